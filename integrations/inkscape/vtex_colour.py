# Part of the extension of vtex for Inkscape.
"""Colours in Oklab, where equal distances look equal."""

from __future__ import annotations

import math
import re

from inkex import AbortExtension, Color, ColorError

Lab = tuple[float, float, float]

HUES = ("red", "orange", "yellow", "green", "teal", "blue", "violet", "pink")
HUE_STARTS = (0.0, 45.0, 80.0, 125.0, 170.0, 220.0, 285.0, 330.0)
"""Where each hue starts on the circle of Oklab, in degrees."""

SAME_HUE, OTHER_HUE = 0.05, 0.1
"""Distances without lightness: up to the first, a colour is a shade of another; from the second, it is not."""


def parse(text: str) -> tuple[int, int, int]:
    """Return the red, green and blue of a colour in hex or with a name of CSS."""
    match = re.fullmatch(r"#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})", text.strip())
    if match:
        digits = match[1] if len(match[1]) == 6 else "".join(2 * digit for digit in match[1])
        return int(digits[0:2], 16), int(digits[2:4], 16), int(digits[4:6], 16)
    try:
        red, green, blue = Color(text.strip()).to_rgb()[:3]
    except (ColorError, ValueError, TypeError) as error:
        raise AbortExtension(
            f"'{text}' is not a colour.\nhint: write #rrggbb or a name of CSS, such as teal"
        ) from error
    return int(red), int(green), int(blue)


def to_hex(red: int, green: int, blue: int) -> str:
    """Write a colour as #rrggbb."""
    return f"#{red:02x}{green:02x}{blue:02x}"


def to_lab(text: str) -> Lab:
    """Return a colour in Oklab."""
    linear = []
    for value in parse(text):
        share = value / 255
        linear.append(share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4)
    red, green, blue = linear
    long = cube_root(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue)
    medium = cube_root(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue)
    short = cube_root(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue)
    return (
        0.2104542553 * long + 0.7936177850 * medium - 0.0040720468 * short,
        1.9779984951 * long - 2.4285922050 * medium + 0.4505937099 * short,
        0.0259040371 * long + 0.7827717662 * medium - 0.8086757660 * short,
    )


def cube_root(value: float) -> float:
    """Return the cube root of a number that is not negative; math.cbrt needs Python 3.11."""
    return value ** (1 / 3)


def linear_of(lab: Lab) -> tuple[float, float, float]:
    """Return linear red, green and blue; outside 0 to 1 for colours that sRGB does not have."""
    lightness, a, b = lab
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    return (
        4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short,
        -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short,
        -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short,
    )


def from_lab(lab: Lab) -> str:
    """Return a colour as #rrggbb; one too strong for sRGB becomes weaker, with the same lightness and hue."""
    lightness = min(max(lab[0], 0.0), 1.0)
    low, high = 0.0, 1.0

    def fits(share: float) -> bool:
        linear = linear_of((lightness, share * lab[1], share * lab[2]))
        return all(-1e-4 <= value <= 1 + 1e-4 for value in linear)

    if not fits(1.0):
        for _ in range(12):
            middle = (low + high) / 2
            low, high = (middle, high) if fits(middle) else (low, middle)
        share = low
    else:
        share = 1.0
    values = []
    for value in linear_of((lightness, share * lab[1], share * lab[2])):
        value = min(max(value, 0.0), 1.0)
        encoded = 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
        values.append(round(255 * encoded))
    return to_hex(*values)


def shifted(colour: str, main: Lab, target: Lab, keep: bool = False) -> str:
    """Return a colour after the change that turns `main` into `target`. Black, white and shading stay.

    With `keep`, colours of another hue stay too, such as those of the hearts of flowers.
    """
    old = to_lab(colour)
    lightness, a, b = old
    far = math.hypot(a - main[1], b - main[2])
    share = min(max((OTHER_HUE - far) / (OTHER_HUE - SAME_HUE), 0.0), 1.0) if keep else 1.0
    if lightness <= main[0]:
        lightness = target[0] * lightness / main[0] if main[0] > 0 else target[0]
    else:
        lightness = 1 - (1 - target[0]) * (1 - lightness) / (1 - main[0])
    new = lightness, a + target[1] - main[1], b + target[2] - main[2]
    return from_lab(mixed(old, new, share)) if share else colour


def mixed(old: Lab, new: Lab, share: float) -> Lab:
    """Return the mixture of two colours."""
    lightness, a, b = (before + share * (after - before) for before, after in zip(old, new, strict=True))
    return lightness, a, b


def broad_name(colour: str) -> str:
    """Return a name that similar colours share, such as 'dark green'."""
    lightness, a, b = to_lab(colour)
    depth = "dark" if lightness < 0.4 else "light" if lightness > 0.7 else "middle"
    if math.hypot(a, b) < 0.03:
        return f"{depth} grey"
    hue = math.degrees(math.atan2(b, a)) % 360
    name = [name for name, start in zip(HUES, HUE_STARTS, strict=True) if start <= hue][-1]
    return f"{depth} {name}"
