"""The workflows run code of others only as it was when it was read: every action is named by its commit."""

import re
from pathlib import Path

WORKFLOWS = Path(__file__).parents[2] / ".github" / "workflows"
PINNED = re.compile(r"[\w.-]+/[\w./-]+@[0-9a-f]{40} # v\d+(\.\d+)*")


def test_every_action_is_pinned_by_its_commit():
    files = sorted(WORKFLOWS.glob("*.y*ml"))
    uses = [line.split("uses:", 1)[1].strip() for file in files for line in file.read_text().splitlines() if "uses:" in line]
    assert uses
    assert [use for use in uses if not use.startswith("./") and not PINNED.fullmatch(use)] == []
    # One commit for each action: who updates it does so everywhere.
    assert len(set(uses)) == len({use.split("@")[0] for use in uses})
