"""Layers, as libraries and scenes list them."""

from __future__ import annotations

from typing import NamedTuple


class Layer(NamedTuple):
    """A layer of a library or scene."""

    #: Its name, by which edits select it.
    name: str
    #: What its elements are to the texture: ``"primary"``, ``"secondary"`` or ``"background"``.
    role: str
    #: Number of its elements at their places.
    instances: int
