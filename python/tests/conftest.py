"""What tests share: a small exemplar, its library, a scene, and the program if it is built."""

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import vtex

ROOT = Path(__file__).resolve().parents[2]
EXEMPLARS = ROOT / "examples" / "exemplars"


@pytest.fixture(scope="session")
def photo_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A part of a picture of pebbles, 160 x 128 pixels, as PNG."""
    path = tmp_path_factory.mktemp("photo") / "pebbles.png"
    with Image.open(EXEMPLARS / "pebbles.png") as image:
        image.convert("RGB").crop((40, 60, 200, 188)).save(path)
    return path


@pytest.fixture(scope="session")
def pixels(photo_path: Path) -> np.ndarray:
    """The same as an array."""
    with Image.open(photo_path) as image:
        return np.asarray(image).copy()


@pytest.fixture(scope="session")
def library(photo_path: Path) -> vtex.Library:
    """Its library."""
    return vtex.analyze(photo_path)


@pytest.fixture(scope="session")
def scene(library: vtex.Library) -> vtex.Scene:
    """A texture of it, 300 x 200 pixels."""
    return vtex.synthesize(library, (300, 200), seed=7)


@pytest.fixture(scope="session")
def program() -> str:
    """The program, from $VTEX_PROGRAM or the newest build of this checkout."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    built = [target / profile / "vtex" for profile in ("release", "trial", "debug")]
    built = sorted((p for p in built if p.is_file()), key=lambda p: p.stat().st_mtime, reverse=True)
    found = os.environ.get("VTEX_PROGRAM") or (str(built[0]) if built else shutil.which("vtex"))
    if found is None:
        pytest.skip("the program is not built: run 'cargo build --release', or set VTEX_PROGRAM")
    return found
