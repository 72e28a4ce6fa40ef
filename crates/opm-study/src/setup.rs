//! What the poses of a request are judged by: load, gravity, springs, characteristic length.

use crate::error::RequestError;
use crate::request::characteristic_length;
use opm_analysis::{Gravity, Load, LoadAxes, LoadPoint, Setup, Springs, Wrench};
use opm_core::manipulator::Manipulator;
use opm_core::nalgebra::Vector3;
use opm_core::skeleton::Density;

/// A setup as it is requested, before it is known for which mechanism.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetupOptions {
    /// Characteristic length, metres; by default the spread of the joint axes.
    pub length: Option<f64>,
    /// What acts on the platform.
    pub load: Option<Load>,
    /// What makes links and platform heavy.
    pub gravity: Option<Gravity>,
    /// How much links and actuators give way.
    pub springs: Option<SpringOptions>,
}

/// How much a mechanism gives way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpringOptions {
    /// The stiffness of each link against translations, N/m, and against rotations, N m/rad.
    pub links: [f64; 2],
    /// The stiffness of actuated joints by their names, N/m and N m/rad; others are rigid.
    pub actuators: Vec<(String, f64)>,
}

impl SetupOptions {
    /// The setup for a manipulator.
    ///
    /// # Errors
    /// The length is out of range, or the springs do not suit the manipulator.
    pub fn check(&self, manipulator: &Manipulator) -> Result<Setup, RequestError> {
        let length = characteristic_length(self.length, manipulator)?;
        let springs = self.springs.as_ref().map(|SpringOptions { links, actuators }| {
            Springs::new(manipulator, *links, actuators).map_err(RequestError::Springs)
        });
        let (load, gravity, springs) = (self.load, self.gravity, springs.transpose()?);
        Ok(Setup { length, load, gravity, springs })
    }
}

/// Numbers with all digits, with commas between them.
fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let values: Vec<f64> = text.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
    values.try_into().ok()
}

/// A setup as words: names of options and their values, as recordings store them and the command line takes them. The
/// characteristic length is not among them.
pub fn fields(setup: &Setup, manipulator: &Manipulator) -> Vec<(&'static str, String)> {
    let mut fields = Vec::new();
    if let Some(Load { wrench, at, axes }) = setup.load {
        fields.push(("wrench", list(&wrench.components())));
        fields.push((
            "at",
            match at {
                LoadPoint::Platform => "platform".to_owned(),
                LoadPoint::Base => "base".to_owned(),
                LoadPoint::From(arm) => list(arm.as_slice()),
            },
        ));
        fields.push(("frame", axes.name().to_owned()));
    }
    if let Some(Gravity { acceleration, density }) = setup.gravity {
        fields.push(("gravity", list(acceleration.as_slice())));
        fields.extend(density.given().map(|density| ("density", density.to_string())));
    }
    if let Some(Springs { actuators, translation, rotation }) = &setup.springs {
        fields.push(("link_stiffness", list(&[*translation, *rotation])));
        let each = Springs::names(manipulator).into_iter().zip(actuators);
        let given = each.filter(|(_, stiffness)| stiffness.is_finite());
        let given: Vec<String> = given.map(|(name, k)| format!("{name}={k}")).collect();
        if !given.is_empty() {
            fields.push(("joint_stiffness", given.join(",")));
        }
    }
    fields
}

/// The setup of which these are the [`fields`], with a characteristic length; `None` if they are not those of one.
pub fn of_fields<'a>(field: impl Fn(&str) -> Option<&'a str>, length: f64) -> Option<SetupOptions> {
    let mut options = SetupOptions { length: Some(length), ..SetupOptions::default() };
    if let Some(wrench) = field("wrench") {
        let at = match field("at")? {
            "platform" => LoadPoint::Platform,
            "base" => LoadPoint::Base,
            arm => LoadPoint::From(Vector3::from(numbers(arm)?)),
        };
        let wrench = Wrench::from_components(numbers(wrench)?);
        options.load = Some(Load { wrench, at, axes: LoadAxes::from_name(field("frame")?)? });
    }
    if let Some(gravity) = field("gravity") {
        let acceleration = Vector3::from(numbers(gravity)?);
        let density = field("density").map(str::parse).transpose().ok()?;
        let density = Density::new(density).ok()?;
        options.gravity = Some(Gravity { acceleration, density });
    }
    if let Some(links) = field("link_stiffness") {
        let each = field("joint_stiffness").into_iter().flat_map(|text| text.split(','));
        let actuators = each.map(|text| {
            let (name, stiffness) = text.rsplit_once('=')?;
            Some((name.to_owned(), stiffness.parse().ok()?))
        });
        let actuators = actuators.collect::<Option<_>>()?;
        options.springs = Some(SpringOptions { links: numbers(links)?, actuators });
    }
    Some(options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setup_is_read_back_from_its_fields() {
        let manipulator = crate::example();
        let wrench = Wrench::from_components([1.0, -2.5, 0.1 + 0.2, 0.0, 1e-7, 3.0]);
        let arm = Vector3::new(0.1, 0.0, -1.0 / 3.0);
        for (at, density) in [
            (LoadPoint::Platform, None),
            (LoadPoint::Base, None),
            (LoadPoint::From(arm), Some(7e3)),
        ] {
            let load = Load { wrench, at, axes: LoadAxes::Platform };
            let density = Density::new(density).unwrap();
            let options = SetupOptions {
                length: Some(0.3),
                load: Some(load),
                gravity: Some(Gravity { acceleration: Vector3::new(0.0, 0.0, -9.81), density }),
                springs: Some(SpringOptions {
                    links: [1e7, 1e4],
                    actuators: vec![("S2".to_owned(), 1e6)],
                }),
            };
            let setup = options.check(&manipulator).unwrap();
            let fields = fields(&setup, &manipulator);
            let field = |name: &str| {
                fields.iter().find(|(known, _)| *known == name).map(|(_, value)| &**value)
            };
            assert_eq!(of_fields(field, 0.3), Some(options));
        }
    }
}
