"""Kinds of workspace against plain reductions of the mask of poses, other people's code, and the program."""

import json
import pickle
import subprocess
import sys
from concurrent.futures import Executor, Future

import numpy as np
import opm_kinematics as opm
import pytest
from matplotlib.path import Path as Polygon
from scipy import ndimage

NAME = "plano-spherical-5dof"
TILT = (-0.25, 0.25, 3)
GRID = {"x": (-0.25, 0.25, 51), "y": (-0.24, 0.24, 41), "zeta": TILT, "xi": TILT, "psi": (-0.2, 0.2, 2)}
LEVEL = GRID | {"zeta": 0.1, "xi": 0.2, "psi": 0.0}
STILL = {"x": 0.02, "y": -0.01, "zeta": (-1.0, 1.0, 21), "xi": (-1.0, 1.0, 19)}
KINDS = {
    "grid": GRID,
    "constant-orientation": LEVEL,
    "orientation": STILL,
    "reachable": GRID,
    "dexterous": GRID,
    "imaginary": GRID | {"x": (0.1, 0.25, 21), "y": (0.05, 0.2, 21), "zeta": (-2.0, 2.0, 9), "xi": (-1.5, 1.5, 8)},
    "upper": {"zeta": (-2.0, 2.0, 21), "psi": (-2.0, 2.0, 17)},
    "lower": {"x": (-0.4, 0.4, 31), "y": (-0.4, 0.4, 27), "theta11": (-0.5, 1.0, 4)},
}
OF_POSES = ["grid", "constant-orientation", "orientation"]
# What rounds in a product of a few numbers.
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load(NAME)


@pytest.fixture(scope="module")
def sweeps(manipulator):
    return {kind: opm.sweep(manipulator, kind=kind, **grid) for kind, grid in KINDS.items()}


def test_places_and_orientations_are_reductions_of_the_poses(manipulator, sweeps):
    poses = sweeps["grid"].mask()
    reachable, dexterous = sweeps["reachable"], sweeps["dexterous"]
    np.testing.assert_array_equal(reachable.mask(), poses.any(axis=(2, 3, 4)))
    np.testing.assert_array_equal(dexterous.mask(), poses.all(axis=(2, 3, 4)))
    for swept in (reachable, dexterous):
        np.testing.assert_array_equal(swept.visits(), poses.sum(axis=(2, 3, 4)))
        assert list(swept.axes) == ["x", "y"] and swept.poses == 51 * 41 and swept.orientations == 18
        assert list(swept.grid) == ["x", "y", "zeta", "xi", "psi"] and len(swept.grid["psi"]) == 2
        assert swept.imaginary_range == sweeps["grid"].imaginary_range
    assert reachable.poses > reachable.count > dexterous.count > 0
    wide = opm.sweep(manipulator, **KINDS["imaginary"]).mask()
    np.testing.assert_array_equal(sweeps["imaginary"].mask(), wide.any(axis=(0, 1)))
    assert 0 < sweeps["imaginary"].fraction < 1 and list(sweeps["imaginary"].axes) == ["zeta", "xi", "psi"]


def test_one_subspace_has_its_lengths_as_place():
    m = opm.examples.load("planar-3rrr")
    grid = {"x": (-0.1, 0.1, 21), "y": (-0.1, 0.12, 17), "theta": (-0.6, 0.5, 7)}
    poses = opm.sweep(m, **grid).mask()
    for kind, expected in (("reachable", poses.any(axis=2)), ("dexterous", poses.all(axis=2))):
        swept = opm.sweep(m, kind=kind, **grid)
        np.testing.assert_array_equal(swept.mask(), expected)
        np.testing.assert_array_equal(swept.visits(), poses.sum(axis=2))
        assert list(swept.axes) == ["x", "y"] and swept.orientations == 7 and 0 < swept.count
    assert swept.count < swept.poses
    with pytest.raises(opm.OpmError, match="^kind: upper: all legs of this mechanism move in one subspace, so it has no upper"):
        opm.sweep(m, kind="upper")


