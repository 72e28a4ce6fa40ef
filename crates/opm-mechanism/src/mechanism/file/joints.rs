//! Reading the form of mechanism file that lists the joints at the assembled home pose.

use super::leg_name;
use super::pattern::{self, Pattern, Placement};
use super::problem::Locations;
use super::reader::{Table, UniqueNames, Value, all};
use super::{FileUnits, LegPattern};
use crate::mechanism::joint::{DriveLimit, DriveNumber, Joint, JointKind};
use crate::mechanism::leg::{Leg, Section, placed};
use crate::mechanism::{
    BodyMasses, Cone, FrameHints, HOME_COORDINATES, Mechanism, OrientationCoordinates, Shapes,
    TaskHints, TaskKey,
};
use crate::numeric::Quantity;
use nalgebra::{Point3, Unit, Vector3};
use std::f64::consts::PI;

pub(super) const KEYS: &[&str] = &[
    "format",
    "name",
    "units",
    "parameters",
    "platform",
    "task",
    "bodies",
    "obstacle",
    "difference",
    "leg",
];
pub(super) const LEG_KEYS: &[&str] = &["name", "joints", "pattern"];
pub(super) const TASK_KEYS: &[&str] =
    &["axis", "lower", "upper", "coordinates", "home", "independent"];
/// The keys of `[task]` in the file of a family, of which the frames are given.
pub(super) const FAMILY_TASK_KEYS: &[&str] = &["coordinates"];
pub(super) const FRAME_KEYS: &[&str] = &["x", "axis", "w", "normal", "origin"];
pub(super) const TYPES: [(&str, Type); 7] = [
    ("revolute", Type::Revolute),
    ("prismatic", Type::Prismatic),
    ("helical", Type::Helical),
    ("cylindrical", Type::Cylindrical),
    ("universal", Type::Universal),
    ("spherical", Type::Spherical),
    ("parallelogram", Type::Parallelogram),
];

/// Names that tables and recordings use for other columns than joints: the task coordinates of all
/// pairs of subspaces, and status columns. Imaginary joints are `tau.` and the leg's name.
pub(super) const RESERVED: [&str; 15] = [
    "x",
    "y",
    "z",
    "w",
    "theta",
    "phi",
    "zeta",
    "xi",
    "psi",
    "mu",
    "nu",
    "reachable",
    "within_limits",
    "mode",
    "branch",
];

/// Sine of the angle below which the two axes of a universal joint count as parallel, so that its
/// two freedoms would be the same.
const PARALLEL: f64 = 1e-6;

/// The `type` of a joint.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Type {
    Revolute,
    Prismatic,
    Helical,
    Cylindrical,
    Universal,
    Spherical,
    /// Two hinges: see [`Joint::parallelogram`].
    Parallelogram,
}

impl Type {
    /// The keys that a joint of this type may have.
    pub(super) fn keys(self) -> Vec<&'static str> {
        let mut keys = vec!["name", "type", "point", "actuated", "home", "limits"];
        keys.extend(DriveLimit::ALL.map(DriveLimit::key));
        keys.extend(DriveNumber::ALL.map(DriveNumber::key));
        keys.extend(self.directions().iter().chain(self.lengths()));
        if self.tilts() {
            keys.push("cone");
        }
        match self {
            Self::Revolute => keys.push(Joint::TURNS_BACK),
            Self::Parallelogram => keys.push("point2"),
            _ => {}
        }
        keys
    }

    /// The keys that a joint of this type must have, beyond its name and its type.
    #[cfg(feature = "schema")]
    pub(super) fn needs(self) -> Vec<&'static str> {
        let mut keys = [self.directions(), self.lengths()].concat();
        if self != Self::Prismatic {
            keys.push("point");
        }
        if self == Self::Parallelogram {
            keys.push("point2");
        }
        keys
    }

    /// Whether it may have a cone.
    fn tilts(self) -> bool {
        match self {
            Self::Universal | Self::Spherical => true,
            Self::Revolute
            | Self::Prismatic
            | Self::Helical
            | Self::Cylindrical
            | Self::Parallelogram => false,
        }
    }

    /// The keys of its axes.
    fn directions(self) -> &'static [&'static str] {
        match self {
            Self::Revolute
            | Self::Prismatic
            | Self::Helical
            | Self::Cylindrical
            | Self::Parallelogram => &["axis"],
            Self::Universal => &["axis", "axis2"],
            Self::Spherical => &[],
        }
    }

    /// The keys of its dimensions.
    fn lengths(self) -> &'static [&'static str] {
        match self {
            Self::Helical => &["pitch"],
            Self::Revolute
            | Self::Prismatic
            | Self::Cylindrical
            | Self::Universal
            | Self::Spherical
            | Self::Parallelogram => &[],
        }
    }
}

