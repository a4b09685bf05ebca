"""The examples of Ray, Dask and Spark, run on clusters of two workers on this machine."""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

import vtex

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
NEEDS = {"ray": ["ray"], "dask": ["dask", "distributed"], "spark": ["pyspark", "pandas", "pyarrow"]}


@pytest.fixture(scope="module")
def photos(tmp_path_factory, pixels):
    """A folder of four photographs, and two files that are none."""
    folder = tmp_path_factory.mktemp("photos")
    for k in range(4):
        Image.fromarray(pixels[8 * k : 8 * k + 96]).save(folder / f"photo-{k}.png")
    (folder / "empty.png").write_bytes(b"")
    (folder / "cut.png").write_bytes((folder / "photo-0.png").read_bytes()[:2000])
    return folder


@pytest.mark.parametrize("engine", NEEDS)
def test_an_engine_makes_the_textures_of_a_folder(engine, photos, tmp_path):
    for module in NEEDS[engine]:
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed: pip install './python[engines]'")
    if engine == "spark" and shutil.which("java") is None and "JAVA_HOME" not in os.environ:
        pytest.skip("Spark needs Java, which is not installed")
    environment = os.environ | {"PYTHONWARNINGS": "ignore", "PYSPARK_PYTHON": sys.executable}
    command = [sys.executable, str(EXAMPLES / f"{engine}_textures.py"), str(photos), str(tmp_path), "2"]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=600, env=environment)
    assert ran.returncode == 0, ran.stderr[-3000:]
    rows = dict(line.split(" ", 1) for line in ran.stdout.splitlines() if ".png " in line)
    rows = {Path(path).name: told for path, told in rows.items()}
    made = {f"photo-{k}.png": "done" for k in range(4)}
    assert {name: told for name, told in rows.items() if told == "done"} == made
    assert "cannot decode" in rows["cut.png"]
    # Spark passes over empty files.
    assert engine == "spark" or "the file is empty" in rows["empty.png"]
    # What workers make is what is made here.
    for name in made:
        scene = vtex.synthesize(vtex.analyze(photos / name), 600, seed=7)
        assert (tmp_path / name).with_suffix(".svg").read_text(encoding="utf-8") == scene.svg()
    assert len(list(tmp_path.iterdir())) == 4
