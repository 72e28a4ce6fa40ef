//! What there is to say of a motion when it is over.

use super::Run;
use crate::text::{self, Table, count, short};
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::trajectory::{Sample, Told, Violation};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Violations that are listed; their number is told in any case.
pub const MOST_LISTED: usize = 10_000;

/// Violations in text: a person reads no more.
const MOST_SHOWN: usize = 20;

/// Lowest and highest value.
#[derive(Clone, Copy, Debug)]
struct Range([f64; 2]);

impl Range {
    const NONE: Self = Self([f64::INFINITY, f64::NEG_INFINITY]);

    fn add(&mut self, value: f64) {
        self.0 = [self.0[0].min(value), self.0[1].max(value)];
    }

    fn get(self) -> Option<[f64; 2]> {
        (self.0[0] <= self.0[1]).then_some(self.0)
    }
}

/// Of a coordinate: its position, its velocity and its acceleration.
type Ranges = [Range; 3];

/// What a motion comes to.
pub struct Summary {
    pub samples: u64,
    /// Samples in reach.
    reached: u64,
    /// Samples in reach and within all limits.
    pub valid: u64,
    joints: Vec<Ranges>,
    imaginary: Vec<Ranges>,
    /// The worst condition number and when.
    condition: Option<[f64; 2]>,
    pub violations: Vec<Violation>,
    pub violation_count: u64,
}

impl Summary {
    pub fn new(manipulator: &Manipulator) -> Self {
        Self {
            samples: 0,
            reached: 0,
            valid: 0,
            joints: vec![[Range::NONE; 3]; manipulator.coordinates().len()],
            imaginary: vec![[Range::NONE; 3]; manipulator.imaginary().len()],
            condition: None,
            violations: Vec::new(),
            violation_count: 0,
        }
    }

    pub fn add(&mut self, sample: &Sample) {
        self.samples += 1;
        self.reached += u64::from(sample.reached);
        self.valid += u64::from(sample.valid());
        if !sample.reached {
            return;
        }
        let condition = sample.condition;
        if self.condition.is_none_or(|[worst, _]| condition > worst) {
            self.condition = Some([condition, sample.time]);
        }
        let (solution, motion) = (&sample.solution, &sample.motion);
        for (ranges, positions, rates, accelerations) in [
            (&mut self.joints, &solution.joints, &motion.joint_rates, &motion.joint_accelerations),
            (
                &mut self.imaginary,
                &solution.imaginary,
                &motion.imaginary_rates,
                &motion.imaginary_accelerations,
            ),
        ] {
            for (i, [position, velocity, acceleration]) in ranges.iter_mut().enumerate() {
                position.add(positions[i]);
                if sample.regular {
                    velocity.add(rates[i]);
                    acceleration.add(accelerations[i]);
                }
            }
        }
    }

    pub fn violation(&mut self, violation: Violation) {
        self.violation_count += 1;
        if self.violations.len() < MOST_LISTED {
            self.violations.push(violation);
        }
    }

    /// In the order of their beginnings.
    pub fn sort(&mut self) {
        self.violations.sort_by(|a, b| a.start.total_cmp(&b.start));
    }

    pub fn json(&self, run: &Run<'_>) -> Value {
        let ranges = |[position, velocity, acceleration]: &Ranges| {
            json!({
                "position": position.get(),
                "velocity": velocity.get(),
                "acceleration": acceleration.get(),
            })
        };
        let manipulator = run.manipulator;
        let joints: Map<String, Value> = (manipulator.coordinates().iter().zip(&self.joints))
            .map(|(c, r)| (c.name.clone(), ranges(r)))
            .collect();
        let imaginary: Map<String, Value> = (manipulator.imaginary().iter().zip(&self.imaginary))
            .map(|(joint, r)| (joint.name.clone(), ranges(r)))
            .collect();
        let violations: Vec<Value> =
            self.violations.iter().map(|v| json(&Told::new(v, manipulator))).collect();
        json!({
            "name": manipulator.mechanism().name,
            "motion": run.motion.motion.name,
            "mode": manipulator.format_mode(run.mode),
            "start": run.motion.motion.start,
            "duration": run.motion.motion.duration,
            "rate": run.rate,
            "samples": self.samples,
            "reached": self.reached,
            "valid": self.valid,
            "joints": joints,
            "imaginary": imaginary,
            "condition": self.condition.map(|[worst, time]| json!({
                "worst": worst, "time": time,
            })),
            "violation_count": self.violation_count,
            "violations": violations,
        })
    }