/// Reads the mechanism. What cannot be read is reported and replaced by a harmless value, so that
/// the rest is checked too.
pub(super) fn read(root: &Table<'_>, name: &str) -> (Mechanism, Locations<usize>, Vec<LegPattern>) {
    root.allow(KEYS);
    let point = "the platform's reference point [x, y, z] at home";
    let platform = root
        .require("platform", "a table [platform] with its `point`, or else a `family`")
        .and_then(|value| value.table(&["point"]))
        .and_then(|table| table.require("point", point)?.point())
        .map_or_else(Point3::origin, Point3::from);
    let mut locations = Locations::default();
    let task = root
        .get("task")
        .and_then(|value| value.table(TASK_KEYS))
        .map_or_else(TaskHints::default, |task| read_task(&task, &mut locations));

    let tables = root.tables("leg", LEG_KEYS);
    let (described, patterns) = legs(&tables);
    let (mut leg_names, mut joint_names) = (UniqueNames::new("legs"), UniqueNames::new("joints"));
    for name in RESERVED {
        joint_names.reserve(name, "a task coordinate or a column of tables");
    }
    for leg in &described {
        let imaginary = Leg::new(leg.name.clone(), Vec::new()).imaginary_name();
        joint_names.reserve(&imaginary, "that leg's imaginary joint");
    }
    let mut legs = Vec::new();
    for leg in described {
        leg_names.add(&leg.name, root.reader, leg.table.location_of("name"));
        locations.legs.push(leg.table.at);
        root.reader.number_leg(leg.number.map(|(number, _)| number));
        let mut joints =
            read_joints(leg.table, platform, leg.number, &mut joint_names).unwrap_or_default();
        root.reader.number_leg(None);
        if let Some(place) = leg.place {
            joints.iter_mut().for_each(|joint| place.place(joint));
        }
        legs.push(Leg::new(leg.name, joints));
    }
    let at = root.location_of("leg");
    // How many legs a wrong pattern would make is not known.
    let told = patterns.contains(&None);
    if legs.len() < 2 && !told && !root.reader.has_problem(at) {
        let (count, tables) = (legs.len(), if legs.len() == 1 { "table" } else { "tables" });
        let problem = format!("found {count} {tables} [[leg]], expected at least 2 legs");
        root.reader.report(at, problem);
    }
    let (bodies, shapes) = (BodyMasses::default(), Shapes::default());
    let units = root.reader.units();
    let name = name.to_owned();
    let copies = patterns.into_iter().flatten().filter(|pattern| !pattern.text.is_empty());
    let differences = Vec::new();
    let mechanism = Mechanism { name, legs, platform, differences, task, bodies, shapes, units };
    (mechanism, locations, copies.collect())
}

/// A leg of the file, or one of those that a pattern makes of it.
struct Described<'t, 'a> {
    table: &'t Table<'a>,
    name: String,
    /// Its number in the pattern, as names have it, and how many there are.
    number: Option<(usize, usize)>,
    place: Option<Placement>,
}

