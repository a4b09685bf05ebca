"""Libraries: what analysis knows of an exemplar."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from vtex import _inputs, _showing, _vtex
from vtex._errors import InputTypeError
from vtex._layer import Layer


class Library:
    """The elements of an exemplar, and how they are arranged: what `synthesize` makes textures of.

    Libraries do not change. They are equal if their content is, and pickled as the bytes of their
    document. `analyze` makes them, `read` and `from_bytes` bring them back.
    """

    __slots__ = ("_core",)
    __hash__ = None  # type: ignore[assignment]

    _core: _vtex.Library

    def __init__(self) -> None:
        raise InputTypeError("libraries are not made by hand", "call vtex.analyze or Library.read")

    @classmethod
    def _of(cls, core: _vtex.Library) -> Library:
        library = cls.__new__(cls)
        library._core = core
        return library

    @classmethod
    def read(cls, path: _inputs.Path) -> Library:
        """Read a library from a file.

        Parameters
        ----------
        path : str or os.PathLike
            A ``.lib.json`` or ``.lib.json.gz``; the content decides, not the name.

        Returns
        -------
        Library
            The library, checked.

        Raises
        ------
        FileError
            If the file cannot be read.
        InputError
            If it is no library, or damaged.
        """
        name = _inputs.path_of(path)
        return cls._of(_vtex.Library.from_bytes((name, _vtex.read(name))))

    @classmethod
    def from_bytes(cls, data: bytes) -> Library:
        """Read a library from the bytes of its document.

        Parameters
        ----------
        data : bytes
            JSON, plain or gzip.

        Returns
        -------
        Library
            The library, checked.

        Raises
        ------
        InputError
            If the bytes are no library, or damaged.
        """
        return cls._of(_vtex.Library.from_bytes(_inputs.document(data)))

    def to_bytes(self) -> bytes:
        """Give the library's document as gzip.

        Returns
        -------
        bytes
            Packed JSON; the same for equal libraries.
        """
        return self._core.gzip()

    def to_dict(self) -> dict[str, Any]:
        """Give the library's document as plain data.

        Returns
        -------
        dict
            As ``schema/library.schema.json`` describes it. Lengths in pixels of the exemplar, x to the
            right, y down.
        """
        document: dict[str, Any] = json.loads(self._core.json())
        return document

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
    def categories(self) -> int:
        """Number of categories of primary elements."""
        return self._core.categories

    @property
    def layers(self) -> list[Layer]:
        """Its layers, from bottom to top."""
        return [Layer(*layer) for layer in self._core.layers]

    @property
    def warnings(self) -> list[str]:
        """What analysis had to say, a sentence each."""
        return self._core.warnings

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters of its analysis, by name."""
        parameters: dict[str, Any] = json.loads(self._core.parameters)
        return parameters

    def __eq__(self, other: object) -> bool:
        return self._core.equals(other._core) if isinstance(other, Library) else NotImplemented

    def __reduce__(self) -> tuple[Callable[[bytes], Library], tuple[bytes]]:
        return Library.from_bytes, (self.to_bytes(),)

    def __repr__(self) -> str:
        return (
            f"<vtex.Library of '{self.file}', {self.width} x {self.height} px: {self.primaries} primary elements in "
            f"{self.categories} categories, {self.elements - self.primaries} others>"
        )

    def _repr_svg_(self) -> str | None:
        return _showing.svg(_vtex.reconstruct(self._core))

    def _repr_png_(self) -> bytes:
        return _showing.png(_vtex.reconstruct(self._core))
