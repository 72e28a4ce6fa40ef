//! The aspects of assemblies: which of them are joined by paths without a singularity.

use crate::args::{FkArgs, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::progress::interruptible;
use crate::unitless;
use crate::workspace::{Work, threads};
use opm_core::forward::Assembly;
use opm_core::manipulator::{Manipulator, Mode};
use opm_workspace::{Aspects, aspect_at};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

/// The number of the aspect of each assembly, in its working mode; `None` if the grid does not tell.
pub fn of(
    args: &FkArgs,
    list: &[Assembly],
    loaded: &Loaded,
    output: &Output,
) -> Result<Vec<Option<u32>>, Failure> {
    let manipulator = Arc::new(loaded.compile()?);
    let ends = args.grid.iter().flat_map(crate::pose::GridAxis::ends);
    unitless::note_ranges(output, "--grid", (loaded, &manipulator), ends);
    let (progress, pool) = (interruptible()?, threads(None)?);
    let work = Work { output, pool: &pool, progress: &progress };
    let mut known: Vec<(Mode, Aspects)> = vec![];
    let mut labels = vec![];
    for Assembly { mode, pose, .. } in list {
        if known.iter().all(|(other, _)| other != mode) {
            let aspects = work.aspects(&manipulator, *mode, &args.grid, loaded.file.units)?;
            known.push((*mode, aspects));
        }
        let aspects = known.iter().find(|(other, _)| other == mode);
        labels.push(aspects.and_then(|(_, aspects)| aspect_at(&manipulator, *mode, aspects, pose)));
    }
    Ok(labels)
}

/// Which assemblies share an aspect, in words.
pub fn text(manipulator: &Manipulator, list: &[Assembly], aspects: &[Option<u32>]) -> String {
    let mut shared: BTreeMap<(String, u32), Vec<String>> = BTreeMap::new();
    for (number, (assembly, aspect)) in list.iter().zip(aspects).enumerate() {
        let Some(aspect) = aspect else { continue };
        let key = (manipulator.format_mode(assembly.mode), *aspect);
        shared.entry(key).or_default().push((number + 1).to_string());
    }
    let mut text = String::new();
    for ((_, aspect), numbers) in shared {
        let [others @ .., last] = &numbers[..] else { continue };
        if !others.is_empty() {
            let others = others.join(", ");
            let _ = writeln!(
                text,
                "\n{others} and {last} share aspect {aspect}: paths without a singularity join them"
            );
        }
    }
    text
}
