"""Convert the arguments of users to the few forms that the compiled half accepts."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Sequence
from typing import IO, Any, Protocol, TypeAlias, TypeGuard, Union

import numpy as np
import numpy.typing as npt

from vtex import _vtex
from vtex._errors import InputError, InputTypeError


class PillowImage(Protocol):
    """An image of Pillow."""

    mode: str
    info: dict[Any, Any]

    def convert(self, mode: str) -> PillowImage:
        """Return the same picture in another mode."""
        ...


Path: TypeAlias = Union[str, "os.PathLike[str]"]
#: A picture: the path of a file, its bytes, the text of an SVG, an open file, an array, or an image of Pillow.
Picture: TypeAlias = Union[Path, bytes, bytearray, memoryview, IO[bytes], npt.NDArray[Any], PillowImage]
#: The size of a canvas: a number of pixels, a length such as ``"300mm"``, or two of these for width and height.
Size: TypeAlias = Union[int, str, Sequence[int], Sequence[str]]
#: Function that vtex calls with the name of a stage, the steps done and the number of steps (0 while it is unknown).
#: The work stops if the function returns False or raises an exception.
Progress: TypeAlias = Callable[[str, int, int], Union[bool, None]]

Named: TypeAlias = "tuple[str, bytes]"

_SIDES = 2

_BYTES = "give height x width x 3 of uint8, 0 to 255: array.astype('uint8')"


#: The text of an SVG begins with one of these.
_SVG = ("<svg", "<?xml", "<!--", "<!DOCTYPE svg")


def is_svg(text: str) -> bool:
    """Return whether text is an SVG, not a path."""
    return text.lstrip("\ufeff \t\r\n").startswith(_SVG)


def names_file(text: str) -> bool:
    """Return whether text that may be a name is a path or an SVG."""
    return "." in text or is_svg(text)


def path_of(path: Path) -> str:
    """Return a path as text."""
    text = os.fspath(path)
    if not isinstance(text, str):
        raise InputTypeError("a path of bytes cannot be used", "give str or pathlib.Path")
    return text


def contents(source: Picture, name: str | None) -> tuple[str, bytes] | None:
    """Return the name and the bytes of a file in any form, or None if the source is not a file."""
    if isinstance(source, str) and is_svg(source):
        data = source.lstrip("\ufeff \t\r\n").encode("utf-8", "replace")
        return name or f"text-{hashlib.sha256(data).hexdigest()[:12]}.svg", data
    if isinstance(source, (str, os.PathLike)):
        path = path_of(source)
        return name or path, _vtex.read(path)
    if isinstance(source, (bytes, bytearray, memoryview)):
        return name or "bytes", bytes(source)
    read = getattr(source, "read", None)
    if read is None:
        return None
    try:
        data = read()
    except ValueError as error:
        raise InputError(f"the file cannot be read: {error}", "open it, and give it while it is open") from error
    if not isinstance(data, bytes):
        raise InputTypeError("the file gives text", "open it with mode 'rb'")
    given = getattr(source, "name", None)
    return name or (given if isinstance(given, str) else "file"), data


def pixels_of_pillow(image: Any) -> npt.NDArray[Any]:
    """Return the pixels of an image of Pillow as vtex reads them from a file, but without its colour profile."""
    from PIL import ImageOps

    try:
        # Turn it by the orientation that the camera stored, as for files.
        image = ImageOps.exif_transpose(image)
        if image.mode not in ("L", "RGB", "RGBA", "I;16"):
            if image.mode in ("I", "F"):
                message = f"an image of mode '{image.mode}' has no range of values"
                raise InputTypeError(message, "convert it to 'L' or 'RGB'")
            clear = "A" in image.mode or "a" in image.mode or "transparency" in image.info
            image = image.convert("RGBA" if clear else "RGB")
        return np.asarray(image)
    except ValueError as error:
        raise InputError(f"the image cannot be read: {error}", "give it before it is closed") from error


def is_pillow(source: object) -> bool:
    """Return whether an object is an image of Pillow. This function does not import Pillow."""
    return any(kind.__module__ == "PIL.Image" for kind in type(source).__mro__)


def has_pixels(source: object) -> bool:
    """Return whether an object is an array, or numpy can read it as one."""
    return isinstance(source, np.ndarray) or hasattr(source, "__array__") or hasattr(source, "__array_interface__")


def array_of(source: object, role: str) -> npt.NDArray[Any]:
    """Return an object with pixels as an array of two or three axes."""
    if is_pillow(source):
        return pixels_of_pillow(source)
    if has_pixels(source):
        array: npt.NDArray[Any] = np.asarray(source)
        if array.ndim == 3 and array.shape[2] == 1:
            array = array[:, :, 0]
        if array.ndim not in (2, 3) or 0 in array.shape:
            raise InputError(
                f"{role} is an array of shape {array.shape}", "arrays are height x width, or height x width x 3 or 4"
            )
        if array.ndim == 3 and array.shape[2] not in (3, 4):
            first = array.shape[0] in (3, 4)
            raise InputError(
                f"{role} is an array of shape {array.shape}",
                "colours come last: array.transpose(1, 2, 0)" if first else "colours are 3 or 4, on the last axis",
            )
        return array
    raise InputTypeError(
        f"{role} is {type(source).__name__}",
        "give a path, bytes, an open file, an array of numpy, or an image of Pillow",
    )


def photo(source: Picture, name: str | None) -> tuple[str, bytes | npt.NDArray[Any]]:
    """Return a photograph as bytes, or as pixels of 8 bits."""
    file = contents(source, name)
    if file is not None:
        return file
    array = array_of(source, "the photograph")
    if array.dtype == np.uint16:
        # Round as for the samples of a file.
        array = ((array.astype(np.uint32) + 128) // 257).astype(np.uint8)
    elif array.dtype == np.bool_:
        array = array.astype(np.uint8) * 255
    elif array.dtype != np.uint8:
        scaled = "(array * 255).round().astype('uint8') if it is 0 to 1"
        raise InputTypeError(
            f"the photograph is an array of {array.dtype}", scaled if array.dtype.kind == "f" else _BYTES
        )
    return name or "array", np.ascontiguousarray(array)


def picture(source: Picture | None, role: str, most: float = 1.0) -> Named | None:
    """Return a control picture as the bytes of a file. Floats are 0 to `most`."""
    if source is None:
        return None
    file = contents(source, None)
    if file is not None:
        return file
    array = array_of(source, role)
    if array.dtype.kind == "f":
        if array.ndim != 2:
            raise InputError(f"{role} is an array of floats of shape {array.shape}", "give height x width")
        if not bool(((array >= 0) & (array <= most)).all()):
            raise InputError(f"{role} has values that are not 0 to {most:g}", "clip them: array.clip(0, ...)")
        array = np.rint(array.astype(np.float64) * (65535 / most)).astype(np.uint16)
    elif array.dtype == np.bool_:
        array = array.astype(np.uint8) * 255
    elif array.dtype != np.uint8 and not (array.dtype == np.uint16 and array.ndim == 2):
        raise InputTypeError(f"{role} is an array of {array.dtype}", "give uint8, bool, or floats in range")
    data = _vtex.encode(np.ascontiguousarray(array))
    return f"array-{hashlib.sha256(data).hexdigest()[:12]}.png", data


def size_of(size: Size | None) -> tuple[int, int] | tuple[str, str] | None:
    """Return the width and height of a canvas in pixels, or those of a page as lengths."""
    if size is None:
        return None
    hint = "give a number of pixels, a length such as '300mm', or (width, height)"
    wrong = InputTypeError(f"size = {size!r} cannot be used", hint)
    if isinstance(size, str):
        parts = re.split(r"(?<=[a-z])\s*x\s*(?=[\d.])", size)
        size = (parts[0], parts[-1]) if len(parts) <= _SIDES else parts
    try:
        sides = [size, size] if isinstance(size, (int, np.integer)) else list(size)
        if len(sides) == _SIDES and all(isinstance(side, str) for side in sides):
            return str(sides[0]), str(sides[1])
        width, height = (int(side) if isinstance(side, (int, np.integer)) else None for side in sides)
    except (TypeError, ValueError):
        raise wrong from None
    if width is None or height is None or isinstance(size, bool):
        raise wrong
    if not (1 <= width <= 100_000 and 1 <= height <= 100_000):
        raise InputError(f"size = {width}x{height} is out of range: 1 to 100000 px on each side")
    return width, height


def plain(value: object) -> Any:
    """Return a number of numpy as a number of Python, for JSON."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    raise InputTypeError(f"{value!r} cannot be used here", "give numbers, text, True or False")


