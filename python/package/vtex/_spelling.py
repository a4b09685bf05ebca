"""Both spellings of colour, in names and in values."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection
from typing import Any, TypeVar

Made = TypeVar("Made", bound=Callable[..., Any])


def other(name: str) -> str:
    """Return a name in the other spelling, or the same name if it has only one."""
    if "colour" in name:
        return name.replace("colour", "color")
    return name.replace("color", "colour")


def known(given: dict[str, Any], names: Collection[str], caller: str) -> dict[str, Any]:
    """Return arguments under the names that a callable has, whatever their spelling."""
    found = {}
    for name, value in given.items():
        named = name if name in names or other(name) not in names else other(name)
        if named in found or (named != name and named in given):
            raise TypeError(f"{caller}() got both '{named}' and '{other(named)}'")
        found[named] = value
    return found


def both(function: Made) -> Made:
    """Let a function accept its arguments in both spellings."""
    names = frozenset(inspect.signature(function).parameters)

    @functools.wraps(function)
    def spelled(*args: Any, **given: Any) -> Any:
        return function(*args, **known(given, names, function.__name__))

    return spelled  # type: ignore[return-value]


class Spelled(type):
    """Metaclass of classes that accept and return their parameters in both spellings."""

    @property
    def __signature__(cls) -> inspect.Signature:
        """Signature that `help` and editors show: the declared parameters."""
        made = inspect.signature(cls.__init__)  # type: ignore[misc]
        return made.replace(parameters=list(made.parameters.values())[1:], return_annotation=made.empty)

    def __call__(cls, *args: Any, **given: Any) -> Any:
        """Make an object."""
        names = getattr(cls, "__dataclass_fields__", {})
        return super().__call__(*args, **known(given, names, cls.__name__))
