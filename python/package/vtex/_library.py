"""Libraries: what the analysis found in an exemplar."""

from __future__ import annotations

import json
from typing import Any

from vtex import _inputs, _vtex
from vtex._category import Category
from vtex._document import Document


class Library(Document[_vtex.Library]):
    """The elements of an exemplar and their arrangement; `synthesize` makes textures from it.

    Libraries do not change. Two libraries are equal if their content is equal. ``pickle`` stores the bytes of the
    document. `analyze` makes a library, and `read` and `from_bytes` read one.
    """

    __slots__ = ()

    _kind = _vtex.Library
    _maker = "vtex.analyze"

    def save(self, path: _inputs.Path, *, force: bool = False) -> int:
        """Write the library to a file, complete or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            Name of the file. It ends in ``.lib.json`` or ``.lib.json.gz``.
        force : bool, default False
            Whether to replace a file that vtex did not write, or that was changed after vtex wrote it.

        Returns
        -------
        int
            Number of bytes written.

        Raises
        ------
        FileError
            If vtex cannot write the file, or may not replace it (see `force`).
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
        """File name of the exemplar, without its folder."""
        return self._core.file

    @property
    def is_drawing(self) -> bool:
        """Whether the exemplar is a drawing, not a photograph."""
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
        """Number of elements, primary and secondary."""
        return self._core.elements

    @property
    def primaries(self) -> int:
        """Number of primary elements. Each of them has a category."""
        return self._core.primaries

    @property
    def categories(self) -> list[Category]:
        """Categories of the primary elements, by number."""
        return [Category(*category) for category in self._core.categories]

    @property
    def warnings(self) -> list[str]:
        """Warnings of the analysis, one sentence each."""
        return self._core.warnings

    @property
    def parameters(self) -> dict[str, Any]:
        """Parameters of the analysis, by name."""
        parameters: dict[str, Any] = json.loads(self._core.parameters)
        return parameters

    def __repr__(self) -> str:
        return (
            f"<vtex.Library of '{self.file}', {self.width} x {self.height} px: {self.primaries} primary elements in "
            f"{len(self.categories)} categories, {self.elements - self.primaries} others>"
        )

    def _as_scene(self) -> _vtex.Scene:
        return _vtex.reconstruct(self._core)
