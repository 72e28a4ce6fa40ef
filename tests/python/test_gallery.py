"""The tables of dimensions in docs/gallery: they are those of the files, and what they say of a change works."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
COMMANDS = re.findall(r"^To change one: `(opm [^`]+)`", (GALLERY / "README.md").read_text(encoding="utf-8"), re.M)


def test_tables_are_those_of_the_files():
    done = subprocess.run([sys.executable, GALLERY / "dimensions.py", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_mechanism_with_dimensions_has_a_table():
    sections = (GALLERY / "README.md").read_text(encoding="utf-8").split("\n## ")[1:]
    without = [section.split("\n")[0] for section in sections if "<!-- dimensions -->" not in section]
    assert without == ["agile-eye"]  # All of its angles are right.


@pytest.mark.parametrize("command", COMMANDS)
def test_a_dimension_is_changed_as_it_is_told(opm, command):
    before = subprocess.run([opm, *command.split()[1:3]], capture_output=True, text=True)
    after = subprocess.run([opm, *command.split()[1:]], capture_output=True, text=True)
    # What is told of a linkage has a place in the file, which a changed file has not.
    told = re.sub(r":\d+:\d+: ", ": ", before.stderr)
    assert (after.returncode, after.stderr) == (0, told), command
    changed = re.search(r"--set ([^=]+)=(\S+?)(mm|deg)$", command)
    assert after.stdout != before.stdout, command
    if "." not in changed[1]:
        row = rf"^\s*{re.escape(changed[1])}\s+{re.escape(changed[2])}\s?{changed[3]}\b"
        assert re.search(row, after.stdout, re.M), after.stdout
