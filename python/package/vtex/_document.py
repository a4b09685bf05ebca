"""The base class of libraries and scenes: vtex can read, compare, pickle and show them."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from vtex import _inputs, _showing, _vtex
from vtex._errors import InputTypeError
from vtex._layer import Layer

if TYPE_CHECKING:
    from typing_extensions import Self

Core = TypeVar("Core", _vtex.Library, _vtex.Scene)


class Document(Generic[Core]):
    """A compiled document, and the methods that all documents share."""

    __slots__ = ("_core",)
    __hash__ = None  # type: ignore[assignment]

    #: The compiled class.
    _kind: ClassVar[type[Any]]
    #: The function that makes documents of this class.
    _maker: ClassVar[str]
    _core: Core

    def __init__(self) -> None:
        name = type(self).__name__
        raise InputTypeError(f"a {name} is not made by hand", f"call {self._maker} or {name}.read")

    @classmethod
    def _of(cls, core: Core) -> Self:
        document = cls.__new__(cls)
        document._core = core
        return document

    @classmethod
    def read(cls, path: _inputs.Path) -> Self:
        """Read a file that `save` or the program wrote.

        Parameters
        ----------
        path : str or os.PathLike
            File of a library (``.lib.json``) or a scene (``.scene.json``), plain or gzip. vtex detects the file type
            from the content, not from the name.

        Returns
        -------
        Library or Scene
            An object of this class. vtex has checked its content.

        Raises
        ------
        FileError
            If vtex cannot read the file.
        InputError
            If the file is damaged, or contains another kind of document.
        """
        name = _inputs.path_of(path)
        return cls._of(cls._kind.read((name, _vtex.read(name))))

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Read a document from its bytes.

        Parameters
        ----------
        data : bytes
            JSON, plain or gzip.

        Returns
        -------
        Library or Scene
            An object of this class. vtex has checked its content.

        Raises
        ------
        InputError
            If the bytes are damaged, or contain another kind of document.
        """
        return cls._of(cls._kind.read(_inputs.document(data)))

    def to_bytes(self) -> bytes:
        """Return the document as JSON, packed with gzip.

        Returns
        -------
        bytes
            The packed JSON. Equal documents give the same bytes.
        """
        return self._core.content(True)

    def to_dict(self) -> dict[str, Any]:
        """Return the document as plain data.

        Returns
        -------
        dict
            Data in the form that ``schema/library.schema.json`` or ``schema/scene.schema.json`` describes. Lengths are
            in pixels of the exemplar or the canvas, x to the right, y down.
        """
        document: dict[str, Any] = json.loads(self._core.content(False))
        return document

    @property
    def layers(self) -> list[Layer]:
        """Layers of the document, in painting order."""
        return [Layer(*layer) for layer in self._core.layers]

    def __eq__(self, other: object) -> bool:
        return self._core.equals(other._core) if isinstance(other, type(self)) else NotImplemented

    def __reduce__(self) -> tuple[Callable[[bytes], Self], tuple[bytes]]:
        return type(self).from_bytes, (self.to_bytes(),)

    def _as_scene(self) -> _vtex.Scene:
        """Return the document as a scene, which notebooks show."""
        raise NotImplementedError

    def _repr_mimebundle_(
        self, include: Collection[str] | None = None, exclude: Collection[str] | None = None
    ) -> dict[str, Any]:
        return _showing.picture(self._as_scene(), include, exclude)
