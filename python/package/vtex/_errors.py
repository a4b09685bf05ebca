"""Exceptions. All are `Error`, and most are also a standard exception of Python."""

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
    What to try, in one sentence without a full stop. Default: no hint.
"""


class Error(Exception):
    """Base class of all errors of vtex.

    Parameters
    ----------
    message : str
        What is wrong.
    hint : str, optional
        What to try, in one sentence without a full stop. Default: no hint.

    Attributes
    ----------
    hint : str or None
        What to try, in one sentence without a full stop. None = no hint.
    """

    hint: str | None

    def __init_subclass__(cls) -> None:
        """Document the parameters that all errors share."""
        cls.__doc__ = f"{inspect.cleandoc(cls.__doc__ or cls.__base__.__doc__ or '')}\n{_SHARED}"

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.hint = hint
        # A traceback shows the hint below the message.
        if hint is not None and hasattr(self, "add_note"):
            self.add_note(f"hint: {hint}")

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""

    def __reduce__(self) -> tuple[type[Error], tuple[str, str | None], dict[str, Any]]:
        file = {"errno": self.errno, "filename": self.filename} if isinstance(self, OSError) else {}
        return type(self), (str(self), self.hint), {**vars(self), **file}


class InputError(Error, ValueError):
    """A value that vtex cannot use: a parameter out of range, a damaged file, or a picture that is too small."""


class InputTypeError(Error, TypeError):
    """A value whose type vtex cannot use, such as an array of floats for a photograph."""


class FileError(Error, OSError):
    """A file that vtex cannot read or write; `filename` and `errno` contain the file and the reason."""


class EngineError(Error, RuntimeError):
    """A neural network, or an engine that runs networks, that does not work."""


class Interrupted(Error):
    """The work stopped because the progress function returned False."""


class VtexWarning(UserWarning):
    """A problem that does not stop the work."""


def _kind(standard: type[OSError]) -> type[FileError]:
    """Return the class for a file error that has a name in Python. Tracebacks show this name."""
    return type(standard.__name__, (FileError, standard), {"__doc__": inspect.getdoc(standard)})


#: The classes of file errors that have a name in Python, by error number.
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
    """Return the exception for a file error. Its class is the one that Python uses for the same error number."""
    usual = errno.EACCES if number == errno.EPERM else number
    error = KINDS.get(usual, FileError)(message, hint) if usual is not None else FileError(message, hint)
    error.errno = number
    error.strerror = None if number is None else os.strerror(number)
    error.filename = os.fspath(path)
    return error


def warn(message: str) -> None:
    """Issue a warning at the line that called vtex."""
    level = 1
    frame: FrameType | None = sys._getframe()
    while frame is not None and str(frame.f_globals.get("__name__")).partition(".")[0] == "vtex":
        level, frame = level + 1, frame.f_back
    warnings.warn(message, VtexWarning, stacklevel=level)
