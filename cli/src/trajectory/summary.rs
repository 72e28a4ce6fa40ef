//! The printed summary of a motion.

use crate::interference::set_aside_json;
use crate::text::{self, Table, count, length_text, short};
use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::joint::DriveLimit;
use opm_core::trajectory::{Violation, ViolationReport};
use opm_interference::Contact;
use opm_study::recording::violation_fields;
use opm_study::{Bearing, Contacts, CoordinateRanges, Duty, MotionRequest, MotionSummary};
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The share of the largest force or moment that is rounding.
const ROUNDING: f64 = 1e-9;
/// Number of violations in text; nobody reads more.
const MOST_SHOWN: usize = 20;

/// The results of a followed motion, for printing.
pub struct Report<'a> {
    pub request: MotionRequest<'a>,
    pub summary: &'a MotionSummary,
    /// The units of the mechanism file.
    pub units: FileUnits,
    /// The duration of the motion as it is given, seconds, if it got another timing.
    pub given_duration: Option<f64>,
}

impl Report<'_> {
    pub fn json(&self) -> Value {
        let ranges = |[position, velocity, acceleration]: &CoordinateRanges| {
            json!({
                "position": position.get(),
                "velocity": velocity.get(),
                "acceleration": acceleration.get(),
            })
        };
        let Self { request, summary, given_duration, .. } = self;
        let manipulator = request.manipulator;
        let dependent: Map<String, Value> =
            (manipulator.dependent_coordinates().iter().zip(&summary.dependent))
                .map(|(c, r)| (c.name.to_owned(), ranges(r)))
                .collect();
        let joints: Map<String, Value> = (manipulator.coordinates().iter().zip(&summary.joints))
            .map(|(c, r)| (c.name.clone(), ranges(r)))
            .collect();
        let imaginary: Map<String, Value> =
            (manipulator.imaginary().iter().zip(&summary.imaginary))
                .map(|(joint, r)| (joint.name.clone(), ranges(r)))
                .collect();
        let violations: Vec<Value> = summary
            .violations
            .iter()
            .map(|v| json(&ViolationReport::new(v, manipulator)))
            .collect();
        let mut json = json!({
            "name": manipulator.mechanism().name,
            "motion": request.motion.name,
            "mode": manipulator.format_mode(request.mode),
            "start": request.motion.start,
            "duration": request.motion.duration,
            "rate": request.rate,
            "samples": summary.samples,
            "reached": summary.reached,
            "valid": summary.valid,
            "joints": joints,
            "imaginary": imaginary,
            "condition": summary.condition.map(|[worst, time]| json!({
                "worst": worst, "time": time,
            })),
            "violation_count": summary.violation_count,
            "violations": violations,
        });
        if let Some(contacts) = &summary.contacts {
            json["interference"] = contacts_json(contacts);
        }
        if request.efforts.is_some() {
            let motor = |(name, duty): (String, &Duty)| {
                let [peak, time] = duty.peak.map_or([None; 2], |peak| peak.map(Some));
                let [gives, takes] = duty.power;
                let duty = json!({
                    "peak": peak, "time": time, "rate": duty.peak.map(|_| duty.rate_at_peak),
                    "rms": duty.rms(), "power": [takes, gives],
                });
                (name, duty)
            };
            json["efforts"] = self.motors().map(motor).collect::<Map<_, _>>().into();
        }
        if request.reactions.is_some() {
            let largest = |found: Option<[f64; 2]>| {
                found.map(|[largest, time]| json!({ "largest": largest, "time": time }))
            };
            let bearing = |(name, found): (&str, &Bearing)| {
                let both =
                    json!({ "force": largest(found.force), "moment": largest(found.moment) });
                (name.to_owned(), both)
            };
            json["reactions"] = self.bearings().map(bearing).collect::<Map<_, _>>().into();
        }
        if let Some(given) = given_duration {
            json["given_duration"] = json!(given);
        }
        if !dependent.is_empty() {
            json["dependent"] = dependent.into();
        }
        json
    }

    pub fn text(&self) -> String {
        let Self { request, summary, units, given_duration } = *self;
        let MotionRequest { manipulator, motion, .. } = request;
        let mut text = format!("{}, {}", manipulator.mechanism().name, motion.name);
        let mode = manipulator.format_mode(request.mode);
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let _ = writeln!(
            text,
            "\n{} s{} at {} Hz: {} samples, {} in reach, {} within limits\n",
            short(motion.duration),
            given_duration
                .map_or_else(String::new, |given| format!(" ({} s as given)", short(given))),
            short(request.rate),
            count(summary.samples),
            count(summary.reached),
            count(summary.valid)
        );
        let mut table = Table::new([
            "joint", "kind", "unit", ">min", ">max", ">min /s", ">max /s", ">min /s2", ">max /s2",
        ]);
        let mut row = |name: &str, kind: &str, quantity: Quantity, ranges: &CoordinateRanges| {
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
        for ((c, ranges), kind) in manipulator.coordinates().iter().zip(&summary.joints).zip(kinds)
        {
            row(&c.name, kind, c.quantity, ranges);
        }
        for (joint, ranges) in manipulator.imaginary().iter().zip(&summary.imaginary) {
            row(&joint.name, "imaginary", joint.quantity, ranges);
        }
        for (c, ranges) in manipulator.dependent_coordinates().iter().zip(&summary.dependent) {
            row(c.name, "dependent", c.quantity, ranges);
        }
        let _ = write!(text, "{table}");
        if let Some([worst, time]) = summary.condition {
            let worst = if worst.is_finite() { short(worst) } else { "infinite".into() };
            let _ = writeln!(text, "\ncondition number at most {worst}, at t = {} s", short(time));
        }
        text += &self.motors_text();
        text += &self.bearings_text();
        for violation in summary.violations.iter().take(MOST_SHOWN) {
            let _ = writeln!(text, "{}", self.line(violation));
        }
        let more = summary.violation_count.saturating_sub(MOST_SHOWN as u64);
        if more > 0 {
            let _ = writeln!(text, "and {} more violations", count(more));
        }
        if let Some(contacts) = &summary.contacts {
            text += &self.contacts_text(contacts);
        }
        text
    }

    /// What each motor has to do.
    fn motors(&self) -> impl Iterator<Item = (String, &Duty)> {
        let manipulator = self.request.manipulator;
        let name = |&number: &usize| manipulator.coordinates()[number].name.clone();
        manipulator.actuated().iter().map(name).zip(&self.summary.motors)
    }

    /// The table from which motors are bought; nothing without efforts.
    fn motors_text(&self) -> String {
        if self.request.efforts.is_none() {
            return String::new();
        }
        let (manipulator, units) = (self.request.manipulator, self.units);
        let mut table = Table::new([
            "motor",
            "unit",
            ">peak",
            ">at t [s]",
            ">at rate",
            ">rms",
            ">peak rate",
            "unit",
            ">gives [W]",
            ">takes [W]",
        ]);
        for ((name, duty), &number) in self.motors().zip(manipulator.actuated()) {
            let quantity = manipulator.coordinates()[number].quantity;
            let unit = DriveLimit::Effort.unit(quantity);
            let known = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
            let rate = self.summary.joints[number][1].get();
            let rate = rate.map(|[low, high]| low.abs().max(high.abs()));
            let shown = |rate: Option<f64>| {
                rate.map_or_else(|| "-".to_owned(), |rate| text::number(rate, quantity, units))
            };
            table.row([
                name,
                unit.to_owned(),
                known(duty.peak.map(|[peak, _]| peak)),
                known(duty.peak.map(|[_, time]| time)),
                shown(duty.peak.map(|_| duty.rate_at_peak)),
                known(duty.rms()),
                shown(rate),
                format!("{}/s", units.symbol(quantity)),
                short(duty.power[0]),
                short(0.0 - duty.power[1]),
            ]);
        }
        format!("\n{table}")
    }

    /// What each joint has to bear.
    fn bearings(&self) -> impl Iterator<Item = (&str, &Bearing)> {
        let joints = self.request.manipulator.mechanism().joints();
        joints.map(|joint| &*joint.name).zip(&self.summary.bearings)
    }

    /// The table from which bearings are bought; nothing without reactions.
    fn bearings_text(&self) -> String {
        if self.request.reactions.is_none() {
            return String::new();
        }
        let mut table =
            Table::new(["joint", ">force [N]", ">at t [s]", ">moment [N m]", ">at t [s]"]);
        // What is far below the largest is rounding: a ball passes no moment on.
        let most = |of: fn(&Bearing) -> Option<[f64; 2]>| {
            let sizes = self.summary.bearings.iter().filter_map(of).map(|[size, _]| size);
            sizes.fold(0.0, f64::max)
        };
        let most = [most(|of| of.force), most(|of| of.moment)];
        for (name, Bearing { force, moment }) in self.bearings() {
            let cells =
                [force, moment].into_iter().zip(most).flat_map(|(found, most)| match found {
                    Some([size, _]) if *size <= ROUNDING * most => ["0".to_owned(), "-".to_owned()],
                    Some(found) => found.map(short),
                    None => ["-", "-"].map(str::to_owned),
                });
            table.row(std::iter::once(name.to_owned()).chain(cells));
        }
        format!("\n{table}")
    }

    /// The nearest bodies, and the contacts, in words.
    fn contacts_text(&self, of: &Contacts) -> String {
        let Some((nearest, time)) = of.nearest else { return String::new() };
        let [one, other] = of.interference.names_of(nearest.pair);
        let mut text = format!(
            "\nnearest bodies: {one} and {other}, {} at t = {} s\n",
            length_text(nearest.distance, self.units),
            short(time)
        );
        for contact in of.contacts.iter().take(MOST_SHOWN) {
            let _ = writeln!(text, "{}", self.contact_line(of, contact));
        }
        let more = of.contacts.len().saturating_sub(MOST_SHOWN);
        if more > 0 {
            let _ = writeln!(text, "and {} more contacts", count(more as u64));
        }
        text
    }

    fn contact_line(&self, of: &Contacts, contact: &Contact) -> String {
        let Contact { pair, start, end, worst, distance } = *contact;
        let [one, other] = of.interference.names_of(pair);
        let nearest = length_text(distance, self.units);
        format!(
            "t = {start:.6} .. {end:.6} s: {one} and {other} interfere, {nearest} at {worst:.6} s"
        )
    }

    /// The first contact in words.
    pub fn first_contact(&self) -> String {
        let contacts = self.summary.contacts.as_ref();
        let first = contacts.and_then(|of| Some(self.contact_line(of, of.contacts.first()?)));
        first.unwrap_or_default()
    }

    /// The first violation in words.
    pub fn first(&self) -> String {
        let first = self.summary.violations.first();
        first.map_or_else(String::new, |violation| self.line(violation))
    }

    /// One line for people, in the units of the mechanism file.
    fn line(&self, violation: &Violation) -> String {
        let Violation { start, end, worst, amount, quantity, .. } = *violation;
        let report = ViolationReport::new(violation, self.request.manipulator);
        let (what, units) = (report.what(), self.units);
        match quantity {
            Some(quantity) => format!(
                "t = {start:.6} .. {end:.6} s: {what} by {} {}{} at {worst:.6} s",
                text::number(amount, quantity, units),
                units.symbol(quantity),
                report.per_time()
            ),
            None => format!("t = {start:.6} s: {what}"),
        }
    }
}

fn contacts_json(of: &Contacts) -> Value {
    let names = |pair| of.interference.names_of(pair);
    let contacts = of.contacts.iter().map(|c| {
        let Contact { pair, start, end, worst, distance } = *c;
        json!({
            "pair": names(pair), "start": start, "end": end, "worst": worst, "distance": distance,
        })
    });
    let nearest = of.nearest.map(|(nearest, time)| {
        json!({ "pair": names(nearest.pair), "distance": nearest.distance, "time": time })
    });
    json!({
        "nearest": nearest,
        "contacts": contacts.collect::<Vec<_>>(),
        "set_aside": set_aside_json(&of.interference),
    })
}

fn json(report: &ViolationReport<'_>) -> Value {
    violation_fields(report).into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}
