"""From scenes to scenes: bent, blended, or with the appearance of others. And from pictures to scenes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from vtex import _inputs, _vtex
from vtex._errors import InputError, InputTypeError
from vtex._library import Library
from vtex._scene import Scene
from vtex._synthesis import libraries_of, maps_of


def warp(
    scene: Scene,
    library: Library | Sequence[Library],
    stretch: float | tuple[float, float] | None = None,
    *,
    cage: _inputs.Picture | None = None,
    to: _inputs.Picture | None = None,
    edge: Literal["keep", "clip", "avoid"] | None = None,
    seed: int | None = None,
    progress: _inputs.Progress | None = None,
) -> Scene:
    """Bend or stretch a scene; its elements keep their size and density.

    vtex moves the elements. It fills gaps with new elements, and removes elements where they crowd. Give either
    `stretch`, or both `cage` and `to`. The same scene, libraries, parameters and seed give the same scene as the
    program ``vtex warp``.

    Parameters
    ----------
    scene : Scene
        The scene to bend.
    library : Library or sequence of Library
        The libraries that the scene was made from, in any order.
    stretch : float or (float, float), optional
        Factor of the canvas size, or one factor for the width and one for the height, 0.1 to 10 each.
    cage : path, bytes or file, optional
        The cage before: an SVG with one closed path, drawn over the scene. One pixel of the SVG is one pixel of the
        canvas.
    to : path, bytes or file, optional
        The cage after: a copy of `cage` with moved points. The page of this SVG is the new canvas.
    edge : {"keep", "clip", "avoid"}, optional
        What happens to elements at the edge of the new shape. Default: the same as in the scene.

        * ``"keep"``: elements remain whole
        * ``"clip"``: elements are clipped
        * ``"avoid"``: no element crosses the edge
    seed : int, optional
        Seed of the new elements, 0 to 2**64 - 1. Default: the seed of the scene.
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.

    Returns
    -------
    Scene
        The new scene. It does not tile.

    Raises
    ------
    InputError
        If a factor is out of range, the cages do not match, or the scene was made from other libraries.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    Interrupted
        If `progress` returns False.
    """
    given = [value is not None for value in (stretch, cage, to)]
    if given not in ([True, False, False], [False, True, True]):
        raise InputError("warp takes stretch, or cage and to", "give one number or two, or two SVGs")
    before, after = _inputs.picture(cage, "cage"), _inputs.picture(to, "to")
    cages = None if before is None or after is None else (before, after)
    factors = None if stretch is None else _inputs.pair("stretch", stretch)
    options = {
        "stretch": None if factors is None else [_inputs.number("stretch", factor, 0.1, 10) for factor in factors],
        "edge": edge,
        "seed": None if seed is None else _inputs.seed_of(seed),
    }
    cores = [library._core for library in libraries_of(library)]
    return Scene._of(_vtex.warp(_core(scene), cores, _inputs.to_json(options), cages, progress))


@overload
def interpolate(first: Scene, second: Scene, at: float, *, progress: _inputs.Progress | None = None) -> Scene: ...


@overload
def interpolate(
    first: Scene,
    second: Scene,
    at: Sequence[float] | npt.NDArray[np.floating[Any]],
    *,
    progress: _inputs.Progress | None = None,
) -> list[Scene]: ...


@overload
def interpolate(
    first: Scene,
    second: Scene,
    *,
    morph: Literal["x", "y", "radial"] | _inputs.Picture,
    progress: _inputs.Progress | None = None,
) -> Scene: ...


def interpolate(
    first: Scene,
    second: Scene,
    at: float | Sequence[float] | npt.NDArray[np.floating[Any]] | None = None,
    *,
    morph: Literal["x", "y", "radial"] | _inputs.Picture | None = None,
    progress: _inputs.Progress | None = None,
) -> Scene | list[Scene]:
    """Make the scenes between two scenes.

    The elements of the first scene move and change until they are those of the second. Give either `at` or `morph`. The
    same scenes give the same result as the program ``vtex animate``.

    Parameters
    ----------
    first, second : Scene
        The two scenes. Their canvases have the same size.
    at : float or sequence of float, optional
        Position between the scenes, 0 (the first) to 1 (the second). A sequence, such as ``numpy.linspace(0, 1, 30)``,
        gives one scene for each number: the frames of an animation. This is faster than single calls, because vtex
        pairs the elements only once.
    morph : {"x", "y", "radial"} or picture, optional
        Makes one scene that changes from the first to the second across the canvas:

        * ``"x"``: from left to right
        * ``"y"``: from top to bottom
        * ``"radial"``: from the middle to the sides
        * a grey picture, stretched over the canvas: black (0.0) = the first scene, white (1.0) = the second
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.

    Returns
    -------
    Scene or list of Scene
        A list if `at` is a sequence, else one scene.

    Raises
    ------
    InputError
        If the scenes differ in size, or a number is out of range.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    Interrupted
        If `progress` returns False.
    """
    ends = _core(first), _core(second)
    if (at is None) == (morph is None):
        raise InputError("interpolate takes at or morph", "give at=0.5 for the scene half-way, or morph='x'")
    if morph is not None:
        place = morph if isinstance(morph, str) and morph in ("x", "y", "radial") else "map"
        map = _inputs.picture(morph, "morph") if place == "map" else None
        return Scene._of(_vtex.morph(*ends, place, map, progress))
    at = at.tolist() if isinstance(at, np.ndarray) else at
    several = at if isinstance(at, Sequence) else [at]
    shares = [_inputs.number("at", share, 0, 1) for share in several]
    scenes = [Scene._of(core) for core in _vtex.interpolate(*ends, shares, progress)]
    return scenes if several is at else scenes[0]


def transfer(
    structure: Scene | Library,
    appearance: Scene | Library | Sequence[Scene | Library],
    *,
    map: _inputs.Picture | Sequence[_inputs.Picture] | None = None,
    mode: Literal["replace", "mean"] = "replace",
    element_scale: float = 1.0,
    seed: int = 0,
) -> Scene:
    """Combine the arrangement of one texture with the appearance of others.

    Every element keeps its position, size and direction. Extremely thin elements also keep their shape. From a library,
    vtex uses the arrangement of the exemplar itself. The same textures, parameters and seed give the same scene as the
    program ``vtex transfer``.

    Parameters
    ----------
    structure : Scene or Library
        The texture that gives the arrangement.
    appearance : Scene, Library or sequence of these
        The texture that gives the appearance. With several textures, `map` sets where to use which.
    map : picture or sequence of pictures, optional
        Where to use which of several appearances. Use one of these forms:

        * one grey picture for two appearances: black = the first, white = the second
        * one picture with one colour for each appearance
        * one grey picture for each appearance. Floats are shares, 0 to 1.
    mode : {"replace", "mean"}, default "replace"
        What elements take over. ``"replace"`` replaces each element by a random one of similar elongation. ``"mean"``
        keeps the shapes and shifts the colours to the mean colours of the appearance.
    element_scale : float, default 1.0
        Factor of the size of elements, 0.01 to 100.
    seed : int, default 0
        Seed of all random choices, 0 to 2**64 - 1.

    Returns
    -------
    Scene
        The new texture. If the appearance has no elements of a role, vtex removes the elements of this role and warns.

    Raises
    ------
    InputError
        If a parameter is out of range, or the arguments do not fit each other.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    """
    several: Sequence[Any] = appearance if isinstance(appearance, (list, tuple)) else [appearance]
    if not several:
        raise InputError("no appearance is given", "give a scene or a library")
    options = {
        "mode": mode,
        "element_scale": _inputs.number("element_scale", element_scale, 0.01, 100),
        "seed": _inputs.seed_of(seed),
    }
    maps = maps_of(map, len(several), "appearances")
    cores = [_texture(one) for one in several]
    return Scene._of(_vtex.transfer(_texture(structure), cores, _inputs.to_json(options), maps))


def stylize(
    picture: _inputs.Picture,
    texture: Scene | Library,
    *,
    keep: Literal["color", "colour", "lightness", "none"] = "color",
    longer_side: int = 1000,
    element_size: float | None = None,
    levels: int = 4,
    seed: int = 0,
) -> Scene:
    """Redraw any picture with the elements of a texture.

    Elements follow the edges in the picture. They are small where the picture has detail. The same picture, texture,
    parameters and seed give the same scene as the program ``vtex transfer --onto``.

    Parameters
    ----------
    picture : path, bytes, file, numpy.ndarray or PIL.Image.Image
        The picture, in any form that `analyze` accepts for a photograph.
    texture : Scene or Library
        The texture that gives the elements.
    keep : {"color", "colour", "lightness", "none"}, default "color"
        What elements take from the picture:

        * ``"color"`` or ``"colour"``: its colours
        * ``"lightness"``: only its lightness
        * ``"none"``: nothing. vtex uses the elements whose own colours are nearest to the picture.
    longer_side : int, default 1000
        Longer side of the canvas, 32 to 16384 pixels. The canvas has the proportions of the picture.
    element_size : float, optional
        Distance between the largest elements, 2 to 1000 pixels. Default: 1/28 of the longer side.
    levels : int, default 4
        Number of element sizes, 1 to 6. Each size is half of the one before.
    seed : int, default 0
        Seed of all random choices, 0 to 2**64 - 1.

    Returns
    -------
    Scene
        The picture, drawn with elements.

    Raises
    ------
    InputError
        If vtex cannot use the picture, a parameter is out of range, or there would be too many elements.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    """
    name, content = _inputs.photo(picture, None)
    options = {
        "keep": "color" if keep == "colour" else keep,
        "longer_side": _inputs.whole("longer_side", longer_side, 32, 16384),
        "element_size": None if element_size is None else _inputs.number("element_size", element_size, 2, 1000),
        "levels": _inputs.whole("levels", levels, 1, 6),
        "seed": _inputs.seed_of(seed),
    }
    return Scene._of(_vtex.stylize(name, content, _texture(texture), _inputs.to_json(options)))


def _core(scene: object) -> _vtex.Scene:
    if not isinstance(scene, Scene):
        hint = "make one with vtex.synthesize, or vtex.reconstruct of a library"
        raise InputTypeError(f"{type(scene).__name__} is no Scene", hint)
    return scene._core


def _texture(given: object) -> _vtex.Scene:
    if isinstance(given, (Scene, Library)):
        return given._as_scene()
    hint = "make one with vtex.analyze or vtex.synthesize"
    raise InputTypeError(f"{type(given).__name__} is neither Scene nor Library", hint)
