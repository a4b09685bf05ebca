"""Libraries, scenes, edits and errors survive pickling, copying and other processes."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

import vtex


@pytest.mark.parametrize("protocol", range(3, pickle.HIGHEST_PROTOCOL + 1))
def test_libraries_and_scenes_are_pickled_by_their_bytes(library, scene, protocol):
    for thing in (library, scene):
        data = pickle.dumps(thing, protocol)
        assert thing.to_bytes() in data
        again = pickle.loads(data)
        assert again == thing and again is not thing and type(again) is type(thing)
        assert pickle.dumps(again, protocol) == data


def test_copies_are_equal(library, scene):
    for thing in (library, scene):
        assert copy.copy(thing) == thing == copy.deepcopy(thing)


def test_equality_is_of_content_and_kind(library, scene):
    assert library == vtex.Library.from_bytes(library.to_bytes())
    assert scene == vtex.Scene.from_bytes(scene.to_bytes())
    assert library != scene and scene != "scene" and library != None  # noqa: E711
    assert scene != scene.edit(vtex.Move(1, 0))
    with pytest.raises(TypeError):
        hash(scene)


def test_errors_keep_their_hints():
    with pytest.raises(vtex.Error) as one:
        vtex.Scene.read("none.scene.json")
    with pytest.raises(vtex.Error) as other:
        vtex.Library()
    for error in (one.value, other.value, vtex.EngineError("a", "b"), vtex.Interrupted("a")):
        again = pickle.loads(pickle.dumps(error))
        assert (type(again), str(again), again.hint) == (type(error), str(error), error.hint)
    assert pickle.loads(pickle.dumps(one.value)).filename == "none.scene.json"
    # The hint stands in tracebacks too.
    assert any("spelling" in note for note in getattr(one.value, "__notes__", ["spelling"]))


def work(library: vtex.Library) -> vtex.Scene:
    return vtex.synthesize(library, (300, 200), seed=7)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_other_processes_make_the_same(library, scene, method):
    with ProcessPoolExecutor(2, mp_context=get_context(method)) as pool:
        assert list(pool.map(work, [library] * 3, timeout=120)) == [scene] * 3
