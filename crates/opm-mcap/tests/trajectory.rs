//! What is in the recording of a motion.

mod common;

use common::{MECHANISM, file, record};
use opm_mcap::trajectory::{IMAGINARY_TOPIC, JOINTS_TOPIC};
use opm_mcap::workspace::START;
use opm_mcap::{Message, ReadError, RecordError, Trajectory, TrajectoryRecorder, read};
use std::io::Cursor;

/// Nanoseconds between the samples.
const STEP: u64 = 40_000_000;

fn trajectory(imaginary: &[&str]) -> Trajectory<'static> {
    Trajectory {
        joints: ["a1", "b3", "a.2"].map(String::from).into(),
        imaginary: imaginary.iter().map(ToString::to_string).collect(),
        mechanism_name: "test.toml",
        mechanism: MECHANISM,
        run: record([("input", "a1")]),
    }
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
        recorder.push(i * STEP, &joints(i), &[2.0 * i as f64]).unwrap();
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
        seen.push((message.topic.to_owned(), message.time, doubles(message.data)));
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
        recording.topics.iter().map(|t| (&*t.name, &*t.schema, t.messages, t.points)).collect();
    let expected =
        [(IMAGINARY_TOPIC, "opm.ImaginaryJoints", 3, None), (JOINTS_TOPIC, "opm.Joints", 3, None)];
    assert_eq!(topics, expected);
    assert_eq!(recording.metadata("joints").unwrap()["a_2"], "a.2");
    assert_eq!(recording.metadata("joints").unwrap()["tau_leg1"], "tau.leg1");
    assert_eq!(recording.metadata("run").unwrap()["input"], "a1");
    assert_eq!(recording.metadata("result").unwrap()["complete"], "true");
    assert_eq!(recording.attachments.len(), 1);
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
    recorder.push(0, &joints(0), &[]).unwrap();
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
        recorder.push(STEP, &all, &[0.0]).unwrap();
        let error = recorder.push(time, joints, imaginary).unwrap_err();
        assert!(matches!(error, RecordError::Time { .. } | RecordError::Row { .. }), "{error}");
        let after = recorder.push(2 * STEP, &all, &[0.0]);
        assert!(matches!(after, Err(RecordError::AfterFailure)));
        assert!(recorder.finish(&record([])).is_err());
        assert!(!path.exists());
    }
    let twice = Trajectory { joints: vec!["a".into(), "a".into()], ..trajectory(&[]) };
    let error = TrajectoryRecorder::create(&path, &twice).err().unwrap();
    assert!(error.to_string().contains("joint a is given twice"), "{error}");
}
