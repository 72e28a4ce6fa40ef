//! `opm explore`: a page that shows a mechanism and its workspace.

use crate::args::{ExploreArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::{is_stdout, print_with};
use crate::target::Target;
use std::io::Write;
use std::path::Path;

pub fn run(args: &ExploreArgs, output: &Output) -> Result<(), Failure> {
    let path = args.output.as_deref().filter(|path| !is_stdout(path));
    path.map_or(Ok(()), ends_in_html)?;
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
    output.note(format_args!("{}: open it in a browser", path.display()));
    Ok(())
}

/// Browsers take the kind of a file from its ending.
fn ends_in_html(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|ending| ending == "html" || ending == "htm") {
        return Ok(());
    }
    let problem = format!("{}: expected a name that ends in .html", path.display());
    Err(Failure::flag("--output", problem))
}
