"""Libraries: what analysis knows of an exemplar."""

from __future__ import annotations

import json
from typing import Any

from vtex import _inputs, _vtex
from vtex._category import Category
from vtex._document import Document


class Library(Document[_vtex.Library]):
    """The elements of an exemplar, and how they are arranged: what `synthesize` makes textures of.

    Libraries do not change. They are equal if their content is, and pickled as the bytes of their
    document. `analyze` makes them, `read` and `from_bytes` bring them back.
    """

    __slots__ = ()

    _kind = _vtex.Library
    _maker = "vtex.analyze"

    def save(self, path: _inputs.Path, *, force: bool = False) -> int:
        """Write the library to a file, as a whole or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            A name that ends in ``.lib.json`` or ``.lib.json.gz``.
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
            If the name has another ending.
        """
        return self._core.save(_inputs.path_of(path), force)

    @property
    def width(self) -> int:
        """Width of the exemplar, in pixels."""
        return self._core.width

    @property
    def height(self) -> int:
        """Height of the exemplar, in pixels."""
        return self._core.height

    @property
    def file(self) -> str:
        """Name of the exemplar's file, without its folder."""
        return self._core.file

    @property
    def is_drawing(self) -> bool:
        """Whether the exemplar is an SVG, not a photograph."""
        return self._core.drawing

    @property
    def is_periodic(self) -> bool:
        """Whether opposite borders of the exemplar join."""
        return self._core.periodic

    @property
    def coverage(self) -> float:
        """Share of the exemplar that primary elements cover, 0 to 1."""
        return self._core.coverage

    @property
    def elements(self) -> int:
        """Number of elements, large and small."""
        return self._core.elements

    @property
    def primaries(self) -> int:
        """Number of primary elements, those that have a category."""
        return self._core.primaries

    @property
    def categories(self) -> list[Category]:
        """Categories of primary elements, by number."""
        return [Category(*category) for category in self._core.categories]

    @property
    def warnings(self) -> list[str]:
        """What analysis had to say, a sentence each."""
        return self._core.warnings

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters of its analysis, by name."""
        parameters: dict[str, Any] = json.loads(self._core.parameters)
        return parameters

    def __repr__(self) -> str:
        return (
            f"<vtex.Library of '{self.file}', {self.width} x {self.height} px: {self.primaries} primary elements in "
            f"{len(self.categories)} categories, {self.elements - self.primaries} others>"
        )

    def _as_scene(self) -> _vtex.Scene:
        return _vtex.reconstruct(self._core)
