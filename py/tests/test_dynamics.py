"""The equations of motion from Python against each other, and against differences of energies."""

import numpy as np
import opm_kinematics as opm
import pytest

NAMES = ["delta", "stewart", "plano-spherical-5dof", "five-bar", "tricept"]


def drawn(name, count=40):
    m = opm.examples.load(name)
    rng = np.random.default_rng(7)
    size = np.array([0.02 if c.unit == "m" else 0.2 for c in m.task_coordinates])
    poses = m.home + rng.uniform(-1, 1, (count, len(m.home))) * size
    near = m.singularity(poses)
    poses = poses[near.reachable & (np.abs(near.serial) > 1e-3) & (np.abs(near.coordinates) > 1e-2)]
    assert len(poses) > 5
    return m, poses, rng.normal(size=poses.shape), rng.normal(size=poses.shape)


@pytest.mark.parametrize("name", NAMES)
def test_forward_dynamics_undoes_inverse_dynamics(name):
    m, poses, rates, accelerations = drawn(name)
    efforts = m.inverse_dynamics(poses, rates, accelerations)
    assert efforts.shape == (len(poses), len(m.actuated))
    np.testing.assert_allclose(m.forward_dynamics(poses, rates, efforts), accelerations, atol=1e-6)
    parts = m.bias(poses, rates) + m.gravity(poses) + m.friction(poses, rates)
    needed = np.einsum("nij,nj->ni", m.mass_matrix(poses), accelerations) + parts
    found = np.einsum("nai,na->ni", m.jacobian(poses), efforts)
    np.testing.assert_allclose(found, needed, rtol=1e-8, atol=1e-8 * np.abs(needed).max())


@pytest.mark.parametrize("name", NAMES)
def test_the_bias_is_what_changes_of_the_mass_matrix_need(name):
    """Lagrange: c = dM/dt v - 1/2 d(v M v)/dx."""
    m, poses, rates, _ = drawn(name)
    step = 1e-5
    ahead, back = m.mass_matrix(poses + step * rates), m.mass_matrix(poses - step * rates)
    expected = np.einsum("nij,nj->ni", (ahead - back) / (2 * step), rates)
    for j in range(poses.shape[1]):
        moved = step * np.eye(poses.shape[1])[j]
        slope = (m.mass_matrix(poses + moved) - m.mass_matrix(poses - moved)) / (2 * step)
        expected[:, j] -= 0.5 * np.einsum("ni,nij,nj->n", rates, slope, rates)
    found = m.bias(poses, rates)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_the_linear_model_is_what_small_changes_do(name):
    m, poses, rates, _ = drawn(name)
    efforts = m.inverse_dynamics(poses, rates, np.zeros_like(rates))
    A, B = m.linear_model(poses, rates, efforts)
    d, step = poses.shape[1], 1e-6
    assert A.shape == (len(poses), 2 * d, 2 * d) and B.shape == (len(poses), 2 * d, efforts.shape[1])
    expected = np.zeros((len(poses), 2 * d, 2 * d + efforts.shape[1]))
    expected[:, :d, d : 2 * d] = np.eye(d)
    for j in range(expected.shape[2]):
        change = step * np.eye(expected.shape[2])[j]
        ends = [
            m.forward_dynamics(poses + s * change[:d], rates + s * change[d : 2 * d], efforts + s * change[2 * d :])
            for s in (1, -1)
        ]
        expected[:, d:, j] = (ends[0] - ends[1]) / (2 * step)
    size = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(np.concatenate([A, B], axis=2) - expected) < 1e-5 * size).all()
    np.testing.assert_array_equal(m.linear_model(poses[0], rates[0], efforts[0])[0], A[0])
    A, B = m.linear_model(poses * np.nan, rates, efforts)
    assert np.isnan(A).all() and np.isnan(B).all()


