//! Assemblies are written, and accepted where all legs close.

use super::held::Held;
use super::search::{Memory, Search};
use super::{Assemblies, Assembly, Unmet};
use crate::manipulator::{ClosureBuffer, Manipulator, Mode, Section, Solution, Unreachable};
use crate::numeric::Quantity;
use nalgebra::Isometry3;
use std::f64::consts::{PI, TAU};

/// The solution at an assembled pose has the values of the actuated joints to within this, in radians or shares of the
/// size. Near a serial singularity, inverse kinematics are only accurate to about the square root of rounding.
pub(super) const MATCH: f64 = 1e-6;

/// Two solutions at one pose that both match are distinct if a joint differs by more than this, in radians or shares of the
/// size. Otherwise they are one solution near a singularity.
pub(super) const APART: f64 = 1e-4;

/// Below this residual, the passive joints that inverse kinematics give are not improved any further.
pub(super) const SETTLED: f64 = 1e-13;

/// Two assemblies in one mode are the same if no joint differs by more than this, in radians or metres.
const SAME: f64 = 1e-9;

/// Where an assembly is looked for.
#[derive(Clone, Copy)]
pub(super) struct AssemblyPlace<'a> {
    /// The independent task coordinates, metres and radians.
    pub pose: &'a [f64],
    /// All task coordinates, dependent ones too.
    pub all: &'a [f64],
    /// The platform's displacement from home at this pose, which the legs have to reach.
    pub target: &'a Isometry3<f64>,
    pub mode: Mode,
}

/// A solution of inverse kinematics at the place.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    /// The values of all joint coordinates, radians and metres.
    pub joints: &'a [f64],
    /// The values of all imaginary joints, radians and metres.
    pub imaginary: &'a [f64],
    pub within_limits: bool,
}

impl Assembly {
    /// A buffer for the assemblies of a manipulator.
    pub(super) fn buffer(manipulator: &Manipulator) -> Self {
        Self {
            pose: Vec::with_capacity(manipulator.task_coordinates().len()),
            dependent: Vec::with_capacity(manipulator.dependent_coordinates().len()),
            mode: Mode::default(),
            joints: Vec::with_capacity(manipulator.coordinates().len()),
            imaginary: Vec::with_capacity(manipulator.imaginary().len()),
            within_limits: false,
            residual: f64::NAN,
        }
    }
}

impl Manipulator {
    /// Gives the actuated joints of a solution these displacements from home, with the full revolutions that inverse
    /// kinematics give.
    pub(super) fn set_actuated(&self, displacements: &[f64], joints: &mut [f64]) {
        for (&displacement, &coordinate) in displacements.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            let given = c.home + displacement;
            let joint = &mut joints[coordinate];
            let revolutions = match c.quantity {
                Quantity::Angle => ((*joint - given) / TAU).round(),
                Quantity::Length => 0.0,
            };
            *joint = given + TAU * revolutions;
        }
    }

    /// The error of an actuated joint that has this value and should be displaced from home by `wanted`, in radians or shares of
    /// the size. Full revolutions do not count where it is `modulo` these: see [`Manipulator::modulo_revolutions`].
    #[inline]
    pub(super) fn actuated_error(
        &self,
        coordinate: usize,
        value: f64,
        wanted: f64,
        modulo: bool,
    ) -> f64 {
        let mut off = (value - self.coordinates()[coordinate].home - wanted).abs();
        if modulo && off > PI {
            off = (off - TAU * (off / TAU).round()).abs();
        }
        off * self.weight(coordinate)
    }

    /// The assembly in a mode with these displacements of the actuated joints, from a solution at its pose.
    pub(super) fn assembly_of(
        &self,
        (pose, mode): (&[f64], Mode),
        solution: &Solution,
        wanted: &[f64],
        buffer: &mut ClosureBuffer,
    ) -> Option<Assembly> {
        let (all, target) = (self.completed(pose, mode).ok()?, solution.displacement(self));
        let (mut joints, mut residuals) = (solution.joints().to_vec(), Vec::new());
        self.set_actuated(wanted, &mut joints);
        self.closure.write_residuals(&joints, &[target], &mut residuals);
        let place = AssemblyPlace { pose, all: &all, target: &target, mode };
        let solved = Solved {
            joints: &joints,
            imaginary: solution.imaginary(),
            within_limits: solution.within_limits(),
        };
        let mut assembly = Assembly::buffer(self);
        self.write_assembly(place, solved, residuals[0], buffer, &mut assembly);
        Some(assembly)
    }

    /// Writes the assembly at a pose from a solution there, with its residual. The passive joints are improved where it
    /// does not close to rounding.
    pub(super) fn write_assembly(
        &self,
        AssemblyPlace { pose, all, target, mode }: AssemblyPlace<'_>,
        solved: Solved<'_>,
        residual: f64,
        buffer: &mut ClosureBuffer,
        out: &mut Assembly,
    ) {
        let write = |to: &mut Vec<f64>, from: &[f64]| {
            to.clear();
            to.extend_from_slice(from);
        };
        write(&mut out.pose, pose);
        out.dependent.clear();
        out.dependent.extend(self.dependent.iter().flat_map(|dependent| dependent.values(all)));
        write(&mut out.joints, solved.joints);
        write(&mut out.imaginary, solved.imaginary);
        (out.mode, out.within_limits) = (mode, solved.within_limits);
        out.residual = residual;
        if out.residual > SETTLED {
            out.residual = self.closure.settle(&mut out.joints, target, out.residual, buffer);
        }
    }
}