@pytest.mark.parametrize("kind", KINDS)
def test_masks_counts_and_points_agree(sweeps, kind):
    swept = sweeps[kind]
    mask, axes = swept.mask(), list(swept.axes.values())
    assert mask.dtype == np.bool_ and mask.shape == tuple(map(len, axes))
    assert (swept.kind, swept.count, swept.poses) == (kind, mask.sum(), mask.size)
    assert swept.fraction == swept.count / swept.poses
    inside = np.argwhere(mask.T)[:, ::-1]
    expected = np.stack([values[inside[:, i]] for i, values in enumerate(axes)], axis=1)
    np.testing.assert_array_equal(swept.points(), expected)


def test_poses_with_coordinates_held_are_poses(manipulator, sweeps):
    for kind in ("constant-orientation", "orientation"):
        np.testing.assert_array_equal(sweeps[kind].mask(), opm.sweep(manipulator, **KINDS[kind]).mask())


def inside_by_rings(outline, x, y):
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    crossed = sum(Polygon(ring).contains_points(points).astype(int) for ring in outline.rings)
    return (crossed % 2 == 1).reshape(len(x), len(y))


def shoelace(ring):
    x, y = (ring - ring[0]).T
    return 0.5 * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def test_the_boundary_has_the_points_of_the_mask_inside(manipulator, sweeps):
    holed = opm.sweep(manipulator.with_parameters(a2=0.1, b2=0.15), kind="constant-orientation", x=(-0.6, 0.6, 121), y=(-0.6, 0.6, 111))
    for swept in (sweeps["constant-orientation"], sweeps["reachable"], sweeps["dexterous"], holed):
        mask, axes = swept.mask(), swept.axes
        (outline,) = swept.boundary()
        assert outline.axes == ("x", "y") and outline.at == {}
        # Nothing at the edge of the grid: every line runs half-way between points.
        assert not (mask[[0, -1]].any() or mask[:, [0, -1]].any())
        np.testing.assert_array_equal(inside_by_rings(outline, axes["x"], axes["y"]), mask.reshape(len(axes["x"]), -1))
        areas = [shoelace(ring) for ring in outline.rings]
        assert all(np.array_equal(ring[0], ring[-1]) and ring.shape[1] == 2 for ring in outline.rings)
        assert [ring is not None for ring in outline.outer] == [True] * sum(area > 0 for area in areas)
        assert len(outline.outer) + len(outline.holes) == len(outline.rings)
        assert all(shoelace(ring) < 0 for ring in outline.holes)
        assert outline.area == pytest.approx(sum(areas), rel=ROUNDING)
    assert holed.boundary()[0].holes


def test_the_boundary_of_three_coordinates_is_sliced(manipulator):
    swept = opm.sweep(manipulator, **LEVEL | {"xi": (0.0, 0.8, 3)})
    mask = swept.mask()[:, :, 0, :, 0]
    outlines = swept.boundary()
    assert [outline.at for outline in outlines] == [{"xi": value} for value in swept.axes["xi"]]
    for number, outline in enumerate(outlines):
        np.testing.assert_array_equal(inside_by_rings(outline, swept.axes["x"], swept.axes["y"]), mask[:, :, number])


@pytest.mark.parametrize("kind", KINDS)
def test_components_are_those_of_scipy(sweeps, kind):
    labels, _ = ndimage.label(sweeps[kind].mask())
    sizes = np.sort(np.bincount(labels.ravel())[1:])[::-1]
    np.testing.assert_array_equal(sweeps[kind].components(), sizes)
    found = sweeps[kind].labels()
    assert found.dtype == np.int32 and found.shape == labels.shape
    np.testing.assert_array_equal(np.bincount(found.ravel())[1:], sizes)
    # One label of ours for each of theirs.
    assert len(np.unique(np.stack([found.ravel(), labels.ravel()]), axis=1).T) == len(np.unique(labels)) == len(np.unique(found))
    np.testing.assert_array_equal(found > 0, sweeps[kind].mask())


