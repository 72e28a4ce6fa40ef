//! The steps of inverse kinematics, each a loop over the poses of a block. The kind of chain, intersection
//! motion or limits is decided outside of the loop; the loop does the same arithmetic as for one pose.

use super::lanes::{
    Branches, Column, DisplacementColumns, Displacements, LANES, Lane, Lanes, Mask,
};
use crate::chain::cylindrical::WithRevolute;
use crate::chain::limits::Limits;
use crate::chain::partial::PartialChain;
use crate::chain::planar::PlanarChain;
use crate::chain::{Attempt, Chain, ClosedForm};
use crate::group::{
    Cylindrical, CylindricalDisplacement, CylindricalMotion, Displacement, IntersectionMotion,
    JointDisplacement, MotionType, Planar, PlanarDisplacement, PlanarMotion, SpatialMotion,
    Spherical, SphericalMotion, Subgroup, SubspaceKind, TranslationalMotion, TranslationalPlane,
    TranslationalSpace,
};
use crate::manipulator::{CompiledSection, ImaginaryJoint};
use crate::mechanism::OrientationCoordinates;
use crate::mechanism::leg::Section;
use crate::numeric::angle::sin_cos_reduced;
use crate::task::{
    Form, SectionValues, Task, lower_angles, lower_displacement, upper_angles, upper_displacement,
};
use nalgebra::{Complex, Matrix3, Vector3};

/// Half of the lanes. Where angles are computed, two halves at a time load the constants once.
#[inline(always)]
fn half_of(lanes: usize) -> usize {
    lanes.min(LANES) / 2
}

/// The result of a section's chain for every pose of a block.
#[derive(Clone, Debug)]
pub struct Found {
    pub displacements: [DisplacementColumns; 3],
    /// See [`Attempt::holds`].
    pub holds: Mask,
    /// See [`Attempt::beyond`].
    pub beyond: Mask,
}

impl Found {
    pub fn new() -> Self {
        let displacements =
            [DisplacementColumns::new(), DisplacementColumns::new(), DisplacementColumns::new()];
        Self { displacements, holds: Lanes::all(0), beyond: Lanes::all(0) }
    }

    /// Repeats the result of the first pose for all.
    #[inline(always)]
    pub fn repeat(&mut self) {
        for displacements in &mut self.displacements {
            displacements.repeat();
        }
        (self.holds, self.beyond) = (Lanes::all(self.holds[0]), Lanes::all(self.beyond[0]));
    }
}

/// The coordinates of a section at some poses. What they share is computed once.
pub trait SectionPoses {
    /// Those of pose number `lane`.
    fn at(&self, lane: usize) -> [f64; 3];
}

/// Poses that share nothing.
impl SectionPoses for [&Column; 3] {
    #[inline(always)]
    fn at(&self, lane: usize) -> [f64; 3] {
        [self[0][lane], self[1][lane], self[2][lane]]
    }
}

/// Poses that share their third coordinate.
pub struct OfSheet<'a> {
    pub first: &'a Column,
    pub second: &'a Column,
    pub third: f64,
}

impl SectionPoses for OfSheet<'_> {
    #[inline(always)]
    fn at(&self, lane: usize) -> [f64; 3] {
        [self.first[lane], self.second[lane], self.third]
    }
}

/// The first poses of rows, which differ in the second coordinate alone.
pub struct FirstOfRows<'a> {
    pub first: f64,
    pub second: &'a Column,
    pub third: f64,
}

impl SectionPoses for FirstOfRows<'_> {
    #[inline(always)]
    fn at(&self, lane: usize) -> [f64; 3] {
        [self.first, self.second[lane], self.third]
    }
}

/// The unit vector at an angle that needs no reduction.
#[inline(always)]
fn unit_reduced(angle: f64) -> Complex<f64> {
    let (sin, cos) = sin_cos_reduced(angle);
    Complex::new(cos, sin)
}

