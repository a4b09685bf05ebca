"""Categories of libraries and scenes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Category:
    """A category: elements that look alike.

    Parameters
    ----------
    name : str
        Name of the category, by default after its colour, such as ``"small light grey"``. The name is unique in the
        library. A scene uses the same name.
    colour : str
        Mean colour of the elements, as ``"#rrggbb"``. In a scene it is their present colour. You can also write
        ``color``.
    count : int
        Number of elements. In a library, vtex counts different elements. In a scene, it counts placed elements.
    coverage : float
        Share of the exemplar or the canvas that the elements cover, 0 to 1.
    number : int
        Number of the category in its library, from 1. ``where="category=..."`` and the classes of an SVG use this
        number.
    library : int, default 0
        Index of the library in ``exemplars`` of a scene, from 0. ``where="library=..."`` counts from 1.
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
