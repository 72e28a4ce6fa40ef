//! `opm measure`: areas, volumes and shares of all orientations, with bounds that are guaranteed.

use crate::args::{MeasureArgs, Output, SectionName};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::{GridAxis, OverAxis, flag_value};
use crate::progress::{interruptible, watch, watch_boxes};
use crate::runs::{self, Cell};
use crate::text::{self, Table, count, short};
use crate::unitless;
use crate::workspace::{modes, threads};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_core::numeric::number::readable;
use opm_study::unit_product;
use opm_workspace::measure::{
    CoordinateRange, Domain, DomainAxis, DomainError, Goal, Measured, SearchEnd, default_ranges,
    measure, measure_told,
};
use opm_workspace::{Cancelled, Modes, Progress};
use rayon::ThreadPool;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Measures of at least this size are shown with an exponent.
const LARGE: f64 = 1e7;

/// Number of digits of a double.
const MOST_DIGITS: i32 = 15;

pub fn run(args: &MeasureArgs, output: &Output) -> Result<(), Failure> {
    let mut loaded = load::read_as_it_is(&args.file)?;
    loaded.change(&args.change)?;
    if let Some(tolerance) = args.joint_tolerance {
        loaded.snap(tolerance, "--joint-tolerance")?;
        loaded.note_snapped(output);
    }
    if let Some(vary) = &args.vary {
        return table(args, &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let modes = modes(&args.mode, &manipulator)?;
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let ends = args.over.iter().flat_map(OverAxis::ends);
    unitless::note_ranges(output, "--over", (&loaded, &manipulator), ends);
    let domain = domain(args, output, (&loaded, &manipulator), modes, &pool, &progress)?;
    let goal = Goal { tolerance: args.tolerance, budget: args.budget };
    let before = progress.done();
    let start = Instant::now();
    let bounds = Mutex::new(None);
    let tell = |found: &Measured| {
        *bounds.lock().unwrap_or_else(PoisonError::into_inner) = Some(*found);
    };
    let job =
        || pool.install(|| measure_told(&manipulator, &domain, modes, &goal, &progress, tell));
    let told = || match *bounds.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(found) => format!("measuring, {}", between(&found)),
        None => "measuring".to_owned(),
    };
    let found = watch_boxes(output, args.budget, told, || progress.done() - before, job);
    let seconds = start.elapsed().as_secs_f64();
    let run = Run { loaded: &loaded, manipulator: &manipulator, domain: &domain, modes, args };
    output.print(&run.json(&found, seconds), run.text(&found, seconds))?;
    match found.stop {
        SearchEnd::Tolerance => {}
        SearchEnd::Budget => output.warn(run.beyond(&found)),
        SearchEnd::Exhausted => {
            output.warn(
                "the bounds hold, but come no closer: what is between them lies on the boundary of the workspace",
            );
        }
        SearchEnd::Cancelled => {
            return Err(Failure::interrupted("interrupted; the bounds hold"));
        }
    }
    Ok(())
}

/// The measure for each value of a number of the mechanism file.
fn table(
    args: &MeasureArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let silent = output.silent();
    let goal = Goal { tolerance: args.tolerance, budget: args.budget };
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let modes = modes(&args.mode, &manipulator)?;
        let domain = domain(args, &silent, (changed, &manipulator), modes, &pool, &progress)?;
        let found = pool.install(|| measure(&manipulator, &domain, modes, &goal, &progress));
        if found.stop == SearchEnd::Cancelled {
            return Err(Failure::interrupted("interrupted"));
        }
        let (unit, factor) = unit_product(&domain.powers(), loaded.file.units);
        let ends = [found.value(), found.lower, found.upper].map(|end| end / factor);
        let [value, lower, upper] = rounded(ends, resolving(ends[2] - ends[1], ends[2]));
        let units = unit_product(&domain.powers(), FileUnits::SI).0;
        Ok(vec![
            Cell {
                header: format!("measure [{unit}]"),
                ..Cell::new("measure", found.value(), value)
            },
            Cell { header: "at least".to_owned(), ..Cell::new("lower", found.lower, lower) },
            Cell { header: "at most".to_owned(), ..Cell::new("upper", found.upper, upper) },
            Cell {
                header: "share [%]".to_owned(),
                ..Cell::new("fraction", found.fraction(), short(100.0 * found.fraction()))
            },
            Cell { header: "in".to_owned(), ..Cell::new("units", units, unit) },
        ])
    })
}

