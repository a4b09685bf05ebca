"""The examples of Ray, Dask and Spark, run on clusters of two workers on this machine."""

import importlib.util
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

import vtex

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LIMIT = 300  # Seconds.
NEEDS = {"ray": ["ray"], "dask": ["dask", "distributed"], "spark": ["pyspark", "pandas", "pyarrow"]}


@pytest.fixture(scope="module")
def photos(tmp_path_factory, pixels):
    """A folder of four photographs, and two files that are none."""
    folder = tmp_path_factory.mktemp("photos")
    for k in range(4):
        Image.fromarray(pixels[:, 8 * k :]).save(folder / f"photo-{k}.png")
    (folder / "empty.png").write_bytes(b"")
    (folder / "cut.png").write_bytes((folder / "photo-0.png").read_bytes()[:2000])
    return folder


def run(command: list[str], environment: dict[str, str], folder: Path) -> str:
    """Give what a command prints; if it fails or takes too long, the test fails with what it said."""
    # Processes that an engine leaves behind would keep pipes open, but not files.
    out, err = folder / "stdout", folder / "stderr"
    with out.open("w") as stdout, err.open("w") as stderr:
        child = subprocess.Popen(command, stdout=stdout, stderr=stderr, env=environment, start_new_session=True)
        try:
            ended = f"ended with {child.wait(LIMIT)}"
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            ended = f"took longer than {LIMIT} s and was stopped"
    if child.returncode != 0:
        pytest.fail(f"{command} {ended}:\n{out.read_text()[-1000:]}\n{err.read_text()[-3000:]}", pytrace=False)
    return out.read_text()


@pytest.mark.parametrize("engine", NEEDS)
def test_an_engine_makes_the_textures_of_a_folder(engine, photos, tmp_path):
    results = tmp_path / "textures"
    results.mkdir()
    for module in NEEDS[engine]:
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed: pip install './python[engines]'")
    if engine == "spark" and shutil.which("java") is None and "JAVA_HOME" not in os.environ:
        pytest.skip("Spark needs Java, which is not installed")
    environment = os.environ | {"PYTHONWARNINGS": "ignore", "PYSPARK_PYTHON": sys.executable}
    command = [sys.executable, str(EXAMPLES / f"{engine}_textures.py"), str(photos), str(results), "2"]
    told = run(command, environment, tmp_path)
    rows = dict(line.split(" ", 1) for line in told.splitlines() if ".png " in line)
    rows = {Path(path).name: told for path, told in rows.items()}
    made = {f"photo-{k}.png": "done" for k in range(4)}
    assert {name: told for name, told in rows.items() if told == "done"} == made
    assert "cannot decode" in rows["cut.png"]
    # Spark passes over empty files.
    assert engine == "spark" or "the file is empty" in rows["empty.png"]
    assert sorted(path.name for path in results.iterdir()) == [f"photo-{k}.svg" for k in range(4)]
    # What workers make is what is made here.
    for name in made:
        scene = vtex.synthesize(vtex.analyze(photos / name), 600, seed=7)
        assert (results / name).with_suffix(".svg").read_text(encoding="utf-8") == scene.svg()
