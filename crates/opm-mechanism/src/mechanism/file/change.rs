//! A mechanism file with some of its numbers changed: the parameters of a family, or the values at home and the limits of
//! the joints of a list.

use super::{
    Digits, FileUnits, Locations, MechanismFile, NamedParameter, NamedValue, ParameterUnit, Source,
    checks, nearest, write, writer,
};
use crate::mechanism::family::{Family, ParameterErrors, ParameterValue};
use crate::mechanism::joint::{DriveLimit, DriveNumber, JointCoordinate};
use crate::mechanism::{Mechanism, Payload, TaskHints};
use crate::numeric::Quantity;
use nalgebra::Matrix3;

impl MechanismFile {
    /// The dimensions that the file gives by name, SI: its named parameters that are numbers and follow from no others, then
    /// the parameters of its family ([`Family::parameters`]).
    pub fn dimensions(&self) -> Vec<(String, ParameterValue)> {
        let named = self.parameters.iter().filter(|parameter| parameter.formula.is_none());
        let named = named.filter_map(|parameter| match parameter.value {
            NamedValue::Number(value) => {
                Some((parameter.name.clone(), ParameterValue::Number(value)))
            }
            NamedValue::Point(_) => None,
        });
        named.chain(self.family.iter().flat_map(Family::parameters)).collect()
    }

    /// The parameter that the file names so.
    pub fn parameter(&self, name: &str) -> Option<&NamedParameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// Whether a name that [`MechanismFile::with`] takes is that of a number that has no unit at all.
    pub fn is_plain(&self, name: &str) -> bool {
        self.parameter(name).is_some_and(|parameter| parameter.unit == ParameterUnit::Number)
    }

    /// What a number of the file measures, by the name that [`MechanismFile::with`] takes; `None` if there is no such
    /// number, if it is an effort ([`MechanismFile::is_effort`]) or of a drive ([`MechanismFile::drive_number`]), and if it has no unit
    /// ([`MechanismFile::is_plain`]).
    pub fn quantity_of(&self, name: &str) -> Option<Quantity> {
        if let Some(parameter) = self.parameter(name) {
            return parameter.unit.quantity();
        }
        match &self.family {
            Some(family) => family.quantity_of(name),
            None => {
                let (joint, part) = split(name)?;
                if matches!(part, JointEntry::Drive(DriveLimit::Effort) | JointEntry::Number(_)) {
                    return None;
                }
                let mut all = self.mechanism.coordinates();
                all.find(|c| joint.is_none_or(|joint| joint == c.name)).map(|c| c.quantity)
            }
        }
    }

    /// Whether a name that [`MechanismFile::with`] takes is that of the largest effort of actuators, in newtons or newton
    /// metres.
    pub fn is_effort(&self, name: &str) -> bool {
        self.parameter(name).is_none()
            && name.split('.').any(|part| part == DriveLimit::Effort.key())
    }

    /// The number of a drive that a name which [`MechanismFile::with`] takes is that of, if it is.
    pub fn drive_number(&self, name: &str) -> Option<DriveNumber> {
        let is = |number: &DriveNumber| name.split('.').any(|part| part == number.key());
        let found = DriveNumber::ALL.into_iter().find(is);
        found.filter(|_| self.parameter(name).is_none())
    }

    /// Whether a name that [`MechanismFile::with`] takes is that of a largest rate, acceleration or effort, or of a number of a drive, and
    /// not that of a length or an angle.
    pub fn is_of_drive(&self, name: &str) -> bool {
        let of = |part: &str| DriveLimit::ALL.iter().any(|limit| limit.key() == part);
        let limited = self.parameter(name).is_none() && name.split('.').any(of);
        limited || self.drive_number(name).is_some()
    }

    /// Whether a name that [`MechanismFile::with`] takes is that of a mass, kg, or of the density of bodies, kg/m³.
    pub fn is_of_bodies(&self, name: &str) -> bool {
        let is = name.starts_with("masses.") || ["payload.mass", "density"].contains(&name);
        is && self.parameter(name).is_none()
    }

