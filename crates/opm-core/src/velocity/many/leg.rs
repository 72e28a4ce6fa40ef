//! A leg's rows of the Jacobian at every pose of a block.

use super::platform::{VectorColumns, fill, store, vector};
use crate::chain::Chain;
use crate::chain::partial::PartialChain;
use crate::group::{
    LocalTwist, Planar, PlanarDisplacement, Spherical, Subgroup, SubspaceKind, rotated,
};
use crate::manipulator::batch::Block;
use crate::manipulator::batch::lanes::{
    Column, DisplacementColumns, Displacements, LANES, Lane, Lanes, Mask, repeat,
};
use crate::manipulator::batch::section::{self, Found, Side, Step};
use crate::manipulator::{CompiledLeg, CompiledSection, Manipulator, Section};
use crate::velocity::SINGULAR;
use crate::velocity::jacobian::Basis;
use nalgebra::Complex;

/// A joint of which the rates are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowJoint {
    /// An actuated joint, by the number of its coordinate.
    Actuated(usize),
    /// A joint that a constraining leg lacks, by its section and its number there.
    Locked(Section, usize),
}

/// The rates of one joint, for each component of the section twist.
#[derive(Clone, Debug)]
pub struct JointRow {
    pub joint: RowJoint,
    pub rates: Vec<Column>,
}

/// One branch of a leg at every pose of a block.
#[derive(Clone, Debug)]
pub struct BranchRows {
    /// Whether it reaches a pose within the leg's limits.
    pub reaches: Mask,
    /// Whether a section's screws are dependent.
    pub serial: Mask,
    /// The leg's actuated joints, then those that it lacks.
    pub rows: Vec<JointRow>,
    /// The number of the leg's imaginary joint, and its values.
    pub imaginary: Option<(usize, Column)>,
}

impl BranchRows {
    /// Room for a leg's rows.
    pub fn new(manipulator: &Manipulator, leg: usize) -> Self {
        let compiled = &manipulator.legs[leg];
        let freedoms = manipulator.task().coordinates.len();
        let joints = compiled.lower.coordinates.iter().chain(&compiled.upper.coordinates).flatten();
        let joints = joints.chain(compiled.lift.iter().map(|lift| &lift.coordinate));
        let actuated = joints.filter(|joint| joint.actuated.is_some());
        let actuated = actuated.map(|joint| RowJoint::Actuated(joint.number));
        let locked = locked(manipulator).filter(|(of, _)| *of == leg).map(|(_, joint)| joint);
        let rows = actuated
            .chain(locked)
            .map(|joint| JointRow { joint, rates: vec![Lanes::all(0.0); freedoms] });
        Self {
            reaches: Lanes::all(0),
            serial: Lanes::all(0),
            rows: rows.collect(),
            imaginary: compiled.imaginary.map(|number| (number, Lanes::all(0.0))),
        }
    }

    /// The row of a joint, if its rates are asked for.
    #[inline(always)]
    fn row(&mut self, joint: RowJoint) -> Option<&mut Vec<Column>> {
        let mut rows = self.rows.iter_mut();
        rows.find(|row| row.joint == joint).map(|row| &mut row.rates)
    }
}

/// The joints that constraining legs lack, each with its leg: see [`Jacobians::locked`](crate::velocity::Jacobians::locked).
pub fn locked(manipulator: &Manipulator) -> impl Iterator<Item = (usize, RowJoint)> + '_ {
    let dependent = manipulator.dependent.iter();
    let locked = dependent.flat_map(|dependent| dependent.locked(&manipulator.legs));
    locked.map(|(leg, section, joint)| (leg, RowJoint::Locked(section, joint)))
}

/// The displaced screws of a section, and one over their determinant.
#[derive(Clone, Debug)]
struct Screws {
    moved: [VectorColumns; 3],
    inverse: Column,
    /// Displacements of the first and the second joint.
    steps: [Displacements; 2],
}

impl Screws {
    fn new() -> Self {
        Self {
            moved: [[Lanes::all(0.0); 3]; 3],
            inverse: Lanes::all(0.0),
            steps: [[Lanes::all(0.0); 9]; 2],
        }
    }

