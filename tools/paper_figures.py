#!/usr/bin/env python3
"""Runs the commands of docs/papers.md and puts the pictures that they make on one sheet for each paper.

    tools/paper_figures.py [--vtex PROGRAM] [--only LETTERS] [--sheets FOLDER] [FOLDER]

FOLDER, by default target/papers, is where the commands run: beside the files of examples/exemplars, examples/drawings
and examples/maps, which are copied there. The sheets go into the same folder, or into that of --sheets, such as
docs/images. --only BT takes the rows whose numbers begin with B or T. It ends with 1 if a command failed.

Needs Pillow. All rows take some ten minutes on two cores.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import time

from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "papers.md"
EXAMPLES = ("exemplars/*.png", "drawings/*.svg", "maps/*.svg")
CELL, GAP, LINE, COLUMNS = 150, 4, 12, 8
LARGEST = 200_000


def parts(page):
    """The sections of the page: name of the sheet, commands before the table, rows as (number, commands, text)."""
    for section in re.split(r"^## ", page, flags=re.M)[1:]:
        sheet = re.search(r"\(images/(paper-[\w-]+\.jpg)\)", section)
        blocks = re.findall(r"^```sh\n(.*?)^```", section, flags=re.M | re.S)
        before = [line for block in blocks for line in block.splitlines() if line.startswith("vtex ")]
        rows = re.findall(r"^\| ([A-Z]\d+) \|(.*)\|$", section, flags=re.M)
        commands = [(number, re.findall(r"`(vtex [^`]*)`", text), text) for number, text in rows]
        yield sheet and sheet.group(1), before, commands


def pictures(text):
    """The files that a row shows: those it names that begin with the number of a row."""
    found = re.findall(r"\b([A-Z]\d+(?:-\w+)?(?:/[\w-]+)?\.(?:svg|png|gif))\b", text)
    return list(dict.fromkeys(found))


def label(number, name):
    """The name of a picture on the sheet, which begins with the number of its row."""
    stem = name.rsplit(".", 1)[0]
    return stem if stem.startswith(number) else f"{number} {stem.split('/')[-1]}"


def run(command, folder, program):
    """Runs a command, says how long it took, and whether it succeeded."""
    start = time.monotonic()
    shell = re.sub(r"^vtex ", f"'{program}' -q ", command)
    result = subprocess.run(shell, shell=True, cwd=folder, capture_output=True, text=True)
    print(f"{time.monotonic() - start:6.1f} s  {command}", flush=True)
    if result.returncode != 0:
        print(result.stderr, end="", file=sys.stderr)
    return result.returncode == 0


def read(path, program):
    """A picture as RGB on white; an SVG is drawn first, 16 bits become 8."""
    if path.suffix == ".svg":
        drawn = path.with_name(path.name + ".cell.png")
        subprocess.run([program, "-q", "render", path, "-o", drawn, "--width", str(2 * CELL), "-f"], check=True)
        path = drawn
    picture = Image.open(path)
    if picture.mode.startswith("I"):
        picture = picture.convert("I").point(lambda v: v / 257).convert("L")
    picture = picture.convert("RGBA")
    white = Image.new("RGBA", picture.size, "white")
    white.alpha_composite(picture)
    return white.convert("RGB")


def save_sheet(cells, path, program):
    """Pictures beneath their names, in rows, as a JPEG below the largest size."""
    rows = -(-len(cells) // COLUMNS)
    size = (COLUMNS * (CELL + GAP) - GAP, rows * (CELL + LINE + GAP) - GAP)
    sheet = Image.new("RGB", size, "white")
    draw = ImageDraw.Draw(sheet)
    for k, (name, file) in enumerate(cells):
        x, y = k % COLUMNS * (CELL + GAP), k // COLUMNS * (CELL + LINE + GAP)
        picture = read(file, program)
        picture.thumbnail((CELL, CELL), Image.Resampling.LANCZOS)
        draw.text((x + 1, y), name, fill="black")
        sheet.paste(picture, (x, y + LINE))
    for quality in range(86, 30, -4):
        sheet.save(path, quality=quality, optimize=True)
        if path.stat().st_size < LARGEST:
            break
    print(f"{path}: {len(cells)} pictures, {path.stat().st_size // 1000} kB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=ROOT / "target" / "papers")
    parser.add_argument("--vtex", default="vtex")
    parser.add_argument("--only", default="")
    parser.add_argument("--sheets", type=pathlib.Path)
    options = parser.parse_args()
    program = shutil.which(options.vtex) or sys.exit(f"no program {options.vtex}")
    program = str(pathlib.Path(program).resolve())
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for pattern in EXAMPLES:
        for file in (ROOT / "examples").glob(pattern):
            shutil.copy(file, folder)
    failed = []
    for sheet, before, rows in parts(PAGE.read_text()):
        rows = [row for row in rows if not options.only or row[0][0] in options.only]
        needed = sheet is None or rows
        failed += [command for command in before if needed and not run(command, folder, program)]
        cells = []
        for number, commands, text in rows:
            failed += [command for command in commands if not run(command, folder, program)]
            for name in pictures(text):
                if not (folder / name).exists():
                    failed.append(f"{number}: no {name}")
                elif all(folder / name != shown for _, shown in cells):
                    cells.append((label(number, name), folder / name))
        if cells:
            save_sheet(cells, (options.sheets or folder) / sheet, program)
    for command in failed:
        print(f"failed: {command}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