def test_shapes_names_and_threads():
    m, poses, rates, _ = drawn("plano-spherical-5dof")
    one = m.forward_dynamics(poses[0], rates[0], np.zeros(5))
    assert one.shape == (5,) and m.mass_matrix(poses[0]).shape == (5, 5)
    many = m.forward_dynamics(poses, rates, {m.joint_names[m.actuated[0]]: 0.0}, threads=1)
    np.testing.assert_array_equal(many[0], one)
    np.testing.assert_array_equal(many, m.forward_dynamics(poses, rates, np.zeros((len(poses), 5)), threads=3))
    double = m.mass_matrix(poses, density=5400) / m.mass_matrix(poses, density=2700)
    assert np.nanmax(double) < 2 + 1e-9
    np.testing.assert_allclose(m.gravity(poses, gravity=[0, 0, 0]), 0)
    assert np.isnan(m.mass_matrix([100.0, 0, 0, 0.1, 0])).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0, 0], [0, 0, 0]), "efforts has shape"),
        (([0, 0, 0], [0, 0]), "rates has shape"),
        (([0, np.nan, 0], [0, 0, 0]), "NaN is among efforts"),
        (({"Q9": 1.0}, [0, 0, 0]), "efforts has a column 'Q9'"),
        ((np.zeros((2, 3)), np.zeros((4, 3))), "2 rows of efforts, expected 4 as of poses, or one"),
    ],
)
def test_wrong_arguments_are_named(arguments, message):
    m = opm.examples.load("delta")
    efforts, rates = arguments
    with pytest.raises(opm.OpmError, match=message):
        m.forward_dynamics(m.home, rates, efforts)
    with pytest.raises(opm.OpmError, match="gravity"):
        m.gravity(m.home, gravity=[0, 0])


def test_natural_frequencies_are_those_of_the_equations_of_motion():
    m = opm.examples.load("delta")
    stiff = np.array([2000.0, 3000.0, 4000.0])
    names = [m.joint_names[i] for i in m.actuated]
    found = m.analyze(m.home, link_stiffness=(1e9, 1e9), joint_stiffness=dict(zip(names, stiff, strict=True)))
    jacobian, mass = m.jacobian(m.home), m.mass_matrix(m.home)
    squares = np.linalg.eigvals(np.linalg.solve(mass, jacobian.T * stiff @ jacobian))
    expected = np.sort(np.sqrt(squares.real)) / (2 * np.pi)
    np.testing.assert_allclose(found.natural_frequencies[:3], expected, rtol=1e-3)
    assert found.natural_frequency == found.natural_frequencies[0] and found.vibration_shapes.shape == (6, 6)
    assert m.analyze(m.home).natural_frequencies is None
    light = m.analyze(m.home, gravity=[0, 0, -1], density=300, link_stiffness=(1e9, 1e9)).natural_frequency
    assert light > m.analyze(m.home, gravity=[0, 0, -1], density=3000, link_stiffness=(1e9, 1e9)).natural_frequency


@pytest.mark.parametrize("name", NAMES)
def test_a_simulated_motion_is_the_one_whose_efforts_drive_it(name):
    """Efforts along a known motion, held over short times, give that motion again, the better the shorter the times are."""
    m, poses, _, _ = drawn(name, 60)
    start, size = poses[0], np.where([c.unit == "m" for c in m.task_coordinates], 0.01, 0.1)
    speed, swing = 3.0, size * np.cos(1.0 + np.arange(len(start)))

    def known(t):
        angle = speed * np.asarray(t)[..., None]
        return start + swing * np.sin(angle), speed * swing * np.cos(angle), -(speed**2) * swing * np.sin(angle)

    errors = []
    for count in (20, 40):
        times = np.linspace(0, 0.2, count + 1)
        middle = np.append(times[:-1] + 0.5 * np.diff(times), times[-1])
        efforts = m.inverse_dynamics(*known(middle))
        x, v, _ = known(times)
        found, rates = m.simulate(x[0], v[0], times, efforts)
        assert found.shape == x.shape and not np.isnan(found).any()
        errors.append(max((np.abs(found - x) / size).max(), (np.abs(rates - v) / size / speed).max()))
    assert errors[0] < 0.05 and errors[1] < 0.3 * errors[0]


