//! The steps of inverse kinematics, each a loop over the poses of a block: what kind of chain, cut or limits
//! it is is decided outside of the loop, and what it does is what it does for one pose.

use super::lanes::{Amounts, Column, Displacements, LANES, Lane, Mask};
use crate::chain::cylindrical::WithRevolute;
use crate::chain::limits::Limits;
use crate::chain::planar::PlanarChain;
use crate::chain::{Attempt, Branch, Chain, ClosedForm};
use crate::group::{
    Cylindrical, CylindricalMotion, Displacement, IntersectionMotion, JointDisplacement, Planar,
    PlanarMotion, Spherical, SphericalMotion, Subgroup, SubspaceKind, TranslationalMotion,
    TranslationalPlane,
};
use crate::manipulator::ImaginaryJoint;
use crate::mechanism::leg::Section;
use crate::numeric::angle::sin_cos_reduced;
use crate::task::{Form, Task, lower_displacement, upper_displacement};
use nalgebra::Matrix3;

/// What a section's chain finds.
#[derive(Clone, Debug)]
pub struct Found {
    pub amounts: [Amounts; 3],
    /// See [`Attempt`].
    pub holds: Mask,
    pub beyond: Mask,
}

impl Found {
    pub fn new() -> Self {
        let amounts = [Amounts::new(), Amounts::new(), Amounts::new()];
        Self { amounts, holds: [0; LANES], beyond: [0; LANES] }
    }
}

/// The displacements of a section, for its coordinates and their values at home.
#[inline(always)]
pub fn displace(
    task: &Task,
    section: Section,
    at: [&Column; 3],
    home: [f64; 3],
    to: &mut Displacements,
) {
    // With a constant form, the loop is straight.
    macro_rules! each {
        ($kind:ident, $turn:expr) => {{
            let form = Form { kind: SubspaceKind::$kind, turn: $turn };
            for lane in 0..LANES {
                let at = [at[0][lane], at[1][lane], at[2][lane]];
                match section {
                    Section::Lower => lower_displacement(form, at, home, sin_cos_reduced),
                    Section::Upper => upper_displacement(form, at, home, sin_cos_reduced),
                }
                .store(to, lane);
            }
        }};
    }
    let Form { kind, turn } = task.form(section);
    match (kind, turn) {
        (SubspaceKind::Planar, true) => each!(Planar, true),
        (SubspaceKind::Planar, false) => each!(Planar, false),
        (SubspaceKind::Spherical, _) => each!(Spherical, true),
        (SubspaceKind::Cylindrical, true) => each!(Cylindrical, true),
        (SubspaceKind::Cylindrical, false) => each!(Cylindrical, false),
        (SubspaceKind::TranslationalPlane, _) => each!(TranslationalPlane, false),
    }
    if let (Section::Upper, Some(inverse)) = (section, task.home_orientation_inverse()) {
        for lane in 0..LANES {
            (Matrix3::load(to, lane) * inverse).store(to, lane);
        }
    }
}

impl Displacement {
    /// Into the columns of its kind.
    #[inline(always)]
    fn store(&self, to: &mut Displacements, lane: usize) {
        match self {
            Self::Planar(g) => g.store(to, lane),
            Self::Spherical(r) => r.store(to, lane),
            Self::Cylindrical(g) => g.store(to, lane),
            Self::Translational(t) => t.store(to, lane),
        }
    }
}

