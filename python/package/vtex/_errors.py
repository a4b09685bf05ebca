"""Exceptions. All are `Error`, each also the standard one that Python programs expect."""

from __future__ import annotations

import errno
import inspect
import os
import sys
import warnings
from types import FrameType
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


def _kind(standard: type[OSError]) -> type[FileError]:
    """Make the class of a file's error that Python has a name for. Tracebacks show that name."""
    return type(standard.__name__, (FileError, standard), {"__doc__": inspect.getdoc(standard)})


#: The classes of errors of files that have a name, by number.
KINDS = {
    number: _kind(standard)
    for number, standard in (
        (errno.ENOENT, FileNotFoundError),
        (errno.EACCES, PermissionError),
        (errno.EISDIR, IsADirectoryError),
        (errno.ENOTDIR, NotADirectoryError),
        (errno.EEXIST, FileExistsError),
    )
}


def file_error(number: int | None, message: str, hint: str | None, path: str | os.PathLike[str]) -> FileError:
    """Make the exception for a file, of the class that Python has for the number of its error."""
    usual = errno.EACCES if number == errno.EPERM else number
    error = KINDS.get(usual, FileError)(message, hint) if usual is not None else FileError(message, hint)
    error.errno = number
    error.strerror = None if number is None else os.strerror(number)
    error.filename = os.fspath(path)
    return error


def warn(message: str) -> None:
    """Warn at the line that called vtex."""
    level = 1
    frame: FrameType | None = sys._getframe()
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == "vtex":
        level, frame = level + 1, frame.f_back
    warnings.warn(message, VtexWarning, stacklevel=level)
