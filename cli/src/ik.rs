//! `opm ik`: inverse kinematics.

pub mod nearest;
mod table;

use crate::args::{IkArgs, Output};
use crate::batch::{self, Modes};
use crate::failure::Failure;
use crate::interference;
use crate::load::{self, Loaded};
use crate::output::named;
use crate::pose::Checks;
use crate::text::{self, Table, reason};
use crate::transform::{self, Located};
use crate::unitless;
use nalgebra::Point3;
use nearest::Nearest;
use opm_core::chain::limits::Limits;
use opm_core::group::JointDisplacement;
use opm_core::manipulator::{Manipulator, Mode, OutsideMotion, Solution, Unreachable};
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::joint::{JointCoordinate, Quantity};
use opm_core::task::TaskCoordinate;
use opm_interference::{self as bodies, Distances, Interference};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// Largest number of two-valued choices for which every combination is listed.
const MOST_CHOICES: u32 = 16;

pub fn run(args: &IkArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    if let (Some(vary), Some(pose)) = (&args.vary, &args.pose) {
        return table::run((args, pose), &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let modes = modes(args, &manipulator)?;
    let mut checks = None;
    let located = match (&args.pose, &args.transform) {
        (Some(pose), _) => {
            unitless::note_pose(output, "--pose", pose, &loaded, &manipulator);
            let (pose, given) = pose.resolve_with_checks(&manipulator)?;
            checks = Some(given);
            Located::Pose(pose)
        }
        (None, Some(transform)) => {
            let mode = match modes {
                Modes::One(mode) => mode,
                Modes::All => manipulator.home_mode(),
            };
            transform.locate(&manipulator, mode)
        }
        (None, None) => return batch::run(args, output, &loaded, &manipulator, modes),
    };
    let answer = match located {
        Located::Pose(pose) => {
            let mut answer = Answer::new(&loaded, &manipulator, modes, pose)?;
            if let Some(checks) = checks {
                answer.keep(&checks)?;
            }
            answer
        }
        Located::Outside(outside) => Answer::outside(&loaded, &manipulator, modes, outside),
    };
    if !args.nearest {
        return output.print(&answer.json(), answer.text());
    }
    let nearest = Nearest::of(&answer, modes, nearest::length(args, &manipulator)?)?;
    let json = Json { nearest_pose: Some(nearest.json()), ..answer.json() };
    output.print(&json, answer.text() + &nearest.text())
}

/// The working modes that the flags select.
fn modes(args: &IkArgs, manipulator: &Manipulator) -> Result<Modes, Failure> {
    if !args.all_modes {
        return load::mode(manipulator, &args.mode).map(Modes::One);
    }
    let choices = manipulator.choices();
    if choices > MOST_CHOICES {
        return Err(Failure::flag(
            "--all-modes",
            format!("2^{choices} working modes, at most 2^{MOST_CHOICES}; use --mode"),
        ));
    }
    Ok(Modes::All)
}

/// The joints at one pose.
struct Answer<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    pose: Vec<f64>,
    all: bool,
    solutions: Vec<(Mode, Solution)>,
    unreachable: Vec<Unreachable>,
    /// The distance of the requested transform from the motion, if it is outside. The pose is then the
    /// nearest.
    outside: Option<OutsideMotion>,
    interference: Interference,
}

#[derive(Serialize)]
struct Json<'a> {
    pose: Map<String, Value>,
    reachable: bool,
    solutions: Vec<JsonSolution>,
    unreachable: Vec<JsonUnreachable<'a>>,
    transform: Value,
    #[serde(skip_serializing_if = "Option::is_none")]
    outside: Option<Value>,
    /// The pairs of bodies that are not tested for interference.
    set_aside: Value,
    /// What --nearest found; null if the pose is in reach itself, or nothing was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest_pose: Option<Value>,
}

