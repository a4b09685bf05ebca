#!/usr/bin/env python3
# Part of the extension of vtex for Inkscape.
"""Inkscape extension: make a texture of the selected objects."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import inkex
from inkex import AbortExtension
from vtex_boxes import Box
from vtex_extension import TextureExtension
from vtex_shapes import Canvas, Piece, box_of, page_box, pieces, swatch_svg

NOTHING = "Select the objects of the swatch, such as some leaves or lines, and try again."
GAP = 0.1
"""Distance from the swatch to the texture beside it, in widths of the swatch."""


class Swatch(TextureExtension):
    """Make a texture of the selected objects, and put it on the page, beside the objects or into a shape."""

    def add_arguments(self, pars: argparse.ArgumentParser) -> None:
        """Add the parameters of the dialog."""
        super().add_arguments(pars)
        pars.add_argument("--place", default="beside")
        pars.add_argument("--columns", type=float, default=3.0)
        pars.add_argument("--rows", type=float, default=3.0)
        pars.add_argument("--tile", type=inkex.Boolean, default=False)
        pars.add_argument("--page", default="selection")
        pars.add_argument("--lenient", type=inkex.Boolean, default=False)

    def effect(self) -> None:
        """Add one layer with the texture."""
        elements = self.selected()
        if not elements:
            raise AbortExtension(NOTHING)
        self.start()
        shape = elements.pop() if self.options.place == "shape" else None
        if not elements:
            raise AbortExtension("Select the objects of the swatch and, as the topmost object, the shape to fill.")
        fills = [element.get_id() for element in elements] + ([shape.get_id()] if shape is not None else [])
        self.remove_earlier(fills)
        drawn = self.outlined(elements)
        page = self.page_of(drawn)
        library = self.make_swatch(drawn, page)
        canvas, parts, position, extra = self.place(page, elements[-1], shape)
        self.add_texture(library, "selection", canvas, parts, self.options.seed, fills, position, extra)

    def page_of(self, drawn: list[inkex.BaseElement]) -> Box:
        """Return the page of the swatch: what vtex repeats or rearranges."""
        if self.options.page == "document":
            return page_box(self.svg)
        framing = drawn[:1] if self.options.page == "lowest" else drawn
        box = box_of([part for element in framing for part in pieces(element)])
        if not box[0] < box[2] or not box[1] < box[3]:
            raise AbortExtension(f"The selected objects have no area.\n{NOTHING}")
        return box

    def make_swatch(self, drawn: list[inkex.BaseElement], page: Box) -> Path:
        """Return the library of the selected objects."""
        with tempfile.TemporaryDirectory(prefix="vtex-") as folder:
            source = Path(folder) / "selection.svg"
            source.write_bytes(swatch_svg(drawn[0].root, drawn, page))
            return self.library(source, ["--lenient"] if self.options.lenient else [])

    def place(
        self, page: Box, highest: inkex.BaseElement, shape: inkex.BaseElement | None
    ) -> tuple[Canvas, list[Piece] | None, tuple[inkex.BaseElement, int], list[str]]:
        """Return the canvas, its shape, the place for the layer and further options."""
        if shape is not None:
            parts = self.shape_of([shape])
            return Canvas(box_of(parts), self.per_unit), parts, self.above(shape), []
        if self.options.place == "page":
            left, top, right, bottom = page_box(self.svg)
            path = inkex.Path(f"M{left} {top}H{right}V{bottom}H{left}Z")
            # Beneath everything, but after definitions and settings.
            index = next(
                (i for i, child in enumerate(self.svg) if isinstance(child, inkex.ShapeElement)), len(self.svg)
            )
            return Canvas((left, top, right, bottom), self.per_unit), [Piece(path, "nonzero")], (self.svg, index), []
        width, height = page[2] - page[0], page[3] - page[1]
        left = page[2] + GAP * width
        share = self.options.scale / 100
        box = left, page[1], left + self.options.columns * width * share, page[1] + self.options.rows * height * share
        return (
            Canvas(box, self.per_unit, exact=True),
            None,
            self.above(highest),
            ["--tile"] if self.options.tile else [],
        )


if __name__ == "__main__":
    Swatch().run()
