"""From a photograph to a scene: the same picture in vectors."""

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
    """The other parameters of `analyze`, for `vectorize`."""

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
    """Draw a photograph in vectors: the picture itself, not a texture.

    `vectorize` combines `analyze` and `reconstruct`. By default it uses no network, keeps slow changes of light, and
    does not test whether borders join. The same photograph, parameters and seed give the same scene as the program
    ``vtex vectorize``.

    Parameters
    ----------
    photo : str, os.PathLike, bytes, file, numpy.ndarray or PIL.Image.Image
        The photograph, in any form that `analyze` accepts.
    name : str, optional
        Name of the photograph in the scene. Default: the name of the file, or ``"array"`` for pixels.
    segmenter : {"auto", "texton", "regions", "felzenszwalb", "sam"}, default "auto"
        Method that finds the elements. ``"auto"`` is ``"sam"`` if you give an `encoder`, else a faster form of
        ``"regions"``.
    masks : path, bytes, file, numpy.ndarray or list, optional
        Masks of the elements, in any form that `analyze` accepts. They replace the segmenter.
    seed : int, default 0
        Seed of all random choices, 0 to 2**64 - 1.
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
        Maximum number of pixels, 4096 to 4 000 000 000. vtex first reduces a larger photograph. The scene has the size
        of the original photograph. ``"off"`` = no limit.
    progress : callable, optional
        Function that vtex calls as ``progress(stage, done, total)`` in the caller's thread. `total` is 0 while it is
        unknown. If the function returns False or raises an exception, the work stops. Default: no function.
    **parameters : dict, optional
        The other parameters of `analyze`, by name.

    Returns
    -------
    Scene
        The picture, as large as the photograph.

    Raises
    ------
    InputError
        If vtex cannot use the photograph, or a parameter is out of range.
    InputTypeError
        If an argument has a type that vtex cannot use.
    FileError
        If vtex cannot read a file.
    EngineError
        If vtex cannot load or run a network.
    Interrupted
        If `progress` returns False.
    """
    finder: Any = segmenter
    if segmenter == "auto" and parameters.get("encoder") is None and parameters.get("decoder") is None:
        finder = "one-tree"
    # The picture keeps its light.
    if parameters.get("even_light", "auto") == "auto":
        parameters["even_light"] = "off"
    # The picture is not repeated, so vtex does not test whether borders join.
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
