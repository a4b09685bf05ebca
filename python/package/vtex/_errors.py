"""Exceptions. All are `Error`, each also the standard one that Python programs expect."""

from __future__ import annotations

import inspect
import os
from typing import Any

_SHARED = """
Parameters
----------
message : str
    What is wrong.
hint : str, optional
    What to try, in one sentence without a full stop.
"""


class Error(Exception):
    """Anything that goes wrong in vtex.

    Parameters
    ----------
    message : str
        What is wrong.
    hint : str, optional
        What to try, in one sentence without a full stop.

    Attributes
    ----------
    hint : str or None
        What to try, in one sentence without a full stop; None where there is nothing to say.
    """

    hint: str | None

    def __init_subclass__(cls) -> None:
        """Document the parameters that all share."""
        cls.__doc__ = f"{inspect.cleandoc(cls.__doc__ or cls.__base__.__doc__ or '')}\n{_SHARED}"

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.hint = hint
        # A traceback shows it below the message.
        if hint is not None and hasattr(self, "add_note"):
            self.add_note(f"hint: {hint}")

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""

    def __reduce__(self) -> tuple[type[Error], tuple[str, str | None], dict[str, Any]]:
        file = {"errno": self.errno, "filename": self.filename} if isinstance(self, OSError) else {}
        return type(self), (str(self), self.hint), {**vars(self), **file}


class InputError(Error, ValueError):
    """A value that cannot be used: a parameter out of range, a damaged file, a picture too small."""


class InputTypeError(Error, TypeError):
    """Something of a type that cannot be used, such as an array of floats for a photograph."""


class FileError(Error, OSError):
    """A file that cannot be read or written; `filename` and `errno` say which and why."""


class EngineError(Error, RuntimeError):
    """A neural network, or what runs it, that does not work."""


class Interrupted(Error):
    """The progress function answered False, so the work was stopped."""


class VtexWarning(UserWarning):
    """Something that the user should know; the work went on."""


class _FileNotFound(FileError, FileNotFoundError):
    """A file that is not there."""


class _PermissionDenied(FileError, PermissionError):
    """A file that may not be read or written."""


class _IsAFolder(FileError, IsADirectoryError):
    """A folder in place of a file."""


class _FileExists(FileError, FileExistsError):
    """A file that is there and not replaced."""


_KINDS: dict[str, type[FileError]] = {
    "missing": _FileNotFound,
    "denied": _PermissionDenied,
    "folder": _IsAFolder,
    "exists": _FileExists,
}


def file_error(kind: str, message: str, hint: str | None, errno: int | None, path: str | os.PathLike[str]) -> FileError:
    """Make the exception for a file."""
    error = _KINDS.get(kind, FileError)(message, hint)
    error.errno = errno
    error.filename = os.fspath(path)
    return error
