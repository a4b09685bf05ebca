"""Scenes: synthesised textures."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from vtex import _inputs, _showing, _vtex
from vtex._category import Category
from vtex._document import Document
from vtex.edits import Edit, _asked


class Scene(Document[_vtex.Scene]):
    """A texture: layers of placed elements over a background of smooth colours.

    Scenes do not change; `edit` returns a new scene. Two scenes are equal if their content is equal. ``pickle`` stores
    the bytes of the document. Coordinates are in pixels of the canvas, x to the right, y down. A notebook shows a scene
    as a picture.
    """

    __slots__ = ()

    _kind = _vtex.Scene
    _maker = "vtex.synthesize"

    def svg(
        self,
        *,
        precision: int = 1,
        expand: bool = False,
        css: bool = False,
        max_bytes: int | None = None,
        background: str | None = None,
        ink: str | None = None,
        pattern: bool = False,
    ) -> str:
        """Return the scene as SVG.

        Parameters
        ----------
        precision : int, default 1
            Number of decimals, 0 to 6. Drawings on a small page have 2 instead of 1.
        expand : bool, default False
            Whether to write every element in full, not as ``<symbol>`` and ``<use>``.
        css : bool, default False
            Whether to write CSS rules that can recolour each category.
        max_bytes : int, optional
            Maximum file size, 1 to 10**12 bytes. To stay below it, vtex drops decimals and names, then outline detail,
            then the least visible shapes. Default: no limit.
        background : str, optional
            Background of one colour in place of the exemplar's: ``"#rrggbb"``, ``"#rgb"`` or a CSS colour name.
            ``"none"`` = transparent between the elements. Default: the background of the exemplar.
        ink : str, optional
            Colour of all elements, for a scene whose elements have one colour: ``"#rrggbb"``, ``"#rgb"`` or a CSS
            colour name. Shapes in the colour of the background follow `background`. Default: the exemplar's colour.
        pattern : bool, default False
            Whether to write a tile for the fills of maps, layouts and web pages: plain shapes, also as a ``<pattern>``.
            The scene must repeat along both axes, have a background of one colour or none, and no soft shading.

        Returns
        -------
        str
            The text that `save` writes to a ``.svg``.

        Raises
        ------
        InputError
            If a parameter is out of range, vtex cannot make the text as small as `max_bytes`, or the scene does not
            suit `ink` or `pattern`.
        """
        options = _showing.options(precision, expand, css, max_bytes, 1.0, background, ink, pattern)
        return self._core.encode(".svg", options).decode()

    def pdf(self, *, max_bytes: int | None = None, background: str | None = None, ink: str | None = None) -> bytes:
        """Return the scene as PDF, with the size of its `page`, or else 96 pixels per inch.

        Parameters
        ----------
        max_bytes : int, optional
            See `svg`.
        background : str, optional
            See `svg`.
        ink : str, optional
            See `svg`.

        Returns
        -------
        bytes
            The content of a ``.pdf``.

        Raises
        ------
        InputError
            If a parameter is out of range, or vtex cannot make the file as small as `max_bytes`.
        """
        options = _showing.options(max_bytes=max_bytes, background=background, ink=ink)
        return self._core.encode(".pdf", options)

    def png(self, *, scale: float = 1.0, background: str | None = None, ink: str | None = None) -> bytes:
        """Return the scene as PNG. Transparent areas remain transparent.

        Parameters
        ----------
        scale : float, default 1.0
            Pixels of the picture for each pixel of the canvas, or of a page in pixels, 0.01 to 100.
        background : str, optional
            See `svg`.
        ink : str, optional
            See `svg`.

        Returns
        -------
        bytes
            The content of a ``.png``.
        """
        return self._core.encode(".png", _showing.options(scale=scale, background=background, ink=ink))

    def render(
        self, *, scale: float = 1.0, background: str | None = None, alpha: bool = False, ink: str | None = None
    ) -> npt.NDArray[np.uint8]:
        """Draw the scene as an array of pixels.

        Parameters
        ----------
        scale : float, default 1.0
            Pixels of the picture for each pixel of the canvas, or of a page in pixels, 0.01 to 100.
        background : str, optional
            See `svg`.
        alpha : bool, default False
            Whether to return the opacity too. If False, transparent areas are white.
        ink : str, optional
            See `svg`.

        Returns
        -------
        numpy.ndarray
            Array height x width x 3 of uint8: sRGB, 0 to 255. With `alpha`, height x width x 4, and the colours are not
            multiplied by the opacity.

        Raises
        ------
        InputError
            If the scale is out of range, or the picture would have more than 2**30 pixels.
        """
        return self._core.render(_showing.options(scale=scale, background=background, ink=ink), alpha)

    def save(
        self,
        path: _inputs.Path,
        *,
        precision: int = 1,
        expand: bool = False,
        css: bool = False,
        max_bytes: int | None = None,
        scale: float = 1.0,
        background: str | None = None,
        force: bool = False,
        ink: str | None = None,
        pattern: bool = False,
    ) -> int:
        """Write the scene to a file, complete or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file. Its ending sets the format, such as ``.svg``, ``.svgz``, ``.pdf``, ``.png``,
            ``.scene.json`` or ``.scene.json.gz``.
        precision : int, default 1
            See `svg`. For SVG only.
        expand : bool, default False
            See `svg`. For SVG only.
        css : bool, default False
            See `svg`. For SVG only.
        max_bytes : int, optional
            See `svg`. For SVG and PDF only.
        scale : float, default 1.0
            See `render`. For PNG only.
        background : str, optional
            See `svg`.
        force : bool, default False
            Whether to replace a file that vtex did not write, or that was changed after vtex wrote it.
        ink : str, optional
            See `svg`.
        pattern : bool, default False
            See `svg`. For SVG only.

        Returns
        -------
        int
            Number of bytes written.

        Raises
        ------
        FileError
            If vtex cannot write the file, or may not replace it (see `force`).
        InputError
            If the name has another ending, a parameter is out of range, or the scene does not suit `ink` or `pattern`.
        """
        options = _showing.options(precision, expand, css, max_bytes, scale, background, ink, pattern)
        return self._core.save(_inputs.path_of(path), options, force)

    def edit(self, *edits: Edit | Iterable[Edit], seed: int | None = None) -> Scene:
        """Apply edits, one after the other.

        Parameters
        ----------
        *edits : Edit or sequence of Edit
            The edits: `Tint`, `Shadow`, `Thin` and the other classes of `vtex.edits`, one by one or in lists.
        seed : int, optional
            Seed of all random choices, 0 to 2**64 - 1. Default: the seed of the scene.

        Returns
        -------
        Scene
            The new scene, which also records the edits. vtex warns of an edit that selects no elements.

        Raises
        ------
        InputError
            If an edit is impossible, for example because a number is out of range or a layer does not exist.
        InputTypeError
            If an argument has a type that vtex cannot use.
        """
        asked, files = _asked(edits)
        core, _ = self._core.edit(_inputs.to_json(asked), files, None if seed is None else _inputs.seed_of(seed))
        return Scene._of(core)

    @property
    def width(self) -> int:
        """Width of the canvas, in pixels."""
        return self._core.width

    @property
    def height(self) -> int:
        """Height of the canvas, in pixels."""
        return self._core.height

    @property
    def page(self) -> tuple[str, str] | None:
        """Width and height of the page in files, such as ``("300mm", "200mm")``. None = 96 pixels per inch."""
        return self._core.page

    @property
    def seed(self) -> int | None:
        """Seed of the random choices. None for a reconstruction."""
        return self._core.seed

    @property
    def tile(self) -> str:
        """Axes along which the scene repeats without a seam: ``"none"``, ``"both"``, ``"x"`` or ``"y"``."""
        return {(False, False): "none", (True, True): "both", (True, False): "x", (False, True): "y"}[self._core.tile]

    @property
    def exemplars(self) -> list[str]:
        """File names of the exemplars."""
        return self._core.exemplars

    @property
    def elements(self) -> int:
        """Number of different elements."""
        return self._core.elements

    @property
    def instances(self) -> int:
        """Number of placed elements."""
        return self._core.instances

    @property
    def categories(self) -> list[Category]:
        """Categories of the elements in the scene, by library and number.

        Their coverage is measured in the picture. Parts that other elements hide do not count.
        """
        return [Category(*category) for category in self._core.categories]

    @property
    def parameters(self) -> dict[str, Any] | None:
        """Parameters of the synthesis, by name. None for a reconstruction."""
        parameters: dict[str, Any] | None = json.loads(self._core.parameters)
        return parameters

    @property
    def edits(self) -> list[dict[str, Any]]:
        """Edits applied after the synthesis, in order, as plain data."""
        edits: list[dict[str, Any]] = json.loads(self._core.edits)
        return edits

    def __repr__(self) -> str:
        tile = {"none": "", "both": ", repeats along both axes"}.get(self.tile, f", repeats along {self.tile}")
        exemplars = ", ".join(f"'{name}'" for name in self.exemplars)
        return (
            f"<vtex.Scene of {exemplars or 'nothing'}, {self.width} x {self.height} px: {self.instances} instances of "
            f"{self.elements} elements{tile}>"
        )

    def _as_scene(self) -> _vtex.Scene:
        return self._core
