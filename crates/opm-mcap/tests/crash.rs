//! A recording that is cut short: by a full disk, by its process's end, by damage afterwards.

mod common;

use std::fs;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use common::{clouds, file, layout, nothing, record_slices, recorded, row, rows, workspace};
use opm_mcap::workspace::SLICES_TOPIC;
use opm_mcap::{PartialFile, ReadError, RecordError, Sink, WorkspaceRecorder, read};

const COUNTS: [u64; 5] = [300, 0, 50_000, 20, 40_000];

/// A disk that is full at one write and has room again afterwards.
#[derive(Clone)]
struct FullDisk(Arc<Mutex<Disk>>);

struct Disk {
    file: Cursor<Vec<u8>>,
    /// Writes until the one that fails.
    countdown: usize,
    committed: bool,
}

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut disk = self.0.lock().unwrap();
        let now = disk.countdown == 0;
        disk.countdown = disk.countdown.wrapping_sub(1);
        if now { Err(io::ErrorKind::StorageFull.into()) } else { disk.file.write(bytes) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for FullDisk {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.0.lock().unwrap().file.seek(position)
    }
}

impl Sink for FullDisk {
    fn commit(self: Box<Self>) -> io::Result<()> {
        self.0.lock().unwrap().committed = true;
        Ok(())
    }
}

#[test]
fn a_failed_write_is_final_wherever_it_happens() {
    let run = |countdown| {
        let disk = Disk { file: Cursor::default(), countdown, committed: false };
        let disk = FullDisk(Arc::new(Mutex::new(disk)));
        let result = record_slices(disk.clone(), &COUNTS, 5000);
        let disk = Arc::into_inner(disk.0).unwrap().into_inner().unwrap();
        (result, disk)
    };
    let (result, whole) = run(usize::MAX);
    result.unwrap();
    assert!(whole.committed && whole.file.get_ref().ends_with(mcap::MAGIC));
    let writes = usize::MAX - whole.countdown;
    assert!(writes > 100, "{writes} writes");

    for countdown in 0..writes {
        let (result, disk) = run(countdown);
        let error = result.unwrap_err();
        assert!(matches!(error, RecordError::Io(_)), "write {countdown}: {error:?}");
        assert!(!disk.committed, "write {countdown}");
        // Room was back at once, and nothing of it was used to make the file look whole.
        let start = disk.file.get_ref();
        assert!(start.len() <= 8 || !start.ends_with(mcap::MAGIC), "write {countdown}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_is_reported() {
    struct Device(fs::File);
    impl Write for Device {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }
    impl Seek for Device {
        fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
            self.0.seek(position)
        }
    }
    impl Sink for Device {
        fn commit(self: Box<Self>) -> io::Result<()> {
            panic!("nothing was written")
        }
    }
    let device = Device(fs::File::options().write(true).open("/dev/full").unwrap());
    let error = record_slices(device, &COUNTS, 5000).unwrap_err();
    let RecordError::Io(reason) = error else { panic!("{error:?}") };
    assert_eq!(reason.kind(), io::ErrorKind::StorageFull);
}

#[test]
fn a_dropped_recorder_leaves_the_old_file_and_a_partial() {
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "w.mcap", b"the old file");
    let mut recorder = WorkspaceRecorder::create(&path, &workspace(layout(), 60_000, 2)).unwrap();
    recorder.overview(&rows(0..60_000)).unwrap();
    recorder.push(0, &rows(0..50_000)).unwrap();
    recorder.push(1, &rows(50_000..60_000)).unwrap();
    drop(recorder);

    assert_eq!(fs::read(&path).unwrap(), b"the old file");
    let (seen, recording) = clouds(&directory.path().join("w.mcap.partial")).unwrap();
    assert!(!recording.complete);
    assert!(!fs::read(directory.path().join("w.mcap.partial")).unwrap().ends_with(mcap::MAGIC));
    assert_eq!(seen.iter().map(common::Seen::len).collect::<Vec<_>>(), [60_000, 50_000]);

    // The next run takes the place of both.
    record_slices(PartialFile::create(&path).unwrap(), &COUNTS, 999).unwrap();
    assert_eq!(fs::read(&path).unwrap(), recorded(&COUNTS, 4));
    assert!(!directory.path().join("w.mcap.partial").exists());
}

