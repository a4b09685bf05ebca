# Part of the extension of vtex for Inkscape.
"""Change the colours of elements. What other elements share with them is copied first."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, field

import inkex
from lxml import etree
from vtex_boxes import XLINK_HREF, Boxes, area, reference, tag
from vtex_colour import Lab, from_lab, to_lab
from vtex_texture import PAINTED, RESOURCES, URL, Category, category_of

HIDDEN = {*RESOURCES, "defs", "metadata"}
COLOURED = ("fill", "stroke", "stop-color")


def style_of(element: etree._Element) -> dict[str, str]:
    """Return the rules in the style attribute of an element."""
    pairs = (rule.partition(":") for rule in element.attrib.get("style", "").split(";"))
    return {name.strip(): value.strip() for name, _, value in pairs if value}


def value_of(element: etree._Element, name: str) -> str:
    """Return a property from the style or the attribute of an element; without it, an empty text."""
    return style_of(element).get(name) or element.attrib.get(name) or ""


def is_flat(value: str) -> bool:
    """Whether a paint is one colour."""
    return value.startswith("#") or (value.isalpha() and value not in ("none", "inherit", "currentColor"))


@dataclass
class Found:
    """A category in the document: its elements, and its colours weighed by area."""

    key: str
    name: str
    elements: list[etree._Element] = field(default_factory=list)
    total: float = 0.0
    sums: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])

    def add(self, colour: str, weight: float) -> None:
        """Add a colour that covers this much."""
        self.total += weight
        for i, value in enumerate(to_lab(colour)):
            self.sums[i] += weight * value

    @property
    def main(self) -> Lab | None:
        """The mean colour; None for elements without a colour."""
        if not self.total:
            return None
        return self.sums[0] / self.total, self.sums[1] / self.total, self.sums[2] / self.total

    def describe(self) -> str:
        """Return a line such as '2  olive  #907108  (8 shapes)'."""
        colour = from_lab(self.main) if self.main else "no colour"
        return f"{self.key}   {self.name}   {colour}   ({len(self.elements)} shapes)"


def find_categories(svg: inkex.SvgDocumentElement, tops: list[etree._Element]) -> dict[str, Found]:
    """Return the categories of these objects by number; each element belongs to its nearest marked ancestor."""
    found: dict[str, Found] = {}
    boxes = Boxes([svg])

    def visit(element: etree._Element, category: Category | None, fill: str) -> None:
        category = category_of(element) or category
        fill = value_of(element, "fill") or fill
        if tag(element) in PAINTED and category:
            entry = found.setdefault(category[0], Found(*category))
            entry.elements.append(element)
            weigh(entry, element, fill)
        elif tag(element) not in HIDDEN:
            for child in element:
                if tag(child):
                    visit(child, category, fill)

    def weigh(entry: Found, element: etree._Element, fill: str) -> None:
        try:
            weight = area(boxes.box(element))
        except ValueError:
            weight = 1.0  # Arcs, and lengths with units, which designers may draw.
        original = boxes.by_id.get(reference(element)) if tag(element) == "use" else None
        if not fill and original is not None:
            fills = (value_of(child, "fill") for child in original.iter() if tag(child))
            fill = next((value for value in fills if value), "")
        paint = URL.match(fill)
        if paint and paint[1] in boxes.by_id:
            stops = [value_of(stop, "stop-color") for stop in boxes.by_id[paint[1]].iter() if tag(stop) == "stop"]
            for colour in filter(is_flat, stops):
                entry.add(colour, weight / len(stops))
        elif is_flat(fill):
            entry.add(fill, weight)

    for top in tops:
        inherited = next((found for found in map(category_of, [top, *top.iterancestors()]) if found), None)
        visit(top, inherited, "")
    return found


class Repainter:
    """Change colours with a function; gradients and clone originals are copied, once each."""

    def __init__(self, svg: inkex.SvgDocumentElement, change: Callable[[str], str]) -> None:
        self.svg = svg
        self.change = change
        self.by_id = {element.get("id"): element for element in svg.iter() if element.get("id")}
        self.copies: dict[str, str] = {}
        self.changed: dict[str, str] = {}

    def colour(self, text: str) -> str:
        """Return the new colour of an old one."""
        if text not in self.changed:
            self.changed[text] = self.change(text)
        return self.changed[text]

    def value(self, text: str) -> str:
        """Return the new paint of an old one: a colour, or a reference to a copied gradient."""
        found = URL.match(text)
        if found:
            return f"url(#{self.copied(found[1])})"
        return self.colour(text) if is_flat(text) else text

    def paint(self, element: etree._Element) -> None:
        """Change the colours of an element and of all within it."""
        for child in element.iter():
            if not tag(child):
                continue
            self.paint_alone(child)
            if tag(child) == "use" or tag(child).endswith("Gradient"):
                name = reference(child)
                if name:
                    child.attrib[XLINK_HREF if XLINK_HREF in child.attrib else "href"] = f"#{self.copied(name)}"

    def paint_alone(self, element: etree._Element) -> None:
        """Change the colours that an element itself sets."""
        for name in COLOURED:
            if name in element.attrib:
                element.attrib[name] = self.value(element.attrib[name])
        style = style_of(element)
        if any(name in style for name in COLOURED):
            rules = {name: self.value(value) if name in COLOURED else value for name, value in style.items()}
            element.attrib["style"] = ";".join(f"{name}:{value}" for name, value in rules.items())

    def copied(self, name: str) -> str:
        """Return the id of a repainted copy of a gradient or of a clone's original."""
        if name not in self.by_id or not self.has_colour(self.by_id[name]):
            return name
        if name not in self.copies:
            original = self.by_id[name]
            made = copy.deepcopy(original)
            renamed = {}
            for child in made.iter():
                if tag(child) and child.attrib.get("id"):
                    old = child.attrib["id"]
                    renamed[old] = child.attrib["id"] = self.free_id(old)
            self.copies[name] = renamed[name]
            for child in made.iter():
                if tag(child) == "use" and reference(child) in renamed:
                    child.attrib[XLINK_HREF if XLINK_HREF in child.attrib else "href"] = f"#{renamed[reference(child)]}"
            original.addnext(made)
            for new in made.iter():
                if tag(new) and new.attrib.get("id"):
                    self.by_id[new.attrib["id"]] = new
                    self.copies.setdefault(new.attrib["id"], new.attrib["id"])
            self.paint(made)
        return self.copies[name]

    def has_colour(self, element: etree._Element) -> bool:
        """Whether a definition has a colour of its own, or refers to one that has."""
        for child in element.iter():
            if not tag(child):
                continue
            if any(value_of(child, name) not in ("", "inherit", "none") for name in COLOURED):
                return True
            name = reference(child)
            if name and name in self.by_id and self.by_id[name] is not element and self.has_colour(self.by_id[name]):
                return True
        return False

    def free_id(self, old: str) -> str:
        """Return an id that is not used, with the same prefix as the old one."""
        number = 2
        stem = old.rpartition("_")[0] if old.rpartition("_")[2].isdigit() and "_" in old else old
        while f"{stem}_{number}" in self.by_id:
            number += 1
        return f"{stem}_{number}"

    def remove_unused(self) -> None:
        """Remove the originals that nothing refers to any more."""
        originals = [name for name, new in self.copies.items() if name != new]
        while True:
            used = set()
            for element in self.svg.iter():
                if tag(element):
                    used.add(reference(element))
                    for value in element.attrib.values():
                        used.update(URL.findall(value))
            unused = [
                name
                for name in originals
                if name not in used
                and self.by_id[name].getparent() is not None
                and not any(child.get("id") in used for child in self.by_id[name].iter() if tag(child))
                and any(tag(parent) == "defs" for parent in self.by_id[name].iterancestors())
            ]
            if not unused:
                return
            for name in unused:
                self.by_id[name].getparent().remove(self.by_id[name])
                originals.remove(name)
