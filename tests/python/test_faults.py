"""Runs that are killed at random moments, and disks that are full at any byte.

`make kills` kills a thousand runs; here it is a few dozen. OPM_KILLS says how many.
"""

import json
import os
import random
import resource
import signal
import subprocess
import time

import pytest

MECHANISM = "plano-spherical-5dof"
BEFORE = b"what was recorded before"
KILLS = int(os.environ.get("OPM_KILLS", "24"))
SEED = int(os.environ.get("OPM_KILLS_SEED", "20261124"))
#: Full disks, each at another byte.
DISKS = 16
GRID = [f"--grid={axis}" for axis in ("x=-0.2:0.2:601", "y=-0.15:0.25:601", "xi=0:0.6:4")]


def jobs(opm, folder):
    """The arguments of each kind of run, without its output."""
    parts = [folder / f"part-{number}.mcap" for number in (1, 2)]
    for number, part in enumerate(parts, start=1):
        run = [opm, "--quiet", "workspace", MECHANISM, *GRID, f"--shard={number}/2", "-o", part]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
    return {
        "workspace": ["workspace", MECHANISM, *GRID, "--scalars", "theta11"],
        "trajectory": ["trajectory", MECHANISM, "--motion", "plano-spherical-sinusoids", "--rate", "2000"],
        "merge": ["merge", *parts],
        "shard": ["workspace", MECHANISM, *GRID, "--shard", "1/2"],
    }


@pytest.fixture(scope="module")
def whole(opm, tmp_path_factory):
    """Each kind of run, the file that it writes, and how long it takes."""
    folder = tmp_path_factory.mktemp("whole")
    found = {}
    for kind, arguments in jobs(opm, folder).items():
        target, start = folder / f"{kind}.mcap", time.monotonic()
        subprocess.run([opm, "--quiet", *arguments, "-o", target], check=True, stdout=subprocess.DEVNULL)
        found[kind] = (arguments, target.read_bytes(), time.monotonic() - start)
    return found


def recovered(opm, partial):
    """What `opm recover` makes of an unfinished file: its contents, or None if not even a beginning is there."""
    target = partial.with_name("recovered.mcap")
    target.unlink(missing_ok=True)
    done = subprocess.run([opm, "--format=json", "recover", partial, "-o", target], capture_output=True)
    if done.returncode != 0:
        message = done.stderr.decode()
        assert "not an MCAP file" in message or "nothing to recover" in message, message
        assert "not an MCAP file" not in message or partial.stat().st_size < 4096, message
        assert not target.exists() and not target.with_name("recovered.mcap.partial").exists()
        return None
    inspect = [opm, "--quiet", "--format=json", "inspect"]
    before, after = (json.loads(subprocess.run([*inspect, of], check=True, stdout=subprocess.PIPE).stdout) for of in (partial, target))
    assert before["topics"] == after["topics"] and before["extents"] == after["extents"]
    assert sum(topic["messages"] for topic in after["topics"]) == json.loads(done.stdout)["messages"]
    # All but the end may have been there.
    assert after["complete"] == (after["metadata"].get("result", {}).get("complete") == "true")
    return after


def check_what_is_left(opm, folder, kind, expected):
    """Only the old file, or the whole new one; and a `.partial` file that gives what it has."""
    target, partial = folder / "out.mcap", folder / "out.mcap.partial"
    assert target.read_bytes() in (BEFORE, expected), f"half a file of {kind}"
    done = target.read_bytes() == expected
    assert not done or not partial.exists()
    found = recovered(opm, partial) if partial.exists() else None
    names = {path.name for path in folder.iterdir()} - {"recovered.mcap"}
    assert names <= {"out.mcap", "out.mcap.partial"}, names
    return done, found


