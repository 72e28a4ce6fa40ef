"""The programs under test."""

import json
import signal
import subprocess
from pathlib import Path

import pytest

# Where the tests run in the background, a shell has them, and the programs that they start, ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)

REPOSITORY = Path(__file__).parents[2]
# Shipped mechanisms that are moved by one joint, not by a pose of the platform.
LINKAGES = ["bennett-double-spherical-6r", "bennett-plano-spherical-6r", "sarrus"]
# Builds the whole workspace with the features of `make test-rust`, so that its artefacts are reused.
BUILD = (
    "cargo build --quiet --workspace --features opm-core/serde --bins --examples"
    " --message-format=json-render-diagnostics"
)


@pytest.fixture(scope="session")
def programs():
    """Paths of the programs and the examples, by their names."""
    build = subprocess.run(
        BUILD.split(), cwd=REPOSITORY, check=True, stdout=subprocess.PIPE, text=True
    )
    messages = map(json.loads, build.stdout.splitlines())
    built = (message for message in messages if message.get("executable"))
    return {message["target"]["name"]: message["executable"] for message in built}


@pytest.fixture(scope="session")
def opm(programs):
    """Path of the program."""
    return programs["opm"]


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