/// The displacements of a section, for its coordinates and their values at home.
#[inline(always)]
pub fn displace(
    task: &Task,
    section: Section,
    poses: &impl SectionPoses,
    home: [f64; 3],
    to: &mut Displacements,
    lanes: usize,
) {
    let lanes = lanes.min(LANES);
    // With a constant form, the loop has no branches.
    macro_rules! each {
        ($kind:ident, $shared:expr) => {
            each!($kind, $shared, OrientationCoordinates::EulerAngles)
        };
        ($kind:ident, $shared:expr, $angles:expr) => {{
            let form = Form { kind: SubspaceKind::$kind, shared: $shared, angles: $angles };
            for lane in 0..lanes {
                let values = SectionValues { at: poses.at(lane), home };
                let angles = match section {
                    Section::Lower => lower_angles(form, values),
                    Section::Upper => upper_angles(form, values),
                };
                let mut units = [Complex::ONE; 3];
                if let Some([a, b, c]) = angles {
                    // Three calls, where a map would not be inlined.
                    units = [unit_reduced(a), unit_reduced(b), unit_reduced(c)];
                }
                let values = values.less_home();
                let displacement = match section {
                    Section::Lower => lower_displacement(form, values, units),
                    Section::Upper => upper_displacement(form, values, units),
                };
                store(&displacement, to, lane);
            }
        }};
    }
    use MotionType::{Rotation, Translation};
    use OrientationCoordinates::{EulerAngles, RollPitchYaw, TiltTorsion};
    let Form { kind, shared, angles } = task.form(section);
    match (kind, shared) {
        (SubspaceKind::Identity, _) => {}
        (SubspaceKind::Planar, Some(Rotation)) => each!(Planar, Some(Rotation)),
        (SubspaceKind::Planar, Some(Translation)) => each!(Planar, Some(Translation)),
        (SubspaceKind::Planar, None) => each!(Planar, None),
        (SubspaceKind::Spherical, Some(_)) => match angles {
            EulerAngles => each!(Spherical, Some(Rotation)),
            TiltTorsion => each!(Spherical, Some(Rotation), TiltTorsion),
            RollPitchYaw => each!(Spherical, Some(Rotation), RollPitchYaw),
        },
        (SubspaceKind::Spherical, None) => match angles {
            EulerAngles => each!(Spherical, None),
            TiltTorsion => each!(Spherical, None, TiltTorsion),
            RollPitchYaw => each!(Spherical, None, RollPitchYaw),
        },
        (SubspaceKind::Cylindrical, Some(Rotation)) => each!(Cylindrical, Some(Rotation)),
        (SubspaceKind::Cylindrical, Some(Translation)) => each!(Cylindrical, Some(Translation)),
        (SubspaceKind::Cylindrical, None) => each!(Cylindrical, None),
        (SubspaceKind::TranslationalPlane, Some(_)) => each!(TranslationalPlane, Some(Translation)),
        (SubspaceKind::TranslationalPlane, None) => each!(TranslationalPlane, None),
        (SubspaceKind::TranslationalSpace, Some(_)) => each!(TranslationalSpace, Some(Translation)),
        (SubspaceKind::TranslationalSpace, None) => each!(TranslationalSpace, None),
    }
    let oriented = task.oriented_section() == Some(section);
    if let (true, Some(inverse)) = (oriented, task.home_orientation_inverse()) {
        for lane in 0..lanes {
            (Matrix3::load(to, lane) * inverse).store(to, lane);
        }
    }
}

/// Stores a displacement in the columns of its kind.
#[inline(always)]
pub(crate) fn store(displacement: &Displacement, to: &mut Displacements, lane: usize) {
    match displacement {
        Displacement::Identity(_) => {}
        Displacement::Planar(g) => g.store(to, lane),
        Displacement::Spherical(r) => r.store(to, lane),
        Displacement::Cylindrical(g) => g.store(to, lane),
        Displacement::Translational(t) => t.store(to, lane),
        Displacement::Spatial(t) => t.store(to, lane),
    }
}

/// The joints' displacements that move the outer link of a section by `targets`, as [`CompiledSection::inverse`] gives
/// them.
#[inline(always)]
pub fn solve(
    section: &CompiledSection,
    branches: &Branches,
    targets: &Displacements,
    found: &mut Found,
    lanes: usize,
) {
    match &section.partial {
        None => solve_chain(&section.chain, branches, targets, found, lanes),
        Some(partial) => solve_partial(partial, &section.chain, targets, found, lanes),
    }
}

