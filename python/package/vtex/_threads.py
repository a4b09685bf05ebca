"""How many threads a call uses."""

from __future__ import annotations

from vtex import _vtex


def set_threads(number: int | None) -> None:
    """Set the number of threads that each call works with.

    Results do not depend on it. Within a worker of Ray, Dask or Spark, where there are as many workers
    as cores, 1 is right.

    Parameters
    ----------
    number : int or None
        1 to 1024; None for the default: the number in the environment variable ``VTEX_THREADS``, else
        one for each core.

    Raises
    ------
    InputError
        If the number is out of range.
    """
    _vtex.set_threads(number)


def get_threads() -> int:
    """Give the number of threads that each call works with.

    Returns
    -------
    int
        The number set, or the default.
    """
    return _vtex.threads()
