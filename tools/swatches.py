"""Measure the textures of all drawings in folders against the drawings themselves.

    python tools/swatches.py FOLDER... --vtex PROGRAM --out SHEET.png --json TABLE.json
    python -m doctest tools/swatches.py

PROGRAM is vtex. Needs numpy, scipy, Pillow and scikit-image. The second command tests the measures on small pictures.

vtex makes two textures of each SVG, `vtex texture S.svg --seed 1` and the same with --tile. `vtex render` draws the
swatch and the texture at the same number of pixels per unit. The default texture of a drawing is two or three pages
wide, so the numbers of the swatch and of the texture are compared per area. The border of the page cuts elements, and
it cuts relatively more of them in the swatch. The measures of elements correct this by weights (see `Elements`).

Columns of the table, for the texture without --tile unless stated otherwise:

* ink: mean difference of the pixels from the ground colour of the swatch; the same for the texture; the error in %
* tile: the error of ink of the tile, in %
* count: number of connected pieces of ink per area, divided by that of the swatch
* specks: pieces smaller than a twentieth of the smallest whole piece of the swatch, or if it has none, smaller than a
  disc as wide as its lines
* sizes: largest difference between the distributions of the areas of pieces (Kolmogorov-Smirnov, 0 to 1)
* nearest: median distance to the nearest piece, divided by that of the swatch
* hole, room: largest distance from ink, and the 99th percentile over the page; both divided by those of the swatch
* ends: ends of the centre lines of ink per 100 units of centre line, of the swatch and of the texture
* seam: difference across the border of the tile, divided by the median difference of neighbouring rows or columns;
  rank is the share of these that differ at least as much, so a seam is visible if seam is large and rank is near 0
* CPU seconds, memory and bytes: those of `vtex texture`; of CPU seconds and memory the larger of the two runs
"""

import argparse
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont
from scipy import ndimage, spatial
from skimage import morphology

Floats = npt.NDArray[np.floating]
Mask = npt.NDArray[np.bool_]

# Pixels on the longer side of a swatch: the thinnest lines of a swatch are then about three pixels wide.
SWATCH_PIXELS = 700
# Ink covers a pixel if it differs from the ground by this share of the largest difference in the swatch.
INK_SHARE = 0.35
SPECK_SHARE = 1 / 20
# With fewer elements, a median or a distribution says nothing.
FEWEST_ELEMENTS = 5
EQUAL_AREAS = 1.1
WANTED_INK = 0.10
WANTED_CPU, WANTED_CPU_SHARE, MOST_CPU = 1.0, 0.95, 10.0
MOST_MEMORY = 200e6
# Seconds until a run counts as failed.
RUN_LIMIT = "600"
PIXELS_PER_UNIT = {"px": 1, "pt": 4 / 3, "mm": 96 / 25.4, "cm": 96 / 2.54, "in": 96}
CELL_PIXELS, SHEET_PIXELS = 800, 2400


@dataclasses.dataclass
class Ground:
    """The ground of a swatch: its colour, and the largest difference of a pixel from it."""

    colour: Floats
    contrast: float


def ground_of(picture: Floats) -> Ground:
    """Take the most frequent colour of a picture as its ground.

    >>> ground = ground_of(dots(3))
    >>> ground.colour.tolist(), ground.contrast
    ([1.0, 1.0, 1.0], 1.0)
    """
    levels = np.round(picture * 255).astype(np.int64)
    codes = levels @ np.array([65536, 256, 1])
    values, counts = np.unique(codes, return_counts=True)
    common = int(values[counts.argmax()])
    colour = np.array([common >> 16, common >> 8 & 255, common & 255]) / 255
    contrast = float(np.abs(picture - colour).mean(axis=2).max())
    return Ground(colour, max(contrast, 1 / 255))


def difference(picture: Floats, ground: Ground) -> Floats:
    """Difference of each pixel from the ground: for black on white, 1 - lightness."""
    return np.abs(picture - ground.colour).mean(axis=2)


def ink(picture: Floats, ground: Ground) -> float:
    """Share of ink.

    >>> swatch = dots(3)
    >>> lost = swatch.copy()
    >>> lost[:20, :20] = 1  # one dot of nine
    >>> ground = ground_of(swatch)
    >>> round(ink(lost, ground) / ink(swatch, ground), 3)
    0.889
    """
    return float(difference(picture, ground).mean())


