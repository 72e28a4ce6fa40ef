"""What a designer asks `opm`: other dimensions, all modes, what limits, what is inscribed, tilt and torsion."""

import json
import math
import subprocess

import pytest
from conftest import REPOSITORY

MECHANISM = "plano-spherical-5dof"
GRID = ["--grid=x=-0.3:0.3:21", "--grid=y=-0.3:0.3:21"]


@pytest.fixture(scope="session")
def ask(opm):
    """Runs `opm` and returns its JSON answer."""

    def run(command, mechanism, *arguments):
        line = [opm, command, mechanism, "--format", "json", "--quiet", *arguments]
        done = subprocess.run(line, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def refused(opm):
    """Runs `opm`, which must refuse, and returns its one message."""

    def run(command, mechanism, *arguments):
        done = subprocess.run([opm, command, mechanism, *arguments], capture_output=True, text=True)
        assert done.returncode in (1, 2) and done.stdout == ""
        return done.stderr

    return run


def test_a_number_that_is_set_is_that_of_a_changed_file(ask, tmp_path):
    text = (REPOSITORY / "crates/opm-core/mechanisms" / f"{MECHANISM}.toml").read_text()
    changed = tmp_path / "longer.toml"
    assert text.count("h = 120") == 3
    changed.write_text(text.replace("h = 120", "h = 140"))
    expected = ask("workspace", str(changed), *GRID)["reachable"]
    assert ask("workspace", MECHANISM, "--set", "h=140mm", *GRID)["reachable"] == expected
    table = ask("workspace", MECHANISM, "--vary", "h=120mm:160mm:3", *GRID)
    assert [run["value"] for run in table["runs"]] == pytest.approx([0.12, 0.14, 0.16])
    assert table["runs"][1]["reachable"] == expected
    one = ["--over", "x=-0.2:0.2", "--over", "y=-0.2:0.2"]
    measured = ask("measure", MECHANISM, "--vary", "h=140mm:140mm:1", *one)["runs"][0]
    assert measured["measure"] == ask("measure", str(changed), *one)["value"]
    assert ask("decompose", MECHANISM, "--vary", "h=0.1:0.12:2")["runs"][0]["mobility"] == 5


def test_every_command_has_a_table_of_a_varied_number(ask, tmp_path):
    """Each row is what the command answers for the number set to that value."""

    def rows(command, mechanism, vary, *arguments):
        runs = ask(command, mechanism, "--vary", vary, *arguments)["runs"]
        name = vary.split("=")[0]
        for run in runs:
            yield run, ask(command, mechanism, "--set", f"{name}={run['value']!r}", *arguments)

    h = "h=120mm:160mm:3"
    reached = []
    for run, alone in rows("ik", MECHANISM, h, "--pose", "x=-130mm,y=20mm,xi=15deg"):
        reached.append(run["reachable"])
        assert run["reachable"] == alone["reachable"]
        if alone["reachable"]:
            (solution,) = alone["solutions"]
            assert run["within_limits"] == solution["within_limits"]
            assert run["nearest"] == solution["nearest"]["distance"]
            for name, value in {**solution["imaginary"], **solution["joints"]}.items():
                assert run.get(name, value) == value
            assert {"S1", "theta11"} <= set(run)
        else:
            assert run["S1"] is None and run["nearest"] is None
    assert set(reached) == {True, False}

    joints = "S1=170mm,S2=165mm,S3=160mm,phi14=-150deg,phi24=130deg"
    for run, alone in rows("fk", MECHANISM, h, "--joints", joints):
        assert run["assemblies"] == len(alone["assemblies"])
        if alone["assemblies"]:
            first = alone["assemblies"][0]
            assert [run[name] for name in first["pose"]] == list(first["pose"].values())
            assert run["mode"] == first["mode"]
        else:
            assert run["x"] is None and run["mode"] is None
    for run, alone in rows("velocity", MECHANISM, h, "--pose", "xi=15deg", "--rates", "x=1"):
        assert [run[name] for name in ("condition", "serial", "parallel")] == [
            alone["singularity"][name] for name in ("condition", "serial", "parallel")
        ]
        assert run["d.S1"] == alone["joint_rates"]["S1"]
    for run, alone in rows("analyze", MECHANISM, h, "--pose", "xi=15deg", "--wrench", "0,0,0,0,0,1"):
        assert run["balance"] == alone["balance"]
        assert [run[f"effort.{name}"] for name in alone["efforts"]] == list(alone["efforts"].values())
    for run, alone in rows("trajectory", MECHANISM, h, "--motion", "plano-spherical-sinusoids", "--rate", "20"):
        assert [run[name] for name in ("samples", "reached", "valid", "duration")] == [
            alone[name] for name in ("samples", "reached", "valid", "duration")
        ]
        assert run["violations"] == alone["violation_count"]
        nearest = alone["interference"]["nearest"]
        assert run["nearest"] == (nearest and nearest["distance"])
    linkage = ask("linkage", "bennett-double-spherical-6r", "--input", "a1=30deg")
    home = next(s for s in linkage["solutions"] if s["branch"] == linkage["home_branch"])
    (row,) = ask("linkage", "bennett-double-spherical-6r", "--input", "a1=30deg", "--vary", "a1.home=0:0:1")["runs"]
    assert row["positions"] == len(linkage["solutions"])
    assert [row[name] for name in home["joints"]] == pytest.approx(list(home["joints"].values()), abs=1e-12)


def test_accuracy_has_a_table_of_a_varied_number(ask):
    pose, grid = ["--pose", "x=-130mm,y=20mm,xi=15deg"], ["--grid", "x=-0.13:0.13:5", "--grid", "xi=15deg"]
    sizes = ["--axes", "0.05mm,0.02deg", "--clearance", "20um"]
    for where in (pose, grid):
        runs = ask("accuracy", MECHANISM, "--vary", "h=120mm:160mm:3", *sizes, *where)["runs"]
        reached = set()
        for run in runs:
            alone = ask("accuracy", MECHANISM, "--set", f"h={run['value']!r}", *sizes, *where)
            reached.add(run["reachable"])
            assert run["reachable"] == alone["reachable"]
            values = (run["error.x"], run["worst.length"], run["misfit.angle"], run["uniform.length"])
            if not run["reachable"]:
                assert values == (None, None, None, None)
                continue
            value = (lambda found: found["value"]) if where == grid else (lambda found: found)
            misfits = [value(joint["angle"]) for joint in alone["misfit"].values()]
            uniform = alone["clearance"]["uniform"]["length"]
            expected = (value(alone["pose_error"]["x"]), value(alone["worst"]["length"]), max(misfits), uniform)
            assert values == expected and max(misfits) > 0.0
        assert len(reached) > 1


def test_paths_have_a_table_of_a_varied_number(ask):
    ends = ["--from", "x=-130mm,y=20mm,xi=15deg", "--to", "x=60mm,xi=15deg"]
    where = [*ends, "--grid", "x=-0.16:0.16:17", "--grid", "y=-0.1:0.1:11", "--grid", "xi=15deg"]
    joined = []
    for run in ask("path", MECHANISM, "--vary", "h=120mm:160mm:3", *where)["runs"]:
        joined.append(run["joined"])
        if not run["joined"]:
            assert "the start is out of reach" in run["reason"] and run["clearance"] is None
            continue
        alone = ask("path", MECHANISM, "--set", f"h={run['value']!r}", *where)
        assert (run["from"], run["to"], run["aspects"]) == tuple(alone["aspects"][k] for k in ("from", "to", "number"))
        assert (run["poses"], run["clearance"], run["reason"]) == (len(alone["t"]), alone["clearance"], None)
    assert set(joined) == {True, False}


def test_certificates_have_a_table_of_a_varied_number(ask):
    (run,) = ask("check", MECHANISM, "--samples", "5", "--vary", "h=130mm:130mm:1")["runs"]
    alone = ask("check", MECHANISM, "--samples", "5", "--set", "h=130mm")
    assert run["holds"] and alone["holds"]
    assert all(run[found["name"]] == found["worst"] for found in alone["comparisons"])
    assert run["closure"] > 0.0


def test_values_that_do_not_assemble_are_rows_that_say_so(ask):
    runs = ask("workspace", MECHANISM, "--vary", "h=120mm:920mm:2", *GRID)["runs"]
    assert "problem" not in runs[0]
    assert "home is out of this leg's reach by" in runs[1]["problem"] and " mm" in runs[1]["problem"]


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["--set", "leg1.hh=1"], "did you mean `leg1.h`"),
        (["--set", "leg1.h=1deg"], "leg1.h is a length"),
        (["--set", "leg1.h"], "expected NAME=VALUE"),
        (["--set", "h=120mm", "--set", "h=130mm"], "h is given twice"),
        (["--set", "limits.S=0.3:-0.3"], "limits.S"),
        (["--vary", "hh=0.1:0.2:3"], "did you mean `h`"),
        (["--vary", "h=0.1:0.2"], "NAME=MIN:MAX:COUNT"),
        (["--vary", "h=0.1:0.2:0"], "0 values, expected 1"),
        (["--coordinates", "tilt"], "possible values: euler-angles, tilt-torsion, roll-pitch-yaw"),
        (["--explain", "--kind", "upper"], "--explain: is of poses"),
        (["--inscribed", "ball", *GRID], "--inscribed: a ball needs a set that varies in three"),
        (["--inscribed", "disc", "--grid=x=-0.1:0.1:5", "--grid=xi=-0.1:0.1:5"], "of one unit"),
        (["--inscribed", "disc", "--centre", "x=0", *GRID], "--centre: y is not given"),
        (["--inscribed", "disc", "--centre", "x=0,y=0,z=0", *GRID], "no varying coordinate \"z\""),
    ],
)
def test_wrong_questions_get_one_message(refused, arguments, message):
    told = refused("workspace", MECHANISM, *arguments)
    assert message in told, told
    assert "panicked" not in told


