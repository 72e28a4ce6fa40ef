//! The picture of a mechanism, from four sides.

use super::label::value_label;
use super::sized::drawn;
use crate::args::{MechanismArgs, Output, PlotArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::Shown;
use crate::pose::Pose;
use crate::text::{nearest_text, reason};
use crate::unitless;
use nalgebra::{Isometry3, Point3};
use opm_core::decomposition::Decomposition;
use opm_core::linkage::Linkage;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::Mechanism;
use opm_core::skeleton::{
    Body, Configuration, ImaginaryJoints, Material, SeatMotion, Skeleton, Solid,
};
use opm_core::{Quantity, group::subspace::SubspaceClass};
use opm_interference::member::names_of_parts;
use opm_interference::{Distances, Interference};
use opm_plot::{Color, Drawing, Heading, Named, Steps, Unit, ViewFigure};
use std::collections::BTreeSet;

/// Values below this are noise of the arithmetic, in metres or radians.
const NOISE: f64 = 1e-9;

/// Draws a mechanism at a pose, or as it was assembled.
pub fn draw(args: &PlotArgs, output: &Output) -> Result<Drawing, Failure> {
    for (flag, given) in [
        ("--panels", !args.panels.is_empty()),
        ("--values", !args.values.is_empty()),
        ("--slice", !args.slice.is_empty()),
    ] {
        if given {
            let problem = format!("{} is a mechanism, expected a recording", args.file.shown());
            return Err(Failure::flag(flag, problem));
        }
    }
    let given = MechanismArgs {
        file: args.file.clone(),
        tolerance: args.tolerance,
        change: args.change.clone(),
    };
    let loaded = load::open(&given, output)?;
    let at = At { pose: args.pose.as_ref(), mode: args.mode.as_deref() };
    let figure = figure(&loaded, &at, output)?;
    drawn(args, |size| figure.draw(size))
}

/// The pose and the working mode in which a mechanism is drawn; those of home by default.
#[derive(Clone, Copy, Default)]
pub struct At<'a> {
    pose: Option<&'a Pose>,
    mode: Option<&'a str>,
}

/// The figure of a mechanism.
pub fn figure(loaded: &Loaded, at: &At<'_>, output: &Output) -> Result<ViewFigure, Failure> {
    let mechanism = &loaded.file.mechanism;
    let posed = at.pose.is_some() || at.mode.is_some();
    match Manipulator::new(mechanism.clone()) {
        Ok(manipulator) => {
            let (solution, mode) = solve(loaded, &manipulator, at, output)?;
            if !solution.within_limits() {
                output.warn(format_args!("the pose is beyond the limits of a joint"));
            }
            let (decomposition, imaginary) = (manipulator.decomposition(), manipulator.imaginary());
            let configuration = Configuration {
                joints: solution.joints(),
                imaginary: solution.imaginary(),
                platform: solution.displacement(&manipulator),
            };
            let mut lines =
                vec![pose_line(loaded, &manipulator, (&solution, mode)), split_line(decomposition)];
            let joints = ImaginaryJoints { decomposition, imaginary };
            let interference = Interference::new(manipulator.mechanism());
            let mut distances = Distances::new(&interference);
            distances.place(&manipulator, &solution);
            let nearest = distances.nearest();
            if nearest.is_some_and(|nearest| nearest.distance < 0.0) {
                let units = loaded.file.units;
                lines.push(nearest_text(&interference, nearest, units));
            }
            let pairs =
                distances.nearer_than(0.0).flat_map(|near| interference.members_of(near.pair));
            let red: BTreeSet<_> = pairs.map(|member| member.name.clone()).collect();
            assemble(loaded, Some(joints), &configuration, lines, &red)
        }
        // It has no inverse kinematics, so that no other pose is known than that at home.
        Err(_) if posed => Err(loaded.compile().map_or_else(
            |failure| failure,
            |_| Failure::flag("--pose", "the mechanism has no inverse kinematics"),
        )),
        Err(_) => {
            let joints: Vec<f64> = mechanism.coordinates().map(|c| c.home).collect();
            let home = |imaginary| Configuration {
                joints: &joints,
                imaginary,
                platform: Isometry3::identity(),
            };
            match Linkage::new(mechanism) {
                Ok(linkage) => {
                    let imaginary = linkage.imaginary();
                    let homes: Vec<f64> = imaginary.iter().map(|joint| joint.home).collect();
                    let decomposition = linkage.decomposition();
                    let cuts = decomposition
                        .map(|decomposition| ImaginaryJoints { decomposition, imaginary });
                    let mut lines = vec!["at home".to_owned()];
                    lines.extend(decomposition.map(split_line));
                    assemble(loaded, cuts, &home(&homes), lines, &BTreeSet::new())
                }
                Err(_) => {
                    let why = "it does not decompose: `opm decompose` says why";
                    let lines = vec![format!("at home; {why}")];
                    assemble(loaded, None, &home(&[]), lines, &BTreeSet::new())
                }
            }
        }
    }
}