    /// The same file with some numbers changed, SI.
    ///
    /// A name may be one of [`MechanismFile::parameters`]: everything that the file gives by it follows.
    /// The names are those of [`Family::parameters`] (see [`Family::with`]). In a list of joints, `S1.limits` are the
    /// limits of a joint coordinate, `S1.max_rate`, `S1.max_acceleration` and `S1.max_effort` those of how it is driven,
    /// `S1.rotor_inertia` and the other keys of [`DriveNumber`] the numbers of its drive, and
    /// `S1.home` is its value at home; `limits` alone are those of all joints that have any, and so are the others.
    ///
    /// In every file, `masses.NAME` is the mass of a body, `payload.mass` that of what the platform carries, and `density` the density of the
    /// bodies whose masses are not given.
    ///
    /// # Errors
    /// A name or a value is wrong, or a leg does not reach home.
    pub fn with<'n>(
        &self,
        changes: impl IntoIterator<Item = (&'n str, ParameterValue)>,
    ) -> Result<Self, ParameterErrors> {
        let changes: Vec<_> = changes.into_iter().collect();
        let (named, others): (Vec<_>, Vec<_>) =
            changes.into_iter().partition(|(name, _)| self.parameter(name).is_some());
        let file = if named.is_empty() { self.clone() } else { self.with_named(&named)? };
        let (masses, others): (Vec<_>, Vec<_>) =
            others.into_iter().partition(|(name, _)| self.is_of_bodies(name));
        let file = if masses.is_empty() { file } else { file.with_masses(masses)? };
        if others.is_empty() { Ok(file) } else { file.with_others(others) }
    }

    /// The same with other values of named parameters: the file is read anew with them.
    #[cfg(feature = "files")]
    fn with_named(&self, changes: &[(&str, ParameterValue)]) -> Result<Self, ParameterErrors> {
        let (mut values, mut problems) = (Vec::new(), Vec::new());
        for &(name, value) in changes {
            let Some(parameter) = self.parameter(name) else { continue };
            match parameter.takes(value) {
                Ok(value) => values.push((name, parameter.unit.number_of(value, self.units))),
                Err(problem) => problems.push(format!("`{name}` {problem}")),
            }
        }
        if !problems.is_empty() {
            return Err(ParameterErrors { problems });
        }
        let text = self.edited().and_then(|text| super::edit::parameters(&text, &values));
        let Some(text) = text else {
            let problem = "the text with the parameters is not known".to_owned();
            return Err(ParameterErrors { problems: vec![problem] });
        };
        super::read(&text).map_err(|errors| ParameterErrors {
            problems: errors.problems.into_iter().map(|problem| problem.message).collect(),
        })
    }

    /// Nothing is named where files are not read.
    #[cfg(not(feature = "files"))]
    fn with_named(&self, _: &[(&str, ParameterValue)]) -> Result<Self, ParameterErrors> {
        Ok(self.clone())
    }

    /// The text that it was read from with what was changed since; `None` where that text cannot say it, as for one leg of a
    /// pattern.
    #[cfg(feature = "files")]
    fn edited(&self) -> Option<String> {
        use super::edit;
        let Source { text, mechanism, family } = &**self.source.as_ref()?;
        if *mechanism == self.mechanism && *family == self.family {
            return Some(text.clone());
        }
        let mechanisms = [mechanism, &self.mechanism];
        match [family, &self.family] {
            [Some(old), Some(new)] if mechanism.units == self.units => {
                let text = edit::family(text, [old, new], self.units)?;
                edit::angles(&text, mechanisms)
            }
            [None, None] => edit::joints(text, mechanisms, self.units),
            _ => None,
        }
    }

    #[cfg(not(feature = "files"))]
    fn edited(&self) -> Option<String> {
        None
    }

    /// The same with the text that gives its numbers, if there is one; else it has no named parameters any more.
    fn settled(mut self) -> Self {
        let text = self.edited();
        if text.is_none() {
            (self.parameters, self.patterns) = (Vec::new(), Vec::new());
        }
        self.source = text.map(|text| Source::of(text, &self));
        self
    }

