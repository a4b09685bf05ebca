# Part of the extension of vtex for Inkscape.
"""Turn an SVG of vtex into one layer: named groups by category, unique ids, clones that take a colour."""

from __future__ import annotations

import re
from collections.abc import Hashable
from pathlib import Path

from inkex import NSS, AbortExtension
from lxml import etree
from vtex_arrange import Item, arrange
from vtex_boxes import XLINK_HREF, Boxes, area, reference, tag
from vtex_colour import broad_name

SVG = f"{{{NSS['svg']}}}"
LABEL = f"{{{NSS['inkscape']}}}label"
GROUPMODE = f"{{{NSS['inkscape']}}}groupmode"
# Marks in the document. Recolouring reads them, so they stay valid when a designer renames groups.
TEXTURE = "data-vtex-texture"
CATEGORY = "data-vtex-category"
NAME = "data-vtex-name"
BACKGROUND, SMALL = "background", "small"
NAMES = {BACKGROUND: "background", SMALL: "small elements"}

GROUP_LIMIT = 200
"""Maximum number of objects in a group."""
SMALL_AREA = 600
"""Maximum box of a primary that is merged with others of its colour, in square pixels of the canvas."""

RESOURCES = {"linearGradient", "radialGradient", "clipPath", "mask", "symbol", "filter", "pattern"}
PAINTED = {"path", "use", "circle", "ellipse", "rect", "line", "polyline", "polygon"}
CATEGORY_CLASS = re.compile(r"\bcategory-(\d+)\b")
NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+))"
START = re.compile(rf"\s*m\s*{NUMBER}[\s,]*{NUMBER}[\s,]*")
URL = re.compile(r"url\(#([^)]+)\)")

Category = tuple[str, str]
"""The number of a category, or what stands for it, and its name."""


def read_texture(path: Path) -> etree._Element:
    """Return the root of an SVG that vtex wrote."""
    try:
        # The parser of inkex makes objects that parse each path: too slow for thousands of them.
        return etree.parse(str(path), etree.XMLParser(huge_tree=True, resolve_entities=False)).getroot()
    except (OSError, etree.XMLSyntaxError) as error:
        raise AbortExtension(f"Cannot read the texture that vtex wrote: {error}") from error


def category_of(element: etree._Element) -> Category | None:
    """Return the category of an element, as marked by this extension or written by vtex."""
    key = element.attrib.get(CATEGORY)
    if key is not None:
        return key, element.attrib.get(NAME, key)
    found = CATEGORY_CLASS.search(element.attrib.get("class", ""))
    if found:
        return found[1], re.sub(r"\s+\d+$", "", element.attrib.get(LABEL, "")) or f"category {found[1]}"
    if element.attrib.get(GROUPMODE) == "layer":
        key = {"background": BACKGROUND, "secondary": SMALL}.get(element.attrib.get("id", "").rpartition("-")[2])
        return (key, NAMES[key]) if key else None
    return None


def mark(element: etree._Element, category: Category | None) -> None:
    """Write the category into an element in place of its class, which the document may style."""
    element.attrib.pop("class", None)
    if category:
        element.set(CATEGORY, category[0])
        element.set(NAME, category[1])