/// The domain of the measure: given by the flags, or fitted to the workspace.
fn domain(
    args: &MeasureArgs,
    output: &Output,
    (loaded, manipulator): (&Loaded, &Manipulator),
    modes: Modes,
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<Domain, Failure> {
    let sections = args.section.sections();
    let coordinates = sections.coordinates(manipulator);
    let given: Result<Vec<CoordinateRange>, _> =
        args.over.iter().map(|axis| axis.resolve(&coordinates)).collect();
    let given = given.map_err(|error| Failure::flag("--over", error))?;
    // The flags are checked before any work is done.
    let checked = |over: &[CoordinateRange]| {
        Domain::new(manipulator, sections, over).map_err(|error| match error {
            DomainError::NoUpperSection | DomainError::Dependent { .. } => {
                Failure::flag("--section", error)
            }
            DomainError::Inclined | DomainError::Repeated => Failure::at(&loaded.label, error),
            error => Failure::flag("--over", error),
        })
    };
    checked(&given)?;
    let find = || pool.install(|| default_ranges(manipulator, sections, modes, &given, progress));
    let (over, beyond) = watch(output, "fitting ranges", None, || progress.done(), find)
        .map_err(|Cancelled| Failure::interrupted("interrupted while fitting ranges"))?;
    if over.len() > given.len() {
        let flags = over.iter().map(|CoordinateRange { name, min, max }| {
            let of = coordinates.iter().find(|c| c.name == *name);
            let shown = |end: f64| {
                of.map_or(end.to_string(), |c| flag_value(end, c.quantity, loaded.file.units))
            };
            let [low, high] = [min, max].map(|&end| shown(end));
            match min == max {
                true => format!("--over {name}={low}"),
                false => format!("--over {name}={low}:{high}"),
            }
        });
        output.note(format_args!("measured over {}", flags.collect::<Vec<_>>().join(" ")));
    }
    for name in beyond {
        output.warn(format_args!(
            "the workspace continues beyond this range along {name}; limit a joint, or give --over"
        ));
    }
    checked(&over)
}

/// The measured quantity and its results.
struct Run<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    domain: &'a Domain,
    modes: Modes,
    args: &'a MeasureArgs,
}

impl Run<'_> {
    /// `any`, or the signs of the mode.
    fn mode(&self) -> String {
        match self.modes {
            Modes::Any => "any".to_owned(),
            Modes::One(mode) => self.manipulator.format_mode(mode),
        }
    }

    fn json(&self, found: &Measured, seconds: f64) -> Value {
        let over: Map<String, Value> = (self.domain.axes().iter())
            .map(|axis| (axis.name.clone(), json!({ "min": axis.min, "max": axis.max })))
            .collect();
        let weights: Vec<&str> = self.domain.axes().iter().filter_map(DomainAxis::weight).collect();
        json!({
            "value": found.value(),
            "lower": found.lower,
            "upper": found.upper,
            "units": unit_product(&self.domain.powers(), FileUnits::SI).0,
            "fraction": found.fraction(),
            "boxes": found.boxes,
            "seconds": seconds,
            "whole": found.whole,
            "section": self.args.section.name(),
            "mode": self.mode(),
            "over": over,
            "weights": weights,
            "tolerance": self.args.tolerance,
            "reached": found.stop == SearchEnd::Tolerance,
        })
    }

    fn text(&self, found: &Measured, seconds: f64) -> String {
        let units = self.loaded.file.units;
        let mut text = self.manipulator.mechanism().name.clone();
        if self.args.section != SectionName::Whole {
            let _ = write!(text, ", {} section", self.args.section.name());
        }
        let mode = self.mode();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let mut axes = Table::new(["over", ">from", ">to", "unit", "weighed by"]);
        for axis in self.domain.axes() {
            let end = |value| text::number(value, axis.quantity, units);
            let (from, to) = (end(axis.min), end(axis.max));
            let to = if axis.min < axis.max { to } else { String::new() };
            let symbol = units.symbol(axis.quantity);
            axes.row([&*axis.name, &from, &to, symbol, axis.weight().unwrap_or("")]);
        }
        let _ = writeln!(text, "\n\n{axes}");

        let (symbol, factor) = unit_product(&self.domain.powers(), units);
        let ends = [found.value(), found.lower, found.upper];
        let decimals = |ends: [f64; 3]| resolving(ends[2] - ends[1], ends[2]);
        let measures = ends.map(|end| end / factor);
        let shares = ends.map(|end| 100.0 * end / found.whole);
        let mut results = Table::new(["", ">value", ">at least", ">at most", "unit"]);
        for (name, ends, unit) in [("measure", measures, &*symbol), ("share", shares, "%")] {
            let [value, lower, upper] = rounded(ends, decimals(ends));
            results.row([name, &value, &lower, &upper, unit]);
        }
        let _ = write!(text, "{results}");
        let (boxes, seconds) = (boxes(found.boxes), short(seconds));
        let certain = percent(found.uncertainty());
        let _ =
            writeln!(text, "\n{boxes} in {seconds} s; the value is certain to within {certain}");
        text
    }

    /// The warning that the budget was too small, with advice.
    fn beyond(&self, found: &Measured) -> String {
        let section = match self.args.section {
            SectionName::Whole if !self.manipulator.is_whole() => "--section upper, ",
            SectionName::Whole | SectionName::Upper | SectionName::Lower => "",
        };
        format!(
            "the --budget of {} ended before --tolerance was met: the value is certain to within \
             {}, and {} was asked for; the bounds hold, and narrower ranges of --over, {section}or a \
             larger --budget bring them closer",
            boxes(self.args.budget),
            percent(found.uncertainty()),
            percent(self.args.tolerance),
        )
    }
}

