"""Masks in place of a segmenter: labels, boolean arrays, and what Segment Anything gives."""

import io

import numpy as np
import pytest
from PIL import Image

import vtex

BOXES = [(20, 50, 20, 60), (70, 100, 80, 130), (10, 40, 90, 150)]


@pytest.fixture(scope="module")
def stack(pixels):
    """Three masks that do not overlap."""
    stack = np.zeros((3, *pixels.shape[:2]), bool)
    for mask, (top, bottom, left, right) in zip(stack, BOXES, strict=True):
        mask[top:bottom, left:right] = True
    return stack


@pytest.fixture(scope="module")
def analyzed(pixels):
    """The elements that masks give, without what is found between them."""
    return lambda masks: vtex.analyze(pixels, masks=masks, secondary_tolerance=0.0)


@pytest.fixture(scope="module")
def wanted(analyzed, stack):
    return analyzed(stack)


def outlines(library):
    return [element["shapes"] for element in library.to_dict()["elements"][: library.primaries]]


def test_labels_take_the_place_of_a_segmenter(analyzed, stack, wanted):
    labels = sum((number + 1) * mask.astype(np.int64) for number, mask in enumerate(stack))
    library = analyzed(labels)
    assert library.primaries == wanted.primaries == 3
    assert library.to_dict()["source"]["segmenter"] == wanted.to_dict()["source"]["segmenter"] == "masks:array"
    assert outlines(library) == outlines(wanted)
    file = io.BytesIO()
    Image.fromarray(labels.astype(np.uint8)).save(file, "PNG")
    assert outlines(analyzed(file.getvalue())) == outlines(wanted)
    # One mask is a label map of 0 and 1.
    assert analyzed(stack[0]).primaries == 1


def rle(mask, pack):
    """Write a mask as COCO does."""
    flat = np.concatenate([[False], mask.T.ravel()])
    starts = np.flatnonzero(np.diff(flat.astype(np.int8))).tolist()
    counts = np.diff([0, *starts, mask.size]).tolist()
    if not pack:
        return {"size": list(mask.shape), "counts": counts}
    text = b""
    for place, count in enumerate(counts):
        value = count - counts[place - 2] if place > 2 else count
        more = True
        while more:
            bits, value = value & 0x1F, value >> 5
            more = value != (-1 if bits & 0x10 else 0)
            text += bytes([(bits | 0x20 if more else bits) + 48])
    return {"size": list(mask.shape), "counts": text if pack == "bytes" else text.decode()}


class Tensor:
    """What has an array, as those of torch have."""

    def __init__(self, array):
        self.array = array

    def __array__(self, dtype=None, copy=None):
        return self.array


def test_boolean_arrays_are_masks(analyzed, stack, wanted):
    dictionaries = [
        {"segmentation": mask, "area": int(mask.sum()), "predicted_iou": 1.01, "stability_score": np.float32(1)}
        for mask in stack
    ]
    forms = {
        "list": list(stack),
        "tuple": tuple(stack),
        "strided": stack.transpose(0, 2, 1).copy().transpose(0, 2, 1),
        "predictor": stack[:, None],
        "tensor": Tensor(stack),
        "tensors": [Tensor(mask[None]) for mask in stack],
        "generator": dictionaries,
        "only masks": [{"segmentation": mask} for mask in stack],
        "run lengths": [{"segmentation": rle(mask, None)} for mask in stack],
        "packed": [{"segmentation": rle(mask, "text")} for mask in stack],
        "packed bytes": [{"segmentation": rle(mask, "bytes")} for mask in stack],
        "with an empty one": [*stack, np.zeros_like(stack[0])],
    }
    for name, masks in forms.items():
        assert outlines(analyzed(masks)) == outlines(wanted), name


def test_masks_may_overlap_and_the_better_one_counts(analyzed, stack):
    whole = np.zeros_like(stack[0])
    whole[20:50, 20:110] = True
    sure, unsure = {"predicted_iou": 0.95, "stability_score": 0.97}, {"predicted_iou": 0.5, "stability_score": 0.6}
    one = analyzed([{"segmentation": whole, **sure}, {"segmentation": stack[0], **unsure}])
    other = analyzed([{"segmentation": whole, **unsure}, {"segmentation": stack[0], **sure}])
    assert one.primaries == other.primaries == 1


@pytest.mark.parametrize(
    ("masks", "kind", "message"),
    [
        ([], ValueError, "no mask"),
        (np.zeros((2, 128, 160), bool), ValueError, "no mask"),
        (np.zeros((0, 128, 160), bool), ValueError, "no mask"),
        (np.ones((2, 90, 160), bool), ValueError, "160 x 90"),
        ([np.ones((128, 160), bool), np.ones((128, 90), bool)], ValueError, "shape of the photograph"),
        (np.ones((2, 128, 160)), TypeError, "float64"),
        (np.ones((2, 128, 160), np.uint8), TypeError, "uint8"),
        ([np.ones((128, 160))], TypeError, r"masks\[0\] is an array of float64"),
        ([[1, 2]], TypeError, r"masks\[0\] is list"),
        ([{"area": 3}], ValueError, "segmentation"),
        ([{"segmentation": np.ones((128, 160), bool), "predicted_iou": "good"}], TypeError, "predicted_iou"),
        ([{"segmentation": {"size": [128, 160], "counts": [3, 4]}}], ValueError, "run lengths"),
        ([{"segmentation": {"size": [128, 160], "counts": "ooo"}}], ValueError, "run lengths"),
        ([{"segmentation": {"counts": [3, 4]}}], ValueError, "run lengths"),
        (np.full((128, 160), 70_000), ValueError, "65535"),
        (np.full((128, 160), -1), ValueError, "65535"),
        (3, TypeError, "masks is int"),
    ],
)
def test_other_masks_are_refused(analyzed, masks, kind, message):
    with pytest.raises(kind, match=message) as error:
        analyzed(masks)
    assert isinstance(error.value, vtex.Error)