class TextureLayer:
    """The layer made from one SVG of vtex, and the definitions it needs."""

    def __init__(self, root: etree._Element, prefix: str, group: bool = True, merge: bool = False) -> None:
        self.group = group
        self.merge = merge
        self.definitions = take_definitions(root)
        inherit_fills(root, self.definitions)
        self.boxes = Boxes([root, *self.definitions])
        parts = [child for child in root if child.get(GROUPMODE) == "layer"]
        self.layer = etree.SubElement(root, f"{SVG}g")
        self.layer.set(GROUPMODE, "layer")
        self.layer.set(TEXTURE, prefix)
        # If all is inside the shape, the layer itself is clipped: one group less.
        if len(parts) == 1 and parts[0].get("id") == "inside":
            self.layer.set("clip-path", parts[0].get("clip-path"))
            parts = list(parts[0])
        for part in parts:
            self.add_part(part, self.layer)
        set_prefix([self.layer, *self.definitions], prefix)

    def add_part(self, part: etree._Element, parent: etree._Element) -> None:
        """Add one layer of the SVG as a group, with a group for each of its categories."""
        kept = {name: value for name, value in part.attrib.items() if name not in ("id", "class", LABEL, GROUPMODE)}
        nested = [child for child in part if child.get(GROUPMODE) == "layer"]
        own = [child for child in part if tag(child) and child not in nested]
        category = category_of(part)
        is_primary = part.get("id", "").rpartition("-")[2] == "primary"
        if is_primary and self.group and not kept and not nested:
            group = parent
        else:
            group = etree.SubElement(parent, f"{SVG}g", kept)
            group.set(LABEL, re.sub("secondary$", "small elements", part.get(LABEL, "Layer").lower()).capitalize())
        if is_primary or category == (SMALL, NAMES[SMALL]) or any(category_of(child) for child in own):
            self.add_elements(own, group, category)
        elif own:
            # The smooth colours beneath the elements stay one group.
            if nested:
                group = etree.SubElement(group, f"{SVG}g", {LABEL: "Background"})
            mark(group, (BACKGROUND, NAMES[BACKGROUND]))
            group.extend(own)
        for child in nested:
            self.add_part(child, group)

    def add_elements(self, children: list[etree._Element], parent: etree._Element, category: Category | None) -> None:
        """Add elements, grouped by category and merged by colour as wanted."""
        items = [item for child in children for item in self.items(child, category)]
        if self.merge:
            items = [merged(members) for members in arrange(items, merge_key, apart=True)]
        if not self.group:
            mark(parent, category)
            parent.extend(item.element for item in items)
            return
        seen: dict[str, int] = {}
        for members in arrange(items, self.group_key, GROUP_LIMIT):
            _, label = self.group_key(members[0])
            seen[label] = seen.get(label, 0) + 1
            group = etree.SubElement(parent, f"{SVG}g")
            group.set(LABEL, label if seen[label] == 1 else f"{label} ({seen[label]})")
            mark(group, (members[0].category, members[0].name))
            group.extend(item.element for item in members)

    def items(self, element: etree._Element, inherited: Category | None) -> list[Item]:
        """Return the elements in this part of the SVG. A group that only sets a fill is dissolved."""
        if not tag(element):
            return []
        category = category_of(element)
        if tag(element) == "g" and category is None and set(element.attrib) <= {"fill"}:
            for child in element:
                if element.get("fill") and child.get("fill") is None:
                    child.set("fill", element.get("fill"))
            return [item for child in list(element) for item in self.items(child, inherited)]
        own = category
        if category is None:
            # A motif is painted and moved as one thing: it is grouped with its first element.
            within = (category_of(child) for child in element.iterdescendants())
            category = next((found for found in within if found), inherited or ("0", "other"))
        for child in element.iterdescendants():
            mark(child, category_of(child) if tag(child) else None)
        mark(element, own)
        box = self.boxes.box(element)
        item = Item(element, [box], *category)
        plain = self.plain(element)
        if plain is not None and (category[0] == SMALL or area(box) <= SMALL_AREA):
            item.fill, item.data = plain
        return [item]

    def group_key(self, item: Item) -> Category:
        """Return the category and the label of an element's group. Small elements are grouped by similar colours."""
        if item.category != SMALL:
            return item.category, item.name
        fill = item.fill or item.element.get("fill") or ""
        found = URL.fullmatch(fill)
        if found and found[1] in self.boxes.by_id:
            stops = self.boxes.by_id[found[1]].findall(f"{SVG}stop")
            fill = stops[0].get("stop-color", "") if stops else ""
        return item.category, f"small, {broad_name(fill)}" if fill.startswith("#") else NAMES[SMALL]

    def plain(self, element: etree._Element) -> tuple[str, str] | None:
        """Return the colour and the path of an element that is only one path with a flat fill."""
        inner = element
        if tag(element) == "g":
            if len(element) != 1 or set(element.attrib) - {"id", LABEL, CATEGORY, NAME}:
                return None
            inner = element[0]
        fill = inner.get("fill", "")
        x = y = 0.0
        path = inner
        if tag(inner) == "use":
            if set(inner.attrib) - {"id", "x", "y", "fill", XLINK_HREF}:
                return None
            x, y = float(inner.get("x", 0)), float(inner.get("y", 0))
            path = self.boxes.by_id.get(reference(inner), inner)
            if tag(path) == "g" and len(path) == 1 and set(path.attrib) <= {"id"}:
                path = path[0]
        if tag(path) != "path" or not fill.startswith("#") or set(path.attrib) - {"id", "d", "fill"}:
            return None
        data = moved(path.get("d", ""), x, y)
        return (fill, data) if data else None


