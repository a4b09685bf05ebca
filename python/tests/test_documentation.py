"""Documentation in the form of numpydoc, for every public name."""

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
