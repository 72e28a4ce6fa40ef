"""What viser is told to show. A stand-in for viser takes it, because viser is no requirement of the tests."""

import sys
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import opm_kinematics as opm
import pytest


def matrix_of(wxyz):
    """The rotation of a unit quaternion."""
    w, v = wxyz[0], np.asarray(wxyz[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def wxyz_of(matrix):
    """A unit quaternion of a rotation: the null vector of the rest."""
    best, sign = max(((np.trace(matrix) + 1, 0), *((1 - np.trace(matrix) + 2 * matrix[i, i], i + 1) for i in range(3))))
    axis = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    if sign == 0:
        return np.array([best, *axis]) / (2 * np.sqrt(best))
    i = sign - 1
    rest = [matrix[j, i] + matrix[i, j] for j in range(3)]
    rest[i] = best
    return np.array([axis[i], *rest]) / (2 * np.sqrt(best))


class Shown:
    """The server: every node of the scene, and every control, by its name."""

    def __init__(self, **options):
        self.options, self.nodes, self.controls = options, {}, {}
        self.scene = self.gui = self

    def atomic(self):
        return nullcontext()

    def set_up_direction(self, direction):
        assert direction == "+z"

    def __getattr__(self, name):
        kind = name.removeprefix("add_")
        table = self.controls if kind in ("checkbox", "slider", "text") else self.nodes

        def add(label, **options):
            node = SimpleNamespace(kind=kind, updates=[], value=options.get("initial_value"), **options)
            node.on_update = lambda then: node.updates.append(then) or then
            table[label] = node
            return node

        return add


@pytest.fixture(autouse=True)
def viser(monkeypatch):
    so3 = SimpleNamespace(from_matrix=lambda matrix: SimpleNamespace(wxyz=wxyz_of(matrix)))
    module = SimpleNamespace(ViserServer=Shown, transforms=SimpleNamespace(SO3=so3))
    monkeypatch.setitem(sys.modules, "viser", module)


def assert_at(server, frames):
    for name, matrix in frames.items():
        node = server.nodes[f"/{name}"]
        np.testing.assert_allclose(matrix_of(node.wxyz), matrix[:3, :3], atol=1e-12)
        np.testing.assert_allclose(node.position, matrix[:3, 3], atol=1e-12)


@pytest.mark.parametrize("name", ["plano-spherical-5dof", "delta", "stewart"])
def test_links_stand_where_they_are(name):
    m = opm.examples.load(name)
    pose = np.array(m.home) + 0.01
    server = m.show(pose)
    assert_at(server, m.link_frames(pose))
    # Rods stand between the ends that the solids have in this pose.
    rods = [solid for solid in m.solids(pose) if solid.shape == "cylinder"]
    nodes = {label: node for label, node in server.nodes.items() if node.kind == "cylinder"}
    assert len(rods) == len(nodes)
    for solid, (label, node) in zip(rods, nodes.items(), strict=True):
        body = server.nodes[label.rpartition("/")[0]]
        assert label.startswith(f"/{solid.body}/")
        turned = matrix_of(body.wxyz)
        half = node.height / 2 * matrix_of(node.wxyz)[:, 2]
        ends = [body.position + turned @ (node.position + sign * half) for sign in (-1, 1)]
        np.testing.assert_allclose(ends, solid.ends, atol=1e-9)
        assert node.radius == solid.width / 2
    assert set(server.controls) == {"frames"}
    server.controls["frames"].value = True
    server.controls["frames"].updates[0](None)
    assert all(server.nodes[f"/{link}"].show_axes for link in m.link_frames())


def test_poses_are_chosen_by_a_slider():
    m = opm.examples.load("delta")
    poses = np.array(m.home) + np.array([[0, 0, 0], [0.02, 0, 0], [9, 0, 0]])
    server = m.show(poses, rate=5)
    slider = server.controls["pose"]
    assert (slider.min, slider.max) == (0, 2)
    for number, shown, told in [(1, 1, "0.200 s"), (2, 1, "0.400 s: out of reach"), (0, 0, "0.000 s")]:
        slider.value = number
        slider.updates[0](None)
        assert_at(server, {name: frame[shown] for name, frame in m.link_frames(poses).items()})
        assert server.controls["time"].value == told


def test_a_motion_has_its_own_times():
    m = opm.examples.load("plano-spherical-5dof")
    for motion in ("plano-spherical-sinusoids", opm.trajectory(m, "plano-spherical-sinusoids", rate=10)):
        server = m.show(motion)
        slider = server.controls["pose"]
        slider.value = slider.max
        slider.updates[0](None)
        assert server.controls["time"].value == "10.000 s"


def test_what_cannot_be_shown_is_refused(monkeypatch):
    m = opm.examples.load("delta")
    with pytest.raises(opm.OpmError, match="1 poses, none of them in reach"):
        m.show([9.0, 0, 0])
    with pytest.raises(opm.OpmError, match="rate is 0.0, expected"):
        m.show(rate=0.0)
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(ImportError, match=r"m.show\(\) needs viser: pip install viser"):
        m.show()
