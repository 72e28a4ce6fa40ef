"""The examples for jax and torch, where these are installed; those for SciPy run with the other pages."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "frameworks.md"


@pytest.mark.parametrize("framework", ["jax", "torch"])
def test_the_examples_run(framework):
    blocks = re.findall(rf"^```python \({framework}\)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert blocks
    pytest.importorskip(framework)
    for block in blocks:
        done = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
