//! What poses are judged by, as Python gives it: load, gravity, springs.

use crate::arguments;
use crate::error::wrong;
use crate::given::Columns;
use nalgebra::Vector3;
use opm_analysis::{Gravity, Load, LoadAxes, LoadPoint, Wrench};
use opm_study::{SetupOptions, SpringOptions};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// The components of a wrench.
pub const WRENCH: [&str; 6] = ["FX", "FY", "FZ", "MX", "MY", "MZ"];

/// The arguments of a setup, as they are given.
pub struct Given<'a, 'py> {
    pub wrench: Option<&'a Bound<'py, PyAny>>,
    pub at: Option<&'a Bound<'py, PyAny>>,
    pub frame: &'a str,
    pub gravity: Option<&'a Bound<'py, PyAny>>,
    pub density: Option<f64>,
    pub link_stiffness: Option<[f64; 2]>,
    pub joint_stiffness: Option<BTreeMap<String, f64>>,
    pub length: Option<f64>,
}

impl Given<'_, '_> {
    /// The setup that is asked for, with a wrench of six numbers.
    pub fn options(self) -> PyResult<SetupOptions> {
        let wrench = self.wrench.map(|given| six(given)).transpose()?;
        if wrench.is_none() && (self.at.is_some() || self.frame != "base") {
            return Err(wrong("at and frame need wrench"));
        }
        self.options_with(wrench)
    }

    /// The same, with a wrench that was read already.
    pub fn options_with(self, wrench: Option<Wrench>) -> PyResult<SetupOptions> {
        let Self { frame, density, link_stiffness, joint_stiffness, length, .. } = self;
        let Some(axes) = LoadAxes::from_name(frame) else {
            return Err(wrong(format!("frame is {frame:?}, expected \"base\" or \"platform\"")));
        };
        let at = self.at.map(load_point).transpose()?.unwrap_or_default();
        let load = wrench.map(|wrench| Load { wrench, at, axes });
        let acceleration = self.gravity.map(|given| vector(given, "gravity")).transpose()?;
        if density.is_some() && acceleration.is_none() {
            return Err(wrong("density needs gravity"));
        }
        let density = arguments::density(density)?;
        let gravity = acceleration.map(|acceleration| Gravity { acceleration, density });
        if joint_stiffness.is_some() && link_stiffness.is_none() {
            return Err(wrong("joint_stiffness needs link_stiffness"));
        }
        let actuators = joint_stiffness.unwrap_or_default().into_iter().collect();
        let springs = link_stiffness.map(|links| SpringOptions { links, actuators });
        Ok(SetupOptions { length, load, gravity, springs })
    }
}

/// Gravity and the density of bodies, where every body has a mass.
pub fn gravity(given: Option<&Bound<'_, PyAny>>, density: Option<f64>) -> PyResult<Gravity> {
    let standard = Gravity::default();
    let acceleration = given.map(|given| vector(given, "gravity")).transpose()?;
    let density = arguments::density(density)?;
    Ok(Gravity { acceleration: acceleration.unwrap_or(standard.acceleration), density })
}

/// A wrench of six finite numbers.
fn six(given: &Bound<'_, PyAny>) -> PyResult<Wrench> {
    let row = arguments::row(given, "wrench", Columns::all(&WRENCH))?;
    match row.iter().find(|value| !value.is_finite()) {
        Some(odd) => Err(wrong(format!("{odd} is among wrench, expected finite numbers"))),
        None => Ok(Wrench::from_components(std::array::from_fn(|i| row[i]))),
    }
}

/// Three finite numbers.
fn vector(given: &Bound<'_, PyAny>, name: &str) -> PyResult<Vector3<f64>> {
    let row = arguments::row(given, name, Columns::all(&["x", "y", "z"]))?;
    match row.iter().find(|value| !value.is_finite()) {
        Some(odd) => Err(wrong(format!("{odd} is among {name}, expected finite numbers"))),
        None => Ok(Vector3::from_fn(|i, _| row[i])),
    }
}

/// Where a force acts, as Python gives it.
fn load_point(given: &Bound<'_, PyAny>) -> PyResult<LoadPoint> {
    if let Ok(name) = given.extract::<String>() {
        match &*name {
            "platform" => return Ok(LoadPoint::Platform),
            "base" => return Ok(LoadPoint::Base),
            _ => {}
        }
    } else {
        return vector(given, "at").map(LoadPoint::From);
    }
    let found = given.repr()?;
    Err(wrong(format!("at is {found}, expected \"platform\", \"base\" or a point (x, y, z)")))
}