/// The solution at the pose that was asked for, and its working mode.
fn solve(
    loaded: &Loaded,
    manipulator: &Manipulator,
    at: &At<'_>,
    output: &Output,
) -> Result<(Solution, Mode), Failure> {
    let pose = match at.pose {
        Some(pose) => {
            unitless::note_pose(output, "--pose", pose, loaded, manipulator);
            pose.resolve(manipulator)?
        }
        None => manipulator.home_pose(),
    };
    let mode = load::mode(manipulator, at.mode.unwrap_or("home"))?;
    let mut buffer = manipulator.solution();
    let found = manipulator.inverse(&pose, mode, &mut buffer);
    if let Some(found) = found.map_err(|error| Failure::flag("--pose", error))? {
        return Ok((found.clone(), mode));
    }
    let units = loaded.file.units;
    let legs = &manipulator.mechanism().legs;
    let each = buffer.unreachable().iter();
    let each = each.map(|u| format!("{}, {}", legs[u.leg].name, reason(u, units)));
    let each = each.collect::<Vec<_>>().join("; ");
    Err(Failure::work(format!("{}: the pose is out of reach: {each}", loaded.label)))
}

/// The pose, and the working mode unless it is that of home.
fn pose_line(
    loaded: &Loaded,
    manipulator: &Manipulator,
    (solution, mode): (&Solution, Mode),
) -> String {
    let units = loaded.file.units;
    let coordinates = manipulator.task_coordinates().iter().zip(solution.pose());
    let pose = coordinates.map(|(c, &value)| {
        // What is only rounding is zero.
        let value = if value.abs() <= NOISE { 0.0 } else { value };
        let value = value_label(value / units.factor(c.quantity));
        format!("{} = {value} {}", c.name, units.symbol(c.quantity))
    });
    let pose = pose.collect::<Vec<_>>().join(", ");
    match (mode == manipulator.home_mode(), solution.pose() == manipulator.home_pose()) {
        (true, true) => format!("at home: {pose}"),
        (true, false) => pose,
        (false, _) => format!("{pose}; mode {}", manipulator.format_mode(mode)),
    }
}

fn split_line(decomposition: &Decomposition) -> String {
    let Decomposition { lower, upper, .. } = decomposition;
    if decomposition.is_whole() {
        return format!("platform: {}; each leg is solved by itself", decomposition.motion());
    }
    if matches!(upper, SubspaceClass::Identity) {
        return format!("all legs move in one subspace: {}", lower.name());
    }
    format!("lower section: {}; upper section: {}", lower.name(), upper.name())
}

