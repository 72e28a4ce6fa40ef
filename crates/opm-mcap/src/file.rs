//! A file that appears under its name only once it is whole.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::RecordError;

/// Where a recording goes.
///
/// Dropping a sink that was not committed must leave nothing that looks finished.
pub trait Sink: Write + Seek {
    /// Makes what was written final. Called once, after the last byte.
    fn commit(self) -> io::Result<()>;
}

/// In memory there is nothing to make final. Lend a buffer to keep what is written:
/// `Cursor::new(&mut bytes)`.
impl Sink for io::Cursor<&mut Vec<u8>> {
    fn commit(self) -> io::Result<()> {
        Ok(())
    }
}

/// A file being written as `NAME.partial`, which [`Sink::commit`] renames to `NAME`.
///
/// Until then whatever stands under `NAME` stays as it is; afterwards it is replaced. A run that
/// ends early, however it ends, leaves the `.partial` file, which the next run overwrites, unless that is
/// [discarded](Self::discard).
#[derive(Debug)]
pub struct PartialFile {
    file: BufWriter<File>,
    partial: PathBuf,
    target: PathBuf,
    /// Something was written.
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
        let file = BufWriter::with_capacity(1 << 17, file);
        Ok(Self { file, partial, target: target.into(), begun: false })
    }

    /// Ends it without a trace: what was written is of no use to anybody.
    pub fn discard(mut self) {
        self.begun = false;
    }
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
    fn commit(mut self) -> io::Result<()> {
        self.begun = true;
        self.file.flush()?;
        self.file.get_ref().sync_all()?;
        fs::rename(&self.partial, &self.target)
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        if !self.begun {
            // Empty or of no use; if it stays, so be it.
            let _ = fs::remove_file(&self.partial);
        }
    }
}
