# Part of the plug-in of vtex for GIMP.
"""The part of the plug-in that does not need GIMP: commands of vtex, running them, and their results."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path
from typing import Any

SVG = "{http://www.w3.org/2000/svg}"
MISSING = (
    "The program vtex was not found. Install it, or write its path into the field 'Program', "
    "or set the environment variable VTEX. Searched: {searched}"
)
# `vtex integrate gimp` may write the program's path into this file beside the plug-in.
PATH_FILE = Path(__file__).with_name("vtex_program.txt")
PULSE_SECONDS = 0.1


class VtexError(Exception):
    """A message for the user."""


def find_program(named: str) -> str:
    """Return the path of vtex: from the dialog, VTEX, the file beside the plug-in, PATH, or a usual folder."""
    name = "vtex.exe" if sys.platform == "win32" else "vtex"
    if named.strip():
        candidates = [os.path.expanduser(named.strip())]
    else:
        written = PATH_FILE.read_text("utf-8").strip() if PATH_FILE.is_file() else ""
        folders = (
            Path.home() / ".cargo/bin",
            Path.home() / ".local/bin",
            Path("/usr/local/bin"),
            Path("/opt/homebrew/bin"),
        )
        candidates = [os.environ.get("VTEX", ""), written, name, *(str(folder / name) for folder in folders)]
    candidates = [candidate for candidate in candidates if candidate]
    for candidate in candidates:
        found = shutil.which(candidate)
        if found:
            return found
    raise VtexError(MISSING.format(searched=", ".join(candidates)))


def texture_command(source: str, output: str, settings: dict[str, Any]) -> list[str]:
    """Return the arguments that make a texture: of elements, or of pixels."""
    size = f"{settings['width']}x{settings['height']}"
    common = [source, "-o", output, "--size", size, "--seed", str(settings["seed"])]
    if settings["tile"] != "none":
        common.append(f"--tile={settings['tile']}")
    if settings["method"] == "pixels":
        return ["raster", *common]
    return ["texture", *common, "--preset", settings["quality"]]


def hole_command(source: str, hole: str, output: str, seed: int) -> list[str]:
    """Return the arguments that make the white part of `hole` again."""
    return ["raster", source, "-o", output, "--hole", hole, "--seed", str(seed)]


def path_command(source: str, output: str, settings: dict[str, Any]) -> list[str]:
    """Return the arguments that draw the elements of a picture, each as one path without details."""
    return [
        *("vectorize", source, "-o", output, "--preset", "poster", "--shading", "flat", "--expand"),
        # With fewer paths than elements, vtex leaves out details and small elements between them.
        *("--max-paths", "1", "--minimum-area", str(settings["smallest"]), "--seed", str(settings["seed"])),
    ]


def run(program: str, arguments: list[str], limit: float, pulse: Callable[[], None]) -> dict[str, Any]:
    """Run vtex and return its summary; `pulse` is called while it works."""
    command = [program, *arguments, "--force", "--json", "--quiet", "--color", "never"]
    flags = getattr(subprocess, "CREATE_NO_WINDOW", 0)  # Only on Windows.
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            creationflags=flags,
        )
    except OSError as error:
        raise VtexError(f"Cannot start '{program}': {error.strerror}") from error
    start = time.monotonic()
    try:
        while True:
            try:
                output, errors = process.communicate(timeout=PULSE_SECONDS)
                break
            except subprocess.TimeoutExpired:
                pulse()
            if time.monotonic() - start > limit:
                raise VtexError(
                    f"vtex took longer than {limit:.0f} s and was stopped. "
                    "Choose the quality 'draft' or a smaller size, or raise the time limit."
                )
    finally:
        if process.poll() is None:
            process.kill()
            process.communicate()
    if process.returncode != 0:
        raise VtexError(errors.strip() or f"vtex ended with the code {process.returncode} and no message.")
    try:
        summary: dict[str, Any] = json.loads(output)
        return summary
    except ValueError as error:
        raise VtexError(f"'{program}' is not vtex: it wrote no summary.") from error


def paths_svg(svg: str, offset: tuple[int, int], image: tuple[int, int]) -> str:
    """Return an SVG as large as the image, with the elements of a vtex SVG at the position of their layer.

    GIMP reads only paths, so the background, which is a surface and not an outline, is left out.
    """
    root = ET.fromstring(svg)
    width, height = image
    moved = ET.Element(f"{SVG}g", {"transform": f"translate({offset[0]},{offset[1]})"})
    for layer in root.findall(f"{SVG}g"):
        if layer.get("id", "").rpartition("-")[2] != "background":
            moved.append(layer)
    if not any(element.tag == f"{SVG}path" for element in moved.iter()):
        raise VtexError("vtex found no elements here. Select a larger part, or lower the smallest element.")
    made = ET.Element(f"{SVG}svg", {"width": str(width), "height": str(height), "viewBox": f"0 0 {width} {height}"})
    made.append(moved)
    ET.register_namespace("", SVG.strip("{}"))
    return ET.tostring(made, encoding="unicode")
