//! The assembly near a pose: the sections one after the other, or else the steps of Newton's method; and the buffers of
//! both.

use super::accept::{AssemblyPlace, MATCH, SETTLED, Solved};
use super::held::Held;
use super::near::{NearStop, NotFound};
use super::nearest::{NearestBuffer, distance};
use super::{Assembly, NearError};
use crate::chain::limits::Limits;
use crate::group::{Displacement, JointDisplacement, LocalTwist};
use crate::manipulator::{
    ChainCoordinate, ClosureBuffer, Manipulator, Mode, Section, Solution, SolvedPose,
};
use crate::mechanism::joint::JointKind;
use crate::numeric::Quantity;
use crate::numeric::least_squares::{LeastSquares, MOST};
use crate::velocity::{Jacobians, Rows};
use pulp::{Simd, WithSimd};
use std::f64::consts::{PI, TAU};

/// The largest number of steps. Newton's method takes three from a near start, and about six from a good one.
const STEPS: u32 = 60;

/// The longest step, in radians or shares of the size. The linear terms are not useful further away.
const LONGEST: f64 = 0.5;

/// How often a step is halved that leads out of reach or away from the solution.
const HALVINGS: u32 = 20;

/// The joints have their values to within this, in radians and shares of the size. From there on, steps are
/// taken only as long as they reduce the error, and with the last Jacobian: another one would not be better.
const ARRIVED: f64 = 1e-11;

/// The joints have their values to within this, in radians and shares of the size, which is the rounding of some
/// operations: no step is taken.
const EXACT: f64 = 4e-15;

/// The farthest assembly that the sections are solved for one after the other, in radians and shares of the size. Of
/// those beyond, Newton's method may find another one.
const NEAR: f64 = 0.25;

/// What is left of a column of the Jacobian counts as zero below this share of the longest. Lengths are over the
/// size.
const SINGULAR: f64 = 1e-9;

/// The buffer of [`Manipulator::forward_near_into`], with which nothing is allocated where an assembly is found. It
/// is made by [`Manipulator::near_buffer`].
#[derive(Clone, Debug)]
pub struct NearBuffer {
    /// The displacements of the actuated joints from home, radians and metres.
    pub(super) displacements: Vec<f64>,
    /// The actuated joints of the legs' chains.
    driven: Vec<DrivenJoint>,
    /// The solution at the present pose.
    solution: Solution,
    /// The solution at the pose that a step leads to.
    tried: Solution,
    /// Buffers for the independent coordinates of a pose, and for all of them.
    pose: Vec<f64>,
    all: Vec<f64>,
    /// The actuated joints' wanted values minus their present ones, in radians and shares of the size.
    error: Vec<f64>,
    /// The same after a step.
    error_after: Vec<f64>,
    /// The right side of the linear equations: the error, and zeros for the joints that are locked.
    right: Vec<f64>,
    jacobians: Jacobians,
    /// The unit of each component of a step: the size where it is a length, otherwise one.
    units: [f64; MOST],
    system: LeastSquares,
    nearest: NearestBuffer,
    closure: ClosureBuffer,
    /// The assembly that was found last.
    pub(super) assembly: Assembly,
}

impl NearBuffer {
    /// The assembly that was found last. Before the first one it has no meaning.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }
}

/// An actuated joint of a leg's chain.
#[derive(Clone, Debug)]
struct DrivenJoint {
    leg: usize,
    /// Its section, and its number among the joints of the chain; `None` for what is between the sections.
    place: Option<(Section, usize)>,
    /// Its number among the actuated joints.
    number: usize,
    /// Its value at home, radians or metres.
    home: f64,
    limits: Limits,
    /// Whether it is an angle modulo 2π.
    modulo: bool,
    /// What an error counts as: one over the size for a length, one for an angle.
    weight: f64,
}

