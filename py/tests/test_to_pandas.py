"""Results as tables: every number once, under a name, with the labels that the poses had."""

import pickle

import numpy as np
import opm_kinematics as opm
import pandas as pd
import pytest


def table_of(m, count=3):
    names = [c.name for c in m.task_coordinates]
    steps = np.random.default_rng(1).uniform(-0.01, 0.01, (count, len(names)))
    return pd.DataFrame(np.array(m.home) + steps, columns=names, index=pd.Index([f"p{i}" for i in range(count)], name="point"))


CALLS = {
    "inverse": lambda m, p: m.inverse(p),
    "velocity": lambda m, p: m.velocity(p, np.ones(len(m.home))),
    "singularity": lambda m, p: m.singularity(p),
    "analyze": lambda m, p: m.analyze(p, wrench=[1, 2, 3, 0.1, 0.2, 0.3], link_stiffness=(1e7, 1e3)),
    "clearance": lambda m, p: m.clearance(p),
    "accuracy": lambda m, p: m.accuracy(p, actuators=(2e-5, 2e-5), clearance=(2e-5, None)),
    "samples": lambda m, p: m.accuracy(p, actuators=(2e-5, 2e-5), samples=5).samples,
    "parameter_jacobian": lambda m, p: m.parameter_jacobian(p),
    "nearest_reachable": lambda m, p: m.nearest_reachable(p),
}


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("name", ["plano-spherical-5dof", "delta", "stewart"])
def test_rows_keep_their_labels_and_numbers_their_places(name, call):
    m, call = opm.examples.load(name), CALLS[call]
    poses = table_of(m)
    found = call(m, poses)
    frame = found.to_pandas()
    assert frame.index.equals(poses.index) and frame.index.name == "point" and found.index.equals(poses.index)
    assert frame.columns.is_unique
    # All numbers are there: their sums are equal, array by array.
    own = [n for n in vars(type(found)) if isinstance(getattr(found, n), np.ndarray) and n not in ("sizes", "pair")]
    for part in own:
        columns = [column for column in frame if column == part or column.startswith(f"{part}.")]
        if type(found) is opm.NearestReachable and part == "poses":
            columns = [c.name for c in m.task_coordinates]
        if type(found) is opm.Solutions:
            columns = {"joints": found.joint_names, "imaginary": found.imaginary_names}.get(part, [part])
        array = getattr(found, part)
        assert len(columns) == array[0].size, part
        np.testing.assert_array_equal(frame[columns].to_numpy(dtype=float).ravel(), array.astype(float).ravel(), err_msg=part)
    # Without labels rows are counted; labels are part of what is equal, and of pickles.
    plain = call(m, poses.to_numpy())
    assert plain.index is None and plain.to_pandas().index.equals(pd.RangeIndex(3)) and plain != found
    assert pickle.loads(pickle.dumps(found)) == found == call(m, poses) and call(m, poses.iloc[::-1]) != found
    assert len(call(m, poses.to_numpy()[0]).to_pandas()) == 1
    assert call(m, np.tile(poses.to_numpy(), (2, 1, 1))).to_pandas().index.names == ["pose0", "pose1"]


def test_names_of_columns():
    m = opm.examples.load("delta")
    poses = table_of(m)
    motion = m.velocity(poses, [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(motion.to_pandas()[f"joint_rates.{m.joint_names[1]}"], motion.joint_rates[:, 1])
    efforts = m.analyze(poses, wrench=np.ones(6))
    actuated = m.joint_names[m.actuated[2]]
    np.testing.assert_array_equal(efforts.to_pandas()[f"effort_jacobian.{actuated}.FZ"], efforts.effort_jacobian[:, 2, 2])
    of = opm.examples.load("plano-spherical-5dof")
    rates = of.parameter_jacobian(table_of(of))
    parameter = rates.parameters[1]
    np.testing.assert_array_equal(rates.to_pandas()[f"pose.zeta.{parameter}"], rates.pose[:, 2, 1])
    clear = m.clearance(poses)
    assert clear.to_pandas()["one"].iloc[0] == clear.pairs[clear.pair[0]][0]
    away = m.transform(poses)
    away[1, 2, 3] += 0.1
    tilted = away.copy()
    tilted[1, :3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    nearest = m.nearest(tilted)
    frame = nearest.to_pandas()
    assert list(frame)[:3] == ["x", "y", "z"] and list(frame)[-1] == "translation.z"
    np.testing.assert_array_equal(frame["rotation.x"], nearest.rotation[:, 0])


def test_modes_of_labelled_poses():
    m = opm.examples.load("planar-3rpr")
    poses = table_of(m)
    every = m.inverse(poses, mode="all").to_pandas()
    assert every.index.names == ["pose", "mode"] and list(every.loc["p1"].index) == m.modes


def test_assemblies_close_with_their_residuals():
    m = opm.examples.load("planar-3rpr")
    joints = m.inverse(table_of(m), joints="actuated").joints
    for given, levels in ((joints, ["row", "assembly"]), (joints[None], ["row0", "row1", "assembly"]), (joints[0], ["assembly"])):
        found = m.forward(given)
        frame = found.to_pandas()
        assert list(frame.index.names) == levels and list(frame)[-1] == "residual" and len(frame) == found.counts.sum()
        assert list(frame)[:3] == found.pose_names == ["x", "y", "theta"]
    found = m.forward(joints)
    row = found.to_pandas().loc[(1, 0)]
    assert row["residual"] == found[1][0].residual and row["mode"] == found[1][0].mode
    np.testing.assert_array_equal(row[found.pose_names].to_numpy(dtype=float), found[1][0].pose)
    assert len(m.forward([99.0] * 3).to_pandas()) == 0 == len(m.forward(np.zeros((0, 3))).to_pandas())


def test_other_results():
    m = opm.examples.load("planar-3rpr")
    certificate = m.check(samples=5)
    frame = certificate.to_pandas()
    assert list(frame.index) == [one.name for one in certificate.comparisons] and list(frame)[-1] == "worst"
    measured = opm.measure(m, over={"theta": (-0.1, 0.1)}, tolerance=0.2)
    assert measured.to_pandas()["value"].item() == measured.value
    bounds = m.accuracy_over({"x": (0.0, 0.01), "y": 0.0, "theta": 0.0}, actuators=(1e-5, None), gap=0.5)
    assert bounds.to_pandas()["length"].item() == bounds.length
    for found in (certificate, measured, bounds):
        assert found.to_pandas().shape[0] >= 1


def test_pandas_is_imported_late():
    import subprocess
    import sys

    code = "import sys, opm_kinematics as opm; m = opm.examples.load('delta'); m.inverse([m.home]); m.singularity(m.home); assert 'pandas' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)
