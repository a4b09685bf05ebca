"""Categories, as libraries and scenes list them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Category:
    """A category: elements that look alike.

    Parameters
    ----------
    name : str
        A plain name for its colour; no other category of its library has it. A scene calls it as its library does.
    colour : str
        Mean colour of its elements, as ``"#rrggbb"``; in a scene, as they are there. ``color`` is the same.
    count : int
        Number of its elements: in a library of different ones, in a scene of those at their places.
    coverage : float
        Share of the exemplar or the canvas that they cover, 0 to 1.
    number : int
        Its number in its library, from 1, which ``where="category=..."`` and the classes of an SVG say.
    library : int, default 0
        Its library, as a place in ``exemplars`` of a scene, from 0; ``where="library=..."`` counts from 1.
    """

    name: str
    colour: str
    count: int
    coverage: float
    number: int
    library: int = 0

    @property
    def color(self) -> str:
        """The colour, as ``"#rrggbb"``."""
        return self.colour
