//! `opm analyze`: efforts, payload and transmission at a pose.

pub mod load;
mod poses;
mod report;

use crate::args::{AnalyzeArgs, Output};
use crate::failure::Failure;
use crate::load as mechanisms;
use crate::pose::Number;
use crate::unitless;
use load::LinkStiffness;
use opm_analysis::{Balance, Compliant, Load, NoTransmission, Springs, Statics, Transmissions};
use opm_core::manipulator::{Manipulator, Solution};
use opm_study::characteristic_length;
use report::{Elastic, Report};

pub fn run(args: &AnalyzeArgs, output: &Output) -> Result<(), Failure> {
    let loaded = mechanisms::open(&args.mechanism, output)?;
    let manipulator = loaded.compile()?;
    let mode = mechanisms::mode(&manipulator, &args.mode)?;
    let length = args.length.map(Number::characteristic_length).transpose()?;
    let length = characteristic_length(length, &manipulator)?;
    let load = args.wrench.map(|given| Load { wrench: given.0, at: args.at.0, axes: args.frame });
    let mut analyser = Analyser::new(&manipulator, length, load);
    if let Some(input) = &args.poses {
        return poses::run(args, input, output, &loaded, (&mut analyser, mode));
    }
    unitless::note_pose(output, "--pose", &args.pose, &loaded, &manipulator);
    let (pose, checks) = args.pose.resolve_with_checks(&manipulator)?;
    let mut at = manipulator.solution();
    let found = manipulator.inverse(&pose, mode, &mut at);
    let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
    let mut springs = None;
    if let Some(LinkStiffness([translation, rotation])) = args.link_stiffness {
        let actuators = load::actuators(args.joint_stiffness.as_ref(), &manipulator)
            .map_err(|error| Failure::flag("--joint-stiffness", error))?;
        let given = Springs { actuators, translation, rotation };
        let compliant = Compliant::new(&manipulator, given);
        springs = Some(compliant.map_err(|error| Failure::flag("--link-stiffness", error))?);
    }
    let mut elastic = None;
    if reached {
        checks.verify(&manipulator, &at, loaded.file.units)?;
        analyser.update(&at)?;
        elastic = springs.as_mut().map(|compliant| {
            let stiffness = compliant.stiffness(&at)?;
            let reactions = analyser.wrench(&at).map(|w| compliant.reactions(&stiffness, &w));
            Some(Elastic { stiffness, reactions: reactions.flatten() })
        });
    }
    let units = loaded.file.units;
    let report =
        Report { analyser: &analyser, at: &at, pose: &pose, mode, reached, elastic, units };
    output.print(&report.json(), report.text())
}

/// What is computed at a pose.
pub struct Analyser<'a> {
    manipulator: &'a Manipulator,
    load: Option<Load>,
    statics: Statics<'a>,
    transmissions: Result<Transmissions<'a>, NoTransmission>,
}

impl<'a> Analyser<'a> {
    fn new(manipulator: &'a Manipulator, length: f64, load: Option<Load>) -> Self {
        let transmissions = Transmissions::new(manipulator);
        Self { manipulator, load, statics: Statics::new(manipulator, length), transmissions }
    }

    /// Takes a solution that is in reach.
    fn update(&mut self, at: &Solution) -> Result<(), Failure> {
        self.statics.update(at).map_err(|error| Failure::flag("--pose", error))?;
        if let Ok(transmissions) = &mut self.transmissions {
            transmissions.update(at);
        }
        Ok(())
    }

    /// The wrench at the reference point of the platform, in base directions.
    fn wrench(&self, at: &Solution) -> Option<opm_analysis::Wrench> {
        let platform = self.manipulator.platform_at(&at.displacement(self.manipulator));
        Some(self.load?.on(&platform))
    }
}

/// The word for a balance.
fn word(balance: Balance) -> &'static str {
    match balance {
        Balance::Balanced => "balanced",
        Balance::Driven => "driven",
        Balance::Singular => "singular",
    }
}