    /// Displaces the screws of a section: see [`Screws`](crate::velocity::screws::Screws).
    #[inline(always)]
    fn displace(
        &mut self,
        kind: SubspaceKind,
        section: &CompiledSection,
        found: &Found,
        lanes: usize,
    ) {
        let Self { moved: [first, second, third], steps: [one, two], .. } = self;
        let [s1, s2, s3] = section.screws;
        let [q1, q2, _] = &found.displacements;
        fill(first, &s1);
        match kind {
            SubspaceKind::Planar => {
                along_screw(&s1, q1, one, lanes);
                along_screw(&s2, q2, two, lanes);
                for lane in 0..lanes.min(LANES) {
                    let one = PlanarDisplacement::load(one, lane);
                    let two = one.after(&PlanarDisplacement::load(two, lane));
                    store(second, lane, Planar::adjoint(&one, &s2));
                    store(third, lane, Planar::adjoint(&two, &s3));
                }
            }
            SubspaceKind::Spherical => {
                unit_directions(q1, one, lanes);
                unit_directions(q2, two, lanes);
                for lane in 0..lanes.min(LANES) {
                    let one = Complex::load(one, lane);
                    let two = Complex::load(two, lane);
                    store(second, lane, rotated(&s1, one, &s2));
                    store(third, lane, rotated(&s1, one, &rotated(&s2, two, &s3)));
                }
            }
            SubspaceKind::Identity
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace => {
                fill(second, &s2);
                fill(third, &s3);
            }
        }
    }

    /// Replaces the screws of the locked joints of a section that constrains the platform, and returns the unit of the
    /// determinant: see [`PartialChain::complete`].
    // Inlined, it would be compiled for every set of instructions.
    #[inline(never)]
    fn complete(&mut self, partial: &PartialChain, length: f64, lanes: usize) -> f64 {
        let mut unit = 1.0;
        for lane in 0..lanes.min(LANES) {
            let mut screws = self.moved.each_ref().map(|screw| vector(screw, lane));
            unit = partial.complete(&mut screws, length);
            for joint in partial.locked_joints() {
                store(&mut self.moved[joint], lane, screws[joint]);
            }
        }
        unit
    }

    /// Computes the determinant, whose unit is `scale`, and marks the poses at which it counts as zero.
    #[inline(always)]
    fn invert(&mut self, scale: f64, serial: &mut Mask, lanes: usize) {
        let Self { moved: [first, second, third], inverse, .. } = self;
        let mut singular = Lanes::all(0);
        for lane in 0..lanes.min(LANES) {
            let cross = vector(second, lane).cross(&vector(third, lane));
            let determinant = vector(first, lane).dot(&cross);
            singular[lane] = u64::from((determinant / scale).abs() < SINGULAR);
            inverse[lane] = determinant.recip();
        }
        if lanes < LANES {
            singular = Lanes::all(singular[0]);
        }
        for lane in 0..LANES {
            serial[lane] |= singular[lane];
        }
    }

    /// The reciprocal screw of a joint.
    #[inline(always)]
    fn reciprocal(&self, joint: usize, to: &mut VectorColumns, lanes: usize) {
        let [a, b] = match joint {
            0 => [&self.moved[1], &self.moved[2]],
            1 => [&self.moved[2], &self.moved[0]],
            _ => [&self.moved[0], &self.moved[1]],
        };
        for lane in 0..lanes.min(LANES) {
            store(to, lane, vector(a, lane).cross(&vector(b, lane)) * self.inverse[lane]);
        }
    }
}

/// The displacements along a screw of the plane.
#[inline(always)]
fn along_screw(screw: &LocalTwist, q: &DisplacementColumns, to: &mut Displacements, lanes: usize) {
    // The displacement of a slider is a value.
    if screw.x == 0.0 {
        for lane in 0..lanes.min(LANES) {
            PlanarDisplacement::along_slider(screw, q.value(lane)).store(to, lane);
        }
        return;
    }
    unit_directions(q, to, lanes);
    for lane in 0..lanes.min(LANES) {
        let rotation = Complex::load(to, lane);
        PlanarDisplacement::along_rotation(screw, rotation).store(to, lane);
    }
}

/// The unit complex numbers in the directions of angles.
#[inline(always)]
fn unit_directions(q: &DisplacementColumns, to: &mut Displacements, lanes: usize) {
    macro_rules! each {
        ($read:ident) => {
            for lane in 0..lanes.min(LANES) {
                q.$read(lane).unit_direction().store(to, lane);
            }
        };
    }
    if q.are_directions { each!(direction) } else { each!(value) }
}

