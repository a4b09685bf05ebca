# Part of the extension of vtex for Inkscape.
"""Bounding boxes of the parts of a vtex SVG, fast enough for tens of thousands of paths.

A box may be larger than its element, because the control points of curves count. It is never smaller.
All attributes are read with `attrib`: objects of inkex would parse each path and write it anew.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from inkex import Transform
from lxml import etree

XLINK_HREF = "{http://www.w3.org/1999/xlink}href"
TOKEN = re.compile(r"[A-Za-z]|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2}

Box = tuple[float, float, float, float]
EMPTY: Box = (float("inf"), float("inf"), float("-inf"), float("-inf"))


def tag(element: etree._Element) -> str:
    """Return the name of an element without its namespace; comments have none."""
    name = element.tag
    return name.rpartition("}")[2] if isinstance(name, str) else ""


def reference(element: etree._Element) -> str:
    """Return the id that a clone refers to."""
    return (element.attrib.get(XLINK_HREF) or element.attrib.get("href") or "").lstrip("#")


def join(one: Box, other: Box) -> Box:
    """Return the box around two boxes."""
    return min(one[0], other[0]), min(one[1], other[1]), max(one[2], other[2]), max(one[3], other[3])


def overlap(one: Box, other: Box) -> bool:
    """Whether two boxes touch or overlap."""
    return one[0] <= other[2] and other[0] <= one[2] and one[1] <= other[3] and other[1] <= one[3]


def area(box: Box) -> float:
    """Return the area of a box."""
    return max(box[2] - box[0], 0.0) * max(box[3] - box[1], 0.0)


def transformed(box: Box, transform: Transform) -> Box:
    """Return the box around a transformed box."""
    if box == EMPTY:
        return box
    (a, c, e), (b, d, f) = transform.matrix
    points = [(a * x + c * y + e, b * x + d * y + f) for x in (box[0], box[2]) for y in (box[1], box[3])]
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return min(xs), min(ys), max(xs), max(ys)


def points_of(data: str) -> Iterator[tuple[float, float]]:
    """Yield the nodes and control points of path data. Arcs are not read: vtex writes none."""
    tokens = TOKEN.findall(data)
    at, command = 0, ""
    x = y = start_x = start_y = 0.0
    while at < len(tokens):
        if tokens[at].isalpha():
            command = tokens[at]
            at += 1
            if command in "zZ":
                x, y = start_x, start_y
                continue
        kind = command.lower()
        if kind not in COUNTS:
            raise ValueError(f"path command '{command}' is not read")
        count = COUNTS[kind]
        numbers = [float(token) for token in tokens[at : at + count]]
        if len(numbers) < count:
            raise ValueError("path data is incomplete")
        at += count
        base_x, base_y = (x, y) if command.islower() else (0.0, 0.0)
        if kind == "h":
            x = base_x + numbers[0]
            yield x, y
        elif kind == "v":
            y = base_y + numbers[0]
            yield x, y
        else:
            for i in range(0, count, 2):
                point = base_x + numbers[i], base_y + numbers[i + 1]
                yield point
            x, y = point
        if kind == "m":
            start_x, start_y = x, y
            command = "l" if command == "m" else "L"


def path_box(data: str) -> Box:
    """Return the box around all nodes and control points of a path."""
    points = list(points_of(data))
    if not points:
        return EMPTY
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def number(element: etree._Element, name: str) -> float:
    """Return the number in an attribute; without it, 0."""
    return float(element.attrib.get(name, 0))


class Boxes:
    """Boxes of elements, with the boxes of the ids that clones refer to."""

    def __init__(self, tops: list[etree._Element]) -> None:
        self.by_id = {
            element.attrib.get("id"): element for top in tops for element in top.iter() if element.attrib.get("id")
        }
        self.targets: dict[str, Box] = {}

    def box(self, element: etree._Element) -> Box:
        """Return the box of an element in the coordinates of its parent."""
        kind = tag(element)
        if kind == "path":
            box = path_box(element.attrib.get("d", ""))
        elif kind == "rect":
            x, y = number(element, "x"), number(element, "y")
            box = x, y, x + number(element, "width"), y + number(element, "height")
        elif kind == "circle":
            x, y, r = number(element, "cx"), number(element, "cy"), number(element, "r")
            box = x - r, y - r, x + r, y + r
        elif kind == "use":
            x, y = number(element, "x"), number(element, "y")
            box = self.target(reference(element))
            box = box[0] + x, box[1] + y, box[2] + x, box[3] + y
        elif kind in ("g", "symbol"):
            box = EMPTY
            for child in element:
                box = join(box, self.box(child))
        else:
            return EMPTY
        # A stroke reaches beyond its path by half its width; at sharp joins, by four times that (mitre limit 4).
        width = float(element.attrib.get("stroke-width", 1 if element.attrib.get("stroke", "none") != "none" else 0))
        if width and box != EMPTY:
            box = box[0] - 2 * width, box[1] - 2 * width, box[2] + 2 * width, box[3] + 2 * width
        if element.attrib.get("transform"):
            box = transformed(box, Transform(element.attrib.get("transform")))
        return box

    def target(self, name: str) -> Box:
        """Return the box of an element that clones refer to."""
        if name not in self.targets:
            element = self.by_id.get(name)
            self.targets[name] = EMPTY if element is None else self.box(element)
        return self.targets[name]
