"""Measures of how similar two pictures are."""

from __future__ import annotations

import json
from typing import Any, TypedDict

from vtex import _inputs, _vtex
from vtex._library import Library
from vtex._scene import Scene


class Spread(TypedDict):
    """Spread of the mean colours of square blocks of one size."""

    #: Side of the blocks, in pixels.
    block: int
    #: Standard deviation of the block means of the exemplar, in Oklab.
    exemplar: float
    #: Standard deviation of the block means of the result, in Oklab.
    result: float
    #: `result` divided by `exemplar`: below 1 = too even, above 1 = too patchy. None if `exemplar` is 0.
    ratio: float | None


class Contours(TypedDict):
    """Contours of a result, drawn four times as large, compared with those of its exemplar."""

    #: Share of the picture that contours cover, 0 to 1.
    share: float
    #: Share of the picture that contours cover where the exemplar has none, 0 to 1.
    spurious: float
    #: Mean width of borders in the exemplar, from 10 % to 90 % of the change across them, in pixels.
    width_exemplar: float
    #: Mean width of borders in the result, measured in the same way.
    width_result: float


class Metrics(TypedDict):
    """Measures of the difference between a result and its exemplar.

    A distance is 0 for identical pictures. It grows with the difference.
    """

    #: Width and height of the exemplar, in pixels.
    exemplar_size: list[int]
    #: Width and height of the result after resizing, in pixels.
    result_size: list[int]
    #: Side of the windows whose power spectra are compared, in pixels.
    window: int
    #: Earth mover's distance between 8-bit histograms, averaged over red, green and blue, 0 to 255.
    emd_rgb: float
    #: Earth mover's distance between histograms in CIE Lab, in delta E.
    emd_lab: float
    #: Root mean square difference of log power over radial frequency bands.
    psd_radial: float
    #: The same difference, with each band divided into eight directions.
    psd_2d: float
    #: Distance between histograms of local binary patterns, 0 to 1.
    lbp: float
    #: Sliced Wasserstein distance between patches, in standard deviations of the exemplar's patches.
    swd: float
    #: The same distance for each level of the pyramid, the finest first.
    swd_levels: list[float]
    #: Frechet distance between filter responses, in standard deviations of the exemplar's responses.
    fb_frechet: float
    #: Distance from patches of the result to the nearest patches of the exemplar: 1 = as near as patches of the
    #: exemplar are to each other, below 1 = nearer. None if a side is below 53 pixels.
    coherence: float | None
    #: Distance from patches of the exemplar to the nearest patches of the result, on the same scale. None if a side is
    #: below 53 pixels.
    completeness: float | None
    #: Variance of the Laplacian of the exemplar's grey values, 0 to 255. A lower variance means more blur.
    lapvar_exemplar: float
    #: Variance of the Laplacian of the result's grey values.
    lapvar_result: float
    #: Logarithm of `lapvar_result` divided by `lapvar_exemplar`: below 0 = more blurred, above 0 = noisier.
    lapvar_logratio: float
    #: Spread of the mean colours of blocks, by block size.
    structure: list[Spread]
    #: Repetition in the exemplar: its largest autocorrelation beyond 12 pixels, at most 1.
    acf_peak_exemplar: float
    #: Repetition in the result, measured in the same way.
    acf_peak_result: float
    #: Structural similarity (SSIM) of the common central part, 0 to 1 (identical).
    ssim: float
    #: Structural similarity over five scales (MS-SSIM), 0 to 1. None if a side is below 176 pixels.
    ms_ssim: float | None
    #: Contours of a result that is an SVG, a scene or a library, as large as the exemplar. None for other results, and
    #: if `scale` is not 1.
    contours: Contours | None


def metrics(
    exemplar: _inputs.Picture | Scene | Library,
    result: _inputs.Picture | Scene | Library,
    *,
    scale: float = 1.0,
    progress: _inputs.Progress | None = None,
) -> Metrics:
    """Measure how similar a result is to its exemplar.

    Parameters
    ----------
    exemplar, result : path, bytes, file, numpy.ndarray, PIL.Image.Image, Scene or Library
        The two pictures. vtex draws an SVG, a scene or a library first. Each picture has at least 32 pixels on each
        side. Above 1 600 000 pixels, vtex reduces both by the same factor and warns. The two sizes may differ. An array
        is height x width x 3 of uint8.
    scale : float, default 1.0
        How many times as large the result shows the texture, 0.01 to 100. vtex first resizes the result to the scale of
        the exemplar. The limits above apply after that.
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.

    Returns
    -------
    Metrics
        A dictionary of the measures, by name.

    Raises
    ------
    InputError
        If vtex cannot use a picture.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    Interrupted
        If `progress` returns False.
    """
    measured: Metrics = json.loads(
        _vtex.compare(_viewed(exemplar, "exemplar"), _viewed(result, "result"), scale, progress)
    )
    return measured


def _viewed(given: _inputs.Picture | Scene | Library, role: str) -> tuple[str, Any]:
    if isinstance(given, (Scene, Library)):
        return role, given._core
    name, content = _inputs.photo(given, None)
    return (role if name in ("array", "bytes") else name), content
