//! The program `opm`: see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    opm_cli::main(std::env::args_os()).into()
}