    /// The same with other masses.
    fn with_masses(&self, changes: Vec<(&str, ParameterValue)>) -> Result<Self, ParameterErrors> {
        let mut file = self.clone();
        let names: Vec<String> = file.mechanism.body_names().map(str::to_owned).collect();
        let bodies = &mut file.mechanism.bodies;
        let mut problems = Vec::new();
        for (name, value) in changes {
            let range = if name == "density" { checks::DENSITIES } else { checks::MASSES };
            let unit = if name == "density" { "kg/m^3" } else { "kg" };
            let mut set = || {
                let ParameterValue::Number(value) = value else {
                    return Err("expected a number".to_owned());
                };
                let value = checks::within(value, range, unit)?;
                match name.strip_prefix("masses.") {
                    None if name == "density" => bodies.density = Some(value),
                    None => {
                        let none = Payload { mass: value, centre: None, inertia: Matrix3::zeros() };
                        bodies.payload.get_or_insert(none).mass = value;
                    }
                    Some(body) if !names.iter().any(|known| known == body) => {
                        let hint = nearest(body, &names);
                        let hint = hint.map_or_else(String::new, |meant| {
                            format!("did you mean `masses.{meant}`? ")
                        });
                        return Err(format!(
                            "names no body {body}; {hint}expected one of {}",
                            names.join(", ")
                        ));
                    }
                    Some(body) => match bodies.masses.iter_mut().find(|(known, _)| known == body) {
                        Some((_, mass)) => *mass = value,
                        None => bodies.masses.push((body.to_owned(), value)),
                    },
                }
                Ok(())
            };
            problems.extend(set().err().map(|problem| format!("`{name}` {problem}")));
        }
        // In the order in which they are read.
        let place = |body: &String| names.iter().position(|known| known == body);
        bodies.masses.sort_by_key(|(body, _)| place(body));
        if !problems.is_empty() {
            return Err(ParameterErrors { problems });
        }
        file.places = Locations::default();
        Ok(if file.parameters.is_empty() { file } else { file.settled() })
    }

    /// The same with other numbers than those of named parameters changed.
    fn with_others(&self, changes: Vec<(&str, ParameterValue)>) -> Result<Self, ParameterErrors> {
        let mut file = self.clone();
        match &self.family {
            Some(family) => {
                let family = family.with_in(changes, self.units)?;
                let mechanism =
                    family.assemble().map_err(|error| family.explain_in(&error, self.units))?;
                file.mechanism.legs = mechanism.legs;
                file.mechanism.platform = mechanism.platform;
                file.mechanism.task =
                    TaskHints { coordinates: self.mechanism.task.coordinates, ..mechanism.task };
                file.mode = Some(family.mode());
                file.family = Some(family);
            }
            None => {
                let mut problems = Vec::new();
                for (name, value) in changes {
                    let problem = change(&mut file.mechanism, name, value, self).err();
                    problems.extend(problem.map(|problem| format!("`{name}` {problem}")));
                }
                if problems.is_empty() {
                    let problems_of = |c| excludes_home(c, self.units);
                    problems.extend(file.mechanism.coordinates().filter_map(problems_of));
                }
                if !problems.is_empty() {
                    return Err(ParameterErrors { problems });
                }
            }
        }
        file.places = Locations::default();
        Ok(if file.parameters.is_empty() { file } else { file.settled() })
    }

    /// The text of the file, in its units: as it was typed, but for what was changed.
    pub fn text(&self) -> String {
        let written = || text(&self.mechanism, self.family.as_ref(), self.units);
        self.edited().unwrap_or_else(written)
    }
}

/// The text of a mechanism file with these units: the parameters of the mechanism's family, or its joints.
pub fn text(mechanism: &Mechanism, family: Option<&Family>, units: FileUnits) -> String {
    match family {
        Some(family) => {
            // The frames of a family are given.
            let coordinates = mechanism.task.coordinates;
            let hints = TaskHints { coordinates, ..TaskHints::default() };
            let task = writer::task(&hints, units, Digits::All);
            family.write_in(units) + &task + &writer::surroundings(mechanism, units, Digits::All)
        }
        None => write(mechanism, units, Digits::All),
    }
}

/// What is changed of a joint.
#[derive(Clone, Copy, PartialEq)]
enum JointEntry {
    Home,
    Limits,
    Drive(DriveLimit),
    Number(DriveNumber),
}

impl JointEntry {
    /// Whether it is a limit, or a number of a drive, that the coordinate has.
    fn is_limit_of(self, coordinate: &JointCoordinate) -> bool {
        match self {
            Self::Home => false,
            Self::Limits => coordinate.limits.is_some(),
            Self::Drive(limit) => limit.of(coordinate).is_some(),
            Self::Number(number) => number.of(&coordinate.drive) != number.usual(),
        }
    }
}

