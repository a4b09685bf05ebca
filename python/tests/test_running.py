"""Work that is watched, stopped, forked, and done in many threads at once."""

import os
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from conftest import EXEMPLARS, ROOT

import vtex

README = (ROOT / "python" / "README.md").read_text(encoding="utf-8")


def test_progress_is_told_in_this_thread(library, pixels, scene):
    for work in (
        lambda watch: vtex.analyze(pixels, progress=watch),
        lambda watch: vtex.synthesize(library, 300, progress=watch),
        lambda watch: vtex.metrics(pixels, pixels, progress=watch),
        lambda watch: vtex.warp(scene, library, 2, progress=watch),
        lambda watch: vtex.interpolate(scene, scene, [0, 0.5], progress=watch),
        lambda watch: vtex.interpolate(scene, scene, morph="x", progress=watch),
    ):
        seen = []

        def watch(stage, done, total, seen=seen):
            seen.append((stage, done, total, threading.get_ident()))

        work(watch)
        assert len(seen) > 2
        for stage, done, total, thread in seen:
            assert isinstance(stage, str) and done >= 0 and (total == 0 or done <= total)
            assert thread == threading.get_ident()


def test_the_bar_of_the_readme_moves(photo_path, tmp_path, monkeypatch, capsys):
    pytest.importorskip("tqdm", reason="pip install tqdm")
    code = next(block for block in re.findall(r"```python\n(.*?)```", README, re.S) if "tqdm" in block)
    (tmp_path / "photo.jpg").write_bytes(photo_path.read_bytes())
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    bars = re.findall(r"([a-z][\w :]+): +(\d+)%", capsys.readouterr().err)
    shares = [int(share) for _, share in bars]
    assert len({stage for stage, _ in bars}) > 5 and len(set(shares)) > 5, bars
    assert shares == sorted(shares) and shares[-1] == 100, bars


class Stop(Exception):
    pass


def test_what_a_callback_raises_stops_the_work_and_is_raised(pixels):
    calls = []

    def watch(stage, done, total):
        calls.append(stage)
        if len(calls) == 2:
            raise Stop(stage)

    with pytest.raises(Stop) as error:
        vtex.analyze(pixels, progress=watch)
    assert str(error.value) == calls[1] and len(calls) == 2
    assert error.traceback[-1].name == "watch"
    # Nothing is left behind.
    assert vtex.analyze(pixels, segmenter="felzenszwalb").width == 160


@pytest.mark.parametrize("answer", [None, True, 1, "on"])
def test_answers_that_go_on(pixels, answer):
    vtex.analyze(pixels, segmenter="felzenszwalb", progress=lambda *_: answer)


@pytest.mark.parametrize("answer", [False, 0])
def test_answers_that_stop(pixels, answer):
    with pytest.raises(vtex.Interrupted):
        vtex.analyze(pixels, segmenter="felzenszwalb", progress=lambda *_: answer)


def test_callbacks_that_are_none(pixels):
    with pytest.raises(TypeError):
        vtex.analyze(pixels, segmenter="felzenszwalb", progress=3)
    with pytest.raises(TypeError):
        vtex.analyze(pixels, segmenter="felzenszwalb", progress=lambda: None)


def test_a_callback_may_use_vtex(pixels, library):
    made = []

    def watch(stage, done, total):
        if not made:
            made.append(vtex.synthesize(library, 60))

    vtex.analyze(pixels, segmenter="felzenszwalb", progress=watch)
    assert made == [vtex.synthesize(library, 60)]


SLOW = f"""
import sys, vtex
print("ready", flush=True)
vtex.analyze({str(EXEMPLARS / "pebbles.png")!r}, progress={{watch}})
print("done", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="no SIGINT for a child here")
@pytest.mark.parametrize("watch", ["None", "lambda *_: None"])
def test_control_c_stops_the_work(watch):
    code = SLOW.format(watch=watch)
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.4)
    began = time.monotonic()
    child.send_signal(signal.SIGINT)
    out, err = child.communicate(timeout=60)
    took = time.monotonic() - began
    assert "KeyboardInterrupt" in err and out == "", (out, err)
    # The whole takes several times as long; a single step of it may have to end.
    assert took < 30


def test_handlers_of_signals_run_while_work_is_done(pixels):
    rung = []
    before = signal.signal(signal.SIGALRM, lambda *_: rung.append(time.monotonic()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        vtex.analyze(pixels)
        ended = time.monotonic()
    finally:
        signal.signal(signal.SIGALRM, before)
    assert rung and rung[0] < ended


def test_the_lock_is_released(library):
    counted = 0
    done = threading.Event()

    def work():
        vtex.synthesize(library, 900)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        counted += 1
        time.sleep(0.001)
    thread.join()
    # Held for the whole of the work, the lock would let this thread count to two or three.
    assert counted > 20


def test_ten_threads_at_once(library, pixels, scene):
    def work(k):
        if k % 3 == 0:
            return vtex.analyze(pixels, segmenter="felzenszwalb")
        if k % 3 == 1:
            return vtex.synthesize(library, (300, 200), seed=7)
        return scene.edit(vtex.Tint("red")).render().tobytes()

    with ThreadPoolExecutor(10) as pool:
        made = list(pool.map(work, range(30)))
    for k in range(3):
        assert all(thing == made[k] for thing in made[k::3])
    assert made[1] == scene


def run_alone(code: str) -> str:
    """Run code in an interpreter of its own, which must end."""
    ran = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=180
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_fork_after_use_works(photo_path):
    out = run_alone(
        f"""
        import os, vtex
        library = vtex.analyze({str(photo_path)!r}, segmenter="texton")
        scene = vtex.synthesize(library, 200)
        scene.render()
        children = []
        for k in range(3):
            child = os.fork()
            if child == 0:
                again = vtex.analyze({str(photo_path)!r}, segmenter="texton")
                same = again == library and vtex.synthesize(library, 200) == scene
                os._exit(0 if same else 3)
            children.append(child)
        print([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children])
        """
    )
    assert out.strip() == "[0, 0, 0]"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_fork_while_other_threads_work(photo_path):
    out = run_alone(
        f"""
        import os, threading, time, vtex
        library = vtex.analyze({str(photo_path)!r}, segmenter="felzenszwalb")
        scene = vtex.synthesize(library, 200)
        thread = threading.Thread(target=lambda: [vtex.synthesize(library, 400, seed=k) for k in range(5)])
        thread.start()
        codes = []
        for k in range(5):
            time.sleep(0.05)
            child = os.fork()
            if child == 0:
                os._exit(0 if vtex.synthesize(library, 200) == scene else 3)
            codes.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        thread.join()
        print(codes)
        """
    )
    assert out.strip() == "[0, 0, 0, 0, 0]"


def test_the_interpreter_ends_while_work_is_done():
    run_alone(
        f"""
        import threading, time, vtex
        def work():
            vtex.analyze({str(EXEMPLARS / "pebbles.png")!r})
        threading.Thread(target=work, daemon=True).start()
        time.sleep(0.2)
        """
    )
