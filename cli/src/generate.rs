//! `opm generate`: the kinematics of a mechanism as source code.

use crate::args::{CodeArgs, GenerateArgs, Language, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::{Shown, is_stdout};
use crate::target::Target;
use opm_core::Manipulator;
use opm_generate::{Content, GenerateError, Package};
use std::fs;
use std::path::Path;

pub fn run(args: &GenerateArgs, output: &Output) -> Result<(), Failure> {
    match &args.language {
        Language::C(args) => write(args, opm_generate::c_package, output),
        Language::Rust(args) => write(args, opm_generate::rust, output),
        Language::Python(args) => write(args, opm_generate::python, output),
        Language::Matlab(args) => write(args, opm_generate::matlab, output),
        Language::St(args) => write(args, opm_generate::st, output),
    }
}

/// Writes the files of a language.
fn write(
    args: &CodeArgs,
    generate: impl Fn(&Manipulator, Content) -> Result<Package, GenerateError>,
    output: &Output,
) -> Result<(), Failure> {
    if is_stdout(&args.output) {
        let problem = format!("{}: expected a folder", args.output.shown());
        return Err(Failure::flag("--output", problem));
    }
    let loaded = load::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    let code = generate(&manipulator, args.content()).map_err(|e| Failure::at(&loaded.label, e))?;
    let code = code.with_dimensions(&loaded.file);
    let folder = &args.output;
    let files: Vec<_> = code.files.iter().map(|(name, text)| (folder.join(name), text)).collect();
    make(folder)?;
    for (path, _) in &files {
        path.parent().map_or(Ok(()), make)?;
        loaded.refuse_as_output(path, &[])?;
    }
    // All of them can be written before the first one is.
    let targets: Result<Vec<_>, _> = files.iter().map(|(path, _)| Target::create(path)).collect();
    let texts = files.iter().map(|(_, text)| text.as_bytes());
    Target::commit_all(targets?.into_iter().zip(texts))?;
    let names: Vec<&str> = code.files.iter().map(|(name, _)| &**name).collect();
    output.note(format_args!("{}: {}", folder.shown(), names.join(", ")));
    Ok(())
}

/// Makes a folder, and those that it is in.
fn make(folder: &Path) -> Result<(), Failure> {
    if folder.exists() && !folder.is_dir() {
        let path = folder.shown();
        return Err(Failure::work(format!("{path}: a file, expected a folder or a new name")));
    }
    fs::create_dir_all(folder).map_err(|error| Failure::at(folder.shown(), error))
}