@pytest.mark.parametrize("length", [None, 0.05])
def test_conditioning_is_that_of_every_pose(manipulator, length):
    swept = opm.sweep(manipulator, length=length, **LEVEL)
    poses, mask = np.stack([v.ravel() for v in np.meshgrid(*swept.axes.values(), indexing="ij")], axis=1), swept.mask()
    condition = manipulator.singularity(poses, length=length).condition.reshape(mask.shape)
    local = swept.local_conditioning()
    np.testing.assert_array_equal(np.isnan(local), ~mask)
    np.testing.assert_allclose(local[mask], 1 / condition[mask], rtol=ROUNDING)
    found = swept.conditioning()
    assert found.global_index == pytest.approx(np.nanmean(local), rel=ROUNDING)
    assert (found.local_min, found.local_max) == (np.nanmin(local), np.nanmax(local))
    assert found.poses == swept.count and found.length == swept.length
    most = float(np.median(condition[mask]))
    limited = opm.sweep(manipulator, length=length, max_condition=most, **LEVEL)
    np.testing.assert_array_equal(limited.mask(), mask & (condition <= most))
    assert limited.max_condition == most and 0 < limited.count < swept.count
    assert limited.conditioning().local_min >= 1 / most
    nothing = opm.sweep(manipulator, x=5.0).conditioning()
    assert (nothing.global_index, nothing.local_min, nothing.local_max, nothing.poses) == (None, None, None, 0)


def program(kind, grid, *options, output=None):
    command = [sys.executable, "-m", "opm_kinematics", "workspace", NAME, "--quiet", "--format", "json", "--kind", kind, *options]
    for name, range_ in grid.items():
        command += ["--grid", f"{name}=" + (":".join(map(str, range_)) if isinstance(range_, tuple) else str(range_))]
    command += [] if output is None else ["-o", output]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


@pytest.mark.parametrize("kind", KINDS)
def test_the_program_says_the_same(sweeps, kind):
    swept = sweeps[kind]
    told = program(kind, KINDS[kind], "--shape", *(["--conditioning"] if kind in OF_POSES else []))
    assert (swept.poses, swept.count, swept.fraction) == (told["poses"], told["reachable"], told["fraction"])
    assert {name: range_ and list(range_) for name, range_ in swept.imaginary_range.items()} == told["imaginary_range"]
    assert swept.components().tolist() == told["components"]["sizes"]
    assert told.get("orientations", swept.orientations) == swept.orientations
    if told["boundary"] is None:
        assert kind in ("grid", "imaginary")
        with pytest.raises(opm.OpmError, match="5 coordinates have several values|says nothing of the imaginary joints"):
            swept.boundary()
    else:
        outlines = swept.boundary()
        assert list(outlines[0].axes) == told["boundary"]["axes"]
        for outline, slice_ in zip(outlines, told["boundary"]["slices"], strict=True):
            assert (outline.at, outline.area) == (slice_["at"], slice_["area"])
            assert [ring[:-1].tolist() for ring in outline.rings] == slice_["rings"]
    if kind in OF_POSES:
        found = swept.conditioning()
        assert told["conditioning"] == {
            "characteristic_length": found.length,
            "global": found.global_index,
            "local_min": found.local_min,
            "local_max": found.local_max,
        }


@pytest.mark.parametrize("mode", ["home", "any"])
@pytest.mark.parametrize("kind", ["constant-orientation", "reachable", "dexterous"])
def test_limits_on_the_condition_number_are_those_of_the_program(manipulator, kind, mode):
    grid = LEVEL if kind == "constant-orientation" else {**LEVEL, "x": (-0.2, 0.2, 21), "y": (-0.2, 0.2, 21), "xi": (0.0, 0.4, 3)}
    told = program(kind, grid, "--mode", mode, "--max-condition", "20", "--length", "0.1")
    swept = opm.sweep(manipulator, kind=kind, mode=mode, max_condition=20, length=0.1, **grid)
    assert swept.count == told["reachable"] > 0
    assert swept.count < opm.sweep(manipulator, kind=kind, mode=mode, **grid).count


