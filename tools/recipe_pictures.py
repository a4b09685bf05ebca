#!/usr/bin/env python3
"""Runs the commands of docs/recipes.md and makes the picture of each recipe from their files.

    tools/recipe_pictures.py [--vtex PROGRAM] [--only NAME] [--pictures FOLDER] [FOLDER]

FOLDER, by default target/recipes, is where the commands run. Each recipe has a folder there, with one of
examples/exemplars as photo.jpg. The pictures go to docs/images, or to the folder of --pictures. --only makes one
picture, such as `tile`. recipe-correct.jpg shows the studio: tests/studio/run makes it.

Needs Pillow. All pictures take about two minutes on two cores.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "recipes.md"
GAP = 8
QUALITY = 82
LARGEST_BYTES = 60_000
LARGEST_WIDTH = 900
# The page of a word, as a drawing program saves it after text is converted to paths.
WORD = """<svg xmlns="http://www.w3.org/2000/svg" width="900" height="300" viewBox="0 0 900 300">
<path d="M10 20H95L140 185L185 20H270L185 280H95Z"/>
<path d="M285 20H475V90H420V280H340V90H285Z"/>
<path d="M505 20H660V88H583V117H648V183H583V212H660V280H505Z"/>
<path d="M675 20H764L787 83L810 20H895L834 150L895 280H806L783 217L760 280H670L734 150Z"/>
</svg>"""

Part = tuple[Image.Image, str]


class Workspace:
    """A folder in which the commands of a recipe run."""

    def __init__(self, folder: Path, program: str, exemplar: str) -> None:
        self.folder = folder
        self.program = program
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        # vtex detects the file type from the content.
        shutil.copy(ROOT / "examples" / "exemplars" / f"{exemplar}.png", folder / "photo.jpg")

    def run(self, command: str) -> None:
        """Run a line of a shell, with this program as `vtex`."""
        command = re.sub(r"^vtex ", f"'{self.program}' -q ", command)
        subprocess.run(command, shell=True, cwd=self.folder, check=True, stdout=subprocess.DEVNULL)

    def recipe(self, name: str, *changes: tuple[str, str]) -> None:
        """Run the commands of a recipe; changes replace a text that they contain."""
        text = commands(name)
        for old, new in changes:
            if old not in text:
                raise ValueError(f"the recipe {name} has no {old}")
            text = text.replace(old, new)
        for line in text.splitlines():
            # With a seed, each run makes the same pictures.
            self.run(f"{line} --seed 1" if line.startswith("vtex analyze ") else line)

    def picture(self, name: str, side: int | None = None, box: tuple[int, int, int, int] | None = None) -> Image.Image:
        """Open a picture on white; draw it first if it has no pixels. A box is a part of it."""
        path = self.folder / name
        if path.suffix in (".svg", ".svgz"):
            drawn = path.with_name(path.name + ".drawn.png")
            self.run(f"vtex render '{path}' -o '{drawn}' --scale 4 -f")
            path = drawn
        picture = Image.open(path).convert("RGBA")
        white = Image.new("RGBA", picture.size, "white")
        white.alpha_composite(picture)
        picture = white.convert("RGB").crop(box)
        size = (side, side * picture.height // picture.width) if side else picture.size
        return picture.resize(size, Image.Resampling.LANCZOS)


def commands(name: str) -> str:
    """Return the block of a recipe, by its mark."""
    found = re.search(rf"^<!-- test: recipe_{name} -->\n```sh\n(.*?)^```", PAGE.read_text(), flags=re.M | re.S)
    if not found:
        raise ValueError(f"{PAGE} has no recipe {name}")
    return found.group(1)


def labelled(picture: Image.Image, label: str) -> Image.Image:
    """Put a line of text below a picture."""
    if not label:
        return picture
    result = Image.new("RGB", (picture.width, picture.height + 22), "white")
    result.paste(picture)
    font = ImageFont.load_default(14)
    ImageDraw.Draw(result).text((picture.width / 2, picture.height + 12), label, fill="#222", font=font, anchor="mm")
    return result


def grid(parts: list[Part], columns: int) -> Image.Image:
    """Put labelled pictures of one size in rows."""
    cells = [labelled(*part) for part in parts]
    width, height = cells[0].size
    rows = -(-len(cells) // columns)
    result = Image.new("RGB", (columns * (width + GAP) - GAP, rows * (height + GAP) - GAP), "white")
    for index, cell in enumerate(cells):
        result.paste(cell, (index % columns * (width + GAP), index // columns * (height + GAP)))
    return result


def copies(tile: Image.Image, columns: int, rows: int) -> Image.Image:
    """Repeat a tile without a gap."""
    result = Image.new("RGB", (tile.width * columns, tile.height * rows))
    for x in range(columns):
        for y in range(rows):
            result.paste(tile, (x * tile.width, y * tile.height))
    return result


def tile(workspace: Workspace) -> Image.Image:
    """Show the photograph, one tile, and four copies of it, at one scale."""
    workspace.recipe("tile")
    photo, one = workspace.picture("photo.jpg", 225), workspace.picture("seamless.png", 132)
    parts = (photo, one, copies(one, 2, 2))
    height = max(part.height for part in parts)
    result = Image.new("RGB", (sum(part.width + 2 * GAP for part in parts) - 2 * GAP, height), "white")
    x = 0
    for part in parts:
        result.paste(part, (x, (height - part.height) // 2))
        x += part.width + 2 * GAP
    return result


def print_at_3m(workspace: Workspace) -> Image.Image:
    """Show the whole page, with a frame around a part of it, and this part enlarged."""
    workspace.recipe("tile")
    # The page is a PDF; the recipe names a PNG of the same size instead.
    workspace.recipe("print", ("-o poster.pdf", "-o poster.png --scale 4"))
    poster = workspace.picture("poster.png")
    width, side, part = 660, 220, poster.width // 22
    left, top = int(0.43 * poster.width), int(0.42 * poster.height)
    whole = poster.resize((width, width * poster.height // poster.width), Image.Resampling.LANCZOS)
    shown = [place * width / poster.width for place in (left, top, left + part, top + part)]
    ImageDraw.Draw(whole).rectangle(shown, outline="white", width=2)
    detail = poster.crop((left, top, left + part, top + part)).resize((side, side), Image.Resampling.LANCZOS)
    result = Image.new("RGB", (width + GAP + side, side), "white")
    result.paste(whole, (0, 0))
    result.paste(detail, (width + GAP, 0))
    return result


def game(workspace: Workspace) -> Image.Image:
    """Repeat the tile on a plane, seen in perspective."""
    workspace.recipe("tile")
    workspace.recipe("game")
    side, count = 512, 8
    plane = copies(workspace.picture("ground-1024.png", side), count, count)
    # Drawn three times as large, then reduced, so that distant stones are smooth.
    width, height = 3 * 660, 3 * 250
    horizon = height / 3
    # The lower edge shows two tiles, the upper one eight.
    spread = 2 * side * (height + horizon) / width
    far = plane.height
    across = (spread / horizon, far / 2 / horizon, far / 2 - width / 2 * spread / horizon)
    along = (0, far / horizon, far - spread * width / horizon)
    seen = plane.transform(
        (width, height),
        Image.Transform.PERSPECTIVE,
        (*across, *along, 0, 1 / horizon),
        Image.Resampling.BILINEAR,
    )
    return seen.reduce(3)


def programs(workspace: Workspace) -> Image.Image:
    """Show the SVG, and each of its layers alone."""
    workspace.recipe("tile")
    workspace.recipe("programs")
    text = (workspace.folder / "for-inkscape.svg").read_text()
    layers = re.findall(r'<g id="([^"]*)" inkscape:groupmode="layer" inkscape:label="([^"]*)"', text)
    parts = [(workspace.picture("for-inkscape.svg", 200), "all layers")]
    for shown, label in layers:
        alone = text
        for hidden in {layer for layer, _ in layers} - {shown}:
            alone = alone.replace(f'<g id="{hidden}"', f'<g id="{hidden}" display="none"')
        (workspace.folder / f"{shown}.svg").write_text(alone)
        parts.append((workspace.picture(f"{shown}.svg", 200), label))
    return grid(parts, len(parts))


def small(workspace: Workspace) -> Image.Image:
    """Show the same part of each file, with its size."""
    workspace.recipe("tile")
    workspace.recipe("small")
    parts = []
    for name in ("packed.svgz", "light.svgz", "light.svg"):
        size = (workspace.folder / name).stat().st_size
        parts.append((workspace.picture(name, 288, (560, 480, 1160, 1080)), f"{name}, {size / 1000:.0f} kB"))
    return grid(parts, 3)


def colourways(workspace: Workspace) -> Image.Image:
    """Show the tile and its two colourways."""
    workspace.recipe("tile")
    workspace.recipe("colourways")
    workspace.run("vtex render tile.scene.json -o tile.png")
    return grid([(workspace.picture(f, 210), f) for f in ("tile.png", "night.svg", "warm.svg")], 3)


def fill(workspace: Workspace) -> Image.Image:
    """Show the filled word."""
    workspace.recipe("tile")
    (workspace.folder / "shape.svg").write_text(WORD)
    # The recipe asks for the proportions of the page.
    workspace.recipe("fill", ("--size 300", "--size 900x300"))
    return workspace.picture("filled.svg", 840)


def plotter(workspace: Workspace) -> Image.Image:
    """Show the texture and its drawing of lines."""
    workspace.recipe("tile")
    workspace.recipe("colourways")
    workspace.recipe("plotter")
    workspace.run("vtex render tile.scene.json -o tile.png --scale 2")
    return grid([(workspace.picture("tile.png", 256), ""), (workspace.picture("plot.svg", 256), "")], 2)


def batch(workspace: Workspace) -> Image.Image:
    """Show six of the variants."""
    found = re.search(r"`(vtex texture [^`]* --variants )100`", PAGE.read_text())
    if not found:
        raise ValueError(f"{PAGE} makes no variants")
    workspace.run(f"{found.group(1)}6 --seed 1")
    made = sorted(file.name for file in workspace.folder.glob("tile*.svg"))
    return grid([(workspace.picture(name, 160), "") for name in made], 3)


RECIPES: dict[str, tuple[str, Callable[[Workspace], Image.Image]]] = {
    "tile": ("terrazzo", tile),
    "print": ("concrete", print_at_3m),
    "game": ("pebbles", game),
    "programs": ("flowers", programs),
    "small": ("pebbles", small),
    "colourways": ("terrazzo", colourways),
    "fill": ("leaves", fill),
    "plotter": ("terrazzo", plotter),
    "batch": ("flowers", batch),
}


def save(picture: Image.Image, path: Path) -> None:
    """Save a picture as JPEG, and check its size."""
    picture.save(path, quality=QUALITY, optimize=True)
    size = path.stat().st_size
    print(f"{path}: {picture.width} x {picture.height} px, {size / 1000:.0f} kB")
    if picture.width > LARGEST_WIDTH or size > LARGEST_BYTES:
        raise ValueError(f"{path} is too large")


def main() -> None:
    """Make the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "target" / "recipes")
    parser.add_argument("--vtex", default="vtex")
    parser.add_argument("--only", choices=RECIPES)
    parser.add_argument("--pictures", type=Path, default=ROOT / "docs" / "images")
    options = parser.parse_args()
    program = shutil.which(options.vtex) or sys.exit(f"no program {options.vtex}")
    for name, (exemplar, make) in RECIPES.items():
        if options.only in (None, name):
            workspace = Workspace(options.folder.resolve() / name, str(Path(program).resolve()), exemplar)
            save(make(workspace), options.pictures / f"recipe-{name}.jpg")


if __name__ == "__main__":
    main()
