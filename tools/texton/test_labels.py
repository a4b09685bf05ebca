"""Tests of `labels.py` and of the label files themselves: `python tools/texton/test_labels.py`."""

import glob
import json
import os
import unittest

import numpy as np

from labels import FOLDER, GROUND, UNSURE, areas, inside, instances, load


def square(x, y, side, sure=True):
    polygon = [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    return {"kind": "chip", "sure": sure, "polygon": polygon}


def polygon_area(polygon):
    x, y = np.asarray(polygon, float).T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def perimeter(polygon):
    points = np.asarray(polygon, float)
    return np.linalg.norm(points - np.roll(points, -1, axis=0), axis=1).sum()


class Drawing(unittest.TestCase):
    def test_square_covers_exactly_its_pixels(self):
        out = instances([100, 50, 10, 8], [square(102, 53, 4)])
        self.assertEqual(out.shape, (8, 10))
        wanted = np.zeros((8, 10), np.uint16)
        wanted[3:7, 2:6] = 1
        np.testing.assert_array_equal(out, wanted)

    def test_two_halves_share_no_pixel_and_leave_none_out(self):
        upper, lower = [[0, 0], [20, 0], [0, 13]], [[20, 0], [20, 13], [0, 13]]
        one, other = inside(np.array(upper, float), 20, 13), inside(np.array(lower, float), 20, 13)
        self.assertFalse((one & other).any())
        self.assertTrue((one | other).all())

    def test_later_lies_on_top_and_unsure_has_no_number(self):
        textons = [square(0, 0, 6), square(4, 4, 4, sure=False), square(5, 0, 3)]
        out = instances([0, 0, 10, 10], textons)
        self.assertEqual(out[0, 0], 1)
        self.assertEqual(out[5, 5], UNSURE)
        self.assertEqual(out[1, 5], 2)
        self.assertEqual(out[9, 9], GROUND)
        self.assertEqual(areas(out).tolist(), [36 - 4 - 3, 9])


class Files(unittest.TestCase):
    def test_files_hold_what_they_promise(self):
        paths = sorted(glob.glob(os.path.join(FOLDER, "*.json")))
        self.assertEqual(len(paths), 14)
        for path in paths:
            with open(path, encoding="utf-8") as f:
                textons = json.load(f)["textons"]
            photo, (x, y, width, height), labels = load(path)
            self.assertEqual(os.path.splitext(photo)[0], os.path.splitext(os.path.basename(path))[0])
            self.assertEqual((height, width), labels.shape)
            sure = [t["polygon"] for t in textons if t["sure"]]
            visible = areas(labels)
            self.assertEqual(len(visible), len(sure))
            for polygon, pixels in zip(sure, visible):
                points = np.asarray(polygon)
                self.assertTrue(((points >= (x, y)) & (points <= (x + width, y + height))).all())
                area = polygon_area(polygon)
                self.assertGreaterEqual(area, 30, polygon)
                # Nothing but the rounding of the outline to pixels: next to nothing lies under a neighbour.
                self.assertLess(abs(pixels - area), 0.2 * perimeter(polygon), polygon)


if __name__ == "__main__":
    unittest.main()
