"""Edits: what each does, and that all are what the program does."""

import json
import pickle
import re
import subprocess
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import vtex


def test_colours_are_mixed(scene):
    red = scene.edit(vtex.Tint("red", amount=1.0))
    assert red != scene and red.edits[0]["operation"]["edit"]["action"]["tint"]["colour"] == "#ff0000"
    mean = red.render(background="none", alpha=True)
    inside = mean[mean[..., 3] == 255][:, :3].mean(axis=0)
    assert inside[0] > 200 > 60 > inside[1]
    for other in ("#f00", "#FF0000", (255, 0, 0), np.array([255, 0, 0]).tolist()):
        assert scene.edit(vtex.Tint(other, amount=1.0)) == red


def test_edits_are_done_in_order(scene):
    once = scene.edit(vtex.Thin(0.5), vtex.Shadow(length=4))
    assert once == scene.edit(vtex.Thin(0.5)).edit(vtex.Shadow(length=4))
    assert once.instances < scene.instances
    assert len(once.edits) == 2
    assert scene.edit() == scene.edit([]) == scene
    for listed in ([vtex.Thin(0.5), vtex.Shadow(length=4)], (vtex.Thin(0.5), vtex.Shadow(length=4))):
        assert scene.edit(listed) == once
        assert scene.edit(iter(listed)) == once
    assert scene.edit([vtex.Thin(0.5)], vtex.Shadow(length=4)) == once


def test_selections_limit_edits(scene):
    layers = {layer.role: layer.instances for layer in scene.layers}
    gone = scene.edit(vtex.Delete(layer="secondary"))
    assert {layer.role: layer.instances for layer in gone.layers} == layers | {"secondary": 0}
    left = scene.edit(vtex.Delete(where="x<150"))
    assert 0 < left.instances < scene.instances
    both = scene.edit(vtex.Delete(where=["x<150", "y<100"]))
    assert both == scene.edit(vtex.Delete(where="x<150, y<100")).edit() and both.instances > left.instances


def test_maps_are_paths_bytes_and_arrays(scene, tmp_path):
    left = np.zeros((20, 30))
    left[:, :15] = 1.0
    kept = scene.edit(vtex.Density(left))
    assert 0 < kept.instances < scene.instances
    from PIL import Image

    greys = Image.fromarray((left * 255).astype(np.uint8))
    greys.save(tmp_path / "left.png")
    for same in (tmp_path / "left.png", str(tmp_path / "left.png"), (tmp_path / "left.png").read_bytes(), greys):
        other = scene.edit(vtex.Density(same))
        assert (other.layers, other.render().tolist()) == (kept.layers, kept.render().tolist())
    assert scene.edit(vtex.Mask(left)) != scene.edit(vtex.Mask(left, inside=False))
    grown = scene.edit(vtex.Scale(left))
    assert grown != scene
    assert scene.edit(vtex.Vary(colour=left, shape=0.5)).edits[0]["operation"]["edit"]["action"]["vary"]["shape"] == 0.5
    turned = scene.edit(vtex.Orient(left), vtex.Rotate(left))
    assert [next(iter(e["operation"]["edit"]["action"])) for e in turned.edits] == ["orient", "rotate"]
    coloured = np.zeros((4, 4, 3), np.uint8)
    coloured[..., 2] = 255
    blue = scene.edit(vtex.Tint(coloured, amount=1.0)).render(background="none", alpha=True)
    assert blue[blue[..., 3] == 255][:, 2].mean() > 200


def test_different_arrays_have_different_names(scene):
    one, two = np.zeros((3, 3)), np.ones((3, 3))
    edited = scene.edit(vtex.Scale(one), vtex.Scale(two))
    names = {e["operation"]["edit"]["action"]["scale"]["factor"] for e in edited.edits}
    assert len(names) == 2


def test_libraries_replace_elements(scene, library, tmp_path, pixels):
    other = vtex.analyze(255 - pixels, name="negative", segmenter="regions")
    replaced = scene.edit(vtex.Replace(other))
    assert "negative" in replaced.exemplars
    other.save(tmp_path / "other.lib.json")
    by_path = scene.edit(vtex.Replace(tmp_path / "other.lib.json"))
    assert by_path.layers == replaced.layers and (by_path.render() == replaced.render()).all()


def test_palettes_are_colours_or_files(scene, tmp_path):
    (tmp_path / "p.txt").write_text("#102030 and #d0c0b0")
    by_file = scene.edit(vtex.Palette(tmp_path / "p.txt"))
    by_list = scene.edit(vtex.Palette(["#102030", (0xD0, 0xC0, 0xB0)]))
    assert (by_file.render() == by_list.render()).all()


def test_edits_are_plain_values():
    for edit in (vtex.Tint("red", 0.3, layer="primary"), vtex.Density(np.ones((2, 2))), vtex.Flatten()):
        again = pickle.loads(pickle.dumps(edit))
        assert again == edit and type(again) is type(edit)
    assert vtex.Tint("red") != vtex.Tint("red", 0.4) != vtex.Shadow()
    assert vtex.Density(np.ones((2, 2))) != vtex.Density(np.zeros((2, 2)))
    assert "amount=0.5" in repr(vtex.Tint("red"))


