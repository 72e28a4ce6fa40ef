//! The arguments that say which errors there are, and how large.

use crate::arguments;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::velocity::characteristic_length;
use opm_accuracy::{Both, ErrorModel, Model, Source, Tolerances};
use opm_core::Quantity;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_mcap::input::Expected;
use pyo3::prelude::*;
use pyo3::types::PyMapping;

/// Which errors there are, as arguments.
pub struct ErrorArguments<'a, 'py> {
    pub actuators: Option<&'a Bound<'py, PyAny>>,
    pub tolerances: Option<&'a Bound<'py, PyAny>>,
    pub errors: &'a str,
    pub length: Option<f64>,
}

impl ErrorArguments<'_, '_> {
    /// The errors of a manipulator, and the size of each, metres and radians.
    pub fn read<'m>(&self, manipulator: &'m Manipulator) -> PyResult<(Model<'m>, Vec<f64>)> {
        let inner = &*manipulator.inner;
        let length = characteristic_length(inner, self.length)?;
        let Some(errors) = ErrorModel::from_name(self.errors) else {
            let given = self.errors;
            return Err(wrong(format!("errors is {given:?}, expected \"axes\" or \"links\"")));
        };
        let model = Model::new(inner, Some(&manipulator.file()), errors).with_length(length);
        let sources = model.sources();
        let mut sizes = match self.tolerances {
            Some(given) => tolerances(given, sources)?,
            None => Tolerances::default(),
        };
        if let Some(given) = self.actuators {
            sizes.actuators = pair(given, "actuators")?;
            let lacks = |s: &&Source| s.is_actuator() && sizes.actuators.of(s.quantity).is_none();
            if let Some(source) = sources.iter().find(lacks) {
                let what = match source.quantity {
                    Quantity::Length => "a length",
                    Quantity::Angle => "an angle",
                };
                let name = &source.name;
                return Err(wrong(format!(
                    "actuators: {name} is {what}, and no size is given for it"
                )));
            }
        }
        let sizes = sizes.of(sources);
        Ok((model, sizes))
    }
}

/// A size that is not negative.
fn size(given: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    let number = given.extract().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| {
        let shown = arguments::shown(given);
        wrong(format!("{what} is {shown}, expected a number of at least 0"))
    })
}

/// A pair of sizes, a length and an angle. Either may be None.
pub fn pair(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Both> {
    let Ok([length, angle]) = given.extract::<[Bound<'_, PyAny>; 2]>() else {
        let shown = arguments::shown(given);
        return Err(wrong(format!("{what} is {shown}, expected two numbers: (metres, radians)")));
    };
    let of = |part: &Bound<'_, PyAny>| match part.is_none() {
        true => Ok(None),
        false => size(part, what).map(Some),
    };
    Ok(Both { length: of(&length)?, angle: of(&angle)? })
}

/// The entries of a mapping, by name.
fn entries<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let unsuitable = || {
        let shown = arguments::shown(given);
        wrong(format!("{what} is {shown}, expected a dict"))
    };
    let mapping = given.cast::<PyMapping>().map_err(|_| unsuitable())?;
    mapping.items()?.iter().map(|item| item.extract().map_err(|_| unsuitable())).collect()
}

/// The name, if it is among those that are known.
fn known(name: &str, what: &str, names: &[&str]) -> PyResult<()> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(wrong(format!("tolerances: {name:?} is not {what}; {}", expected_one_of(name, names))))
}

/// The argument `tolerances`: a file, or a dict with the same keys in metres and radians.
fn tolerances(given: &Bound<'_, PyAny>, sources: &[Source]) -> PyResult<Tolerances> {
    let py = given.py();
    let mut found = Tolerances::default();
    if given.cast::<PyMapping>().is_err() {
        let path = arguments::path(given).map_err(|_| {
            let expected = "a path, or a mapping";
            wrong(format!("tolerances is {}, expected {expected}", arguments::shown(given)))
        })?;
        let text = arguments::text(py, &path, Expected::TOLERANCES, "")?;
        let read = Tolerances::read(&text, sources);
        return read.map_err(|errors| wrong(errors.in_file(path.display())));
    }
    let both = |given: &Bound<'_, PyAny>, what: &str| -> PyResult<Both> {
        let mut both = Both::default();
        for (name, value) in entries(given, what)? {
            known(&name, "a tolerance", &["length", "angle"])?;
            let place = if name == "length" { &mut both.length } else { &mut both.angle };
            *place = Some(size(&value, &format!("{what}[{name:?}]"))?);
        }
        Ok(both)
    };
    for (name, value) in entries(given, "tolerances")? {
        known(&name, "a key", &["length", "angle", "actuators", "joint", "parameter"])?;
        let what = format!("tolerances[{name:?}]");
        match &*name {
            "length" => found.axes.length = Some(size(&value, &what)?),
            "angle" => found.axes.angle = Some(size(&value, &what)?),
            "actuators" => found.actuators = both(&value, &what)?,
            "joint" => {
                for (joint, value) in entries(&value, &what)? {
                    known(&joint, "a joint", &Tolerances::joint_names(sources))?;
                    let sizes = both(&value, &format!("{what}[{joint:?}]"))?;
                    found.joints.insert(joint, sizes);
                }
            }
            _ => {
                for (single, value) in entries(&value, &what)? {
                    known(&single, "an error", &Tolerances::single_names(sources))?;
                    let size = size(&value, &format!("{what}[{single:?}]"))?;
                    found.single.insert(single, size);
                }
            }
        }
    }
    Ok(found)
}
