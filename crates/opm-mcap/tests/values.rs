//! Flat messages and attachments, read back without knowing who wrote them.

mod common;

use common::{MECHANISM, file};
use opm_mcap::trajectory::{Coordinate, JOINTS_TOPIC, Posture, Role, Sample};
use opm_mcap::{Message, Metadata, ReadError, Trajectory, TrajectoryRecorder, read};
use std::io::Cursor;

fn recorded(long: &[u8], joints: &[[f64; 2]]) -> Vec<u8> {
    let joint = |name: &str| Coordinate { name: name.into(), unit: "m", role: Role::Passive };
    let trajectory = Trajectory {
        pose: vec![],
        dependent: vec![],
        joints: vec![joint("b"), joint("a.x")],
        imaginary: vec![],
        rates: false,
        measures: vec![],
        indices: Vec::new(),
        bodies: vec![],
        files: vec![("m.toml", MECHANISM), ("long.csv", long), ("last.csv", MECHANISM)],
        run: Metadata::new(),
    };
    let mut bytes = Vec::new();
    let mut recorder = TrajectoryRecorder::new(Cursor::new(&mut bytes), &trajectory).unwrap();
    for (i, joints) in (0..).zip(joints) {
        let posture = Some(Posture { joints, ..Posture::default() });
        recorder.push(i, &Sample { posture, ..Sample::default() }).unwrap();
    }
    recorder.finish(&Metadata::new()).unwrap();
    bytes
}

#[test]
fn values_come_with_their_names() {
    let directory = tempfile::tempdir().unwrap();
    let joints = [[0.0, -1.5], [f64::MAX, 1e-300], [f64::NEG_INFINITY, 0.0]];
    let path = file(&directory, "t.mcap", &recorded(b"", &joints));
    let (mut seen, mut values, mut others) = (vec![], vec![1.0], 0);
    read(&path, |message: &Message<'_>| -> Result<(), ReadError> {
        if message.values(&mut values)? {
            assert_eq!(message.topic, JOINTS_TOPIC);
            assert_eq!(message.flat.unwrap().names, ["b", "a_x"]);
            seen.push([values[0], values[1]]);
        } else {
            assert!(message.flat.is_none() && values.is_empty(), "{}", message.topic);
            others += 1;
        }
        Ok(())
    })
    .unwrap();
    assert_eq!(seen, joints);
    assert!(others > 0, "messages of well-known types are not flat");
}

#[test]
fn attachments_are_kept_as_far_as_there_is_room() {
    let directory = tempfile::tempdir().unwrap();
    let long = vec![b'x'; 17 << 20];
    let path = file(&directory, "t.mcap", &recorded(&long, &[[0.0; 2]]));
    let recording = read::<ReadError>(&path, |_| Ok(())).unwrap();
    let found: Vec<_> =
        recording.attachments.iter().map(|a| (a.size, a.content.as_deref())).collect();
    let size = MECHANISM.len() as u64;
    assert_eq!(found, [(size, Some(MECHANISM)), (17 << 20, None), (size, Some(MECHANISM))]);
}
