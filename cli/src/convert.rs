//! `opm convert`: a mechanism file, written anew.

use crate::args::{ConvertArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::{is_stdout, print_with};
use crate::target::{Target, ends_in};
use opm_core::mechanism::file::{self, Digits};
use std::io::Write;

pub fn run(args: &ConvertArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open_as_it_is(&args.mechanism, output)?;
    let text = match args.joints {
        true => file::write(&loaded.file.mechanism, loaded.file.units, Digits::All),
        false => loaded.text.clone(),
    };
    let Some(path) = args.output.as_deref().filter(|path| !is_stdout(path)) else {
        return print_with(|out| out.write_all(text.as_bytes()));
    };
    loaded.refuse_as_output(path, &[])?;
    ends_in(path, &["toml"])?;
    Target::create(path)?.commit(text.as_bytes())
}