/// The share of the whole that is certain so far, in percent.
fn between(found: &Measured) -> String {
    let ends = [found.value(), found.lower, found.upper].map(|end| 100.0 * end / found.whole);
    let [_, lower, upper] = rounded(ends, resolving(ends[2] - ends[1], ends[2]));
    format!("between {lower} and {upper} %")
}

/// A share, rounded up to two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = if percent > 0.0 { (1 - exponent(percent)).max(0) } else { 0 };
    let power = 10_f64.powi(decimals);
    // The rounding error of the product with 100 is no reason to round up.
    format!("{} %", readable((percent * power * (1.0 - 1e-12)).ceil() / power))
}

/// The power of ten of the first digit of a number above zero.
fn exponent(x: f64) -> i32 {
    x.log10().floor() as i32
}

/// The number of decimals that distinguish two bounds this far apart, without false precision.
fn resolving(gap: f64, size: f64) -> i32 {
    if size <= 0.0 {
        return 0;
    }
    let most = MOST_DIGITS - 1 - exponent(size);
    if gap > 0.0 { (1 - exponent(gap)).min(most) } else { most }
}

/// Value and bounds with this many decimals. Bounds are rounded outward; large numbers have an exponent.
fn rounded([value, lower, upper]: [f64; 3], decimals: i32) -> [String; 3] {
    let power = 10_f64.powi(decimals);
    let large = upper >= LARGE;
    let shown = |x: f64| match x / power {
        x if large && x > 0.0 => format!("{x:.*e}", (decimals + exponent(x)).max(0) as usize),
        x => format!("{x:.*}", decimals.max(0) as usize),
    };
    [shown((value * power).round()), shown((lower * power).floor()), shown((upper * power).ceil())]
}

/// A number of boxes with its noun.
fn boxes(number: u64) -> String {
    format!("{} {}", count(number), if number == 1 { "box" } else { "boxes" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_away_from_the_value() {
        let shown = |ends: [f64; 3]| rounded(ends, resolving(ends[2] - ends[1], ends[2]));
        assert_eq!(shown([63.094, 63.0349, 63.1541]), ["63.09", "63.03", "63.16"]);
        assert_eq!(shown([5560.0, 5101.0, 6019.0]), ["5560", "5100", "6020"]);
        assert_eq!(shown([0.0, 0.0, 0.0]), ["0", "0", "0"]);
        assert_eq!(shown([1.0, 1.0, 1.0])[1], "1.00000000000000");
        assert_eq!(shown([1.1876e7, 1.1805e7, 1.1944e7]), ["1.188e7", "1.180e7", "1.195e7"]);
        assert_eq!(shown([3.9e11, 0.0, 7.8e11]), ["3.9e11", "0", "7.8e11"]);
        assert_eq!(shown([5.1e11, 9.7e10, 9.24e11]), ["5.1e11", "9e10", "9.3e11"]);
    }

    #[test]
    fn shares_are_rounded_up() {
        let shown = [0.01, 0.07, 0.123_1, 0.005_71, 1e-9, 1.0, 0.0].map(percent);
        let expected = ["1 %", "7 %", "13 %", "0.58 %", "0.0000001 %", "100 %", "0 %"];
        assert_eq!(shown, expected);
    }
}