def test_mechanisms_without_an_orientation_have_no_tilt(refused):
    told = refused("workspace", "planar-3rrr", "--coordinates", "tilt-torsion")
    assert "has no Euler angles" in told and told.count("\n") == 1


def test_every_mode_is_that_of_its_own_run(ask):
    table = ask("workspace", MECHANISM, "--all-modes", "--conditioning", *GRID)
    assert len(table["runs"]) == 2**7
    for run in table["runs"][::37]:
        alone = ask("workspace", MECHANISM, "--mode", run["mode"], "--conditioning", *GRID)
        assert run["reachable"] == alone["reachable"]
        assert run["measure"] == alone["measure"]["value"]
        assert run["conditioning"] == alone["conditioning"]["global"]


def test_rejections_add_up(ask):
    answer = ask("workspace", MECHANISM, "--explain", *GRID)
    found = answer["explain"]
    assert (found["poses"], found["reachable"]) == (answer["poses"], answer["reachable"])
    rejected = answer["poses"] - answer["reachable"]
    alone = sum(cause["alone"] for cause in found["causes"])
    shared = sum(cause["with_others"] for cause in found["causes"])
    # Each of the others has two causes at least.
    assert 0 < alone < rejected and shared >= 2 * (rejected - alone)
    assert {cause["joint"] for cause in found["causes"]} <= {None, "S1", "S2", "S3"}
    # Without limits, what they alone reject is reached.
    free = ask("workspace", MECHANISM, "--set", "limits.S=none", *GRID)
    one = [cause for cause in found["causes"] if cause["joint"]]
    assert free["reachable"] >= answer["reachable"] + sum(cause["alone"] for cause in one)


