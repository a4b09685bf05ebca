"""Libraries to scene."""

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
    """Make a texture of any size like the exemplar of a library.

    The same libraries, parameters and seed give the same scene on any number of threads, and the same
    as the program ``vtex synth``. Lengths are pixels of the canvas. Pictures that steer are stretched
    over the canvas; they are paths, bytes, open files, images of Pillow, or arrays height x width (greys
    of uint8, or floats as said below) or height x width x 3 of uint8.

    Parameters
    ----------
    library : Library or sequence of Library
        What the texture is made of. Several, at most 16, share the canvas by `map`.
    size : int, str, or a pair of them, optional
        Width and height of the canvas, 1 to 100 000 pixels each, at most 400 megapixels; units of a drawing count as
        pixels. Or lengths in mm, cm, m, in or pt, as in ``"300mm"``, ``"3mx1m"`` or ``("3m", "1m")``: the size of the
        page, which files state exactly. Default: 1000, or three by three pages of a drawing, shown at 900 pixels.
    dpi : int, optional
        Pixels of the canvas per inch of its page, 1 to 9600. Default: as many pixels as the default size has for a size
        in lengths, so that elements are as large in relation to the page as they are there.
    seed : int, default 0
        Seed of random choices, 0 to 2**64 - 1.
    method : {"auto", "correspondence", "descriptor", "period", "clustered", "curves"}, default "auto"
        How elements are placed: carried from the exemplar along a field of correspondences, one by one
        by the descriptors of their neighbours, by the period of a drawing, by clusters of samples for a
        drawing, as curves for a drawing of lines that run on, or as the library allows.
    variation : float, optional
        Share of a periodic drawing's free elements that leave their places, 0 to 1. Default: 0 for a
        regular drawing, else 1. By clusters or as curves: how readily the drawing is rearranged. Default: 1.
    lattice : "auto", "off" or sequence of two or four floats, default "auto"
        Rows or lattice that the texture keeps to: as found in the exemplar, none, or one or two vectors
        in pixels of the exemplar, x before y.
    candidates : int, default 20
        Elements tried for each place, by descriptors, 1 to 1000.
    moves : int, default 5
        Moves by one cell that may better a placement, 0 to 100.
    weights : sequence of five floats, default (0.5, -0.4, -0.2, -0.5, -0.5)
        Weights of target, uncovered, empty, mismatched and same-overlap areas in the score of a
        placement, -10 to 10 each.
    background_spacing : float, optional
        Distance between background colours, 4 to 1000 pixels. Default: as in the library.
    tile : bool or {"none", "both", "x", "y"}, default "none"
        Axes along which it repeats without a seam.
    rotate : float, optional
        Largest angle by which elements are turned either way, 0 to 180 degrees. Default: 0, but small photographs
        without a direction are turned and mirrored.
    mirror : bool, default False
        Whether half of the elements are mirrored.
    scale_jitter : float, default 0.0
        Largest change of an element's size either way, 0 to 50 per cent.
    edge : {"clip", "keep", "avoid"}, default "clip"
        What becomes of elements at the edge of a domain.
    exclude : sequence of str, default ()
        Names of categories whose elements are left out; their places are background.
    ablate : sequence of str, default ()
        Parts of the method that are left out, for experiments: "secondary", "overlap", "density",
        "decay", "improve", "growth", "removal", "copies", "seeds", "neighbourhoods", "matching"; of
        clusters "shape-context", "link", "shape", "switch", "merge", "split", "depth"; of curves "edge", "robust",
        "orientation", "existence", "patches", "mend".
    domain : picture or SVG, optional
        The shape to fill: all filled shapes of an SVG together, fitted to the canvas, or a mask, white (1.0) inside.
    density : picture, optional
        Density relative to the exemplar's: black 0, middle grey 1, white 2; floats are densities, 0 to 2.
    map : picture or sequence of pictures, optional
        Which library is where, for several: one grey picture for two (black the first, white the second),
        one with a colour for each, or a grey one for each (floats are shares, 0 to 1).
    control : picture, optional
        Layers as in a map, in the colours of the library's layers.
    guide : picture, optional
        Light and dark as in another picture; floats are lightness, 0 to 1.
    context : SVG, optional
        A drawing that stays as it is, in the units of the library's drawing: what is made in `region` fits to
        its lines or elements. The canvas is its page, unless `size` is given. The scene holds it as the layer
        `drawn`, and what is made as the layer `predicted`. For one drawing, without other things that steer.
    region : SVG, optional
        The region that is filled beside `context`: all filled shapes together, fitted to the canvas.
    anew : bool, default False
        Make the region anew: strokes of the drawing are cut at its border, and elements whose middle lies in
        it are left out.
    source : SVG, optional
        The part of the library's drawing that is copied to the region and fitted to what is around it: all
        filled shapes together, fitted to the library's page. Their middle comes to the region's.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.

    Returns
    -------
    Scene
        The texture.

    Raises
    ------
    InputError
        If a parameter is out of range, or what is given does not go together.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
    Interrupted
        If `progress` returned False.
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
    """Draw the exemplar back from its library.

    Parameters
    ----------
    library : Library
        What analysis knows of the exemplar.

    Returns
    -------
    Scene
        A scene of the exemplar's size, without parameters.
    """
    if not isinstance(library, Library):
        raise InputTypeError(f"{type(library).__name__} is no Library", "make one with vtex.analyze")
    return Scene._of(_vtex.reconstruct(library._core))


def libraries_of(given: Library | Sequence[Library]) -> list[Library]:
    """Give one library or several as a list."""
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
    """Give the maps that say where which of several things is."""
    several: list[Any] = list(given) if isinstance(given, (list, tuple)) else [] if given is None else [given]
    if number == 1 and several:
        raise InputError(f"map is for several {what}, one is given")
    if number > 1 and len(several) not in (1, number):
        message = f"{len(several)} maps are given for {number} {what}"
        raise InputError(message, f"give one map for all {what}, or one for each")
    return [named for picture in several if (named := _inputs.picture(picture, "map")) is not None]
