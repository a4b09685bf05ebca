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
    """A texture: layers of elements at their places, over fields of colour.

    Scenes do not change; `edit` gives another. They are equal if their content is, and pickled as the
    bytes of their document. Coordinates are pixels of the canvas, x to the right, y down. A notebook
    shows a scene as its picture.
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
    ) -> str:
        """Write the scene as SVG.

        Parameters
        ----------
        precision : int, default 1
            Decimals of numbers, 0 to 6.
        expand : bool, default False
            Whether elements are written in full, not as ``<symbol>`` and ``<use>``.
        css : bool, default False
            Whether CSS rules are written, by which categories are recoloured.
        max_bytes : int, optional
            Maximum file size, 1 to 10**12: drops decimals and names, then outline detail, then what
            is seen least. Default: no limit.
        background : str, optional
            Background of one colour (``"#rrggbb"``, ``"#rgb"`` or a name of CSS) in place of the
            exemplar's, or ``"none"``. Default: the exemplar's.

        Returns
        -------
        str
            The text that `save` writes to a ``.svg``.

        Raises
        ------
        InputError
            If a parameter is out of range, or nothing that can be given up makes the text small enough.
        """
        options = _showing.options(precision, expand, css, max_bytes, 1.0, background)
        return self._core.encode(".svg", options).decode()

    def pdf(self, *, background: str | None = None) -> bytes:
        """Write the scene as PDF, 96 pixels to the inch.

        Parameters
        ----------
        background : str, optional
            As for `svg`.

        Returns
        -------
        bytes
            The content of a ``.pdf``.
        """
        return self._core.encode(".pdf", _showing.options(background=background))

    def png(self, *, scale: float = 1.0, background: str | None = None) -> bytes:
        """Draw the scene as PNG, with transparency where there is any.

        Parameters
        ----------
        scale : float, default 1.0
            Pixels of the picture for each pixel of the canvas, 0.01 to 100.
        background : str, optional
            As for `svg`.

        Returns
        -------
        bytes
            The content of a ``.png``.
        """
        return self._core.encode(".png", _showing.options(scale=scale, background=background))

    def render(
        self, *, scale: float = 1.0, background: str | None = None, alpha: bool = False
    ) -> npt.NDArray[np.uint8]:
        """Draw the scene.

        Parameters
        ----------
        scale : float, default 1.0
            Pixels of the picture for each pixel of the canvas, 0.01 to 100.
        background : str, optional
            As for `svg`.
        alpha : bool, default False
            Whether the opacity is given too; if not, what is transparent shows white.

        Returns
        -------
        numpy.ndarray
            Shape height x width x 3, or x 4 with `alpha` (not multiplied by it); uint8, sRGB 0 to 255.

        Raises
        ------
        InputError
            If the scale is out of range, or the picture would have more than 2**30 pixels.
        """
        return self._core.render(_showing.options(scale=scale, background=background), alpha)

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
    ) -> int:
        """Write the scene to a file, as a whole or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            Its ending says the format: ``.svg``, ``.svgz``, ``.pdf``, ``.png``, ``.scene.json`` or
            ``.scene.json.gz``.
        precision : int, default 1
            As for `svg`, and for SVGs only.
        expand : bool, default False
            As for `svg`, and for SVGs only.
        css : bool, default False
            As for `svg`, and for SVGs only.
        max_bytes : int, optional
            As for `svg`, and for SVGs and PDFs.
        scale : float, default 1.0
            As for `render`; for PNGs only.
        background : str, optional
            As for `svg`.
        force : bool, default False
            Whether to replace a file that vtex did not write, or that was changed since.

        Returns
        -------
        int
            Bytes written.

        Raises
        ------
        FileError
            If the file cannot be written, or is there and not vtex's own.
        InputError
            If the name has another ending, or a parameter is out of range.
        """
        options = _showing.options(precision, expand, css, max_bytes, scale, background)
        return self._core.save(_inputs.path_of(path), options, force)

    def edit(self, *edits: Edit | Iterable[Edit], seed: int | None = None) -> Scene:
        """Do edits one after the other.

        Parameters
        ----------
        *edits : Edit or sequence of Edit
            What to do: `Tint`, `Shadow`, `Thin` and the other classes of `vtex.edits`, one by one or in lists.
        seed : int, optional
            Seed of random choices, 0 to 2**64 - 1. Default: the scene's own.

        Returns
        -------
        Scene
            The new scene, which also records the edits. What they select nothing for is warned of.

        Raises
        ------
        InputError
            If an edit cannot be done: a number out of range, a layer that is not there.
        InputTypeError
            If something is no edit.
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
        """Width and height at which files show the canvas, e.g. ``("300mm", "200mm")``; None at 96 px to the inch."""
        return self._core.page

    @property
    def seed(self) -> int | None:
        """Seed of its random choices; None for a reconstruction."""
        return self._core.seed

    @property
    def tile(self) -> str:
        """Axes along which it repeats without a seam: ``"none"``, ``"both"``, ``"x"`` or ``"y"``."""
        return {(False, False): "none", (True, True): "both", (True, False): "x", (False, True): "y"}[self._core.tile]

    @property
    def exemplars(self) -> list[str]:
        """Names of the files of its exemplars."""
        return self._core.exemplars

    @property
    def elements(self) -> int:
        """Number of different elements."""
        return self._core.elements

    @property
    def instances(self) -> int:
        """Number of elements at their places."""
        return self._core.instances

    @property
    def categories(self) -> list[Category]:
        """Categories of which it shows elements, by library and number.

        Their coverage is counted in the picture: what others hide does not count.
        """
        return [Category(*category) for category in self._core.categories]

    @property
    def parameters(self) -> dict[str, Any] | None:
        """The parameters of its synthesis, by name; None for a reconstruction."""
        parameters: dict[str, Any] | None = json.loads(self._core.parameters)
        return parameters

    @property
    def edits(self) -> list[dict[str, Any]]:
        """What was done to it since, in order, as plain data."""
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