#[derive(Serialize)]
struct JsonSolution {
    mode: String,
    within_limits: bool,
    joints: Map<String, Value>,
    imaginary: Map<String, Value>,
    /// The dependent coordinates, which may differ from mode to mode.
    #[serde(skip_serializing_if = "Map::is_empty")]
    dependent: Map<String, Value>,
    /// The differences of joints that have limits.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    differences: Vec<Value>,
    /// Where the platform is, which follows from the pose alone where no coordinate is dependent.
    #[serde(skip_serializing_if = "Option::is_none")]
    transform: Option<Value>,
    /// The two bodies that are nearest to each other.
    nearest: Value,
}

#[derive(Serialize)]
struct JsonUnreachable<'a> {
    leg: &'a str,
    reason: String,
}

impl<'a> Answer<'a> {
    fn new(
        loaded: &'a Loaded,
        manipulator: &'a Manipulator,
        modes: Modes,
        pose: Vec<f64>,
    ) -> Result<Self, Failure> {
        let wrong = |error| Failure::flag("--pose", error);
        let mut solution = manipulator.solution();
        let (solutions, unreachable) = match modes {
            Modes::One(mode) => {
                let found = manipulator.inverse(&pose, mode, &mut solution).map_err(wrong)?;
                let solutions = found.into_iter().map(|found| (mode, found.clone())).collect();
                (solutions, solution.unreachable().to_vec())
            }
            Modes::All => {
                let mut all = manipulator.all_modes();
                manipulator.inverse_all(&pose, &mut all).map_err(wrong)?;
                let solutions = all
                    .modes(manipulator)
                    .filter_map(|mode| {
                        let found = manipulator.solution_in_mode(&all, mode, &mut solution)?;
                        Some((mode, found.clone()))
                    })
                    .collect();
                (solutions, all.unreachable().collect())
            }
        };
        let all = matches!(modes, Modes::All);
        let interference = Interference::new(manipulator.mechanism());
        let outside = None;
        Ok(Self { loaded, manipulator, pose, all, solutions, unreachable, outside, interference })
    }

    /// Keeps the solutions that have the given values of dependent coordinates.
    fn keep(&mut self, checks: &Checks) -> Result<(), Failure> {
        let manipulator = self.manipulator;
        if let [(_, only)] = &*self.solutions
            && !self.all
        {
            let verified = checks.verify(manipulator, only.dependent(), self.loaded.file.units);
            return verified.map_err(|error| Failure::flag("--pose", error));
        }
        let before = self.solutions.len();
        self.solutions.retain(|(_, solution)| checks.hold(manipulator, solution.dependent()));
        if self.solutions.is_empty() && before > 0 {
            return Err(Failure::flag("--pose", Checks::refusal(before)));
        }
        Ok(())
    }

    /// The names and values of the pose, and of the dependent coordinates of the first solution.
    fn pose(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let dependent = self.solutions.first().map_or(&[][..], |(_, first)| first.dependent());
        text::whole_pose(self.manipulator, &self.pose, dependent)
    }

    /// The report for a transform that is not a pose.
    fn outside(
        loaded: &'a Loaded,
        manipulator: &'a Manipulator,
        modes: Modes,
        outside: OutsideMotion,
    ) -> Self {
        let all = matches!(modes, Modes::All);
        let (solutions, unreachable) = (Vec::new(), Vec::new());
        let pose = outside.nearest.clone();
        let outside = Some(outside);
        let interference = Interference::new(manipulator.mechanism());
        Self { loaded, manipulator, pose, all, solutions, unreachable, outside, interference }
    }

    /// The two bodies that are nearest to each other in a solution.
    fn nearest(&self, solution: &Solution) -> Option<bodies::Nearest> {
        let mut distances = Distances::new(&self.interference);
        distances.place(self.manipulator, solution);
        distances.nearest()
    }

