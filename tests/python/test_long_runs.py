"""Long runs: what happens if they are killed or interrupted, and how much memory they take."""

import json
import signal
import subprocess
import sys
import time

import check_recording
import pytest

MECHANISM = "plano-spherical-5dof"
BEFORE = b"what was recorded before"
MIB = 1 << 20
# Time limit in seconds for something to happen.
PATIENCE = 60

# A grid for counting only: some 10^9 poses.
COUNTED = ("x=-0.25:0.25:251", "y=-0.15:0.30:251", "zeta=-1:1:25", "xi=0:1:26", "psi=-1:1:25")
# More than twenty million of these are in reach, more than four million a slice.
RECORDED = ("x=-0.25:0.25:5001", "y=-0.15:0.30:5001", "xi=0:0.6:4")

# All of these are in reach, which is the most that can wait to be written; several messages per slice.
REACHABLE = ("x=-0.05:0.05:2201", "y=-0.05:0.05:2201", "xi=0:0.3:5")

# A separate process, because the peak of a child includes the memory of the process that started it.
MEASURE = """
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.PIPE, check=True)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
sys.stderr.write(str(peak if sys.platform == "darwin" else peak * 1024))
sys.stdout.buffer.write(done.stdout)
"""


def command(opm, grid, *arguments):
    flags = (f"--grid={axis}" for axis in grid)
    return [opm, "workspace", MECHANISM, "--format=json", "--quiet", *flags, *arguments]


def measured(command):
    """The JSON output of a command, and its peak memory in bytes."""
    done = subprocess.run([sys.executable, "-c", MEASURE, *command], capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    return json.loads(done.stdout), int(done.stderr)


@pytest.fixture
def recording(opm, tmp_path):
    """Starts a long recording over an existing file; gives the file, its `.partial`, and the process."""
    target = tmp_path / "w.mcap"
    target.write_bytes(BEFORE)
    partial = tmp_path / "w.mcap.partial"
    process = subprocess.Popen(command(opm, RECORDED, "-o", target), stderr=subprocess.PIPE)
    deadline = time.monotonic() + PATIENCE
    while not (partial.exists() and partial.stat().st_size > 4 * MIB):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline, "nothing is being recorded"
        time.sleep(0.01)
    yield target, partial, process
    process.kill()
    process.communicate()


def test_a_killed_recording_leaves_the_old_file_and_a_partial_one(opm, recording, tmp_path):
    target, partial, process = recording
    process.kill()
    assert process.wait(PATIENCE) == -signal.SIGKILL
    assert target.read_bytes() == BEFORE
    assert sorted(tmp_path.iterdir()) == [target, partial]

    inspect = [opm, "inspect", "--format=json", partial]
    found = json.loads(subprocess.run(inspect, stdout=subprocess.PIPE, check=True).stdout)
    assert found["complete"] is False
    with pytest.raises(check_recording.Failure):
        check_recording.check(partial)

    # The next run replaces it, as if nothing had happened.
    small = command(opm, ["x=-0.1:0.1:9"], "-o", target)
    subprocess.run(small, stdout=subprocess.DEVNULL, check=True)
    check_recording.check(target)
    assert list(tmp_path.iterdir()) == [target]


def test_ctrl_c_while_recording(recording):
    target, _, process = recording
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE) == 130
    assert target.read_bytes() == BEFORE
    said = process.stderr.read().decode()
    assert said.count("\n") == 1 and "interrupted" in said


def test_ctrl_c_while_counting(opm, tmp_path):
    endless = ["x=-0.25:0.25:100001", "y=-0.15:0.30:100001", "xi=0:1:1001"]
    target = tmp_path / "w.mcap"
    process = subprocess.Popen(command(opm, endless, "-o", target), stderr=subprocess.PIPE)
    time.sleep(1)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE) == 130
    assert process.stderr.read().count(b"\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_memory_while_counting(opm):
    answer, peak = measured(command(opm, COUNTED))
    assert answer["poses"] > 1e9
    assert peak < 64 * MIB


@pytest.mark.parametrize("scalars", ["zeta,psi", "zeta,psi,theta11,theta12,theta13,S1,S2,S3"])
def test_memory_while_recording(opm, tmp_path, scalars):
    flags = ("-o", tmp_path / "w.mcap", "--threads=16", f"--scalars={scalars}")
    answer, peak = measured(command(opm, REACHABLE, *flags))
    assert answer["reachable"] == answer["poses"] > 20e6
    assert peak < 256 * MIB
