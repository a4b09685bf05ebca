# Part of the extension of vtex for Inkscape.
"""Put elements of one kind into groups without changing the picture.

An element may move down to an earlier group only if nothing between overlaps its bounding box.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from lxml import etree
from vtex_boxes import Box, join, overlap


@dataclass
class Item:
    """One element of a texture, in painting order."""

    element: etree._Element
    boxes: list[Box]
    category: str
    name: str
    fill: str | None = None
    """The colour of an element that may be merged with others of this colour."""
    data: str = ""
    """The path of such an element."""
    outline: Box = field(init=False)

    def __post_init__(self) -> None:
        self.outline = self.boxes[0]
        for box in self.boxes[1:]:
            self.outline = join(self.outline, box)


class Painted:
    """All boxes painted so far, by cells of a grid, with the group that each is in."""

    def __init__(self, cell: float) -> None:
        self.cell = cell
        self.cells: dict[tuple[int, int], list[tuple[Box, int]]] = {}

    def keys(self, box: Box) -> list[tuple[int, int]]:
        """Return the cells that a box touches."""
        left, top, right, bottom = (int(side // self.cell) for side in box)
        return [(x, y) for x in range(left, right + 1) for y in range(top, bottom + 1)]

    def add(self, box: Box, group: int) -> None:
        """Note that a group paints something within this box."""
        for key in self.keys(box):
            self.cells.setdefault(key, []).append((box, group))

    def highest(self, box: Box) -> int:
        """Return the last group that paints something within this box, or -1."""
        found = -1
        for key in self.keys(box):
            for other, group in self.cells.get(key, ()):
                if group > found and overlap(box, other):
                    found = group
        return found


def arrange(
    items: list[Item], key: Callable[[Item], Hashable], limit: int | None = None, apart: bool = False
) -> list[list[Item]]:
    """Return groups in painting order; the items of a group have the same key.

    A group has at most `limit` items. With `apart`, the items of a group do not overlap each other.
    """
    items = [item for item in items if item.outline[0] <= item.outline[2]]
    if not items:
        return []
    width = max(item.outline[2] for item in items) - min(item.outline[0] for item in items)
    height = max(item.outline[3] for item in items) - min(item.outline[1] for item in items)
    painted = Painted(max(width, height, 1e-6) / 64)
    groups: list[list[Item]] = []
    by_key: dict[Hashable, list[int]] = {}
    for item in items:
        kind = key(item)
        same = by_key.setdefault(kind, [])
        lowest = max(painted.highest(box) for box in item.boxes)
        for group in same:
            clear = group > lowest or (group == lowest and not apart)
            if clear and (limit is None or len(groups[group]) < limit):
                break
        else:
            group = len(groups)
            groups.append([])
            same.append(group)
        groups[group].append(item)
        for box in item.boxes:
            painted.add(box, group)
    return groups
