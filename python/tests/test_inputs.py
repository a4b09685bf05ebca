"""What is given: every form that is taken, and what is said of those that are not."""

import errno
import io
import os
import pathlib
import pickle

import numpy as np
import pytest
from PIL import Image

import vtex


@pytest.fixture(scope="module")
def quick():
    """Analyse fast: what is given matters here, not what is found."""
    return lambda source, **given: vtex.analyze(source, segmenter="felzenszwalb", **given)


@pytest.fixture(scope="module")
def known(quick, pixels):
    return quick(pixels)


def told(error: pytest.ExceptionInfo[BaseException]) -> vtex.Error:
    """The exception, which is vtex's own, says something and hints at something."""
    assert isinstance(error.value, vtex.Error)
    assert str(error.value) and error.value.hint
    return error.value


def same(one: vtex.Library, other: vtex.Library) -> bool:
    """Whether two libraries differ at most in what the exemplar is called and how its file is packed."""
    a, b = one.to_dict(), other.to_dict()
    for document in (a, b):
        document["source"] |= {"file": "", "sha256": "", "warnings": []}
    return a == b


def test_photographs_come_in_many_forms(quick, known, photo_path, pixels):
    data = photo_path.read_bytes()
    with photo_path.open("rb") as file:
        forms = [
            str(photo_path),
            photo_path,
            data,
            bytearray(data),
            memoryview(data),
            io.BytesIO(data),
            file,
            Image.open(photo_path),
            np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)]),
        ]
        for form in forms:
            assert same(quick(form), known), type(form)
    assert known.file == "array" and quick(pixels, name="mine").file == "mine"
    assert quick(photo_path) == quick(data, name="pebbles.png")


def test_an_array_is_summed_as_its_ppm(quick, pixels):
    ppm = b"P6\n160 128\n255\n" + pixels.tobytes()
    assert quick(pixels, name="a") == quick(ppm, name="a")


def test_arrays_need_not_be_contiguous(quick, known, pixels):
    wide = np.zeros((128, 320, 3), np.uint8)
    wide[:, ::2] = pixels
    assert not wide[:, ::2].flags.c_contiguous
    assert quick(wide[:, ::2]) == known
    assert quick(np.asfortranarray(pixels)) == known
    assert quick(pixels[::-1][::-1]) == known
    assert same(quick(pixels[::-1]), quick(np.ascontiguousarray(pixels[::-1])))
    frozen = pixels.copy()
    frozen.flags.writeable = False
    assert quick(frozen) == known


def test_greys_and_wider_samples_are_converted(quick, pixels):
    grey = pixels[..., 1]
    three = quick(np.dstack([grey] * 3))
    assert quick(grey) == three and quick(grey[..., None]) == three
    assert quick(grey.astype(np.uint16) * 257) == three
    assert quick(Image.fromarray(grey)) == three


def test_images_of_pillow_are_read_as_their_files_are(quick, pixels, tmp_path):
    image = Image.fromarray(pixels)
    turned = tmp_path / "turned.jpg"
    exif = Image.Exif()
    exif[0x0112] = 6
    image.save(turned, exif=exif, quality=95)
    # Decoders of JPEG differ by a step here and there, so only the shape is compared.
    by_pillow, by_file = quick(Image.open(turned)), quick(turned)
    assert (by_pillow.width, by_pillow.height) == (by_file.width, by_file.height) == (128, 160)
    clear = image.copy()
    clear.putalpha(Image.new("L", image.size, 128))
    with pytest.warns(vtex.VtexWarning, match="transparent"):
        quick(clear)
    palette = image.quantize(16)
    palette.save(tmp_path / "p.png")
    assert same(quick(palette), quick(tmp_path / "p.png"))
    cmyk = quick(image.convert("CMYK"))
    assert cmyk.width == 160


def test_transparent_pixels_lie_over_white(quick, pixels):
    clear = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
    clear[:, :80, 3] = 0
    with pytest.warns(vtex.VtexWarning, match="transparent"):
        library = quick(clear)
    assert any("transparent" in warning for warning in library.warnings)
    white = pixels.copy()
    white[:, :80] = 255
    assert same(library, quick(white))


@pytest.mark.parametrize("shape", [(160,), (2, 160, 128, 3), (160, 128, 2), (160, 128, 5), (3, 160, 128), (0, 9, 3)])
def test_arrays_of_other_shapes_are_refused(quick, shape):
    with pytest.raises(ValueError, match="shape") as error:
        quick(np.zeros(shape, np.uint8))
    hint = told(error).hint
    assert ("transpose" in hint) == (shape == (3, 160, 128))