def cover(picture: Floats, ground: Ground) -> Floats:
    """Share of each pixel that ink covers; less than 1 throughout for pale ink."""
    return difference(picture, ground) / ground.contrast


@dataclasses.dataclass
class Elements:
    """The connected pieces of ink that the border of the page does not cut.

    A large piece is cut more often than a small one. So each piece weighs one over the probability that a piece of its
    width and height is whole on a page of this size. The sum of the weights is the number of pieces per page, and no
    longer depends on the size of the page.
    """

    areas: Floats
    centres: Floats
    weights: Floats
    page: tuple[int, int]

    @classmethod
    def of(cls, cover: Floats) -> "Elements":
        """Find the whole pieces. Pale rims count for the areas, so these do not depend on fractions of pixels.

        >>> line = np.zeros((9, 30))
        >>> line[3:6, 5:25] = [[0.3], [1.0], [0.7]]
        >>> Elements.of(line).areas.round(6).tolist()
        [40.0]

        Large dots anywhere: a page of a quarter of the size has as many per area, on average.

        >>> page = cover(dots(12, radius=9), ground_of(dots(1)))
        >>> parts = [page[y : y + 60, x : x + 60] for x in range(0, 180, 7) for y in range(0, 180, 7)]
        >>> round(float(np.mean([Elements.of(part).per_area() for part in parts])) * 400, 1)
        1.0
        >>> round(float(np.mean([len(Elements.of(part).areas) for part in parts])) / 9, 1)
        0.4
        """
        labels, count = ndimage.label(cover > INK_SHARE, np.ones((3, 3)))
        height, width = cover.shape
        kept, weights = [], []
        for number, (rows, columns) in enumerate(ndimage.find_objects(labels), 1):
            if rows.start > 0 and columns.start > 0 and rows.stop < height and columns.stop < width:
                kept.append(number)
                high, wide = rows.stop - rows.start, columns.stop - columns.start
                weights.append(1 / ((1 - high / height) * (1 - wide / width)))
        with_rims = np.where(labels > 0, labels, ndimage.maximum_filter(labels, 3))
        areas = np.bincount(with_rims.ravel(), cover.ravel(), count + 1)[kept].astype(float)
        centres = np.array(ndimage.center_of_mass(cover, labels, kept), float).reshape(-1, 2)
        return cls(areas, centres, np.array(weights), (height, width))

    def chosen(self, choice: Mask) -> "Elements":
        """Keep only some pieces."""
        return Elements(self.areas[choice], self.centres[choice], self.weights[choice], self.page)

    def per_area(self) -> float:
        """Count pieces per pixel."""
        return float(self.weights.sum() / (self.page[0] * self.page[1]))

    def share_below(self, bounds: Floats) -> Floats:
        """Share of the pieces whose area is at most each of the bounds."""
        order = np.argsort(self.areas)
        sums = np.concatenate([[0], np.cumsum(self.weights[order])])
        return sums[np.searchsorted(self.areas[order], bounds, "right")] / sums[-1]

    def nearest(self) -> float | None:
        """Median distance to the nearest piece.

        A piece counts if the border of the page is farther away than its neighbour, so no nearer neighbour can be
        beyond the border. Its weight is one over the area of the page where this is so at its distance.

        >>> page = dots(6)
        >>> Elements.of(cover(page, ground_of(page))).nearest()
        20.0
        """
        if len(self.areas) < FEWEST_ELEMENTS:
            return None
        distances = spatial.cKDTree(self.centres).query(self.centres, 2)[0][:, 1]
        far_side = np.array(self.page) - self.centres
        inside = np.minimum(self.centres, far_side).min(axis=1) >= distances
        height, width = self.page
        room = (height - 2 * distances) * (width - 2 * distances)
        inside &= room > 0
        if not inside.any():
            return None
        return weighted_median(distances[inside], 1 / room[inside])


def weighted_median(values: Floats, weights: Floats) -> float:
    """Find the value with half of the weight on each side.

    >>> weighted_median(np.array([3.0, 1.0, 2.0]), np.array([5.0, 1.0, 1.0]))
    3.0
    """
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(sums, sums[-1] / 2)])