def test_the_inscribed_disc_is_in_the_set(ask):
    disc = ask("workspace", MECHANISM, "--inscribed", "disc", *GRID)["inscribed"]
    step = 0.03
    assert disc["error"] == pytest.approx(step / math.sqrt(2))
    assert disc["measure"] == pytest.approx(math.pi * disc["radius"] ** 2)
    centre = f"x={disc['centre']['x']!r},y={disc['centre']['y']!r}"
    given = ask("workspace", MECHANISM, "--inscribed", "disc", "--centre", centre, *GRID)
    assert given["inscribed"]["radius"] == pytest.approx(disc["radius"], abs=1e-12)
    # Every pose of the grid in the disc is reached, one by one.
    x, y = (disc["centre"][name] for name in "xy")
    turns = [2 * math.pi * turn / 24 for turn in range(24)]
    radius = disc["radius"] - disc["error"]
    for turn in turns:
        pose = f"x={x + radius * math.cos(turn)!r},y={y + radius * math.sin(turn)!r}"
        (solution,) = ask("ik", MECHANISM, "--pose", pose)["solutions"]
        assert solution["within_limits"]


def test_tilt_and_torsion_go_through_recordings(opm, ask, tmp_path):
    grid = ["--grid=x=-0.2:0.2:9", "--grid=tilt=0:40deg:5", "--grid=azimuth=-180deg:135deg:8"]
    path = tmp_path / "tilted.mcap"
    answer = ask("workspace", MECHANISM, "--coordinates", "tilt-torsion", *grid, "-o", str(path))
    assert answer["grid"]["tilt"]["count"] == 5
    inspected = subprocess.run([opm, "inspect", str(path)], capture_output=True, text=True)
    assert "tilt" in inspected.stdout
    parts = []
    for number in (1, 2):
        part = str(tmp_path / f"part-{number}.mcap")
        ask("workspace", MECHANISM, "--coordinates", "tilt-torsion", *grid, "--shard", f"{number}/2", "-o", part)
        parts.append(part)
    merged = tmp_path / "merged.mcap"
    joined = ask("merge", parts[0], parts[1], "-o", str(merged))
    assert joined["reachable"] == answer["reachable"]
    assert merged.read_bytes() == path.read_bytes()
    drawn = subprocess.run([opm, "plot", str(path), "-o", str(tmp_path / "a.svg")], capture_output=True)
    assert drawn.returncode == 0
    # A pose back from joints.
    pose = "x=10mm,azimuth=100deg,tilt=15deg,torsion=5deg"
    flags = ["--coordinates", "tilt-torsion"]
    (solution,) = ask("ik", MECHANISM, *flags, "--pose", pose)["solutions"]
    actuated = ["S1", "S2", "S3", "phi14", "phi24"]
    joints = ",".join(f"{name}={solution['joints'][name]!r}" for name in actuated)
    found = ask("fk", MECHANISM, *flags, "--joints", joints, "--near", pose)
    text = json.dumps(found)
    assert "azimuth" in text and "torsion" in text
