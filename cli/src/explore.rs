//! `opm explore`: a page that shows a mechanism and its workspace.

use crate::args::{ExploreArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::{Shown, is_stdout, print_with};
use crate::target::{Target, ends_in};
use std::io::Write;

pub fn run(args: &ExploreArgs, output: &Output) -> Result<(), Failure> {
    let path = args.output.as_deref().filter(|path| !is_stdout(path));
    // Browsers take the kind of a file from its ending.
    path.map_or(Ok(()), |path| ends_in(path, &["html", "htm"]))?;
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(path) = path {
        loaded.refuse_as_output(path, &[])?;
    }
    // The page would say the same, but later.
    loaded.compile()?;
    let target = path.map(Target::create).transpose()?;
    let page = opm_export::explorer(&loaded.file_name, &loaded.text);
    let page = page.map_err(|error| Failure::at("explorer.html", error))?;
    let (Some(path), Some(target)) = (path, target) else {
        return print_with(|out| out.write_all(page.as_bytes()));
    };
    target.commit(page.as_bytes())?;
    output.note(format_args!("{}: open it in a browser", path.shown()));
    Ok(())
}