def distribution_distance(one: Elements, other: Elements) -> float | None:
    """Largest difference between the two distributions of areas, by weight.

    Areas that differ by less than a tenth are equal: curves are drawn a little differently at fractions of a pixel.

    >>> small, large = dots(6), dots(6, radius=6)
    >>> pages = [Elements.of(cover(page, ground_of(page))) for page in (small, large)]
    >>> distribution_distance(pages[0], pages[0]), distribution_distance(pages[0], pages[1])
    (0.0, 1.0)

    Two of 36 dots that touch are one piece, so one piece of 35 has another area.

    >>> small[50, 50:70] = 0
    >>> joined = Elements.of(cover(small, ground_of(small)))
    >>> round(distribution_distance(joined, pages[0]), 2)
    0.03
    """
    if min(len(one.areas), len(other.areas)) < FEWEST_ELEMENTS:
        return None
    bounds = np.unique(np.concatenate([one.areas, other.areas]))
    distances = [one.share_below(bounds) - other.share_below(EQUAL_AREAS * bounds)]
    distances += [other.share_below(bounds) - one.share_below(EQUAL_AREAS * bounds)]
    return float(max(0, np.max(distances)))


def line_ends(mask: Mask) -> tuple[int, int, float]:
    """Count ends of the centre lines of the ink, and pixels of centre line; measure the width of the lines.

    Only what is farther from the border than three widths counts: there the border of the page makes no ends.

    >>> ring = np.full((100, 100), False)
    >>> ring[20:80, 20:80] = True
    >>> ring[24:76, 24:76] = False
    >>> line_ends(ring)[0]
    0
    >>> ring[40:60, :50] = False  # opened
    >>> line_ends(ring)[0]
    2
    """
    skeleton = morphology.skeletonize(mask)
    depth = ndimage.distance_transform_edt(mask)
    width = 2 * float(np.median(depth[skeleton])) if skeleton.any() else 1.0
    neighbours = ndimage.convolve(skeleton.astype(np.uint8), np.ones((3, 3), np.uint8), mode="constant") - 1
    margin = min(round(3 * width) + 1, min(mask.shape) // 4)
    inner = np.zeros_like(mask)
    inner[margin:-margin, margin:-margin] = True
    return int((skeleton & (neighbours == 1) & inner).sum()), int((skeleton & inner).sum()), width


def seam(picture: Floats) -> tuple[float, float]:
    """Difference across the border of a tile relative to the median inside, and the rank of it.

    Of the two directions, that with the lower rank.

    >>> tile = dots(3, shift=10)
    >>> seam(tile)[1] > 0.05
    True
    >>> cut = tile[:, 4:]
    >>> seam(cut)[1] < 0.05
    True
    """
    found = []
    for axis in (0, 1):
        steps = np.abs(picture - np.roll(picture, 1, axis)).mean(axis=(1 - axis, 2))
        across, inner = steps[0], steps[1:]
        median = np.median(inner[inner > 0]) if inner.any() else 1 / 255
        found.append((float(across / median), float((inner >= across).mean())))
    return min(found, key=lambda pair: (pair[1], -pair[0]))


def holes(inked: Mask) -> tuple[float, float]:
    """Largest distance from ink in pixels, and the 99th percentile over the page, where no nearer ink can be beyond it.

    >>> page = np.zeros((100, 100), bool)
    >>> page[::10, ::10] = True
    >>> found = holes(page)
    >>> page[50, 50] = False
    >>> round(found[0], 2), holes(page)[0], holes(page)[1] < 7.2
    (7.07, 10.0, True)
    """
    distances = ndimage.distance_transform_edt(~inked)
    height, width = inked.shape
    y, x = np.ogrid[:height, :width]
    to_border = np.minimum(np.minimum(y, height - 1 - y), np.minimum(x, width - 1 - x))
    known = distances[distances <= to_border]
    return (float(known.max()), float(np.percentile(known, 99))) if inked.any() and known.size else (0.0, 0.0)


def speck_limit(elements: Elements, width: float) -> float:
    """Area below which a piece is a speck, given the pieces and the width of the lines of the swatch.

    >>> page = cover(dots(6), ground_of(dots(6)))
    >>> int(page[:20, :20].sum()), speck_limit(Elements.of(page), 4)
    (49, 2.45)
    """
    if not len(elements.areas):
        return float(np.pi / 4 * width**2)
    return float(SPECK_SHARE * elements.areas.min())


def relative(before: float, after: float) -> float | None:
    """Relative error; none if there is ink where the swatch has none.

    >>> round(relative(0.2, 0.15), 2), relative(0, 0), relative(0, 0.1)
    (-0.25, 0.0, None)
    """
    if not before:
        return None if after else 0.0
    return after / before - 1


def compare(swatch: Floats, texture: Floats, unit: float) -> dict[str, float | None]:
    """Measures of a texture against its swatch; both have `unit` pixels per unit.

    >>> page = dots(6)
    >>> page[50, 60] = 0  # a speck
    >>> page[:20, 40:60] = 1  # a lost dot
    >>> result = compare(dots(6), page, 1)
    >>> result["specks"], round(result["count"], 2), round(100 * result["ink_error"])
    (1, 0.97, -3)
    """
    ground = ground_of(swatch)
    covers = cover(swatch, ground), cover(texture, ground)
    all_elements = [Elements.of(cover) for cover in covers]
    lines = [line_ends(cover > INK_SHARE) for cover in covers]
    limit = speck_limit(all_elements[0], lines[0][2])
    specks = int((all_elements[1].areas < limit).sum())
    before, after = (elements.chosen(elements.areas >= limit) for elements in all_elements)
    nearest = before.nearest(), after.nearest()
    inks = ink(swatch, ground), ink(texture, ground)
    # The page of a swatch repeats.
    (hole, room), (own_hole, own_room) = holes(covers[1] > INK_SHARE), holes(np.tile(covers[0] > INK_SHARE, (3, 3)))
    ends = [100 * ends * unit / length if length else 0 for ends, length, _ in lines]
    return {
        "ink_swatch": inks[0],
        "ink_texture": inks[1],
        "ink_error": relative(*inks),
        "count": after.per_area() / before.per_area() if len(before.areas) >= FEWEST_ELEMENTS else None,
        "specks": specks,
        "sizes": distribution_distance(before, after),
        "nearest": nearest[1] / nearest[0] if nearest[0] and nearest[1] else None,
        "hole": hole / own_hole if own_hole else None,
        "room": room / own_room if own_room else None,
        "ends_swatch": ends[0],
        "ends_texture": ends[1],
    }


def dots(count: int, radius: int = 4, shift: int = 0) -> Floats:
    """Draw a picture for the tests: black dots at distances of 20 pixels on white."""
    size = 20 * count
    rows, columns = np.mgrid[:size, :size]
    inside = ((rows + shift) % 20 - 10) ** 2 + ((columns + shift) % 20 - 10) ** 2 <= radius**2
    return np.repeat(np.where(inside, 0.0, 1.0)[:, :, None], 3, axis=2)


class Program:
    """The program vtex."""

    def __init__(self, path: pathlib.Path):
        self.path = str(path)

    def run(self, *arguments: str) -> tuple[dict, float]:
        """Return the summary and the CPU seconds of a run; RuntimeError has the message of vtex."""
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as messages:
            command = ["timeout", RUN_LIMIT, self.path, *arguments, "--json", "--force"]
            process = subprocess.Popen(command, stdout=out, stderr=messages)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            messages.seek(0)
            if process.returncode:
                raise RuntimeError(messages.read().decode().strip() or f"vtex ended with {process.returncode}")
            return json.load(out), usage.ru_utime + usage.ru_stime

    def drawn(self, svg: pathlib.Path, png: pathlib.Path, *size: str) -> Floats:
        """Draw an SVG over white."""
        self.run("render", str(svg), "-o", str(png), *size)
        picture = Image.open(png).convert("RGBA")
        paper = Image.new("RGBA", picture.size, "white")
        return np.asarray(Image.alpha_composite(paper, picture).convert("RGB"), np.float32) / 255


def page_of(svg: pathlib.Path, attribute: str) -> tuple[float, float]:
    """Width and height of a page: by `size`, the attributes width and height, or by `viewBox`."""
    root = ElementTree.parse(svg).getroot()
    sides = [re.fullmatch(r"([\d.]+)(px|pt|mm|cm|in)?", root.get(side, "")) for side in ("width", "height")]
    if attribute == "size" and sides[0] and sides[1]:
        width, height = (float(side[1]) * PIXELS_PER_UNIT[side[2] or "px"] for side in sides if side)
    else:
        _, _, width, height = (float(text) for text in re.split(r"[\s,]+", root.get("viewBox", "").strip()))
    return width, height


@dataclasses.dataclass
class Swatch:
    """One drawing and what was measured."""

    name: str
    row: dict
    pictures: tuple[Floats, Floats] | None = None


def measured(program: Program, svg: pathlib.Path, folder: pathlib.Path) -> Swatch:
    """Make both textures of a drawing and measure them."""
    name = svg.stem
    row: dict = {"name": name}
    try:
        made, tile = folder / f"{name}.texture.svg", folder / f"{name}.tile.svg"
        summary, cpu = program.run("texture", str(svg), "--seed", "1", "-o", str(made))
        page = page_of(svg, "size")
        width = round(SWATCH_PIXELS * page[0] / max(page))
        swatch = program.drawn(svg, folder / f"{name}.png", "--width", str(width))
        # `render` rounds the size of a small page, so the swatch may be a little wider.
        unit = swatch.shape[1] / page[0]
        # A unit of the texture is one of the page, but vtex reads a tiny page as ten or a hundred times as large. The
        # default texture is two or three pages wide.
        units = page_of(made, "viewBox")[0]
        enlarged = 10 ** int(np.log10(units / page[0]))
        width = round(unit * units / enlarged)
        texture = program.drawn(made, folder / f"{name}.texture.png", "--width", str(width))
        row |= {"method": summary["method"], "bytes": summary["bytes"], "warnings": summary["warnings"]}
        row |= compare(swatch, texture, unit)
        tile_summary, tile_cpu = program.run("texture", str(svg), "--seed", "1", "--tile", "-o", str(tile))
        # Scaled by a whole number, so that the last row and column of pixels are full ones.
        tiled = program.drawn(tile, folder / f"{name}.tile.png", "--scale", "2")
        row["ink_error_tile"] = relative(row["ink_swatch"], ink(tiled, ground_of(swatch)))
        row["seam"], row["seam_rank"] = seam(tiled)
        row["cpu"] = max(cpu, tile_cpu)
        # What vtex measures itself: that of wait4 contains the memory of this program before it started vtex.
        row["memory"] = max(summary["peak_memory"], tile_summary["peak_memory"])
        return Swatch(name, row, (swatch, texture))
    except (RuntimeError, ValueError) as error:
        row["error"] = str(error)
        return Swatch(name, row)


def ink_error(swatch: Swatch) -> float:
    """Size of the error of ink; a swatch without a texture is the worst."""
    error = swatch.row.get("ink_error")
    return float("inf") if error is None else abs(error)


# Heading, entry of the row, format, and factor of the table's columns.
COLUMNS: list[tuple[str, str, str, float]] = [
    ("ink", "ink_swatch", ".4f", 1),
    ("texture", "ink_texture", ".4f", 1),
    ("error, %", "ink_error", "+.1f", 100),
    ("tile, %", "ink_error_tile", "+.1f", 100),
    ("count", "count", ".2f", 1),
    ("specks", "specks", "d", 1),
    ("sizes", "sizes", ".2f", 1),
    ("nearest", "nearest", ".2f", 1),
    ("hole", "hole", ".2f", 1),
    ("room", "room", ".2f", 1),
    ("ends", "ends_swatch", ".2f", 1),
    ("texture", "ends_texture", ".2f", 1),
    ("seam", "seam", ".1f", 1),
    ("rank", "seam_rank", ".3f", 1),
    ("CPU, s", "cpu", ".2f", 1),
    ("MB", "memory", ".0f", 1e-6),
    ("kB", "bytes", ".0f", 1e-3),
]


def print_table(swatches: list[Swatch]) -> None:
    """Print the table in Markdown."""
    print("| swatch | method |", " | ".join(heading for heading, *_ in COLUMNS), "|")
    print("|---|---|" + "--:|" * len(COLUMNS))
    for swatch in swatches:
        row = swatch.row
        if "error" in row:
            print(f"| {swatch.name} | failed: {row['error'].splitlines()[0]} |")
            continue
        cells = ["-" if row[entry] is None else format(row[entry] * factor, form) for _, entry, form, factor in COLUMNS]
        print("|", " | ".join([swatch.name, row["method"], *cells]), "|")


def print_goals(swatches: list[Swatch]) -> None:
    """Print how many swatches reach the goals."""
    count = len(swatches)
    rows = [swatch.row for swatch in swatches if "error" not in swatch.row]
    close = sum(ink_error(swatch) <= WANTED_INK for swatch in swatches)
    quick = sum(row["cpu"] <= WANTED_CPU for row in rows)
    print(f"\nink within {WANTED_INK:.0%}: {close} of {count}")
    print(f"CPU at most {WANTED_CPU:g} s: {quick} of {count} (goal: {WANTED_CPU_SHARE:.0%})")
    for entry, most, form, unit in (("cpu", MOST_CPU, ".2f", "s"), ("memory", MOST_MEMORY, ".0f", "B")):
        largest = max(rows, key=lambda row: row[entry], default=None)
        if largest:
            print(f"largest {entry}: {largest[entry]:{form}} {unit} ({largest['name']}; goal: at most {most:g} {unit})")
    print(f"failed: {count - len(rows)} of {count}")


def write_sheets(swatches: list[Swatch], out: pathlib.Path, per_page: int) -> None:
    """Write pages of swatches and textures, side by side at one scale, with names and errors of ink."""
    shown = [swatch for swatch in swatches if swatch.pictures]
    across = max(1, round((per_page / 1.5) ** 0.5))
    down = -(-per_page // across)
    # A cell shows the texture and beside it the swatch, which is at most half as wide.
    side = min(CELL_PIXELS, (SHEET_PIXELS // across - 16) * 2 // 3)
    font = ImageFont.load_default(18)
    cell = side * 3 // 2 + 16, side + 32
    for page, first in enumerate(range(0, len(shown), per_page), 1):
        sheet = Image.new("RGB", (across * cell[0], down * cell[1]), "#dddddd")
        draw = ImageDraw.Draw(sheet)
        for place, swatch in enumerate(shown[first : first + per_page]):
            x, y = place % across * cell[0] + 6, place // across * cell[1] + 26
            assert swatch.pictures
            scale = side / max(swatch.pictures[1].shape[:2])
            for picture in swatch.pictures:
                image = Image.fromarray(np.round(picture * 255).astype(np.uint8))
                size = max(1, round(image.width * scale)), max(1, round(image.height * scale))
                sheet.paste(image.resize(size, Image.Resampling.BOX), (x, y))
                x += size[0] + 4
            error = swatch.row["ink_error"]
            text = f"{swatch.name}  {swatch.row['method']}  ink " + ("-" if error is None else f"{error:+.1%}")
            draw.text((place % across * cell[0] + 6, y - 23), text, "black", font)
        one = len(shown) <= per_page
        sheet.save(out if one else out.with_stem(f"{out.stem}-{page:02}"))


def main() -> None:
    """Measure all drawings of the folders."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=pathlib.Path, metavar="FOLDER", help="folders of SVG drawings")
    parser.add_argument("--vtex", required=True, type=pathlib.Path, help="the program")
    parser.add_argument("--out", type=pathlib.Path, help="sheet of pictures, PNG; SHEET-01.png, ... if several")
    parser.add_argument("--json", type=pathlib.Path, help="the table as JSON")
    parser.add_argument("--per-page", type=int, default=12, help="drawings on a page of the sheet [default: 12]")
    parser.add_argument("--keep", type=pathlib.Path, help="keep the SVGs and pictures in this folder")
    arguments = parser.parse_args()
    drawings = [svg for folder in arguments.folders for svg in sorted(folder.glob("*.svg"))]
    if not drawings:
        sys.exit("the folders contain no SVG")
    program = Program(arguments.vtex)
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        swatches = []
        for svg in drawings:
            print(svg.stem, file=sys.stderr)
            swatches.append(measured(program, svg, folder))
    swatches.sort(key=ink_error, reverse=True)
    print_table(swatches)
    print_goals(swatches)
    if arguments.json:
        arguments.json.write_text(json.dumps([swatch.row for swatch in swatches], indent=1) + "\n")
    if arguments.out:
        write_sheets(swatches, arguments.out, arguments.per_page)


if __name__ == "__main__":
    main()
