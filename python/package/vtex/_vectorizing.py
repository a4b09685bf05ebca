"""Photograph to scene: the same picture in vectors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from vtex import _inputs, _masks, _spelling
from vtex._analysis import analyze
from vtex._scene import Scene
from vtex._synthesis import reconstruct

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Parameters(TypedDict, total=False):
    """What `analyze` takes besides, for a picture that is drawn."""

    minimum_area: int
    detail_scale: float
    detail_sigma: float
    detail_minimum: int
    secondary_tolerance: float
    secondary_minimum: int
    secondary_maximum: int
    categories: int | Literal["auto"]
    descriptor_reach: float
    background_spacing: float
    background_margin: float
    contrast: float | Literal["auto", "off"]
    even_light: Literal["auto", "on", "off"]
    wrap: bool | None
    layers: int | Literal["auto", "off"]
    layer_order: Sequence[int]
    layer_map: _inputs.Picture | None
    kind: Literal["photo", "curves"]
    elements: Literal["auto", "group", "path", "piece"]
    group: Literal["auto", "contact", "none"]
    lenient: bool
    encoder: _inputs.Path | None
    decoder: _inputs.Path | None
    engine: Literal["auto", "onnxruntime", "rten"]
    onnxruntime: _inputs.Path | None


@_spelling.both
def vectorize(
    photo: _inputs.Picture,
    *,
    name: str | None = None,
    segmenter: Literal["auto", "texton", "regions", "felzenszwalb", "sam"] = "auto",
    masks: _masks.Masks | None = None,
    seed: int = 0,
    fidelity: float = 0.5,
    shading: Literal["flat", "gradient", "soft"] = "soft",
    colors: int = 0,
    max_paths: int = 0,
    cells: int = 0,
    max_pixels: int | Literal["off"] = 1_200_000,
    progress: _inputs.Progress | None = None,
    **parameters: Unpack[Parameters],
) -> Scene:
    """Draw a photograph in vectors: the picture itself, not a texture of it.

    It is `analyze` and `reconstruct` in one, without a network and without a search for borders that join. The
    same photograph, parameters and seed give the same as the program ``vtex vectorize``.

    Parameters
    ----------
    photo : str, os.PathLike, bytes, file, numpy.ndarray or PIL.Image.Image
        The photograph, in any of the forms that `analyze` takes.
    name : str, optional
        What the scene calls it. Default: the file's name, or ``"array"``.
    segmenter : {"auto", "texton", "regions", "felzenszwalb", "sam"}, default "auto"
        What finds the elements. ``"auto"`` is a quick kind of ``"regions"``, or ``"sam"`` if an `encoder` is given.
    masks : path, bytes, file, numpy.ndarray or list, optional
        The elements, in any of the forms that `analyze` takes.
    seed : int, default 0
        Seed of random choices, 0 to 2**64 - 1.
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
        A photograph of more pixels is reduced first. The scene has the photograph's own size.
    progress : callable, optional
        Called as ``progress(stage, done, total)`` in this thread; the work stops if it returns False or
        raises.
    **parameters : dict, optional
        The other parameters of `analyze`, by name.

    Returns
    -------
    Scene
        The picture, of the photograph's size.

    Raises
    ------
    InputError
        If the photograph cannot be used, or a parameter is out of range.
    InputTypeError
        If something has a type that cannot be used.
    FileError
        If a file cannot be read.
    EngineError
        If a network cannot be loaded or run.
    Interrupted
        If `progress` returned False.
    """
    finder: Any = segmenter
    if segmenter == "auto" and parameters.get("encoder") is None and parameters.get("decoder") is None:
        finder = "one-tree"
    # The picture keeps its light.
    if parameters.get("even_light", "auto") == "auto":
        parameters["even_light"] = "off"
    # Nothing is repeated here, so nobody asks whether borders join.
    parameters["wrap"] = parameters.get("wrap") is True
    library = analyze(
        photo,
        name=name,
        segmenter=finder,
        masks=masks,
        seed=seed,
        fidelity=fidelity,
        shading=shading,
        colors=colors,
        max_paths=max_paths,
        cells=cells,
        max_pixels=max_pixels,
        progress=progress,
        **parameters,
    )
    return reconstruct(library)
