"""What libraries and scenes share: documents that are read, compared, pickled and shown."""

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
    """A compiled document, with what can be done to it whatever it holds."""

    __slots__ = ("_core",)
    __hash__ = None  # type: ignore[assignment]

    #: The compiled class.
    _kind: ClassVar[type[Any]]
    #: The function that makes such documents.
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
        """Read a file that `save` or the program has written.

        Parameters
        ----------
        path : str or os.PathLike
            A ``.lib.json`` of a library, a ``.scene.json`` of a scene, or either with ``.gz``; the content
            decides, not the name.

        Returns
        -------
        Library or Scene
            The class that was asked, checked.

        Raises
        ------
        FileError
            If the file cannot be read.
        InputError
            If it holds something else, or is damaged.
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
            The class that was asked, checked.

        Raises
        ------
        InputError
            If the bytes hold something else, or are damaged.
        """
        return cls._of(cls._kind.read(_inputs.document(data)))

    def to_bytes(self) -> bytes:
        """Give the document as gzip.

        Returns
        -------
        bytes
            Packed JSON; the same for equal documents.
        """
        return self._core.content(True)

    def to_dict(self) -> dict[str, Any]:
        """Give the document as plain data.

        Returns
        -------
        dict
            As ``library.schema.json`` or ``scene.schema.json`` in ``schema/`` describes it. Lengths are pixels
            of the exemplar or the canvas, x to the right, y down.
        """
        document: dict[str, Any] = json.loads(self._core.content(False))
        return document

    @property
    def layers(self) -> list[Layer]:
        """Its layers, in painting order."""
        return [Layer(*layer) for layer in self._core.layers]

    def __eq__(self, other: object) -> bool:
        return self._core.equals(other._core) if isinstance(other, type(self)) else NotImplemented

    def __reduce__(self) -> tuple[Callable[[bytes], Self], tuple[bytes]]:
        return type(self).from_bytes, (self.to_bytes(),)

    def _as_scene(self) -> _vtex.Scene:
        """Give the document as a scene, which notebooks show."""
        raise NotImplementedError

    def _repr_mimebundle_(
        self, include: Collection[str] | None = None, exclude: Collection[str] | None = None
    ) -> dict[str, Any]:
        return _showing.picture(self._as_scene(), include, exclude)
