"""What users do: analyse, synthesise, draw, write, edit, compare."""

import inspect
import json
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import vtex


def test_a_photograph_becomes_a_library(library, photo_path):
    assert (library.width, library.height, library.file) == (160, 128, photo_path.name)
    assert 5 < library.primaries <= library.elements
    assert 1 <= len(library.categories) <= 15
    assert 0 < library.coverage < 1
    assert [layer.role for layer in library.layers] == ["background", "secondary", "primary"]
    assert not library.is_drawing and not library.is_periodic
    assert library.parameters["seed"] == 0
    assert f"{library.primaries} primary elements" in repr(library)


def test_a_library_becomes_a_scene(scene, library):
    assert (scene.width, scene.height, scene.seed, scene.tile) == (300, 200, 7, "none")
    assert scene.exemplars == [library.file]
    assert scene.instances == sum(layer.instances for layer in scene.layers) > 10
    assert scene.parameters["width"] == 300
    assert scene.edits == []
    assert "300 x 200 px" in repr(scene)


def test_sizes_may_be_lengths(library):
    scene = vtex.synthesize(library, "300mmx100mm", dpi=30)
    assert (scene.width, scene.height, scene.page) == (354, 118, ("300mm", "100mm"))
    assert scene == vtex.synthesize(library, ("300mm", "100mm"), dpi=30)
    assert b'width="300mm" height="100mm"' in scene.svg().encode()
    assert vtex.synthesize(library, (90, 60), dpi=150).page == ("15.24mm", "10.16mm")
    assert vtex.synthesize(library, 90).page is None
    for wrong in ("9kg", "300", ("3m", "1kg")):
        with pytest.raises(vtex.InputError, match="size"):
            vtex.synthesize(library, wrong)
    with pytest.raises(vtex.InputError, match="dpi"):
        vtex.synthesize(library, "3m", dpi=0)


def test_the_size_is_a_number_a_pair_or_the_default(library):
    assert (vtex.synthesize(library, 90).width, vtex.synthesize(library, 90).height) == (90, 90)
    by_numpy = vtex.synthesize(library, np.array([80, 70]))
    assert (by_numpy.width, by_numpy.height) == (80, 70)


def test_seeds_decide(library, scene):
    assert vtex.synthesize(library, (300, 200), seed=7) == scene
    assert vtex.synthesize(library, (300, 200), seed=8) != scene
    most = 2**64 - 1
    assert vtex.synthesize(library, 60, seed=most).seed == most


def test_results_do_not_depend_on_threads(library, scene, photo_path):
    before = vtex.get_threads()
    try:
        vtex.set_threads(1)
        assert vtex.get_threads() == 1
        alone = vtex.analyze(photo_path), vtex.synthesize(library, (300, 200), seed=7)
        vtex.set_threads(3)
        assert alone == (library, scene)
        assert vtex.synthesize(library, (300, 200), seed=7) == scene
    finally:
        vtex.set_threads(None)
    assert vtex.get_threads() == before


def test_tiles_continue_at_their_borders(library):
    tile = vtex.synthesize(library, 160, tile="both")
    assert tile.tile == "both" and "both axes" in repr(tile)
    assert vtex.synthesize(library, 60, tile=True).tile == "both"
    assert vtex.synthesize(library, 60, tile=False).tile == "none"
    image = tile.render().astype(int)
    across = np.abs(image[:, 0] - image[:, -1]).mean()
    within = np.abs(np.diff(image, axis=1)).mean()
    assert across < 2 * within


def test_scenes_are_written_in_every_format(scene, tmp_path):
    starts = {
        "out.svg": b"<?xml",
        "out.svgz": b"\x1f\x8b",
        "out.pdf": b"%PDF",
        "out.png": b"\x89PNG",
        "out.scene.json": b'{"format":"vtex-scene"',
        "out.scene.json.gz": b"\x1f\x8b",
    }
    for name, start in starts.items():
        size = scene.save(tmp_path / name)
        data = (tmp_path / name).read_bytes()
        assert data.startswith(start) and len(data) == size, name
    assert scene.svg() == (tmp_path / "out.svg").read_text(encoding="utf-8")
    assert scene.png() == (tmp_path / "out.png").read_bytes()
    assert scene.pdf().startswith(b"%PDF")
    assert vtex.Scene.read(tmp_path / "out.scene.json") == scene
    assert vtex.Scene.read(str(tmp_path / "out.scene.json.gz")) == scene