/// The legs of the file, in order, those of patterns one by one, and the patterns; `None` in place of a wrong one.
fn legs<'t, 'a>(tables: &'t [Table<'a>]) -> (Vec<Described<'t, 'a>>, Vec<Option<LegPattern>>) {
    let (mut legs, mut patterns) = (Vec::new(), Vec::new());
    for table in tables {
        let pattern = table.get("pattern");
        let Some(value) = pattern else {
            let name = leg_name(table, legs.len());
            let name = pattern::numbered(table.get("name").as_ref(), &name, None);
            legs.push(Described { table, name, number: None, place: None });
            continue;
        };
        let Some(pattern) = Pattern::read(&value) else {
            patterns.push(None);
            continue;
        };
        let count = pattern.count();
        for index in 0..count {
            let name = leg_name(table, legs.len());
            let given = table.get("name");
            let number = Some((pattern.first + index, count));
            let name = match given {
                Some(_) => pattern::numbered(given.as_ref(), &name, number),
                None => name,
            };
            let place = Some(pattern.place(index));
            legs.push(Described { table, name, number, place });
        }
        let names = legs[legs.len() - count..].iter().map(|leg| leg.name.clone());
        let text = pattern.describe(table.reader.units());
        patterns.push(Some(LegPattern { legs: names.collect(), text }));
    }
    (legs, patterns)
}

/// Reads `[task]`: how the pose is measured. Whether it fits the geometry is checked later.
fn read_task(task: &Table<'_>, locations: &mut Locations<usize>) -> TaskHints {
    TaskHints {
        axis: task_direction(task, TaskKey::Axis, locations),
        lower: read_frame(task, Section::Lower, locations),
        upper: read_frame(task, Section::Upper, locations),
        coordinates: read_angles(task, locations),
        home: read_home(task, locations),
        independent: read_independent(task, locations),
    }
}

/// Reads the names of the independent task coordinates. Whether the mechanism has these is checked later.
fn read_independent(task: &Table<'_>, locations: &mut Locations<usize>) -> Vec<String> {
    let Some(value) = task_value(task, TaskKey::Independent, locations) else { return Vec::new() };
    let Some(items) = value.items("an array of names of task coordinates") else {
        return Vec::new();
    };
    if items.is_empty() {
        value.report("is empty, expected the names of the independent task coordinates");
    }
    let mut names: Vec<String> = Vec::new();
    for item in items {
        let Some(name) = item.name() else { continue };
        if names.iter().any(|known| known == name) {
            item.report(format!("has {name:?} twice, expected different task coordinates"));
        }
        names.push(name.to_owned());
    }
    names
}

/// Reads the values of task coordinates at home. Whether the mechanism has these coordinates is checked later.
fn read_home(task: &Table<'_>, locations: &mut Locations<usize>) -> Vec<(String, f64)> {
    let value = task_value(task, TaskKey::Home, locations);
    let Some(home) = value.and_then(|value| value.table(&HOME_COORDINATES.map(|(name, _)| name)))
    else {
        return Vec::new();
    };
    let read = |(name, quantity)| Some((str::to_owned(name), home.get(name)?.quantity(quantity)?));
    HOME_COORDINATES.into_iter().filter_map(read).collect()
}

/// Reads which angles an orientation is written with.
pub(super) fn read_angles(
    task: &Table<'_>,
    locations: &mut Locations<usize>,
) -> Option<OrientationCoordinates> {
    let value = task_value(task, TaskKey::Coordinates, locations);
    value.and_then(|value| value.word(&OrientationCoordinates::NAMED))
}

fn read_frame(task: &Table<'_>, section: Section, locations: &mut Locations<usize>) -> FrameHints {
    let value = match section {
        Section::Lower => task.get("lower"),
        Section::Upper => task.get("upper"),
    };
    let Some(frame) = value.and_then(|value| value.table(FRAME_KEYS)) else {
        return FrameHints::default();
    };
    let origin = task_value(&frame, TaskKey::Origin(section), locations);
    FrameHints {
        x: task_direction(&frame, TaskKey::X(section), locations),
        axis: task_direction(&frame, TaskKey::AxisOf(section), locations),
        w: task_direction(&frame, TaskKey::W(section), locations),
        normal: task_direction(&frame, TaskKey::Normal(section), locations),
        origin: origin.and_then(|value| value.point()).map(Point3::from),
    }
}

