//! Files that are written at once, under a temporary name until they are whole.

use crate::failure::Failure;
use crate::output::Shown;
use crate::progress::clean_up_at_ctrl_c;
use opm_mcap::PartialFile;
use opm_mcap::input::is_same_file;
use opm_study::recording::partial;
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
        clean_up_at_ctrl_c()?;
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.shown(), e))?;
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
        written.map_err(|error| Failure::at(self.path.shown(), error))
    }

    fn place(mut self) -> Result<(), Failure> {
        let Some(file) = self.file.take() else { return Ok(()) };
        file.commit().map_err(|error| Failure::at(self.path.shown(), error))
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

/// Checks the ending of the name of an output, in capitals or not.
pub fn ends_in(path: &Path, endings: &[&str]) -> Result<(), Failure> {
    let found = path.extension();
    if endings.iter().any(|ending| found.is_some_and(|found| found.eq_ignore_ascii_case(ending))) {
        return Ok(());
    }
    let expected = endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>();
    let expected = expected.join(" or ");
    let problem = format!("{}: expected a name that ends in {expected}", path.shown());
    Err(Failure::flag("--output", problem))
}

/// Refuses an output that would replace an input, also while it is written under its temporary name.
pub fn refuse_inputs<'a>(
    flag: &str,
    output: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let unfinished = partial(output);
    for input in inputs {
        if is_same_file(output, input) {
            return Err(Failure::flag(flag, format!("{} is also the input", output.shown())));
        }
        if is_same_file(&unfinished, input) {
            let (output, unfinished) = (output.shown(), unfinished.shown());
            let problem =
                format!("{unfinished}, as {output} is called until it is whole, is also the input");
            return Err(Failure::flag(flag, problem));
        }
    }
    Ok(())
}