impl DrivenJoint {
    /// The wanted value minus that of a solution, in radians or shares of the size.
    #[inline]
    fn error(&self, wanted: &[f64], solution: &Solution) -> f64 {
        let leg = &solution.legs[self.leg];
        let displacement = match self.place {
            Some((section, place)) => &leg.section(section)[place],
            None => &leg.tau,
        };
        let moved = match displacement {
            JointDisplacement::Direction(_) => self.limits.report_angle(displacement.value()),
            JointDisplacement::Value(value) => *value,
        };
        let off = wanted[self.number] - (self.home + moved);
        match self.modulo && off.abs() > PI {
            true => off - TAU * (off / TAU).round(),
            false => off * self.weight,
        }
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::forward_near_into`].
    pub fn near_buffer(&self) -> NearBuffer {
        let jacobians = self.jacobians();
        let (actuated, locked) = (self.actuated().len(), jacobians.locked.nrows());
        let [independent, all] =
            [self.task_coordinates().len(), jacobians.joints.ncols()].map(Vec::with_capacity);
        NearBuffer {
            displacements: Vec::with_capacity(actuated),
            driven: self.driven_joints(),
            solution: self.solution(),
            tried: self.solution(),
            pose: independent,
            all,
            error: vec![0.0; actuated],
            error_after: vec![0.0; actuated],
            right: vec![0.0; actuated + locked],
            units: self.units(&jacobians),
            system: LeastSquares::new(actuated + locked, jacobians.joints.ncols()),
            jacobians,
            nearest: NearestBuffer::new(self.legs()),
            closure: self.closure.buffer(),
            assembly: Assembly::buffer(self),
        }
    }

    /// The unit of each component of the section twist: the size where it is a length, otherwise one.
    fn units(&self, jacobians: &Jacobians) -> [f64; MOST] {
        let (lower, upper) = (self.task().lower.kind, self.task().upper.kind);
        let is_length =
            |[u, l]: [LocalTwist; 2]| upper.is_translation(&u) || lower.is_translation(&l);
        let lengths = jacobians.directions().map(is_length);
        let height = self.task().height.is_some().then_some(true);
        let mut units = [1.0; MOST];
        for (unit, length) in units.iter_mut().zip(lengths.chain(height)) {
            if length {
                *unit = self.closure.size;
            }
        }
        units
    }

    /// The actuated joints of all chains.
    fn driven_joints(&self) -> Vec<DrivenJoint> {
        let modulo = self.modulo_revolutions();
        let mut found = Vec::new();
        for (leg, compiled) in self.legs.iter().enumerate() {
            let mut push = |joint: &ChainCoordinate, place: Option<(Section, usize)>| {
                let ChainCoordinate { home, limits, actuated: Some(number), .. } = *joint else {
                    return;
                };
                let (modulo, weight) = (modulo[number], self.weight(joint.number));
                found.push(DrivenJoint { leg, place, number, home, limits, modulo, weight });
            };
            for section in [Section::Lower, Section::Upper] {
                let joints = compiled.section(section).coordinates.iter().enumerate();
                for (place, joint) in joints {
                    joint.iter().for_each(|joint| push(joint, Some((section, place))));
                }
            }
            let between = compiled.whole.as_ref().and_then(|whole| whole.between);
            between.iter().for_each(|joint| push(joint, None));
        }
        found
    }

    /// What an error of a joint coordinate counts as: one for an angle, one over the size for a length.
    pub(super) fn weight(&self, coordinate: usize) -> f64 {
        match self.coordinates()[coordinate].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => self.closure.size.recip(),
        }
    }

    /// For every actuated coordinate, whether it is an angle modulo 2π.
    pub(super) fn modulo_revolutions(&self) -> Vec<bool> {
        let rotates = |kind: JointKind| match kind {
            JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical => true,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Spherical => false,
        };
        let joints = self.mechanism().joints().filter(|joint| joint.actuated);
        joints
            .flat_map(|joint| {
                let rotates = rotates(joint.kind);
                joint.coordinates.iter().map(move |c| rotates && c.quantity == Quantity::Angle)
            })
            .collect()
    }
}

/// Newton's method for one set of actuated joints.
pub(super) struct Newton<'a> {
    pub manipulator: &'a Manipulator,
    /// The values that the actuated joints should have, radians and metres.
    pub wanted: &'a [f64],
    pub mode: Mode,
}

impl Newton<'_> {
    /// Starts at a pose, goes to where the joints have the wanted values, and writes the assembly to the buffer.
    pub fn run(&self, start: &[f64], at: &mut NearBuffer) -> Result<(), NearError> {
        if !self.manipulator.close(start, self.mode, &mut at.solution)? {
            let why = NearStop::OutOfReach(at.solution.unreachable[0]);
            return Err(NotFound { why, steps: 0, off: f64::INFINITY, pose: start.to_vec() }.into());
        }
        self.write_error(&at.solution, &at.driven, &mut at.error);
        let steps = if self.follow_plan(at) { 0 } else { self.take_steps(at)? };
        self.assemble(at);
        let residual = at.assembly.residual;
        match residual > self.manipulator.largest_residual() {
            true => Err(self.ended(at, NearStop::Stalled, steps, residual)),
            false => Ok(()),
        }
    }

    /// Goes to the assembly nearby that the sections have one after the other, as the mechanism's plan says. Returns
    /// `false` where there is none, and stays where it is. So it does where a step of Newton's method costs no more: near a
    /// singularity that one is more accurate.
    fn follow_plan(&self, at: &mut NearBuffer) -> bool {
        let m = self.manipulator;
        let Ok(plan) = &m.plan else { return false };
        if most(&at.error) <= MATCH || !m.lifts_straight() || m.task().shares_height() {
            return false;
        }
        let held = Held::new(m, plan, &at.displacements);
        let found = held.nearest(&at.solution, &mut at.nearest);
        let rise = held.rise;
        let Some([v, b]) = found else { return false };
        if self.displace([&v, &b], rise, at).is_err() {
            return false;
        }
        self.write_error(&at.tried, &at.driven, &mut at.error_after);
        let (old, new) = (&at.solution.solved, &at.tried.solved);
        let [of_v, of_b] = [(&old.v, &new.v), (&old.b, &new.b)]
            .map(|(old, new)| distance(old, new, m.closure.size));
        let found = most(&at.error_after) <= SETTLED && of_v <= NEAR && of_b <= NEAR;
        if found {
            std::mem::swap(&mut at.solution, &mut at.tried);
        }
        found
    }

    /// Takes steps of Newton's method until the joints have the wanted values, and returns their number.
    fn take_steps(&self, at: &mut NearBuffer) -> Result<u32, NearError> {
        let (mut steps, mut kept) = (0, false);
        while steps < STEPS && most(&at.error) > EXACT {
            let before = most(&at.error);
            let arrived = before <= ARRIVED;
            kept |= arrived && steps > 0;
            let regular = kept || self.linearise(at);
            match if regular { self.step(at) } else { Err(NearStop::Singular) } {
                Ok(()) => steps += 1,
                Err(_) if arrived => break,
                // Another Jacobian may do what the last one does not.
                Err(_) if kept => {}
                Err(why) => return Err(self.ended(at, why, steps, most(&at.error))),
            }
            // Where a step leaves e of an error e₀, the next one with the same Jacobian leaves 2 e²/e₀: F. A. Potra, V. Pták,
            // "Nondiscrete induction and iterative processes" (1984). A new Jacobian pays only where that is too much.
            let after = most(&at.error);
            kept = !kept && 2.0 * after * after <= EXACT * before;
        }
        let off = most(&at.error);
        match off.is_nan() || off > ARRIVED {
            true => Err(self.ended(at, NearStop::Steps, steps, off)),
            false => Ok(steps),
        }
    }

    /// The report of a run without an assembly.
    #[cold]
    fn ended(&self, at: &mut NearBuffer, why: NearStop, steps: u32, off: f64) -> NearError {
        self.write_pose(at);
        NotFound { why, steps, off, pose: at.pose.clone() }.into()
    }

    /// Writes the actuated joints' wanted values minus those of a solution, in radians and shares of the size.
    fn write_error(&self, solution: &Solution, driven: &[DrivenJoint], error: &mut [f64]) {
        let m = self.manipulator;
        for joint in driven {
            error[joint.number] = joint.error(self.wanted, solution);
        }
        for lift in m.lifts() {
            if let ChainCoordinate { number, actuated: Some(actuated), .. } = lift.coordinate {
                let off = self.wanted[actuated] - solution.joints[number];
                error[actuated] = off * m.weight(number);
            }
        }
    }

    /// Decomposes the Jacobian of the actuated joints at the present pose; `false` if it is singular. In rows and
    /// columns, lengths are divided by the size. Locked joints stay where they are.
    fn linearise(&self, at: &mut NearBuffer) -> bool {
        self.manipulator.arch.dispatch(Linearise { manipulator: self.manipulator, at })
    }

    /// Takes one step with the last Jacobian, shortened until it reduces the error.
    fn step(&self, at: &mut NearBuffer) -> Result<(), NearStop> {
        at.right.fill(0.0);
        at.right[..at.error.len()].copy_from_slice(&at.error);
        let step = at.system.solve(&mut at.right);
        let longest = most(&step);
        let share = (LONGEST / longest).min(1.0);
        let mut stop = NearStop::Stalled;
        for halving in 0..HALVINGS {
            let scale = share * 0.5_f64.powi(halving as i32);
            match self.try_step(&step, scale, at) {
                Ok(()) => {
                    self.write_error(&at.tried, &at.driven, &mut at.error_after);
                    if norm(&at.error_after) < norm(&at.error) {
                        std::mem::swap(&mut at.solution, &mut at.tried);
                        std::mem::swap(&mut at.error, &mut at.error_after);
                        return Ok(());
                    }
                    stop = NearStop::Stalled;
                }
                Err(why) => stop = why,
            }
            if most(&at.error) <= ARRIVED {
                break;
            }
        }
        Err(stop)
    }

    /// Solves the pose that a share of a step leads to.
    fn try_step(
        &self,
        step: &[f64; MOST],
        scale: f64,
        at: &mut NearBuffer,
    ) -> Result<(), NearStop> {
        let m = self.manipulator;
        let (lower, upper) = (m.task().lower.kind, m.task().upper.kind);
        let [mut upper_twist, mut lower_twist] = [LocalTwist::zeros(); 2];
        let mut count = 0;
        for [u, l] in at.jacobians.directions() {
            let component = step[count] * at.units[count] * scale;
            upper_twist += u * component;
            lower_twist += l * component;
            count += 1;
        }
        let along =
            if m.task().height.is_some() { step[count] * at.units[count] * scale } else { 0.0 };
        // The twists are ḃ b⁻¹ and v⁻¹ v̇.
        let (v, b) = (at.solution.solved.v, at.solution.solved.b);
        let moved_b = upper.first_order(&upper_twist).after(&b);
        let moved_v = v.after(&lower.first_order(&lower_twist));
        let rise = m.task().rise(&at.solution.solved.pose) + along;
        self.displace([&moved_v, &moved_b], rise, at)
    }

    /// Solves the pose at the displacements `v` and `b`, and at a height above home, metres.
    fn displace(
        &self,
        [v, b]: [&Displacement; 2],
        rise: f64,
        at: &mut NearBuffer,
    ) -> Result<(), NearStop> {
        let m = self.manipulator;
        let reached = if m.dependent_coordinates().is_empty() {
            // The legs need no coordinates, which would cost sines and arctangents.
            let solved = &mut at.tried.solved;
            let (v, b, rise) = m.task().described_factors(v, b, rise);
            (solved.v, solved.b) = (v, b);
            m.task().set_rise(rise, &mut solved.pose);
            m.close_displaced(self.mode, &mut at.tried)
        } else {
            m.task().write_pose(v, b, rise, &mut at.all);
            m.write_independent(Some(self.mode), &mut at.all, &mut at.pose);
            m.close(&at.pose, self.mode, &mut at.tried).map_err(|_| NearStop::Stalled)?
        };
        match reached {
            true => Ok(()),
            false => Err(NearStop::OutOfReach(at.tried.unreachable[0])),
        }
    }

    /// Writes the coordinates of the present pose, angles within π of home.
    fn write_pose(&self, at: &mut NearBuffer) {
        let m = self.manipulator;
        let SolvedPose { pose, v, b } = &mut at.solution.solved;
        m.task().write_pose(v, b, m.task().rise(pose), &mut at.all);
        if m.dependent_coordinates().is_empty() {
            pose.copy_from_slice(&at.all);
        }
        m.write_independent(Some(self.mode), &mut at.all, &mut at.pose);
    }

    /// Writes the assembly at the present pose.
    fn assemble(&self, at: &mut NearBuffer) {
        let m = self.manipulator;
        self.write_pose(at);
        let NearBuffer { displacements, all, pose, solution, closure, assembly, .. } = at;
        m.write_closed(solution);
        m.set_actuated(displacements, &mut solution.joints);
        // The start may have had other angles than those that are written. So its own dependent coordinates are no use, and
        // the legs are held against the pose as it is written.
        let target = match &m.dependent {
            None => solution.displacement(m),
            Some(_) => m.task().displacement(all),
        };
        let residual = m.closure.residual(&solution.joints, &target);
        let place = AssemblyPlace { pose, all, target: &target, mode: self.mode };
        let solved = Solved {
            joints: solution.joints(),
            imaginary: solution.imaginary(),
            within_limits: solution.within_limits(),
        };
        m.write_assembly(place, solved, residual, closure, assembly);
    }
}

/// [`Newton::linearise`], with the instructions of the processor at hand.
struct Linearise<'a> {
    manipulator: &'a Manipulator,
    at: &'a mut NearBuffer,
}

impl WithSimd for Linearise<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let m = self.manipulator;
        let NearBuffer { solution, jacobians, system, units, .. } = self.at;
        if !m.differentiate_joints(solution, Rows::Driven, jacobians) {
            return false;
        }
        let (rows, locked_rows) = (m.actuated().len(), jacobians.locked.nrows());
        let joints = jacobians.joints.as_slice().chunks_exact(m.coordinates().len());
        let locked = jacobians.locked.as_slice();
        for ((number, joints), by) in joints.enumerate().zip(units) {
            let column = system.column_mut(number);
            for (entry, &coordinate) in column.iter_mut().zip(m.actuated()) {
                *entry = joints[coordinate] * *by * m.weight(coordinate);
            }
            let locked = &locked[number * locked_rows..(number + 1) * locked_rows];
            for (entry, rate) in column[rows..].iter_mut().zip(locked) {
                *entry = rate * *by;
            }
        }
        system.decompose(SINGULAR)
    }
}

/// The largest absolute value; not a number if one is not.
fn most(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| if x.abs() <= most { most } else { x.abs() })
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::samples::Numbers;
    use crate::manipulator::plan::{Anchor, Plan};
    use crate::mechanism::examples::EXAMPLES;

    /// Each step leaves the square of the error before it, times a constant of the mechanism.
    #[test]
    fn convergence_is_quadratic() {
        let mut squared = 0;
        for name in ["plano-spherical-5dof", "translational-planar-4dof", "planar-planar-5dof"] {
            let m = Manipulator::example(name).unwrap();
            let home = m.task().home();
            for sign in [-1.0, 1.0] {
                let aim: Vec<f64> = home.iter().map(|q| q + 0.02 * sign).collect();
                let mut solution = m.solution();
                assert!(m.inverse(&aim, m.home_mode(), &mut solution).unwrap().is_some());
                let wanted: Vec<f64> = m.actuated().iter().map(|&i| solution.joints[i]).collect();
                let mut at = m.near_buffer();
                assert!(m.inverse(&home, m.home_mode(), &mut at.solution).unwrap().is_some());
                let newton = Newton { manipulator: &m, wanted: &wanted, mode: m.home_mode() };
                newton.write_error(&at.solution, &at.driven, &mut at.error);
                let mut before = most(&at.error);
                while before > 1e-12 {
                    assert!(newton.linearise(&mut at));
                    newton.step(&mut at).unwrap();
                    let after = most(&at.error);
                    assert!(
                        after < 20.0 * before * before + 1e-14,
                        "{name}: {before:e}, {after:e}"
                    );
                    squared += usize::from(after > 1e-13);
                    before = after;
                }
            }
        }
        assert!(squared > 6, "{squared} steps above rounding");
    }

    /// The sections one after the other lead to the assembly to which Newton's method leads, from starts near poses in
    /// random modes. Near singularities, where they do not, the steps lead farther away more often.
    #[test]
    fn the_plan_leads_where_newton_leads() {
        let mut numbers = Numbers::new(8);
        for name in EXAMPLES.iter().map(|example| example.name) {
            let Ok(m) = Manipulator::example(name) else { continue };
            // A linear system takes one step of Newton's method.
            let Ok(Plan { anchor, .. }) = &m.plan else { continue };
            if matches!(anchor, Anchor::Flat(_)) {
                continue;
            }
            let modes: Vec<Mode> = m.modes().collect();
            let (mut ends, mut solution) = ([m.near_buffer(), m.near_buffer()], m.solution());
            let (mut starts, mut followed, mut same, mut nearer) = (0, 0, 0, 0);
            while starts < 200 {
                let pose = beside(&m, &m.home_pose(), [0.5, 0.08], &mut numbers);
                let start = beside(&m, &pose, [0.02, 0.002], &mut numbers);
                let mode = modes[(numbers.next().abs() * modes.len() as f64) as usize];
                if m.inverse(&pose, mode, &mut solution).unwrap().is_none() {
                    continue;
                }
                let wanted: Vec<f64> = m.actuated().iter().map(|&i| solution.joints[i]).collect();
                let newton = Newton { manipulator: &m, wanted: &wanted, mode };
                for at in &mut ends {
                    m.write_displacements(&wanted, &mut at.displacements).unwrap();
                    if m.close(&start, mode, &mut at.solution).unwrap() {
                        newton.write_error(&at.solution, &at.driven, &mut at.error);
                    }
                }
                let [by_plan, by_steps] = &mut ends;
                let in_reach = by_steps.solution.unreachable.is_empty();
                if !in_reach || newton.take_steps(by_steps).is_err() {
                    continue;
                }
                starts += 1;
                if !newton.follow_plan(by_plan) {
                    continue;
                }
                followed += 1;
                let [pose, a, b] = [&solution, &by_plan.solution, &by_steps.solution]
                    .map(|solution| m.platform_at(&solution.displacement(&m)));
                if m.platform_distance(&a, &b) < 1e-8 {
                    same += 1;
                } else if m.platform_distance(&a, &pose) < m.platform_distance(&b, &pose) {
                    nearer += 1;
                }
            }
            println!("{name}: {followed} of {starts} followed, {same} the same, {nearer} nearer");
            // Full revolutions of schoenflies-4dof's screw are assemblies farther away; planar-3rpr is nearly singular.
            assert!(followed >= 60 && 100 * (same + nearer) >= 98 * followed, "{name}");
        }
    }

    /// A random pose within these angles and lengths of another one, radians and metres.
    fn beside(m: &Manipulator, pose: &[f64], reach: [f64; 2], numbers: &mut Numbers) -> Vec<f64> {
        let coordinates = m.task_coordinates().iter().zip(pose);
        let reach = |quantity| reach[usize::from(quantity == Quantity::Length)];
        coordinates.map(|(c, q)| q + reach(c.quantity) * numbers.next()).collect()
    }
}
