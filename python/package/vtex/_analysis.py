"""From a photograph or a drawing to a library."""

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

    A drawing is an SVG. The same exemplar, parameters and seed give the same library, on any number of threads. The
    program ``vtex analyze`` finds the same library. Lengths are in pixels of the exemplar after a reduction by
    `max_pixels`. Areas are in square pixels.

    Parameters
    ----------
    exemplar : str, os.PathLike, bytes, file, numpy.ndarray or PIL.Image.Image
        The photograph or SVG, in one of these forms:

        * a file: its path, its bytes, or a file that is open for reading bytes
        * the text of an SVG
        * an array of uint8: height x width x 3, height x width for greys, or height x width x 4. vtex places
          transparent pixels on white.
        * an image of Pillow

        A photograph is a PNG, JPEG, TIFF, WebP, BMP, GIF or PNM. It has at most 16384 pixels on each side. vtex repeats
        a tile of a few pixels, at least 4 on each side. With ``wrap=False``, the photograph needs at least 32 pixels on
        each side. vtex applies the colour profile of a file. It reads the colours of arrays and of images of Pillow as
        sRGB.
    name : str, optional
        Name of the exemplar in the library. Default: the name of the file, or ``"array"`` for pixels.
    segmenter : {"auto", "texton", "regions", "felzenszwalb", "sam"}, default "auto"
        Method that finds the elements of a photograph:

        * ``"auto"``: ``"sam"`` if you give an `encoder`, else ``"texton"``
        * ``"texton"``: a small network that is part of vtex
        * ``"regions"``: no network; merges small regions, then takes those that look most like elements
        * ``"felzenszwalb"``: the method of Felzenszwalb and Huttenlocher
        * ``"sam"``: Segment Anything; needs an `encoder`
    masks : path, bytes, file, numpy.ndarray or list, optional
        Masks of the elements of a photograph. They replace the segmenter. Use one of these forms:

        * an array N x height x width of bool, or a list of arrays height x width of bool. These masks may overlap.
        * the list of dictionaries from the generator of Segment Anything
        * labels: an array height x width of whole numbers. 0 = no element, 1 to 65535 = one element for each number.
        * a file: a PNG of labels, or vtex's own JSON
    seed : int, default 0
        Seed of all random choices, 0 to 2**64 - 1.
    minimum_area : int, default 5
        Area of the smallest primary element, 1 to 1 000 000 square pixels.
    detail_scale : float, default 10.0
        Scale of details, 0 to 10 000. A larger value gives fewer details.
    detail_sigma : float, default 0.7
        Smoothing before vtex finds details: a standard deviation, 0 to 10 pixels.
    detail_minimum : int, default 3
        Area of the smallest detail, 1 to 10 000 square pixels.
    secondary_tolerance : float, default 0.055
        Maximum colour difference within a secondary element, as a share of the range of colours, 0 to 1.
    secondary_minimum, secondary_maximum : int, default 3 and 300
        Area of the smallest secondary element, 1 to 10 000 square pixels. Area of the largest secondary element, 1 to
        100 000 square pixels.
    categories : int or "auto", default "auto"
        Number of categories of elements, 1 to 1000. vtex makes fewer if there are fewer different elements. ``"auto"``
        makes as few categories as the eye distinguishes.
    descriptor_reach : float, default 2.25
        How far the descriptor of an element reaches, in mean distances between elements, 0.5 to 10.
    background_spacing : float, default 25.0
        Distance between the colour points of the background, 4 to 1000 pixels.
    background_margin : float, default 5.0
        Margin around elements that is left out of the background, 0 to 100 pixels.
    fidelity : float, default 0.5
        Largest distance between a smooth outline and the outline in the photograph, 0.05 to 5 pixels. A larger value
        also gives fewer shapes.
    shading : {"soft", "gradient", "flat"}, default "soft"
        How vtex fills elements and details:

        * ``"soft"``: few shapes, with soft ellipses that make elements look round
        * ``"gradient"``: more shapes, with gradients where they fit better
        * ``"flat"``: one colour for each shape
    colors : int, default 0
        Maximum number of colours, 0 to 4096. 0 = no limit. With a limit, each shape has one colour. You can also write
        ``colours``.
    max_paths : int, default 0
        Maximum number of elements and details together, 0 to 10 000 000. 0 = no limit. With a limit, vtex joins or
        leaves out the least visible ones.
    cells : int, default 0
        Number of cells along each side of a pixel, 0 to 4. vtex separates small shapes on these cells. 0 = 2 cells for
        up to 2.5 million pixels, 1 cell for more.
    max_pixels : int or "off", default 1 200 000
        Maximum number of pixels of a photograph, 4096 to 4 000 000 000. vtex first reduces a larger photograph to this
        number, or until its elements are about 20 to 80 pixels across. Sizes of results remain in pixels of the
        original photograph. ``"off"`` = no limit.
    contrast : float, "auto" or "off", default "auto"
        Factor by which vtex stretches the contrast before the analysis, 1 to 10. ``"auto"`` stretches subtle pictures
        only. ``"off"`` stretches none. Results have the original colours of the picture.
    even_light : {"auto", "on", "off"}, default "auto"
        Whether vtex removes slow changes of light before the analysis, such as light from one side. ``"auto"`` removes
        them if vtex finds them, except in a picture whose opposite borders join.
    wrap : bool, optional
        Whether opposite borders of the exemplar join. If they do, vtex joins the parts of elements that a border cuts.
        Default: vtex tests the borders.
    layers : int, "auto" or "off", default "auto"
        Number of nested layers of a photograph, such as rust on paint, 1 to 6. ``"auto"`` finds one to three layers.
        ``"off"`` = 1.
    layer_order : sequence of int, default ()
        New order of the layers that vtex finds, from bottom to top. Each number is a layer in the order found, counted
        from 0 at the bottom. Default: the order in which layers that are not next to each other touch least.
    layer_map : path, bytes, file or numpy.ndarray, optional
        Map of the layers of a photograph, in place of those that vtex finds. It is as large as the photograph and has 2
        to 6 flat colours, one for each layer.
    kind : {"photo", "curves"}, default "photo"
        What a picture shows. ``"photo"`` = a photograph. ``"curves"`` = lines on paper: each line becomes a stroke
        along its middle.
    elements : {"auto", "group", "path", "piece"}, default "auto"
        Which shapes of a drawing form one element:

        * ``"auto"``: a small group, or shapes that belong together by their positions
        * ``"group"``: each group
        * ``"path"``: each path
        * ``"piece"``: each connected piece of a path
    group : {"auto", "contact", "none"}, default "auto"
        Which elements of a drawing form one motif. Textures keep the elements of a motif together.

        * ``"auto"``: elements whose relative positions recur, or that are much nearer to each other than to all others
        * ``"contact"``: elements that touch, or that contain each other
        * ``"none"``: no motifs
    lenient : bool, default False
        Whether vtex leaves out the parts of a drawing that it cannot read. If False, such a part raises `InputError`.
    encoder, decoder : path, optional
        ONNX files of a network of Segment Anything: the image encoder and the prompt decoder. If one file contains
        both, give it as `encoder`. Default: no network.
    engine : {"auto", "onnxruntime", "rten"}, default "auto"
        Engine that runs networks of Segment Anything. ``"auto"`` uses ONNX Runtime if vtex finds it, else rten, which
        is part of vtex. The segmenter ``"texton"`` needs no engine.
    onnxruntime : path, optional
        Shared library of ONNX Runtime. Default: the file that the environment variable ``VTEX_ONNXRUNTIME`` or
        ``ORT_DYLIB_PATH`` names, else the first file found.
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.

    Returns
    -------
    Library
        The library, from which `synthesize` makes textures.

    Raises
    ------
    InputError
        If vtex cannot use the exemplar, or a parameter is out of range.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    EngineError
        If vtex cannot load or run a network.
    Interrupted
        If `progress` returns False.
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
