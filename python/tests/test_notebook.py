"""The notebook, run from beginning to end without a screen."""

from pathlib import Path

import pytest

NOTEBOOK = Path(__file__).resolve().parents[1] / "examples" / "textures.ipynb"


def test_the_notebook_runs_and_shows_its_pictures():
    nbformat = pytest.importorskip("nbformat", reason="pip install nbclient ipykernel")
    nbclient = pytest.importorskip("nbclient", reason="pip install nbclient ipykernel")
    pytest.importorskip("ipykernel", reason="pip install nbclient ipykernel")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(NOTEBOOK.parent)}}
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=resources).execute()
    shown = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    kinds = [{"image/png", "image/svg+xml"} & set(output.get("data", {})) for output in shown]
    # Each stores one.
    assert [len(kind) for kind in kinds if kind] == [1] * 7
    assert {"image/svg+xml"} in kinds
    assert not any(output.output_type == "error" for output in shown)
