//! `opm recover`: what a run that was cut short has recorded.

use crate::args::{Output, RecoverArgs};
use crate::failure::Failure;
use crate::output::Shown;
use crate::progress::clean_up_at_ctrl_c;
use crate::target::{ends_in, refuse_inputs};
use crate::text::count;
use opm_mcap::input::is_same_file;
use opm_mcap::{ReadError, RecoverError, recover};
use opm_study::recording::recovered_name;
use serde_json::json;

pub fn run(args: &RecoverArgs, output: &Output) -> Result<(), Failure> {
    let label = args.file.shown();
    let target = args.output.clone().unwrap_or_else(|| recovered_name(&args.file));
    if is_same_file(&target, &args.file) {
        return Err(Failure::flag("--output", format!("{label} is the file to recover")));
    }
    refuse_inputs("--output", &target, [&*args.file])?;
    ends_in(&target, &["mcap"])?;
    clean_up_at_ctrl_c()?;
    let found = recover(&args.file, &target).map_err(|error| match error {
        RecoverError::Read(ReadError::Io { source, .. }) => Failure::at(&label, source),
        RecoverError::Read(error @ ReadError::NotMcap { .. }) => {
            Failure::because(format!("{label}: not an MCAP file"), error)
        }
        RecoverError::Record(error) => Failure::at(target.shown(), error),
        error => Failure::at(&label, error),
    })?;
    let seconds = found.time_range.map(|range| range.map(|time| time as f64 / 1e9));
    let json = json!({
        "file": label,
        "output": target.display().to_string(),
        "messages": found.messages,
        "attachments": found.attachments,
        "time": seconds,
        "damage": found.damage,
    });
    let messages = count(found.messages);
    output.print(&json, format_args!("{label}: {messages} messages, in {}\n", target.shown()))?;
    if let Some(damage) = &found.damage {
        output.warn(format_args!("it is damaged, and was read up to there: {damage}"));
    }
    Ok(())
}