@pytest.mark.parametrize("kind", ["f4", "f8", "i4", "i1", "c8", "O", "M8[s]", "U3"])
def test_arrays_of_other_types_are_refused(quick, kind):
    with pytest.raises(TypeError, match="photograph is an array") as error:
        quick(np.zeros((40, 40, 3), kind))
    assert "uint8" in told(error).hint


def test_small_and_plain_pictures_are_refused(quick):
    with pytest.raises(ValueError, match="3 x 40 pixels") as error:
        quick(np.zeros((40, 3, 3), np.uint8))
    told(error)
    with pytest.raises(ValueError, match="no texture") as error:
        quick(np.full((40, 40, 3), 7, np.uint8))
    told(error)
    with pytest.raises(ValueError, match="16384") as error:
        quick(np.zeros((32, 17000, 3), np.uint8))
    told(error)


@pytest.mark.parametrize("thing", [None, 3, 2.5, object(), {"a": 1}, [[1, 2], [3, 4]], ("a", "b"), b"a".__len__])
def test_other_things_are_refused(quick, thing):
    with pytest.raises(TypeError) as error:
        quick(thing)
    told(error)


def test_files_that_cannot_be_read(quick, tmp_path, library):
    with pytest.raises(FileNotFoundError) as error:
        quick(tmp_path / "none.jpg")
    assert told(error).filename == str(tmp_path / "none.jpg") and error.value.errno == 2
    assert isinstance(error.value, vtex.FileError)
    assert error.value.strerror and type(error.value).__name__ == "FileNotFoundError"
    with pytest.raises(IsADirectoryError) as error:
        quick(tmp_path)
    assert isinstance(error.value, vtex.FileError) and type(error.value).__name__ == "IsADirectoryError"
    (tmp_path / "file").write_text("")
    with pytest.raises(NotADirectoryError):
        quick(tmp_path / "file" / "none.jpg")
    with pytest.raises(FileNotFoundError):
        vtex.Scene.read("none.scene.json")
    with pytest.raises(FileNotFoundError):
        library.save(tmp_path / "none" / "a.lib.json")
    with pytest.raises(FileNotFoundError):
        vtex.synthesize(library, density="none.png")
    (tmp_path / "text.txt").write_text("no picture at all")
    with pytest.raises(ValueError, match="cannot decode") as error:
        quick(tmp_path / "text.txt")
    told(error)
    with pytest.raises(ValueError, match="a HEIC picture") as error:
        quick(b"\0\0\0\x18ftypheic\0\0\0\0mif1heic\0\0\0\0meta")
    told(error)
    for damaged in (b"", b"\x89PNG\r\n\x1a\n damaged", b"\x1f\x8b\x08\x00"):
        with pytest.raises(ValueError):
            quick(damaged)


def test_closed_files_and_files_of_text(quick, photo_path, tmp_path):
    with photo_path.open("rb") as file:
        pass
    with pytest.raises(ValueError, match="closed") as error:
        quick(file)
    told(error)
    closed = Image.open(photo_path)
    closed.close()
    with pytest.raises(ValueError) as error:
        quick(closed)
    told(error)
    (tmp_path / "t.txt").write_text("abc")
    with (tmp_path / "t.txt").open() as text, pytest.raises(TypeError, match="text") as error:
        quick(text)
    told(error)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"minimum_area": 0}, "minimum_area = 0 is out of range"),
        ({"detail_scale": -1.0}, "detail_scale"),
        ({"fidelity": 99}, "fidelity"),
        ({"fidelity": float("nan")}, "finite"),
        ({"fidelity": "much"}, "invalid type"),
        ({"shading": "bright"}, "bright"),
        ({"categories": 0}, "auto or 1 to 1000"),
        ({"seed": -1}, "seed"),
        ({"seed": 2**64}, "seed"),
        ({"layers": 9}, "layers"),
        ({"contrast": 11}, "auto, off, or 1 to 10"),
        ({"minimum_area": 5.5}, "invalid type"),
        ({"engine": "steam"}, "steam"),
    ],
)
def test_parameters_out_of_range(pixels, given, message):
    with pytest.raises(ValueError, match=message) as error:
        vtex.analyze(pixels, **{"segmenter": "felzenszwalb"} | given)
    assert isinstance(error.value, vtex.InputError)


