//! Files that are written at once, under a temporary name until they are whole.

use crate::failure::Failure;
use opm_mcap::{PartialFile, Sink};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A file that is written at once when the work is done: opened before it, so that a wrong path costs no time.
pub struct Target {
    path: PathBuf,
    file: Option<PartialFile>,
}

impl Target {
    /// Opens it under a temporary name.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.display(), e))?;
        Ok(Self { path: path.to_owned(), file: Some(file) })
    }

    /// Writes it, and gives it its name.
    pub fn commit(mut self, bytes: &[u8]) -> Result<(), Failure> {
        let Some(mut file) = self.file.take() else { return Ok(()) };
        // A small file is on the disk only once it is flushed.
        let written = match file.write_all(bytes).and_then(|()| file.flush()) {
            Ok(()) => file.commit(),
            Err(error) => {
                file.discard();
                Err(error)
            }
        };
        written.map_err(|error| Failure::at(self.path.display(), error))
    }
}

impl Drop for Target {
    /// An incomplete file is of no use.
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            file.discard();
        }
    }
}
