//! Files that appear under their name only once they are whole.

use std::borrow::Cow;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::RecordError;

/// A place that a recording is written to: a file ([`PartialFile`]) or memory (`Cursor<&mut Vec<u8>>`).
///
/// Dropping a sink that was not committed must leave nothing that looks finished.
///
/// ```
/// use opm_mcap::{Sink, Trajectory, TrajectoryRecorder};
/// # fn record(sink: impl Sink, trajectory: &Trajectory<'_>) -> Result<(), opm_mcap::RecordError> {
/// let recorder = TrajectoryRecorder::new(sink, trajectory)?;
/// # recorder.finish(&opm_mcap::Metadata::new())
/// # }
/// ```
pub trait Sink: Write + Seek + Send {
    /// Makes final what was written, after the last byte.
    fn commit(self: Box<Self>) -> io::Result<()>;
}

/// A recording in memory. Lend a buffer to keep what is written: `Cursor::new(&mut bytes)`.
impl Sink for io::Cursor<&mut Vec<u8>> {
    fn commit(self: Box<Self>) -> io::Result<()> {
        Ok(())
    }
}

/// A file being written as `NAME.partial`, which [`commit`](Self::commit) renames to `NAME`.
///
/// Until then a file `NAME` stays as it is; then it is replaced. Where `NAME` is a symbolic link, the file that it leads to
/// is written, and the link stays. A run that ends early, for whatever reason, leaves the `.partial` file, unless it
/// [discards](Self::discard) it. The next run overwrites it.
///
/// ```
/// use opm_mcap::PartialFile;
/// use std::io::Write;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("table.csv");
/// let mut file = PartialFile::create(&path)?;
/// file.write_all(b"x,y\n")?;
/// assert!(!path.exists());
/// file.commit()?;
/// assert!(path.exists());
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct PartialFile {
    file: BufWriter<File>,
    partial: PathBuf,
    target: PathBuf,
    /// Whether something was written that may be of use.
    begun: bool,
}

impl PartialFile {
    /// Opens `NAME.partial` beside `target` and locks it for this process.
    ///
    /// # Errors
    /// [`RecordError::NotAFile`] when `target` is a directory or device, [`RecordError::Busy`] when
    /// another process writes the same file, [`RecordError::Create`] when it cannot be opened.
    pub fn create(target: &Path) -> Result<Self, RecordError> {
        if fs::metadata(target).is_ok_and(|found| !found.is_file()) {
            return Err(RecordError::NotAFile { path: target.into() });
        }
        let target = &*followed(target);
        let mut partial = target.as_os_str().to_owned();
        partial.push(".partial");
        let partial = PathBuf::from(partial);
        let failed = |source| RecordError::Create { path: partial.clone(), source };

        let file = loop {
            // Truncated only once it is locked: it may be another process's running recording.
            let file = File::options()
                .write(true)
                .create(true)
                .truncate(false)
                .open(&partial)
                .map_err(failed)?;
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Err(RecordError::Busy { path: partial }),
                // A file system without locks: two writers there are not told apart.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // Between opening and locking, the other process may have renamed it: then what is
            // locked here is its finished file.
            if partial.try_exists().map_err(failed)? {
                break file;
            }
        };
        file.set_len(0).map_err(failed)?;
        open().push(partial.clone());
        let file = BufWriter::with_capacity(1 << 17, file);
        Ok(Self { file, partial, target: target.into(), begun: false })
    }

    /// The file as it is called until it is whole.
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Ends the file and removes it.
    pub fn discard(mut self) {
        self.begun = false;
    }

    /// Gives the file its name, once all of it is on the disk.
    ///
    /// # Errors
    /// A failed write, or a name that cannot be given. The `.partial` file then stays.
    pub fn commit(mut self) -> io::Result<()> {
        self.begun = true;
        self.file.flush()?;
        self.file.get_ref().sync_all()?;
        fs::rename(&self.partial, &self.target)
    }
}

/// The unfinished files of this process.
static OPEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn open() -> MutexGuard<'static, Vec<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The unfinished files of this process that something was written to, for one that ends at once. Those that nothing was
/// written to are removed.
pub fn unfinished() -> Vec<PathBuf> {
    let is_empty = |path: &PathBuf| fs::metadata(path).is_ok_and(|found| found.len() == 0);
    let (empty, begun): (Vec<_>, Vec<_>) = open().iter().cloned().partition(is_empty);
    for path in empty {
        // Empty or of no use; if it stays, so be it.
        let _ = fs::remove_file(path);
    }
    begun
}

/// The file that a symbolic link leads to, whether it is there yet or not; another name as it is.
fn followed(target: &Path) -> Cow<'_, Path> {
    /// As many as the system follows.
    const LINKS: usize = 40;
    let mut at = Cow::Borrowed(target);
    for _ in 0..LINKS {
        let Ok(next) = fs::read_link(&at) else { break };
        // A relative link begins in its own folder.
        at = Cow::Owned(at.parent().unwrap_or(Path::new("")).join(next));
    }
    at
}

impl Write for PartialFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.begun = true;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for PartialFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.file.seek(position)
    }

    fn stream_position(&mut self) -> io::Result<u64> {
        // `BufWriter` answers this without the flush that its `seek` makes.
        self.file.stream_position()
    }
}

impl Sink for PartialFile {
    fn commit(self: Box<Self>) -> io::Result<()> {
        (*self).commit()
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        open().retain(|path| *path != self.partial);
        if !self.begun {
            // Empty or of no use; if it stays, so be it.
            let _ = fs::remove_file(&self.partial);
        }
    }
}
