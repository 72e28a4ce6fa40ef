//! `opm check`: a certificate for a mechanism.

use crate::args::{CheckArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::progress::{interruptible, watch_steps};
use crate::text::{Table, count};
use opm_check::{Certificate, Comparison, Options, check};
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};

pub fn run(args: &CheckArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    let options = Options { samples: args.samples, seed: args.seed };
    let (progress, steps) = (interruptible()?, AtomicU64::new(0));
    let work = || {
        check(&manipulator, &options, |done| {
            steps.store(done, Ordering::Relaxed);
            !progress.is_cancelled()
        })
    };
    let done = || steps.load(Ordering::Relaxed);
    let found = watch_steps(output, "checking", Some(options.steps()), done, work);
    let certificate = found.ok_or_else(|| Failure::interrupted("interrupted"))?;
    output.print(&as_json(&certificate), text(&certificate))?;
    let mut broken = certificate.comparisons.iter().filter(|comparison| !comparison.holds());
    match broken.next() {
        None => Ok(()),
        Some(first) => {
            let problem = first.problem.as_deref().unwrap_or_default();
            Err(Failure::work(format!("{}: {} does not hold: {problem}", loaded.label, first.name)))
        }
    }
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
    text += "differences in radians, and lengths over the mechanism's size; derivatives over the largest one\n";
    text
}
