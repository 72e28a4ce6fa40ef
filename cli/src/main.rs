//! The program `opm`: see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    opm_cli::main(std::env::args_os()).into()
}

/// Asks whether standard output is closed before the runtime opens `/dev/null` in its place. The attribute puts the function
/// among those that the system calls before `main`; it is why the package denies and does not forbid `unsafe_code`.
#[cfg(any(target_os = "linux", target_os = "macos"))]
#[used]
#[expect(unsafe_code, reason = "the attribute counts as unsafe; there is no unsafe code in it")]
#[cfg_attr(target_os = "linux", unsafe(link_section = ".init_array"))]
#[cfg_attr(target_os = "macos", unsafe(link_section = "__DATA,__mod_init_func"))]
static BEFORE_MAIN: extern "C" fn() = {
    extern "C" fn look() {
        opm_cli::look_at_stdout();
    }
    look
};
