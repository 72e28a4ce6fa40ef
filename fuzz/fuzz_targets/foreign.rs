#![no_main]

#[allow(dead_code)]
#[path = "../../tests/tests/fuzzed/command.rs"]
mod command;

libfuzzer_sys::fuzz_target!(|data: &[u8]| command::foreign(data));
