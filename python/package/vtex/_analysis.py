"""Photograph or drawing to library."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from vtex import _inputs, _masks, _spelling, _vtex
from vtex._errors import InputError
from vtex._library import Library


@_spelling.both
def analyze(
    exemplar: _inputs.Picture,
    *,
    name: str | None = None,
    segmenter: Literal["auto", "texton", "regions", "felzenszwalb", "sam"] = "auto",
    masks: _masks.Masks | None = None,
    seed: int = 0,
    minimum_area: int = 5,
    detail_scale: float = 10.0,
    detail_sigma: float = 0.7,
    detail_minimum: int = 3,
    secondary_tolerance: float = 0.055,
    secondary_minimum: int = 3,
    secondary_maximum: int = 300,
    categories: int | Literal["auto"] = "auto",
    descriptor_reach: float = 2.25,
    background_spacing: float = 25.0,
    background_margin: float = 5.0,
    fidelity: float = 0.5,
    shading: Literal["flat", "gradient", "soft"] = "soft",
    colors: int = 0,
    max_paths: int = 0,
    cells: int = 0,
    max_pixels: int | Literal["off"] = 1_200_000,
    contrast: float | Literal["auto", "off"] = "auto",
    even_light: Literal["auto", "on", "off"] = "auto",
    wrap: bool | None = None,
    layers: int | Literal["auto", "off"] = "auto",
    layer_order: Sequence[int] = (),
    layer_map: _inputs.Picture | None = None,
    kind: Literal["photo", "curves"] = "photo",
    elements: Literal["auto", "group", "path", "piece"] = "auto",
    group: Literal["auto", "contact", "none"] = "auto",
    lenient: bool = False,
    encoder: _inputs.Path | None = None,
    decoder: _inputs.Path | None = None,
    engine: Literal["auto", "onnxruntime", "rten"] = "auto",
    onnxruntime: _inputs.Path | None = None,
    progress: _inputs.Progress | None = None,
) -> Library:
    """Find the elements of a photograph or a drawing, and how they are arranged.

    The same exemplar, parameters and seed give the same library on any number of threads, and the same
    as the program ``vtex analyze``. Lengths are pixels of the exemplar as it is analysed, areas square pixels.

    Parameters
    ----------
    exemplar : str, os.PathLike, bytes, file, numpy.ndarray or PIL.Image.Image
        The photograph (PNG, JPEG, TIFF, WebP, BMP, GIF, PNM) or SVG: its path, its bytes, a file open for
        reading bytes, or the text of an SVG; or pixels: an array height x width x 3 of uint8 (also x 4, laid
        over white, or height x width of greys), or an image of Pillow. At most 16384 pixels on each side.
        Tiles of a few pixels are repeated; with ``wrap=False`` at least 32 pixels are needed. Colour profiles
        of files are applied; pixels are taken as sRGB.
    name : str, optional
        What the library calls the exemplar. Default: the file's name, or ``"array"``.
    segmenter : {"auto", "texton", "regions", "felzenszwalb", "sam"}, default "auto"
        What finds the elements of a photograph. ``"auto"`` is ``"sam"`` if an `encoder` is given, else
        ``"texton"``, a small network that is part of vtex.
    masks : path, bytes, file, numpy.ndarray or list, optional
        The elements, in place of a segmenter. Masks that may overlap: an array N x height x width of bool, a
        list of such arrays height x width, or the list of dictionaries that Segment Anything's generator
        gives. Or labels: an array height x width of whole numbers (0 for none, 1 to 65535 for an element
        each), a label PNG, or vtex's own JSON.
    seed : int, default 0
        Seed of random choices, 0 to 2**64 - 1.
    minimum_area : int, default 5
        Smallest primary element, 1 to 1 000 000 square pixels.
    detail_scale : float, default 10.0
        Scale of details: larger means fewer, 0 to 10 000.
    detail_sigma : float, default 0.7
        Smoothing before details are sought, 0 to 10 pixels.
    detail_minimum : int, default 3
        Smallest detail, 1 to 10 000 square pixels.
    secondary_tolerance : float, default 0.055
        Colour difference within a secondary element, 0 to 1.
    secondary_minimum, secondary_maximum : int, default 3 and 300
        Smallest (1 to 10 000) and largest (1 to 100 000) secondary element, square pixels.
    categories : int or "auto", default "auto"
        Number of categories of elements, 1 to 1000; ``"auto"`` makes as few as the eye tells apart.
    descriptor_reach : float, default 2.25
        How far an element sees, in mean distances between elements, 0.5 to 10.
    background_spacing : float, default 25.0
        Distance between background colours, 4 to 1000 pixels.
    background_margin : float, default 5.0
        Strip around elements that is not background, 0 to 100 pixels.
    fidelity : float, default 0.5
        Distance of smooth outlines from the photograph's, 0.05 to 5 pixels.
    shading : {"soft", "gradient", "flat"}, default "soft"
        ``"soft"``: soft ellipses on few shapes make elements round. ``"gradient"``: more shapes, filled with
        gradients where these tell more. ``"flat"``: one colour each.
    colors : int, default 0
        Most colours, all flat, up to 4096; 0 for as many as there are. ``colours`` is the same.
    max_paths : int, default 0
        Most elements and details together, up to 10 000 000; 0 for as many as there are.
    cells : int, default 0
        Cells along each side of a pixel, on which small shapes are told apart, 1 to 4; 0 as fits the
        photograph.
    max_pixels : int or "off", default 1 200 000
        A photograph of more pixels is reduced first, to this number, or to where its elements are some 20
        to 80 pixels across. Sizes of results stay in the photograph's own pixels.
    contrast : float, "auto" or "off", default "auto"
        Factor by which the contrast is stretched before the analysis, 1 to 10. ``"auto"`` stretches subtle pictures
        only. Results have the picture's own colours.
    even_light : {"auto", "on", "off"}, default "auto"
        Whether slow changes of light, such as of a plate lit from one side, are taken out before the analysis.
        ``"auto"`` does so where they are seen, unless the picture wraps.
    wrap : bool, optional
        Whether opposite borders join, so that what they cut is one element. Default: where they are seen
        to.
    layers : int, "auto" or "off", default "auto"
        Number of nested layers, such as rust on paint, 1 to 6.
    layer_order : sequence of int, default ()
        The layers found, counted from 0 at the bottom, from the new bottom to the new top.
    layer_map : path, bytes, file or numpy.ndarray, optional
        A painted map of the photograph's size, in 2 to 6 flat colours, in place of the layers found.
    kind : {"photo", "curves"}, default "photo"
        What a picture shows: a photograph, or lines on paper, each of which becomes a stroke along its middle.
    elements : {"auto", "group", "path", "piece"}, default "auto"
        Which shapes of a drawing are one element.
    group : {"auto", "contact", "none"}, default "auto"
        Which elements of a drawing are one motif, which textures keep together: those whose relative places
        recur or that are much nearer to each other than to all others, those that touch, or none.
    lenient : bool, default False
        Whether what cannot be read of a drawing is left out, rather than refused.
    encoder, decoder : path, optional
        ONNX files of a network of Segment Anything: the image encoder, or one file with both parts, and
        the prompt decoder.
    engine : {"auto", "onnxruntime", "rten"}, default "auto"
        What runs networks of Segment Anything. The network that is part of vtex needs no engine.
    onnxruntime : path, optional
        ONNX Runtime's shared library. Default: the first found.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.

    Returns
    -------
    Library
        What `synthesize` makes textures of.

    Raises
    ------
    InputError
        If the exemplar cannot be used, or a parameter is out of range.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
    EngineError
        If a network cannot be loaded or run.
    Interrupted
        If `progress` returned False.
    """
    label, source = _inputs.photo(exemplar, name)
    networks = [_inputs.path_of(path) for path in (encoder, decoder) if path is not None]
    if networks and segmenter not in ("auto", "sam"):
        raise InputError(f"segmenter = '{segmenter}' needs no encoder", "use segmenter='sam'")
    if segmenter == "sam" and not networks:
        raise InputError("segmenter = 'sam' needs a network", "name its ONNX files by encoder= and decoder=")
    parameters = {
        "seed": _inputs.seed_of(seed),
        "minimum_area": minimum_area,
        "detail_scale": detail_scale,
        "detail_sigma": detail_sigma,
        "detail_minimum": detail_minimum,
        "secondary_tolerance": secondary_tolerance,
        "secondary_minimum": secondary_minimum,
        "secondary_maximum": secondary_maximum,
        "categories": categories,
        "descriptor_reach": descriptor_reach,
        "background_spacing": background_spacing,
        "background_margin": background_margin,
        "fidelity": fidelity,
        "shading": shading,
        "colors": colors,
        "max_paths": max_paths,
        "cells": cells,
        "max_pixels": max_pixels,
        "contrast": contrast,
        "even_light": even_light,
        "wrap": wrap is True,
        "layers": 1 if layers == "off" else layers,
        "layer_order": list(layer_order),
        "kind": kind,
        "elements": elements,
        "group": group,
        "lenient": lenient,
    }
    options = {
        "segmenter": segmenter,
        "networks": networks,
        "engine": engine,
        "onnxruntime": None if onnxruntime is None else _inputs.path_of(onnxruntime),
        "wrap": wrap,
        "parameters": parameters,
    }
    core = _vtex.analyze(
        label,
        source,
        _inputs.to_json(options),
        _masks.masks_of(masks),
        _inputs.picture(layer_map, "layer_map"),
        progress,
    )
    return Library._of(core)