/// A twist displaced by displacements of a subspace.
#[inline(always)]
fn adjoint(kind: SubspaceKind, by: &Displacements, twist: &LocalTwist, to: &mut VectorColumns) {
    macro_rules! each {
        ($group:ty) => {
            for lane in 0..LANES {
                store(to, lane, <$group>::adjoint(&Lane::load(by, lane), twist));
            }
        };
    }
    match kind {
        SubspaceKind::Planar => each!(Planar),
        SubspaceKind::Spherical => each!(Spherical),
        // There, displacements commute.
        SubspaceKind::Identity
        | SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => fill(to, twist),
    }
}

/// What leads to the rows of a leg, for every pose of a block.
#[derive(Clone, Debug)]
pub struct LegRows {
    /// The numbers of upper and of lower components of the section twist.
    counts: [usize; 2],
    /// The upper components, the same at all poses.
    basis: [LocalTwist; 3],
    upper: [VectorColumns; 3],
    /// These as the leg's displacement along the intersection motion carries them.
    carried_upper: [VectorColumns; 3],
    /// The lower components and the intersection motion after the displacement of the lower section.
    moved_lower: [VectorColumns; 3],
    moved_along: VectorColumns,
    lower_screws: Screws,
    upper_screws: Screws,
    /// Rates along the intersection motion for the components of the section that is solved first.
    along: [Column; 3],
    /// The intersection motion in the upper section.
    upper_along: VectorColumns,
    reciprocal: VectorColumns,
    /// Displacements along the intersection motion, and back.
    back: DisplacementColumns,
    steps: Displacements,
}

impl LegRows {
    pub fn new(manipulator: &Manipulator, basis: &Basis) -> Self {
        let same = |twist: &LocalTwist| [twist.x, twist.y, twist.z].map(Lanes::all);
        let none = same(&LocalTwist::zeros());
        Self {
            counts: basis.counts,
            basis: basis.upper,
            upper: basis.upper.each_ref().map(same),
            carried_upper: [none; 3],
            moved_lower: [none; 3],
            moved_along: none,
            lower_screws: Screws::new(),
            upper_screws: Screws::new(),
            along: none,
            upper_along: same(&manipulator.task().upper_intersection.unit_twist()),
            reciprocal: none,
            back: DisplacementColumns::new(),
            steps: [Lanes::all(0.0); 9],
        }
    }

    /// Begins a block: finds what all legs share.
    #[inline(always)]
    pub fn begin(&mut self, manipulator: &Manipulator, basis: &Basis, block: &Block) {
        let task = manipulator.task();
        let kind = task.lower.kind;
        adjoint(kind, &block.v, &task.lower_intersection.unit_twist(), &mut self.moved_along);
        for (twist, to) in basis.lower[..basis.counts[1]].iter().zip(&mut self.moved_lower) {
            adjoint(kind, &block.v, twist, to);
        }
    }

    /// Computes the rows of the branch of a leg that the block solved last: see
    /// [`Manipulator::differentiate`].
    #[inline(always)]
    pub fn differentiate(
        &mut self,
        manipulator: &Manipulator,
        number: usize,
        block: &Block,
        out: &mut BranchRows,
    ) {
        let (task, leg) = (manipulator.task(), &manipulator.legs[number]);
        out.serial = Lanes::all(0);
        // What is solved first in the upper section may be the same at all poses.
        let first = leg.split_section == Section::Upper;
        let upper_lanes = if first { block.upper_lanes } else { LANES };
        for (section, kind, found, screws, lanes) in [
            (&leg.lower, task.lower.kind, &block.lower, &mut self.lower_screws, LANES),
            (&leg.upper, task.upper.kind, &block.upper, &mut self.upper_screws, upper_lanes),
        ] {
            // A spherical joint is never singular, and is not actuated here.
            if !matches!(section.chain, Chain::Ball(_)) {
                screws.displace(kind, section, found, lanes);
                let scale = match &section.partial {
                    None => section.scale,
                    Some(partial) => {
                        screws.complete(partial, manipulator.characteristic_length(), lanes)
                    }
                };
                screws.invert(scale, &mut out.serial, lanes);
            }
        }
        self.carry(manipulator, leg, block, upper_lanes);
        self.section_rows(leg, Section::Lower, out, LANES);
        self.section_rows(leg, Section::Upper, out, upper_lanes);
        if let Some(lift) = &leg.lift
            && let Some(rates) = out.row(RowJoint::Actuated(lift.coordinate.number))
            && let Some(height) = rates.last_mut()
        {
            // It does not lean, so that nothing else changes the height.
            height.fill(lift.displacement(1.0));
        }
        if let Some((imaginary, values)) = &mut out.imaginary {
            section::imaginary(&manipulator.imaginary()[*imaginary], &block.tau, values, LANES);
        }
    }

