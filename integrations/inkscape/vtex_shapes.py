# Part of the extension of vtex for Inkscape.
"""The shapes to fill and the swatch to copy: geometry of selected objects, in the units of the document."""

from __future__ import annotations

import copy
import math
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import inkex
from inkex import AbortExtension, Transform
from inkex.command import which
from lxml import etree
from vtex_boxes import EMPTY, Box, join, reference, tag
from vtex_program import Cache, run_command

TEXTS = {"text", "flowRoot"}
MAXIMUM_SIDE = 100_000
MAXIMUM_PIXELS = 400_000_000
INKSCAPE_SECONDS = 60


@dataclass
class Piece:
    """One filled path in the coordinates of the document's viewBox."""

    path: inkex.Path
    rule: str


@dataclass
class Canvas:
    """The pixels that vtex fills, and where they are in the document."""

    box: Box
    per_unit: float
    """Pixels of the canvas per unit of the document."""
    exact: bool = False
    """Fit the whole canvas to the box; otherwise the shape cuts off a part of the last pixel."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in whole pixels."""
        left, top, right, bottom = self.box
        width, height = (right - left) * self.per_unit, (bottom - top) * self.per_unit
        if self.exact:
            return max(1, round(width)), max(1, round(height))
        return max(1, math.ceil(width - 1e-6)), max(1, math.ceil(height - 1e-6))

    def check(self) -> None:
        """Refuse a canvas that is too large for vtex."""
        width, height = self.size
        if max(width, height) > MAXIMUM_SIDE or width * height > MAXIMUM_PIXELS:
            raise AbortExtension(
                f"The texture would have {width} x {height} px, which is too large.\nhint: raise the scale"
            )

    @property
    def to_pixels(self) -> Transform:
        """The transformation from the document to the canvas."""
        return Transform(scale=self.per_unit) @ Transform(translate=(-self.box[0], -self.box[1]))

    @property
    def to_document(self) -> Transform:
        """The transformation from the canvas to the document."""
        left, top, right, bottom = self.box
        width, height = self.size
        scale = ((right - left) / width, (bottom - top) / height) if self.exact else 1 / self.per_unit
        return Transform(translate=(left, top)) @ Transform(scale=scale)


def pixels_per_unit(svg: inkex.SvgDocumentElement) -> float:
    """Return how many CSS pixels (1/96 inch) one unit of the viewBox has on the page."""
    box = svg.get_viewbox()
    if len(box) != 4 or not all(box[2:]):
        return 1.0
    scales = []
    for name, side in zip(("width", "height"), box[2:], strict=True):
        length = svg.get(name)
        pixels = inkex.units.convert_unit(length, "px") if length and not length.strip().endswith("%") else 0
        if pixels:
            scales.append(pixels / side)
    return min(scales) if scales else 1.0


def page_box(svg: inkex.SvgDocumentElement) -> Box:
    """Return the page in the coordinates of the viewBox."""
    box = svg.get_viewbox()
    if len(box) == 4 and all(box[2:]):
        return box[0], box[1], box[0] + box[2], box[1] + box[3]
    width, height = (inkex.units.convert_unit(svg.get(name, "100"), "px") for name in ("width", "height"))
    return 0.0, 0.0, width, height


def has_text(element: inkex.BaseElement) -> bool:
    """Whether an object is or contains text."""
    return any(tag(child) in TEXTS for child in element.iter())


def with_outlined_text(svg: inkex.SvgDocumentElement, ids: list[str], cache: Cache) -> inkex.SvgDocumentElement:
    """Return a copy of the document with the text in these objects as paths, made by Inkscape."""
    texts = [child.get_id() for name in ids for child in svg.getElementById(name).iter() if tag(child) in TEXTS]
    content = etree.tostring(svg)

    def convert(output: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="vtex-") as folder:
            source = Path(folder) / "text.svg"
            source.write_bytes(content)
            actions = (
                f"select-by-id:{','.join(texts)};object-to-path;export-filename:{output};export-plain-svg;export-do"
            )
            command = [str(which("inkscape")), f"--actions={actions}", str(source)]
            code, _, errors = run_command(command, INKSCAPE_SECONDS)
            if code != 0 or not output.is_file():
                raise AbortExtension(
                    f"Inkscape could not convert the text to paths.\n{errors.strip()}\n"
                    "hint: select the text, choose Path > Object to Path, and try again"
                )

    path = cache.get([content.decode(), *texts], ".text.svg", convert)
    with open(path, "rb") as stream:
        return inkex.load_svg(stream).getroot()


