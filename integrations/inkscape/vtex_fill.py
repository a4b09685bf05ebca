#!/usr/bin/env python3
# Part of the extension of vtex for Inkscape.
"""Inkscape extension: fill the selected shapes with a texture."""

from __future__ import annotations

import argparse
from pathlib import Path

import inkex
from inkex import AbortExtension
from vtex_extension import TextureExtension
from vtex_shapes import Canvas, box_of

NOTHING = """Select the shape to fill, such as a path, a rectangle, a text or a group, and try again."""
NO_SOURCE = """Choose what the texture is made from: a photograph, a library of vtex (.lib.json) or an SVG swatch."""


class Fill(TextureExtension):
    """Fill each selected shape, or all together, with a texture from a file."""

    def add_arguments(self, pars: argparse.ArgumentParser) -> None:
        """Add the parameters of the dialog."""
        super().add_arguments(pars)
        pars.add_argument("--source", default="")
        pars.add_argument("--together", type=inkex.Boolean, default=False)

    def effect(self) -> None:
        """Add one layer for each shape."""
        elements = self.selected()
        if not elements:
            raise AbortExtension(NOTHING)
        if not self.options.source.strip():
            raise AbortExtension(NO_SOURCE)
        source = Path(self.options.source.strip()).expanduser()
        if not source.is_file():
            raise AbortExtension(f"'{source}' is not a file.\n{NO_SOURCE}")
        self.start()
        library = self.library(source)
        name = source.name.partition(".")[0]
        groups = [elements] if self.options.together else [[element] for element in elements]
        # All shapes first: text is converted in a copy of the document, best before it grows.
        shapes = [self.shape_of(group) for group in groups]
        for offset, (group, parts) in enumerate(zip(groups, shapes, strict=True)):
            fills = [element.get_id() for element in group]
            self.remove_earlier(fills)
            box = box_of(parts)
            if not box[0] < box[2] or not box[1] < box[3]:
                raise AbortExtension(f"The object '{' '.join(fills)}' has no area to fill.\n{NOTHING}")
            canvas = Canvas(box, self.per_unit)
            self.add_texture(library, name, canvas, parts, self.options.seed + offset, fills, self.above(group[-1]))


if __name__ == "__main__":
    Fill().run()
