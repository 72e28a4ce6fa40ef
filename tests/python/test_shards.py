"""Shards, read by public decoders as docs/scaling.md says."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from check_recording import doctor
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
    """Held against inverse kinematics pose by pose."""
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
