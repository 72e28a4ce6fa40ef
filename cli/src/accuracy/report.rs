//! What is said of one pose.

use super::Setting;
use crate::output::named;
use crate::text::{self, Table, plural};
use crate::transform;
use nalgebra::Vector3;
use opm_accuracy::{Allocation, Budget, ErrorModel, Permitted, Play, Response, Samples, Spread};
use opm_core::Quantity;
use opm_core::manipulator::Solution;
use opm_core::mechanism::file::FileUnits;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The errors with the largest effects that text shows.
const SHOWN: usize = 12;

/// A pose, and what was computed there.
pub struct Report<'a> {
    pub setting: &'a Setting<'a>,
    pub at: &'a Solution,
    pub pose: &'a [f64],
    /// If the pose is in reach.
    pub found: Option<PoseAccuracy>,
}

/// What was computed at a pose.
pub struct PoseAccuracy {
    pub response: Response,
    pub budget: Budget,
    pub allocation: Option<Allocation>,
    pub samples: Option<Samples>,
}

impl Report<'_> {
    pub fn json(&self) -> Value {
        let setting = self.setting;
        let manipulator = setting.manipulator();
        let coordinates = manipulator.task_coordinates();
        let mut json = Map::new();
        let pose = match self.found {
            Some(_) => named(text::whole_pose(manipulator, self.pose, self.at.dependent())),
            None => named(coordinates.iter().map(|c| c.name).zip(self.pose.iter().copied())),
        };
        json.insert("pose".into(), pose.into());
        json.insert("mode".into(), manipulator.format_mode(setting.mode).into());
        json.insert("reachable".into(), self.found.is_some().into());
        json.insert("errors".into(), error_model(setting.model.error_model()).into());
        json.insert("length".into(), setting.model.length().into());
        let keys = ["pose_error", "worst", "root_sum_square", "sensitivity", "misfit"];
        let more = ["clearance", "samples", "overconstraints", "held", "transform"];
        let Some(PoseAccuracy { response, budget, allocation, samples }) = &self.found else {
            json.extend(keys.into_iter().chain(more).map(|key| (key.to_owned(), Value::Null)));
            let legs = &manipulator.mechanism().legs;
            let out = self.at.unreachable().iter().map(|u| &*legs[u.leg].name);
            json.insert("unreachable".into(), out.collect::<Vec<_>>().into());
            return json.into();
        };
        let by_coordinate = |value: fn(&Spread) -> f64| {
            let each = coordinates.iter().zip(&budget.coordinates);
            named_or_null(each.map(|(c, spread)| (c.name, value(spread))))
        };
        let plays = |of: fn(&Spread) -> f64| {
            let joints = manipulator.mechanism().joints().zip(&budget.misfit);
            let play =
                |play: &Play| json!({ "length": of(&play.length), "angle": of(&play.angle) });
            Value::Object(joints.map(|(j, p)| (j.name.clone(), play(p))).collect())
        };
        let rows = response.coordinates.column_iter();
        let rows = rows.map(|row| row.iter().map(|&value| finite(value)).collect::<Vec<_>>());
        let sources = setting.model.sources();
        let values = [
            by_coordinate(|spread| spread.worst),
            json!({
                "length": finite(budget.length.worst),
                "angle": finite(budget.angle.worst),
                "displacement": triple(&budget.worst_displacement),
                "rotation": triple(&budget.worst_rotation),
            }),
            json!({
                "pose_error": by_coordinate(|spread| spread.root_sum_square),
                "length": finite(budget.length.root_sum_square),
                "angle": finite(budget.angle.root_sum_square),
                "misfit": plays(|spread| spread.root_sum_square),
            }),
            json!({
                "rows": sources.iter().map(|s| &*s.name).collect::<Vec<_>>(),
                "columns": coordinates.iter().map(|c| c.name).collect::<Vec<_>>(),
                "values": rows.collect::<Vec<_>>(),
                "units": sources.iter().map(|s| s.quantity.unit()).collect::<Vec<_>>(),
                "sizes": setting.sizes,
            }),
            plays(|spread| spread.worst),
            allocation.as_ref().map_or(Value::Null, |found| allocation_json(setting, found)),
            samples.as_ref().map_or(Value::Null, |found| self.samples_json(found)),
            response.overconstraints.into(),
            response.held.into(),
            transform::at(manipulator, self.at),
        ];
        json.extend(keys.into_iter().chain(more).map(str::to_owned).zip(values));
        json.into()
    }

    pub fn text(&self) -> String {
        let setting = self.setting;
        let manipulator = setting.manipulator();
        let units = setting.loaded.file.units;
        let mut text = heading(setting);
        let Some(PoseAccuracy { response, budget, allocation, samples }) = &self.found else {
            let mut table = Table::new(["coordinate", ">value", "unit"]);
            for (c, &value) in manipulator.task_coordinates().iter().zip(self.pose) {
                let shown = text::number(value, c.quantity, units);
                table.row([c.name, &shown, units.symbol(c.quantity)]);
            }
            let _ = writeln!(text, "\n\n{table}\nout of reach in this mode");
            for out in self.at.unreachable() {
                let leg = &manipulator.mechanism().legs[out.leg].name;
                let _ = writeln!(text, "  {leg}: {} out of reach", out.part());
            }
            return text;
        };
        let mut table = Table::new(["coordinate", ">value", ">worst error", ">RSS", "unit"]);
        let coordinates = manipulator.task_coordinates();
        for ((c, &value), spread) in coordinates.iter().zip(self.pose).zip(&budget.coordinates) {
            let [worst, rss] = spread_text(spread, c.quantity, units);
            let shown = text::number(value, c.quantity, units);
            table.row([c.name, &shown, &worst, &rss, units.symbol(c.quantity)]);
        }
        for (name, spread, quantity) in [
            ("displacement", &budget.length, Quantity::Length),
            ("rotation", &budget.angle, Quantity::Angle),
        ] {
            let [worst, rss] = spread_text(spread, quantity, units);
            table.row([name, "", &worst, &rss, units.symbol(quantity)]);
        }
        let _ = writeln!(text, "\n\n{table}");
        if !response.held {
            let _ =
                writeln!(text, "the actuators do not hold the platform: its error is not known\n");
        }
        self.sensitivity_text(&mut text, response);
        let _ = match response.overconstraints {
            0 => writeln!(text, "not overconstrained: motions take up all errors"),
            number => {
                writeln!(text, "{number} overconstraints: what no motion takes up needs play")
            }
        };
        if setting.sizes.iter().any(|&size| size > 0.0) && response.overconstraints > 0 {
            let misfit = budget.misfit.iter().map(|play| [play.length.worst, play.angle.worst]);
            let _ = writeln!(text, "\n{}", misfit_table(setting, misfit));
        }
        if let Some(found) = samples {
            self.samples_text(&mut text, found);
        }
        if let Some(allocation) = allocation {
            let _ = writeln!(text, "\n{}", allocation_text(setting, allocation));
        }
        text
    }

    fn samples_json(&self, found: &Samples) -> Value {
        let manipulator = self.setting.manipulator();
        let names = manipulator.task_coordinates().iter().map(|c| c.name);
        let joints = manipulator.mechanism().joints().zip(&found.misfit);
        let misfit = joints.map(|(joint, [length, angle])| {
            (joint.name.clone(), json!({ "length": finite(*length), "angle": finite(*angle) }))
        });
        json!({
            "count": found.count,
            "failed": found.failed,
            "deviation": named_or_null(names.zip(found.deviations.iter().copied())),
            "length": finite(found.length),
            "angle": finite(found.angle),
            "misfit": Value::Object(misfit.collect()),
        })
    }

    fn samples_text(&self, text: &mut String, found: &Samples) {
        let setting = self.setting;
        let units = setting.loaded.file.units;
        let _ = write!(text, "\n{} assembled with drawn errors", plural(found.count, "mechanism"));
        if found.failed > 0 {
            let _ = write!(text, ", of which {} do not assemble", text::count(found.failed));
        }
        let mut table = Table::new(["coordinate", ">deviation", "unit"]);
        let coordinates = setting.manipulator().task_coordinates();
        for (c, &deviation) in coordinates.iter().zip(&found.deviations) {
            let shown = significant(deviation / units.factor(c.quantity));
            table.row([c.name, &shown, units.symbol(c.quantity)]);
        }
        let _ = writeln!(text, "\n\n{table}");
        let [length, angle] = [(found.length, Quantity::Length), (found.angle, Quantity::Angle)]
            .map(|(value, quantity)| {
                format!(
                    "{} {}",
                    significant(value / units.factor(quantity)),
                    units.symbol(quantity)
                )
            });
        let _ =
            writeln!(text, "95 % are displaced by at most {length} and rotated by at most {angle}");
        let all = found.misfit.iter().flatten().copied().fold(0.0, f64::max);
        if all > 0.0 {
            let table = misfit_table(setting, found.misfit.iter().copied());
            let _ = writeln!(text, "\nplay of each joint that 95 % do not exceed\n\n{table}");
        }
    }

    /// The errors that matter most: by their share of the displacement and the rotation; without sizes, those of one unit of the
    /// file.
    fn sensitivity_text(&self, text: &mut String, response: &Response) {
        let setting = self.setting;
        let units = setting.loaded.file.units;
        let sized = setting.sizes.iter().any(|&size| size > 0.0);
        let size = |k: usize| match sized {
            true => setting.sizes[k],
            false => units.factor(setting.model.sources()[k].quantity),
        };
        let part = |k: usize| response.twists.column(k) * size(k);
        let effect = |k: usize| {
            let twist = part(k);
            let angle = twist.fixed_rows::<3>(0).norm();
            angle + twist.fixed_rows::<3>(3).norm() / setting.model.length()
        };
        let mut order: Vec<usize> = (0..setting.sizes.len()).filter(|&k| effect(k) > 0.0).collect();
        order.sort_by(|&i, &j| effect(j).total_cmp(&effect(i)));
        if order.is_empty() {
            return;
        }
        let coordinates = setting.manipulator().task_coordinates();
        let mut headers = vec!["error".to_owned(), ">size".to_owned(), "unit".to_owned()];
        headers.extend(coordinates.iter().map(|c| text::header(c.name, c.quantity, units)));
        let mut table = Table::new(headers);
        for &k in order.iter().take(SHOWN) {
            let source = &setting.model.sources()[k];
            let size = size(k);
            let shown = significant(size / units.factor(source.quantity));
            let mut row = vec![source.name.clone(), shown];
            row.push(units.symbol(source.quantity).to_owned());
            row.extend(coordinates.iter().enumerate().map(|(i, c)| {
                let change = response.coordinates[(i, k)] * size / units.factor(c.quantity);
                significant(change)
            }));
            table.row(row);
        }
        let _ = writeln!(text, "{table}");
        if order.len() > SHOWN {
            let left = plural((order.len() - SHOWN) as u64, "smaller one");
            let _ = writeln!(text, "{left} not shown: --format json has all\n");
        }
    }
}