    fn json(&self) -> Json<'_> {
        let dependent = || self.manipulator.dependent_coordinates().iter().map(|c| c.name);
        let solution = |(mode, solution): &(Mode, Solution)| {
            let joints = self.manipulator.coordinates().iter().map(|c| &*c.name);
            let imaginary = self.manipulator.imaginary().iter().map(|j| &*j.name);
            JsonSolution {
                mode: self.manipulator.format_mode(*mode),
                within_limits: solution.within_limits(),
                joints: named(joints.zip(solution.joints().iter().copied())),
                imaginary: named(imaginary.zip(solution.imaginary().iter().copied())),
                dependent: named(dependent().zip(solution.dependent().iter().copied())),
                differences: differences(self.manipulator, solution),
                transform: dependent().next().map(|_| transform::at(self.manipulator, solution)),
                nearest: interference::nearest_json(&self.interference, self.nearest(solution)),
            }
        };
        Json {
            pose: named(self.pose()),
            reachable: !self.solutions.is_empty(),
            solutions: self.solutions.iter().map(solution).collect(),
            unreachable: self
                .unreachable
                .iter()
                .map(|u| JsonUnreachable { leg: self.leg(u), reason: reason(u, FileUnits::SI) })
                .collect(),
            transform: match self.solutions.first() {
                Some((_, first)) => transform::at(self.manipulator, first),
                None => transform::json(self.manipulator, &self.pose),
            },
            outside: self.outside.as_ref().map(transform::outside_json),
            set_aside: interference::set_aside_json(&self.interference),
            nearest_pose: None,
        }
    }

    fn text(&self) -> String {
        let units = self.loaded.file.units;
        let name = &self.manipulator.mechanism().name;
        let mut text = match &self.outside {
            Some(outside) => {
                format!("{name}: {}\nnearest pose: ", outside_text(outside, self.tip(), units))
            }
            None => format!("{name} at "),
        };
        let shown = |coordinates: &[TaskCoordinate], values: &[f64]| {
            let each = coordinates.iter().zip(values).map(|(c, &value)| {
                let value = text::number(value, c.quantity, units);
                format!("{} = {value} {}", c.name, units.symbol(c.quantity))
            });
            each.collect::<Vec<_>>().join(", ")
        };
        let _ = write!(text, "{}", shown(self.manipulator.task_coordinates(), &self.pose));
        let dependent = self.manipulator.dependent_coordinates();
        if let ([(_, only)], false) = (&*self.solutions, self.all || dependent.is_empty()) {
            let _ = write!(text, "; then {}", shown(dependent, only.dependent()));
        }
        let _ = writeln!(text, "\n");
        if self.outside.is_some() {
            return text.trim_end().to_owned() + "\n";
        }
        match &*self.solutions {
            [] => {
                let whose = if self.all { "in every mode" } else { "in this mode" };
                let _ = writeln!(text, "out of reach {whose}");
                for u in &self.unreachable {
                    let _ = writeln!(text, "  {}: {}", self.leg(u), reason(u, units));
                }
            }
            [(mode, solution)] if !self.all => {
                let _ = writeln!(
                    text,
                    "{}, {}\n\n{}",
                    self.mode_name(*mode),
                    if solution.within_limits() {
                        "within limits"
                    } else {
                        "beyond limits (marked *)"
                    },
                    self.joint_table(solution)
                );
                if let Some(differences) = self.differences_text(solution) {
                    let _ = writeln!(text, "{differences}");
                }
                let nearest = self.nearest(solution);
                let nearest = text::nearest_text(&self.interference, nearest, units);
                let _ = writeln!(text, "{nearest}");
                if let Some(aside) = text::set_aside_text(&self.interference, units) {
                    let _ = writeln!(text, "{aside}");
                }
            }
            solutions => {
                let _ =
                    writeln!(text, "{} working modes\n\n{}", solutions.len(), self.mode_table());
            }
        }
        text
    }

    /// The differences of joints that have limits, a row for each; `None` if there are none.
    fn differences_text(&self, solution: &Solution) -> Option<Table> {
        let units = self.loaded.file.units;
        let mut table = Table::new(["difference", ">value", "unit", ">limits", ""]);
        for difference in self.manipulator.differences() {
            let quantity = difference.quantity;
            table.row([
                &*difference.name,
                &text::number(difference.value(solution.joints()), quantity, units),
                units.symbol(quantity),
                &text::range(difference.limits, quantity, units),
                if difference.allows(solution.joints()) { "" } else { "*" },
            ]);
        }
        (!self.manipulator.differences().is_empty()).then_some(table)
    }

    /// Every joint of one solution, leg by leg.
    fn joint_table(&self, solution: &Solution) -> Table {
        let units = self.loaded.file.units;
        let mut table = Table::new(["leg", "joint", "", ">value", "unit", ">limits", ""]);
        let mut row = |leg: &str, name: &str, kind: &str, value: f64, of: Of<'_>, cone: ConeOf| {
            let quantity = of.quantity();
            let limits = of.limits().map(|l| text::range(l, quantity, units));
            let angle = |angle| format!("cone {}", text::number(angle, Quantity::Angle, units));
            let limits: Vec<String> =
                limits.into_iter().chain(cone.map(|(most, _)| angle(most))).collect();
            let within = of.admits(value) && cone.is_none_or(|(_, within)| within);
            table.row([
                leg,
                name,
                kind,
                &text::number(value, quantity, units),
                units.symbol(quantity),
                &limits.join(", "),
                if within { "" } else { "*" },
            ]);
        };
        let mut number = 0;
        let beyond = self.manipulator.beyond_cones(solution.joints());
        let beyond: Vec<usize> = beyond.map(|(_, first)| first).collect();
        let imaginary = || self.manipulator.imaginary().iter().zip(solution.imaginary());
        for (leg_number, leg) in self.manipulator.mechanism().legs.iter().enumerate() {
            for joint in &leg.joints {
                let kind = if joint.actuated { "actuated" } else { "passive" };
                let first = number;
                for coordinate in &joint.coordinates {
                    let value = solution.joints()[number];
                    let of = Of::Joint(coordinate, &self.manipulator.limits()[number]);
                    let cone = joint.cone.filter(|_| number == first);
                    let cone = cone.map(|cone| (cone.half_angle, !beyond.contains(&number)));
                    row(&leg.name, &coordinate.name, kind, value, of, cone);
                    number += 1;
                }
            }
            for (joint, &value) in imaginary().filter(|(joint, _)| joint.leg == leg_number) {
                let of = Of::Imaginary(joint.quantity);
                row(&leg.name, &joint.name, "imaginary", value, of, None);
            }
        }
        table
    }

    /// The platform's reference point at home, where a frame has its centre elsewhere.
    fn tip(&self) -> Option<Point3<f64>> {
        /// Nearer points are the same but for rounding, metres.
        const SAME: f64 = 1e-9;
        let (task, platform) = (self.manipulator.task(), self.manipulator.mechanism().platform);
        let apart = |centre: Point3<f64>| (centre - platform).norm() > SAME;
        (apart(task.lower.origin) || apart(task.upper.origin)).then_some(platform)
    }

    /// A table with a row for each mode: imaginary and actuated joints.
    fn mode_table(&self) -> Table {
        let units = self.loaded.file.units;
        let manipulator = self.manipulator;
        let actuated =
            || manipulator.actuated().iter().map(|&i| (i, &manipulator.coordinates()[i]));
        let imaginary = || manipulator.imaginary().iter();
        let mut headers = vec!["mode".to_owned(), "within limits".to_owned()];
        let dependent = manipulator.dependent_coordinates();
        headers.extend(dependent.iter().map(|c| text::header(c.name, c.quantity, units)));
        headers.extend(imaginary().map(|j| text::header(&j.name, j.quantity, units)));
        headers.extend(actuated().map(|(_, c)| text::header(&c.name, c.quantity, units)));
        headers.push(text::header("nearest", Quantity::Length, units));
        let mut table = Table::new(headers);
        for (mode, solution) in &self.solutions {
            let within = if solution.within_limits() { "yes" } else { "no" };
            let mut row = vec![manipulator.format_mode(*mode), within.to_owned()];
            row.extend(
                dependent
                    .iter()
                    .zip(solution.dependent())
                    .map(|(c, &value)| text::number(value, c.quantity, units)),
            );
            row.extend(
                imaginary()
                    .zip(solution.imaginary())
                    .map(|(j, &value)| text::number(value, j.quantity, units)),
            );
            row.extend(
                actuated().map(|(i, c)| text::number(solution.joints()[i], c.quantity, units)),
            );
            let nearest = self.nearest(solution).map(|nearest| nearest.distance);
            row.push(nearest.map_or_else(
                || "-".to_owned(),
                |distance| text::number(distance, Quantity::Length, units),
            ));
            table.row(row);
        }
        table
    }

    fn mode_name(&self, mode: Mode) -> String {
        let signs = self.manipulator.format_mode(mode);
        if signs.is_empty() { "the only working mode".to_owned() } else { format!("mode {signs}") }
    }

    fn leg(&self, unreachable: &Unreachable) -> &str {
        &self.manipulator.mechanism().legs[unreachable.leg].name
    }
}

