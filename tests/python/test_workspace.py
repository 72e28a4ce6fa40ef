"""`opm workspace` recordings, compared point by point with the paper's closed form in NumPy."""

import csv
import subprocess

import check_recording
import numpy as np
import plano_spherical
import pytest
from conftest import LINKAGES, REPOSITORY

MECHANISM = "plano-spherical-5dof"
# Metres and radians, first axis fastest; no value is on the boundary of reach or on a limit.
GRID = {
    "x": (-0.23, 0.21, 45),
    "y": (-0.17, 0.29, 47),
    "zeta": (-1.1, 0.9, 4),
    "xi": (-0.7, 1.7, 7),
    "psi": (-0.8, 1.3, 3),
}
# Tolerance for the margins of the closed form: a pose with a larger one is clearly in or out of reach.
ROUNDING = 1e-9


def flags(grid):
    return [f"--grid={name}={low}:{high}:{count}" for name, (low, high, count) in grid.items()]


def poses(grid):
    """All poses of a grid, one column per axis, the first axis fastest."""
    values = [np.linspace(*axis) for axis in reversed(grid.values())]
    columns = [axis.ravel() for axis in np.meshgrid(*values, indexing="ij")]
    return dict(zip(grid, reversed(columns)))


def write(path, columns):
    with open(path, "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(columns)
        rows.writerows(zip(*(column.tolist() for column in columns.values())))


@pytest.fixture(scope="module")
def expected():
    """The reachable poses of `GRID` with their joint values, by the closed form."""
    grid = poses(GRID)
    joints, margin = plano_spherical.joints(**grid)
    assert not np.any(np.abs(margin) < ROUNDING), "a pose on the boundary of reach: choose another grid"
    inside = margin > 0
    assert 0.1 < inside.mean() < 0.9, "a grid that is all inside or all outside shows little"
    return {name: column[inside] for name, column in (grid | joints).items()}


def test_the_closed_form_gives_the_golden_vectors():
    with open(REPOSITORY / "data/reference/independent/plano_spherical_ik.csv") as file:
        rows = [row for row in csv.DictReader(file) if row["mode"] == "++ ++ ++ +"]
    grid = {name: np.array([float(row[name]) for row in rows]) for name in GRID}
    joints, margin = plano_spherical.joints(**grid)
    assert len(rows) > 20
    assert ((margin >= 0) == [row["within_limits"] == "1" for row in rows]).all()
    for number, row in enumerate(rows):
        for name, values in joints.items() if row["closes"] == "1" else ():
            error = values[number] - float(row[name])
            error = error if name.startswith("S") else plano_spherical.nearest(error, 0)
            assert abs(error) < 1e-12, (row, name)


def test_every_point_is_where_the_closed_form_says(workspace, expected, tmp_path):
    names = [name for name in expected if name not in ("x", "y", "xi")]
    answer = workspace(
        MECHANISM, *flags(GRID), "-o", tmp_path / "w.mcap",
        "--axes=x,y,xi", f"--scalars={','.join(names)}", "--color=theta11",
    )  # fmt: skip
    assert answer["poses"] == np.prod([count for _, _, count in GRID.values()])
    assert answer["reachable"] == len(expected["x"])
    for name, (low, high) in answer["imaginary_range"].items():
        assert (low, high) == pytest.approx((expected[name].min(), expected[name].max()))

    fields = {"z" if name == "xi" else name: column for name, column in expected.items()}
    write(tmp_path / "expected.csv", fields)
    points, slices = check_recording.check(tmp_path / "w.mcap", tmp_path / "expected.csv")
    assert points == answer["reachable"]
    orientations = np.stack([expected[name] for name in ("zeta", "xi", "psi")])
    assert slices == np.unique(orientations, axis=1).shape[1]


def test_every_mode_counts_what_the_closed_form_counts(workspace):
    grid = {
        "x": (-0.23, 0.21, 31),
        "y": (-0.17, 0.29, 29),
        "zeta": (-3.0, 2.9, 7),
        "xi": (-3.1, 3.0, 9),
        "psi": (-2.8, 3.1, 5),
    }
    legs, arm = plano_spherical.margins(**poses(grid))
    assert min(np.abs(margin).min() for margin in (*legs.values(), arm)) > ROUNDING
    counts = {}
    for signs in ("++ +- -+ +", "-- -- -- -", "+- -+ ++ -", "-+ ++ +- +"):
        inside = arm > 0
        for leg, choices in enumerate(signs.split()[:3]):
            inside &= legs[tuple(int(f"{sign}1") for sign in choices)][:, leg] > 0
        counts[signs] = inside.sum()
    counts["any"] = ((arm > 0) & (np.max(list(legs.values()), axis=0).min(axis=-1) > 0)).sum()
    assert len(set(counts.values())) == len(counts), "modes that count the same tell nothing apart"
    for mode, expected in counts.items():
        answer = workspace(MECHANISM, *flags(grid), f"--mode={mode}")
        assert (mode, answer["reachable"]) == (mode, expected)


def test_the_mechanism_is_attached_as_it_is(opm, workspace, tmp_path):
    shipped = (REPOSITORY / "crates/opm-core/mechanisms" / f"{MECHANISM}.toml").read_bytes()
    own = tmp_path / "own.toml"
    own.write_bytes(b"# My own.\r\n" + shipped)
    for mechanism, text in ((MECHANISM, shipped), (own, own.read_bytes())):
        workspace(mechanism, "--grid=x=-0.1:0.1:9", "-o", tmp_path / "w.mcap")
        with open(tmp_path / "w.mcap", "rb") as file:
            attached = list(check_recording.make_reader(file).iter_attachments())
        assert [attachment.data for attachment in attached] == [text]
    printed = subprocess.run([opm, "examples", MECHANISM], stdout=subprocess.PIPE, check=True)
    assert printed.stdout == shipped


def test_a_slice_of_many_points_is_split_and_its_overview_thinned(workspace, tmp_path):
    answer = workspace(
        MECHANISM, "--grid=x=-0.23:0.21:5001", "--grid=y=-0.17:0.29:4001", "--grid=xi=0.3",
        "-o", tmp_path / "w.mcap",
    )  # fmt: skip
    assert answer["reachable"] > check_recording.MAX_MESSAGE_POINTS
    points, slices = check_recording.check(tmp_path / "w.mcap")
    assert (points, slices) == (answer["reachable"], 1)


def test_the_default_grid_holds_the_whole_workspace(workspace, tmp_path):
    answer = workspace(MECHANISM, "-o", tmp_path / "w.mcap")
    points, _ = check_recording.check(tmp_path / "w.mcap")
    assert points == answer["reachable"] > 10_000
    # The arm reaches 200 mm about (0, 75 mm), and leg 3 up to a1 + a2 - h = 140 mm along y.
    x, y = (answer["grid"][name] for name in "xy")
    assert x["min"] <= -0.2 and x["max"] >= 0.2 and y["min"] <= -0.125 and y["max"] >= 0.14


def test_the_same_run_gives_the_same_bytes(workspace, tmp_path):
    recordings = set()
    for number, threads in enumerate((None, None, "1", "2", "3")):
        path = tmp_path / f"{number}.mcap"
        workspace(
            MECHANISM, *flags(GRID), "-o", path, "--color=S1",
            *([f"--threads={threads}"] if threads else []),
        )  # fmt: skip
        recordings.add(path.read_bytes())
    assert len(recordings) == 1


SHIPPED = sorted(path.stem for path in (REPOSITORY / "crates/opm-core/mechanisms").glob("*.toml"))


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_mechanism(opm, workspace, tmp_path, name):
    listed = subprocess.run([opm, "examples"], stdout=subprocess.PIPE, text=True, check=True)
    assert name in listed.stdout
    subprocess.run([opm, "decompose", name], stdout=subprocess.DEVNULL, check=True)
    if name not in LINKAGES:  # a linkage is moved by one joint, not by a pose
        answer = workspace(name, "-o", tmp_path / "out.mcap")
        points, _ = check_recording.check(tmp_path / "out.mcap")
        assert points == answer["reachable"] > 0