fn task_direction(
    table: &Table<'_>,
    key: TaskKey,
    locations: &mut Locations<usize>,
) -> Option<Vector3<f64>> {
    task_value(table, key, locations)?.direction().map(Unit::into_inner)
}

/// Reads a value of `[task]` and notes its location.
fn task_value<'a>(
    table: &Table<'a>,
    key: TaskKey,
    locations: &mut Locations<usize>,
) -> Option<Value<'a>> {
    let value = table.get(key.name())?;
    locations.task.push((key, value.at));
    Some(value)
}

/// Reads the joints of a leg; `None` if one of them has no known type.
fn read_joints(
    leg: &Table<'_>,
    platform: Point3<f64>,
    number: Option<(usize, usize)>,
    names: &mut UniqueNames,
) -> Option<Vec<Joint>> {
    let expected = "an array of joints, from base to platform";
    let value = leg.require("joints", expected)?;
    let items = value.items(expected)?;
    if items.is_empty() {
        value.report("is empty, expected at least one joint");
    }
    let read = all(items.iter().map(|item| read_joint(item, platform, number, names)))?;
    let described = items
        .iter()
        .zip(read)
        .flat_map(|(item, joints)| joints.into_iter().map(move |joint| (item, joint)));
    let (items, joints): (Vec<&Value<'_>>, Vec<_>) = described.unzip();
    let placed = Leg::new("", placed(joints));
    check_cones(leg, &items, &placed);
    check_parallelograms(leg, &items, &placed);
    Some(placed.joints)
}

/// Checks that each hinge that turns back follows one with another, parallel axis.
fn check_parallelograms(table: &Table<'_>, items: &[&Value<'_>], leg: &Leg) {
    for (number, (item, joint)) in items.iter().zip(&leg.joints).enumerate() {
        if !joint.turns_back {
            continue;
        }
        let first = number.checked_sub(1).map(|before| &leg.joints[before]);
        let first = first.filter(|first| first.kind == JointKind::Revolute && !first.turns_back);
        let name = &joint.name;
        let problem = match first {
            None => format!(
                "{name} turns back, but the joint before it is not a revolute joint that it could turn back"
            ),
            Some(first) if (*first.axis - *joint.axis).norm() > PARALLEL => {
                format!(
                    "{name} turns back {}, but its `axis` is another, expected the same",
                    first.name
                )
            }
            Some(first) => {
                let bar = joint.point - first.point;
                let across = bar.cross(&first.axis).norm();
                let least = PARALLEL * bar.norm().max(first.point.coords.norm());
                if across > least {
                    continue;
                }
                format!(
                    "the two axes of {} are one line, expected a bar between them: the points have to differ across the axis",
                    first.name
                )
            }
        };
        table.reader.report(item.at, problem);
    }
}