/// Half the angle of the cone of a joint, radians, and whether the joint is within it.
type ConeOf = Option<(f64, bool)>;

/// The owner of a value.
#[derive(Clone, Copy)]
enum Of<'a> {
    Joint(&'a JointCoordinate, &'a Limits),
    Imaginary(Quantity),
}

impl Of<'_> {
    fn quantity(self) -> Quantity {
        match self {
            Self::Joint(coordinate, _) => coordinate.quantity,
            Self::Imaginary(quantity) => quantity,
        }
    }

    fn limits(self) -> Option<[f64; 2]> {
        match self {
            Self::Joint(coordinate, _) => coordinate.limits,
            Self::Imaginary(_) => None,
        }
    }

    fn admits(self, value: f64) -> bool {
        match self {
            Self::Joint(c, limits) => limits.admits(JointDisplacement::Value(value - c.home)),
            Self::Imaginary(_) => true,
        }
    }
}

/// The values of the differences of joints that have limits, and whether they are within these.
fn differences(manipulator: &Manipulator, solution: &Solution) -> Vec<Value> {
    let each = manipulator.differences().iter().map(|difference| {
        json!({
            "joints": difference.coordinates.map(|i| &*manipulator.coordinates()[i].name),
            "value": difference.value(solution.joints()),
            "limits": difference.limits,
            "within_limits": difference.allows(solution.joints()),
        })
    });
    each.collect()
}