/// The assemblies that were accepted so far, and what is known of the others.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub assemblies: Assemblies,
    /// Former assemblies, whose memory is used again.
    spare: Vec<Assembly>,
    /// Whether a candidate was rejected.
    rejected: bool,
    /// A buffer for closure errors.
    closure: ClosureBuffer,
}

impl Outcome {
    /// No assemblies so far.
    pub fn new(manipulator: &Manipulator) -> Self {
        let closure = manipulator.closure.buffer();
        Self { assemblies: Assemblies::default(), spare: Vec::new(), rejected: false, closure }
    }

    /// Forgets what is known.
    pub fn clear(&mut self) {
        let Assemblies { list, unmet, loose, .. } = &mut self.assemblies;
        self.spare.append(list);
        unmet.clear();
        loose.clear();
        self.rejected = false;
    }

    /// Notes that a candidate does not close.
    pub fn reject(&mut self) {
        self.rejected = true;
    }

    /// Adds an assembly to the list, unless it does not close or is listed already.
    pub fn accept(
        &mut self,
        held: &Held<'_>,
        place: AssemblyPlace<'_>,
        solved: Solved<'_>,
        residual: f64,
    ) {
        let Held { manipulator: m, displacements, .. } = *held;
        let AssemblyPlace { pose, mode, .. } = place;
        let mut assembly = self.spare.pop().unwrap_or_else(|| Assembly::buffer(m));
        m.write_assembly(place, solved, residual, &mut self.closure, &mut assembly);
        if assembly.residual > SETTLED && assembly.residual < MATCH {
            // Near a singularity of a section, Newton's method on the whole mechanism restores digits that
            // the sections have lost.
            let actuated = m.actuated().iter().zip(displacements);
            let given: Vec<f64> = actuated.map(|(&c, a)| m.coordinates()[c].home + a).collect();
            if let Ok(better) = m.forward_near(&given, pose, mode) {
                let moved = better.joints.iter().zip(&assembly.joints);
                let near = moved.into_iter().all(|(a, b)| (a - b).abs() < MATCH);
                if near && better.residual < assembly.residual {
                    assembly = better;
                }
            }
        }
        if assembly.residual.is_nan() || assembly.residual > m.largest_residual() {
            self.reject();
            self.spare.push(assembly);
            return;
        }
        let known = |other: &Assembly| {
            let joints = other.joints.iter().zip(&assembly.joints);
            other.mode == mode && joints.into_iter().all(|(a, b)| (a - b).abs() < SAME)
        };
        let to = match self.assemblies.list.iter().any(known) {
            true => &mut self.spare,
            false => &mut self.assemblies.list,
        };
        to.push(assembly);
    }
}

impl Search<'_> {
    /// Gives the reasons if there are no assemblies.
    pub(super) fn give_reasons(&mut self) {
        let Memory { outcome, deficits, .. } = &mut *self.memory;
        let Outcome { assemblies: Assemblies { list, unmet, loose, .. }, rejected, .. } = outcome;
        if !list.is_empty() {
            unmet.clear();
            return;
        }
        for (leg, deficit) in deficits.iter().enumerate() {
            if let Some(deficit) = *deficit {
                unmet.push(Unmet::Leg(Unreachable { leg, section: Some(Section::Lower), deficit }));
            }
        }
        if self.upper_failed {
            unmet.push(Unmet::Section(Section::Upper));
        }
        if *rejected {
            unmet.push(match self.manipulator.is_redundant() {
                true => Unmet::Contradiction,
                false => Unmet::Together,
            });
        }
        // A section that can move closes at some poses, which are not listed.
        unmet.retain(|unmet| !matches!(unmet, Unmet::Section(section) if loose.contains(section)));
    }
}