# For each class an edit with its defaults, and how the program is told.
DEFAULTS = [
    (vtex.Thin(0.5), "thin 0.5"),
    (vtex.Orient(30), "orient 30"),
    (vtex.Tint("tan"), "tint tan"),
    (vtex.Recolor("#808080", "#3060a0"), "recolor --from #808080 --to #3060a0"),
    (
        vtex.Recolor("#808080", "#3060a0", keep="details"),
        "recolor --from #808080 --to #3060a0 --keep details",
    ),
    (vtex.Shadow(), "shadow"),
    (vtex.Flatten(), "flatten"),
    (vtex.Simplify(1), "simplify 1"),
    (vtex.Outline(1.5, "#202020"), "outline 1.5 #202020"),
    (vtex.Hatch(spacing=5), "hatch --spacing 5"),
    (vtex.Move(20, -5, where="x<100"), "move 20 -5 --where x<100"),
    (vtex.Scale(1.3, layer="primary"), "scale 1.3 --layer primary"),
    (vtex.Rotate(90), "rotate 90"),
    (vtex.Transform(by=3), "transform --move 3"),
    (vtex.Jitter(distance=4), "jitter --move 4"),
    (vtex.Shuffle(), "shuffle"),
    (vtex.Vary(colour=1.5), "vary --color 1.5"),
    (vtex.Relax(), "relax"),
    (vtex.Order("y"), "order y"),
    (vtex.Delete(where="area<30"), "delete --where area<30"),
    (vtex.Mask("shape.svg"), "mask shape.svg"),
    (vtex.Density("map.png"), "density map.png"),
    (vtex.Palette("palette.txt"), "palette palette.txt"),
    (vtex.Propagate("shape.svg"), "propagate shape.svg"),
    (vtex.Propagate(element="shape.svg"), "propagate --element shape.svg"),
    (vtex.Propagate(fill="teal", layer="primary"), "propagate --fill teal --layer primary"),
    (vtex.Replace("other.lib.json"), "replace other.lib.json"),
]


def test_svgs_are_paths_bytes_and_text(scene, folder):
    path = folder / "shape.svg"
    text = path.read_text()
    wanted = scene.edit(vtex.Mask(path))
    for form in (text, f'<?xml version="1.0"?>\n{text}', text.encode()):
        assert scene.edit(vtex.Mask(form)).layers == wanted.layers
    drawn = [scene.edit(vtex.Propagate(form)).render() for form in (path, text)]
    assert (drawn[0] == drawn[1]).all()
    names = [edit["operation"]["edit"]["action"] for edit in scene.edit(vtex.Mask(text)).edits]
    assert names[0]["mask"]["shape"].startswith("text-")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, scene, library):
    from PIL import Image

    folder = tmp_path_factory.mktemp("edits")
    scene.save(folder / "scene.scene.json")
    library.save(folder / "other.lib.json")
    Image.fromarray(np.tile(np.arange(256, dtype=np.uint8), (8, 1))).save(folder / "map.png")
    (folder / "palette.txt").write_text("#402010 #80a060 #f0e0d0")
    svg = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 300 200"><path d="M60 40h160v120h-160z"/></svg>'
    (folder / "shape.svg").write_text(svg)
    return folder


@pytest.mark.parametrize(("edit", "text"), DEFAULTS, ids=[text for _, text in DEFAULTS])
def test_defaults_are_those_of_the_program(edit, text, program, folder, scene, monkeypatch):
    monkeypatch.chdir(folder)
    command = [program, "edit", "scene.scene.json", "--op", text, "-o", "by-program.scene.json", "--force", "--quiet"]
    subprocess.run(command, check=True)
    scene.edit(edit).save("by-python.scene.json", force=True)
    assert (folder / "by-python.scene.json").read_bytes() == (folder / "by-program.scene.json").read_bytes()


def test_every_class_of_edits_is_compared():
    classes = {kind for kind in vtex.Edit.__subclasses__()}
    assert classes == {type(edit) for edit, _ in DEFAULTS}
    for kind in classes:
        for field in fields(kind):
            assert field.name in ("layer", "where") or field.name in kind.__doc__, (kind, field.name)


def _operations():
    """Return the operations of the schema of scenes, which the program makes: the fields of each, by name."""
    text = (Path(__file__).parents[2] / "schema" / "scene.schema.json").read_text(encoding="utf-8")
    definitions = json.loads(text)["$defs"]
    operations = {}
    for case in definitions["Action"]["oneOf"]:
        operations.update({name: {} for name in case.get("enum", [case.get("const")]) if name})
        for name, content in case.get("properties", {}).items():
            content = definitions[content["$ref"].rsplit("/", 1)[1]] if "$ref" in content else content
            operations[name] = content["properties"]
    return operations


def test_classes_have_the_fields_and_ranges_of_the_operations():
    classes = {kind._word: kind for kind in vtex.Edit.__subclasses__()}
    operations = _operations()
    assert classes.keys() == operations.keys() and len(operations) > 20
    ranges = 0
    for word, properties in operations.items():
        kind = classes[word]
        own = {field.name.rstrip("_") for field in fields(kind)} - {"layer", "where"}
        # A palette's file is told by its name, in place of colours.
        assert own == properties.keys() - ({"file"} if word == "palette" else set()), word
        documented = {}
        for names, text in re.findall(r"^([\w, ]+) : (.*\n(?:    .*\n|\n)*)", kind.__doc__, re.MULTILINE):
            documented.update({name.rstrip("_"): " ".join(text.split()) for name in names.split(", ")})
        for name, declared in properties.items():
            if "minimum" in declared:
                number = r"-?\d+(?:\.\d+)?(?:\*\*\d+)?"
                told = re.findall(rf"({number}) to ({number})", documented[name])
                told = [tuple(float(eval(end)) for end in ends) for ends in told]
                assert (declared["minimum"], declared["maximum"]) in told, (word, name, told)
                ranges += 1
    assert ranges > 20
