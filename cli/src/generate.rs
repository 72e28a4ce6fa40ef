//! `opm generate`: the kinematics of a mechanism as source code.

use crate::args::{CArgs, GenerateArgs, Language, Output};
use crate::failure::Failure;
use crate::load;
use crate::target::Target;
use std::fs;

pub fn run(args: &GenerateArgs, output: &Output) -> Result<(), Failure> {
    match &args.language {
        Language::C(args) => run_c(args, output),
    }
}

fn run_c(args: &CArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    let code = opm_generate::c(&manipulator).map_err(|e| Failure::at(&loaded.label, e))?;
    let folder = &args.output;
    fs::create_dir_all(folder).map_err(|error| Failure::at(folder.display(), error))?;
    let named = code.files().into_iter().map(|(name, text)| (folder.join(name), text));
    let files: Vec<_> = named.collect();
    for (path, _) in &files {
        loaded.refuse_as_output(path, &[])?;
    }
    // All of them can be written before the first one is.
    let targets: Result<Vec<_>, _> = files.iter().map(|(path, _)| Target::create(path)).collect();
    for (target, (_, text)) in targets?.into_iter().zip(&files) {
        target.commit(text.as_bytes())?;
    }
    let names: Vec<String> = code.files().into_iter().map(|(name, _)| name).collect();
    output.note(format_args!("{}: {}", folder.display(), names.join(", ")));
    Ok(())
}