/// The figure of a mechanism in a configuration. The bodies, guides and obstacles with the names `red` interfere.
fn assemble(
    loaded: &Loaded,
    joints: Option<ImaginaryJoints<'_>>,
    at: &Configuration<'_>,
    lines: Vec<String>,
    red: &BTreeSet<String>,
) -> Result<ViewFigure, Failure> {
    let Loaded { file, label, .. } = loaded;
    let (mechanism, units) = (&file.mechanism, file.units);
    let skeleton = Skeleton::new(mechanism, joints);
    let placed = skeleton.place_in_base(at).map_err(|error| Failure::at(label, error))?;
    let factor = units.factor(Quantity::Length);
    let point = |p: Point3<f64>| -> [f64; 3] { (p.coords / factor).into() };
    let mut bodies = Vec::new();
    let mut names = Vec::new();
    let mut used = BTreeSet::new();
    for (body, place) in skeleton.bodies().iter().zip(&placed) {
        for (part, name) in body.parts.iter().zip(names_of_parts(body)) {
            let interferes = name.is_some_and(|name| red.contains(&name));
            let paint = if interferes {
                Paint::Interfering
            } else {
                Paint::of(part.material, || {
                    let divided = joints.filter(|joints| !joints.imaginary.is_empty());
                    divided.and_then(|joints| is_upper(mechanism, joints.decomposition, body))
                })
            };
            used.insert(paint);
            bodies.push((solid(&part.solid, place, point, factor), paint.color()));
        }
        // Each joint is named once. Its body on the platform side comes last; with that one, a slider's block moves.
        for seat in body.seats.iter().filter(|seat| seat.motion != SeatMotion::Weld) {
            let at = point(place * seat.centre);
            match names.iter_mut().find(|named: &&mut Named| named.name == seat.joint) {
                Some(named) => named.at = at,
                None => names.push(Named { name: seat.joint.clone(), at }),
            }
        }
    }
    for obstacle in &mechanism.shapes.obstacles {
        let interferes = red.contains(&obstacle.name);
        let paint = if interferes { Paint::Interfering } else { Paint::Obstacle };
        used.insert(paint);
        let solids = Solid::of_obstacle(&obstacle.shape, skeleton.size(), &mechanism.platform);
        let rest = Isometry3::identity();
        bodies.extend(solids.iter().map(|s| (solid(s, &rest, point, factor), paint.color())));
    }
    let length = units.symbol(Quantity::Length).to_owned();
    Ok(ViewFigure {
        heading: Heading { title: mechanism.name.clone(), lines, notes: vec![] },
        unit: Unit { symbol: length, steps: Steps::Decimal, resolution: NOISE / factor },
        bodies,
        names,
        legend: used.into_iter().map(|paint| (paint.name().to_owned(), paint.color())).collect(),
    })
}

fn solid(
    solid: &Solid,
    place: &Isometry3<f64>,
    point: impl Fn(Point3<f64>) -> [f64; 3],
    factor: f64,
) -> opm_plot::Body {
    match *solid {
        Solid::Cylinder { from, to, radius } => opm_plot::Body::Rod {
            from: point(place * from),
            to: point(place * to),
            radius: radius / factor,
        },
        Solid::Ball { centre, radius } => {
            opm_plot::Body::Ball { centre: point(place * centre), radius: radius / factor }
        }
        Solid::Block { centre, axis, length, width } => opm_plot::Body::Block {
            centre: point(place * centre),
            axis: (place.rotation * axis.into_inner()).into(),
            length: length / factor,
            width: width / factor,
        },
    }
}

/// Whether a link belongs to the upper section: a joint of that section is on its base side.
fn is_upper(mechanism: &Mechanism, decomposition: &Decomposition, body: &Body) -> Option<bool> {
    let (leg, joint) = body.name.split_once('/')?;
    let number = mechanism.legs.iter().position(|known| known.name == leg)?;
    let joint = mechanism.legs[number].joints.iter().position(|known| known.name == joint)?;
    Some(decomposition.legs[number].upper.iter().any(|freedom| freedom.joint <= joint))
}

/// What a part of the picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Paint {
    Base,
    Link,
    LowerLink,
    UpperLink,
    Platform,
    Actuated,
    Passive,
    Imaginary,
    Obstacle,
    Interfering,
}

impl Paint {
    fn of(material: Material, is_upper: impl FnOnce() -> Option<bool>) -> Self {
        match material {
            Material::Base => Self::Base,
            Material::Link => match is_upper() {
                Some(true) => Self::UpperLink,
                Some(false) => Self::LowerLink,
                None => Self::Link,
            },
            Material::Platform => Self::Platform,
            Material::Actuated => Self::Actuated,
            Material::Passive => Self::Passive,
            Material::Imaginary => Self::Imaginary,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Link => "link",
            Self::LowerLink => "link of the lower section",
            Self::UpperLink => "link of the upper section",
            Self::Platform => "platform",
            Self::Actuated => "actuated joint",
            Self::Passive => "passive joint",
            Self::Imaginary => "imaginary joint",
            Self::Obstacle => "obstacle",
            Self::Interfering => "interfering",
        }
    }

