"""`opm export urdf`, read by Pinocchio: joints have opm's values, and the closures close and leave the mobility."""

import random

import numpy as np
import pinocchio
import pytest
import yaml
from exported import MECHANISMS, VARIED, Mechanism, answer, run

# Rounding of two chains of ten joints, of the angles of frames, and of the numbers that opm gives; metres and parts of a
# rotation matrix.
CLOSED = 1e-12
# Poses a mechanism, shared among modes that are drawn at random.
POSES, MODES = 200, 4
LETTERS = str.maketrans("pm", "+-", "_")


class Exported(Mechanism):
    """A mechanism, its tree of links, and its closures, as Gepetto's loaders make them."""

    def __init__(self, opm, folder, name):
        super().__init__(opm, folder, name)
        self.path = folder / "model.urdf"
        run(opm, "export", "urdf", self.name, "-o", self.path)
        self.model = pinocchio.buildModelFromUrdf(str(self.path), mimic=True)
        self.data = self.model.createData()
        self.yaml = yaml.safe_load((folder / "model.yaml").read_text())
        self.pairs = [[self.model.getFrameId(name) for name in pair] for pair in self.yaml["closed_loop"]]
        self.balls = [joint["name"] for joint in self.answer["joints"] if joint["type"] == "spherical"]

    def configuration(self, joints):
        """Pinocchio's coordinates for opm's joint values."""
        values = dict(joints)
        for ball in self.balls:
            vector = np.array([joints[f"{ball}.{axis}"] for axis in "xyz"])
            r = pinocchio.exp3(vector)
            # R = Rx(a) Ry(b) Rz(c).
            b = np.arctan2(r[0, 2], np.hypot(r[0, 0], r[0, 1]))
            values[f"{ball}.1"], values[f"{ball}.2"] = np.arctan2(-r[1, 2], r[2, 2]), b
            values[f"{ball}.3"] = np.arctan2(-r[0, 1], r[0, 0])
        q = pinocchio.neutral(self.model)
        for number in range(1, self.model.njoints):
            joint, name = self.model.joints[number], self.model.names[number]
            if joint.nq == 2:
                q[joint.idx_q : joint.idx_q + 2] = np.cos(values[name]), np.sin(values[name])
            elif joint.nq == 1 and name in values:
                q[joint.idx_q] = values[name]
        return q

    def gap(self, joints):
        """How far the ends of the legs are from the platform, in metres and in parts of a matrix."""
        pinocchio.framesForwardKinematics(self.model, self.data, self.configuration(joints))
        ends = [[self.data.oMf[frame].homogeneous for frame in pair] for pair in self.pairs]
        return max(np.abs(one - other).max() for one, other in ends)

    def home(self):
        values = {}
        for joint in self.answer["joints"]:
            several = joint["home"] if isinstance(joint["home"], list) else [joint["home"]]
            values.update(zip(joint["coordinates"], several, strict=True))
        return values


@pytest.fixture(scope="module", params=[*MECHANISMS, *VARIED])
def exported(opm, tmp_path_factory, request):
    return Exported(opm, tmp_path_factory.mktemp("urdf"), request.param)


def test_the_loops_close_at_poses_of_every_mode(exported):
    generator = random.Random(str(exported.answer["name"]))
    modes = ["home"] * MODES
    if not exported.is_linkage:
        found = answer(exported.opm, "ik", exported.name, "--pose", home(exported), "--all-modes")["solutions"]
        modes = [generator.choice(found)["mode"] or "home" for _ in modes]
    rows = exported.poses(generator, POSES, modes)
    assert len(rows) >= POSES
    assert len(exported.pairs) == len(exported.answer["legs"]) - 1
    worst = max(exported.gap(row) for row in rows)
    assert worst < CLOSED, worst


def home(exported):
    return ",".join(f"{name}={value!r}" for name, value, _ in exported.spans(0, 0))


