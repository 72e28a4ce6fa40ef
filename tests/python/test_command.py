"""The command of the Python package, compared with the program that cargo builds."""

import os
import pty
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest

SCRIPT = [str(Path(sysconfig.get_path("scripts")) / "opm")]
MODULE = [sys.executable, "-m", "opm_kinematics"]


def run(command, *arguments, **options):
    done = subprocess.run([*command, *arguments], capture_output=True, check=False, **options)
    return done.returncode, done.stdout, done.stderr


@pytest.mark.parametrize("command", [SCRIPT, MODULE], ids=["opm", "python -m"])
@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        ("--version", 0),
        ("help workspace", 0),
        ("decompose plano-spherical-5dof", 0),
        ("ik plano-spherical-5dof --pose x=10mm,xi=15deg --all-modes --format json", 0),
        ("ik plano-spherical-5dof --poses -", 0),
        ("decompose none-such", 1),
        ("ik plano-spherical-5dof --pose w=1", 2),
        ("sweep", 2),
        ("", 2),
    ],
)
def test_it_says_what_the_program_says(opm, command, arguments, status):
    given = b"x,y,zeta,xi,psi\n" + b"0.01,0.02,0.1,0.2,0.3\n" * 5000
    expected = run([opm], *arguments.split(), input=given)
    assert expected[0] == status
    assert run(command, *arguments.split(), input=given) == expected


def test_it_records_the_same_bytes(opm, tmp_path):
    grid = "--grid x=-0.1:0.1:21 --grid y=-0.1:0.1:21 --grid xi=-0.5:0.5:5 --quiet".split()
    for name, command in [("a", [opm]), ("b", SCRIPT)]:
        status, _, said = run(command, "workspace", "plano-spherical-5dof", *grid, "-o", tmp_path / f"{name}.mcap")
        assert (status, said) == (0, b"")
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_nobody_reads_its_output():
    with subprocess.Popen([*SCRIPT, "examples"], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert (process.wait(), process.stderr.read()) == (0, b"")


@pytest.mark.parametrize("program", ["cargo", "package"])
def test_ctrl_c(opm, program):
    """On a terminal: a bar is drawn, and the first Ctrl-C ends the sweep in order."""
    command = [opm] if program == "cargo" else SCRIPT
    axes = [f"--grid={name}=-0.2:0.2:{count}" for name, count in [("x", 301), ("y", 301), ("xi", 1001), ("psi", 1001)]]
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [*command, "workspace", "plano-spherical-5dof", *axes], stdout=theirs, stderr=theirs, start_new_session=True
    )
    os.close(theirs)
    said = b""
    while b"counting" not in said:
        said += os.read(ours, 1 << 16)
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    try:
        while more := os.read(ours, 1 << 16):
            said += more
    except OSError:  # the terminal closed with the process
        pass
    assert process.wait() == 130
    assert b"opm: error: interrupted; " in said and b"poses were decided" in said
    assert b"Traceback" not in said


@pytest.mark.parametrize("program", ["cargo", "package"])
def test_ctrl_c_while_it_waits(opm, program):
    """Where nothing needs to be cleaned up, Ctrl-C ends it like any process."""
    command = [opm] if program == "cargo" else SCRIPT
    read, write = os.pipe()
    os.write(write, b"format = 1\n")
    process = subprocess.Popen([*command, "decompose", f"/dev/fd/{read}"], pass_fds=[read], stderr=subprocess.PIPE)
    os.close(read)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == -signal.SIGINT
    os.close(write)
    assert b"Traceback" not in process.stderr.read()
    process.stderr.close()
