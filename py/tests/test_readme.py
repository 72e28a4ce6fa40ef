"""What the READMEs say of Python, as it is written there."""

import re
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")

REPOSITORY = Path(__file__).parents[2]
BLOCKS = [
    pytest.param(block, id=f"{name}-{number}")
    for name in ("README.md", "py/README.md")
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", (REPOSITORY / name).read_text(), re.DOTALL))
]


@pytest.mark.parametrize("block", BLOCKS)
def test_what_the_readmes_say_runs(block):
    exec(block, {})


def test_there_is_something_to_run():
    assert len(BLOCKS) == 3
