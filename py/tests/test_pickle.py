"""Results cross processes, and cannot be changed."""

import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import opm_kinematics as opm
import pytest


@pytest.fixture(scope="module")
def manipulator():
    return opm.examples.load("plano-spherical-5dof")


@pytest.fixture(scope="module")
def objects(manipulator):
    """One of each class."""
    m, home = manipulator, [manipulator.home]
    solutions = m.inverse(home)
    swept = opm.sweep(m, kind="dexterous", x=(-0.1, 0.1, 5), y=(-0.1, 0.1, 5))
    poses = np.zeros((4, 5))
    poses[:, 0] = [0, 0.1, 0.2, 0.3]
    followed = opm.trajectory(m, poses, times=[0, 1, 2, 3], rate=20)
    assert followed.violations
    decomposition = m.decomposition
    found = [
        solutions,
        m.inverse(np.zeros((3, 5)), mode="all"),
        m.velocity(home, home),
        m.singularity(home),
        m.analyze(home, wrench=[1, 2, 3, 4, 5, 6]),
        m.nearest(m.transform(home)),
        m.nearest_reachable(home),
        m.accuracy(home, actuators=(20e-6, 20e-6)),
        m.parameter_jacobian(home, parameters=["leg1.h"]),
        m.accuracy(home, actuators=(20e-6, 20e-6), samples=10, seed=1).samples,
        m.accuracy_over({"x": (-0.01, 0.01)}, actuators=(20e-6, 20e-6)),
        opm.calibrate(m, {name: solutions[name] for name in ("S1", "S2", "S3", "phi14", "phi24")} | {c.name: [c.home] for c in m.task_coordinates}, only=["leg1.h"]),
        opm.trajectory(m, poses, times=[0, 1, 2, 3], rate=20, clearance=0.05).contacts[0],
        m.forward(solutions.joints[:, m.actuated]),
        m.forward(solutions.joints[:, m.actuated])[0][0],
        m.check(samples=2),
        m.check(samples=2).comparisons[0],
        m.solids()[0],
        m.clearance(home),
        m.legs["leg1"][0],
        m.explore(),
        m.task_coordinates[0],
        decomposition,
        decomposition.intersection,
        decomposition.legs[0],
        swept,
        swept.boundary()[0],
        swept.inscribed("disc"),
        opm.sweep(m, x=(-0.3, 0.3, 61)).rejections()[0],
        opm.sweep(m, x=(-0.1, 0.1, 5)).conditioning(),
        opm.sweep(m, kind="aspects", x=(-0.1, 0.1, 5)).aspects()[0],
        opm.measure(m, over={"x": (-0.1, 0.1), "y": 0.01}),
        followed,
        opm.trajectory(m, "plano-spherical-sinusoids", rate=20),
        followed.violations[0],
        opm.examples.bennett(),
        m,
    ]
    classes = {type(thing) for thing in found}
    exported = {getattr(opm, name) for name in opm.__all__ if isinstance(getattr(opm, name), type)} - {opm.OpmError}
    assert classes == exported
    return found


def attributes(thing):
    names = [name for name in dir(thing) if not name.startswith("_")]
    return {name: value for name in names if not callable(value := getattr(thing, name))}


def same(one, other):
    assert type(one) is type(other)
    if isinstance(one, np.ndarray):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype
    elif isinstance(one, dict):
        assert list(one) == list(other)
        for name in one:
            same(one[name], other[name])
    elif isinstance(one, (list, tuple)):
        assert len(one) == len(other)
        for pair in zip(one, other, strict=True):
            same(*pair)
    elif type(one).__module__.startswith("opm_kinematics"):
        assert attributes(one).keys() == attributes(other).keys()
        same(attributes(one), attributes(other))
    else:
        assert one == other


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_everything_is_the_same_after_pickling(objects, protocol):
    for thing in objects:
        again = pickle.loads(pickle.dumps(thing, protocol))
        assert repr(again) == repr(thing)
        same(again, thing)


def test_results_are_equal_where_their_values_are(objects):
    for number, thing in enumerate(objects):
        again = pickle.loads(pickle.dumps(thing))
        assert again is not thing and again == thing and (again != thing) is False
        for other in [*objects[:number], *objects[number + 1 :], None, repr(thing), 1.0]:
            assert (thing == other) is False and thing != other


