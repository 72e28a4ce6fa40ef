//! What is in the recording of a motion.

mod common;

use common::{MECHANISM, file, record};
use foxglove::Decode;
use foxglove::messages::SceneUpdate;
use opm_mcap::scene::{Body, Shape, Solid};
use opm_mcap::trajectory::*;
use opm_mcap::{Message, ReadError, RecordError, Trajectory, TrajectoryRecorder, read};
use std::collections::BTreeMap;
use std::io::Cursor;

/// Nanoseconds between the samples.
const STEP: u64 = 40_000_000;

fn coordinates(names: &[&str], role: Role) -> Vec<Coordinate> {
    names.iter().map(|&name| Coordinate { name: name.into(), unit: "rad", role }).collect()
}

/// Joints alone: what a linkage has.
fn trajectory(imaginary: &[&str]) -> Trajectory<'static> {
    Trajectory {
        pose: Vec::new(),
        dependent: Vec::new(),
        joints: coordinates(&["a1", "b3", "a.2"], Role::Passive),
        imaginary: coordinates(imaginary, Role::Imaginary),
        rates: false,
        measures: Vec::new(),
        indices: Vec::new(),
        bodies: Vec::new(),
        files: vec![("test.toml", MECHANISM)],
        run: record([("input", "a1")]),
    }
}

/// Everything that there can be.
fn whole() -> Trajectory<'static> {
    let rod = Shape::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 1.0], radius: 0.1 };
    let body = |frame: &str, parent| Body {
        frame: frame.into(),
        parent,
        solids: vec![Solid { shape: rod, color: [1.0, 0.5, 0.0, 1.0] }],
        notes: vec![("joint a1".into(), "turn".into())],
    };
    let pose = vec![
        Coordinate { name: "x".into(), unit: "m", role: Role::Task },
        Coordinate { name: "a1".into(), unit: "m", role: Role::Task },
    ];
    Trajectory {
        pose,
        dependent: coordinates(&["theta"], Role::Dependent),
        rates: true,
        measures: vec!["condition".into()],
        indices: Vec::new(),
        bodies: vec![body("base", None), body("arm", Some(0))],
        files: vec![("test.toml", MECHANISM), ("motion.csv", b"t,x\n")],
        ..trajectory(&["tau.leg1"])
    }
}

fn posture<'a>(joints: &'a [f64], imaginary: &'a [f64]) -> Sample<'a> {
    let posture = Posture { joints, imaginary, ..Posture::default() };
    Sample { posture: Some(posture), ..Sample::default() }
}

/// Joint values of sample `i`; a zero among them, which protobuf would leave out.
fn joints(i: u64) -> [f64; 3] {
    [0.1 * i as f64, 0.0, -1.0 / (i + 1) as f64]
}

fn recorded(samples: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let sink = Cursor::new(&mut bytes);
    let mut recorder = TrajectoryRecorder::new(sink, &trajectory(&["tau.leg1"])).unwrap();
    for i in 0..samples {
        recorder.push(i * STEP, &posture(&joints(i), &[2.0 * i as f64])).unwrap();
    }
    recorder.finish(&record([("samples", "3")])).unwrap();
    bytes
}

/// The doubles of a flat message: a key of one byte, then eight bytes, each.
fn doubles(data: &[u8]) -> Vec<f64> {
    let field = |(i, bytes): (usize, &[u8])| {
        assert_eq!(usize::from(bytes[0]), (i + 1) << 3 | 1, "fields in order, all of them doubles");
        f64::from_le_bytes(bytes[1..].try_into().unwrap())
    };
    data.chunks(9).enumerate().map(field).collect()
}

#[test]
fn every_value_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "t.mcap", &recorded(3));
    let mut seen = Vec::new();
    let recording = read(&path, |message: &Message<'_>| -> Result<(), ReadError> {
        if message.topic != JOINT_STATES_TOPIC {
            seen.push((message.topic.to_owned(), message.time, doubles(message.data)));
        }
        Ok(())
    })
    .unwrap();
    let expected: Vec<_> = (0..3)
        .flat_map(|i| {
            let time = START + i * STEP;
            [
                (JOINTS_TOPIC.to_owned(), time, joints(i).to_vec()),
                (IMAGINARY_TOPIC.to_owned(), time, vec![2.0 * i as f64]),
            ]
        })
        .collect();
    assert_eq!(seen, expected);

    assert!(recording.complete);
    let topics: Vec<_> =
        recording.topics.iter().map(|t| (&*t.name, &*t.schema, t.messages)).collect();
    let expected = [
        (IMAGINARY_TOPIC, "opm.ImaginaryJoints", 3),
        (JOINT_STATES_TOPIC, "foxglove.JointStates", 3),
        (JOINTS_TOPIC, "opm.Joints", 3),
        (VIOLATIONS_TOPIC, "foxglove.Log", 0),
    ];
    assert_eq!(topics, expected);
    assert_eq!(recording.metadata("joints").unwrap()["a_2"], "a.2");
    assert_eq!(recording.metadata("joints").unwrap()["tau_leg1"], "tau.leg1");
    assert_eq!(recording.metadata("run").unwrap()["input"], "a1");
    assert_eq!(recording.metadata("result").unwrap()["complete"], "true");
    assert_eq!(recording.attachments.len(), 1);
}

