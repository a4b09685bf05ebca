"""The number of threads of a call."""

from __future__ import annotations

from vtex import _vtex


def set_threads(number: int | None) -> None:
    """Set the number of threads that each call uses.

    Results do not depend on this number. In a worker of Ray, Dask or Spark, use 1: these engines start one worker for
    each core.

    Parameters
    ----------
    number : int or None
        Number of threads, 1 to 1024. None = the default: the number in the environment variable ``VTEX_THREADS``, else
        one thread for each core.

    Raises
    ------
    InputError
        If the number is out of range.
    """
    _vtex.set_threads(number)


def get_threads() -> int:
    """Return the number of threads that each call uses.

    Returns
    -------
    int
        The number that you set, or the default.
    """
    return _vtex.threads()
