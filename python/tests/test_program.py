"""The same bytes as the program writes, and the program that the package brings."""

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest
from conftest import EXEMPLARS
from PIL import Image

import vtex

CAGE = """<svg xmlns="http://www.w3.org/2000/svg" width="300" height="200">
<path d="M0 0 L300 0 L300 200 L0 200 Z"/></svg>"""

SMALL = """<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24">
<circle cx="5.13" cy="5" r="2.27" fill="#a03020"/><circle cx="16" cy="7.31" r="2.6"/>
<circle cx="9" cy="17" r="3.1"/><circle cx="19" cy="18" r="1.9" fill="#208040"/></svg>"""


@pytest.fixture(scope="module")
def made(program, photo_path, tmp_path_factory):
    """A folder with what the program makes of the photograph."""
    folder = tmp_path_factory.mktemp("program")

    def run(*arguments: object) -> None:
        command = [program, *map(str, arguments), "--seed", "7", "--quiet"]
        subprocess.run(command, check=True, cwd=folder)

    run("analyze", photo_path, "--segmenter", "texton", "-o", "p.lib.json")
    run(
        "synth", "p.lib.json", "--size", "300x200", "-o", "p.svg", "-o", "p.scene.json.gz", "-o", "p.pdf", "-o", "p.png"
    )
    run("synth", "p.lib.json", "--size", "256", "--tile", "-o", "tile.svg", "--precision", "2", "--css")
    run("synth", "p.lib.json", "--size", "300", "-o", "small.svgz", "--max-bytes", "25kB", "--background", "navy")
    run("analyze", EXEMPLARS / "terrazzo.png", "--segmenter", "regions", "-o", "t.lib.json")
    run("synth", "t.lib.json", "--size", "300x200", "-o", "t.scene.json")
    (folder / "a.svg").write_text(CAGE)
    (folder / "b.svg").write_text(CAGE.replace("L300 200", "L250 180"))
    Image.linear_gradient("L").save(folder / "map.png")
    run("warp", "p.scene.json.gz", "p.lib.json", "--stretch", "1.5x1", "-o", "stretched.svg")
    run(
        "warp", "p.scene.json.gz", "p.lib.json", "--cage", "a.svg", "--to", "b.svg", "--edge", "avoid", "-o", "bent.svg"
    )
    run("animate", "p.scene.json.gz", "t.scene.json", "--at", "0.4", "-o", "at.scene.json")
    for place in ("x", "radial", "map.png"):
        run("animate", "p.scene.json.gz", "t.scene.json", "--morph", place, "-o", f"morph-{place}.svg")
    run("transfer", "--structure", "p.scene.json.gz", "--appearance", "t.lib.json", "-o", "replaced.scene.json")
    run(
        *("transfer", "--structure", "p.lib.json", "--appearance", "t.lib.json", "p.scene.json.gz", "--map", "map.png"),
        *("--mode", "mean", "--element-scale", "0.8", "-o", "mixed.svg"),
    )
    (folder / "small.drawing.svg").write_text(SMALL)
    run("analyze", "small.drawing.svg", "-o", "s.lib.json")
    run("synth", "s.lib.json", "--size", "60", "-o", "fine.svg", "-o", "fine.svgz", "-o", "fine.scene.json")
    run("edit", "fine.scene.json", "--op", "flatten", "-o", "flat.svg")
    run("vectorize", photo_path, "-o", "vectors.svg")
    run("vectorize", photo_path, "--colors", "8", "--wrap=on", "-o", "poster.scene.json")
    run("transfer", "--onto", photo_path, "--appearance", "t.lib.json", "-o", "drawn.svg")
    run(
        *("transfer", "--onto", photo_path, "--appearance", "t.scene.json", "--keep", "none", "--longer-side", "200"),
        *("--element-size", "20", "--levels", "2", "-o", "small-drawn.svg"),
    )
    return folder


def test_one_seed_gives_the_same_bytes(made, photo_path, tmp_path):
    library = vtex.analyze(photo_path, seed=7)
    library.save(tmp_path / "p.lib.json")
    scene = vtex.synthesize(library, (300, 200), seed=7)
    for name in ("p.svg", "p.scene.json.gz", "p.pdf", "p.png"):
        scene.save(tmp_path / name)
    vtex.synthesize(library, 256, tile="both", seed=7).save(tmp_path / "tile.svg", precision=2, css=True)
    small = vtex.synthesize(library, 300, seed=7)
    small.save(tmp_path / "small.svgz", max_bytes=25000, background="navy")
    same(made, tmp_path, 7)