@pytest.mark.parametrize(
    ("given", "kind", "message"),
    [
        ({"size": 0}, ValueError, "size"),
        ({"size": (10, 0)}, ValueError, "size"),
        ({"size": (1, 2, 3)}, TypeError, "size"),
        ({"size": "large"}, vtex.InputError, "size"),
        ({"size": 10.5}, TypeError, "size"),
        ({"size": True}, TypeError, "size"),
        ({"size": (60_000, 60_000)}, ValueError, "megapixels"),
        ({"tile": "z"}, ValueError, "tile"),
        ({"method": "magic"}, ValueError, "magic"),
        ({"weights": (1, 2)}, ValueError, "weights"),
        ({"weights": (99, 0, 0, 0, 0)}, ValueError, "weights"),
        ({"ablate": ["all"]}, ValueError, "all"),
        ({"rotate": 181}, ValueError, "rotate"),
        ({"scale_jitter": -1}, ValueError, "scale_jitter"),
        ({"density": np.full((4, 4), 2.5)}, ValueError, "0 to 2"),
        ({"density": np.full((4, 4), np.nan)}, ValueError, "0 to 2"),
        ({"density": np.ones((4, 4, 3))}, ValueError, "floats"),
        ({"density": np.ones((4, 4), np.int64)}, TypeError, "int64"),
        ({"density": np.ones(4)}, ValueError, "shape"),
        ({"density": 1.0}, TypeError, "density is float"),
        ({"domain": np.zeros((9, 9))}, ValueError, "white"),
        ({"map": np.ones((4, 4))}, ValueError, "several libraries"),
        ({"control": np.zeros((4, 4), np.uint8), "guide": np.zeros((4, 4), np.uint8)}, ValueError, "both"),
    ],
)
def test_synthesis_refuses(known, given, kind, message):
    with pytest.raises(kind, match=message) as error:
        vtex.synthesize(known, **given)
    assert isinstance(error.value, vtex.Error)


def test_synthesis_needs_libraries(known):
    for thing in ("a.lib.json", 3, None, [known, "x"], pathlib.Path("a")):
        with pytest.raises(TypeError) as error:
            vtex.synthesize(thing)
        told(error)
    with pytest.raises(ValueError):
        vtex.synthesize([])
    with pytest.raises(ValueError):
        vtex.synthesize([known] * 17)
    with pytest.raises(ValueError, match="maps"):
        vtex.synthesize([known, known])
    with pytest.raises(TypeError):
        vtex.reconstruct("a.lib.json")
    for kind in (vtex.Library, vtex.Scene):
        with pytest.raises(TypeError) as error:
            kind()
        told(error)


@pytest.mark.parametrize(
    ("edit", "kind", "message"),
    [
        (vtex.Tint("no colour"), ValueError, "no colour"),
        (vtex.Tint((1, 2)), TypeError, "no colour"),
        (vtex.Tint((1, 2, 256)), ValueError, "0 to 255"),
        (vtex.Tint("red", amount=2), ValueError, "amount = 2 is out of range: 0 to 1"),
        (vtex.Tint("none.png"), OSError, "none.png"),
        (vtex.Thin(), ValueError, "how much to keep"),
        (vtex.Thin(minimum_area=-1.0), ValueError, "minimum_area = -1"),
        (vtex.Thin("half"), ValueError, "invalid type"),
        (vtex.Simplify(0), ValueError, "tolerance = 0"),
        (vtex.Orient(999), ValueError, "direction = 999"),
        (vtex.Jitter(distance=-1), ValueError, "distance = -1"),
        (vtex.Jitter(), ValueError, "what to change"),
        (vtex.Jitter(steps=1.5, hue=3), TypeError, "steps"),
        (vtex.Transform(by=(1, 2, 3)), TypeError, "by"),
        (vtex.Transform(angle=999), ValueError, "angle = 999"),
        (vtex.Relax(rounds=0), ValueError, "rounds"),
        (vtex.Order("z"), ValueError, "z"),
        (vtex.Delete(layer="clouds"), ValueError, "no layer 'clouds'"),
        (vtex.Delete(layer=3), TypeError, "layer"),
        (vtex.Delete(where="size>3"), ValueError, "'size' is nothing that elements have"),
        (vtex.Delete(where="area"), ValueError, "no condition"),
        (vtex.Flatten(layer="background"), ValueError, "background"),
        (vtex.Density(3), TypeError, "map is int"),
        (vtex.Density(None), TypeError, "map"),
        (vtex.Replace("none.lib.json"), OSError, "none"),
        (vtex.Propagate(), ValueError, "one of drawing, element and fill"),
        (vtex.Propagate("a.svg", fill="red"), ValueError, "one of drawing, element and fill"),
        (vtex.Edit(), TypeError, "nothing to do"),
        (vtex.Tint, TypeError, "no edit"),
        ("tint red", TypeError, "no edit"),
        ([vtex.Flatten(), "tint red"], TypeError, "no edit"),
        ([[vtex.Flatten()]], TypeError, "no edit"),
        (None, TypeError, "no edit"),
        (vtex.Mask("<svg"), ValueError, "svg"),
    ],
)
def test_edits_that_cannot_be_done(scene, edit, kind, message):
    with pytest.raises(kind, match=message) as error:
        scene.edit(edit)
    assert isinstance(error.value, vtex.Error)


