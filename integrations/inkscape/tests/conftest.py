"""Find Inkscape's Python modules and the programs that the tests run."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[2]
sys.path.insert(0, str(HERE.parent))
INKEX = Path(os.environ.get("INKSCAPE_EXTENSIONS", "/usr/share/inkscape/extensions"))
if INKEX.is_dir():
    sys.path.append(str(INKEX))
try:
    import inkex  # noqa: F401
except ImportError:
    collect_ignore_glob = ["test_*.py"]
    sys.stderr.write(f"skipped: no module inkex in {INKEX}; set INKSCAPE_EXTENSIONS, and use a Python that has lxml\n")


@pytest.fixture(scope="session")
def vtex() -> str:
    """Return the program, or skip."""
    built = [REPOSITORY / "target" / kind / "vtex" for kind in ("release", "debug")]
    for candidate in (os.environ.get("VTEX"), *map(str, built), "vtex"):
        found = shutil.which(candidate) if candidate else None
        if found:
            return found
    pytest.skip("no program vtex: set VTEX, or build it with cargo build --release")


@pytest.fixture(scope="session")
def photograph() -> Path:
    """Return a photograph."""
    return REPOSITORY / "examples" / "exemplars" / "terrazzo.png"


@pytest.fixture(scope="session")
def texture(vtex: str, photograph: Path, tmp_path_factory: pytest.TempPathFactory):
    """Return a function that makes an SVG of vtex, once for each set of options."""
    folder = tmp_path_factory.mktemp("textures")

    def make(*options: str) -> Path:
        path = folder / ("_".join(options).replace("-", "").replace("/", "") + ".svg")
        if not path.is_file():
            command = [vtex, "texture", str(photograph), "-o", str(path), "--seed", "3", "--size", "240", "-q"]
            subprocess.run([*command, "--preset", "draft", *options], check=True, timeout=300)
        return path

    return make


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Keep the cache of the tests apart from that of the user."""
    import tempfile

    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    if "vtex" in request.fixturenames:
        monkeypatch.setenv("VTEX", request.getfixturevalue("vtex"))


@pytest.fixture(scope="session")
def render(tmp_path_factory: pytest.TempPathFactory):
    """Return a function that draws an SVG with Inkscape as an array of 0 to 255."""
    numpy = pytest.importorskip("numpy")
    image = pytest.importorskip("PIL.Image")
    if not shutil.which("inkscape"):
        pytest.skip("no program inkscape")
    folder = tmp_path_factory.mktemp("pictures")

    def draw(svg: Path, width: int = 480):
        picture = folder / f"{abs(hash((str(svg), svg.stat().st_mtime_ns)))}.png"
        command = ["inkscape", str(svg), "-w", str(width), "-b", "white", "-o", str(picture)]
        subprocess.run(command, check=True, timeout=120, stderr=subprocess.DEVNULL)
        return numpy.asarray(image.open(picture).convert("RGB")).astype(float)

    return draw