def test_own_files_are_replaced_and_others_only_by_force(scene, tmp_path):
    path = tmp_path / "out.svg"
    scene.save(path)
    scene.save(path)
    path.write_text("mine")
    with pytest.raises(FileExistsError) as error:
        scene.save(path)
    assert isinstance(error.value, vtex.FileError) and "force=True" in error.value.hint
    assert path.read_text() == "mine"
    scene.save(path, force=True)
    assert path.read_text(encoding="utf-8") == scene.svg()


def test_svgs_are_as_asked_for(scene):
    plain = scene.svg()
    assert len(scene.svg(precision=0)) < len(plain) < len(scene.svg(precision=3))
    assert "<use" not in scene.svg(expand=True)
    assert "<style" in scene.svg(css=True) and "<style" not in plain
    most = len(plain) * 2 // 3
    assert len(scene.svg(max_bytes=most)) <= most
    assert "#123456" in scene.svg(background="#123456")
    assert scene.svg(background="transparent") == scene.svg(background="none") != plain


def test_pdfs_are_as_small_as_asked_for(scene, tmp_path):
    whole = scene.pdf()
    most = len(whole) * 9 // 10
    small = scene.pdf(max_bytes=most)
    assert len(small) <= most
    scene.save(tmp_path / "small.pdf", max_bytes=most)
    assert (tmp_path / "small.pdf").read_bytes() == small
    for tiny in (lambda: scene.pdf(max_bytes=1), lambda: scene.save(tmp_path / "tiny.pdf", max_bytes=1)):
        with pytest.raises(vtex.InputError, match="no PDF of the scene fits in 1 bytes"):
            tiny()
    assert not (tmp_path / "tiny.pdf").exists()


def test_options_without_effect_are_told(scene, tmp_path):
    with pytest.warns(vtex.VtexWarning, match=r"max_bytes has no effect here: it is for \.svg, \.svgz and \.pdf"):
        scene.save(tmp_path / "out.png", max_bytes=1000)
    with pytest.warns(vtex.VtexWarning, match=r"scale has no effect here: it is for \.png"):
        scene.save(tmp_path / "out.svg", scale=2)
    assert (tmp_path / "out.svg").read_text(encoding="utf-8") == scene.svg()


def test_names_of_other_formats_are_refused(scene, library, tmp_path):
    with pytest.raises(vtex.InputError) as error:
        scene.save(tmp_path / "out.lib.json")
    assert error.value.hint == "names end in .svg, .svgz, .pdf, .png, .scene.json or .scene.json.gz"
    with pytest.raises(vtex.InputError) as error:
        library.save(tmp_path / "out.svg")
    assert error.value.hint == "names end in .lib.json or .lib.json.gz"
    assert not list(tmp_path.iterdir())


def test_pictures_have_their_scale_and_background(scene):
    image = scene.render()
    assert image.shape == (200, 300, 3) and image.dtype == np.uint8 and image.flags.c_contiguous
    assert scene.render(scale=2).shape == (400, 600, 3)
    clear = scene.render(background="none", alpha=True)
    assert clear.shape == (200, 300, 4) and clear[..., 3].min() == 0 and clear[..., 3].max() == 255
    red = scene.render(background="red")
    assert (red == [255, 0, 0]).all(axis=2).any()
    # Over white where nothing else is asked for.
    where = clear[..., 3] == 0
    assert (scene.render(background="none")[where] == 255).all()


def test_libraries_are_saved_and_read(library, tmp_path):
    for name in ("a.lib.json", "a.lib.json.gz"):
        assert library.save(tmp_path / name) == (tmp_path / name).stat().st_size
        assert vtex.Library.read(tmp_path / name) == library
    assert library.to_dict()["format"] == "vtex-library"
    assert vtex.Library.from_bytes(library.to_bytes()) == library
    assert vtex.Library.from_bytes(json.dumps(library.to_dict()).encode()) == library