@pytest.mark.parametrize(
    ("kind", "options", "shown"),
    [
        *((kind, {}, {}) for kind in KINDS),
        ("dexterous", {}, {"scalars": ["share"], "color": "y"}),
        ("imaginary", {}, {"axes": ["theta12", "theta13", "xi"], "color": "theta11"}),
        ("orientation", {"max_condition": 30.0, "length": 0.1}, {"scalars": ["inverse_condition"], "color": "S1"}),
        ("reachable", {"mode": "any", "max_condition": 30.0}, {}),
    ],
)
def test_a_recording_is_that_of_the_program(manipulator, tmp_path, kind, options, shown):
    swept = opm.sweep(manipulator, kind=kind, **options, **KINDS[kind])
    assert swept.count > 0
    flags = []
    for name, value in (options | shown).items():
        flags += [f"--{name.replace('_', '-')}", ",".join(value) if isinstance(value, list) else str(value)]
    program(kind, KINDS[kind], *flags, output=tmp_path / "a.mcap")
    swept.write_mcap(tmp_path / "b.mcap", **shown)
    assert (tmp_path / "b.mcap").read_bytes() == (tmp_path / "a.mcap").read_bytes()
    if kind not in OF_POSES:
        with pytest.raises(opm.OpmError, match=f"b.npy: kind {kind} is written as MCAP"):
            swept.write(tmp_path / "b.npy")


class Here(Executor):
    """Works at once, on what has been pickled."""

    def __init__(self):
        self.calls = 0

    def submit(self, fn, /, *args, **kwargs):
        self.calls += 1
        future = Future()
        work, given = pickle.loads(pickle.dumps((fn, args)))
        future.set_result(pickle.loads(pickle.dumps(work(*given))))
        return future


def test_executors_find_the_same(manipulator, sweeps):
    for kind, swept in sweeps.items():
        here = Here()
        found = opm.sweep(manipulator, kind=kind, executor=here, shards=7, **KINDS[kind])
        assert (found.count, found.poses, found.imaginary_range) == (swept.count, swept.poses, swept.imaginary_range)
        again = pickle.loads(pickle.dumps(found))
        assert (again.kind, again.count, again.length) == (kind, swept.count, swept.length)
        parts = min(7, -(-np.prod([len(values) for values in swept.grid.values()]) // 2**15))
        assert here.calls == parts * (2 if kind in ("reachable", "dexterous", "imaginary") else 1)
        methods = ["mask", "points", "components", "labels"]
        methods += ["conditioning", "local_conditioning"] if kind in OF_POSES else []
        methods += ["visits"] if kind in ("reachable", "dexterous") else []
        for method in methods:
            expected = getattr(swept, method)()
            given = getattr(again, method)(executor=Here(), shards=7)
            if method == "conditioning":
                assert given == expected
            else:
                np.testing.assert_array_equal(given, expected)
        if kind not in ("grid", "imaginary"):
            for a, b in zip(again.boundary(executor=Here(), shards=7), swept.boundary(), strict=True):
                assert (a.at, a.area) == (b.at, b.area)
                assert all(np.array_equal(*rings) for rings in zip(a.rings, b.rings, strict=True))


def test_parts_of_a_grid_that_share_slices_add_up(manipulator):
    """A slice of 63001 poses, two blocks: the parts have the same places and the same orientations."""
    grid = {"x": (-0.25, 0.25, 251), "y": (-0.25, 0.25, 251), "xi": (0.0, 1.2, 3), "psi": (0.0, 0.5, 2)}
    for kind, axes in (("dexterous", (2, 3, 4)), ("imaginary", (0, 1))):
        here = Here()
        found = opm.sweep(manipulator, kind=kind, executor=here, **grid)
        poses = opm.sweep(manipulator, **grid).mask()
        np.testing.assert_array_equal(found.mask(), poses.all(axis=axes) if kind == "dexterous" else poses.any(axis=axes))
        assert here.calls > 20


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kind": "none"}, 'kind is "none", expected one of grid, constant-orientation, orientation, aspects, reachable, dexterous, imag'),
        ({"kind": "orientation", "x": (0.0, 0.1, 2)}, "^grid: x has 2 values; kind orientation holds the place's coord"),
        ({"kind": "imaginary", "mode": "any", "xi": 0.1}, "^mode: with kind imaginary: the imaginary joints have other values"),
        ({"kind": "upper", "xi": 0.1, "max_condition": 9}, "^max_condition: with kind upper: a section alone has no condition"),
        ({"kind": "upper", "x": 0.1}, "x: no such task coordinate of the upper section"),
        ({"max_condition": 0.5, "x": 0.1}, "max_condition is 0.5, expected a number of at least 1"),
        ({"max_condition": float("nan"), "x": 0.1}, "max_condition is NaN, expected a number of at least 1"),
        ({"length": -1.0, "x": 0.1}, "length is -1.0, expected a positive one"),
        ({"kind": "reachable", "x": (0.0, 1.0, 2**14), "y": (0.0, 1.0, 2**14)}, "places of a set: 268435456, expected at most"),
    ],
)
def test_wrong_kinds_are_told(manipulator, options, message):
    with pytest.raises(opm.OpmError, match=message):
        opm.sweep(manipulator, **options)


