"""How vtex writes and draws scenes, and how notebooks show them."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from vtex import _inputs, _vtex

_SVG = "image/svg+xml"
_PNG = "image/png"
#: Maximum number of bytes of an SVG that a notebook shows. Above it, the notebook shows a PNG.
_SHOWN_BYTES = 1_000_000
#: Longer side of the PNG that a notebook shows, in pixels.
_SHOWN_SIDE = 800


def options(
    precision: int = 1,
    expand: bool = False,
    css: bool = False,
    max_bytes: int | None = None,
    scale: float = 1.0,
    background: str | None = None,
    ink: str | None = None,
    pattern: bool = False,
) -> str:
    """Return the options for writing and drawing, as JSON for the compiled half."""
    return _inputs.to_json(
        {
            "precision": _inputs.whole("precision", precision, 0, 6),
            "expand": bool(expand),
            "css": bool(css),
            "max_bytes": None if max_bytes is None else _inputs.whole("max_bytes", max_bytes, 1, 10**12),
            "scale": _inputs.number("scale", scale, 0.01, 100),
            "background": background,
            "ink": ink,
            "pattern": bool(pattern),
        }
    )


def picture(scene: _vtex.Scene, include: Collection[str] | None, exclude: Collection[str] | None) -> dict[str, Any]:
    """Return the one picture that a notebook shows and stores: the SVG, or a PNG if the SVG is long or excluded."""
    wanted = {kind for kind in (_SVG, _PNG) if (not include or kind in include) and kind not in (exclude or ())}
    if _SVG in wanted:
        text = scene.encode(".svg", options())
        if len(text) <= _SHOWN_BYTES or _PNG not in wanted:
            return {_SVG: text.decode()}
    if _PNG not in wanted:
        return {}
    scale = max(0.01, min(1.0, _SHOWN_SIDE / max(scene.width, scene.height)))
    return {_PNG: scene.encode(".png", options(scale=scale))}
