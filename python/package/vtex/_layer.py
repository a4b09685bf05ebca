"""Layers, as libraries and scenes list them."""

from __future__ import annotations

from typing import NamedTuple


class Layer(NamedTuple):
    """A layer of a library or scene.

    Parameters
    ----------
    name : str
        Its name, by which edits select it.
    role : {"primary", "secondary", "background"}
        What its elements are to the texture.
    instances : int
        Number of its elements at their places.
    """

    name: str
    role: str
    instances: int