def test_the_platform_is_where_opm_says(exported):
    if exported.is_linkage:
        pytest.skip("a linkage has no pose")
    generator = random.Random(str(exported.answer["name"]))
    for _ in range(3):
        pose = ",".join(
            f"{name}={home + generator.uniform(-1, 1) * span!r}"
            for name, home, span in exported.spans(angle=0.2, length=0.03)
        )
        found = answer(exported.opm, "ik", exported.name, "--pose", pose)
        exported.gap(found["solutions"][0]["joints"])
        frame = exported.data.oMf[exported.model.getFrameId("platform")]
        expected = found["transform"]
        w, x, y, z = expected["quaternion"]
        assert np.abs(frame.translation - expected["position"]).max() < CLOSED
        # The frame is parallel to the base's at home, where `transform` has the Euler angles of home: zero here.
        assert np.abs(frame.rotation - pinocchio.Quaternion(w, x, y, z).matrix()).max() < CLOSED


def test_the_closures_leave_the_mobility(exported):
    model, data = exported.model, exported.data
    q = exported.configuration(exported.home())
    pinocchio.computeJointJacobians(model, data, q)
    pinocchio.updateFramePlacements(model, data)
    rows = []
    for pair in exported.pairs:
        # The frames coincide, so that their twists can be compared in either.
        one, other = (pinocchio.computeFrameJacobian(model, data, q, frame, pinocchio.LOCAL) for frame in pair)
        rows.append(one - other)
    values = np.linalg.svd(np.vstack(rows), compute_uv=False)
    rank = int((values > 1e-9 * values[0]).sum())
    # The values that count are far from those that are rounding.
    assert values[rank - 1] > 1e-5 * values[0]
    assert model.nv - rank == exported.answer["mobility"]


def test_pinocchio_closes_the_loops_with_the_frames_of_the_loaders(exported):
    """Its own constraints are what the loaders make of each pair; they take no joint that follows another one."""
    model = pinocchio.buildModelFromUrdf(str(exported.path))
    if model.nq != exported.model.nq:
        pytest.skip("Pinocchio 4.1 has no constraints for a model with a joint that follows another one")
    assert exported.yaml["type"] == ["6d"] * len(exported.pairs)
    data = model.createData()
    constraints = []
    for pair in exported.pairs:
        one, other = (model.frames[frame] for frame in pair)
        constraints.append(
            pinocchio.RigidConstraintModel(
                pinocchio.ContactType.CONTACT_6D,
                model,
                one.parentJoint,
                one.placement,
                other.parentJoint,
                other.placement,
            )
        )
    pinocchio.computeJointJacobians(model, data, exported.configuration(exported.home()))
    datas = [constraint.createData() for constraint in constraints]
    rows = [pinocchio.getConstraintJacobian(model, data, *both) for both in zip(constraints, datas, strict=True)]
    values = np.linalg.svd(np.vstack(rows), compute_uv=False)
    assert model.nv - int((values > 1e-9 * values[0]).sum()) == exported.answer["mobility"]


def test_motors_and_limits_are_those_of_opm(exported):
    model = exported.model
    actuated = [joint for joint in exported.answer["joints"] if joint["actuated"]]
    expected = [
        f"{joint['name']}.{i + 1}" if joint["type"] == "spherical" else name
        for joint in actuated
        for i, name in enumerate(joint["coordinates"])
    ]
    assert exported.yaml["name_mot"] == expected
    for joint in exported.answer["joints"]:
        if len(joint["coordinates"]) > 1 or joint["limits"] is None:
            continue
        number = model.joints[model.getJointId(joint["name"])].idx_q
        limits = model.lowerPositionLimit[number], model.upperPositionLimit[number]
        assert limits == pytest.approx(joint["limits"], rel=1e-15)


def test_masses_are_those_of_the_other_format(exported, tmp_path):
    path = tmp_path / "model.xml"
    run(exported.opm, "export", "mjcf", exported.name, "-o", path, "--density", "1200")
    other = pinocchio.buildModelFromMJCF(str(path))
    run(exported.opm, "export", "urdf", exported.name, "-o", tmp_path / "model.urdf", "--density", "1200")
    model = pinocchio.buildModelFromUrdf(str(tmp_path / "model.urdf"))
    masses = [sum(inertia.mass for inertia in one.inertias) for one in (model, other)]
    assert masses[0] == pytest.approx(masses[1], rel=1e-12)
