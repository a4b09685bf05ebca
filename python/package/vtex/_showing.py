"""How scenes are written and drawn, and how notebooks show them."""

from __future__ import annotations

from vtex import _inputs, _vtex

#: Most bytes of an SVG that a notebook shows; beyond, the picture of pixels must do.
_SHOWN_BYTES = 2_000_000
#: Longest side of the picture of pixels that a notebook shows.
_SHOWN_SIDE = 800


def options(
    precision: int = 1,
    expand: bool = False,
    css: bool = False,
    max_bytes: int | None = None,
    scale: float = 1.0,
    background: str | None = None,
) -> str:
    """Give the options of writing and drawing for the compiled half."""
    return _inputs.to_json(
        {
            "precision": _inputs.whole("precision", precision, 0, 6),
            "expand": bool(expand),
            "css": bool(css),
            "max_bytes": None if max_bytes is None else _inputs.whole("max_bytes", max_bytes, 1, 10**12),
            "scale": _inputs.number("scale", scale, 0.01, 100),
            "background": background,
        }
    )


def svg(scene: _vtex.Scene) -> str | None:
    """Give the SVG that a notebook shows, if it is not too long."""
    text = scene.encode(".svg", options())
    return text.decode() if len(text) <= _SHOWN_BYTES else None


def png(scene: _vtex.Scene) -> bytes:
    """Give the PNG that a notebook shows."""
    scale = max(0.01, min(1.0, _SHOWN_SIDE / max(scene.width, scene.height)))
    return scene.encode(".png", options(scale=scale))
