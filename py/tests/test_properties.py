"""Properties of any pose and any grid: forward kinematics finds it again, a mask is what inverse kinematics says."""

import numpy as np
import opm_kinematics as opm
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shipped import LINKAGES

NAMES = [n for n in opm.examples.names() if n not in LINKAGES]
MANIPULATORS = {name: opm.examples.load(name) for name in NAMES}
# Without a closed form, or with a screw that counts turns (found to a whole turn).
FORWARD = [
    n
    for n in NAMES
    if n not in ("translational-planar-4dof", "schoenflies-4dof")
    and MANIPULATORS[n].decomposition.legs[0].solved == "sections"
]


def poses(m, part):
    """Poses about home, within a share of a tenth of a metre and a radian."""
    widths = [0.1 if c.unit == "m" else 1.0 for c in m.task_coordinates]
    offsets = st.tuples(*[st.floats(-part * w, part * w) for w in widths])
    return offsets.map(lambda offset: np.array(m.home) + offset)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_forward_finds_what_inverse_came_from(data):
    m = MANIPULATORS[data.draw(st.sampled_from(FORWARD))]
    mode = data.draw(st.sampled_from(m.modes[:64]))
    pose = data.draw(poses(m, 0.3))
    solutions = m.inverse([pose], mode=mode)
    assume(solutions.reachable[0])
    near = m.singularity([pose], mode=mode)
    # Near a singularity a pose has rounding's own say; on one there are families of poses.
    assume(min(abs(near.serial[0]), abs(near.parallel[0]), abs(near.coordinates[0])) > 1e-2)
    (assemblies,) = m.forward(solutions.joints[:, m.actuated])
    angle = np.array([c.unit == "rad" for c in m.task_coordinates])
    gaps = []
    for assembly in assemblies:
        gap = assembly.pose - pose
        gaps.append(np.abs(gap - angle * 2 * np.pi * np.round(gap / (2 * np.pi))).max())
        back = m.inverse([assembly.pose], mode=assembly.mode).joints[0]
        same = (back - assembly.joints)[m.actuated]
        assert np.abs(np.sin(same / 2)).max() < 1e-8
    assert min(gaps) < 1e-6


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_mask_is_inverse_kinematics(data):
    m = MANIPULATORS[data.draw(st.sampled_from(NAMES))]
    mode = data.draw(st.sampled_from(["home", "any", *m.modes[:8]]))
    axes = {}
    for c in m.task_coordinates:
        width = 0.5 if c.unit == "m" else 3.0
        low, high = sorted(c.home + data.draw(st.floats(-width, width)) for _ in range(2))
        axes[c.name] = (low, high, data.draw(st.integers(2, 7))) if high - low > 1e-3 else low
    swept = opm.sweep(m, mode=mode, **axes)
    grid = np.stack([a.ravel() for a in np.meshgrid(*swept.axes.values(), indexing="ij")], axis=1)
    found = m.inverse(grid, mode="all" if mode == "any" else mode).within_limits
    expected = found.any(axis=1) if mode == "any" else found
    np.testing.assert_array_equal(swept.mask().ravel(), expected)
    assert swept.count == expected.sum() == len(swept.points())


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_coordinates_of_several_poses_do_not_mix(data):
    """A row's answer is its own: any order, any neighbours, any number of them."""
    m = MANIPULATORS[data.draw(st.sampled_from(NAMES))]
    rows = np.array(data.draw(st.lists(poses(m, 1.0), min_size=1, max_size=9)))
    order = np.array(data.draw(st.permutations(range(len(rows)))))
    whole, shuffled, single = m.inverse(rows), m.inverse(rows[order]), m.inverse(rows[:1])
    np.testing.assert_array_equal(shuffled.joints, whole.joints[order])
    np.testing.assert_array_equal(single.joints, whole.joints[:1])
