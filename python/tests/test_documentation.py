"""Documentation in the form of numpydoc, for every public name."""

import inspect
import json
import re
from pathlib import Path

import pytest

import vtex

# What is not asked for: sections for examples, references and the like, and their order.
LEFT_OUT = {"GL01", "GL02", "GL03", "GL08", "SA01", "EX01", "ES01", "RT02", "PR09", "SS06"}
NAMES = [f"vtex.{name}" for name in vtex.__all__ if name != "__version__"] + [
    f"vtex.{kind.__name__}.{name}"
    for kind in (vtex.Library, vtex.Scene)
    for name in dir(kind)
    if not name.startswith("_")
]


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_is_documented(name):
    validate = pytest.importorskip("numpydoc.validate", reason="pip install numpydoc")
    faults = [f"{code}: {text}" for code, text in validate.validate(name)["errors"] if code not in LEFT_OUT]
    assert not faults
    assert validate.validate(name)["docstring"].strip()


def test_ranges_are_those_of_the_schemas():
    docscrape = pytest.importorskip("numpydoc.docscrape", reason="pip install numpydoc")
    folder = Path(__file__).parents[2] / "schema"
    library, scene = (json.loads((folder / f"{n}.schema.json").read_text())["$defs"] for n in ("library", "scene"))
    kinds = {kind._word: kind for kind in vtex.Edit.__subclasses__()}
    documented = [(vtex.analyze, library["AnalyzeParams"]), (vtex.synthesize, scene["SynthParams"])]
    for action in scene["Action"]["oneOf"]:
        for word, schema in action.get("properties", {}).items():
            documented.append((kinds[word], scene["Jitter"] if "$ref" in schema else schema))
    checked = 0
    for what, schema in documented:
        for parameter in docscrape.NumpyDocString(inspect.getdoc(what))["Parameters"]:
            words = re.sub(r"(?<=\d) (?=\d{3}\b)", "", " ".join(parameter.desc))
            words = re.sub(r"10\*\*(\d)", lambda power: str(10 ** int(power[1])), words)
            for name in parameter.name.split(", "):
                limits = schema["properties"].get(name, {})
                if "maximum" in limits:
                    low, high = (re.escape(f"{limits[key]:.10g}") for key in ("minimum", "maximum"))
                    # The 0 of some parameters means none.
                    expected = rf"\bto {high}\b" if low == "0" else rf"(?<![\d.]){low} to {high}\b"
                    assert re.search(expected, words), f"{what.__name__}: {name}: {words}"
                    checked += 1
    assert checked > 40
