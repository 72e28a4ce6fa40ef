//! Recordings that were cut short or damaged, recovered as far as they go.

mod common;

use std::fs;
use std::path::Path;

use common::{clouds, file, nothing, recorded};
use opm_mcap::{PartialFile, RECOVERED, ReadError, RecordError, RecoverError, read, recover};

fn nothing_is_left(target: &Path) {
    assert!(!target.exists());
    assert!(!target.with_extension("mcap.partial").exists());
}

#[test]
fn what_is_left_of_a_recording_cut_anywhere_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let bytes = recorded(&[2, 0, 3], 1);
    let target = directory.path().join("again.mcap");
    let mut recovered = 0;
    for length in 0..bytes.len() {
        let cut = file(&directory, "cut.mcap.partial", &bytes[..length]);
        let _ = fs::remove_file(&target);
        match recover(&cut, &target) {
            Ok(found) => {
                let (expected, before) = clouds(&cut).unwrap();
                let (seen, after) = clouds(&target).unwrap();
                assert_eq!(seen, expected, "cut to {length}");
                assert_eq!(after.attachments, before.attachments, "cut to {length}");
                assert_eq!(after.time_range, before.time_range);
                assert_eq!(found.time_range, before.time_range);
                let messages: u64 = before.topics.iter().map(|topic| topic.messages).sum();
                assert_eq!(found.messages, messages);
                let (origin, rest) = after.metadata.split_last().unwrap();
                assert_eq!(rest, before.metadata);
                assert_eq!(origin.0, RECOVERED);
                assert_eq!(origin.1["from"], "cut.mcap.partial");
                assert!(fs::read(&target).unwrap().ends_with(mcap::MAGIC));
                // Only where everything was there but the end.
                assert!(
                    !after.complete
                        || rest.iter().any(|(_, record)| record.contains_key("complete"))
                );
                recovered += 1;
            }
            Err(RecoverError::Read(ReadError::NotMcap { .. })) => {
                assert!(length < 60, "cut to {length}");
                nothing_is_left(&target);
            }
            Err(error) => panic!("cut to {length}: {error:?}"),
        }
    }
    assert!(recovered > bytes.len() - 60);
}

#[test]
fn damage_ends_what_is_recovered() {
    let directory = tempfile::tempdir().unwrap();
    let bytes = recorded(&[2, 0, 3], 1);
    let (whole, _) = clouds(&file(&directory, "whole.mcap", &bytes)).unwrap();
    let target = directory.path().join("again.mcap");
    let (mut damaged, mut shortest) = (0, usize::MAX);
    for at in (9..bytes.len()).step_by(3) {
        let mut wrong = bytes.clone();
        wrong[at] ^= 0x10;
        let path = file(&directory, "wrong.mcap", &wrong);
        let _ = fs::remove_file(&target);
        if let Ok(found) = recover(&path, &target) {
            let (seen, after) = clouds(&target).unwrap();
            assert_eq!(seen, whole[..seen.len()], "byte {at}");
            assert_eq!(after.metadata.last().unwrap().0, RECOVERED);
            damaged += u32::from(found.damage.is_some());
            shortest = shortest.min(seen.len());
        } else {
            nothing_is_left(&target);
        }
    }
    assert!(damaged > 100 && shortest == 0, "{damaged} {shortest}");
}

#[test]
fn what_cannot_be_recovered_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let target = directory.path().join("again.mcap");
    let whole = file(&directory, "whole.mcap", &recorded(&[2, 0, 3], 1));
    assert!(matches!(recover(&whole, &target), Err(RecoverError::Whole)));
    nothing_is_left(&target);
    let text = file(&directory, "text", b"x,y\n1,2\n");
    assert!(matches!(recover(&text, &target), Err(RecoverError::Read(ReadError::NotMcap { .. }))));
    nothing_is_left(&target);
    let none = directory.path().join("none");
    assert!(matches!(recover(&none, &target), Err(RecoverError::Read(ReadError::Io { .. }))));
    nothing_is_left(&target);

    // A run that is still going.
    let running = PartialFile::create(&directory.path().join("run.mcap")).unwrap();
    assert!(matches!(recover(running.path(), &target), Err(RecoverError::Busy)));
    nothing_is_left(&target);
    drop(running);

    // The target is a folder; a file of the target's name stays.
    let cut = file(&directory, "cut", &recorded(&[2, 0, 3], 1)[..500]);
    let folder = recover(&cut, directory.path());
    assert!(matches!(folder, Err(RecoverError::Record(RecordError::NotAFile { .. }))));
    fs::write(&target, b"another").unwrap();
    assert!(matches!(recover(&whole, &target), Err(RecoverError::Whole)));
    assert_eq!(fs::read(&target).unwrap(), b"another");
    assert!(read(&cut, nothing).is_ok());
}

/// In a chunk without compression and without a checksum, where nothing else tells.
#[test]
fn a_record_that_is_longer_than_its_chunk_is_damage() {
    let directory = tempfile::tempdir().unwrap();
    let record = |opcode: u8, data: &[u8]| {
        [&[opcode][..], &(data.len() as u64).to_le_bytes(), data].concat()
    };
    let recording = |claimed: u64| {
        // A record of a type that nobody knows, and before it the header of the chunk.
        let content = [&[0x7f][..], &claimed.to_le_bytes(), &[0; 3]].concat();
        let size = (content.len() as u64).to_le_bytes();
        let chunk = [&[0; 16][..], &size, &[0; 4], &[0; 4], &size, &content].concat();
        let parts = [mcap::MAGIC.to_vec(), record(0x01, &[0; 8]), record(0x06, &chunk)];
        file(&directory, "foreign.mcap", &parts.concat())
    };
    let read = |claimed| read::<ReadError>(&recording(claimed), |_| Ok(()));
    assert!(!read(3).unwrap().complete);
    for claimed in [4, 100, u64::MAX] {
        let error = read(claimed).unwrap_err();
        assert!(matches!(error, ReadError::Damaged { .. }), "{claimed}: {error:?}");
    }
}
