"""How alike two pictures are."""

from __future__ import annotations

import json
from typing import Any, TypedDict

from vtex import _inputs, _vtex
from vtex._library import Library
from vtex._scene import Scene


class Spread(TypedDict):
    """Spread of the means of blocks of one size."""

    #: Side of the blocks, in pixels.
    block: int
    #: Spread in the exemplar.
    exemplar: float
    #: Spread in the result.
    result: float
    #: Result over exemplar; None where that has none.
    ratio: float | None


class Contours(TypedDict):
    """Contours of a drawn result, four times enlarged, beside those of its exemplar."""

    #: Share of the picture that is part of a contour, 0 to 1.
    share: float
    #: Share of the picture that is part of a contour where the exemplar has none, 0 to 1.
    spurious: float
    #: Mean width of the exemplar's borders, from 10 % to 90 % of the change across them, in pixels.
    width_exemplar: float
    #: The same of the result.
    width_result: float


class Metrics(TypedDict):
    """Measures of how far a result is from its exemplar.

    Distances are 0 for identical pictures and grow with the difference.
    """

    #: Width and height of the exemplar, in pixels.
    exemplar_size: list[int]
    #: Width and height of the result as it was compared, in pixels.
    result_size: list[int]
    #: Side of the windows whose power spectra are compared, in pixels.
    window: int
    #: Earth mover's distance between 8-bit histograms of red, green and blue, 0 to 255.
    emd_rgb: float
    #: Earth mover's distance between histograms in CIE Lab, in delta E.
    emd_lab: float
    #: Difference of log power over radial frequency bands.
    psd_radial: float
    #: The same, in eight directions.
    psd_2d: float
    #: Distance between histograms of local binary patterns, 0 to 1.
    lbp: float
    #: Sliced Wasserstein distance between patches, in standard deviations of the exemplar's.
    swd: float
    #: The same for each level of the pyramid, the finest first.
    swd_levels: list[float]
    #: Frechet distance between filter responses.
    fb_frechet: float
    #: How near the result's patches are to the exemplar's; 1 is as near as its own. None below 53 pixels.
    coherence: float | None
    #: How near the exemplar's patches are to the result's; 1 is as near as its own. None below 53 pixels.
    completeness: float | None
    #: Variance of the Laplacian of the exemplar's greys: lower is more blurred.
    lapvar_exemplar: float
    #: The same of the result.
    lapvar_result: float
    #: Logarithm of result over exemplar of these.
    lapvar_logratio: float
    #: Spread of block means, by block size.
    structure: list[Spread]
    #: Largest autocorrelation of the exemplar beyond 12 pixels, at most 1.
    acf_peak_exemplar: float
    #: The same of the result.
    acf_peak_result: float
    #: Structural similarity of the common central part, 0 to 1.
    ssim: float
    #: The same over five scales; None below 176 pixels.
    ms_ssim: float | None
    #: Contours of an SVG, a scene or a library of the exemplar's size; None of pictures and other sizes.
    contours: Contours | None


def metrics(
    exemplar: _inputs.Picture | Scene | Library,
    result: _inputs.Picture | Scene | Library,
    *,
    scale: float = 1.0,
    progress: _inputs.Progress | None = None,
) -> Metrics:
    """Measure how alike a result is to its exemplar.

    Parameters
    ----------
    exemplar, result : path, bytes, file, numpy.ndarray, PIL.Image.Image, Scene or Library
        Pictures, or what can be drawn as one: an SVG, a scene, a library. At least 32 pixels on each
        side, at most 2**24 in all; their sizes may differ. Arrays are height x width x 3 of uint8.
    scale : float, default 1.0
        How many times as large the result shows the texture, 0.01 to 100.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.

    Returns
    -------
    Metrics
        A dictionary of the measures, by name.

    Raises
    ------
    InputError
        If a picture cannot be used.
    InputTypeError
        If something has a type that cannot be used.
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