/// The joint coordinate of a name, or all of them, and what of it the name changes.
fn split(name: &str) -> Option<(Option<&str>, JointEntry)> {
    let (joint, part) = match name.rsplit_once('.') {
        Some((joint, part)) => (Some(joint), part),
        None => (None, name),
    };
    let part = match part {
        "home" if joint.is_some() => JointEntry::Home,
        "limits" => JointEntry::Limits,
        part => {
            let limit = DriveLimit::ALL.into_iter().find(|limit| limit.key() == part);
            let number = || DriveNumber::ALL.into_iter().find(|number| number.key() == part);
            limit.map(JointEntry::Drive).or_else(|| number().map(JointEntry::Number))?
        }
    };
    Some((joint, part))
}

/// Changes a joint of a list, or says what is wrong, in the units of the file. The value is SI.
fn change(
    mechanism: &mut Mechanism,
    name: &str,
    value: ParameterValue,
    file: &MechanismFile,
) -> Result<(), String> {
    let units = file.units;
    let names: Vec<String> = mechanism.coordinates().map(|c| c.name.clone()).collect();
    let list = || names.join(", ");
    let Some((joint, part)) = split(name) else {
        let parts = ["limits", "home"].into_iter().chain(DriveLimit::ALL.map(DriveLimit::key));
        let parts = parts.chain(DriveNumber::ALL.map(DriveNumber::key));
        let parts =
            names.iter().flat_map(|name| parts.clone().map(move |part| format!("{name}.{part}")));
        let named: Vec<String> = file.parameters.iter().map(|p| p.name.clone()).collect();
        let hint = nearest(name, &parts.chain(named.iter().cloned()).collect::<Vec<_>>());
        let hint = hint.map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        let parameters = match &named[..] {
            [] => String::new(),
            named => format!("a parameter ({}), ", named.join(", ")),
        };
        return Err(format!(
            "is not a number of a list of joints; {hint}expected {parameters}JOINT.limits, JOINT.home, JOINT.max_rate, \
             JOINT.max_acceleration, JOINT.max_effort, {}, JOINT one of {}",
            DriveNumber::ALL.map(|number| format!("JOINT.{}", number.key())).join(", "),
            list()
        ));
    };
    let all = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let all = all.flat_map(|joint| &mut joint.coordinates);
    let chosen: Vec<&mut JointCoordinate> = match joint {
        Some(joint) => all.filter(|c| c.name == joint).collect(),
        None => all.filter(|c| part.is_limit_of(c)).collect(),
    };
    if chosen.is_empty() {
        let Some(joint) = joint else { return Err("changes nothing: no joint has any".into()) };
        let hint = nearest(joint, &names);
        let hint = hint.map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        return Err(format!("names no joint {joint}; {hint}expected one of {}", list()));
    }
    let size = |value, quantity| checks::size(checks::finite(value)?, quantity, units);
    for coordinate in chosen {
        let quantity = coordinate.quantity;
        match (part, value) {
            (JointEntry::Home, ParameterValue::Number(value)) => {
                coordinate.home = size(value, quantity)?;
            }
            (JointEntry::Limits, ParameterValue::None) => coordinate.limits = None,
            (JointEntry::Limits, ParameterValue::Pair([low, high])) => {
                let limits = [size(low, quantity)?, size(high, quantity)?];
                coordinate.limits = Some(checks::ordered(limits, quantity, units)?);
            }
            (JointEntry::Drive(limit), ParameterValue::None) => {
                *limit.of_mut(coordinate) = None;
            }
            (JointEntry::Drive(limit), ParameterValue::Number(value)) => {
                let value = checks::finite(value)?;
                let value = checks::drive_limit(value, limit, quantity, units)?;
                *limit.of_mut(coordinate) = Some(value);
            }
            (JointEntry::Number(number), ParameterValue::None) => {
                *number.of_mut(&mut coordinate.drive) = number.usual();
            }
            (JointEntry::Number(number), ParameterValue::Number(value)) => {
                *number.of_mut(&mut coordinate.drive) = checks::drive_number(value)?;
            }
            (JointEntry::Home, _) => return Err("expected a number".into()),
            (JointEntry::Drive(_) | JointEntry::Number(_), _) => {
                return Err("expected a number, or none".into());
            }
            (JointEntry::Limits, _) => return Err("expected limits LOWEST:HIGHEST, or none".into()),
        }
    }
    Ok(())
}