/// The same for the chain of a section that does not constrain the platform.
#[inline(always)]
pub fn solve_chain(
    chain: &Chain,
    branches: &Branches,
    targets: &Displacements,
    found: &mut Found,
    lanes: usize,
) {
    match chain {
        // Blocks are of legs that are split.
        Chain::Rigid | Chain::Part(_) => {
            (found.holds, found.beyond) = (Lanes::all(1), Lanes::all(0));
        }
        Chain::Planar(PlanarChain::Rrr(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Prr(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Rrp(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Rpr(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Rpp(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Ppr(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Planar(PlanarChain::Prp(chain)) => attempt(chain, branches, targets, found, lanes),
        Chain::Spherical(chain) => attempt(chain, branches, targets, found, lanes),
        Chain::Ball(chain) => attempt(chain, branches, targets, found, lanes),
        Chain::Translational(chain) => attempt(chain, branches, targets, found, lanes),
        Chain::Spatial(chain) => attempt(chain, branches, targets, found, lanes),
        Chain::Cylindrical(chain) => match chain.revolute() {
            Some(0) => attempt(&WithRevolute::<0>(*chain), branches, targets, found, lanes),
            Some(_) => attempt(&WithRevolute::<1>(*chain), branches, targets, found, lanes),
            None => attempt(&WithRevolute::<2>(*chain), branches, targets, found, lanes),
        },
    }
}

/// The same for a section that constrains the platform, at targets that satisfy its constraints.
#[inline(always)]
fn solve_partial(
    partial: &PartialChain,
    chain: &Chain,
    targets: &Displacements,
    found: &mut Found,
    lanes: usize,
) {
    (found.holds, found.beyond) = (Lanes::all(1), Lanes::all(0));
    let to = &mut found.displacements;
    // Locked joints do not move.
    to.iter_mut().for_each(DisplacementColumns::clear);
    macro_rules! each {
        ($variant:ident, $displacement:ty) => {{
            let target = |lane: usize| {
                Displacement::<f64>::$variant(<$displacement as Lane>::load(targets, lane))
            };
            // The variants of the displacements depend on the joints alone.
            for (to, first) in to.iter_mut().zip(partial.inverse(&target(0))) {
                to.are_directions = matches!(first, JointDisplacement::Direction(_));
            }
            match partial.free() {
                (Some(a), Some(b)) => {
                    for lane in 0..lanes.min(LANES) {
                        let [p, q] = partial.two([a, b], &target(lane));
                        to[a].set(lane, p);
                        to[b].set(lane, q);
                    }
                }
                (Some(a), None) => {
                    for lane in 0..lanes.min(LANES) {
                        to[a].set(lane, partial.one(a, &target(lane)));
                    }
                }
                (None, _) => {}
            }
        }};
    }
    match chain {
        Chain::Planar(_) => each!(Planar, PlanarDisplacement),
        Chain::Spherical(_) | Chain::Ball(_) => each!(Spherical, Matrix3<f64>),
        Chain::Cylindrical(_) => each!(Cylindrical, CylindricalDisplacement),
        Chain::Translational(_) => each!(Translational, Complex<f64>),
        Chain::Rigid | Chain::Part(_) | Chain::Spatial(_) => each!(Spatial, Vector3<f64>),
    }
}

#[inline(always)]
fn attempt<C>(
    chain: &C,
    branches: &Branches,
    targets: &Displacements,
    found: &mut Found,
    lanes: usize,
) where
    C: ClosedForm + Copy,
    C::Target: Lane,
{
    let chain = *chain;
    // The variants of the displacements depend on the chain alone.
    let first = chain.attempt(&C::Target::load(targets, 0), branches[0].sign());
    let [a, b, c] = &mut found.displacements;
    for (displacements, displacement) in
        [&mut *a, &mut *b, &mut *c].into_iter().zip(first.displacements)
    {
        displacements.are_directions = matches!(displacement, JointDisplacement::Direction(_));
    }
    let mut take = |lane: usize, Attempt { displacements, holds, beyond }| {
        a.set(lane, displacements[0]);
        b.set(lane, displacements[1]);
        c.set(lane, displacements[2]);
        found.holds[lane] = u64::from(holds);
        found.beyond[lane] = u64::from(beyond);
    };
    if lanes == 1 {
        return take(0, first);
    }
    #[expect(clippy::needless_range_loop, reason = "a loop over the branches takes a fifth longer")]
    for lane in 0..lanes.min(LANES) {
        take(lane, chain.attempt(&C::Target::load(targets, lane), branches[lane].sign()));
    }
}

/// The side on which a displacement `τ` along the intersection motion is multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The product `v · exp(I τ)`.
    After,
    /// The product `exp(I τ) · b`.
    Before,
}

/// A step along the intersection motion, on one side of a displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub motion: IntersectionMotion,
    pub side: Side,
}

/// Displacements along a motion, one for each pose of a block.
pub trait Displaced {
    /// Whether they are directions; otherwise they are values.
    fn are_directions(&self) -> bool;
    /// That of pose number `lane`, which must be a direction.
    fn direction(&self, lane: usize) -> JointDisplacement;
    /// That of pose number `lane`, which must be a value.
    fn value(&self, lane: usize) -> JointDisplacement;
}

impl Displaced for DisplacementColumns {
    #[inline(always)]
    fn are_directions(&self) -> bool {
        self.are_directions
    }

    #[inline(always)]
    fn direction(&self, lane: usize) -> JointDisplacement {
        self.direction(lane)
    }

    #[inline(always)]
    fn value(&self, lane: usize) -> JointDisplacement {
        self.value(lane)
    }
}

/// The same displacement for all poses.
impl Displaced for JointDisplacement {
    #[inline(always)]
    fn are_directions(&self) -> bool {
        matches!(self, Self::Direction(_))
    }

    #[inline(always)]
    fn direction(&self, _: usize) -> JointDisplacement {
        *self
    }

    #[inline(always)]
    fn value(&self, _: usize) -> JointDisplacement {
        *self
    }
}

/// Moves displacements of a subspace along the intersection motion.
#[inline(always)]
pub fn shift(
    Step { motion, side }: Step,
    from: &Displacements,
    tau: &impl Displaced,
    to: &mut Displacements,
    lanes: usize,
) {
    let lanes = lanes.min(LANES);
    // Where displacements commute, both sides are the same.
    macro_rules! each {
        ($group:ty, $motion:expr, $read:ident, $before:ident) => {{
            let motion = $motion;
            for lane in 0..lanes {
                let displacement = <$group as Subgroup>::Displacement::load(from, lane);
                match side {
                    Side::After => motion.after::<f64>(&displacement, tau.$read(lane)),
                    Side::Before => motion.$before::<f64>(&displacement, tau.$read(lane)),
                }
                .store(to, lane);
            }
        }};
    }
    match (motion, tau.are_directions()) {
        (IntersectionMotion::None(_), _) => to.copy_from_slice(from),
        (IntersectionMotion::Planar(PlanarMotion::Rotation), true) => {
            each!(Planar, PlanarMotion::<Complex<f64>>::Rotation, direction, before);
        }
        (IntersectionMotion::Planar(PlanarMotion::Rotation), false) => {
            each!(Planar, PlanarMotion::<Complex<f64>>::Rotation, value, before);
        }
        (IntersectionMotion::Planar(PlanarMotion::Translation(along)), _) => {
            each!(Planar, PlanarMotion::Translation(along), value, before);
        }
        (IntersectionMotion::Spherical(SphericalMotion::Rotation), true) => {
            each!(Spherical, SphericalMotion::Rotation, direction, before);
        }
        (IntersectionMotion::Spherical(SphericalMotion::Rotation), false) => {
            each!(Spherical, SphericalMotion::Rotation, value, before);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Rotation), true) => {
            each!(Cylindrical, CylindricalMotion::Rotation, direction, after);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Rotation), false) => {
            each!(Cylindrical, CylindricalMotion::Rotation, value, after);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Translation), _) => {
            each!(Cylindrical, CylindricalMotion::Translation, value, after);
        }
        (IntersectionMotion::Translational(TranslationalMotion::Translation(along)), _) => {
            each!(TranslationalPlane, TranslationalMotion::Translation(along), value, after);
        }
        (IntersectionMotion::Spatial(SpatialMotion::Translation), _) => {
            each!(TranslationalSpace, SpatialMotion::Translation, value, after);
        }
    }
}

/// Computes the values to report of displacements, and clears `within` where they are not within the limits.
#[inline(always)]
pub fn report(
    limits: &Limits,
    home: f64,
    displacements: &DisplacementColumns,
    values: &mut Column,
    within: &mut Mask,
    lanes: usize,
) {
    let half = half_of(lanes);
    macro_rules! each {
        ($limits:expr, $read:ident) => {{
            let limits = $limits;
            for lane in 0..half {
                let (value, admitted) = limits.place(displacements.$read(lane), None);
                let (other, also) = limits.place(displacements.$read(lane + half), None);
                (values[lane], values[lane + half]) = (home + value, home + other);
                within[lane] &= u64::from(admitted);
                within[lane + half] &= u64::from(also);
            }
        }};
    }
    match (*limits, displacements.are_directions) {
        (Limits::Free, true) => each!(Limits::Free, direction),
        (Limits::Free, false) => each!(Limits::Free, value),
        (Limits::Range { low, high, arc: Some(arc) }, true) => {
            each!(Limits::Range { low, high, arc: Some(arc) }, direction);
        }
        (Limits::Range { low, high, arc: None }, true) => {
            each!(Limits::Range { low, high, arc: None }, direction);
        }
        (Limits::Range { low, high, .. }, false) => {
            each!(Limits::Range { low, high, arc: None }, value);
        }
    }
}

/// Clears `within` where displacements are not within the limits.
#[inline(always)]
pub fn admit(
    limits: &Limits,
    displacements: &DisplacementColumns,
    within: &mut Mask,
    lanes: usize,
) {
    macro_rules! each {
        ($limits:expr, $read:ident) => {{
            let limits = $limits;
            for lane in 0..lanes.min(LANES) {
                within[lane] &= u64::from(limits.admits(displacements.$read(lane)));
            }
        }};
    }
    match (*limits, displacements.are_directions) {
        (Limits::Free, _) | (Limits::Range { arc: None, .. }, true) => {}
        (Limits::Range { low, high, arc: Some(arc) }, true) => {
            each!(Limits::Range { low, high, arc: Some(arc) }, direction);
        }
        (Limits::Range { low, high, .. }, false) => {
            each!(Limits::Range { low, high, arc: None }, value);
        }
    }
}

/// Computes an imaginary joint's values for displacements along the intersection motion.
#[inline(always)]
pub fn imaginary(
    joint: &ImaginaryJoint,
    tau: &DisplacementColumns,
    values: &mut Column,
    lanes: usize,
) {
    let (home, sign) = (joint.home, joint.sign);
    let value = |displacement: JointDisplacement| home + sign * displacement.value();
    if tau.are_directions {
        let half = half_of(lanes);
        for lane in 0..half {
            let two = [tau.direction(lane), tau.direction(lane + half)];
            (values[lane], values[lane + half]) = (value(two[0]), value(two[1]));
        }
    } else {
        for (lane, to) in values.iter_mut().enumerate() {
            *to = value(tau.value(lane));
        }
    }
}

/// The imaginary joint's displacements, as angles within π of home where revolutions are counted.
#[inline(always)]
pub fn unwind(
    counts_revolutions: bool,
    found: &DisplacementColumns,
    tau: &mut DisplacementColumns,
    lanes: usize,
) {
    if counts_revolutions && found.are_directions {
        tau.are_directions = false;
        for lane in 0..lanes.min(LANES) {
            tau.set(lane, JointDisplacement::Value(found.direction(lane).value()));
        }
    } else {
        tau.clone_from(found);
    }
}

/// Replaces the displacements by their inverses.
#[inline(always)]
pub fn invert(tau: &mut DisplacementColumns, lanes: usize) {
    if tau.are_directions {
        for lane in 0..lanes.min(LANES) {
            tau.set(lane, tau.direction(lane).inverse());
        }
    } else {
        for lane in 0..lanes.min(LANES) {
            tau.set(lane, tau.value(lane).inverse());
        }
    }
}
