"""Shards, read by public decoders as docs/scaling.md says, and made by its scripts."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from check_recording import doctor
from conftest import REPOSITORY
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

PLANO = "plano-spherical-5dof"
AXES = {"x": (-0.25, 0.25, 61), "y": (-0.2, 0.2, 33), "zeta": (0, 1, 9), "xi": (-1.7, 1.7, 23)}
GRID = [word for name, ends in AXES.items() for word in ("--grid", f"{name}={ends[0]}:{ends[1]}:{ends[2]}")]


@pytest.fixture(scope="module")
def parts(opm, tmp_path_factory):
    folder = tmp_path_factory.mktemp("parts")
    paths = [folder / f"part-{i}.mcap" for i in (1, 2, 3)]
    for i, path in enumerate(paths, 1):
        command = [opm, "workspace", PLANO, *GRID, "--shard", f"{i}/3", "-o", path, "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
    return paths


def test_the_runs_are_the_poses_that_are_in_reach(opm, parts, tmp_path):
    """The shards are compared with inverse kinematics pose by pose."""
    counts = [ends[2] for ends in AXES.values()]
    mask = np.zeros(counts, bool, order="F")
    flat = mask.reshape(-1, order="F")
    assert np.shares_memory(flat, mask)
    for path in parts:
        doctor(path)
        with open(path, "rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            for *_, runs in reader.iter_decoded_messages(topics="/shard/runs"):
                ends = runs.start + np.cumsum(np.array(runs.lengths, np.uint64))
                for first, end in ends.reshape(-1, 2):
                    flat[int(first) : int(end)] = True

    values = [np.linspace(*ends) for ends in AXES.values()]
    numbers = np.random.default_rng(5).choice(flat.size, 4000, replace=False)
    places = np.unravel_index(numbers, counts, order="F")
    columns = [value[place] for value, place in zip(values, places)]
    table = tmp_path / "poses.csv"
    np.savetxt(table, np.transpose(columns), delimiter=",", header=",".join(AXES), comments="")
    solved = tmp_path / "solved.csv"
    subprocess.run([opm, "ik", PLANO, "--poses", table, "-o", solved, "-q"], check=True)
    header = solved.read_text().splitlines()[0].split(",")
    within = np.genfromtxt(
        solved, delimiter=",", skip_header=1, usecols=header.index("within_limits")
    )
    assert 100 < within.sum() < 3900
    assert (flat[numbers] == (within == 1)).all()


def test_a_shard_says_what_it_is_of(opm, parts):
    inspected = json.loads(
        subprocess.check_output([opm, "inspect", parts[1], "--format", "json"], text=True)
    )
    assert inspected["complete"]
    record = inspected["metadata"]
    assert record["shard"] == {"file": PLANO, "shard": "2/3"}
    assert record["run"]["grid.x"] == "-0.25:0.25:61"
    assert record["run"]["mode"] == "++ ++ ++ +"
    assert int(record["result"]["poses"]) < int(record["run"]["poses"])
    assert [a["name"] for a in inspected["attachments"]] == [Path(f"{PLANO}.toml").name]


def scripts(heading):
    """The shell scripts of a section of docs/scaling.md, unchanged."""
    text = (REPOSITORY / "docs" / "scaling.md").read_text()
    section = re.search(rf"^## {heading}\n(.*?)(?=^## )", text, re.DOTALL | re.MULTILINE)
    assert section, heading
    found = re.findall(r"^```sh\n(.*?)^```", section[1], re.DOTALL | re.MULTILINE)
    assert found, heading
    return found


@pytest.fixture(scope="module")
def one_run(opm, tmp_path_factory):
    path = tmp_path_factory.mktemp("one") / "cloud.mcap"
    subprocess.run([opm, "workspace", PLANO, "-o", path, "-q"], check=True, capture_output=True)
    return path.read_bytes()


@pytest.fixture
def shell(opm, tmp_path):
    """Runs a script in a folder of its own, with the program in the path."""
    path = f"{Path(opm).parent}{os.pathsep}{os.environ['PATH']}"

    def run(script, **variables):
        done = subprocess.run(
            ["sh", "-c", script],
            cwd=tmp_path,
            env={**os.environ, "PATH": path, **variables},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr

    return run


def parts_in(folder):
    return sorted(path.name for path in folder.glob("part-*.mcap"))


EIGHT = [f"part-{i}.mcap" for i in range(1, 9)]


def test_what_the_document_runs_side_by_side(shell, one_run, tmp_path):
    side_by_side, _ = scripts("With a shell")
    shell(side_by_side)
    assert parts_in(tmp_path) == EIGHT
    assert (tmp_path / "cloud.mcap").read_bytes() == one_run


def test_what_the_document_runs_in_a_loop(shell, one_run, tmp_path):
    side_by_side, loop = scripts("With a shell")
    shell(loop)
    assert parts_in(tmp_path) == EIGHT
    merge = side_by_side.splitlines()[-1]
    assert merge.startswith("opm merge")
    shell(merge)
    assert (tmp_path / "cloud.mcap").read_bytes() == one_run


@pytest.mark.skipif(not shutil.which("parallel"), reason="GNU parallel is not installed")
def test_what_the_document_gives_to_parallel(shell, one_run, tmp_path):
    (script,) = scripts("With GNU parallel")
    shell(script)
    assert parts_in(tmp_path) == EIGHT
    assert (tmp_path / "cloud.mcap").read_bytes() == one_run


def test_what_the_document_gives_to_slurm(shell, one_run, tmp_path):
    """Without Slurm: starts one process for each number of the array, as Slurm would."""
    task, submission = scripts("With Slurm")
    assert task.startswith("#!/bin/sh\n")
    first, last = map(int, re.search(r"^#SBATCH --array=(\d+)-(\d+)$", task, re.MULTILINE).groups())
    for number in range(last, first - 1, -1):
        shell(task, SLURM_ARRAY_TASK_ID=str(number), SLURM_CPUS_PER_TASK="2")
    assert parts_in(tmp_path) == EIGHT
    shell(re.search(r"--wrap '(.*)'", submission)[1])
    assert (tmp_path / "cloud.mcap").read_bytes() == one_run
