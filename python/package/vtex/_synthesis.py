"""From libraries to a scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from vtex import _inputs, _vtex
from vtex._errors import InputError, InputTypeError
from vtex._library import Library
from vtex._scene import Scene

_MOST_LIBRARIES = 16
_MOST_DPI = 9600


def synthesize(
    library: Library | Sequence[Library],
    size: _inputs.Size | None = None,
    *,
    dpi: int | None = None,
    seed: int = 0,
    method: Literal["auto", "correspondence", "descriptor", "period", "clustered", "curves"] = "auto",
    variation: float | None = None,
    lattice: str | Sequence[float] = "auto",
    candidates: int = 20,
    moves: int = 5,
    weights: Sequence[float] = (0.5, -0.4, -0.2, -0.5, -0.5),
    background_spacing: float | None = None,
    tile: bool | Literal["none", "both", "x", "y"] = "none",
    rotate: float | None = None,
    mirror: bool = False,
    scale_jitter: float = 0.0,
    edge: Literal["keep", "clip", "avoid"] = "clip",
    exclude: Sequence[str] = (),
    ablate: Sequence[str] = (),
    domain: _inputs.Picture | None = None,
    density: _inputs.Picture | None = None,
    map: _inputs.Picture | Sequence[_inputs.Picture] | None = None,
    control: _inputs.Picture | None = None,
    guide: _inputs.Picture | None = None,
    context: _inputs.Picture | None = None,
    region: _inputs.Picture | None = None,
    anew: bool = False,
    source: _inputs.Picture | None = None,
    progress: _inputs.Progress | None = None,
) -> Scene:
    """Make a texture of any size that looks like the exemplar of a library.

    The same libraries, parameters and seed give the same scene, on any number of threads. The program ``vtex synth``
    makes the same scene. Lengths are in pixels of the canvas.

    `domain`, `density`, `map`, `control` and `guide` accept pictures, which vtex stretches over the canvas. A picture
    is a path, bytes, an open file, an image of Pillow or an array. An array is height x width (greys of uint8, or
    floats in the range below) or height x width x 3 of uint8.

    Parameters
    ----------
    library : Library or sequence of Library
        One library, or up to 16. With several libraries, `map` sets where to use which.
    size : int, str, or a pair of them, optional
        Width and height of the canvas, 1 to 100 000 pixels each, at most 400 megapixels. For a drawing, one pixel is
        one unit of the drawing. Or width and height of the page, in mm, cm, m, in or pt: ``"300mm"``, ``"3mx1m"`` or
        ``("3m", "1m")``. Files state this size exactly. Default: 1000. For the library of one drawing, three by three
        of its pages, or fewer if these have very many elements. Files then show the longer side at 900 pixels.
    dpi : int, optional
        Pixels of the canvas per inch of the page, 1 to 9600. Default: with a `size` in lengths, the canvas has as many
        pixels as the default canvas. So elements are as large in relation to the page as on the default canvas. A
        `size` in pixels sets no page.
    seed : int, default 0
        Seed of all random choices, 0 to 2**64 - 1.
    method : {"auto", "correspondence", "descriptor", "period", "clustered", "curves"}, default "auto"
        How vtex places elements:

        * ``"auto"``: the method that suits the library and the parameters
        * ``"correspondence"``: copies elements along a field from the exemplar to the canvas. This keeps structure
          larger than a few elements.
        * ``"descriptor"``: places elements one by one, by the descriptors of their neighbours
        * ``"period"``: repeats the period of a drawing whose opposite borders join
        * ``"clustered"``: arranges the elements of a drawing in a new way, as clusters of samples
        * ``"curves"``: makes new lines or cells, for a drawing of continuous lines or of cells side by side
    variation : float, optional
        For the method ``"period"``: share of the movable elements that leave their positions, 0 to 1. 0 repeats the
        drawing exactly. Default: 0 for a regular drawing, else 1. For ``"clustered"`` and ``"curves"``: how freely vtex
        rearranges the drawing, 0 to 1. Default: 1.
    lattice : "auto", "off" or sequence of two or four floats, default "auto"
        Rows or lattice that the texture keeps. ``"auto"`` keeps those that the analysis found, if they are regular
        everywhere. ``"off"`` keeps none. Numbers are one or two vectors in pixels of the exemplar, x before y. Each is
        at least 4 pixels long.
    candidates : int, default 20
        Number of elements compared for each position, with the method ``"descriptor"``, 1 to 1000. Half as many are
        compared for each gap that is filled, with ``"descriptor"`` and ``"correspondence"``.
    moves : int, default 5
        Maximum number of moves to a better position for each element, 0 to 100, with the methods ``"descriptor"`` and
        ``"correspondence"``.
    weights : sequence of five floats, default (0.5, -0.4, -0.2, -0.5, -0.5)
        Weights of the areas in the score of a placement: target, uncovered, empty, mismatched and same-overlap. Each is
        -10 to 10.
    background_spacing : float, optional
        Distance between the colour points of the background, 4 to 1000 pixels. Default: the same as in the library.
    tile : bool or {"none", "both", "x", "y"}, default "none"
        Axes along which the texture repeats without a seam. True = ``"both"``, False = ``"none"``.
    rotate : float, optional
        Maximum angle by which vtex turns elements at random in either direction, 0 to 180 degrees. Default: 0. But vtex
        turns and mirrors a small photograph without a direction.
    mirror : bool, default False
        Whether vtex mirrors half of the elements, chosen at random.
    scale_jitter : float, default 0.0
        Maximum random change of the size of an element, larger or smaller, 0 to 50 per cent.
    edge : {"clip", "keep", "avoid"}, default "clip"
        What happens to elements at the edge of a domain:

        * ``"clip"``: elements are clipped
        * ``"keep"``: elements remain whole
        * ``"avoid"``: no element crosses the edge
    exclude : sequence of str, default ()
        Names of categories whose elements are left out. vtex fills their positions with background.
    ablate : sequence of str, default ()
        Parts of the method that are left out, to see their effect:

        * "secondary", "overlap", "density", "decay", "improve", "growth", "removal", "copies", "seeds",
          "neighbourhoods", "matching"
        * of the method ``"clustered"``: "shape-context", "link", "shape", "switch", "merge", "split", "depth"
        * of the method ``"curves"``: "edge", "robust", "orientation", "existence", "patches", "mend"
    domain : picture or SVG, optional
        Shape that the texture fills: all filled shapes of an SVG together, fitted to the canvas. Or a mask, in which
        white (1.0) is inside. If the mask has transparent pixels, its opaque area is inside. Default: the whole canvas.
    density : picture, optional
        Density relative to the exemplar: black = 0, middle grey = 1, white = 2. Floats are densities, 0 to 2.
    map : picture or sequence of pictures, optional
        Where to use which of several libraries. Use one of these forms:

        * one grey picture for two libraries: black = the first, white = the second
        * one picture with one colour for each library
        * one grey picture for each library. Floats are shares, 0 to 1.
    control : picture, optional
        Map of the layers on the canvas, in the colours of the library's layers. For one library only.
    guide : picture, optional
        Picture whose light and dark areas the texture follows. Floats are lightness, 0 to 1. You cannot combine it with
        `control`.
    context : SVG, optional
        Existing drawing that vtex keeps, in the units of the library's drawing. vtex fits the new part in `region` to
        its lines or elements. The canvas is the page of this SVG, unless you give `size`. In the scene, the existing
        drawing is the layer `drawn`, and the new part is the layer `predicted`. This works with the library of one
        drawing, without `domain`, `density`, `map`, `control` and `guide`.
    region : SVG, optional
        Region that vtex fills beside `context`: all filled shapes of the SVG together, fitted to the canvas.
    anew : bool, default False
        Whether vtex empties the region first. It cuts strokes of `context` at the border of the region. It removes
        elements whose middle is in the region.
    source : SVG, optional
        Part of the library's drawing that vtex copies to the region and fits to the lines or elements around it. The
        part is all filled shapes of the SVG together, fitted to the page of the library. Its middle moves to the middle
        of the region. Default: no copy.
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.

    Returns
    -------
    Scene
        The texture.

    Raises
    ------
    InputError
        If a parameter is out of range, or the arguments do not fit each other.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    Interrupted
        If `progress` returns False.
    """
    libraries = libraries_of(library)
    if isinstance(tile, (bool, np.bool_)):
        tile = "both" if tile else "none"
    if tile not in ("none", "both", "x", "y"):
        raise InputError(f"tile = {tile!r} cannot be used", "give True, False, 'none', 'both', 'x' or 'y'")
    names = ("target", "uncovered", "empty", "mismatched", "same_overlap")
    numbers = list(weights)
    if len(numbers) != len(names):
        raise InputError(f"weights has {len(numbers)} numbers, not {len(names)}")
    if control is not None and guide is not None:
        raise InputError("control and guide are both given", "give one of them")
    if control is not None and len(libraries) > 1:
        raise InputError(f"control is for a single library, {len(libraries)} are given")
    if (context is None) != (region is None):
        raise InputError("context and region go together", "give both, or neither")
    if context is None and (anew or source is not None):
        raise InputError("anew and source are for a context", "give context and region, too")
    if context is not None and any(v is not None for v in (domain, density, map, control, guide)):
        raise InputError("a context goes with nothing else that steers", "leave out the others")
    if dpi is not None and not (isinstance(dpi, (int, np.integer)) and 1 <= dpi <= _MOST_DPI):
        raise InputError(f"dpi = {dpi!r} is out of range: 1 to {_MOST_DPI}")
    sides = _inputs.size_of(size)
    lengths = sides if sides is not None and isinstance(sides[0], str) else None
    canvas = {"pixels": sides if lengths is None else None, "page": lengths, "dpi": None if dpi is None else int(dpi)}
    parameters = {
        "seed": _inputs.seed_of(seed),
        "method": method,
        "variation": variation,
        "lattice": lattice if isinstance(lattice, str) else ",".join(str(float(v)) for v in lattice),
        "candidates": candidates,
        "moves": moves,
        "weights": dict(zip(names, numbers, strict=True)),
        "background_spacing": background_spacing,
        "tile": {"x": tile in ("both", "x"), "y": tile in ("both", "y")},
        "rotate": rotate,
        "mirror": mirror,
        "scale_jitter": scale_jitter,
        "edge": edge,
        "exclude": [exclude] if isinstance(exclude, str) else list(exclude),
        "ablate": [ablate] if isinstance(ablate, str) else list(ablate),
    }
    maps = maps_of(map, len(libraries), "libraries")
    shape, densities = _inputs.picture(domain, "domain"), _inputs.picture(density, "density", 2.0)
    layers, lightness = _inputs.picture(control, "control"), _inputs.picture(guide, "guide")
    drawing, free = _inputs.picture(context, "context"), _inputs.picture(region, "region")
    beside = drawing, free, bool(anew), _inputs.picture(source, "source")
    cores = [library._core for library in libraries]
    steering = (shape, densities, maps, layers, lightness, *beside)
    return Scene._of(_vtex.synthesize(cores, _inputs.to_json(parameters), _inputs.to_json(canvas), *steering, progress))


def reconstruct(library: Library) -> Scene:
    """Draw the exemplar again from its library.

    Parameters
    ----------
    library : Library
        Library of the exemplar.

    Returns
    -------
    Scene
        A scene as large as the exemplar. Its `parameters` are None.
    """
    if not isinstance(library, Library):
        raise InputTypeError(f"{type(library).__name__} is no Library", "make one with vtex.analyze")
    return Scene._of(_vtex.reconstruct(library._core))


def libraries_of(given: Library | Sequence[Library]) -> list[Library]:
    """Return one library or several libraries as a list."""
    if not isinstance(given, (Library, Sequence)) or isinstance(given, (str, bytes)):
        hint = "make one with vtex.analyze, or read one with vtex.Library.read"
        raise InputTypeError(f"{type(given).__name__} is no Library", hint)
    several = [given] if isinstance(given, Library) else list(given)
    for library in several:
        if not isinstance(library, Library):
            raise InputTypeError(f"{type(library).__name__} is no Library", "make one with vtex.analyze")
    if not 1 <= len(several) <= _MOST_LIBRARIES:
        raise InputError(f"{len(several)} libraries are given, not 1 to {_MOST_LIBRARIES}")
    return several


def maps_of(given: _inputs.Picture | Sequence[_inputs.Picture] | None, number: int, what: str) -> list[_inputs.Named]:
    """Return the maps that set where to use which of several things."""
    several: list[Any] = list(given) if isinstance(given, (list, tuple)) else [] if given is None else [given]
    if number == 1 and several:
        raise InputError(f"map is for several {what}, one is given")
    if number > 1 and len(several) not in (1, number):
        message = f"{len(several)} maps are given for {number} {what}"
        raise InputError(message, f"give one map for all {what}, or one for each")
    return [named for picture in several if (named := _inputs.picture(picture, "map")) is not None]
