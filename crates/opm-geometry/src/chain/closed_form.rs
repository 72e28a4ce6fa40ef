//! What the closed form of a chain consists of. Each is written once, over numbers ([`crate::numbers`]).

use super::{Branch, ReachDeficit};
use crate::group::JointDisplacement;
use crate::numbers::{Joint, Real, Tolerance, Truth};
use crate::numeric::Quantity;

/// The result of a closed form's general case, which does not test what kind of target it has.
#[derive(Clone, Copy, Debug)]
pub struct Attempt<T: Real = f64> {
    /// The joints' displacements, base first. They are valid only where `holds` is true.
    pub displacements: [T::Joint; 3],
    /// Whether the target is in reach and the general case applies.
    pub holds: T::Truth,
    /// Whether the target is certainly out of reach. Where neither `holds` nor `beyond` is true,
    /// [`ClosedForm::exception`] decides.
    pub beyond: T::Truth,
}

impl<T: Real> Attempt<T> {
    /// The result of a closed form whose general case applies to every target in reach.
    #[inline(always)]
    pub fn decided(displacements: [T::Joint; 3], holds: T::Truth) -> Self {
        Self { displacements, holds, beyond: !holds }
    }

    /// The result for the inverse of the target and the joints in reverse order:
    /// `(E₁E₂E₃)⁻¹ = E₃⁻¹E₂⁻¹E₁⁻¹`, each displacement with the opposite sign.
    #[inline(always)]
    pub fn backwards(self) -> Self {
        Self { displacements: backwards::<T>(self.displacements), ..self }
    }
}

/// The joints of the chain in reverse order, each displaced by the opposite.
#[inline(always)]
fn backwards<T: Real>([a3, a2, a1]: [T::Joint; 3]) -> [T::Joint; 3] {
    [a1.inverse(), a2.inverse(), a3.inverse()]
}

/// What holds of a target to which the general case does not apply.
#[derive(Clone, Copy, Debug)]
pub struct Exception<T: Real = f64> {
    /// By how much it is out of reach.
    pub excess: T,
    /// Whether that is a length or an angle.
    pub quantity: Quantity,
    /// The solution of a special case, and whether the target is one.
    pub special: Option<(T::Truth, [T::Joint; 3])>,
}

impl<T: Real> Exception<T> {
    /// A target that is out of reach by a length.
    #[inline(always)]
    pub fn length(excess: T) -> Self {
        Self { excess, quantity: Quantity::Length, special: None }
    }

    /// See [`Attempt::backwards`].
    #[inline(always)]
    pub fn backwards(self) -> Self {
        let special = self.special.map(|(holds, joints)| (holds, backwards::<T>(joints)));
        Self { special, ..self }
    }
}

/// What decides whether there is a solution: whether a chain closes, or a coordinate follows from another one.
#[derive(Clone, Copy, Debug)]
pub enum Closes<T> {
    /// There always is.
    Always,
    /// A number is in a range.
    Within(T, [f64; 2]),
    /// A number is further from zero than a tolerance.
    Exceeds(T, Tolerance),
}

impl Closes<f64> {
    /// Whether it holds, to within a tolerance; false where the number is none.
    #[inline(always)]
    pub fn holds(&self, tolerance: f64) -> bool {
        match *self {
            Self::Always => true,
            Self::Within(number, [least, most]) => {
                number >= least - tolerance && number <= most + tolerance
            }
            Self::Exceeds(number, tolerance) => number.abs() > tolerance.share,
        }
    }
}

/// A chain whose target fixes its joints up to a sign.
pub trait ClosedForm<T: Real = f64> {
    /// The type of a displacement of the chain's subspace.
    type Target;

    /// The general case. It has no branch and no call, so that a loop over targets is vectorised. Whether it gives a
    /// direction or a number for a joint depends on the joint alone, not on the target.
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T>;

    /// Handles a target to which the general case does not apply. It is not asked for a chain whose general case always
    /// applies.
    #[inline(always)]
    fn exception(&self, target: &Self::Target, sign: T::Sign) -> Exception<T> {
        let special = Some((T::Truth::YES, self.attempt(target, sign).displacements));
        Exception { special, ..Exception::length(T::constant(0.0)) }
    }

    /// What decides whether the chain closes, as a number whose bounds over a box are narrow.
    fn closes(&self, _target: &Self::Target) -> Closes<T> {
        Closes::Always
    }
}

/// Writes the joints' displacements that move the outer link by `target`; nothing where it is out of reach.
#[inline(always)]
pub fn solve<C: ClosedForm>(
    chain: &C,
    target: &C::Target,
    branch: Branch,
    out: &mut [JointDisplacement; 3],
) -> Result<(), ReachDeficit> {
    let Attempt { displacements, holds, .. } = chain.attempt(target, branch.sign());
    *out = if holds { displacements } else { special(chain, target, branch)? };
    Ok(())
}

#[cold]
fn special<C: ClosedForm>(
    chain: &C,
    target: &C::Target,
    branch: Branch,
) -> Result<[JointDisplacement; 3], ReachDeficit> {
    match chain.exception(target, branch.sign()) {
        Exception { special: Some((true, displacements)), .. } => Ok(displacements),
        Exception { excess, quantity, .. } => Err(ReachDeficit::new(excess, quantity)),
    }
}
