"""What scenes are made into: bent, mixed, dressed as others; and pictures redrawn."""

import numpy as np
import pytest

import vtex

CAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="200"><path d="M0 0H{0}V200H0Z"/></svg>'


@pytest.fixture(scope="module")
def dark(pixels):
    """The library of the photograph at a third of its light, with elements like those of `library`."""
    return vtex.analyze((pixels // 3).astype(np.uint8), name="dark")


@pytest.fixture(scope="module")
def night(dark):
    """A texture of it, of the size of `scene`."""
    return vtex.synthesize(dark, (300, 200), seed=3)


def light(scene: vtex.Scene) -> float:
    return float(scene.render().mean())


def test_a_stretched_scene_keeps_density_and_size_of_elements(scene, library):
    wide = vtex.warp(scene, library, (2, 1))
    assert (wide.width, wide.height) == (600, 200)
    assert wide.layers[2].instances == pytest.approx(2 * scene.layers[2].instances, rel=0.3)
    both = vtex.warp(scene, [library], 1.5)
    assert (both.width, both.height) == (450, 300)
    assert vtex.warp(scene, library, np.array([2, 1])) == wide
    assert vtex.warp(scene, library, (2, 1), seed=8) != wide


def test_cages_bend_a_scene(scene, library, tmp_path):
    before, after = CAGE.format(300).encode(), CAGE.format(400).encode()
    bent = vtex.warp(scene, library, cage=before, to=after)
    assert (bent.width, bent.height) == (400, 200)
    (tmp_path / "a.svg").write_bytes(before)
    with (tmp_path / "a.svg").open("rb") as file:
        assert vtex.warp(scene, library, cage=file, to=after) == bent
    inner = after.replace(b"M0 0H400V200H0Z", b"M100 50H300V150H100Z")
    small = vtex.warp(scene, library, cage=before, to=inner, edge="clip")
    assert small.render(alpha=True)[10, 10, 3] == 0 and small.render(alpha=True)[100, 200, 3] == 255


def test_scenes_between_two(scene, night):
    between = vtex.interpolate(scene, night, 0.5)
    assert light(night) < light(between) < light(scene)
    frames = vtex.interpolate(scene, night, np.linspace(0, 1, 3))
    assert frames == [scene, between, night]
    assert vtex.interpolate(scene, night, [0.5]) == [between] and vtex.interpolate(scene, night, []) == []


def test_a_scene_turns_into_another_over_the_canvas(scene, night):
    across = vtex.interpolate(scene, night, morph="x").render().mean(axis=(0, 2))
    assert across[-40:].mean() < 0.7 * across[:40].mean()
    down = vtex.interpolate(scene, night, morph="y").render().mean(axis=(1, 2))
    assert down[-40:].mean() < 0.7 * down[:40].mean()
    radial = vtex.interpolate(scene, night, morph="radial").render().mean(axis=2)
    assert radial[:20, :20].mean() < 0.7 * radial[80:120, 130:170].mean()
    # A map says where: the second on the left.
    left = np.repeat([[1.0, 0.0]], 2, axis=0)
    mapped = vtex.interpolate(scene, night, morph=left).render().mean(axis=(0, 2))
    assert mapped[:40].mean() < 0.7 * mapped[-40:].mean()


def test_an_arrangement_takes_another_appearance(scene, library, dark, night):
    dressed = vtex.transfer(scene, night)
    assert light(dressed) < 0.7 * light(scene)
    assert dressed.layers[2].instances == scene.layers[2].instances
    assert vtex.transfer(scene, night, seed=1) != dressed
    # A library stands for its exemplar as it is.
    assert vtex.transfer(library, dark) == vtex.transfer(vtex.reconstruct(library), vtex.reconstruct(dark))
    mean = vtex.transfer(scene, night, mode="mean")
    # They have other elements at other places: .99 to 1.22 over parts of the photograph and seeds.
    assert light(mean) == pytest.approx(light(night), rel=0.15)
    assert vtex.transfer(scene, scene) == scene
    assert vtex.transfer(scene, night, element_scale=0.5) != dressed


def test_several_appearances_share_the_canvas(scene, library, night):
    halves = np.repeat([[0.0, 1.0]], 2, axis=0)
    image = vtex.transfer(scene, [library, night], map=halves).render().mean(axis=(0, 2))
    assert image[-40:].mean() < 0.7 * image[:40].mean()
    masks = [halves, 1 - halves]
    turned = vtex.transfer(scene, (library, night), map=masks).render().mean(axis=(0, 2))
    assert turned[:40].mean() < 0.7 * turned[-40:].mean()


def test_elements_that_go_are_warned_of(scene, pixels):
    masks = np.zeros(pixels.shape[:2], np.uint8)
    masks[20:50, 20:60] = 1
    bare = vtex.analyze(pixels, masks=masks, secondary_minimum=300, secondary_maximum=300)
    assert bare.layers[1].instances == 0
    with pytest.warns(vtex.VtexWarning, match="elements are gone") as seen:
        vtex.transfer(scene, bare)
    assert seen[0].filename == __file__


def test_a_picture_is_redrawn_in_elements(library, scene, photo_path, pixels):
    ramp = np.tile(np.linspace(0, 255, 90).astype(np.uint8), (60, 1))
    drawn = vtex.stylize(ramp, library, longer_side=240)
    assert (drawn.width, drawn.height) == (240, 160)
    columns = drawn.render().mean(axis=(0, 2))
    assert columns[200:].mean() > 2 * columns[:40].mean()
    few = vtex.stylize(ramp, library, longer_side=240, levels=1, element_size=30)
    assert 0 < few.instances < drawn.instances
    assert vtex.stylize(ramp, library, longer_side=240, keep="lightness") != drawn
    # Pictures come in the forms of photographs, textures in those of `transfer`.
    assert vtex.stylize(photo_path, scene, longer_side=100) == vtex.stylize(pixels, scene, longer_side=100)


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda s, a: vtex.warp(s, a), ValueError, "stretch, or cage and to"),
        (lambda s, a: vtex.warp(s, a, 2, cage=b"<svg/>", to=b"<svg/>"), ValueError, "stretch, or cage and to"),
        (lambda s, a: vtex.warp(s, a, 2, cage=b"<svg/>"), ValueError, "stretch, or cage and to"),
        (lambda s, a: vtex.warp(s, a, to=b"<svg/>"), ValueError, "stretch, or cage and to"),
        (lambda s, a: vtex.warp(s, a, 11), ValueError, "stretch = 11 is out of range: 0.1 to 10"),
        (lambda s, a: vtex.warp(s, a, (1, float("nan"))), ValueError, "stretch = nan"),
        (lambda s, a: vtex.warp(s, a, (1, 2, 3)), TypeError, "stretch"),
        (lambda s, a: vtex.warp(s, a, "2"), TypeError, "stretch"),
        (lambda s, a: vtex.warp(s, a, 2, edge="soft"), ValueError, "soft"),
        (lambda s, a: vtex.warp(s, a, 2, seed=-1), ValueError, "seed"),
        (lambda s, a: vtex.warp(s, [a, a], 2), ValueError, "the scene was made without it"),
        (lambda s, a: vtex.warp(s, s, 2), TypeError, "Scene is no Library"),
        (lambda s, a: vtex.warp(a, a, 2), TypeError, "Library is no Scene"),
        (lambda s, a: vtex.warp(s, a, cage=b"no svg", to=b"no svg"), ValueError, "svg|SVG|drawing"),
        (lambda s, a: vtex.interpolate(s, s), ValueError, "at or morph"),
        (lambda s, a: vtex.interpolate(s, s, 0.5, morph="x"), ValueError, "at or morph"),
        (lambda s, a: vtex.interpolate(s, s, 1.5), ValueError, "at = 1.5 is out of range: 0 to 1"),
        (lambda s, a: vtex.interpolate(s, s, [0, "1"]), TypeError, "at = '1'"),
        (lambda s, a: vtex.interpolate(s, s, True), TypeError, "at = True"),
        (lambda s, a: vtex.interpolate(s, s, morph="z.png"), OSError, "z.png"),
        (lambda s, a: vtex.interpolate(s, s, morph=np.full((2, 2), 3.0)), ValueError, "0 to 1"),
        (lambda s, a: vtex.interpolate(s, a, 0.5), TypeError, "Library is no Scene"),
        (lambda s, a: vtex.interpolate(s, vtex.reconstruct(a), 0.5), ValueError, "300x200"),
        (lambda s, a: vtex.transfer(s, []), ValueError, "no appearance"),
        (lambda s, a: vtex.transfer(s, "a.lib.json"), TypeError, "str is neither"),
        (lambda s, a: vtex.transfer(s, [a, a]), ValueError, "0 maps are given for 2 appearances"),
        (lambda s, a: vtex.transfer(s, a, map=np.ones((2, 2))), ValueError, "several appearances"),
        (lambda s, a: vtex.transfer(s, a, mode="all"), ValueError, "all"),
        (lambda s, a: vtex.transfer(s, a, element_scale=0), ValueError, "element_scale = 0 is out of range"),
        (lambda s, a: vtex.stylize(None, a), TypeError, "NoneType"),
        (lambda s, a: vtex.stylize(b"no picture", a), ValueError, "cannot decode"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), None), TypeError, "neither"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), a, levels=7), ValueError, "levels = 7"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), a, levels=1.0), TypeError, "levels"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), a, longer_side=9), ValueError, "longer_side = 9"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), a, element_size=1), ValueError, "element_size = 1"),
        (lambda s, a: vtex.stylize(np.zeros((40, 40, 3), np.uint8), a, keep="hue"), ValueError, "hue"),
    ],
)
def test_composing_refuses(scene, library, call, kind, message):
    with pytest.raises(kind, match=message) as error:
        call(scene, library)
    assert isinstance(error.value, vtex.Error)


def test_a_scene_needs_its_own_libraries(scene, dark, night):
    with pytest.raises(vtex.InputError, match="it is not given") as error:
        vtex.warp(scene, dark, 2)
    assert "scene.exemplars" in error.value.hint
    with pytest.raises(vtex.InputError) as error:
        vtex.interpolate(scene, vtex.warp(night, dark, 2), 0.5)
    assert "vtex.warp" in error.value.hint
