"""Tilt and torsion, what rejects poses, and the largest disc or box in a workspace."""

import math
import pickle
from pathlib import Path

import numpy as np
import opm_kinematics as opm
import pytest
from mcap.reader import make_reader

GRID = {"x": (-0.3, 0.3, 31), "y": (-0.3, 0.3, 31)}


def rotation(axis: int, angle: float) -> np.ndarray:
    """The matrix of a rotation about y (1) or z (2)."""
    c, s = math.cos(angle), math.sin(angle)
    if axis == 1:
        return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def test_tilt_and_torsion_are_those_of_the_formula() -> None:
    m = opm.examples.load("plano-spherical-5dof").with_coordinates("tilt-torsion")
    assert [c.name for c in m.task_coordinates] == ["x", "y", "azimuth", "tilt", "torsion"]
    azimuth, tilt, torsion = 2.1, 0.4, -0.3
    pose = [0.01, 0.02, azimuth, tilt, torsion]
    placed = m.transform([pose])[0]
    expected = rotation(2, azimuth) @ rotation(1, tilt) @ rotation(2, torsion - azimuth)
    assert np.allclose(placed[:3, :3], expected, atol=1e-12)
    assert m == pickle.loads(pickle.dumps(m)) == opm.Manipulator.parse(m.text)
    longer = m.with_parameters({"leg1.h": 0.13})
    assert [c.name for c in longer.task_coordinates][2:] == ["azimuth", "tilt", "torsion"]
    with pytest.raises(opm.OpmError, match='expected "euler-angles", "tilt-torsion" or "roll-pitch-yaw"'):
        m.with_coordinates("tilt")
    with pytest.raises(opm.OpmError, match="has no Euler angles"):
        opm.examples.load("planar-3rrr").with_coordinates("tilt-torsion")


def test_rejections_are_those_of_inverse_kinematics() -> None:
    m = opm.examples.load("plano-spherical-5dof")
    sweep = opm.sweep(m, **GRID)
    found = sweep.rejections()
    x, y = np.meshgrid(*(np.linspace(low, high, n) for low, high, n in GRID.values()), indexing="ij")
    poses = np.zeros((x.size, 5))
    poses[:, 0], poses[:, 1] = x.ravel(), y.ravel()
    solved = m.inverse(poses)
    rejected = np.count_nonzero(~(solved.reachable & solved.within_limits))
    assert sweep.poses - sweep.count == rejected
    assert sum(one.alone for one in found) <= rejected
    # Where every leg closes, the limits alone reject.
    limit = 0.3
    past = {name: np.abs(solved.joints[:, m.joint_names.index(name)]) > limit for name in ("S1", "S2", "S3")}
    count = sum(past.values())
    for name, where in past.items():
        alone = np.count_nonzero(solved.reachable & where & (count == 1))
        assert sum(one.alone for one in found if one.joint == name) == alone
    assert pickle.loads(pickle.dumps(found[0])) == found[0]
    # In any mode, no cause rejects more poses than are rejected.
    anywhere = opm.sweep(m, mode="any", **GRID)
    everywhere = anywhere.rejections()
    assert 0 < anywhere.poses - anywhere.count <= rejected
    most = max(one.alone + one.with_others for one in everywhere)
    assert 0 < most <= anywhere.poses - anywhere.count <= sum(one.alone + one.with_others for one in everywhere)


def test_a_recording_holds_what_rejects_and_what_fits_inside(tmp_path: Path) -> None:
    m = opm.examples.load("plano-spherical-5dof")
    sweep = opm.sweep(m, kind="constant-orientation", **GRID)
    disc = sweep.inscribed("disc")
    path = tmp_path / "all.mcap"
    sweep.write(path, inscribed=disc, explain=True)
    with open(path, "rb") as file:
        reader = make_reader(file)
        records = {record.name: record.metadata for record in reader.iter_metadata()}
        topics = {channel.topic for channel in reader.get_summary().channels.values()}
    assert "/workspace/rejected" in topics
    assert int(records["rejected"]["points"]) == sweep.poses - sweep.count
    assert disc is not None and records["result"]["inscribed"] == "disc"
    centre, radius, _ = map(float, records["result"]["inscribed.x"].split(":"))
    assert (centre, radius) == (disc.centre["x"], disc.radii["x"])
    with pytest.raises(opm.OpmError, match=r"explain is for a path that ends in \.mcap"):
        sweep.write(tmp_path / "all.npy", explain=True)
    other = opm.sweep(m, xi=(-0.2, 0.2, 5), psi=(-0.2, 0.2, 5))
    with pytest.raises(opm.OpmError, match="inscribed is a shape in x, y, expected one in xi, psi"):
        other.write(tmp_path / "other.mcap", inscribed=disc)


def test_the_largest_disc_is_inside_and_no_point_allows_a_larger_one() -> None:
    m = opm.examples.load("plano-spherical-5dof")
    sweep = opm.sweep(m, **GRID)
    disc = sweep.inscribed("disc")
    assert disc is not None
    mask = sweep.mask().reshape(31, 31)
    step = 0.02
    edges = np.pad(mask, 1)
    outside = (np.argwhere(~edges) - 1) * step - 0.3
    radius = disc.radii["x"]

    def clearance(at: np.ndarray) -> float:
        gaps = np.maximum(np.abs(outside - at) - step / 2, 0)
        return float(np.sqrt((gaps**2).sum(axis=1)).min())

    centre = np.array([disc.centre["x"], disc.centre["y"]])
    assert clearance(centre) == pytest.approx(radius, abs=1e-12)
    inside = np.argwhere(mask) * step - 0.3
    assert max(map(clearance, inside)) <= radius + 1e-12
    given = sweep.inscribed("disc", centre={"x": 0.0, "y": 0.0})
    assert given is not None and given.radii["x"] == pytest.approx(clearance(np.zeros(2)), abs=1e-12)
    box = sweep.inscribed("box")
    assert box is not None and box.measure == pytest.approx(4 * box.radii["x"] * box.radii["y"])
    assert pickle.loads(pickle.dumps(box)) == box
    with pytest.raises(opm.OpmError, match="varies in three coordinates"):
        sweep.inscribed("ball")
    with pytest.raises(opm.OpmError, match="centre is not complete"):
        sweep.inscribed("disc", centre={"x": 0.0})
