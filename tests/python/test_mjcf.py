"""`opm export mjcf`, read and simulated by MuJoCo: joints have opm's values, and the loops close and stay closed."""

import itertools
import json
import random
import subprocess
import sys
from xml.etree import ElementTree

import mujoco
import numpy as np
import pinocchio
import pytest
from exported import MECHANISMS, VARIED, Mechanism, answer, run

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# Rounding of two chains of ten joints, and of the numbers that opm gives, in metres and in parts of a quaternion.
CLOSED = 1e-12
# Poses a mechanism, shared among modes that are drawn at random.
POSES, MODES = 200, 4
# A servoed motion of two seconds, and how wide a loop may open in it, in metres.
STEPS, GAP = 2000, 50e-6
GRAVITY = 9.81


class Exported(Mechanism):
    """A mechanism, its model, and what it is compared with."""

    def __init__(self, opm, folder, name):
        super().__init__(opm, folder, name)
        self.path = folder / "model.xml"
        run(opm, "export", "mjcf", self.name, "-o", self.path)
        self.model = mujoco.MjModel.from_xml_path(str(self.path))
        self.model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        reach = self.data.xpos[self.model.body("base").id + 1 :]
        self.size = float(np.ptp(np.vstack([reach, np.zeros(3)]), axis=0).max())

    def equalities(self, kind):
        return [i for i in range(self.model.neq) if self.model.eq_type[i] == kind]

    def pose_by(self, joints):
        """Sets the joints to opm's values, and moves the bodies there."""
        model, data = self.model, self.data
        data.qpos[:] = model.qpos0
        for number in range(model.njnt):
            joint = model.joint(number)
            place = joint.qposadr[0]
            if joint.type[0] == mujoco.mjtJoint.mjJNT_BALL:
                vector = np.array([joints[f"{joint.name}.{axis}"] for axis in "xyz"])
                mujoco.mju_axisAngle2Quat(
                    data.qpos[place : place + 4],
                    vector / (np.linalg.norm(vector) or 1.0),
                    np.linalg.norm(vector),
                )
            elif joint.name in joints:
                data.qpos[place] = joints[joint.name]
        for number in self.equalities(mujoco.mjtEq.mjEQ_JOINT):
            # The slide of a helical joint: y - y0 = ratio (x - x0), and one of the two is opm's.
            pair = [model.joint(i) for i in (model.eq_obj1id[number], model.eq_obj2id[number])]
            ratio = model.eq_data[number][1]
            slide = next(i for i in range(2) if pair[i].name not in joints)
            known, unknown = (pair[1 - slide].qposadr[0], pair[slide].qposadr[0])
            moved = data.qpos[known] - model.qpos0[known]
            moved *= ratio if slide == 0 else 1 / ratio
            data.qpos[unknown] = model.qpos0[unknown] + moved
        mujoco.mj_kinematics(model, data)

    def gaps(self):
        """How far the ends of the legs are from the platform, in metres and in parts of a quaternion."""
        data, model = self.data, self.model
        gaps = []
        for number in self.equalities(mujoco.mjtEq.mjEQ_WELD):
            a, b = model.eq_obj1id[number], model.eq_obj2id[number]
            turned = min(np.abs(data.xquat[a] - sign * data.xquat[b]).max() for sign in (1, -1))
            gaps.append((np.linalg.norm(data.xpos[a] - data.xpos[b]), turned))
        assert len(gaps) == len(self.answer["legs"]) - 1
        return np.max(gaps, axis=0)


@pytest.fixture(scope="module", params=[*MECHANISMS, *VARIED])
def exported(opm, tmp_path_factory, request):
    return Exported(opm, tmp_path_factory.mktemp("mjcf"), request.param)