/// Out of reach the pose goes on, the joints are NaN and the bodies red; a joint wins over a task coordinate of its name.
#[test]
fn a_motion_has_all_topics() {
    let directory = tempfile::tempdir().unwrap();
    let mut bytes = Vec::new();
    let mut recorder = TrajectoryRecorder::new(Cursor::new(&mut bytes), &whole()).unwrap();
    let frames = [Frame { translation: [1.0, 2.0, 3.0], rotation: [0.0, 0.0, 0.0, 1.0] }];
    let rates = Rates {
        dependent: &[5.0],
        velocities: &[1.0; 3],
        imaginary: &[2.0],
        accelerations: &[3.0; 3],
    };
    let values = [0.5; 3];
    let reached = Posture {
        dependent: &[0.2],
        joints: &values,
        imaginary: &[0.1],
        rates: Some(rates),
        frames: &frames,
        interfering: &[],
    };
    let at = |valid, posture| Sample {
        pose: &[1.0, 2.0],
        pose_velocities: &[3.0, 4.0],
        measures: &[7.0],
        indices: &[],
        valid,
        posture,
    };
    recorder.push(0, &at(true, Some(reached))).unwrap();
    recorder.mark(STEP / 2, "a1: past its highest value").unwrap();
    recorder.push(STEP, &at(false, None)).unwrap();
    recorder.describe("violation.1", &record([("kind", "limit")])).unwrap();
    recorder.finish(&record([])).unwrap();

    let path = file(&directory, "t.mcap", &bytes);
    let (mut judged, mut values, mut known, mut last) = (Vec::new(), Vec::new(), Vec::new(), 0);
    let mut scenes = Vec::new();
    let recording = read(&path, |message: &Message<'_>| -> Result<(), ReadError> {
        assert!(message.time >= last, "time goes back");
        last = message.time;
        if message.topic == CONDITION_TOPIC {
            judged.push(doubles(message.data));
        } else if message.values(&mut values)? {
            known.push((message.time, values.iter().all(|value| !value.is_nan())));
        } else if message.topic == SCENE_TOPIC {
            scenes.push((message.time, SceneUpdate::decode(message.data).unwrap()));
        }
        Ok(())
    })
    .unwrap();
    assert_eq!(judged, [[7.0, 1.0], [7.0, 0.0]]);
    // Nine topics; of the second sample, the pose and its rates are known.
    let count = |time, is_known| known.iter().filter(|k| **k == (time, is_known)).count();
    assert_eq!([count(START, true), count(START, false)], [9, 0]);
    assert_eq!([count(START + STEP, true), count(START + STEP, false)], [2, 7]);
    let [(first, moving), (second, stuck)] = &scenes[..] else { panic!("{scenes:?}") };
    assert_eq!([*first, *second], [START, START + STEP]);
    let color = |scene: &SceneUpdate| scene.entities[1].cylinders[0].color.unwrap();
    let [before, after] = [moving, stuck].map(color);
    assert!((before.r, before.g, before.b) == (1.0, 0.5, 0.0));
    assert!(after.r > 0.8 && after.g < 0.3 && after.b < 0.3 && after.a == 1.0, "{after:?}");
    let counts: BTreeMap<_, _> = recording.topics.iter().map(|t| (&*t.name, t.messages)).collect();
    for (topic, count) in [
        (POSE_TOPIC, 2),
        (POSE_VELOCITIES_TOPIC, 2),
        (DEPENDENT_TOPIC, 2),
        (DEPENDENT_VELOCITIES_TOPIC, 2),
        (JOINTS_TOPIC, 2),
        (VELOCITIES_TOPIC, 2),
        (ACCELERATIONS_TOPIC, 2),
        (IMAGINARY_TOPIC, 2),
        (IMAGINARY_VELOCITIES_TOPIC, 2),
        (JOINT_STATES_TOPIC, 1),
        (FRAMES_TOPIC, 1),
        (SCENE_TOPIC, 2),
        // Once more in red, where the motion is out of reach.
        ("/scene/bodies/base", 2),
        ("/scene/bodies/arm", 2),
        (VIOLATIONS_TOPIC, 1),
    ] {
        assert_eq!(counts[topic], count, "{topic}");
    }
    assert_eq!(recording.metadata("roles").unwrap()["x"], "task");
    assert_eq!(recording.metadata("roles").unwrap()["theta"], "dependent");
    assert_eq!(recording.metadata("roles").unwrap()["a1"], "passive");
    assert!(!recording.metadata("joints").unwrap().contains_key("theta"));
    assert_eq!(recording.metadata("quantities").unwrap()["x"], "m");
    assert_eq!(recording.metadata("quantities").unwrap()["tau_leg1"], "rad");
    assert_eq!(recording.metadata("violation.1").unwrap()["kind"], "limit");
    assert_eq!(recording.attachments.len(), 2);
}