/// Reads a joint; `None` if it has no type, because the type decides what else there is to check.
/// The second value says whether it has a place of its own.
fn read_joint(
    value: &Value<'_>,
    platform: Point3<f64>,
    number: Option<(usize, usize)>,
    names: &mut UniqueNames,
) -> Option<Vec<(Joint, bool)>> {
    let table = value.open_table()?;
    let name = table.require("name", "the joint's name");
    let name = name.and_then(|value| Some(pattern::numbered(Some(&value), value.name()?, number)));
    let kind = table.require("type", "the joint's type")?.word(&TYPES)?;
    table.allow(&kind.keys());

    let axis = match kind {
        Type::Spherical => None,
        _ => direction(&table, "axis"),
    };
    let given = table.get("point");
    let has_place = kind != Type::Prismatic || given.is_some();
    let point = match has_place {
        false => platform,
        true => table
            .require("point", "a point [x, y, z] of the joint at home")
            .and_then(|value| value.point())
            .map_or(platform, Point3::from),
    };
    let joint_kind = joint_kind(&table, kind, axis);
    let mut joint =
        Joint::new(name.unwrap_or_default(), joint_kind, axis.unwrap_or(Vector3::z_axis()), point);
    joint.actuated = table.get("actuated").is_some_and(|value| value.boolean().unwrap_or(true));
    if !joint.name.is_empty() {
        let at = table.location_of("name");
        names.add(&joint.name, table.reader, at);
        // The coordinate `s.x` of a spherical joint `s` may equal the name of another joint.
        for coordinate in joint.coordinates.iter().filter(|c| c.name != joint.name) {
            names.add(&coordinate.name, table.reader, at);
        }
    }
    read_coordinates(&table, &mut joint);
    let units = table.reader.units();
    let cone = table.get("cone").filter(|_| kind.tilts());
    joint.cone = cone.and_then(|value| read_cone(&value, units));
    let back = table.get(Joint::TURNS_BACK).filter(|_| kind == Type::Revolute);
    if back.is_some_and(|value| value.boolean().unwrap_or_default()) {
        joint.turns_back = true;
        if joint.actuated {
            let at = table.location_of("actuated");
            let name = &joint.name;
            let problem = format!(
                "{name} turns back and is actuated, expected the motor at the joint before it"
            );
            table.reader.report(at, problem);
        }
    }
    let mut joints = vec![(joint, has_place)];
    if kind == Type::Parallelogram {
        joints.extend(read_end(&table, &joints[0].0, names).map(|end| (end, true)));
    }
    Some(joints)
}

/// Reads the second hinge of a parallelogram. What limits the angle stands with the first one.
fn read_end(table: &Table<'_>, first: &Joint, names: &mut UniqueNames) -> Option<Joint> {
    let end = table.require("point2", "a point [x, y, z] on the axis at the other end of the bar");
    let end = Point3::from(end?.point()?);
    let [_, back] = Joint::parallelogram(&first.name, first.axis, [first.point, end]);
    if !first.name.is_empty() {
        names.add(&back.name, table.reader, table.location_of("name"));
    }
    Some(back.at(-first.coordinates[0].home))
}

/// Reads the cone of a joint: half its angle, or a table with that and its axis.
fn read_cone(value: &Value<'_>, units: FileUnits) -> Option<Cone> {
    let table = if value.is_table() { Some(value.table(&["angle", "axis"])?) } else { None };
    let (angle, axis) = match &table {
        None => (value.quantity(Quantity::Angle), None),
        Some(table) => {
            let angle = table.require("angle", "the largest angle between the rod and the axis");
            let axis = table.get("axis").and_then(|value| value.direction());
            (angle.and_then(|angle| angle.quantity(Quantity::Angle)), axis)
        }
    };
    let half_angle = angle?;
    if !(half_angle > 0.0 && half_angle < PI) {
        let [found, most] = [half_angle, PI].map(|angle| units.show(angle, Quantity::Angle));
        value.report(format!("has the angle {found}, expected one above 0 and below {most}"));
        return None;
    }
    Some(Cone { half_angle, axis })
}

/// Checks the cones of a leg's joints: that they have a rod, and that home is inside.
fn check_cones(table: &Table<'_>, items: &[&Value<'_>], leg: &Leg) {
    let units = table.reader.units();
    let cones = leg.cones();
    for (number, (item, joint)) in items.iter().zip(&leg.joints).enumerate() {
        let Some(Cone { half_angle, .. }) = joint.cone else { continue };
        let Some(cone) = cones.iter().find(|cone| cone.joint == number) else {
            let name = &joint.name;
            let problem = format!(
                "{name} has a cone, but no other joint of its leg has another place: there is no rod"
            );
            table.reader.report(item.at, problem);
            continue;
        };
        let tilt = cone.tilt(&[0.0; 3]);
        if !cone.admits(&[0.0; 3]) {
            let [tilt, most] = [tilt, half_angle].map(|angle| units.show(angle, Quantity::Angle));
            let name = &joint.name;
            let problem = format!(
                "the cone of {name} excludes home: the rod is {tilt} from its axis there, expected at most {most}"
            );
            table.reader.report(item.at, problem);
        }
    }
}

