//! `opm check`: a certificate for a mechanism.

use crate::args::{CheckArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::progress::{interruptible, watch_steps};
use crate::runs::{self, Cell};
use crate::text::{Table, count};
use opm_check::{Certificate, Comparison, Options, check};
use opm_workspace::Progress;
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};

/// A misfit up to this is rounding of exact numbers.
const EXACT: f64 = 1e-12;

pub fn run(args: &CheckArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let progress = interruptible()?;
    if let Some(vary) = &args.vary {
        return table(args, &loaded, vary, output, &progress);
    }
    let certificate = certify(args, &loaded, output, &progress)?;
    output.print(&as_json(&certificate), text(&certificate))?;
    broken(&certificate, &loaded).map_or(Ok(()), |problem| Err(Failure::work(problem)))
}

fn certify(
    args: &CheckArgs,
    loaded: &Loaded,
    output: &Output,
    progress: &Progress,
) -> Result<Certificate, Failure> {
    let manipulator = loaded.compile()?;
    let options = Options { samples: args.samples, seed: args.seed };
    let steps = AtomicU64::new(0);
    let work = || {
        check(&manipulator, &options, |done| {
            steps.store(done, Ordering::Relaxed);
            !progress.is_cancelled()
        })
    };
    let done = || steps.load(Ordering::Relaxed);
    let found = watch_steps(output, "checking", Some(options.steps()), done, work);
    found.ok_or_else(|| Failure::interrupted("interrupted"))
}

/// The first thing that does not hold.
fn broken(certificate: &Certificate, loaded: &Loaded) -> Option<String> {
    let first = certificate.comparisons.iter().find(|comparison| !comparison.holds())?;
    let problem = first.problem.as_deref().unwrap_or_default();
    Some(format!("{}: {} does not hold: {problem}", loaded.label, first.name))
}

/// The certificate for each value of a number of the mechanism file.
fn table(
    args: &CheckArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
    progress: &Progress,
) -> Result<(), Failure> {
    let silent = output.silent();
    let mut first = None;
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let certificate = certify(args, changed, &silent, progress)?;
        first = first.take().or_else(|| broken(&certificate, changed));
        let worst = |found: &Comparison| {
            let worst = found.worst.unwrap_or(f64::NAN);
            let shown = if worst.is_finite() { format!("{worst:.1e}") } else { "-".to_owned() };
            Cell::new(found.name, worst, shown)
        };
        let holds = Cell::answer("holds", certificate.holds());
        Ok([holds].into_iter().chain(certificate.comparisons.iter().map(worst)).collect())
    })?;
    first.map_or(Ok(()), |problem| Err(Failure::work(problem)))
}

fn as_json(certificate: &Certificate) -> Value {
    let comparison = |found: &Comparison| {
        json!({
            "name": found.name,
            "what": found.what,
            "holds": found.holds(),
            "compared": found.compared,
            "left_out": found.left_out,
            "because": found.because,
            "worst": found.worst.filter(|worst| worst.is_finite()),
            "tolerance": found.tolerance,
            "problem": found.problem,
        })
    };
    json!({
        "name": certificate.name,
        "version": env!("CARGO_PKG_VERSION"),
        "samples": certificate.options.samples,
        "seed": certificate.options.seed,
        "holds": certificate.holds(),
        "misfit": certificate.misfit,
        "comparisons": certificate.comparisons.iter().map(comparison).collect::<Vec<_>>(),
    })
}

fn text(certificate: &Certificate) -> String {
    let Options { samples, seed } = certificate.options;
    let state =
        if certificate.holds() { "everything compared holds" } else { "NOT everything holds" };
    let mut text = format!("{}: {state} ({samples} samples, seed {seed})\n\n", certificate.name);
    let mut table = Table::new(["", "", ">compared", ">left out", ">worst", ">allowed"]);
    for found in &certificate.comparisons {
        let number =
            |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.1e}"));
        let holds = match (found.holds(), found.compared) {
            (false, _) => "does not hold",
            (true, 0) => "not compared",
            (true, _) => "holds",
        };
        table.row([
            found.name.to_owned(),
            holds.to_owned(),
            count(found.compared),
            count(found.left_out),
            number(found.worst),
            number(found.tolerance),
        ]);
    }
    let _ = writeln!(text, "{table}");
    for found in &certificate.comparisons {
        let _ = write!(text, "{}: {}", found.name, found.what);
        if let Some(because) = &found.because {
            let _ = write!(text, "; left out: {because}");
        }
        text.push('\n');
    }
    if certificate.misfit > EXACT {
        let _ = writeln!(
            text,
            "the joints miss their subspaces by {:.1e} (radians, or shares of the mechanism's size): it holds within \
             multiples of that",
            certificate.misfit
        );
    }
    text += "differences in radians, and lengths over the mechanism's size; derivatives over the largest one\n";
    text
}
