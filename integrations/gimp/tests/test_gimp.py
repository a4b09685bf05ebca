# ruff: noqa: D103, RUF100
"""Tests of the plug-in for GIMP. Those of the procedures themselves need GIMP 3; the others do not."""

from __future__ import annotations

import json
import os
import re
import shutil
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[2]
PHOTOGRAPH = REPOSITORY / "examples" / "exemplars" / "terrazzo.png"
sys.path.insert(0, str(HERE.parent))

import vtex_commands  # noqa: E402
from vtex_commands import VtexError, find_program, hole_command, path_command, paths_svg, run, texture_command  # noqa: E402

SETTINGS = {"method": "elements", "quality": "draft", "tile": "both", "seed": 4, "width": 90, "height": 60}


@pytest.fixture(scope="session")
def vtex() -> str:
    built = [REPOSITORY / "target" / kind / "vtex" for kind in ("release", "debug")]
    for candidate in (os.environ.get("VTEX"), *map(str, built), "vtex"):
        found = shutil.which(candidate) if candidate else None
        if found:
            return found
    pytest.skip("no program vtex: set VTEX, or build it with cargo build --release")


def size_of(png: Path) -> tuple[int, int]:
    head = png.read_bytes()[:24]
    return int.from_bytes(head[16:20], "big"), int.from_bytes(head[20:24], "big")


@pytest.mark.parametrize("method", ["elements", "pixels"])
def test_vtex_accepts_the_command_of_a_texture(vtex: str, tmp_path: Path, method: str, monkeypatch) -> None:
    monkeypatch.setattr(vtex_commands, "PULSE_SECONDS", 0.001)
    output = tmp_path / "out.png"
    pulses = []
    command = texture_command(str(PHOTOGRAPH), str(output), {**SETTINGS, "method": method})
    assert run(vtex, command, 120, lambda: pulses.append(1))["seed"] == 4
    assert size_of(output) == (90, 60)
    assert pulses


def test_vtex_fills_a_hole_and_keeps_the_rest(vtex: str, tmp_path: Path) -> None:
    numpy, image = pytest.importorskip("numpy"), pytest.importorskip("PIL.Image")
    photograph = image.open(PHOTOGRAPH).convert("RGB").crop((0, 0, 120, 120))
    photograph.save(tmp_path / "in.png")
    hole = image.new("L", (120, 120), 0)
    hole.paste(255, (40, 40, 70, 70))
    hole.save(tmp_path / "hole.png")
    run(vtex, hole_command(*(str(tmp_path / name) for name in ("in.png", "hole.png", "out.png")), 1), 120, lambda: None)
    before, after = (numpy.asarray(image.open(tmp_path / name).convert("RGB")) for name in ("in.png", "out.png"))
    changed = (before != after).any(axis=2)
    assert changed[40:70, 40:70].mean() > 0.3
    changed[40:70, 40:70] = False
    assert not changed.any()


def test_paths_are_where_their_layer_is(vtex: str, tmp_path: Path) -> None:
    output = tmp_path / "out.svg"
    counts = {}
    for smallest in (30, 400):
        settings = {"smallest": smallest, "seed": 1}
        run(vtex, path_command(str(PHOTOGRAPH), str(output), settings), 120, lambda: None)
        counts[smallest] = output.read_text("utf-8").count("<path")
    assert counts[30] > 1.5 * counts[400]
    text = paths_svg(output.read_text("utf-8"), (30, -7), (800, 600))
    assert 'viewBox="0 0 800 600"' in text and 'transform="translate(30,-7)"' in text
    assert text.count("<path") == counts[400]
    # GIMP reads no clones, and the background is no outline.
    assert "<use" not in text and "<rect" not in text
    with pytest.raises(VtexError, match="no elements"):
        paths_svg(
            '<svg xmlns="http://www.w3.org/2000/svg"><g id="background"><path d="m0 0"/></g></svg>', (0, 0), (9, 9)
        )


def test_errors_of_vtex_are_shown(vtex: str, tmp_path: Path) -> None:
    broken = tmp_path / "broken.png"
    broken.write_text("no picture")
    with pytest.raises(VtexError, match=r"error:.*broken\.png"):
        run(vtex, texture_command(str(broken), str(tmp_path / "out.png"), SETTINGS), 60, lambda: None)


def test_a_missing_program_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(VtexError, match=re.escape("/no/vtex")):
        find_program("/no/vtex")
    program = tmp_path / "mine"
    program.write_text("")
    program.chmod(0o755)
    monkeypatch.setenv("VTEX", str(program))
    assert find_program("") == str(program)


@pytest.mark.skipif(sys.platform == "win32", reason="the stand-in is a script with #!")
def test_a_program_that_hangs_is_stopped(tmp_path: Path) -> None:
    slow = tmp_path / "slow"
    slow.write_text(f"#!{sys.executable}\nimport time; time.sleep(60)\n")
    slow.chmod(slow.stat().st_mode | stat.S_IXUSR)
    start = time.monotonic()
    with pytest.raises(VtexError, match="longer than 1 s"):
        run(str(slow), [], 1, lambda: None)
    assert time.monotonic() - start < 20


def test_the_procedures_in_gimp(vtex: str, tmp_path: Path) -> None:
    gimp = shutil.which("gimp-console-3.0") or shutil.which("gimp-console")
    version = subprocess.run([gimp, "--version"], capture_output=True, text=True).stdout if gimp else ""
    if not re.search(r"version 3\.", version):
        pytest.skip("no GIMP 3")
    # GIMP reads plug-ins from the folder of its settings.
    plug_in = tmp_path / "gimp" / "plug-ins" / "vtex"
    plug_in.mkdir(parents=True)
    for name in ("vtex.py", "vtex_commands.py"):
        shutil.copy(HERE.parent / name, plug_in / name)
    (plug_in / "vtex.py").chmod(0o755)
    settings = {
        "GIMP3_DIRECTORY": str(tmp_path / "gimp"),
        "VTEX": vtex,
        "VTEX_TEST_FOLDER": str(tmp_path),
        "VTEX_TEST_PHOTOGRAPH": str(PHOTOGRAPH),
    }
    script = f"exec(open({str(HERE / 'in_gimp.py')!r}).read())"
    command = [gimp, "-i", "--quit", "--batch-interpreter=python-fu-eval", "-b", script]
    done = subprocess.run(command, env={**os.environ, **settings}, timeout=300, capture_output=True, text=True)
    assert (tmp_path / "report.json").is_file(), done.stdout + done.stderr
    report = json.loads((tmp_path / "report.json").read_text())
    for name in ("texture", "layer", "hole", "outline", "indexed"):
        assert report[name] == [3, "success"], name
    width, height = report["size"]
    assert report["texture image"] == [240, 160, 1]
    assert report["layer layers"][0][1:] == [20, 30, 120, 90, False]
    assert report["hole layers"][0][1:] == [0, 0, width, height, True]
    assert report["outline paths"] and len(report["indexed layers"]) == 2
    selected, left, top, right, bottom = report["outline bounds"]
    # vtex completes elements that the edge of the selection cuts, so outlines may reach beyond it.
    assert selected and (right, bottom) == pytest.approx((200, 190), abs=12)
    assert 0 <= left <= 62 and 0 <= top <= 52
    assert "Select the part" in report["no selection"][1] and "/no/vtex" in report["missing program"][1]
