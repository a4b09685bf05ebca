# ruff: noqa: D103, RUF100
"""Tests of the parts that need neither vtex nor Inkscape's window."""

from __future__ import annotations

import itertools
import random
import re
from pathlib import Path

import pytest
from lxml import etree
from vtex_arrange import Item, arrange
from vtex_boxes import Boxes, overlap, path_box
from vtex_colour import broad_name, from_lab, shifted, to_lab
from vtex_fill import Fill
from vtex_recolour import Recolour
from vtex_swatch import Swatch
from vtex_texture import moved

FOLDER = Path(__file__).resolve().parents[1]


def test_box_of_a_path() -> None:
    assert path_box("m10 20 5 5h-20v1.5z") == (-5, 20, 15, 26.5)
    assert path_box("M1-2C3 4 5 6 7 8L-1.5.5") == (-1.5, -2, 7, 8)
    # After z the pen is at the start again.
    assert path_box("m10 10h5v5zm1 1h1") == (10, 10, 15, 15)
    with pytest.raises(ValueError, match="'a'"):
        path_box("m0 0a1 1 0 0 0 5 5")


def test_box_of_a_turned_clone_with_a_stroke() -> None:
    svg = etree.fromstring(
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
        '<g id="a"><path d="m0 0h10v2z"/><circle r="1" transform="matrix(2 0 0 1 20 0)"/></g>'
        '<use xlink:href="#a" x="5" y="1" transform="rotate(90)" stroke="red" stroke-width="1"/></svg>'
    )
    box = Boxes([svg]).box(svg[1])
    # (0, -1) to (22, 2), moved by (5, 1), wider by 2 for the stroke, then x becomes y and y becomes -x.
    assert box == pytest.approx((-5, 3, 2, 29))


def squares(count: int, seed: int) -> list[Item]:
    rng = random.Random(seed)
    items = []
    for _ in range(count):
        x, y, side = rng.uniform(0, 100), rng.uniform(0, 100), rng.uniform(0.5, 12)
        kind = rng.choice("abc")
        items.append(Item(etree.Element("path"), [(x, y, x + side, y + side)], kind, kind))
    return items


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("apart", [False, True])
def test_groups_keep_the_order_of_what_overlaps(seed: int, apart: bool) -> None:
    items = squares(250, seed)
    groups = arrange(items, lambda item: item.category, limit=20, apart=apart)
    place = {id(item): (g, i) for g, group in enumerate(groups) for i, item in enumerate(group)}
    assert len(place) == len(items)
    for before, after in itertools.combinations(items, 2):
        if overlap(before.boxes[0], after.boxes[0]):
            assert place[id(before)] < place[id(after)]
            assert not apart or place[id(before)][0] != place[id(after)][0]
    for group in groups:
        assert len(group) <= 20
        assert len({item.category for item in group}) == 1
    assert len(groups) < len(items) / 2


def test_elements_apart_become_one_group_per_category() -> None:
    items = [Item(etree.Element("path"), [(3 * i, 0, 3 * i + 1, 1)], "ab"[i % 2], "") for i in range(40)]
    assert [len(group) for group in arrange(items, lambda item: item.category)] == [20, 20]


def test_path_data_that_can_follow_other_data() -> None:
    assert moved("m1-2 3 4h1z", 10, 20) == "M11 18l3 4h1z"
    assert moved("m.5.5c1 2 3 4 5 6m1 1h2", 0, 1) == "M0.5 1.5c1 2 3 4 5 6m1 1h2"
    assert moved("m1 2L5 6", 0, 0) is None


def test_colours_survive_oklab() -> None:
    for colour in ("#000000", "#ffffff", "#c04020", "#1d3557", "#00ff00"):
        assert from_lab(to_lab(colour)) == colour
    assert from_lab((0.6, 0.9, 0.9)) != "#ffffff"
    assert broad_name("#2f5d20") == "middle green"
    assert broad_name("#101010") == "dark grey"


def test_a_shift_reaches_its_target_and_keeps_shading() -> None:
    main, target = to_lab("#808080"), to_lab("#2050c0")
    assert shifted("#808080", main, target) == "#2050c0"
    dark, light = (to_lab(shifted(colour, main, target))[0] for colour in ("#404040", "#c0c0c0"))
    assert dark < target[0] < light
    assert shifted("#e0a000", main, target, keep=True) == "#e0a000"
    assert shifted("#e0a000", main, target, keep=False) != "#e0a000"


@pytest.mark.parametrize("extension, name", [(Fill, "fill"), (Swatch, "swatch"), (Recolour, "recolour")])
def test_the_dialog_has_the_parameters_of_the_script(extension: type, name: str) -> None:
    tree = etree.parse(str(FOLDER / f"vtex_{name}.inx"))
    space = {"i": "http://www.inkscape.org/namespace/inkscape/extension"}
    shown = {param.get("name") for param in tree.iterfind(".//i:param", space)}
    made = extension()
    known = {action.dest for action in made.arg_parser._actions} - {
        "help",
        "output",
        "ids",
        "selected_nodes",
        "input_file",
    }
    # A swatch is a drawing, which has no shading of a photograph.
    assert shown == known - ({"shading"} if name == "swatch" else set())
    script = tree.find(".//i:command", space).text
    assert (FOLDER / script).is_file()
    for param in tree.iterfind(".//i:param[@type='optiongroup']", space):
        first = param.find("i:option", space).get("value")
        assert first == made.arg_parser.get_default(param.get("name")), param.get("name")


def test_the_manual_names_all_files() -> None:
    text = (FOLDER / "README.md").read_text("utf-8")
    for path in FOLDER.glob("vtex_*.*"):
        assert re.search(rf"\b{re.escape(path.name)}\b", text), path.name
