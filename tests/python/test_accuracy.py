"""`opm accuracy`: the contract, and its tables against its answers at single poses."""

import csv
import json
import math
import subprocess

import pytest

PAPER = "plano-spherical-5dof"
SIZES = ["--actuators", "20um,20urad", "--axes", "0.05mm,0.02deg"]


@pytest.fixture(scope="module")
def accuracy(opm):
    """Runs `opm accuracy` and returns its JSON answer."""

    def run(mechanism, *arguments):
        command = [opm, "accuracy", mechanism, "--format", "json", "--quiet", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


def test_worst_cases_are_sums_of_sensitivities(accuracy):
    found = accuracy(PAPER, "--pose", "x=10mm,xi=15deg", *SIZES, "--errors", "links")
    table = found["sensitivity"]
    assert table["columns"] == list(found["pose_error"]) == ["x", "y", "zeta", "xi", "psi"]
    assert table["rows"][:5] == ["S1", "S2", "S3", "phi14", "phi24"]
    for column, name in enumerate(table["columns"]):
        parts = [size * row[column] for size, row in zip(table["sizes"], table["values"])]
        assert found["pose_error"][name] == pytest.approx(sum(map(abs, parts)), rel=1e-12)
        assert found["root_sum_square"]["pose_error"][name] == pytest.approx(math.hypot(*parts), rel=1e-12)
    worst = found["worst"]
    assert math.hypot(*worst["displacement"]) == pytest.approx(worst["length"], rel=1e-12)
    assert found["misfit"]["S1"]["length"] > 1e-6 and found["overconstraints"] == 3


def test_a_grid_is_its_poses(accuracy, opm, tmp_path):
    grid = ["--grid", "x=-0.1:0.1:5", "--grid", "y=0:0.05:3", "--grid", "xi=10deg:30deg:3"]
    one, other = tmp_path / "one.csv", tmp_path / "other.csv"
    found = accuracy(PAPER, *SIZES, *grid, "--clearance", "20um", "-o", one, "--threads", 1)
    again = accuracy(PAPER, *SIZES, *grid, "--clearance", "20um", "-o", other, "--threads", 3)
    for answer in (found, again):
        del answer["seconds"], answer["poses_per_second"]
    assert found == again and one.read_bytes() == other.read_bytes()
    rows = list(csv.DictReader(one.open()))
    assert len(rows) == found["reachable"] <= found["poses"] == 45
    for column, largest in [
        ("error.x", found["pose_error"]["x"]),
        ("worst.length", found["worst"]["length"]),
        ("misfit.phi11.angle", found["misfit"]["phi11"]["angle"]),
    ]:
        row = max(rows, key=lambda row: float(row[column]))
        assert float(row[column]) == pytest.approx(largest["value"], rel=1e-12)
        assert {name: float(row[name]) for name in largest["pose"]} == pytest.approx(largest["pose"])
    pose = ",".join(f"{name}={value!r}" for name, value in largest["pose"].items())
    single = accuracy(PAPER, *SIZES, "--pose", pose)
    assert single["misfit"]["phi11"]["angle"] == pytest.approx(largest["value"], rel=1e-9)
    # The same poses as a table.
    table = tmp_path / "poses.csv"
    done = subprocess.run([opm, "accuracy", PAPER, *SIZES, "--poses", one, "-o", table], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert table.read_text() == one.read_text()


def test_a_table_with_coordinates_that_follow_is_read_back(opm, tmp_path):
    wanted = tmp_path / "wanted.csv"
    wanted.write_text("x,y\n0.02,0.3\n-0.05,0.25\n")

    def run(table):
        command = [opm, "accuracy", "five-bar", *SIZES, "--poses", table]
        return subprocess.run(command, capture_output=True, text=True)

    first = run(wanted)
    assert first.returncode == 0, first.stderr
    rows = list(csv.DictReader(first.stdout.splitlines()))
    assert all(math.isfinite(float(row["theta"])) for row in rows)
    table = tmp_path / "table.csv"
    table.write_text(first.stdout)
    assert run(table).stdout == first.stdout
    # A value that does not follow is refused.
    table.write_text(first.stdout.replace(rows[1]["theta"], "3"))
    wrong = run(table)
    assert wrong.returncode == 1 and f"{table}:3: theta is given as" in wrong.stderr


def test_tolerances_keep_the_clearance(accuracy, tmp_path):
    options = ["--pose", "x=10mm,xi=15deg", "--errors", "links"]
    allowed = accuracy(PAPER, *options, "--clearance", "20um")["clearance"]
    shares = {name: p["share"] for name, p in allowed["parameters"].items() if p["share"] is not None}
    file = tmp_path / "parts.toml"
    file.write_text("[parameter]\n" + "".join(f"{json.dumps(n)} = {t!r}\n" for n, t in shares.items()))
    kept = accuracy(PAPER, *options, "--tolerances", file)
    assert 1e-6 < max(play["length"] for play in kept["misfit"].values()) <= 20e-6 * (1 + 1e-9)
    uniform = allowed["uniform"]
    sizes = f"{uniform['length']!r}m,{uniform['angle']!r}rad"
    kept = accuracy(PAPER, *options, "--axes", sizes)
    assert max(play["length"] for play in kept["misfit"].values()) == pytest.approx(20e-6, rel=1e-8)


def test_a_bound_over_a_box_is_above_all_of_its_poses(accuracy):
    box = [f"--over={name}=-20mm:20mm" for name in "xy"]
    found = accuracy(PAPER, *SIZES, *box, "--gap", 0.1)
    assert found == accuracy(PAPER, *SIZES, *box, "--gap", 0.1, "--threads", 1)
    assert found["tight"] and found["over"]["x"] == [-0.02, 0.02] and found["over"]["xi"] == [0, 0]
    grid = accuracy(PAPER, *SIZES, "--grid=x=-20mm:20mm:9", "--grid=y=-20mm:20mm:9")["worst"]
    for what in ("length", "angle"):
        largest, bound = grid[what]["value"], found[what]["bound"]
        assert largest <= bound <= 1.1 * found[what]["found"] * (1 + 1e-9)
        assert found[what]["found"] >= 0.99 * largest
    # With few boxes the bound is wider, and holds.
    wide = accuracy(PAPER, *SIZES, *box, "--budget", 40)
    assert not wide["tight"]
    assert all(wide[what]["bound"] is None or wide[what]["bound"] >= found[what]["found"] for what in ("length", "angle"))


def test_drawn_mechanisms_are_within_the_worst_case(accuracy):
    options = ["--pose", "x=10mm,xi=15deg", "--errors", "links", *SIZES, "--samples", 200]
    found = accuracy(PAPER, *options, "--seed", 5)
    assert found == accuracy(PAPER, *options, "--seed", 5, "--threads", 1)
    assert found["samples"] != accuracy(PAPER, *options, "--seed", 6)["samples"]
    samples = found["samples"]
    assert (samples["count"], samples["failed"]) == (200, 0)
    # Uniform errors; 200 of them give a deviation to within some 20 %.
    for name, deviation in samples["deviation"].items():
        assert deviation == pytest.approx(found["root_sum_square"]["pose_error"][name] / math.sqrt(3), rel=0.3)
    assert 0 < samples["length"] < found["worst"]["length"]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--actuators", "20urad"], "S1 is a length, and no size is given for it"),
        (["--actuators", "20"], "has no unit"),
        (["--axes", "1um,2um"], "two lengths"),
        (["--tolerances", "missing.toml"], "missing.toml: No such file"),
        (["-o", "out.csv"], "--output: is for --poses and --grid"),
        (["--samples", "0"], "--samples"),
        (["--grid", "q=1"], "no such task coordinate"),
        (["--over", "q=1"], "no task coordinate q, expected one of x, y"),
        (["--over", "x=1mm:-1mm"], "x"),
        (["--over", "x=0:1mm", "--over", "x=0:2mm"], "x is given twice"),
        (["--over", "x=0:1mm", "--gap", "0"], "--gap: 0, expected a positive share"),
        (["--over", "x=0:1mm", "--clearance", "20um"], "cannot be used with"),
        (["--over", "x=0:1mm", "--vary", "h=0.1:0.16:7"], "cannot be used with"),
        (["--gap", "0.1"], "--over"),
    ],
)
def test_wrong_input_is_named(opm, arguments, expected):
    done = subprocess.run([opm, "accuracy", PAPER, *arguments], capture_output=True, text=True)
    assert done.returncode in (1, 2) and expected in done.stderr, done.stderr