def test_photographs_in_vectors_are_the_same_bytes(made, photo_path, tmp_path):
    vtex.vectorize(photo_path, seed=7).save(tmp_path / "vectors.svg")
    vtex.vectorize(photo_path, seed=7, colours=8, wrap=True).save(tmp_path / "poster.scene.json")
    same(made, tmp_path, 2)


def same(made, folder, number):
    """Compare the files of a folder, so many, with those of the program."""
    names = sorted(path.name for path in folder.iterdir())
    assert len(names) == number
    for name in names:
        assert (folder / name).read_bytes() == (made / name).read_bytes(), name


def test_drawings_on_small_pages_are_the_same_bytes(made, tmp_path):
    scene = vtex.synthesize(vtex.Library.read(made / "s.lib.json"), 60, seed=7)
    for name in ("fine.svg", "fine.svgz", "fine.scene.json"):
        scene.save(tmp_path / name)
    vtex.Scene.read(made / "fine.scene.json").edit(vtex.Flatten(), seed=7).save(tmp_path / "flat.svg")
    same(made, tmp_path, 4)
    assert scene.svg(precision=1) == scene.svg(precision=2) != scene.svg(precision=0)


def test_documents_of_the_program_are_read(made):
    library = vtex.Library.read(made / "p.lib.json")
    assert vtex.synthesize(library, (300, 200), seed=7) == vtex.Scene.read(made / "p.scene.json.gz")


def test_scenes_of_scenes_are_the_same_bytes(made, photo_path, tmp_path):
    pebbles, terrazzo = vtex.Library.read(made / "p.lib.json"), vtex.Library.read(made / "t.lib.json")
    scene, other = vtex.Scene.read(made / "p.scene.json.gz"), vtex.Scene.read(made / "t.scene.json")
    vtex.warp(scene, pebbles, (1.5, 1), seed=7).save(tmp_path / "stretched.svg")
    bent = vtex.warp(scene, pebbles, cage=made / "a.svg", to=made / "b.svg", edge="avoid")
    bent.save(tmp_path / "bent.svg")
    vtex.interpolate(scene, other, 0.4).save(tmp_path / "at.scene.json")
    for place in ("x", "radial", "map.png"):
        morph = made / place if place == "map.png" else place
        vtex.interpolate(scene, other, morph=morph).save(tmp_path / f"morph-{place}.svg")
    vtex.transfer(scene, terrazzo, seed=7).save(tmp_path / "replaced.scene.json")
    mixed = vtex.transfer(pebbles, [terrazzo, scene], map=made / "map.png", mode="mean", element_scale=0.8, seed=7)
    mixed.save(tmp_path / "mixed.svg")
    vtex.stylize(photo_path, terrazzo, seed=7).save(tmp_path / "drawn.svg")
    drawn = vtex.stylize(photo_path, other, keep="none", longer_side=200, element_size=20, levels=2, seed=7)
    drawn.save(tmp_path / "small-drawn.svg")
    same(made, tmp_path, 10)


def script() -> str:
    """The script of this environment; another program named vtex may be on the PATH."""
    found = shutil.which("vtex", path=sysconfig.get_path("scripts"))
    assert found, "the package is installed without its script"
    return found


@pytest.fixture(params=["module", "script"])
def packaged(request, tmp_path):
    """Return a function that runs the program of the package in a new folder."""
    command = [sys.executable, "-m", "vtex"] if request.param == "module" else [script()]

    def run(*arguments, **options):
        words = [a if isinstance(a, bytes) else str(a) for a in arguments]
        return subprocess.run([*command, *words], capture_output=True, cwd=tmp_path, timeout=120, **options)

    return run


QUICK = ("--segmenter", "regions", "--size", "200", "--seed", "7", "--quiet")


def test_the_packaged_program_prints_its_version_and_help(packaged):
    result = packaged("--version")
    assert (result.returncode, result.stdout.split(), result.stderr) == (0, [b"vtex", vtex.__version__.encode()], b"")
    result = packaged("--help")
    assert (result.returncode, result.stderr) == (0, b"") and b"Usage: vtex " in result.stdout