    /// Colours that people with any kind of colour vision can tell apart, by Okabe and Ito, and greys.
    fn color(self) -> Color {
        match self {
            Self::Base => [0x55, 0x55, 0x5a],
            Self::Link | Self::LowerLink => [0xc4, 0xc6, 0xca],
            Self::UpperLink => [0x8f, 0xc9, 0xb4],
            Self::Platform => [0x00, 0x72, 0xb2],
            Self::Actuated => [0xd5, 0x5e, 0x00],
            Self::Passive => [0x56, 0xb4, 0xe9],
            Self::Imaginary => [0xe6, 0xbf, 0xd6],
            Self::Obstacle => [0x99, 0x7a, 0x4d],
            Self::Interfering => [0xe0, 0x10, 0x10],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::Format;
    use opm_core::mechanism::examples;
    use opm_core::mechanism::joint::JointKind;

    /// A name stands at the block of its slider, which is as far from home as the value of the joint says. Only the first
    /// joints of legs are looked at, as their guides do not move.
    #[test]
    fn names_of_sliders_move_with_them() {
        let output = Output { format: Format::Text, quiet: true, silent: true };
        for (name, pose) in [
            ("cartesian-wrist-6dof", "x=150mm,y=100mm,z=500mm"),
            ("plano-spherical-5dof", "x=100mm,y=50mm"),
            ("schoenflies-column-4dof", "z=80mm,x=60mm"),
        ] {
            let loaded = load::attached(name, name, examples::find(name).unwrap().text).unwrap();
            let manipulator = loaded.compile().unwrap();
            let pose: Pose = pose.parse().unwrap();
            let at = At { pose: Some(&pose), mode: None };
            let (solution, _) = solve(&loaded, &manipulator, &at, &output).unwrap();
            let [home, moved] =
                [At::default(), at].map(|at| figure(&loaded, &at, &output).unwrap());
            let place = |figure: &ViewFigure, joint: &str| {
                figure.names.iter().find(|named| named.name == joint).unwrap().at
            };
            let mut first = 0;
            let mut sliders = 0;
            for leg in &loaded.file.mechanism.legs {
                let joint = &leg.joints[0];
                if joint.kind == JointKind::Prismatic {
                    let shift = 1e3 * (solution.joints()[first] - joint.coordinates[0].home);
                    let [from, to] = [&home, &moved].map(|figure| place(figure, &joint.name));
                    let off = (0..3).map(|i| to[i] - from[i] - shift * joint.axis[i]);
                    assert!(off.map(f64::abs).fold(0.0, f64::max) < 1e-6, "{name}: {}", joint.name);
                    let on_block = |body: &opm_plot::Body| match body {
                        opm_plot::Body::Block { centre, .. } => {
                            (0..3).all(|i| (centre[i] - to[i]).abs() < 1e-6)
                        }
                        _ => false,
                    };
                    assert!(moved.bodies.iter().any(|(body, _)| on_block(body)), "{}", joint.name);
                    sliders += usize::from(shift.abs() > 1.0);
                }
                first += leg.coordinates().count();
            }
            assert!(sliders > 0, "{name}");
        }
    }

    #[test]
    fn a_mode_is_told() {
        let output = Output { format: Format::Text, quiet: true, silent: true };
        let text = examples::find("five-bar").unwrap().text;
        let loaded = load::attached("five-bar", "five-bar", text).unwrap();
        let line = |mode| {
            let at = At { pose: None, mode };
            figure(&loaded, &at, &output).unwrap().heading.lines[0].clone()
        };
        assert!(line(None).starts_with("at home: x = 0 mm"));
        assert_eq!(line(Some("- +")), line(None));
        let other = line(Some("+ +"));
        assert!(other.starts_with("x = 0 mm") && other.ends_with("; mode + +"), "{other}");
    }
}