fn direction(table: &Table<'_>, key: &str) -> Option<Unit<Vector3<f64>>> {
    table.require(key, "a direction [x, y, z] at home")?.direction()
}

fn joint_kind(table: &Table<'_>, kind: Type, axis: Option<Unit<Vector3<f64>>>) -> JointKind {
    match kind {
        Type::Revolute | Type::Parallelogram => JointKind::Revolute,
        Type::Prismatic => JointKind::Prismatic,
        Type::Cylindrical => JointKind::Cylindrical,
        Type::Spherical => JointKind::Spherical,
        Type::Helical => {
            let value = table.require("pitch", "the advance per radian, a length");
            let pitch = value.and_then(|value| value.length());
            if let (Some(value), Some(0.0)) = (value, pitch) {
                value.report("is 0, expected an advance per radian: without it, a revolute joint");
            }
            JointKind::Helical { pitch: pitch.unwrap_or_default() }
        }
        Type::Universal => {
            let second = direction(table, "axis2");
            if let (Some(first), Some(second)) = (axis, second)
                && first.cross(&second).norm() < PARALLEL
            {
                let at = table.location_of("axis2");
                table
                    .reader
                    .report(at, "`axis2` is parallel to `axis`, expected another direction");
            }
            JointKind::Universal { second: second.unwrap_or(Vector3::x_axis()) }
        }
    }
}

/// Reads `home`, `limits` and the limits of motion: one value or pair per coordinate.
fn read_coordinates(table: &Table<'_>, joint: &mut Joint) {
    let quantities: Vec<Quantity> = joint.coordinates.iter().map(|c| c.quantity).collect();
    let home = match table.get("home") {
        Some(value) => value.per_coordinate(&quantities, Value::quantity),
        None => Some(vec![0.0; quantities.len()]),
    };
    for limit in DriveLimit::ALL {
        let value = table.get(limit.key());
        let read = |item: &Value<'_>, quantity| item.drive_limit(limit, quantity);
        let given = value.and_then(|value| value.per_coordinate(&quantities, read));
        for (coordinate, given) in joint.coordinates.iter_mut().zip(given.into_iter().flatten()) {
            *limit.of_mut(coordinate) = Some(given);
        }
    }
    for number in DriveNumber::ALL {
        let value = table.get(number.key());
        let read = |item: &Value<'_>, quantity| item.drive_number(number, quantity);
        let given = value.and_then(|value| value.per_coordinate(&quantities, read));
        for (coordinate, given) in joint.coordinates.iter_mut().zip(given.into_iter().flatten()) {
            *number.of_mut(&mut coordinate.drive) = given;
        }
    }
    let limits = table.get("limits");
    let pairs = limits.and_then(|value| value.limits_per_coordinate(&quantities));
    for (i, coordinate) in joint.coordinates.iter_mut().enumerate() {
        coordinate.limits = pairs.as_ref().map(|pairs| pairs[i]);
        let Some(home) = &home else { continue };
        coordinate.home = home[i];
        if let (Some(value), Some([low, high])) = (limits, coordinate.limits)
            && !(low..=high).contains(&home[i])
        {
            let show = |number| table.reader.units().show(number, coordinate.quantity);
            value.report(format!(
                "exclude home: {} is {} there, expected it between {} and {}",
                coordinate.name,
                show(home[i]),
                show(low),
                show(high)
            ));
        }
    }
}