def test_the_loops_close_at_poses_of_every_mode(exported):
    generator = random.Random(str(exported.answer["name"]))
    names = [exported.model.key(i).name for i in range(exported.model.nkey)]
    keys = [key.removesuffix("_out_of_limits").removesuffix("_loose") for key in generator.choices(names, k=MODES)]
    letters = str.maketrans("pm", "+-", "_")
    modes = [key if key == "home" else key.translate(letters) for key in keys]
    rows = exported.poses(generator, POSES, modes)
    assert len(rows) >= POSES
    worst = np.zeros(2)
    for row in rows:
        exported.pose_by(row)
        worst = np.maximum(worst, exported.gaps())
    assert worst.max() < CLOSED, worst


def test_every_mode_at_home_is_a_keyframe(exported):
    model, data = exported.model, exported.data
    names = [model.key(i).name for i in range(model.nkey)]
    mujoco.mj_resetData(model, data)
    mujoco.mj_kinematics(model, data)
    home = data.body("platform").xpos.copy()
    for number in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, number)
        mujoco.mj_kinematics(model, data)
        assert max(exported.gaps()) < CLOSED
        for servo in range(model.nu):
            joint = model.actuator_trnid[servo][0]
            assert data.ctrl[servo] == data.qpos[model.jnt_qposadr[joint]]
        if not exported.is_linkage:
            assert np.abs(data.body("platform").xpos - home).max() < CLOSED
    if exported.is_linkage:
        found = answer(exported.opm, "linkage", exported.name)["solutions"]
        modes = [(solution["branch"], solution["within_limits"]) for solution in found]
    else:
        pose = ",".join(f"{name}={value!r}" for name, value, _ in exported.spans(0, 0))
        found = answer(exported.opm, "ik", exported.name, "--pose", pose, "--all-modes")["solutions"]
        modes = [(solution["mode"], solution["within_limits"]) for solution in found]
    letters = str.maketrans("+- ", "pm_")
    expected = [
        (signs.translate(letters) or "home") + ("" if within else "_out_of_limits")
        for signs, within in modes
    ]
    if len(modes) > 256:
        # Of a hexapod's thousands of modes, that of home is a keyframe.
        home = answer(exported.opm, "ik", exported.name, "--pose", pose)["solutions"][0]["mode"]
        expected = [name for name, (signs, _) in zip(expected, modes) if signs == home]
    assert [name.replace("_loose", "") for name in names] == expected


