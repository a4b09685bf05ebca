"""Reads the hand labels of photographs (`tests/labels`) and draws them as maps of instances.

    labels.py [FILES...]

prints for each file (default: all of `tests/labels`) how many textons it holds and how large they are.
"""

import argparse
import glob
import json
import os
import sys

import numpy as np

GROUND = 0
UNSURE = 65535  # the value that training ignores
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "labels")


def load(path):
    """The label file at `path` as (photo, crop, map).

    `photo` is the photograph's file name, `crop` is [x, y, width, height] in its pixels, and `map` is
    that crop as uint16 [height, width]: 0 is ground, 1, 2, … the sure textons in the order of the
    file, 65535 what is neither wanted nor false.
    """
    with open(path, encoding="utf-8") as f:
        file = json.load(f)
    return file["photo"], file["crop"], instances(file["crop"], file["textons"])


def instances(crop, textons):
    """The textons of a label file as a map of `crop`; of two that overlap, the later lies on top."""
    x, y, width, height = crop
    out = np.zeros((height, width), np.uint16)
    number = 0
    for texton in textons:
        number += texton["sure"]
        polygon = np.asarray(texton["polygon"], float) - (x, y)
        out[inside(polygon, width, height)] = number if texton["sure"] else UNSURE
    return out


def inside(polygon, width, height):
    """Which pixels have their centre inside `polygon` (even-odd), as bool [height, width].

    Vertices are [x, y] with whole numbers at the pixels' corners, so the first centre is (0.5, 0.5).
    """
    columns, rows = np.arange(width) + 0.5, np.arange(height) + 0.5
    out = np.zeros((height, width), bool)
    for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0)):
        crossed = np.flatnonzero((y0 <= rows) != (y1 <= rows))
        edge = x0 + (rows[crossed] - y0) * (x1 - x0) / (y1 - y0) if len(crossed) else rows[crossed]
        out[crossed] ^= columns[None, :] > edge[:, None]
    return out


def areas(labels):
    """Visible pixels of each sure texton of a map, in the order of the file."""
    counts = np.bincount(labels[labels != UNSURE].ravel())
    return counts[1:]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", default=sorted(glob.glob(os.path.join(FOLDER, "*.json"))))
    print("photo           sure  median  large from  sure %  unsure %")
    for path in parser.parse_args().files:
        photo, _, labels = load(path)
        area = areas(labels)
        unsure = (labels == UNSURE).mean()
        covered = (labels != GROUND).mean() - unsure
        print(
            f"{photo:15} {len(area):4}  {np.median(area):6.0f}  {np.quantile(area, 2 / 3):10.0f}"
            f"  {100 * covered:6.0f}  {100 * unsure:8.0f}"
        )


if __name__ == "__main__":
    sys.exit(main())
