"""`opm trajectory` recordings, decoded with public decoders: moving bodies stay connected."""

import csv
import json
import subprocess

import check_recording
import numpy as np
import pytest
from conftest import LINKAGES
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

START = 1  # nanoseconds: as good as zero, which viewers take for unset
# Tolerance as a share of the mechanism's size, far above the rounding of a leg's product of exponentials.
TOGETHER = 1e-9

MOTIONS = {
    "plano-spherical-5dof": "plano-spherical-sinusoids",
    "plano-spherical-5dof-joints": "plano-spherical-sinusoids",
    "translational-helical-3dof": "translational-helical-sinusoids",
    "translational-helical-3dof-joints": "translational-helical-sinusoids",
}


def matrix(position, orientation):
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    assert abs(x * x + y * y + z * z + w * w - 1) < 1e-12
    transform = np.eye(4)
    transform[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    transform[:3, 3] = position.x, position.y, position.z
    return transform


class Recorded:
    """Everything in a recording, by topic."""

    def __init__(self, path):
        check_recording.doctor(path)
        self.topics, self.metadata, last = {}, {}, 0
        with open(path, "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            decoded = reader.iter_decoded_messages(log_time_order=False)
            for schema, channel, record, message in decoded:
                assert schema.name == message.DESCRIPTOR.full_name
                assert last <= record.log_time, f"{channel.topic}: time goes back"
                last = record.log_time
                self.topics.setdefault(channel.topic, []).append((record.log_time, message))
            for record in reader.iter_metadata():
                self.metadata[record.name] = record.metadata
            self.attachments = {a.name: a.data for a in reader.iter_attachments()}

    def flat(self, topic):
        """The times, and one column per field."""
        messages = self.topics[topic]
        names = [field.name for field in messages[0][1].DESCRIPTOR.fields]
        columns = {name: np.array([getattr(m, name) for _, m in messages]) for name in names}
        return np.array([time for time, _ in messages]), columns

    def frames(self):
        """For every message of /tf, the transform of each frame to the base."""
        for time, message in self.topics["/tf"]:
            absolute = {"base": np.eye(4)}
            for one in message.transforms:
                stamp = one.timestamp.seconds * 1_000_000_000 + one.timestamp.nanos
                assert stamp == time
                assert one.child_frame_id not in absolute, "a frame has two places"
                # Parents come first, so there is no cycle, and every frame descends from the base.
                parent = absolute[one.parent_frame_id]
                absolute[one.child_frame_id] = parent @ matrix(one.translation, one.rotation)
            yield absolute

    def scene(self):
        (time, scene), *_ = self.topics["/scene"]
        assert time == START
        return scene


@pytest.fixture(scope="module")
def record(opm, tmp_path_factory):
    """Records a motion of a shipped mechanism."""

    def motion_of(mechanism, folder):
        if mechanism in MOTIONS:
            return MOTIONS[mechanism]
        command = [opm, "decompose", mechanism, "--format", "json"]
        found = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
        lines = ["format = 1", 'name = "around home"', "duration = 4", "rate = 25"]
        lines += ['units = { length = "m", angle = "rad" }', "[coordinates]"]
        for i, c in enumerate(found["task_coordinates"]):
            amplitude = 0.02 if c["unit"] == "m" else 0.15
            sinusoid = f"amplitude = {amplitude}, frequency = {0.25 * (1 + i % 2)}"
            lines.append(f"{c['name']} = {{ {sinusoid}, offset = {c['home']!r}, phase = {i} }}")
        path = folder / "motion.toml"
        path.write_text("\n".join(lines))
        return path

    def run(mechanism, *arguments):
        folder = tmp_path_factory.mktemp("trajectory")
        path = folder / "play.mcap"
        if mechanism in LINKAGES:
            command = [opm, "linkage", mechanism, "--sweep", "--count", "101"]
        else:
            motion = arguments[0] if arguments else motion_of(mechanism, folder)
            command = [opm, "trajectory", mechanism, "--motion", motion, *arguments[1:]]
        subprocess.run([*command, "-o", path], check=True, capture_output=True)
        return path

    return run


def mechanisms():
    from conftest import REPOSITORY

    return sorted(path.stem for path in (REPOSITORY / "crates/opm-core/mechanisms").glob("*.toml"))


def distance(kind, one, other, size):
    """The distance between a joint's poses in its two bodies, as a share of the mechanism's size."""
    (c1, a1, r1), (c2, a2, r2) = one, other
    offset, turned = c2 - c1, np.linalg.norm(np.cross(a1, a2))
    if kind == "turn":
        return np.linalg.norm(offset) / size + turned
    if kind == "slide":  # the centres are on the common axis
        return np.linalg.norm(np.cross(offset, a1)) / size + turned
    if kind == "ball":
        return np.linalg.norm(offset) / size
    assert kind == "weld"
    return np.linalg.norm(offset) / size + np.abs(r1 - r2).max()


@pytest.mark.parametrize("mechanism", mechanisms())
def test_link_ends_coincide_at_every_frame(record, mechanism):
    recorded = Recorded(record(mechanism))
    scene = recorded.scene()
    seats, ends = {}, {}
    for entity in scene.entities:
        assert entity.frame_id == entity.id and entity.frame_locked
        points = []
        for cylinder in entity.cylinders:
            assert (cylinder.bottom_scale, cylinder.top_scale) == (1, 1)
            assert cylinder.size.x == cylinder.size.y > 0
            place = matrix(cylinder.pose.position, cylinder.pose.orientation)
            points += [place[:3, 3] + k * cylinder.size.z * place[:3, 2] for k in (-0.5, 0, 0.5)]
        for solid in [*entity.spheres, *entity.cubes]:
            points.append(matrix(solid.pose.position, solid.pose.orientation)[:3, 3])
        ends[entity.frame_id] = np.array(points)
        for note in entity.metadata:
            kind, *numbers = note.value.split()
            numbers = np.array([float(number) for number in numbers])
            seats.setdefault(note.key, []).append((entity.frame_id, kind, numbers))
    size = max(np.ptp(points, axis=0).max() for points in ends.values() if len(points))

    assert len(seats) >= 5
    for joint, shares in seats.items():
        assert len(shares) == 2, f"{joint} joins {len(shares)} bodies"
        for frame, kind, numbers in shares:
            # The drawn solids extend to the joint: to the end or middle of a pin, or to the line of
            # a rail.
            centre, axis = numbers[:3], numbers[3:]
            offset = ends[frame] - centre
            across = np.linalg.norm(np.cross(offset, axis), axis=1)
            off = across if kind == "slide" else np.linalg.norm(offset, axis=1)
            assert off.min() < TOGETHER * size, f"{joint} in {frame}: {off.min()}"

    worst, frames = 0, 0
    travelled = {frame: [] for frame in ends}
    for absolute in recorded.frames():
        frames += 1
        assert set(absolute) == set(ends)
        for joint, shares in seats.items():
            (_, kind, _), _ = shares
            views = []
            for frame, _, numbers in shares:
                g = absolute[frame]
                rotation = g[:3, :3]
                views.append((rotation @ numbers[:3] + g[:3, 3], rotation @ numbers[3:], rotation))
            off = distance(kind, *views, size)
            assert off < TOGETHER, f"{joint}: {off} of the size"
            worst = max(worst, off)
        for frame, place in absolute.items():
            travelled[frame].append(place)
    assert frames > 90
    print(f"{mechanism}: {frames} frames, joints within {worst:.1e} of the size")
    # The mechanism moves, and the base does not.
    moved = {frame: np.ptp(np.array(places), axis=0).max() for frame, places in travelled.items()}
    assert moved.pop("base") == 0
    assert max(moved.values()) > 0.01 and sum(m > 1e-6 for m in moved.values()) > len(moved) / 2
    # The same surfaces as points, each in its frame.
    for frame in ends:
        time, cloud = recorded.topics[f"/scene/bodies/{frame}"][0]
        assert (time, cloud.frame_id) == (START, frame)
        array = check_recording.points(cloud)
        assert len(array) > 50 or not len(ends[frame])


def test_every_topic_has_every_sample(record):
    recorded = Recorded(record("plano-spherical-5dof"))
    result = recorded.metadata["result"]
    assert (result["samples"], result["valid"], result["complete"]) == ("1001", "1001", "true")
    assert set(recorded.attachments) == {
        "plano-spherical-5dof.toml",
        "plano-spherical-sinusoids.toml",
    }
    expected = START + 10_000_000 * np.arange(1001)
    tables = {}
    for topic in ["pose", "pose_velocities", "joints", "velocities", "accelerations"]:
        times, tables[topic] = recorded.flat(f"/{topic}")
        assert (times == expected).all()
    for topic in ["imaginary_joints", "imaginary_velocities", "condition"]:
        times, tables[topic] = recorded.flat(f"/{topic}")
        assert (times == expected).all()
    # Velocities are derivatives of positions.
    for value, rate in [
        ("pose", "pose_velocities"),
        ("joints", "velocities"),
        ("velocities", "accelerations"),
        ("imaginary_joints", "imaginary_velocities"),
    ]:
        assert list(tables[value]) == list(tables[rate])
        for name, column in tables[value].items():
            # The error is the step's square, 1e-4 s², times a third derivative of a few units.
            difference = (column[2:] - column[:-2]) / 0.02
            assert np.abs(difference - tables[rate][name][1:-1]).max() < 2e-3, (value, name)
    condition = tables["condition"]
    measures = ["upper_serial", "upper_parallel", "lower_serial", "lower_parallel"]
    assert list(condition) == ["condition", *measures, "valid"]
    assert (condition["valid"] == 1).all() and (condition["condition"] >= 1).all()
    # The motion by the formula in its file.
    t = (expected - START) / 1e9
    formula = -0.031 + 0.018 * np.sin(2 * np.pi * 0.3 * t + np.radians(85))
    assert np.abs(tables["pose"]["y"] - formula).max() < 1e-12

    roles, quantities = recorded.metadata["roles"], recorded.metadata["quantities"]
    assert set(roles) == set(quantities)
    expected = {"S1": "actuated", "phi11": "passive", "theta11": "imaginary", "zeta": "task"}
    assert {name: roles[name] for name in expected} == expected
    assert (quantities["S1"], quantities["phi14"], quantities["x"]) == ("m", "rad", "m")
    time, states = recorded.topics["/joint_states"][250]
    assert time == START + 5_000_000_000
    for state in states.joints:
        field = state.name.replace(".", "_")
        assert state.position == tables["joints"][field][500]
        assert state.velocity == tables["velocities"][field][500]
        assert state.acceleration == tables["accelerations"][field][500]


def test_the_recording_is_what_inverse_kinematics_says(opm, record, tmp_path):
    recorded = Recorded(record("translational-helical-3dof"))
    _, pose = recorded.flat("/pose")
    _, joints = recorded.flat("/joints")
    with open(tmp_path / "poses.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(pose)
        writer.writerows(zip(*(column.tolist() for column in pose.values())))
    command = [opm, "ik", "translational-helical-3dof", "--poses", tmp_path / "poses.csv"]
    solved = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = list(csv.DictReader(solved.splitlines()))
    assert len(rows) == 1001
    for name in ["S1", "S2", "S3"]:
        assert np.abs(joints[name] - [float(row[name]) for row in rows]).max() < 1e-12


def test_what_cannot_be_followed_is_marked(opm, record, tmp_path):
    """A motion beyond the reach of the arm, whose two links of 100 mm start at (0, 75): down to y = -125 mm."""
    motion = tmp_path / "down.toml"
    motion.write_text(
        'format = 1\nname = "down"\nunits = { length = "mm", angle = "deg" }\nduration = 2\n'
        "rate = 50\n[coordinates]\ny = { amplitude = 150, frequency = 0.5, phase = 180 }\n"
    )
    command = [opm, "trajectory", "plano-spherical-5dof", "--motion", motion, "--format", "json"]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    recorded = Recorded(record("plano-spherical-5dof", motion))
    arm = [v for v in answer["violations"] if v["kind"] == "reach" and v["leg"] == "leg4"]
    # 150 sin(180 deg t) = 125
    start = np.arcsin(125 / 150) / np.pi
    assert len(arm) == 1 and abs(arm[0]["start"] - start) < 1e-9
    assert abs(arm[0]["end"] - (1 - start)) < 1e-9 and abs(arm[0]["worst"] - 0.5) < 1e-6
    assert abs(arm[0]["amount"] - 0.025) < 1e-9 and arm[0]["unit"] == "m"

    listed = [value for name, value in recorded.metadata.items() if name.startswith("violation.")]
    assert len(listed) == answer["violation_count"]
    for violation, written in zip(answer["violations"], listed):
        assert {key: str(value) for key, value in violation.items()}.keys() == written.keys()
        assert float(written["start"]) == violation["start"]
    lines = [(time, log.message) for time, log in recorded.topics["/violations"]]
    begins = [time for time, line in lines if line.startswith("leg4: out of reach")]
    assert [round((time - START) / 1e9, 6) for time in begins] == [round(start, 6)]
    times, judged = recorded.flat("/condition")
    assert len(times) == 101
    t = (times - START) / 1e9
    out = (t > start) & (t < 1 - start)
    assert (judged["valid"][out] == 0).all() and np.isinf(judged["condition"][out]).all()
    posed, _ = recorded.flat("/pose")
    jointed, joints = recorded.flat("/joints")
    assert len(posed) == len(jointed) == 101
    spans = [(v["start"], v["end"]) for v in answer["violations"] if v["kind"] == "reach"]
    lost = np.any([(t > start) & (t < end) for start, end in spans], axis=0)
    assert lost[out].all()
    assert all((np.isnan(column) == lost).all() for column in joints.values())
    # The bodies are red while they are stuck. In reach, there are also scenes where bodies begin or cease to interfere.
    scenes = [(time, scene.entities[-1].cylinders[0].color.g) for time, scene in recorded.topics["/scene"]]
    changes = np.flatnonzero(lost[1:] != lost[:-1]) + 1
    assert scenes[0][0] == START and {*times[changes]} <= {time for time, _ in scenes}
    stuck = {[green for time, green in scenes if time <= now][-1] for now in times[lost]}
    assert len(changes) >= 2 and len(stuck) == 1 and scenes[0][1] not in stuck
    # So are the points of the bodies, for viewers without scenes.
    clouds = recorded.topics["/scene/bodies/platform"]
    greens = [(time, check_recording.points(cloud)["green"].mean()) for time, cloud in clouds]
    red = {[green for time, green in greens if time <= now][-1] for now in times[lost]}
    # Of two reds: what interferes is another one than what is stuck.
    assert greens[0][1] > 1.5 * max(red)