def test_a_controller_is_called_at_every_time():
    m = opm.examples.load("five-bar")
    rest, calls = np.zeros(2), []

    def holding(t, pose, rates):
        calls.append(t)
        return m.inverse_dynamics(pose, rates, rest, gravity=[0, -9.81, 0])

    times = np.linspace(0, 0.5, 6)
    poses, rates = m.simulate(m.home, {}, times, holding, gravity=[0, -9.81, 0])
    assert calls == list(times[:-1])
    np.testing.assert_allclose(poses, np.tile(m.home, (6, 1)), atol=1e-9)
    same, _ = m.simulate(m.home, rest, times, holding(0, m.home, rest), gravity=[0, -9.81, 0])
    np.testing.assert_allclose(same, poses, atol=1e-12)
    # Without motors it falls, and ends where the mechanism does.
    poses, rates = m.simulate(m.home, rest, np.linspace(0, 9, 100), {}, gravity=[0, -9.81, 0], tolerance=1e-8)
    gone = np.isnan(poses).any(axis=1)
    assert not gone[0] and (gone == np.isnan(rates).all(axis=1)).all() and (np.diff(gone.astype(int)) >= 0).all()
    assert poses[1, 1] < m.home[1]


def test_wrong_arguments_of_a_simulation_are_named():
    m = opm.examples.load("delta")
    rest = np.zeros(3)
    for arguments, message in [
        ((m.home, rest, [0, 0], rest), "times do not rise"),
        ((m.home, rest, [], rest), "times"),
        ((m.home, rest, [0, np.inf], rest), "times do not rise"),
        ((m.home, [0, np.nan, 0], [0, 1], rest), "NaN is among rates"),
        (([m.home] * 2, rest, [0, 1], rest), "pose has 2 rows"),
        ((m.home, rest, [0, 1, 2], np.zeros((2, 3))), "2 rows of efforts, expected 3 as of times, or one"),
        ((m.home, rest, [0, 1], [0, 0]), "efforts has shape"),
        ((m.home, rest, [0, 1], lambda t, x, v: [0, 0]), r"efforts\(t = 0 s\) has shape"),
        ((m.home, rest, [0, 1], lambda t, x, v: [np.nan, 0, 0]), "NaN is among efforts"),
    ]:
        with pytest.raises(opm.OpmError, match=message):
            m.simulate(*arguments)
    with pytest.raises(opm.OpmError, match="tolerance is 0"):
        m.simulate(m.home, rest, [0, 1], rest, tolerance=0)
    with pytest.raises(ZeroDivisionError):
        m.simulate(m.home, rest, [0, 1], lambda t, x, v: 1 / 0)


def test_the_frequency_response_solves_the_equations_of_forced_vibrations():
    m = opm.examples.load("stewart")
    soft = {"link_stiffness": (1e7, 1e5), "joint_stiffness": {m.joint_names[i]: 2e5 for i in m.actuated}}
    found = m.analyze(m.home, **soft)
    stiff, shapes, natural = found.stiffness_matrix, found.vibration_shapes, found.natural_frequencies
    pushed = shapes @ stiff
    mass = np.einsum("ki,kj,k->ij", pushed, pushed, 1 / np.einsum("ki,ki,k->k", pushed, shapes, (2 * np.pi * natural) ** 2))
    frequencies = np.array([0, 10.0, natural[0], natural[2], 500])
    response = m.frequency_response(m.home, frequencies, loss_factor=0.05, damping_ratio=0, **soft)
    assert response.shape == (5, 6, 6) and response.dtype == complex
    for frequency, own in zip(frequencies, response, strict=True):
        forced = stiff * (1 + 0.05j) - (2 * np.pi * frequency) ** 2 * mass
        np.testing.assert_allclose(forced @ own, np.eye(6), atol=1e-6)
    # Viscous damping of one half of the loss factor is the same at a natural frequency, of its own vibration.
    viscous = m.frequency_response([m.home, m.home], [natural[0]], damping_ratio=0.025, **soft)
    assert viscous.shape == (2, 1, 6, 6)
    energies = [shapes[0] @ stiff @ own @ stiff @ shapes[0] for own in (viscous[1, 0], response[2])]
    assert energies[0] == pytest.approx(energies[1], rel=1e-6)
    assert np.isnan(m.frequency_response([9.0, 0, 0, 0, 0, 0], [1], **soft)).all()
    for wrong, message in [
        ({"damping_ratio": 0}, "one above 0"),
        ({"loss_factor": -1}, "loss_factor is -1"),
        ({"joint_stiffness": {"Q": 1.0}}, "Q"),
    ]:
        with pytest.raises(opm.OpmError, match=message):
            m.frequency_response(m.home, [1], **{**soft, **wrong})
    with pytest.raises(opm.OpmError, match="-1 is among frequencies"):
        m.frequency_response(m.home, [-1], **soft)
