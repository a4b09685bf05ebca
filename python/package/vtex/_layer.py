"""Layers of libraries and scenes."""

from __future__ import annotations

from typing import NamedTuple


class Layer(NamedTuple):
    """A layer of a library or scene.

    Parameters
    ----------
    name : str
        Name of the layer. Edits select a layer by its name.
    role : {"primary", "secondary", "background"}
        Function of its elements in the texture.
    instances : int
        Number of placed elements in the layer.
    """

    name: str
    role: str
    instances: int