def to_json(value: object) -> str:
    """Return parameters as JSON for the compiled half."""
    try:
        return json.dumps(value, default=plain, allow_nan=False)
    except ValueError:
        raise InputError("a parameter is not a finite number") from None


def whole(name: str, value: object, least: int, most: int) -> int:
    """Return a whole number, if it is in a range."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise InputTypeError(f"{name} = {value!r} is no whole number", f"give {least} to {most}")
    if not least <= value <= most:
        raise InputError(f"{name} = {value} is out of range: {least} to {most}")
    return int(value)


def seed_of(seed: int) -> int:
    """Return the seed of random choices, if it is in its range."""
    return whole("seed", seed, 0, 2**64 - 1)


def is_number(value: object) -> TypeGuard[float]:
    """Return whether an object is a number. True and False are not numbers."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def number(name: str, value: object, least: float, most: float) -> float:
    """Return a number, if it is in a range."""
    if not is_number(value):
        raise InputTypeError(f"{name} = {value!r} is no number", f"give {least:g} to {most:g}")
    if not least <= value <= most:
        raise InputError(f"{name} = {value} is out of range: {least:g} to {most:g}")
    return float(value)


def pair(name: str, value: object, second: float | None = None) -> list[Any]:
    """Return numbers for x and y. A single number is for both, unless `second` is the number for y."""
    value = value.tolist() if isinstance(value, np.ndarray) else value
    if is_number(value):
        return [value, value if second is None else second]
    if not isinstance(value, Sequence) or len(value) != 2:
        raise InputTypeError(f"{name} = {value!r} cannot be used", "give a number, or one for x and one for y")
    return list(value)


def document(data: object) -> Named:
    """Return the bytes of a document, with a name."""
    if not isinstance(data, (bytes, bytearray, memoryview)):
        raise InputTypeError(f"{type(data).__name__} are no bytes", "to read a file, call read")
    return "bytes", bytes(data)