    /// Finds the rates along the intersection motion, and the twists that it carries along.
    #[inline(always)]
    fn carry(
        &mut self,
        manipulator: &Manipulator,
        leg: &CompiledLeg,
        block: &Block,
        upper_lanes: usize,
    ) {
        let [n_upper, n_lower] = self.counts;
        if leg.split_section == Section::Lower {
            self.back.clone_from(&block.tau);
            section::invert(&mut self.back, LANES);
            let motion = manipulator.task().upper_intersection;
            let kind = motion.kind();
            if !kind.commutes() {
                // The displacement back is one of the identity.
                let step = Step { motion, side: Side::Before };
                let mut identity = [Lanes::all(0.0); 9];
                for lane in 0..LANES {
                    section::store(&kind.identity(), &mut identity, lane);
                }
                section::shift(step, &identity, &self.back, &mut self.steps, LANES);
            }
            for (twist, to) in self.basis[..n_upper].iter().zip(&mut self.carried_upper) {
                adjoint(kind, &self.steps, twist, to);
            }
        }
        let Some(joint) = leg.imaginary_joint() else {
            self.along = [Lanes::all(0.0); 3];
            return;
        };
        let (screws, own, lanes) = match leg.split_section {
            Section::Upper => (&self.upper_screws, &self.upper[..n_upper], upper_lanes),
            Section::Lower => (&self.lower_screws, &self.moved_lower[..n_lower], LANES),
        };
        screws.reciprocal(joint, &mut self.reciprocal, lanes);
        for (twist, rates) in own.iter().zip(&mut self.along) {
            for lane in 0..lanes.min(LANES) {
                rates[lane] = vector(&self.reciprocal, lane).dot(&vector(twist, lane));
            }
            if lanes < LANES {
                repeat(std::slice::from_mut(rates));
            }
        }
    }

    /// Computes the rows of a section's joints.
    #[inline(always)]
    fn section_rows(
        &mut self,
        leg: &CompiledLeg,
        section: Section,
        out: &mut BranchRows,
        lanes: usize,
    ) {
        let [n_upper, n_lower] = self.counts;
        let Self { lower_screws, upper_screws, along, reciprocal, .. } = self;
        // Where the components of the section itself are, those of the other one, and what these carry along.
        let (screws, start, [other, count]) = match section {
            Section::Upper => (upper_screws, 0, [n_upper, n_lower]),
            Section::Lower => (lower_screws, n_upper, [0, n_upper]),
        };
        let (own, carried) = match (section, leg.split_section) {
            (Section::Upper, Section::Upper) => (&self.upper[..n_upper], None),
            (Section::Upper, Section::Lower) => {
                (&self.carried_upper[..n_upper], Some(&self.upper_along))
            }
            (Section::Lower, Section::Upper) => {
                (&self.moved_lower[..n_lower], Some(&self.moved_along))
            }
            (Section::Lower, Section::Lower) => (&self.moved_lower[..n_lower], None),
        };
        for (coordinate, joint) in leg.section(section).coordinates.iter().zip(0..) {
            let wanted = match coordinate {
                Some(coordinate) => RowJoint::Actuated(coordinate.number),
                None => RowJoint::Locked(section, joint),
            };
            let Some(rates) = out.row(wanted) else { continue };
            screws.reciprocal(joint, reciprocal, lanes);
            for (twist, rates) in own.iter().zip(&mut rates[start..]) {
                for lane in 0..lanes.min(LANES) {
                    rates[lane] = vector(reciprocal, lane).dot(&vector(twist, lane));
                }
                if lanes < LANES {
                    repeat(std::slice::from_mut(rates));
                }
            }
            for (along, rates) in along[..count].iter().zip(&mut rates[other..]) {
                let Some(carried) = carried else {
                    rates.fill(0.0);
                    continue;
                };
                for lane in 0..LANES {
                    let by_along = vector(reciprocal, lane).dot(&vector(carried, lane));
                    rates[lane] = by_along * along[lane];
                }
            }
        }
    }
}