/// The names of the joint coordinates that are beyond their limits in a solution, or the first of a joint beyond its cone; and
/// of differences of joints, as `a - b`.
pub fn beyond<'a>(manipulator: &'a Manipulator, solution: &Solution) -> Vec<&'a str> {
    let cones: Vec<usize> =
        manipulator.beyond_cones(solution.joints()).map(|(_, first)| first).collect();
    let limits = manipulator.limits().iter().zip(solution.joints());
    let all = manipulator.coordinates().iter().zip(limits).enumerate();
    let beyond = all.filter(|&(i, (c, (limits, &value)))| {
        !Of::Joint(c, limits).admits(value) || cones.contains(&i)
    });
    let differences = manipulator.beyond_differences(solution.joints());
    let differences = differences.map(|number| &*manipulator.differences()[number].name);
    beyond.map(|(_, (c, _))| &*c.name).chain(differences).collect()
}

/// The distance and the direction of a transform from the motion, and the point that it places if coordinates place another.
fn outside_text(
    outside: &OutsideMotion,
    platform: Option<Point3<f64>>,
    units: FileUnits,
) -> String {
    let parts = outside.parts().map(|(quantity, v)| {
        let way = match quantity {
            Quantity::Length => "along",
            Quantity::Angle => "about",
        };
        let [x, y, z] = <[f64; 3]>::from(v.normalize()).map(|c| (c * 1e4).round() / 1e4 + 0.0);
        format!("{} {way} ({x}, {y}, {z})", units.show(v.norm(), quantity))
    });
    let parts: Vec<String> = parts.collect();
    let outside =
        format!("the transform is outside the manipulator's motion by {}", parts.join(" and "));
    let Some(platform) = platform else { return outside };
    let reference = platform.coords / units.length.factor();
    // Adding zero turns a rounded -0 into 0.
    let [x, y, z] = <[f64; 3]>::from(reference).map(|c| (c * 1e6).round() / 1e6 + 0.0);
    let unit = units.length.symbol();
    format!("{outside}; it places the reference point, which is at ({x}, {y}, {z}) {unit} at home")
}