/// The mechanism, its mode, and what errors are.
pub fn heading(setting: &Setting<'_>) -> String {
    let manipulator = setting.manipulator();
    let mut text = manipulator.mechanism().name.clone();
    let mode = manipulator.format_mode(setting.mode);
    if !mode.is_empty() {
        let _ = write!(text, ", mode {mode}");
    }
    let errors = match setting.model.error_model() {
        ErrorModel::Axes => "errors of the file's axes, assembled at home",
        ErrorModel::Links => "errors of links",
    };
    let _ = write!(text, ", {errors}");
    text
}

/// The name of a model of errors.
pub fn error_model(errors: ErrorModel) -> &'static str {
    ErrorModel::NAMED.iter().find(|(_, model)| *model == errors).map_or("", |(name, _)| name)
}

/// The plays that joints need, a length and an angle for each, in the units of the file.
pub fn misfit_table(setting: &Setting<'_>, plays: impl Iterator<Item = [f64; 2]>) -> Table {
    let units = setting.loaded.file.units;
    let quantities = [Quantity::Length, Quantity::Angle];
    let headers = quantities.map(|quantity| format!(">misfit [{}]", units.symbol(quantity)));
    let [length, angle] = &headers;
    let mut table = Table::new(["leg", "joint", length, angle]);
    let legs = setting.manipulator().mechanism().legs.iter();
    let joints = legs.flat_map(|leg| leg.joints.iter().map(move |joint| (leg, joint)));
    for ((leg, joint), play) in joints.zip(plays) {
        let [length, angle] = [0, 1].map(|i| significant(play[i] / units.factor(quantities[i])));
        table.row([&leg.name, &joint.name, &length, &angle]);
    }
    table
}

