"""Unpack an archive of a release and use what is in it.

Usage: try_archive.py ARCHIVE
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# The layers of a texture.
LAYERS = ["background", "secondary", "primary"]


def check(condition: bool, message: str) -> None:
    """End with a message unless the condition is true."""
    if not condition:
        sys.exit(f"error: {message}")


def try_archive(archive: Path, folder: Path) -> None:
    """Make a texture of the photograph in the archive, and look at the other files."""
    shutil.unpack_archive(archive, folder)
    content = folder / archive.name.removesuffix(".zip").removesuffix(".tar.gz")
    program = content / ("vtex.exe" if archive.suffix == ".zip" else "vtex")
    version = subprocess.check_output([program, "--version"], text=True).strip()
    check(content.name.endswith("-v" + version.removeprefix("vtex ")), f"{version} in {archive.name}")

    texture = folder / "terrazzo.svg"
    photo = content / "terrazzo.png"
    subprocess.check_call([program, "texture", photo, "-o", texture, "--size", "1000", "--seed", "1"])
    svg = texture.read_text("utf-8")
    check(len(svg) >= 50_000, f"the SVG has only {len(svg)} characters")
    for layer in LAYERS:
        check(f'id="{layer}"' in svg, f"the SVG has no layer '{layer}'")

    pages = list((content / "man").glob("*.1"))
    completions = list((content / "completions").iterdir())
    check(len(pages) > 10 and len(completions) == 5, f"{len(pages)} man pages, {len(completions)} completions")
    texts = [*pages, *completions, *content.glob("LICENSE-*"), content / "README.md", content / "dependencies.html"]
    for text in texts:
        check(text.stat().st_size > 200, f"{text.name} has {text.stat().st_size} bytes")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        try_archive(Path(sys.argv[1]), Path(folder))