#[test]
fn a_killed_process_leaves_a_partial_that_can_be_read() {
    /// The partial's size at which the process is killed: the overview, two million points of 20
    /// bytes before compression, and some chunks of slices.
    const ENOUGH: u64 = 44_000_000;
    let directory = tempfile::tempdir().unwrap();
    let path = file(&directory, "w.mcap", b"the old file");
    let partial = directory.path().join("w.mcap.partial");
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "endless_recorder", "--ignored"])
        .env("ENDLESS_RECORDING", &path)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    while fs::metadata(&partial).map_or(0, |found| found.len()) < ENOUGH {
        assert!(child.try_wait().unwrap().is_none(), "the recorder ended by itself");
        assert!(Instant::now() < deadline, "the recorder wrote nothing");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();

    assert_eq!(fs::read(&path).unwrap(), b"the old file");
    let (seen, recording) = clouds(&partial).unwrap();
    assert!(!recording.complete);
    assert_eq!(recording.metadata("run").unwrap()["mode"], "++ ++ ++ +");
    // All but the last chunk is there: the slices are whole and in order.
    let slices: Vec<_> = seen.iter().filter(|cloud| cloud.topic == SLICES_TOPIC).collect();
    assert!(slices.len() > 10, "{} slices", slices.len());
    for (number, cloud) in slices.iter().enumerate() {
        assert_eq!(cloud.slice, Some(number as u64));
        let first = number as u64 * ENDLESS_SLICE;
        let expected: Vec<f64> =
            (first..first + ENDLESS_SLICE).map(|i| f64::from(row(i)[3] as f32)).collect();
        assert_eq!(cloud.column("theta11"), expected);
    }
}

/// Points of a slice of the recording below.
const ENDLESS_SLICE: u64 = 5000;

#[test]
#[ignore = "the process that `a_killed_process_leaves_a_partial_that_can_be_read` kills"]
fn endless_recorder() {
    let Some(path) = std::env::var_os("ENDLESS_RECORDING") else { return };
    let slices = opm_mcap::MAX_SLICES;
    let description = workspace(layout(), slices * ENDLESS_SLICE, slices);
    let mut recorder = WorkspaceRecorder::create(Path::new(&path), &description).unwrap();
    let every = recorder.overview_every() as usize;
    let overview = (0..slices * ENDLESS_SLICE).step_by(every).flat_map(row).collect::<Vec<_>>();
    recorder.overview(&overview).unwrap();
    for slice in 0..slices {
        let first = slice * ENDLESS_SLICE;
        recorder.push(slice, &rows(first..first + ENDLESS_SLICE)).unwrap();
    }
}

#[test]
fn what_cannot_become_the_file_is_refused_at_once() {
    let directory = tempfile::tempdir().unwrap();
    assert!(matches!(PartialFile::create(directory.path()), Err(RecordError::NotAFile { .. })));
    let missing = directory.path().join("missing/w.mcap");
    assert!(matches!(PartialFile::create(&missing), Err(RecordError::Create { .. })));

    let path = directory.path().join("w.mcap");
    let first = PartialFile::create(&path).unwrap();
    assert!(matches!(PartialFile::create(&path), Err(RecordError::Busy { .. })));
    drop(first);
    PartialFile::create(&path).unwrap();
}

#[test]
fn a_file_cut_anywhere_is_read_as_far_as_it_goes() {
    let directory = tempfile::tempdir().unwrap();
    let bytes = recorded(&[2, 0, 3], 1);
    let (whole, _) = clouds(&file(&directory, "whole.mcap", &bytes)).unwrap();
    let mut most = 0;
    for length in 0..bytes.len() {
        let path = file(&directory, "cut.mcap", &bytes[..length]);
        match clouds(&path) {
            Ok((seen, recording)) => {
                assert!(!recording.complete, "cut to {length} of {}", bytes.len());
                assert_eq!(seen, whole[..seen.len()], "cut to {length}");
                assert!(seen.len() >= most, "a longer file gives no less");
                most = seen.len();
            }
            Err(ReadError::NotMcap { .. }) => assert!(length < 60, "cut to {length}"),
            Err(error) => panic!("cut to {length}: {error:?}"),
        }
    }
    assert_eq!(most, whole.len());
}

#[test]
fn no_damaged_byte_goes_unnoticed() {
    let directory = tempfile::tempdir().unwrap();
    let bytes = recorded(&[2, 0, 3], 1);
    for at in 0..bytes.len() {
        // The lowest and the highest bit in turn.
        let flip = [0x01, 0x80][at % 2];
        let mut damaged = bytes.clone();
        damaged[at] ^= flip;
        let path = file(&directory, "damaged.mcap", &damaged);
        if let Ok(recording) = read(&path, nothing) {
            assert!(!recording.complete, "byte {at} of {} flipped by {flip}", bytes.len());
        }
    }
}

#[test]
fn other_files_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    for (name, bytes) in [("empty", &b""[..]), ("text", b"x,y,xi\n0.1,0.2,0.3\n")] {
        let error = clouds(&file(&directory, name, bytes)).unwrap_err();
        assert!(matches!(error, ReadError::NotMcap { .. }), "{name}: {error:?}");
    }
    let error = clouds(&directory.path().join("missing")).unwrap_err();
    assert!(matches!(error, ReadError::Io { .. }));
    assert!(matches!(clouds(directory.path()).unwrap_err(), ReadError::Io { .. }));
}
