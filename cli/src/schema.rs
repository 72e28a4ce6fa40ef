//! `opm schema`: JSON schemas of the files that opm reads.

use crate::args::{FileKind, SchemaArgs};
use crate::failure::Failure;
use crate::output::print_with;
use opm_core::{mechanism, motion};
use std::io::Write;

pub fn run(args: &SchemaArgs) -> Result<(), Failure> {
    let schema = match args.kind {
        FileKind::Mechanism => mechanism::file::schema(),
        FileKind::Motion => motion::file::schema(),
    };
    print_with(|out| out.write_all(schema.as_bytes()))
}
