"""What rejects poses, as recorded by `opm workspace --explain -o` and drawn by `opm plot`, against inverse kinematics."""

import csv
import json
import subprocess

import numpy as np
import pytest
from check_recording import points
from test_motion_recording import Recorded

MECHANISM = "plano-spherical-5dof"
GRID = ["--grid=x=-0.3:0.3:31", "--grid=y=-0.3:0.3:31"]


def run(opm, *line):
    done = subprocess.run([opm, *line], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def cloud(recorded, topic):
    ((_, message),) = recorded.topics[topic]
    return points(message)


def legend(recorded):
    """The colour and the words of each cause, by its number."""
    record = recorded.metadata["rejected"]
    causes = {key.split(".")[1]: text.split(" ", 1) for key, text in record.items() if key.startswith("cause.")}
    return {int(number): (tuple(bytes.fromhex(color[1:])), text) for number, (color, text) in causes.items()}


@pytest.fixture(scope="module")
def poses(opm, tmp_path_factory):
    path = tmp_path_factory.mktemp("rejected") / "poses.mcap"
    line = ["workspace", MECHANISM, *GRID, "--explain", "--scale", "none", "-o", path]
    return path, json.loads(run(opm, *line, "--format", "json", "--quiet"))


def test_the_rejected_poses_are_all_others(poses):
    path, answer = poses
    recorded = Recorded(path)
    rejected, reached = cloud(recorded, "/workspace/rejected"), cloud(recorded, "/workspace/cloud")
    both = np.stack([np.concatenate([reached[axis], rejected[axis]]) for axis in "xy"], axis=-1)
    steps = np.linspace(-0.3, 0.3, 31)
    grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    order = np.lexsort(np.round(both, 6).T[::-1])
    np.testing.assert_allclose(both[order], grid, atol=1e-7)
    assert len(rejected["x"]) == answer["poses"] - answer["reachable"]


def test_a_pose_has_the_colour_of_what_rejects_it(opm, poses, tmp_path):
    path, answer = poses
    recorded = Recorded(path)
    rejected, causes = cloud(recorded, "/workspace/rejected"), legend(recorded)
    for number, (color, _) in causes.items():
        chosen = rejected["cause"] == number
        for channel, value in zip(["red", "green", "blue"], color, strict=True):
            assert set(rejected[channel][chosen]) == {value}
    assert len({color for color, _ in causes.values()}) == len(causes)
    # As many poses as the table has for each cause alone.
    table = {1 + i: cause["alone"] for i, cause in enumerate(answer["explain"]["causes"]) if cause["alone"]}
    assert {number: np.count_nonzero(rejected["cause"] == number) for number in causes if number} == table

    # A limit that alone rejects a pose is lifted, and the pose is reached.
    names = {number: text.split(": ")[1] for number, (_, text) in causes.items() if "limit" in text}
    assert len(names) >= 2
    for number, text in names.items():
        assert text.split(" ", 1)[1] in ("above its limit", "below its limit")
        chosen = np.flatnonzero(rejected["cause"] == number)
        given, solved = tmp_path / f"{number}.csv", tmp_path / f"{number}-joints.csv"
        with open(given, "w", newline="") as file:
            csv.writer(file).writerows([["x", "y"], *zip(rejected["x"][chosen], rejected["y"][chosen], strict=True)])
        run(opm, "ik", MECHANISM, "--poses", given, "-o", solved)
        with open(solved, newline="") as file:
            rows = list(csv.DictReader(file))
        joint = text.split()[0]
        values = np.array([[float(row[name]) for name in ("S1", "S2", "S3")] for row in rows])
        beyond = np.abs(values) > 0.3
        assert np.all(beyond.sum(axis=1) == 1) and np.all(beyond[:, ["S1", "S2", "S3"].index(joint)])


def test_places_have_the_cause_of_most_of_their_orientations(opm, tmp_path):
    grid = ["--grid=x=-0.3:0.3:31", "--grid=y=-0.3:0.3:31", "--grid=xi=-40deg:40deg:9"]
    path = tmp_path / "places.mcap"
    line = ["workspace", MECHANISM, "--kind", "dexterous", *grid, "--explain", "--scale", "none", "-o", path]
    run(opm, *line, "--quiet")
    recorded = Recorded(path)
    rejected, causes = cloud(recorded, "/workspace/rejected"), legend(recorded)
    dexterous = len(cloud(recorded, "/workspace/cloud")["x"])
    assert dexterous + len(rejected["x"]) == 31 * 31
    chosen = np.flatnonzero((rejected["share"] > 0) & (rejected["cause"] > 0))
    assert len(chosen) > 3
    for i in chosen[:: len(chosen) // 6]:
        x, y = (float(rejected[axis][i]) for axis in "xy")
        here = [f"--grid=x={x!r}", f"--grid=y={y!r}", "--grid=xi=-40deg:40deg:9"]
        answer = json.loads(run(opm, "workspace", MECHANISM, *here, "--explain", "--format", "json", "--quiet"))
        assert rejected["share"][i] == pytest.approx(answer["reachable"] / 9)
        most = max(answer["explain"]["causes"], key=lambda cause: cause["alone"])
        what = f"{most['section']} section" if most["section"] else most["joint"]
        assert causes[int(rejected["cause"][i])][1].startswith(f"{most['leg']}: {what} ")


def test_slices_of_rejected_poses_are_told_apart(opm, tmp_path):
    grid = [*GRID, "--grid=xi=-0.4:0.4:3"]
    path = tmp_path / "slices.mcap"
    run(opm, "workspace", MECHANISM, *grid, "--explain", "-o", path, "--quiet")
    rejected = cloud(Recorded(path), "/workspace/rejected")
    assert set(rejected["slice"]) == {0, 1, 2}
    for number, xi in enumerate([-0.4, 0.0, 0.4]):
        line = ["workspace", MECHANISM, *GRID, f"--grid=xi={xi}", "--format", "json", "--quiet"]
        answer = json.loads(run(opm, *line))
        in_slice = np.count_nonzero(rejected["slice"] == number)
        assert in_slice == answer["poses"] - answer["reachable"]


def test_a_picture_has_a_legend(opm, poses, tmp_path):
    path, _ = poses
    picture = tmp_path / "poses.svg"
    run(opm, "plot", path, "-o", picture)
    drawn = picture.read_text()
    assert "Rejected poses, by what rejects them" in drawn
    for _, text in legend(Recorded(path)).values():
        assert text in drawn
    run(opm, "plot", path, "--panels", "slices", "-o", tmp_path / "slices.svg")
    assert "what rejects them" not in (tmp_path / "slices.svg").read_text()
    run(opm, "plot", path, "--panels", "rejected", "-o", tmp_path / "rejected.svg")
    assert "Reachable poses" not in (tmp_path / "rejected.svg").read_text()

    plain = tmp_path / "plain.mcap"
    run(opm, "workspace", MECHANISM, *GRID, "-o", plain, "--quiet")
    line = [opm, "plot", plain, "--panels", "rejected", "-o", tmp_path / "none.svg"]
    refused = subprocess.run(line, capture_output=True, text=True)
    assert refused.returncode != 0 and "record with --explain" in refused.stderr
