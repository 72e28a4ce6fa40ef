"""The examples run."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_design_split():
    done = subprocess.run(
        [sys.executable, EXAMPLES / "design_split.py", "--quick"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "9 + 16 parameters, 100 designs a run" in done.stdout and "sections     median" in done.stdout


@pytest.mark.parametrize("notebook", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook(notebook):
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    os.environ.setdefault("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    read = nbformat.read(notebook, as_version=4)
    nbformat.validate(read)
    assert not any(cell.get("outputs") for cell in read.cells), "kept without outputs"
    nbclient.NotebookClient(read, timeout=300, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    pictures = [o for cell in read.cells for o in cell.get("outputs", []) if "image/png" in o.get("data", {})]
    assert len(pictures) >= 3
