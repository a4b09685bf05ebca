"""Scenes to scene: bent, between two, with the appearance of others; and pictures redrawn in elements."""

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

    Elements move, gaps are filled with new ones, and where they crowd some go. Either `stretch` is given,
    or `cage` and `to`. The same scene, libraries, parameters and seed give the same as the program
    ``vtex warp``.

    Parameters
    ----------
    scene : Scene
        The scene.
    library : Library or sequence of Library
        The libraries that it was made from, in any order.
    stretch : float or (float, float), optional
        Factor of the canvas's sides, or those of its width and height, 0.1 to 10 each.
    cage : path, bytes or file, optional
        The cage before: an SVG with one closed path, drawn over the scene, an SVG's pixel for a pixel.
    to : path, bytes or file, optional
        The cage after: a copy whose points have been moved; its page is the new canvas.
    edge : {"keep", "clip", "avoid"}, optional
        Whether elements at the edge of the new shape are kept whole, clipped, or none crosses it. Default:
        as in the scene.
    seed : int, optional
        Seed of the new elements, 0 to 2**64 - 1. Default: the scene's own.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.

    Returns
    -------
    Scene
        The scene of another shape; it does not tile.

    Raises
    ------
    InputError
        If a factor is out of range, the cages do not correspond, or the scene was made from other libraries.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
    Interrupted
        If `progress` returned False.
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
    """Make the scenes between two: elements move and change into those of the other.

    Either `at` or `morph` is given. The same scenes give the same as the program ``vtex animate``.

    Parameters
    ----------
    first, second : Scene
        The scenes, of one size.
    at : float or sequence of float, optional
        How far along the way, 0 (the first) to 1 (the second). A sequence, such as
        ``numpy.linspace(0, 1, 30)``, gives a scene for each: the frames of an animation, for which elements
        are paired only once.
    morph : {"x", "y", "radial"} or picture, optional
        For one scene that turns into the other over the canvas: from left to right, from top to bottom,
        from the middle to the sides, or by a grey picture stretched over it, black (0.0) the first and
        white (1.0) the second.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.

    Returns
    -------
    Scene or list of Scene
        A list if `at` is a sequence.

    Raises
    ------
    InputError
        If the scenes differ in size, or a number is out of range.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
    Interrupted
        If `progress` returned False.
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
    """Give the arrangement of one texture the appearance of others.

    Every element keeps its place, size and direction. What is too thin to be drawn anew keeps its shape.
    A library stands for its exemplar as it is. The same textures, parameters and seed give the same as the
    program ``vtex transfer``.

    Parameters
    ----------
    structure : Scene or Library
        The texture whose arrangement is kept.
    appearance : Scene, Library or sequence of these
        The texture whose appearance is taken over; several share the canvas by `map`.
    map : picture or sequence of pictures, optional
        Which appearance is where, for several: one grey picture for two (black the first, white the second),
        one with a colour for each, or a grey one for each (floats are shares, 0 to 1).
    mode : {"replace", "mean"}, default "replace"
        Whether each element is replaced by one drawn at random, or takes over mean colours only.
    element_scale : float, default 1.0
        Factor of the size of elements, 0.01 to 100.
    seed : int, default 0
        Seed of random choices, 0 to 2**64 - 1.

    Returns
    -------
    Scene
        The texture. Elements that are gone, because the appearance has none of their role, are warned of.

    Raises
    ------
    InputError
        If a parameter is out of range, or what is given does not go together.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
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
    """Redraw any picture in the elements of a texture.

    Elements follow the edges of the picture, and are small where it has detail. The same picture, texture,
    parameters and seed give the same as the program ``vtex transfer --onto``.

    Parameters
    ----------
    picture : path, bytes, file, numpy.ndarray or PIL.Image.Image
        The picture, of any of the forms that `analyze` takes for a photograph.
    texture : Scene or Library
        The texture whose elements are used.
    keep : {"color", "colour", "lightness", "none"}, default "color"
        Whether elements take the picture's colours, its lightness, or keep their own, the nearest being used.
    longer_side : int, default 1000
        Longer side of the canvas, 32 to 16384 pixels; the other follows from the picture's proportions.
    element_size : float, optional
        Distance of the largest elements, 2 to 1000 pixels. Default: a 28th of the longer side.
    levels : int, default 4
        Number of sizes of elements, each half the one before, 1 to 6.
    seed : int, default 0
        Seed of random choices, 0 to 2**64 - 1.

    Returns
    -------
    Scene
        The picture in elements.

    Raises
    ------
    InputError
        If the picture cannot be used, a parameter is out of range, or the elements would be too many.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
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
