//! Violations of a motion, read from its recording.

use super::label::value_label;
use super::source::{Rate, Source, quantity};
use crate::text::count;
use opm_mcap::Metadata;
use opm_plot::axis::label;

/// Number of violations that the notes list.
const LISTED: usize = 8;

/// A violation, read from a recording.
pub struct Violation {
    pub start: f64,
    pub end: f64,
    /// Whether a joint's acceleration is too large.
    pub accelerates: bool,
    /// The violation and its size, in words.
    text: String,
}

impl Violation {
    /// Reads a metadata record; `None` if it has no time.
    fn new(source: &Source<'_>, record: &Metadata) -> Option<Self> {
        let number = |key: &str| record.get(key)?.parse::<f64>().ok().filter(|n| n.is_finite());
        let word = |key: &str| record.get(key).map(String::as_str);
        let start = number("start")?;
        let end = number("end").unwrap_or(start);
        let section = word("section").map_or(String::new(), |section| format!("{section} "));
        let what = match word("kind") {
            Some("limit") => format!(
                "{} past its {} value",
                word("joint").unwrap_or("a joint"),
                word("bound").unwrap_or("last")
            ),
            Some(kind @ ("rate" | "acceleration")) => {
                format!("{} above its max_{kind}", word("joint").unwrap_or("a joint"))
            }
            Some("reach") => format!("out of reach in its {section}section"),
            Some("singularity") => {
                let kind = word("singularity").map_or(String::new(), |kind| format!("{kind} "));
                format!("{kind}singularity of the {section}section")
            }
            other => other.unwrap_or("violation").to_owned(),
        };
        let leg = word("leg").map_or(String::new(), |leg| format!("{leg}: "));
        let (unit, rate) = match word("unit").and_then(|unit| unit.split_once("/s")) {
            None => (word("unit"), Rate::Position),
            Some((unit, "")) => (Some(unit), Rate::Velocity),
            Some((unit, _)) => (Some(unit), Rate::Acceleration),
        };
        let measured = quantity(unit).zip(number("amount"));
        let by = measured.map_or(String::new(), |(quantity, amount)| {
            let (measure, factor) = source.measure("", Some(quantity), rate);
            format!(" by {} {}", value_label(amount / factor), measure.unit.symbol)
        });
        let accelerates = word("kind") == Some("acceleration");
        Some(Self { start, end, accelerates, text: format!("{leg}{what}{by}") })
    }
}

/// Violations in the order of their times.
pub fn violations(source: &Source<'_>) -> Vec<Violation> {
    let records = source.recording.metadata.iter();
    let records = records.filter(|(name, _)| name.starts_with("violation."));
    let mut found: Vec<Violation> =
        records.filter_map(|(_, record)| Violation::new(source, record)).collect();
    found.sort_by(|a, b| a.start.total_cmp(&b.start));
    found
}

/// The number of all violations: a recording may hold only the first of many.
pub fn count_of(source: &Source<'_>, violations: &[Violation]) -> usize {
    let all = source.metadata("result").get("violations").and_then(|count| count.parse().ok());
    all.unwrap_or(0).max(violations.len())
}

/// Notes that explain the marks; `all` is the number of all violations.
pub fn listed(violations: &[Violation], all: usize) -> Vec<String> {
    let note = |(number, violation): (usize, &Violation)| {
        let Violation { start, end, text, .. } = violation;
        let [start, end] = [*start, *end].map(|time| label(time, 3));
        match start == end {
            true => format!("{number}: at {start} s, {text}"),
            false => format!("{number}: {start} to {end} s, {text}"),
        }
    };
    let mut notes: Vec<String> = (1..).zip(violations).take(LISTED).map(note).collect();
    let more = all - notes.len();
    if more > 0 {
        let marked = match violations.len() {
            marked if marked < all => format!("; the first {} are marked", count(marked as u64)),
            _ => String::new(),
        };
        notes.push(format!("and {} more{marked}", count(more as u64)));
    }
    notes
}