def test_the_packaged_program_returns_exit_codes(packaged):
    result = packaged("texture", "--no-such-option")
    assert result.returncode == 2 and b"error: " in result.stderr and b"--no-such-option" in result.stderr
    result = packaged("inspect", "missing.lib.json")
    assert result.returncode == 1 and b"error: cannot read 'missing.lib.json'" in result.stderr
    assert b"Traceback" not in result.stderr and result.stdout == b""


def test_the_packaged_program_makes_the_same_bytes(packaged, program, photo_path, tmp_path):
    if Path(program).samefile(script()):
        pytest.skip("no other program to compare with: set VTEX_PROGRAM")
    line = ("texture", photo_path, *QUICK, "-o", "out.svg")
    result = packaged(*line)
    assert result.returncode == 0, result.stderr
    packed = (tmp_path / "out.svg").read_bytes()
    (tmp_path / "out.svg").unlink()
    subprocess.run([program, *map(str, line)], check=True, cwd=tmp_path)
    assert packed == (tmp_path / "out.svg").read_bytes()


def test_the_packaged_program_reads_and_writes_streams(packaged, program, photo_path):
    line = ("texture", "-", *QUICK, "-o", "-")
    photo = photo_path.read_bytes()
    result = packaged(*line, input=photo)
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith(b"<?xml") and b"\n</svg>\n" in result.stdout
    assert result.stdout == subprocess.run([program, *line], check=True, input=photo, stdout=subprocess.PIPE).stdout


@pytest.mark.skipif(sys.platform != "linux", reason="file names are text here")
def test_the_packaged_program_takes_names_that_are_not_utf8(packaged, photo_path, tmp_path):
    name = b"\xff.png"
    shutil.copy(photo_path, os.fsencode(tmp_path) + b"/" + name)
    result = packaged("texture", name, *QUICK, "-o", "out.svg")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out.svg").stat().st_size > 1000


def test_the_packaged_program_extends_other_programs_with_its_script(packaged, tmp_path):
    result = packaged("integrate", "inkscape", "--folder", tmp_path / "extensions")
    assert result.returncode == 0, result.stderr
    named = (tmp_path / "extensions" / "vtex_program.txt").read_text().strip()
    assert Path(named).samefile(script())


@pytest.mark.skipif(os.name == "nt", reason="needs a shell of Unix")
def test_the_packaged_program_reports_a_closed_output(photo_path, tmp_path):
    line = [sys.executable, "-m", "vtex", "texture", str(photo_path), *QUICK, "-o", "-"]
    closed = ["sh", "-c", 'exec "$@" >&-', "sh", *line]
    result = subprocess.run(closed, stderr=subprocess.PIPE, cwd=tmp_path, timeout=120)
    assert result.returncode == 1 and b"it is closed" in result.stderr


@pytest.mark.skipif(os.name == "nt", reason="needs pipes of Unix")
def test_a_reader_may_leave_the_packaged_program(tmp_path):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        line = [sys.executable, "-m", "vtex", "--help"]
        result = subprocess.run(line, stdout=writing, stderr=subprocess.PIPE, cwd=tmp_path, timeout=120)
    finally:
        os.close(writing)
    assert (result.returncode, result.stderr) == (0, b"")


@pytest.mark.skipif(os.name == "nt", reason="no SIGINT for a child here")
def test_control_c_ends_the_packaged_program(photo_path, tmp_path):
    # The first picture of a stage is written while Ctrl-C is handled; the whole takes many seconds more.
    arguments = ("texture", photo_path, "--segmenter", "regions", "--size", "6000", "--quiet")
    line = [sys.executable, "-m", "vtex", *map(str, arguments), "--debug-dir", "stages", "-o", "out.svg"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path) as child:
        latest = time.monotonic() + 60
        while not list(tmp_path.glob("stages/*.png")):
            assert child.poll() is None and time.monotonic() < latest
            time.sleep(0.02)
        began = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=60)
    assert (child.returncode, out) == (130, b"")
    assert err.strip() == b"error: interrupted"
    assert time.monotonic() - began < 10
    assert not (tmp_path / "out.svg").exists()