/// The tolerances that keep within a clearance, by joint: the smallest of its errors.
fn by_joint(setting: &Setting<'_>, found: &Allocation) -> Vec<(String, [Permitted; 2])> {
    let mut joints: Vec<(String, [Permitted; 2])> = Vec::new();
    for (source, &permitted) in setting.model.sources().iter().zip(found.permitted()) {
        let Some(name) = &source.joint else { continue };
        let number = joints.iter().position(|(known, _)| known == name);
        let number = number.unwrap_or_else(|| {
            joints.push((name.clone(), [Permitted::UNLIMITED; 2]));
            joints.len() - 1
        });
        let place = usize::from(source.quantity == Quantity::Angle);
        let own = &mut joints[number].1[place];
        *own = own.and(permitted);
    }
    joints
}

pub fn allocation_json(setting: &Setting<'_>, found: &Allocation) -> Value {
    let permitted = |p: Permitted| json!({ "alone": finite(p.alone), "share": finite(p.share) });
    let joints = by_joint(setting, found).into_iter().map(|(name, [length, angle])| {
        (name, json!({ "length": permitted(length), "angle": permitted(angle) }))
    });
    let of_axes = setting.model.sources().iter().zip(found.permitted());
    let of_axes = of_axes.filter(|(source, _)| source.joint.is_some());
    let parameters = of_axes.map(|(source, &p)| (source.name.clone(), permitted(p)));
    let [length, angle] = found.uniform().map(finite);
    let clearance = found.clearance();
    json!({
        "length": clearance.length,
        "angle": clearance.angle,
        "uniform": { "length": length, "angle": angle },
        "joints": Value::Object(joints.collect()),
        "parameters": Value::Object(parameters.collect()),
    })
}