def test_results_that_differ_in_one_value_are_not_equal(manipulator):
    m, poses = manipulator, np.array([[0.0, 0, 0, 0.3, 0], [9, 0, 0, 0.3, 0]])
    lifted = m.transform(poses)
    lifted[1, 2, 3] += 1e-9
    other, axes = m.with_parameters(a2=0.055), {"x": (-0.1, 0.1, 5), "y": (-0.1, 0.1, 5)}
    bennett = opm.examples.bennett()
    waypoints = lambda end: [[0, 0, 0, 0.2, 0], [0.1, 0, 0, 0.2, 0], [end, 0, 0, 0.2, 0]]  # noqa: E731
    followed = lambda m, end=0.0, rate=10: opm.trajectory(m, waypoints(end), times=[0, 1, 2], rate=rate)  # noqa: E731
    pairs = [
        # The second pose is out of reach, and NaN.
        (lambda poses: m.inverse(poses), poses, poses + [[1e-15], [0]]),
        (lambda poses: m.velocity(poses, np.ones((1, 5))), poses, poses[:1]),
        (m.singularity, poses, poses[::-1]),
        (lambda load: m.analyze(poses, wrench=load), np.ones(6), np.eye(6)[0]),
        (m.nearest, m.transform(poses), lifted),
        (lambda m: opm.sweep(m, **axes), m, other),
        (lambda kind: opm.sweep(m, kind=kind, **axes), "reachable", "dexterous"),
        (lambda x: opm.sweep(m, x=x), (0.0, 0.1, 3), (0.0, 0.1, 4)),
        (lambda mode: opm.sweep(m, mode=mode, x=0.0), "home", "any"),
        (lambda most: opm.sweep(m, x=0.0, max_condition=most), 30.0, 31.0),
        (lambda least: opm.sweep(m, x=0.0, limits={"lti": least}), 0.1, 0.2),
        (lambda m: opm.sweep(m, x=(-0.4, 0.4, 21), y=(-0.4, 0.4, 21)).boundary(), m, other),
        (lambda y: opm.sweep(m, x=(-0.1, 0.1, 5), y=y).conditioning(), 0.0, 0.1),
        (lambda x: opm.measure(m, over={"x": (0.0, x)}), 0.1, 0.2),
        (lambda budget: opm.measure(m, over={"x": (-0.3, 0.3), "xi": (0, 0.5)}, tolerance=0.0, budget=budget), 100, 400),
        (followed, m, other),
        (lambda rate: followed(m, rate=rate), 10, 20),
        (lambda end: followed(m, end).violations, 9.0, 8.0),
        (opm.Linkage.parse, bennett.text, bennett.text + "# a comment\n"),
    ]
    for make, given, changed in pairs:
        assert make(given) == make(given)
        assert make(given) != make(changed), changed
    assert opm.sweep(m, threads=1, **axes) == opm.sweep(m, threads=2, **axes)
    assert hash(bennett) == hash(opm.Linkage.parse(bennett.text, "else"))
    with pytest.raises(TypeError, match="unhashable"):
        hash(m.inverse(poses))


def test_arrays_of_results_cannot_be_written_to(objects):
    checked = 0
    for thing in [*objects, *(pickle.loads(pickle.dumps(thing)) for thing in objects)]:
        for name, value in attributes(thing).items():
            if isinstance(value, np.ndarray):
                with pytest.raises(ValueError, match="read-only"):
                    value[...] = 0
                assert not getattr(thing, name).flags.writeable
                checked += 1
    assert checked > 60


def test_what_the_caller_owns_can_be_written_to(manipulator):
    swept = opm.sweep(manipulator, x=(-0.1, 0.1, 5))
    for array in (swept.mask(), swept.points(), manipulator.jacobian([manipulator.home])):
        array[...] = 0
    swept.axes["x"][0] = 9
    assert swept.axes["x"][0] == -0.1 and swept.mask().any()


def test_a_trajectory_is_recorded_after_pickling(manipulator, tmp_path):
    for number, followed in enumerate((
        opm.trajectory(manipulator, "plano-spherical-sinusoids", rate=20),
        opm.trajectory(manipulator, np.zeros((3, 5)), times=[0, 1, 2]),
    )):
        paths = [tmp_path / f"{number}a.mcap", tmp_path / f"{number}b.mcap"]
        followed.write_mcap(paths[0])
        pickle.loads(pickle.dumps(followed)).write_mcap(paths[1])
        assert paths[0].read_bytes() == paths[1].read_bytes()


def test_results_come_from_another_process(manipulator):
    poses = np.zeros((7, 5))
    poses[:, 3] = np.linspace(-1, 1, 7)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        solutions = pool.submit(manipulator.inverse, poses).result()
        measured = pool.submit(opm.measure, manipulator, over={"x": (-0.1, 0.1)}).result()
    np.testing.assert_array_equal(solutions.joints, manipulator.inverse(poses).joints)
    assert measured.value == opm.measure(manipulator, over={"x": (-0.1, 0.1)}).value


def test_mechanisms_are_equal_by_what_they_are(manipulator):
    again = pickle.loads(pickle.dumps(manipulator))
    assert again == manipulator and hash(again) == hash(manipulator) and again is not manipulator
    assert len({again, manipulator, opm.examples.load("plano-spherical-5dof")}) == 1
    longer = manipulator.with_parameters(h=0.13)
    assert longer != manipulator and longer == manipulator.with_parameters(h=0.13) and manipulator != "m"