def test_what_a_kind_has_not_is_told(sweeps):
    with pytest.raises(opm.OpmError, match="visits are of kind reachable or dexterous, not of grid"):
        sweeps["grid"].visits()
    for kind, points in (("dexterous", "places"), ("upper", "orientations"), ("lower", "points")):
        for method in ("conditioning", "local_conditioning"):
            with pytest.raises(opm.OpmError, match=f"only poses have a condition number; the {points} of kind {kind} have none"):
                getattr(sweeps[kind], method)()
    for kind in ("reachable", "dexterous", "imaginary"):
        with pytest.raises(opm.OpmError, match=f"a measure is of poses or of one section, not of {kind}"):
            sweeps[kind].measure()
    assert 0 < sweeps["upper"].measure(tolerance=0.1).fraction < 1
    limited = opm.sweep(opm.examples.load(NAME), max_condition=20.0, **LEVEL)
    with pytest.raises(opm.OpmError, match="a measure knows no max_condition"):
        limited.measure()


@pytest.mark.parametrize("kind", ["constant-orientation", "upper"])
def test_a_grid_is_fitted_where_none_is_given(manipulator, kind):
    told = program(kind, {})
    swept = opm.sweep(manipulator, kind=kind)
    ends = {name: {"min": v[0], "max": v[-1], "count": len(v)} for name, v in swept.grid.items()}
    assert ends == told["grid"] and swept.count == told["reachable"] > 0


def test_a_workspace_without_an_end_warns():
    free = opm.examples.load("translational-helical-3dof").with_parameters({"limits.S": None})
    with pytest.warns(UserWarning) as told:
        opm.sweep(free, kind="constant-orientation")
    assert [str(warning.message) for warning in told] == [
        f"the workspace continues beyond this grid along {name}; limit a joint, or give {name}" for name in "xy"
    ]


def test_reprs_say_what_the_points_are(sweeps):
    count = sweeps["dexterous"].count
    assert f"{count} of 2091 places dexterous in mode" in repr(sweeps["dexterous"])
    assert f"{count} of 2091 places dexterous" in sweeps["dexterous"]._repr_html_()
    assert "orientations closing" in repr(sweeps["upper"]) and "poses reachable" in repr(sweeps["grid"])
    (outline,) = sweeps["dexterous"].boundary()
    assert repr(outline) == f"<Outline in x, y: {len(outline.rings)} rings, {len(outline.holes)} of them holes>"
