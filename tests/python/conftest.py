"""The `opm` program under test, built as its users build it."""

import json
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
BUILD = "cargo build --quiet --release -p opm-kinematics --message-format=json-render-diagnostics"


@pytest.fixture(scope="session")
def opm():
    """Path of the program."""
    build = subprocess.run(
        BUILD.split(), cwd=REPOSITORY, check=True, stdout=subprocess.PIPE, text=True
    )
    executables = (json.loads(line).get("executable") for line in build.stdout.splitlines())
    return next(path for path in executables if path)


@pytest.fixture(scope="session")
def workspace(opm):
    """Runs `opm workspace` and returns its JSON answer."""

    def run(mechanism, *arguments):
        command = [opm, "workspace", mechanism, "--format", "json", "--quiet", *arguments]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        return json.loads(done.stdout)

    return run
