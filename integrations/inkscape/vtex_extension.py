# Part of the extension of vtex for Inkscape.
"""What the entries "Fill with a texture" and "Make a texture of the selection" have in common."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import inkex
from lxml import etree
from vtex_boxes import tag
from vtex_program import Cache, Program, make_library, make_texture
from vtex_shapes import Canvas, Piece, domain_svg, pieces, pixels_per_unit, with_outlined_text
from vtex_shapes import has_text as contains_text
from vtex_texture import GROUPMODE, LABEL, PAINTED, SVG, TEXTURE, TextureLayer, read_texture

FILLS = "data-vtex-fills"
"""The ids of the objects that a texture was made for."""
ANALYSIS_SEED = "1"
PRESENTATION = (
    *("fill", "fill-opacity", "fill-rule", "opacity", "stroke", "stroke-linecap", "stroke-linejoin"),
    *("stroke-opacity", "stroke-width", "stop-color", "stop-opacity"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the parameters that both entries have."""
    parser.add_argument("--tab", help="page of the dialog")
    parser.add_argument("--scale", type=float, default=100.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quality", default="default")
    parser.add_argument("--shading", default="flat")
    parser.add_argument("--edge", default="clip")
    parser.add_argument("--group", default="category")
    parser.add_argument("--merge", type=inkex.Boolean, default=False)
    parser.add_argument("--clones", type=inkex.Boolean, default=True)
    parser.add_argument("--replace", type=inkex.Boolean, default=True)
    parser.add_argument("--program", default="")
    parser.add_argument("--limit", type=float, default=120.0)


def textures(svg: inkex.SvgDocumentElement) -> list[inkex.BaseElement]:
    """Return all layers that this extension made."""
    return [element for element in svg.iter(f"{SVG}g") if element.get(TEXTURE)]


def free_prefix(svg: inkex.SvgDocumentElement) -> str:
    """Return a prefix that no id of the document has."""
    # Not svg.get_ids(): that list is not renewed when elements are added.
    used = {(element.attrib.get("id") or "").partition("-")[0] for element in svg.iter()}
    number = 1
    while f"vtex{number}" in used:
        number += 1
    return f"vtex{number}"


def remove_texture(layer: inkex.BaseElement) -> None:
    """Remove a layer that this extension made, with its definitions."""
    prefix = f"{layer.get(TEXTURE)}-"
    for element in list(layer.root.defs):
        if tag(element) and (element.get("id") or "").startswith(prefix):
            element.getparent().remove(element)
    layer.getparent().remove(layer)


def shield_from_styles(tops: list[etree._Element]) -> None:
    """Write attributes as styles, so that style rules of the document do not change the texture."""
    for top in tops:
        for element in top.iter():
            if not tag(element):
                continue
            rules = [f"{name}:{element.attrib.pop(name)}" for name in PRESENTATION if name in element.attrib]
            if tag(element) in PAINTED:
                present = {rule.partition(":")[0] for rule in rules}
                rules += [f"{name}:inherit" for name in ("fill", "stroke") if name not in present]
            if rules:
                element.set("style", ";".join(rules))


def clip_to_canvas(made: TextureLayer, canvas: Canvas) -> None:
    """Cut off what reaches beyond the canvas, as the page of an SVG does."""
    width, height = canvas.size
    clip = etree.Element(f"{SVG}clipPath", {"id": f"{made.layer.get(TEXTURE)}-canvas"})
    etree.SubElement(clip, f"{SVG}rect", {"width": str(width), "height": str(height)})
    made.definitions.append(clip)
    made.layer.set("clip-path", f"url(#{clip.get('id')})")


class TextureExtension(inkex.EffectExtension):
    """An extension that adds textures to the document."""

    def add_arguments(self, pars: argparse.ArgumentParser) -> None:
        """Add the parameters of the dialog."""
        add_arguments(pars)

    def start(self) -> None:
        """Find the program and the cache, once the parameters are known."""
        self.program = Program(self.options.program, self.options.limit)
        self.cache = Cache()
        self.per_unit = pixels_per_unit(self.svg) * 100 / self.options.scale

    def selected(self) -> list[inkex.BaseElement]:
        """Return the selected objects in painting order, without textures made before."""
        made = textures(self.svg)
        order = {element: index for index, element in enumerate(self.svg.iter())}
        chosen = [
            element
            for element in self.svg.selection.values()
            if element not in made and not any(parent in made for parent in element.iterancestors())
        ]
        return sorted(chosen, key=lambda element: order[element])

    def outlined(self, elements: list[inkex.BaseElement]) -> list[inkex.BaseElement]:
        """Return these objects, from a copy of the document with text as paths if they contain text."""
        if not any(contains_text(element) for element in elements):
            return elements
        ids = [element.get_id() for element in elements]
        copied = with_outlined_text(self.svg, ids, self.cache)
        return [found for found in (copied.getElementById(name) for name in ids) if found is not None]

    def library(self, source: Path, extra: list[str] | None = None) -> Path:
        """Return the library of a photograph, a swatch or a library."""
        options = ["--preset", self.options.quality, "--shading", self.options.shading, "--seed", ANALYSIS_SEED]
        return make_library(self.program, self.cache, source, options + (extra or []))

    def add_texture(
        self,
        library: Path,
        name: str,
        canvas: Canvas,
        parts: list[Piece] | None,
        seed: int,
        fills: list[str],
        position: tuple[inkex.BaseElement, int],
        extra: list[str] | None = None,
    ) -> None:
        """Add a layer with a texture of this canvas, within the shape of these paths."""
        canvas.check()
        width, height = canvas.size
        options = [
            "--size",
            f"{width}x{height}",
            "--seed",
            str(seed),
            "--precision",
            str(self.decimals()),
            *(extra or []),
        ]
        if parts is not None:
            options += ["--edge", self.options.edge]
        if not self.options.clones:
            options += ["--expand"]
        domain = domain_svg(parts, canvas) if parts is not None else None
        root = read_texture(make_texture(self.program, self.cache, library, domain, options))
        made = TextureLayer(root, free_prefix(self.svg), self.options.group == "category", self.options.merge)
        if self.svg.xpath("//svg:style"):
            shield_from_styles([made.layer, *made.definitions])
        if parts is None:
            clip_to_canvas(made, canvas)
        parent, index = position
        made.layer.set("transform", str(-parent.composed_transform() @ canvas.to_document))
        made.layer.set(LABEL, f"Texture: {name}")
        made.layer.set(FILLS, " ".join(fills))
        description = etree.Element(f"{SVG}desc")
        description.text = f"Made by vtex from {name}, seed {seed}, scale {self.options.scale:g} %"
        made.layer.insert(0, description)
        parent.insert(index, made.layer)
        self.svg.defs.extend(made.definitions)

    def decimals(self) -> int:
        """Return the decimals of coordinates: about a tenth of a pixel of the document."""
        return min(4, 1 + max(0, math.ceil(math.log10(self.options.scale / 100) - 1e-9)))

    def remove_earlier(self, fills: list[str]) -> None:
        """Remove the texture that was made for the same objects before."""
        for layer in textures(self.svg):
            if self.options.replace and layer.get(FILLS) == " ".join(fills):
                remove_texture(layer)

    def above(self, element: inkex.BaseElement) -> tuple[inkex.BaseElement, int]:
        """Return the place for a layer above an object: in the object's own layer, after the object or its group."""
        child = element
        parent = element.getparent()
        while parent.getparent() is not None and parent.get(GROUPMODE) != "layer":
            child, parent = parent, parent.getparent()
        return parent, parent.index(child) + 1

    def shape_of(self, elements: list[inkex.BaseElement]) -> list[Piece]:
        """Return the filled paths of objects; text is converted."""
        return [part for element in self.outlined(elements) for part in pieces(element)]
