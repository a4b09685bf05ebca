#!/usr/bin/env python3
# Part of the extension of vtex for Inkscape.
"""Inkscape extension: recolour the categories of a texture."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

import inkex
from inkex import AbortExtension
from vtex_boxes import tag
from vtex_colour import Lab, parse, shifted, to_hex, to_lab
from vtex_extension import FILLS, textures
from vtex_repaint import Found, Repainter, find_categories
from vtex_texture import BACKGROUND, category_of

NOTHING = """There is no texture of vtex here.

Select a texture, or something in it. A texture is a layer that "Fill with a texture..." or "Make a texture of the \
selection..." made, or an SVG that vtex wrote."""
COLOUR = re.compile(r"#[0-9a-fA-F]{6}\b|#[0-9a-fA-F]{3}\b")


class Recolour(inkex.EffectExtension):
    """Set one category to a colour, or all to a palette; shading stays."""

    def add_arguments(self, pars: argparse.ArgumentParser) -> None:
        """Add the parameters of the dialog."""
        pars.add_argument("--tab", default="category")
        pars.add_argument("--category", default="")
        pars.add_argument("--colour", type=inkex.Color, default=inkex.Color("#c04020"))
        pars.add_argument("--palette", default="")
        pars.add_argument("--palette_file", default="")
        pars.add_argument("--background", type=inkex.Boolean, default=True)
        pars.add_argument("--keep", type=inkex.Boolean, default=True)
        pars.add_argument("--only", type=inkex.Boolean, default=False)

    def effect(self) -> None:
        """Change colours, or report the categories."""
        found = find_categories(self.svg, self.chosen())
        if not found:
            raise AbortExtension(NOTHING)
        if self.options.tab == "list":
            inkex.errormsg(listing(found))
        elif self.options.tab == "palette":
            self.set_palette(found)
        else:
            self.set_category(found)

    def chosen(self) -> list[inkex.BaseElement]:
        """Return the selected objects or the whole textures they belong to; without a selection, all textures."""
        selected = list(self.svg.selection.values())
        made = textures(self.svg)
        if selected and self.options.only:
            return selected
        chosen = []
        for element in selected:
            around = [parent for parent in [element, *element.iterancestors()] if parent in made]
            around = around or [layer for layer in made if element.get_id() in layer.get(FILLS, "").split()]
            top = around[0] if around else element
            if not around and any(category_of(parent) for parent in element.iterancestors()):
                top = self.svg  # An SVG of vtex, opened itself.
            if top not in chosen:
                chosen.append(top)
        return chosen or made or [self.svg]

    def set_category(self, found: dict[str, Found]) -> None:
        """Turn the main colour of one category into the chosen one."""
        wanted = self.options.category.strip()
        matching = [entry for entry in found.values() if wanted.lower() in (entry.key.lower(), entry.name.lower())]
        if not matching:
            problem = f"There is no category '{wanted}'." if wanted else "Write the number or the name of a category."
            raise AbortExtension(f"{problem}\n\n{listing(found)}")
        target = to_lab(to_hex(*(int(value) for value in self.options.colour.to_rgb()[:3])))
        for entry in matching:
            self.shift(entry, target)

    def set_palette(self, found: dict[str, Found]) -> None:
        """Give each category a colour of the palette, dark by dark and light by light."""
        colours = sorted((to_lab(colour) for colour in self.palette()), key=lambda lab: lab[0])
        entries = [entry for entry in found.values() if self.options.background or entry.key != BACKGROUND]
        entries = sorted((entry for entry in entries if entry.main), key=lambda entry: (entry.main or (0.0,))[0])
        for place, entry in enumerate(entries):
            share = place / (len(entries) - 1) if len(entries) > 1 else 0.5
            self.shift(entry, colours[round(share * (len(colours) - 1))])

    def palette(self) -> list[str]:
        """Return the colours that the dialog or a file lists."""
        text = self.options.palette.strip()
        if text:
            return [to_hex(*parse(word)) for word in re.split(r"[\s,;]+", text) if word]
        named = self.options.palette_file.strip()
        if not named or not Path(named).is_file():
            raise AbortExtension("Write the colours of the palette, such as #1d3557 #a8dadc, or choose a file.")
        content = Path(named).read_text("utf-8", errors="replace")
        if content.startswith("GIMP Palette"):
            rows = re.findall(r"^\s*(\d+)\s+(\d+)\s+(\d+)", content, re.MULTILINE)
            colours = [to_hex(*(min(int(value), 255) for value in row)) for row in rows]
        else:
            colours = COLOUR.findall(content)
        if not colours:
            raise AbortExtension(f"'{named}' contains no colours.\nhint: write #rrggbb, or use a GIMP palette (.gpl)")
        return colours

    def shift(self, entry: Found, target: Lab) -> None:
        """Change all colours of a category as its main colour changes."""
        main = entry.main
        if main is None:
            raise AbortExtension(f"The category '{entry.name}' has no colour to change.")
        repainter = Repainter(self.svg, lambda colour: shifted(colour, main, target, self.options.keep))
        painted = set()
        for element in entry.elements:
            # A group around an element can set its fill.
            for owner in [element, *element.iterancestors()]:
                if owner in painted or (owner is not element and not sets_only_fill(owner)):
                    break
                painted.add(owner)
                if owner is element:
                    repainter.paint(element)
                else:
                    repainter.paint_alone(owner)
        repainter.remove_unused()


def sets_only_fill(element: inkex.BaseElement) -> bool:
    """Whether an element is a group that gives its children a fill."""
    return tag(element) == "g" and "fill" in element.attrib


def listing(found: dict[str, Found]) -> str:
    """Return a table of the categories, by number; what has no number follows."""
    entries = sorted(found.values(), key=lambda entry: (not entry.key.isdigit(), entry.key.zfill(9)))
    return "\n".join(["Categories: number, name, colour", *(entry.describe() for entry in entries)])


if __name__ == "__main__":
    Recolour().run()