    pub fn text(&self, run: &Run<'_>) -> String {
        let units = run.loaded.file.units;
        let manipulator = run.manipulator;
        let motion = &run.motion.motion;
        let mut text = format!("{}, {}", manipulator.mechanism().name, motion.name);
        let mode = manipulator.format_mode(run.mode);
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let _ = writeln!(
            text,
            "\n{} s at {} Hz: {} samples, {} in reach, {} within limits\n",
            short(motion.duration),
            short(run.rate),
            count(self.samples),
            count(self.reached),
            count(self.valid)
        );
        let mut table = Table::new([
            "joint", "kind", "unit", ">min", ">max", ">min /s", ">max /s", ">min /s2", ">max /s2",
        ]);
        let mut row = |name: &str, kind: &str, quantity: Quantity, ranges: &Ranges| {
            let mut cells =
                vec![name.to_owned(), kind.to_owned(), units.symbol(quantity).to_owned()];
            for range in ranges {
                cells.extend(match range.get() {
                    Some(ends) => ends.map(|end| text::number(end, quantity, units)),
                    None => ["-", "-"].map(String::from),
                });
            }
            table.row(cells);
        };
        let kinds = manipulator.mechanism().joints().flat_map(|joint| {
            let kind = if joint.actuated { "actuated" } else { "passive" };
            joint.coordinates.iter().map(move |_| kind)
        });
        for ((c, ranges), kind) in manipulator.coordinates().iter().zip(&self.joints).zip(kinds) {
            row(&c.name, kind, c.quantity, ranges);
        }
        for (joint, ranges) in manipulator.imaginary().iter().zip(&self.imaginary) {
            row(&joint.name, "imaginary", joint.quantity, ranges);
        }
        let _ = write!(text, "{table}");
        if let Some([worst, time]) = self.condition {
            let worst = if worst.is_finite() { short(worst) } else { "infinite".into() };
            let _ = writeln!(text, "\ncondition number at most {worst}, at t = {} s", short(time));
        }
        for violation in self.violations.iter().take(MOST_SHOWN) {
            let _ = writeln!(text, "{}", line(violation, run));
        }
        let more = self.violation_count.saturating_sub(MOST_SHOWN as u64);
        if more > 0 {
            let _ = writeln!(text, "and {} more violations", count(more));
        }
        text
    }

    /// The first violation in words.
    pub fn first(&self, run: &Run<'_>) -> String {
        let first = self.violations.first();
        first.map_or_else(String::new, |violation| line(violation, run))
    }
}

/// Keys and values of a violation, the same in JSON and in the recording.
pub fn fields(told: &Told<'_>) -> Vec<(&'static str, Value)> {
    let Violation { start, end, worst, amount, .. } = *told.violation;
    let mut fields = vec![
        ("kind", json!(told.kind)),
        ("start", json!(start)),
        ("end", json!(end)),
        ("worst", json!(worst)),
        ("amount", json!(amount)),
        ("unit", json!(told.unit())),
    ];
    let words = [
        ("leg", told.leg.map(String::from)),
        ("joint", told.joint.map(String::from)),
        ("section", told.section.map(|section| section.to_string())),
        ("bound", told.bound.map(|bound| bound.name().to_owned())),
        ("singularity", told.singularity().map(String::from)),
    ];
    fields.extend(words.into_iter().filter_map(|(key, word)| Some((key, json!(word?)))));
    fields
}

fn json(told: &Told<'_>) -> Value {
    fields(told).into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// One line for people, in the units of the mechanism file.
fn line(violation: &Violation, run: &Run<'_>) -> String {
    let Violation { start, end, worst, amount, quantity, .. } = *violation;
    let (what, units) = (Told::new(violation, run.manipulator).what(), run.loaded.file.units);
    match quantity {
        Some(quantity) => format!(
            "t = {start:.6} .. {end:.6} s: {what} by {} {} at {worst:.6} s",
            text::number(amount, quantity, units),
            units.symbol(quantity)
        ),
        None => format!("t = {start:.6} s: {what}"),
    }
}