def test_runs_killed_at_random_moments(opm, whole, tmp_path):
    rng, tally = random.Random(SEED), {"done": 0, "left": 0, "recovered": 0}
    for number in range(KILLS):
        kind = sorted(whole)[number % len(whole)]
        arguments, expected, seconds = whole[kind]
        for path in tmp_path.iterdir():
            path.unlink()
        target = tmp_path / "out.mcap"
        target.write_bytes(BEFORE)
        process = subprocess.Popen([opm, "--quiet", *arguments, "-o", target], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        time.sleep(rng.uniform(0, 1.1 * seconds))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        done, found = check_what_is_left(opm, tmp_path, kind, expected)
        tally["done"] += done
        tally["left"] += not done and (tmp_path / "out.mcap.partial").exists()
        tally["recovered"] += found is not None
        # The next run is as if nothing had happened.
        if number % 12 == 0:
            subprocess.run([opm, "--quiet", *arguments, "-o", target], check=True, stdout=subprocess.DEVNULL)
            assert target.read_bytes() == expected and not (tmp_path / "out.mcap.partial").exists()
    print(f"\n{KILLS} runs killed: {tally}")
    assert tally["recovered"] > 0 or KILLS < 20


def limit(size):
    """Files of this process may have so many bytes."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


@pytest.mark.parametrize("kind", ["workspace", "trajectory", "merge", "shard"])
def test_a_disk_that_is_full_at_any_byte(opm, whole, tmp_path, kind):
    """A limit on the size of files: the write that passes it fails, as on a full disk."""
    arguments, expected, _ = whole[kind]
    rng, found_some = random.Random(SEED), 0
    sizes = [0, 1, 7, 8, 100, len(expected) - 1, len(expected) - 9]
    sizes += [rng.randrange(len(expected)) for _ in range(DISKS - len(sizes))]
    for size in sizes:
        target = tmp_path / "out.mcap"
        for path in tmp_path.iterdir():
            path.unlink()
        target.write_bytes(BEFORE)
        done = subprocess.run(
            [opm, *arguments, "-o", target], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, preexec_fn=lambda: limit(size)
        )
        message = done.stderr.decode()
        assert done.returncode == 1 and "out.mcap" in message and "panicked" not in message, message
        finished, found = check_what_is_left(opm, tmp_path, kind, expected)
        assert not finished
        found_some += found is not None
    # A shard of this size is one chunk, which is whole or cannot be read.
    assert found_some > 2 or kind == "shard"


@pytest.mark.parametrize(
    ("command", "name"),
    [("plot", "out.svg"), ("plot", "out.png"), ("export mjcf", "out.xml"), ("convert", "out.toml"), ("explore", "out.html")],
)
def test_a_full_disk_leaves_nothing_of_a_file_that_is_written_at_once(opm, tmp_path, command, name):
    target = tmp_path / name
    run = [opm, *command.split(), MECHANISM, "-o", target]
    subprocess.run(run, check=True, capture_output=True)
    for size in (0, 1000, target.stat().st_size - 1):
        target.write_bytes(BEFORE)
        done = subprocess.run(run, capture_output=True, preexec_fn=lambda size=size: limit(size))
        message = done.stderr.decode()
        assert done.returncode == 1 and name in message and "File too large" in message, message
        assert [path.name for path in tmp_path.iterdir()] == [name] and target.read_bytes() == BEFORE


def test_a_full_disk_changes_no_file_of_several(opm, tmp_path):
    """A model and the table beside it, which is longer: the table does not fit, and the model stays what it was."""
    model, table = tmp_path / "out.xml", tmp_path / "out.csv"
    run = [opm, "export", "mjcf", MECHANISM, "--trajectory", "plano-spherical-sinusoids", "-o", model]
    subprocess.run(run, check=True, capture_output=True)
    size = model.stat().st_size + 1000
    assert size < table.stat().st_size
    for before in ({}, {model: BEFORE, table: BEFORE}):
        for path in (model, table):
            path.unlink()
        for path, text in before.items():
            path.write_bytes(text)
        done = subprocess.run(run, capture_output=True, preexec_fn=lambda: limit(size))
        assert done.returncode == 1 and "out.csv" in done.stderr.decode(), done.stderr
        assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
        for path in (model, table):
            path.touch()