def pieces(element: inkex.BaseElement) -> list[Piece]:
    """Return the filled paths of an object and of all objects in it."""
    parent = element.getparent()
    return list(walk(element, parent.composed_transform() if isinstance(parent, inkex.BaseElement) else Transform()))


def walk(element: inkex.BaseElement, outer: Transform, depth: int = 0) -> Iterator[Piece]:
    """Yield the paths of an object; `outer` transforms its parent's coordinates to the document's."""
    kind = tag(element)
    if not kind or depth > 50 or "display:none" in element.attrib.get("style", "").replace(" ", ""):
        return
    if kind == "image":
        raise AbortExtension(
            f"The object '{element.get_id()}' is an image, which has no outline to fill.\n"
            "hint: draw a rectangle or another shape over it and select this"
        )
    transform = outer
    if isinstance(element, (inkex.ShapeElement, inkex.Symbol)):
        transform = outer @ element.transform
    if kind == "use":
        target = element.root.getElementById(reference(element))
        if target is not None:
            place = Transform(translate=(float(element.attrib.get("x", 0)), float(element.attrib.get("y", 0))))
            yield from walk(target, transform @ place, depth + 1)
    elif kind in ("g", "a", "symbol", "switch"):
        for child in element:
            yield from walk(child, transform, depth + 1)
    elif isinstance(element, inkex.ShapeElement) and kind not in TEXTS:
        path = element.get_path()
        if path:
            rule = element.specified_style().get("fill-rule", "nonzero")
            yield Piece(inkex.Path(path).transform(transform), str(rule))


def box_of(parts: list[Piece]) -> Box:
    """Return the box around paths."""
    box = EMPTY
    for part in parts:
        found = part.path.bounding_box()
        if found is not None:
            box = join(box, (found.left, found.top, found.right, found.bottom))
    return box


def domain_svg(parts: list[Piece], canvas: Canvas) -> str:
    """Return an SVG of the shape for `vtex --domain`, as large as the canvas."""
    width, height = canvas.size
    paths = "".join(
        f'<path fill-rule="{part.rule}" d="{part.path.transform(canvas.to_pixels).to_absolute()}"/>' for part in parts
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}">{paths}</svg>'
    )


def referenced(svg: inkex.SvgDocumentElement, elements: list[etree._Element]) -> list[inkex.BaseElement]:
    """Return the originals of clones that are not among these elements themselves."""
    inside = {child.get("id") for element in elements for child in element.iter()}
    found: dict[str, inkex.BaseElement] = {}
    waiting = list(elements)
    while waiting:
        for use in waiting.pop().iter(inkex.addNS("use", "svg")):
            name = reference(use)
            target = svg.getElementById(name)
            if name not in inside and name not in found and target is not None:
                found[name] = target
                waiting.append(target)
    return [target for target in found.values() if target.getparent().tag != inkex.addNS("defs", "svg")]


def swatch_svg(svg: inkex.SvgDocumentElement, elements: list[inkex.BaseElement], page: Box) -> bytes:
    """Return an SVG of selected objects alone, whose page is `page` at its size in CSS pixels."""
    unit = pixels_per_unit(svg)
    left, top, right, bottom = page
    root = etree.Element(inkex.addNS("svg", "svg"), nsmap=dict(svg.nsmap))
    root.set("viewBox", f"{left} {top} {right - left} {bottom - top}")
    root.set("width", f"{(right - left) * unit:.6g}")
    root.set("height", f"{(bottom - top) * unit:.6g}")
    for child in svg:
        if tag(child) in ("defs", "style"):
            root.append(copy.deepcopy(child))
    originals = etree.SubElement(root, inkex.addNS("defs", "svg"))
    for original in referenced(svg, elements):
        originals.append(copy.deepcopy(original))
    for element in elements:
        parent = element.getparent()
        group = etree.SubElement(root, inkex.addNS("g", "svg"))
        group.set("transform", str(parent.composed_transform()))
        group.set("style", str(parent.specified_style()) if parent is not svg else svg.attrib.get("style", ""))
        group.append(copy.deepcopy(element))
    return etree.tostring(root)