def test_a_mode_is_loose_where_held_motors_leave_a_motion(exported):
    if exported.is_linkage:
        pytest.skip("a linkage is moved by its input")
    model, data = exported.model, exported.data
    servos = np.zeros((model.nu, model.nv))
    for servo in range(model.nu):
        servos[servo, model.jnt_dofadr[model.actuator_trnid[servo][0]]] = 1.0
    for number in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, number)
        mujoco.mj_forward(model, data)
        rows = data.efc_J.reshape(-1, model.nv)
        equalities = rows[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
        # Rods that spin between two balls do so with the motors held, too.
        spins = max(0, exported.answer["mobility"] - model.nu)
        least = np.linalg.svd(np.vstack([equalities, servos]), compute_uv=False)[model.nv - 1 - spins]
        assert ("_loose" in model.key(number).name) == (least < 1e-9), least


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
        assert found["reachable"], pose
        exported.pose_by(found["solutions"][0]["joints"])
        mujoco.mj_comPos(exported.model, exported.data)
        mujoco.mj_sensorPos(exported.model, exported.data)
        place = exported.data.sensor("platform.position").data
        turned = exported.data.sensor("platform.orientation").data
        expected = found["transform"]
        assert np.abs(place - expected["position"]).max() < CLOSED
        quaternion = np.array(expected["quaternion"])
        assert min(np.abs(turned - s * quaternion).max() for s in (1, -1)) < CLOSED


def test_the_constraints_leave_the_mobility(exported):
    model, data = exported.model, exported.data
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    rows = data.efc_J.reshape(-1, model.nv)[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]
    values = np.linalg.svd(rows, compute_uv=False)
    rank = int((values > 1e-9 * values[0]).sum())
    # The values that count are far from those that are rounding.
    assert values[rank - 1] > 1e-5 * values[0]
    assert model.nv - rank == exported.answer["mobility"]


def test_masses_are_those_of_the_shapes(exported):
    """MuJoCo computes them from the shapes where they are not given."""
    model = exported.model
    other = exported.folder / "shapes.xml"
    # The ends of the legs have no shapes: each has its share of the platform.
    ends = [model.body(model.eq_obj2id[i]).name for i in exported.equalities(mujoco.mjtEq.mjEQ_WELD)]
    whole = ElementTree.fromstring(exported.path.read_text())
    for body in whole.iter("body"):
        for inertial in body.findall("inertial"):
            if body.get("name") not in ends:
                body.remove(inertial)
    other.write_text(ElementTree.tostring(whole, encoding="unicode"))
    shapes = mujoco.MjModel.from_xml_path(str(other))
    data, compared = mujoco.MjData(model), mujoco.MjData(shapes)
    for one, at in ((model, data), (shapes, compared)):
        mujoco.mj_kinematics(one, at)
    for number in range(model.body("base").id + 1, model.nbody):
        name = model.body(number).name
        share = 1 / (len(ends) + 1) if name in [*ends, "platform"] else 1
        original = shapes.body("platform" if name in ends else name).id
        mass = share * shapes.body_mass[original]
        tensors = [
            at.ximat[i].reshape(3, 3) @ np.diag(one.body_inertia[i]) @ at.ximat[i].reshape(3, 3).T
            for one, at, i in ((model, data, number), (shapes, compared, original))
        ]
        assert model.body_mass[number] == pytest.approx(mass, rel=1e-9)
        assert np.abs(data.xipos[number] - compared.xipos[original]).max() < 1e-9
        assert np.abs(tensors[0] - share * tensors[1]).max() < 1e-9 * np.abs(tensors[0]).max()


def test_servos_move_it_and_it_stays_together(exported):
    model, data = exported.model, exported.data
    actuated = [model.actuator(i).name for i in range(model.nu)]
    if exported.is_linkage:
        joint = model.joint(actuated[0])
        home, times = float(model.qpos0[joint.qposadr[0]]), np.arange(STEPS + 1) * 1e-3
        rows = [{actuated[0]: home + 0.1 * (1 - np.cos(np.pi * t))} for t in times]
    else:
        rows = exported.motion(2, 1000, exported.at_rest(2))
    assert len(rows) == STEPS + 1
    mujoco.mj_resetData(model, data)
    worst = np.zeros(2)
    lag = np.zeros(model.nu)
    for row in rows[:-1]:
        data.ctrl[:] = [row[name] for name in actuated]
        mujoco.mj_step(model, data)
        worst = np.maximum(worst, exported.gaps())
        reached = np.array([data.joint(name).qpos[0] for name in actuated])
        lag = np.maximum(lag, np.abs(reached - data.ctrl))
    assert worst[0] < GAP, worst
    # What the damper takes at the highest rate, and what the spring gives way where it carries all that moves, a hinge
    # on an arm as long as the mechanism.
    steps = np.abs(np.diff([[row[name] for name in actuated] for row in rows], axis=0))
    stiffness, damping = model.actuator_gainprm[:, 0], -model.actuator_biasprm[:, 2]
    hinges = model.jnt_type[model.actuator_trnid[:, 0]] == mujoco.mjtJoint.mjJNT_HINGE
    weight = GRAVITY * model.body_subtreemass[model.body("base").id]
    sag = weight * np.where(hinges, exported.size, 1.0)
    allowed = (damping * steps.max(axis=0) / model.opt.timestep + sag) / stiffness
    assert (lag < allowed).all(), (lag, allowed)


def scaled(opm, name, factor):
    """A mechanism as a list of joints, with all lengths in metres and times a factor."""
    read = tomllib.loads(run(opm, "convert", name, "--joints"))
    metre = factor * {"m": 1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}[read["units"]["length"]]

    def point(values):
        return [metre * value for value in values]

    def joint(of):
        keys = {key: json.dumps(value) for key, value in of.items()}
        keys["point"] = json.dumps(point(of["point"]))
        if "pitch" in of:
            keys["pitch"] = repr(metre * of["pitch"])
        if of["type"] == "prismatic":
            keys["home"] = repr(metre * of.get("home", 0))
            keys.pop("limits", None)
        return "{ " + ", ".join(f"{key} = {value}" for key, value in keys.items()) + " }"

    text = f'format = 1\nname = "scaled"\nunits = {{ length = "m", angle = "{read["units"]["angle"]}" }}\n'
    text += f"[platform]\npoint = {point(read['platform']['point'])}\n"
    for leg in read["leg"]:
        text += f'[[leg]]\nname = "{leg["name"]}"\njoints = [{", ".join(map(joint, leg["joints"]))}]\n'
    return text


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        *itertools.product(["planar-3rrr", "plano-spherical-5dof", "planar-planar-5dof"], [1e-6, 1e-3, 1, 1e3]),
        # The slides of screws of nanometres are too small for MuJoCo.
        *itertools.product(["schoenflies-lift-4dof"], [1e-3, 1, 1e3]),
    ],
)
def test_servos_reach_what_they_are_told_at_every_size(opm, tmp_path, name, factor):
    """From a mechanism of a micrometre to one of a kilometre; the other servos hold."""
    (tmp_path / "scaled.toml").write_text(scaled(opm, name, factor))
    path = tmp_path / "scaled.xml"
    run(opm, "export", "mjcf", tmp_path / "scaled.toml", "-o", path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    places = model.jnt_qposadr[model.actuator_trnid[:, 0]]
    hinges = model.jnt_type[model.actuator_trnid[:, 0]] == mujoco.mjtJoint.mjJNT_HINGE
    unit = np.where(hinges, 1.0, 0.3 * factor)
    home = model.qpos0[places]
    told = home.copy()
    told[0] += 0.02 * unit[0]
    data.ctrl[:] = told
    for _ in range(1000):
        mujoco.mj_step(model, data)
    # Under gravity, servos of 20 Hz give way by less than a millimetre, as all that moves would.
    sag = 0.0 if "gravcomp" in path.read_text() else 1e-3 / factor
    off = np.abs(data.qpos[places] - told) / unit
    assert off.max() < 1e-4 * 0.02 + sag, off
    assert not any(warning.number for warning in data.warning)
    for number in range(model.neq):
        if model.eq_type[number] == mujoco.mjtEq.mjEQ_WELD:
            a, b = data.xpos[model.eq_obj1id[number]], data.xpos[model.eq_obj2id[number]]
            assert np.linalg.norm(a - b) < 1e-6 * factor
    assert ("in units of" in path.read_text()) == (factor != 1)


def test_a_reference_is_followed(exported):
    """The table beside the model moves it along the motion, whose rows `opm trajectory` gives, and it stays together."""
    if exported.is_linkage:
        pytest.skip("a linkage has no pose to move")
    moves = exported.at_rest(2)
    expected = exported.motion(2, 1000, moves)
    path = exported.folder / "moved.xml"
    run(exported.opm, "export", "mjcf", exported.name, "-o", path, "--trajectory", exported.folder / "motion.toml")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    header = path.with_suffix(".csv").read_text().split("\n", 1)[0].split(",")
    table = np.loadtxt(path.with_suffix(".csv"), delimiter=",", skiprows=1)
    reference, controls = table[:, 1 : 1 + model.nq], table[:, 1 + model.nq :]
    assert table.shape == (STEPS + 1, 1 + model.nq + model.nu)
    assert header[0] == "time" and header[1 + model.nq :] == [f"ctrl.{model.actuator(i).name}" for i in range(model.nu)]
    assert np.abs(table[:, 0] - [row["t"] for row in expected]).max() < 1e-12
    # The rows are the postures that opm gives.
    for row, joints in zip(reference[::100], expected[::100], strict=True):
        exported.pose_by(joints)
        apart = [min(np.abs(a - b), np.abs(a + b)) for a, b in zip(row, exported.data.qpos, strict=True)]
        assert max(apart) < CLOSED
    # Without gravity, a servo that carries all that moves, and its motor, is off by acceleration over stiffness.
    model.opt.gravity[:] = 0
    mujoco.mj_resetDataKeyframe(model, data, model.key("motion").id)
    assert np.abs(data.qpos - reference[0]).max() < CLOSED
    exported_data, exported.data = exported.data, data
    worst, off, lag = np.zeros(2), np.zeros(model.nu), np.zeros(model.nu)
    places = model.jnt_qposadr[model.actuator_trnid[:, 0]]
    for row, control in zip(reference, controls, strict=True):
        off = np.maximum(off, np.abs(data.qpos[places] - row[places]))
        lag = np.maximum(lag, np.abs(control - row[places]))
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
        worst = np.maximum(worst, exported.gaps())
    exported.data = exported_data
    assert worst[0] < GAP, worst
    # By far less than the lag of servos that are told the values alone.
    assert (off < 0.25 * lag.max()).all(), (off, lag)


def test_masses_of_the_file_are_taken(exported, tmp_path):
    answer = exported.answer
    first, *_ = [joint["name"] for joint in answer["joints"] if joint["leg"] == answer["legs"][0]["name"]]
    text = run(exported.opm, "convert", exported.name, "--joints")
    path, model = tmp_path / "heavy.toml", tmp_path / "heavy.xml"
    path.write_text(f'{text}\n[bodies]\ndensity = 1350\nmasses = {{ platform = 0.75, "{first}" = 0.125 }}\n')
    run(exported.opm, "export", "mjcf", path, "-o", model)
    heavy = mujoco.MjModel.from_xml_path(str(model))
    ends = [heavy.eq_obj2id[i] for i in range(heavy.neq) if heavy.eq_type[i] == mujoco.mjtEq.mjEQ_WELD]
    platform = [heavy.body("platform").id, *ends]
    assert heavy.body_mass[platform].sum() == pytest.approx(0.75, rel=1e-12)
    for number in set(range(heavy.body("base").id + 1, heavy.nbody)) - set(platform):
        name = heavy.body(number).name
        named = name == f"{answer['legs'][0]['name']}.{first}"
        expected = 0.125 if named else 0.5 * exported.model.body_mass[number]
        assert heavy.body_mass[number] == pytest.approx(expected, rel=1e-12), name


def test_pinocchio_moves_the_bodies_to_the_same_places(exported):
    if exported.varied:
        pytest.skip("Pinocchio 4.1 has no reference values for the joints of a body that has several")
    model, data = exported.model, exported.data
    read = pinocchio.buildModelFromMJCF(str(exported.path))
    place = read.createData()
    moving = range(model.body("base").id + 1, model.nbody)
    mass = sum(inertia.mass for inertia in read.inertias)
    assert mass == pytest.approx(sum(model.body_mass[i] for i in moving), rel=1e-12)
    for number in range(model.nkey):
        posture = read.referenceConfigurations[model.key(number).name]
        pinocchio.framesForwardKinematics(read, place, posture)
        mujoco.mj_resetDataKeyframe(model, data, number)
        mujoco.mj_kinematics(model, data)
        for body in moving:
            frame = place.oMf[read.getFrameId(model.body(body).name, pinocchio.BODY)]
            assert np.abs(frame.translation - data.xpos[body]).max() < CLOSED
            assert np.abs(frame.rotation.ravel() - data.xmat[body]).max() < CLOSED
