//! Files that are written at once, under a temporary name until they are whole.

use crate::failure::Failure;
use opm_mcap::PartialFile;
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
    pub fn commit(self, bytes: &[u8]) -> Result<(), Failure> {
        Self::commit_all([(self, bytes)])
    }

    /// Writes several files, and gives them their names once all of them are written.
    pub fn commit_all<'a>(
        files: impl IntoIterator<Item = (Self, &'a [u8])>,
    ) -> Result<(), Failure> {
        let write = |(mut target, bytes): (Self, &[u8])| target.write(bytes).map(|()| target);
        let written: Vec<Self> = files.into_iter().map(write).collect::<Result<_, _>>()?;
        written.into_iter().try_for_each(Self::place)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let Some(file) = &mut self.file else { return Ok(()) };
        // A small file is on the disk only once it is flushed.
        let written = file.write_all(bytes).and_then(|()| file.flush());
        written.map_err(|error| Failure::at(self.path.display(), error))
    }

    fn place(mut self) -> Result<(), Failure> {
        let Some(file) = self.file.take() else { return Ok(()) };
        file.commit().map_err(|error| Failure::at(self.path.display(), error))
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