def moved(data: str, x: float, y: float) -> str | None:
    """Return relative path data that starts at an absolute position and can follow other data."""
    start = START.match(data)
    rest = data[start.end() :] if start else ""
    # A later absolute command, or a second start after which a position would be unknown, does not occur in vtex.
    if not start or re.search("[A-Z]", rest):
        return None
    joint = "" if not rest or rest[0].isalpha() else "l"
    return f"M{float(start[1]) + x:.10g} {float(start[2]) + y:.10g}{joint}{rest}"


def merge_key(item: Item) -> Hashable:
    """Elements that may become one path have the same key; all others have one each."""
    return (item.category, item.fill) if item.fill else id(item)


def merged(items: list[Item]) -> Item:
    """Return one path in place of plain elements of one colour that do not overlap."""
    first = items[0]
    if len(items) == 1:
        return first
    element = etree.Element(f"{SVG}path", {"fill": first.fill or "", "d": "".join(item.data for item in items)})
    mark(element, (first.category, first.name))
    return Item(element, [box for item in items for box in item.boxes], first.category, first.name, first.fill)


def take_definitions(root: etree._Element) -> list[etree._Element]:
    """Take gradients, clips, masks and elements drawn once out of the SVG, wherever they are in it."""
    found = [child for defs in root.iter(f"{SVG}defs") for child in defs if tag(child)]
    for element in root.iter(*(f"{SVG}{name}" for name in RESOURCES)):
        if element not in found and all(
            tag(parent) not in RESOURCES - {"symbol"} for parent in element.iterancestors()
        ):
            found.append(element)
    for element in found:
        element.getparent().remove(element)
        if tag(element) == "symbol":
            # A clone of a group is simpler to edit than one of a symbol, and looks the same.
            element.tag = f"{SVG}g"
            element.attrib.pop("overflow", None)
            for title in element.findall(f"{SVG}title"):
                element.remove(title)
    return found


def shapes_in(element: etree._Element) -> list[etree._Element]:
    """Return the painted shapes of a definition, in painting order."""
    return [child for child in element.iter() if tag(child) in PAINTED]


def fill_owner(shape: etree._Element, top: etree._Element) -> etree._Element | None:
    """Return the element, from the shape up to the definition, that sets the shape's fill."""
    element = shape
    while element.get("fill") is None:
        if element is top:
            return None
        element = element.getparent()
    return element


def inherit_fills(root: etree._Element, definitions: list[etree._Element]) -> None:
    """Move the main fill of each element drawn once to its clones, so that a clone can get another colour."""
    uses: dict[str, list[etree._Element]] = {}
    for top in (root, *definitions):
        for use in top.iter(f"{SVG}use"):
            uses.setdefault(reference(use), []).append(use)
    for definition in definitions:
        clones = uses.get(definition.get("id", ""), [])
        shapes = shapes_in(definition) if tag(definition) in ("g", "path") else []
        found = [fill_owner(shape, definition) for shape in shapes]
        owners = [owner for owner in found if owner is not None]
        if not clones or not owners or len(owners) < len(found) or any(clone.get("fill") for clone in clones):
            continue
        fill = owners[0].get("fill")
        if fill == "none":
            continue
        del owners[0].attrib["fill"]
        for clone in clones:
            clone.set("fill", fill)


def set_prefix(elements: list[etree._Element], prefix: str) -> None:
    """Make all ids unique in the document, and the references to them with them."""
    for top in elements:
        for element in top.iter():
            if not tag(element):
                continue
            for name, value in element.attrib.items():
                if name == "id":
                    element.set(name, f"{prefix}-{value}")
                elif name in (XLINK_HREF, "href") and value.startswith("#"):
                    element.set(name, f"#{prefix}-{value[1:]}")
                elif "url(#" in value:
                    element.set(name, URL.sub(rf"url(#{prefix}-\1)", value))
