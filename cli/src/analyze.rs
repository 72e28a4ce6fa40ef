//! `opm analyze`: efforts, payload and transmission at a pose.

pub mod load;
mod poses;
mod report;
mod table;

use crate::args::{AnalyzeArgs, Output};
use crate::failure::Failure;
use crate::load as mechanisms;
use crate::pose::Checks;
use crate::unitless;
use nalgebra::Vector3;
use opm_analysis::{
    Balance, Compliant, Dynamics, Efforts, Gravity, Index, Indices, Loads, NoTransmission, Setup,
    Statics, Transmissions, Velocity,
};
use opm_core::manipulator::{Manipulator, Solution};
use report::{Elastic, Report};

pub fn run(args: &AnalyzeArgs, output: &Output) -> Result<(), Failure> {
    let loaded = mechanisms::open(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return table::run(args, &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let mode = mechanisms::mode(&manipulator, &args.mode)?;
    let setup = args.setup.options(args.length)?.check(&manipulator)?;
    let mut analyser = Analyser::new(&manipulator, &setup)?;
    if let Some(input) = &args.poses {
        return poses::run(args, input, output, &loaded, (&mut analyser, mode));
    }
    unitless::note_pose(output, "--pose", &args.pose, &loaded, &manipulator);
    let (pose, checks) = match &args.transform {
        Some(transform) => (transform.pose(&manipulator, mode)?, Checks::none()),
        None => args.pose.resolve_with_checks(&manipulator)?,
    };
    let mut at = manipulator.solution();
    let found = manipulator.inverse(&pose, mode, &mut at);
    let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
    let springs = setup.springs.clone().map(|springs| Compliant::new(&manipulator, springs));
    let springs = springs.transpose().map_err(|error| Failure::flag("--link-stiffness", error))?;
    // Bodies have masses in any case.
    let weightless = Gravity { acceleration: Vector3::zeros(), ..Gravity::default() };
    let gravity = setup.gravity.unwrap_or(weightless);
    let mut springs = springs.map(|springs| springs.with_gravity(&gravity));
    let (mut elastic, mut moving) = (None, None);
    if reached {
        let verified = checks.verify(&manipulator, at.dependent(), loaded.file.units);
        verified.map_err(|error| Failure::flag("--pose", error))?;
        analyser.update(&at)?;
        moving = setup.gravity.and_then(|_| {
            let mut dynamics = Dynamics::new(&manipulator, &setup);
            let regular = dynamics.update(&at).unwrap_or(false);
            regular.then(|| Some((dynamics.mass_matrix()?, dynamics.gravity()?))).flatten()
        });
        elastic = springs.as_mut().map(|compliant| {
            let stiffness = compliant.stiffness(&at)?;
            let load = setup.has_load().then(|| analyser.wrench(&at).unwrap_or_default());
            let reactions = load.and_then(|load| compliant.reactions(&stiffness, &load));
            let vibrations = compliant.vibrations(&stiffness);
            Some(Elastic { stiffness, reactions, vibrations })
        });
    }
    let units = loaded.file.units;
    let report =
        Report { analyser: &analyser, at: &at, pose: &pose, mode, reached, elastic, moving, units };
    output.print(&report.json(), report.text())
}

/// What is computed at a pose.
pub struct Analyser<'a> {
    manipulator: &'a Manipulator,
    setup: &'a Setup,
    loads: Option<Loads<'a>>,
    statics: Statics<'a>,
    transmissions: Result<Transmissions<'a>, NoTransmission>,
    indices: Indices<'a>,
    /// What acts at the pose, if anything does: its work, and the efforts that balance it.
    acting: Option<(Option<Velocity>, Efforts)>,
}

impl<'a> Analyser<'a> {
    fn new(manipulator: &'a Manipulator, setup: &'a Setup) -> Result<Self, Failure> {
        let known = Index::known(manipulator, setup);
        let indices = Indices::new(manipulator, setup, known);
        Ok(Self {
            manipulator,
            setup,
            loads: Loads::new(manipulator, setup),
            statics: Statics::new(manipulator, setup.length),
            transmissions: Transmissions::new(manipulator),
            indices: indices.map_err(|error| Failure::work(error.to_string()))?,
            acting: None,
        })
    }

    /// Takes a solution that is in reach.
    fn update(&mut self, at: &Solution) -> Result<(), Failure> {
        self.statics.update(at).map_err(|error| Failure::flag("--pose", error))?;
        if let Ok(transmissions) = &mut self.transmissions {
            transmissions.update(at);
        }
        self.indices.evaluate(at);
        let statics = &self.statics;
        self.acting = self.loads.as_mut().map(|loads| {
            let work = statics.is_regular().then(|| loads.work(statics, at)).flatten();
            (work, loads.efforts(statics, at))
        });
        Ok(())
    }

    /// The wrench at the reference point of the platform, in base directions, without the weight of bodies.
    fn wrench(&self, at: &Solution) -> Option<opm_analysis::Wrench> {
        self.setup.load?;
        Some(self.loads.as_ref()?.wrench(at))
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