/// The problem of a joint whose limits exclude its value at home.
fn excludes_home(coordinate: &JointCoordinate, units: FileUnits) -> Option<String> {
    let [low, high] = coordinate.limits?;
    let show = |value| units.show(value, coordinate.quantity);
    (!(low..=high).contains(&coordinate.home)).then(|| {
        format!(
            "the limits of {} exclude home: it is {} there, expected it between {} and {}",
            coordinate.name,
            show(coordinate.home),
            show(low),
            show(high)
        )
    })
}

#[cfg(all(test, feature = "files"))]
mod tests {
    use super::*;
    use crate::mechanism::examples::find;
    use crate::mechanism::file::read;

    fn example(name: &str) -> MechanismFile {
        read(find(name).unwrap().text).unwrap()
    }

    #[test]
    fn a_written_file_is_read_as_the_same() {
        for name in ["plano-spherical-5dof", "planar-3rrr", "plano-spherical-5dof-joints"] {
            let file = example(name);
            let again = read(&file.text()).unwrap();
            assert_eq!(again.units, file.units);
            let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
            for (one, other) in file.mechanism.joints().zip(again.mechanism.joints()) {
                assert!((one.point - other.point).norm() < 1e-12, "{name}");
                let pairs = one.coordinates.iter().zip(&other.coordinates);
                for (one, other) in pairs {
                    assert!(near(one.home, other.home), "{name}");
                }
            }
        }
    }

    #[test]
    fn limits_and_homes_of_joints_are_changed_by_name() {
        let file = example("plano-spherical-5dof-joints");
        let limits = ParameterValue::Pair([-0.5, 0.5]);
        let changed = file.with([("S1.limits", limits)]).unwrap();
        let of = |file: &MechanismFile, name: &str| {
            file.mechanism.coordinates().find(|c| c.name == name).unwrap().clone()
        };
        assert_eq!(of(&changed, "S1").limits, Some([-0.5, 0.5]));
        assert_eq!(of(&changed, "S2"), of(&file, "S2"));
        let problem = |name: &str, value| file.with([(name, value)]).unwrap_err().to_string();
        assert!(problem("S7.limits", limits).contains("did you mean `S"));
        assert!(problem("S1.limit", limits).contains("did you mean `S1.limits`"));
        assert!(problem("S1.limits", ParameterValue::Pair([5.0, 6.0])).contains("exclude home"));
        assert!(problem("S1.home", limits).contains("expected a number"));
        let reversed = ParameterValue::Pair([0.5, 0.25]);
        let expected =
            "`S1.limits` are reversed: 500 mm is above 250 mm, expected [lowest, highest]";
        assert_eq!(problem("S1.limits", reversed), expected);
        let of_family = example("plano-spherical-5dof").with([("limits.S", reversed)]).unwrap_err();
        assert!(of_family.to_string().contains("500 mm is above 250 mm"), "{of_family}");
    }

    #[test]
    fn parameters_of_a_family_keep_the_coordinates() {
        use crate::mechanism::OrientationCoordinates::TiltTorsion;
        let mut file = example("plano-spherical-5dof");
        file.mechanism.task.coordinates = Some(TiltTorsion);
        let changed = file.with([("leg1.h", ParameterValue::Number(0.13))]).unwrap();
        assert_eq!(changed.mechanism.task.coordinates, Some(TiltTorsion));
        let again = read(&changed.text()).unwrap();
        assert_eq!(again.mechanism.task.coordinates, Some(TiltTorsion));
        assert_eq!(again.family, changed.family);
        let error = file.with([("leg1.hh", ParameterValue::Number(0.13))]).unwrap_err();
        assert!(error.to_string().contains("did you mean `leg1.h`"), "{error}");
        assert_eq!(file.quantity_of("leg1.h"), Some(Quantity::Length));
        assert_eq!(file.quantity_of("limits.S"), Some(Quantity::Length));
        assert_eq!(file.quantity_of("leg1.q"), None);
    }
}
