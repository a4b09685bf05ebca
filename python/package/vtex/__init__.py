"""Make editable vector textures of any size from photographs and drawings of textures.

`analyze` finds the elements of a photograph or an SVG. `synthesize` makes a `Scene` of any size from them. You can draw
and edit a scene, and save it as SVG, PDF, PNG or JSON. `warp`, `interpolate`, `transfer` and `stylize` make new scenes
from scenes. `vectorize` draws the photograph itself.

Examples
--------
>>> import vtex
>>> library = vtex.analyze("photo.jpg")                                # doctest: +SKIP
>>> scene = vtex.synthesize(library, size=(1000, 600), tile="both")    # doctest: +SKIP
>>> scene.edit(vtex.Tint("#d08030", amount=0.3)).save("out.svg")       # doctest: +SKIP
"""

from vtex import _errors
from vtex._analysis import analyze
from vtex._category import Category
from vtex._comparing import Contours, Metrics, Spread, metrics
from vtex._composing import interpolate, stylize, transfer, warp
from vtex._errors import (
    EngineError,
    Error,
    FileError,
    InputError,
    InputTypeError,
    Interrupted,
    VtexWarning,
)
from vtex._layer import Layer
from vtex._library import Library
from vtex._scene import Scene
from vtex._synthesis import reconstruct, synthesize
from vtex._threads import get_threads, set_threads
from vtex._vectorizing import vectorize
from vtex._vtex import __version__
from vtex.edits import (
    Delete,
    Density,
    Edit,
    Flatten,
    Hatch,
    Jitter,
    Mask,
    Move,
    Order,
    Orient,
    Outline,
    Palette,
    Propagate,
    Recolor,
    Relax,
    Replace,
    Rotate,
    Scale,
    Shadow,
    Shuffle,
    Simplify,
    Thin,
    Tint,
    Transform,
    Vary,
)

__all__ = [
    "Category",
    "Contours",
    "Delete",
    "Density",
    "Edit",
    "EngineError",
    "Error",
    "FileError",
    "Flatten",
    "Hatch",
    "InputError",
    "InputTypeError",
    "Interrupted",
    "Jitter",
    "Layer",
    "Library",
    "Mask",
    "Metrics",
    "Move",
    "Order",
    "Orient",
    "Outline",
    "Palette",
    "Propagate",
    "Recolor",
    "Relax",
    "Replace",
    "Rotate",
    "Scale",
    "Scene",
    "Shadow",
    "Shuffle",
    "Simplify",
    "Spread",
    "Thin",
    "Tint",
    "Transform",
    "Vary",
    "VtexWarning",
    "__version__",
    "analyze",
    "get_threads",
    "interpolate",
    "metrics",
    "reconstruct",
    "set_threads",
    "stylize",
    "synthesize",
    "transfer",
    "vectorize",
    "warp",
]

# Users, tracebacks and pickles see public names only.
for _name in __all__:
    if not _name.startswith("_"):
        globals()[_name].__module__ = "vtex"
for _kind in _errors.KINDS.values():
    _kind.__module__ = "vtex"
    globals()[_kind.__name__] = _kind