/// The joints' displacements that move the outer link of `chain` by `targets`.
#[inline(always)]
pub fn solve(chain: &Chain, branch: Branch, targets: &Displacements, found: &mut Found) {
    match chain {
        Chain::Planar(PlanarChain::Rrr(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Prr(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Rrp(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Rpr(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Rpp(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Ppr(chain)) => attempt(chain, branch, targets, found),
        Chain::Planar(PlanarChain::Prp(chain)) => attempt(chain, branch, targets, found),
        Chain::Spherical(chain) => attempt(chain, branch, targets, found),
        Chain::Ball(chain) => attempt(chain, branch, targets, found),
        Chain::Translational(chain) => attempt(chain, branch, targets, found),
        Chain::Cylindrical(chain) => match chain.revolute() {
            Some(0) => attempt(&WithRevolute::<0>(*chain), branch, targets, found),
            Some(_) => attempt(&WithRevolute::<1>(*chain), branch, targets, found),
            None => attempt(&WithRevolute::<2>(*chain), branch, targets, found),
        },
    }
}

#[inline(always)]
fn attempt<C>(chain: &C, branch: Branch, targets: &Displacements, found: &mut Found)
where
    C: ClosedForm + Copy,
    C::Target: Lane,
{
    let chain = *chain;
    // The kinds of the amounts are the chain's, whatever the target.
    let first = chain.attempt(&C::Target::load(targets, 0), branch);
    let [a, b, c] = &mut found.amounts;
    for (amounts, amount) in [&mut *a, &mut *b, &mut *c].into_iter().zip(first.amounts) {
        amounts.turns = matches!(amount, JointDisplacement::Direction(_));
    }
    for lane in 0..LANES {
        let Attempt { amounts, holds, beyond } =
            chain.attempt(&C::Target::load(targets, lane), branch);
        a.set(lane, amounts[0]);
        b.set(lane, amounts[1]);
        c.set(lane, amounts[2]);
        found.holds[lane] = u64::from(holds);
        found.beyond[lane] = u64::from(beyond);
    }
}

/// Where a displacement `τ` along the intersection motion comes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// `v · exp(I τ)`.
    After,
    /// `exp(I τ) · b`.
    Before,
}

/// Moves displacements of a subspace along the intersection motion.
#[inline(always)]
pub fn shift(
    (motion, side): (IntersectionMotion, Side),
    from: &Displacements,
    tau: &Amounts,
    to: &mut Displacements,
) {
    macro_rules! each {
        ($group:ty, $motion:expr, $amount:ident) => {{
            let motion = $motion;
            for lane in 0..LANES {
                let displacement = <$group as Subgroup>::Displacement::load(from, lane);
                match side {
                    Side::After => <$group>::after(&motion, &displacement, tau.$amount(lane)),
                    Side::Before => <$group>::before(&motion, &displacement, tau.$amount(lane)),
                }
                .store(to, lane);
            }
        }};
    }
    match (motion, tau.turns) {
        (IntersectionMotion::Planar(PlanarMotion::Rotation), true) => {
            each!(Planar, PlanarMotion::Rotation, turn);
        }
        (IntersectionMotion::Planar(PlanarMotion::Rotation), false) => {
            each!(Planar, PlanarMotion::Rotation, value);
        }
        (IntersectionMotion::Planar(PlanarMotion::Translation(along)), _) => {
            each!(Planar, PlanarMotion::Translation(along), value);
        }
        (IntersectionMotion::Spherical(SphericalMotion::Rotation), true) => {
            each!(Spherical, SphericalMotion::Rotation, turn);
        }
        (IntersectionMotion::Spherical(SphericalMotion::Rotation), false) => {
            each!(Spherical, SphericalMotion::Rotation, value);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Rotation), true) => {
            each!(Cylindrical, CylindricalMotion::Rotation, turn);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Rotation), false) => {
            each!(Cylindrical, CylindricalMotion::Rotation, value);
        }
        (IntersectionMotion::Cylindrical(CylindricalMotion::Translation), _) => {
            each!(Cylindrical, CylindricalMotion::Translation, value);
        }
        (IntersectionMotion::Translational(TranslationalMotion::Translation(along)), _) => {
            each!(TranslationalPlane, TranslationalMotion::Translation(along), value);
        }
    }
}

/// The values to report of amounts, and which of them are within the limits: cleared where not.
#[inline(always)]
pub fn report(
    (limits, home): (&Limits, f64),
    amounts: &Amounts,
    values: &mut Column,
    within: &mut Mask,
) {
    macro_rules! each {
        ($limits:expr, $amount:ident) => {{
            let limits = $limits;
            for lane in 0..LANES {
                let (value, admitted) = limits.place(amounts.$amount(lane), None);
                values[lane] = home + value;
                within[lane] &= u64::from(admitted);
            }
        }};
    }
    match (*limits, amounts.turns) {
        (Limits::Free, true) => each!(Limits::Free, turn),
        (Limits::Free, false) => each!(Limits::Free, value),
        (Limits::Range { low, high, arc: Some(arc) }, true) => {
            each!(Limits::Range { low, high, arc: Some(arc) }, turn);
        }
        (Limits::Range { low, high, arc: None }, true) => {
            each!(Limits::Range { low, high, arc: None }, turn);
        }
        (Limits::Range { low, high, .. }, false) => {
            each!(Limits::Range { low, high, arc: None }, value);
        }
    }
}

/// An imaginary joint's values for displacements along the intersection motion.
#[inline(always)]
pub fn imaginary(joint: &ImaginaryJoint, tau: &Amounts, values: &mut Column) {
    let (home, sign) = (joint.home, joint.sign);
    let value = |amount: JointDisplacement| home + sign * amount.value();
    if tau.turns {
        for (lane, to) in values.iter_mut().enumerate() {
            *to = value(tau.turn(lane));
        }
    } else {
        for (lane, to) in values.iter_mut().enumerate() {
            *to = value(tau.value(lane));
        }
    }
}

/// The cut, as an angle within half a turn of home where whole turns count.
#[inline(always)]
pub fn unwind(counts: bool, cut: &Amounts, tau: &mut Amounts) {
    if counts && cut.turns {
        tau.turns = false;
        for lane in 0..LANES {
            tau.set(lane, JointDisplacement::Value(cut.turn(lane).value()));
        }
    } else {
        tau.clone_from(cut);
    }
}

/// The displacements back.
#[inline(always)]
pub fn invert(tau: &mut Amounts) {
    if tau.turns {
        for lane in 0..LANES {
            tau.set(lane, tau.turn(lane).inverse());
        }
    } else {
        for lane in 0..LANES {
            tau.set(lane, tau.value(lane).inverse());
        }
    }
}