def test_reconstructions_look_like_their_exemplar(library, pixels):
    back = vtex.reconstruct(library)
    assert (back.width, back.height, back.seed, back.parameters) == (160, 128, None, None)
    near = vtex.metrics(pixels, back)
    far = vtex.metrics(pixels, np.random.default_rng(0).integers(0, 256, pixels.shape, dtype=np.uint8))
    assert near["ssim"] > far["ssim"] and near["emd_rgb"] < far["emd_rgb"]


def test_metrics_of_equal_pictures_are_zero(pixels, photo_path, scene):
    same = vtex.metrics(photo_path, pixels)
    assert same["emd_rgb"] == 0 and same["ssim"] == pytest.approx(1)
    assert set(same) == set(vtex.Metrics.__annotations__)
    assert set(same["structure"][0]) == set(vtex.Spread.__annotations__)
    assert vtex.metrics(scene, scene.svg().encode())["ssim"] > 0.9
    halved = vtex.metrics(pixels, np.kron(pixels, np.ones((2, 2, 1), np.uint8)), scale=2)
    assert halved["result_size"] == [160, 128]


def test_drawings_are_exemplars_too():
    library = vtex.analyze(ROOT / "examples" / "drawings" / "garden.svg")
    assert library.is_drawing and library.primaries > 3
    small = vtex.synthesize(library, 200)
    assert small.render().shape == (200, 200, 3)
    text = (ROOT / "examples" / "drawings" / "garden.svg").read_text(encoding="utf-8")
    for form in (text, "\ufeff\n" + text, text[text.index("<svg") :]):
        again = vtex.analyze(form, name="garden.svg")
        assert again.to_dict()["elements"] == library.to_dict()["elements"]
    assert vtex.analyze(text).file.endswith(".svg")
    if library.is_periodic:
        whole = vtex.synthesize(library)
        assert whole.width % library.width == 0 and whole.height % library.height == 0


def test_swatches_of_one_ink_are_recoloured_and_fill():
    swatch = """<svg xmlns="http://www.w3.org/2000/svg" width="40" height="40"><path d="M8 8h6v6h-6z"/>
    <path d="M18 31l7 3M-3 20h6M37 20h6" fill="none" stroke="#000"/><circle cx="30" cy="9" r="4" fill="#fff"/></svg>"""
    library = vtex.analyze(swatch, wrap=True, name="swatch.svg")
    scene = vtex.synthesize(library, 40, tile="both", variation=0, seed=1)
    assert 'class="ink" color="#000"' in scene.svg()
    red = scene.render(ink="#c00", background="navy")
    assert red[11, 11].tolist() == [204, 0, 0] and red[9, 30].tolist() == [0, 0, 128]
    tile = scene.svg(pattern=True, ink="#c00", background="navy")
    assert '<pattern id="texture"' in tile and "<symbol" not in tile and 'color="#c00"' in tile
    with pytest.raises(vtex.InputError, match="cannot be transparent"):
        scene.png(ink="red", background="none")
    with pytest.raises(vtex.InputError, match="ink"):
        scene.pdf(ink="nothing")
    with pytest.raises(vtex.InputError, match="both axes"):
        vtex.synthesize(library, 40, seed=1).svg(pattern=True)


def test_pictures_of_lines_become_drawings_of_strokes():
    page = np.full((120, 200), 245, np.uint8)
    for row in range(15, 120, 20):
        page[row : row + 3] = 30
    library = vtex.analyze(page, kind="curves", name="lines")
    assert library.is_drawing and library.primaries >= 6
    texture = vtex.synthesize(library, size=(300, 200), seed=1)
    assert texture.parameters["method"] == "curves" and "stroke-width" in texture.svg()
    with pytest.raises(vtex.InputError, match="no lines stand out"):
        vtex.analyze(np.full((120, 200), 245, np.uint8), kind="curves")


def test_motifs_of_drawings_are_found():
    places = [(20, 30), (120, 60), (60, 140)]
    bar = '<path d="M{} {}h24v4h-24z"/>'
    pairs = "".join(bar.format(x, y) + bar.format(x, y + 12) for x, y in places)
    text = f'<svg xmlns="http://www.w3.org/2000/svg" width="200" height="200">{pairs}</svg>'
    assert [len(motif["parts"]) for motif in vtex.analyze(text).to_dict()["motifs"]] == [2, 2, 2]
    assert "motifs" not in vtex.analyze(text, group="none").to_dict()