pub fn allocation_text(setting: &Setting<'_>, found: &Allocation) -> String {
    let units = setting.loaded.file.units;
    let [mm, deg] = [Quantity::Length, Quantity::Angle].map(|quantity| units.symbol(quantity));
    let mut table = Table::new([
        "axis of joint".to_owned(),
        format!(">alone [{mm}]"),
        format!(">share [{mm}]"),
        format!(">alone [{deg}]"),
        format!(">share [{deg}]"),
    ]);
    for (name, [length, angle]) in by_joint(setting, found) {
        let shown = |value: f64, quantity| match value.is_finite() {
            true => significant(value / units.factor(quantity)),
            false => "any".to_owned(),
        };
        table.row([
            name,
            shown(length.alone, Quantity::Length),
            shown(length.share, Quantity::Length),
            shown(angle.alone, Quantity::Angle),
            shown(angle.share, Quantity::Angle),
        ]);
    }
    let clearance = found.clearance();
    let within = [(clearance.length, Quantity::Length), (clearance.angle, Quantity::Angle)];
    let within = within
        .into_iter()
        .filter_map(|(value, quantity)| Some(units.show(value?, quantity).to_string()));
    let within = within.collect::<Vec<_>>().join(", ");
    let [length, angle] = found.uniform();
    let all = match length.is_finite() {
        true => format!(
            "all axes within {}, {}",
            units.show(
                rounded_down(length / units.length.factor()) * units.length.factor(),
                Quantity::Length
            ),
            units.show(
                rounded_down(angle / units.angle.factor()) * units.angle.factor(),
                Quantity::Angle
            ),
        ),
        false => "any tolerance of axes".to_owned(),
    };
    format!("tolerances for a play of at most {within} in every joint\n\n{table}\n{all}\n")
}

/// To three significant digits, downwards.
fn rounded_down(value: f64) -> f64 {
    let unit = 10_f64.powf(value.abs().log10().floor() - 2.0);
    (value / unit).floor() * unit
}

fn spread_text(spread: &Spread, quantity: Quantity, units: FileUnits) -> [String; 2] {
    [spread.worst, spread.root_sum_square].map(|value| match value.is_finite() {
        true => significant(value / units.factor(quantity)),
        false => "-".to_owned(),
    })
}

/// A number to three significant digits; what is only rounding is zero.
pub fn significant(value: f64) -> String {
    const ROUNDING: f64 = 1e-12;
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value.abs() < ROUNDING {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor();
    if !(-5.0..7.0).contains(&exponent) {
        return format!("{value:.2e}");
    }
    format!("{value:.decimals$}", decimals = (2.0 - exponent).max(0.0) as usize)
}

fn triple(v: &Vector3<f64>) -> [Option<f64>; 3] {
    [v.x, v.y, v.z].map(|c| finite(c + 0.0))
}

/// Numbers that JSON cannot hold are null.
pub fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn named_or_null<'n>(values: impl Iterator<Item = (&'n str, f64)>) -> Value {
    Value::Object(values.map(|(name, value)| (name.to_owned(), json!(finite(value)))).collect())
}