/// At a thousand samples a second every seventeenth is shown, and all are written.
#[test]
fn pictures_come_no_faster_than_they_are_seen() {
    let mut bytes = Vec::new();
    let mut recorder = TrajectoryRecorder::new(Cursor::new(&mut bytes), &trajectory(&[])).unwrap();
    let mut shown = 0;
    for i in 0..=1000 {
        shown += u64::from(recorder.shows(i * 1_000_000));
        recorder.push(i * 1_000_000, &posture(&joints(i), &[])).unwrap();
    }
    recorder.finish(&record([])).unwrap();
    assert_eq!(shown, 59);
    let directory = tempfile::tempdir().unwrap();
    let recording = read::<ReadError>(&file(&directory, "t.mcap", &bytes), |_| Ok(())).unwrap();
    assert_eq!(recording.topic(JOINTS_TOPIC).unwrap().messages, 1001);
    assert_eq!(recording.topic(JOINT_STATES_TOPIC).unwrap().messages, 59);
}

#[test]
fn the_same_motion_gives_the_same_bytes() {
    assert_eq!(recorded(1000), recorded(1000));
}

#[test]
fn without_imaginary_joints_their_topic_is_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("t.mcap");
    let mut recorder = TrajectoryRecorder::create(&path, &trajectory(&[])).unwrap();
    recorder.push(0, &posture(&joints(0), &[])).unwrap();
    assert!(!path.exists(), "only a whole recording gets its name");
    recorder.finish(&record([])).unwrap();
    let recording = read::<ReadError>(&path, |_| Ok(())).unwrap();
    assert!(recording.topic(IMAGINARY_TOPIC).is_none());
    assert_eq!(recording.topic(JOINTS_TOPIC).unwrap().messages, 1);
}

#[test]
fn what_does_not_fit_ends_the_recording() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("t.mcap");
    let all = joints(1);
    let wrong: [(u64, &[f64], &[f64]); 4] = [
        (STEP - 1, &all, &[0.0]),
        (STEP, &all[..1], &[0.0]),
        (STEP, &all, &[]),
        (STEP, &all, &[0.0, 0.0]),
    ];
    for (time, joints, imaginary) in wrong {
        let mut recorder = TrajectoryRecorder::create(&path, &trajectory(&["tau.leg1"])).unwrap();
        recorder.push(STEP, &posture(&all, &[0.0])).unwrap();
        let error = recorder.push(time, &posture(joints, imaginary)).unwrap_err();
        assert!(matches!(error, RecordError::Time { .. } | RecordError::Row { .. }), "{error}");
        let after = recorder.push(2 * STEP, &posture(&all, &[0.0]));
        assert!(matches!(after, Err(RecordError::AfterFailure)));
        assert!(recorder.finish(&record([])).is_err());
        assert!(!path.exists());
    }
    let twice = Trajectory { joints: coordinates(&["a", "a"], Role::Passive), ..trajectory(&[]) };
    let error = TrajectoryRecorder::create(&path, &twice).err().unwrap();
    assert!(error.to_string().contains("joint a is given twice"), "{error}");
}

/// Rates that a recording has no room for are no reason to panic: without values they are left out, with
/// values they are refused.
#[test]
fn rates_in_a_recording_without_rates() {
    let mut bytes = Vec::new();
    let trajectory = trajectory(&[]);
    let mut recorder = TrajectoryRecorder::new(Cursor::new(&mut bytes), &trajectory).unwrap();
    let push = |recorder: &mut TrajectoryRecorder<'_>, rates| {
        let joints = &[1.0, 2.0, 3.0];
        let posture = Posture { joints, rates: Some(rates), ..Posture::default() };
        recorder.push(0, &Sample { posture: Some(posture), ..Sample::default() })
    };
    push(&mut recorder, Rates::default()).unwrap();
    let rates = Rates { velocities: &[0.0; 3], ..Rates::default() };
    let error = push(&mut recorder, rates).unwrap_err();
    assert!(matches!(error, RecordError::Row { values: 3, columns: 0 }), "{error}");
}
