"""Masks, in the forms that segmenters return."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias, TypeGuard, Union

import numpy as np
import numpy.typing as npt

from vtex import _inputs, _vtex
from vtex._errors import InputError, InputTypeError

#: Masks: a picture of labels, boolean arrays, or the dictionaries of Segment Anything.
Masks: TypeAlias = Union[_inputs.Picture, "Sequence[npt.NDArray[np.bool_]]", "Sequence[Mapping[str, Any]]"]

_Found: TypeAlias = "tuple[float, npt.NDArray[np.bool_]]"

_FORMS = "give height x width of whole numbers (0 for none, 1, 2, ... for each mask), or N x height x width of bool"


def masks_of(source: Masks | None) -> _inputs.Named | None:
    """Return masks as the bytes of a file.

    Arrays of whole numbers contain a label for each pixel; 0 = no element. Arrays of bool contain one mask each. These
    masks may overlap.
    """
    if source is None:
        return None
    if _is_sequence(source):
        return "array", _encoded(_each(source))
    file = _inputs.contents(source, None)  # type: ignore[arg-type]
    if file is not None:
        # The library stores the file name without its folder.
        return os.path.basename(file[0]), file[1]
    array = np.asarray(source) if _inputs.has_pixels(source) else _inputs.array_of(source, "masks")
    if array.dtype == np.bool_ and array.ndim in (3, 4):
        # Predictors return one or several masks for each prompt.
        stacked = array.reshape(-1, *array.shape[-2:])
        return "array", _encoded((1.0, mask) for mask in stacked)
    return "array", _labels(array)


def _is_sequence(source: object) -> TypeGuard[Sequence[Any]]:
    return isinstance(source, (list, tuple))


def _labels(array: npt.NDArray[Any]) -> bytes:
    """Return a map of labels as PNG."""
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    if array.ndim != 2 or 0 in array.shape or array.dtype.kind not in "biu":
        stack = array.ndim == 3 and array.dtype.kind in "iuf"
        message = f"masks are an array of {array.dtype} of shape {array.shape}"
        raise InputTypeError(message, "a mask each is bool: array > 0" if stack else _FORMS)
    least, most = int(array.min()), int(array.max())
    if least < 0 or most > 65535:
        raise InputError(f"masks have numbers from {least} to {most}", "they are 0 to 65535")
    return _vtex.encode(np.ascontiguousarray(array.astype(np.uint8 if most < 256 else np.uint16)))


def _each(several: Iterable[Any]) -> Iterator[_Found]:
    """Return each mask of a list, with the score that the segmenter gave it."""
    for number, one in enumerate(several):
        score, mask = 1.0, one
        if isinstance(one, Mapping):
            if "segmentation" not in one:
                raise InputError(
                    f"masks[{number}] has no 'segmentation'", "give what Segment Anything's generator gives"
                )
            mask = one["segmentation"]
            score = math.prod(_share(one.get(name, 1.0), name) for name in ("predicted_iou", "stability_score"))
            if isinstance(mask, Mapping):
                mask = _run_lengths(mask, number)
        array = np.asarray(mask) if _inputs.has_pixels(mask) else None
        if array is not None and array.ndim == 3 and array.shape[0] == 1:
            array = array[0]
        if array is None or array.ndim != 2 or array.dtype != np.bool_:
            given = type(mask).__name__ if array is None else f"an array of {array.dtype} of shape {array.shape}"
            raise InputTypeError(f"masks[{number}] is {given}", "give height x width of bool: array > 0")
        yield score, array


def _share(value: object, name: str) -> float:
    """Return a share. vtex clips estimates that are slightly below 0 or above 1."""
    if not _inputs.is_number(value) or math.isnan(value):
        raise InputTypeError(f"{name} = {value!r} is no number", "give 0 to 1")
    return float(min(max(value, 0.0), 1.0))


def _encoded(masks: Iterable[_Found]) -> bytes:
    """Return masks in vtex's own JSON."""
    shape, stored = None, []
    for score, mask in masks:
        if shape not in (None, mask.shape):
            raise InputError(f"masks are {shape} and {mask.shape}", "all have the shape of the photograph")
        shape = mask.shape
        steps = np.diff(mask.astype(np.int8), axis=1, prepend=0, append=0)
        (rows, starts), (_, ends) = np.nonzero(steps > 0), np.nonzero(steps < 0)
        if rows.size:
            stored.append({"score": score, "runs": np.column_stack([rows, starts, ends]).tolist()})
    if shape is None or not stored:
        raise InputError("there is no mask", "leave out masks=, and a segmenter finds them")
    height, width = shape
    document = {"format": "vtex-masks", "version": 1, "width": width, "height": height, "segmenter": "array"}
    return json.dumps(document | {"masks": stored}).encode()


def _run_lengths(coded: Mapping[str, Any], number: int) -> npt.NDArray[np.bool_]:
    """Return a mask from COCO's run lengths. They run down the columns and start with pixels outside the mask."""
    try:
        height, width = (int(side) for side in coded["size"])
        counts = coded["counts"]
        runs = _unpacked(counts) if isinstance(counts, (str, bytes)) else [int(count) for count in counts]
        if min(runs, default=0) < 0 or sum(runs) != height * width:
            raise ValueError(f"runs of {sum(runs)} pixels in {height} x {width}")
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(f"masks[{number}] has damaged run lengths: {error}") from error
    on = np.arange(len(runs)) % 2 == 1
    mask: npt.NDArray[np.bool_] = np.repeat(on, runs).reshape(width, height).T
    return mask


def _unpacked(packed: str | bytes) -> list[int]:
    """Return run lengths from text packed by pycocotools: five bits a character, and steps from the third number on."""
    text = packed.encode() if isinstance(packed, str) else packed
    runs: list[int] = []
    place = 0
    while place < len(text):
        value, shift, more = 0, 0, True
        while more:
            bits = text[place] - 48
            value |= (bits & 0x1F) << shift
            more = bool(bits & 0x20)
            place, shift = place + 1, shift + 5
            if not more and bits & 0x10:
                value -= 1 << shift
        runs.append(value + runs[-2] if len(runs) > 2 else value)
    return runs
