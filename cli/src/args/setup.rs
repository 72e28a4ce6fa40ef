//! What poses are judged by: the load, gravity, springs.

use super::heading;
use crate::analyze::load::{At, GravityVector, LinkStiffness, WrenchComponents};
use crate::failure::Failure;
use crate::pose::{Number, Pose};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use opm_analysis::{Gravity, Load, LoadAxes};
use opm_core::skeleton::Density;
use opm_study::{SetupOptions, SpringOptions};

/// What acts on the mechanism, and how much it gives way.
#[derive(Debug, clap::Args)]
pub struct SetupArgs {
    /// Force and moment on the platform, N and N m
    #[arg(help_heading = heading::LOAD, long, value_name = "FX,FY,FZ,MX,MY,MZ", allow_hyphen_values = true)]
    pub wrench: Option<WrenchComponents>,
    /// Where the force acts: `platform`, its reference point; `base`, the base's origin; or a point of the platform, from
    /// the reference point along the axes of --frame
    #[arg(
        help_heading = heading::LOAD,
        long,
        value_name = "POINT",
        default_value = "platform",
        requires = "wrench",
        allow_hyphen_values = true
    )]
    pub at: At,
    /// The axes of --wrench and --at: those of the base, or those that the platform carries
    #[arg(
        help_heading = heading::LOAD,
        long,
        value_name = "base|platform",
        value_parser = axes(),
        default_value = "base",
        requires = "wrench"
    )]
    pub frame: LoadAxes,
    /// The weight of links and platform, whose masses are those of `opm export mjcf`: how a body falls, m/s², for
    /// example 0,0,-9.81
    #[arg(help_heading = heading::LOAD, long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub gravity: Option<GravityVector>,
    /// Density of bodies whose masses the file does not give, kg/m³, instead of that of the file (aluminium, 2700)
    #[arg(help_heading = heading::LOAD, long, value_name = "KG/M3", requires = "gravity", allow_hyphen_values = true)]
    pub density: Option<Number>,
    /// Stiffness of each link against translations of its end, N/m, and against rotations, N m/rad: gives the platform's
    /// stiffness
    #[arg(help_heading = heading::LOAD, long, value_name = "KT,KR", allow_hyphen_values = true)]
    pub link_stiffness: Option<LinkStiffness>,
    /// Stiffness of actuators, N/m or N m/rad; one that is not given is rigid
    #[arg(help_heading = heading::LOAD, long, value_name = "NAME=K,...", requires = "link_stiffness")]
    pub joint_stiffness: Option<Pose>,
}

impl SetupArgs {
    /// What the flags ask for, with a characteristic length.
    pub fn options(&self, length: Option<Number>) -> Result<SetupOptions, Failure> {
        let length = length.map(Number::characteristic_length).transpose()?;
        let load =
            self.wrench.map(|given| Load { wrench: given.0, at: self.at.0, axes: self.frame });
        let density = self.density.map(|given| given.bare("the density")).transpose();
        let density = density.map_err(|error| Failure::flag("--density", error))?;
        let density = Density::new(density).map_err(|error| Failure::flag("--density", error))?;
        let gravity = self.gravity.map(|given| Gravity { acceleration: given.0, density });
        let stiffness = |given: &Pose| {
            let each = given.assignments().map(|(name, number)| {
                let stiffness =
                    number.bare(name).map_err(|e| Failure::flag("--joint-stiffness", e))?;
                Ok((name.to_owned(), stiffness))
            });
            each.collect::<Result<Vec<_>, Failure>>()
        };
        let actuators = self.joint_stiffness.as_ref().map(stiffness).transpose()?;
        let springs = self.link_stiffness.map(|LinkStiffness(links)| SpringOptions {
            links,
            actuators: actuators.unwrap_or_default(),
        });
        Ok(SetupOptions { length, load, gravity, springs })
    }
}

/// Parses which axes a load is along.
fn axes() -> impl TypedValueParser<Value = LoadAxes> {
    let names = PossibleValuesParser::new(LoadAxes::ALL.map(LoadAxes::name));
    names.map(|name| LoadAxes::from_name(&name).unwrap_or_default())
}