@pytest.mark.parametrize(("seed", "kind"), [(-1, ValueError), (2**64, ValueError), (1.5, TypeError), ("7", TypeError)])
def test_seeds_of_edits(scene, seed, kind):
    with pytest.raises(kind, match="seed") as error:
        scene.edit(vtex.Jitter(hue=20), seed=seed)
    assert isinstance(error.value, vtex.Error)


def test_what_matches_nothing_is_warned_of(scene):
    with pytest.warns(vtex.VtexWarning, match="matches nothing") as seen:
        assert scene.edit(vtex.Delete(where="x>99999")).instances == scene.instances
    assert seen[0].filename == __file__


def test_writing_refuses(scene, library, tmp_path):
    for call in (
        lambda: scene.save(tmp_path / "out.jpg"),
        lambda: scene.save(tmp_path / "out.lib.json"),
        lambda: library.save(tmp_path / "out.svg"),
        lambda: scene.svg(precision=7),
        lambda: scene.svg(max_bytes=10),
        lambda: scene.svg(max_bytes=0),
        lambda: scene.svg(background="no colour"),
        lambda: scene.render(scale=0),
        lambda: scene.render(scale=float("inf")),
        lambda: scene.render(scale=1000),
        lambda: scene.png(scale=-1),
    ):
        with pytest.raises(vtex.InputError):
            call()
    for call in (
        lambda: scene.svg(precision=1.5),
        lambda: scene.render(scale="large"),
        lambda: scene.save(3),
        lambda: scene.save(b"out.svg"),
    ):
        with pytest.raises(TypeError):
            call()
    assert list(tmp_path.iterdir()) == []


def test_damaged_documents(library, scene):
    data = library.to_dict()
    data["coverage"] = 7
    import json

    with pytest.raises(ValueError, match="vtex-library") as error:
        vtex.Library.from_bytes(json.dumps(data).encode())
    assert "vtex.analyze" in told(error).hint
    with pytest.raises(ValueError, match="vtex-scene"):
        vtex.Scene.from_bytes(library.to_bytes())
    with pytest.raises(TypeError):
        vtex.Scene.from_bytes("text")
    packed = bytearray(scene.to_bytes())
    packed[len(packed) // 2] ^= 0xFF
    with pytest.raises(ValueError):
        vtex.Scene.from_bytes(bytes(packed))


def test_threads_out_of_range():
    for number in (0, 5000):
        with pytest.raises(ValueError):
            vtex.set_threads(number)


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="all files may be read here")
def test_files_that_may_not_be_read(quick, tmp_path):
    path = tmp_path / "closed.png"
    path.write_bytes(b"")
    path.chmod(0)
    with pytest.raises(PermissionError) as error:
        quick(path)
    assert isinstance(error.value, vtex.FileError) and error.value.errno == 13


@pytest.mark.parametrize(
    ("number", "kind"),
    [
        (errno.ENOENT, FileNotFoundError),
        (errno.EACCES, PermissionError),
        (errno.EPERM, PermissionError),
        (errno.EEXIST, FileExistsError),
        (errno.EISDIR, IsADirectoryError),
        (errno.ENOTDIR, NotADirectoryError),
        (errno.ENOSPC, vtex.FileError),
        (None, vtex.FileError),
    ],
)
def test_errors_of_files_are_those_of_python(number, kind):
    from vtex._errors import file_error

    error = file_error(number, "message", None, "a.png")
    assert isinstance(error, kind) and isinstance(error, vtex.FileError) and str(error) == "message"
    assert (error.errno, error.filename) == (number, "a.png")
    assert type(error).__name__ == kind.__name__
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and (again.errno, again.filename) == (number, "a.png")


def test_warnings_name_the_line_that_called(quick, pixels):
    clear = np.dstack([pixels, np.full(pixels.shape[:2], 128, np.uint8)])
    for call in (quick, vtex.vectorize):
        with pytest.warns(vtex.VtexWarning, match="transparent") as seen:
            call(clear)
        assert {warning.filename for warning in seen} == {__file__}