def test_several_libraries_share_a_canvas(library, pixels):
    dark = vtex.analyze((pixels // 3).astype(np.uint8), name="dark", segmenter="regions")
    ramp = np.zeros((4, 100))
    ramp[:, 50:] = 1
    mixed = vtex.synthesize([library, dark], (300, 150), map=ramp)
    assert mixed.exemplars == [library.file, "dark"]
    image = mixed.render().mean(axis=2)
    assert image[:, :120].mean() > 1.5 * image[:, 180:].mean()
    masks = [np.full((2, 2), 1.0), np.full((2, 2), 0.0)]
    only = vtex.synthesize([library, dark], 150, map=masks)
    assert only.render().mean() > 1.5 * vtex.synthesize(dark, 150).render().mean()


def test_pictures_steer(library):
    density = np.ones((10, 10))
    density[:, 5:] = 0.0
    half = vtex.synthesize(library, 300, density=density)
    full = vtex.synthesize(library, 300)
    assert half.layers[2].instances < 0.8 * full.layers[2].instances
    # An array of greys means the same as its picture.
    greys = np.where(density > 0, 128, 0).astype(np.uint8)
    from io import BytesIO

    from PIL import Image

    file = BytesIO()
    Image.fromarray(greys).save(file, "PNG")
    assert vtex.synthesize(library, 300, density=greys) == vtex.synthesize(library, 300, density=file.getvalue())
    disc = np.hypot(*np.mgrid[-1:1:64j, -1:1:64j]) < 0.7
    shaped = vtex.synthesize(library, 200, domain=disc)
    alpha = shaped.render(alpha=True)[..., 3]
    assert alpha[100, 100] == 255 and alpha[2, 2] == 0


def test_regions_are_filled_and_made_anew_beside_a_drawing():
    drawing = (ROOT / "examples" / "drawings" / "cells.svg").read_bytes()
    library = vtex.analyze(drawing)
    right = b'<svg xmlns="http://www.w3.org/2000/svg" width="300" height="300"><path d="M150 0h150v300h-150z"/></svg>'
    made = vtex.synthesize(library, seed=1, context=drawing, region=right, anew=True, source=right)
    assert made == vtex.synthesize(library, seed=1, context=drawing, region=right, anew=True, source=right)
    layers = {layer["name"]: layer for layer in made.to_dict()["layers"]}
    assert len(layers["drawn"]["instances"]) > 5 and len(layers["predicted"]["instances"]) > 5
    for wrong in ({"anew": True}, {"source": right}, {"context": drawing}):
        with pytest.raises(vtex.InputError, match="context"):
            vtex.synthesize(library, **wrong)


@pytest.mark.parametrize(
    ("schema", "definition", "function"),
    [
        ("library", "AnalyzeParams", vtex.analyze),
        ("scene", "SynthParams", vtex.synthesize),
    ],
)
def test_parameters_have_the_names_and_defaults_of_the_schema(schema, definition, function):
    document = json.loads((ROOT / "schema" / f"{schema}.schema.json").read_text())
    fields = document["$defs"][definition]["properties"]
    signature = inspect.signature(function).parameters
    # Some have another form.
    named = {"width": "size", "height": "size", "page": "size"}
    differently = {"width", "height", "page", "weights", "tile", "wrap"}
    # Defaults that files leave out, and schemas with them.
    unstored = {"group": "auto", "kind": "photo", "contrast": "auto", "even_light": "auto", "exclude": []}
    for name, field in fields.items():
        assert named.get(name, name) in signature, name
        if name not in differently:
            given = signature[name].default
            given = list(given) if isinstance(given, tuple) else given
            assert given == field.get("default", unstored.get(name)), name


def test_every_public_name_is_documented():
    for name in vtex.__all__:
        thing = getattr(vtex, name)
        if callable(thing):
            assert (thing.__doc__ or "").strip(), name
    assert vtex.__version__ == re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)[1]
    assert (Path(vtex.__file__).parent / "py.typed").exists()


def test_notebooks_show_and_store_one_picture(scene, library):
    for thing in (scene, library):
        shown = thing._repr_mimebundle_()
        assert list(shown) == ["image/svg+xml"] and shown["image/svg+xml"].startswith("<?xml")
        assert list(thing._repr_mimebundle_(exclude={"image/svg+xml"})) == ["image/png"]
        assert list(thing._repr_mimebundle_(include=["image/png"])) == ["image/png"]
        assert thing._repr_mimebundle_(include=["text/html"]) == {}
        assert not hasattr(thing, "_repr_svg_") and not hasattr(thing, "_repr_png_")


def test_notebooks_show_pixels_of_what_is_long(library):
    from io import BytesIO

    from PIL import Image

    large = vtex.synthesize(library, (1300, 350))
    assert len(large.svg().encode()) > 1_000_000
    shown = large._repr_mimebundle_()
    assert list(shown) == ["image/png"]
    assert Image.open(BytesIO(shown["image/png"])).size == (800, 215)
    assert list(large._repr_mimebundle_(exclude=["image/png"])) == ["image/svg+xml"]


def test_categories_have_names_and_colours(library, scene):
    listed = library.categories
    assert [category.number for category in listed] == list(range(1, len(listed) + 1))
    assert len({category.name for category in listed}) == len(listed)
    assert sum(category.count for category in listed) == library.primaries
    assert sum(category.coverage for category in listed) == pytest.approx(library.coverage, abs=0.01)
    for category in listed + scene.categories:
        assert re.fullmatch("#[0-9a-f]{6}", category.colour) and category.color == category.colour
        assert category.name and category.library == 0
    for made in (scene, vtex.reconstruct(library), scene.edit(vtex.Tint("red", amount=1.0))):
        assert all(category.name == listed[category.number - 1].name for category in made.categories)
    assert sum(category.count for category in scene.categories) == scene.layers[2].instances
    assert 0 < sum(category.coverage for category in scene.categories) < 1
    red = scene.edit(vtex.Tint("red", amount=1.0, layer="primary")).categories
    assert {category.colour for category in red} == {"#ff0000"}


def test_photographs_are_drawn_in_vectors(photo_path, pixels):
    drawn = vtex.vectorize(photo_path)
    assert (drawn.width, drawn.height, drawn.tile, drawn.parameters) == (160, 128, "none", None)
    assert vtex.metrics(pixels, drawn)["ssim"] > 0.5
    poster = vtex.vectorize(pixels, colours=4, max_paths=100, detail_scale=20.0)
    assert len(poster.svg()) < len(drawn.svg()) / 2
    assert poster == vtex.vectorize(pixels, colors=4, max_paths=100, detail_scale=20.0)
    with pytest.raises(TypeError, match="sizes"):
        vtex.vectorize(pixels, sizes=3)
    with pytest.raises(vtex.Interrupted):
        vtex.vectorize(pixels, progress=lambda *_: False)


def test_both_spellings_are_taken(pixels, scene):
    quick = {"segmenter": "felzenszwalb"}
    assert vtex.analyze(pixels, colours=5, **quick) == vtex.analyze(pixels, colors=5, **quick)
    for one, other in (
        (vtex.Tint(color="red"), vtex.Tint("red")),
        (vtex.Tint(color="red", amount=0.2), vtex.Tint(colour="red", amount=0.2)),
        (vtex.Outline(2, color="navy"), vtex.Outline(2, "navy")),
        (vtex.Vary(color=0.5), vtex.Vary(colour=0.5)),
        (vtex.Palette(colors=["red", "tan"]), vtex.Palette(["red", "tan"])),
    ):
        assert one == other and scene.edit(one) == scene.edit(other)
    assert vtex.Tint("red").color == "red" and vtex.Palette(["tan"]).colors == ["tan"]
    assert not hasattr(vtex.Thin(0.5), "color")
    drawn = [vtex.stylize(pixels, scene, keep=keep, longer_side=100) for keep in ("color", "colour")]
    assert drawn[0] == drawn[1]
    for wrong in (
        lambda: vtex.Tint(color="red", colour="red"),
        lambda: vtex.Tint("red", color="red"),
        lambda: vtex.Thin(0.5, color="red"),
        lambda: vtex.analyze(pixels, colors=5, colours=5),
        lambda: vtex.analyze(pixels, colour=5),
    ):
        with pytest.raises(TypeError, match="colo"):
            wrong()
