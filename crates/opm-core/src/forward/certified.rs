//! Proofs that there is an assembly near one that was computed, and that two are not the same.
//!
//! Unknown are the passive joints; the equations say that all legs end at one place. `F` and its derivatives are bounded over a box of
//! joints about the assembly, with every operation rounded outward. With `A` near the inverse of the derivative in the middle,
//! Krawczyk's operator `K = -A F(0) + (I - A F'(X)) X` takes the box `X` of displacements from the middle into its inside only if there is
//! exactly one solution in it (Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4,
//! 1969; Rump, "Verification methods", Acta Numerica 19, 2010). Where assemblies nearly meet, `F'` nearly has no inverse, and no box
//! is taken into itself.
//!
//! Legs of an overconstrained mechanism give more equations than there are unknowns. By its decomposition the others follow from as
//! many as there are unknowns: the equations have constant rank, so `A F = 0` only where `F = 0`. That holds for axes as the
//! decomposition takes them, which differ from those of the file by its deviation. All such axes are within the bounds.

mod bounds;
mod legs;

use super::Assembly;
use super::accept::MATCH;
use crate::manipulator::Manipulator;
use crate::numeric::Quantity;
use crate::numeric::svd::{Svd, rank};
use fastrand::Rng;
pub(super) use legs::Legs;
use nalgebra::{DMatrix, DVector, Isometry3};
use std::f64::consts::TAU;

/// Below this share of the largest singular value, derivatives depend on each other.
const DEPENDENT: f64 = 1e-9;
/// There is no other solution in a box of at least so large a radius, radians and sizes: two assemblies that are nearer to each other
/// may have been taken for one.
const ALONE: f64 = 4.0 * MATCH;
/// Radii are at least so large, and are tried up to so large ones.
const LEAST: f64 = 1e-15;
const MOST: f64 = 0.05;
/// So many times the image of a box that has a solution is taken for the box.
const SMALLER: usize = 3;
/// A box that is not taken into its inside is made as large as its image times this.
const LARGER: f64 = 1.5;
const BOXES: usize = 12;
/// Steps of Newton's method before.
const STEPS: usize = 3;
/// What a rounded sum of so many products is wrong by, as a share of the sum of their absolute values: more than `n ε`.
const SUMMED: f64 = 1e-14;
/// The distance of two places is rounded by less.
const OF_DISTANCE: f64 = 1e-14;
/// Joints are drawn so far about home, radians and sizes, to count those that move nothing but their leg.
const ABOUT_HOME: f64 = 0.3;

/// What is proven of an assembly: see [`Manipulator::certify`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Certificate {
    /// One exact assembly is near it, and no other one.
    Proven(Proof),
    /// Nothing is proven: two assemblies nearly meet, or the platform can move with its actuated joints held.
    DoubleSuspected,
    /// More joints are actuated than the platform has freedoms: no proof that their values agree exactly.
    Redundant,
}

/// A proof that an exact assembly is near one that was computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Proof {
    /// How far the exact place of the platform is from that of the assembly at most: the angle in radians plus the distance of
    /// the reference point over the mechanism's size.
    pub radius: f64,
    /// Of the closure equations, the number of those that are proven to hold.
    pub proven: usize,
    /// The number of those that follow from these by the decomposition, in an overconstrained mechanism.
    pub implied: usize,
    /// Whether the exact assembly is none of those before it in the list.
    pub distinct: bool,
}

/// A solution in a box of joints.
struct Solved {
    proof: Proof,
    place: Isometry3<f64>,
    /// The joint coordinates but those of balls: centre and radius, radians and sizes.
    joints: Vec<(usize, [f64; 2])>,
}

impl Certificate {
    /// The proof, if there is one.
    pub fn proof(&self) -> Option<&Proof> {
        match self {
            Self::Proven(proof) => Some(proof),
            Self::DoubleSuspected | Self::Redundant => None,
        }
    }
}

impl Manipulator {
    /// Proves for each assembly of a list that one exact solution of the closure equations is near it, and that no two of these are the
    /// same. Joints that move nothing but their own leg, as a rod's rotation about itself, are held where they are. A list that
    /// [`Manipulator::forward`] gives has its certificates in the same order.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("delta")?;
    /// let found = manipulator.forward(&[0.1, -0.05, 0.2])?;
    /// let certificates = manipulator.certify(&found.list);
    /// assert_eq!(certificates.len(), 2);
    /// for certificate in certificates {
    ///     let proof = certificate.proof().expect("a regular assembly");
    ///     assert!(proof.radius < 1e-8 && proof.distinct);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn certify(&self, list: &[Assembly]) -> Vec<Certificate> {
        if self.is_redundant() {
            return vec![Certificate::Redundant; list.len()];
        }
        let idle = self.idle();
        let mut solved: Vec<Solved> = Vec::new();
        let certificate = |assembly: &Assembly| {
            let Some(mut one) = self.solved(assembly, &idle) else {
                return Certificate::DoubleSuspected;
            };
            one.proof.distinct = solved.iter().all(|other| self.are_apart(&one, other));
            let proof = one.proof;
            solved.push(one);
            Certificate::Proven(proof)
        };
        list.iter().map(certificate).collect()
    }

    /// For each leg, how many of its passive joints can move without the others, wherever the leg is.
    pub(super) fn idle(&self) -> Vec<usize> {
        let mut rng = Rng::with_seed(71);
        let joints = self.joints_near_home(ABOUT_HOME, &mut rng);
        let legs = Legs::new(self, &joints, &Isometry3::identity(), 0.0);
        let still = DVector::zeros(legs.coordinates.len());
        let of_leg = |leg: usize| {
            let twists = legs.twists(leg, &still);
            twists.ncols() - rank(twists, DEPENDENT)
        };
        (0..self.legs()).map(of_leg).collect()
    }

    /// Joint values at random, up to so far from home, radians and sizes. Parallelograms stay such; legs do not meet.
    pub(super) fn joints_near_home(&self, off: f64, rng: &mut Rng) -> Vec<f64> {
        let mut joints = Vec::with_capacity(self.coordinates().len());
        for leg in &self.mechanism().legs {
            let first = joints.len();
            let mut own: Vec<f64> = (first..first + leg.coordinates().count())
                .map(|c| off * (2.0 * rng.f64() - 1.0) / self.weight(c))
                .collect();
            leg.hold_parallelograms(&mut own);
            joints.extend(own.iter().zip(leg.coordinates()).map(|(off, c)| c.home + off));
        }
        joints
    }

    /// The exact solution near an assembly.
    fn solved(&self, assembly: &Assembly, idle: &[usize]) -> Option<Solved> {
        let place = self.displacement_of(assembly);
        let exact = Legs::new(self, &assembly.joints, &place, 0.0);
        let held = free(&exact, idle);
        let rows = 6 * (self.legs() - 1);
        let implied = rows.checked_sub(held.len())?;
        let legs = match implied {
            0 => exact,
            _ => Legs::new(self, &assembly.joints, &place, self.decomposition().deviation),
        };
        let (centres, radii, off) = Krawczyk { legs: &legs, free: &held }.solution()?;
        let of = |(i, coordinate): (usize, &Option<usize>)| Some((i, (*coordinate)?));
        let joint = |(i, c): (usize, usize)| {
            let value = assembly.joints[c] * self.weight(c) + centres[i];
            (c, [value, radii[i] + LEAST * value.abs()])
        };
        let joints = legs.coordinates.iter().enumerate().filter_map(of).map(joint).collect();
        let proof = Proof { radius: off, proven: held.len(), implied, distinct: true };
        Some(Solved { proof, place, joints })
    }

    /// Whether two solutions are not the same: the platform or a joint is elsewhere.
    fn are_apart(&self, one: &Solved, other: &Solved) -> bool {
        let [from, to] = [one, other].map(|one| self.platform_at(&one.place));
        let apart = self.platform_distance(&from, &to);
        let pairs = one.joints.iter().zip(&other.joints);
        let mut joints = pairs.map(|((c, [a, r]), (_, [b, s]))| {
            let turns = match self.coordinates()[*c].quantity {
                Quantity::Angle => ((a - b) / TAU).round() * TAU,
                Quantity::Length => 0.0,
            };
            (a - b - turns).abs() > r + s + OF_DISTANCE
        });
        apart > one.proof.radius + other.proof.radius + OF_DISTANCE || joints.any(|apart| apart)
    }
}

/// The unknowns that are solved for: those of a leg that are idle are held, which are least independent of the others.
pub(super) fn free(legs: &Legs, idle: &[usize]) -> Vec<usize> {
    let still = DVector::zeros(legs.coordinates.len());
    let mut found = Vec::new();
    for (leg, (range, &idle)) in legs.unknowns.iter().zip(idle).enumerate() {
        let mut order = DMatrix::from_fn(1, range.len(), |_, i| (range.start + i) as f64);
        if idle > 0 {
            legs.twists(leg, &still).col_piv_qr().p().permute_columns(&mut order);
        }
        found.extend(order.iter().take(range.len() - idle).map(|&number| number as usize));
    }
    found
}

/// The equations in some of the unknowns.
struct Krawczyk<'a> {
    legs: &'a Legs,
    free: &'a [usize],
}

impl Krawczyk<'_> {
    /// The unknowns of a solution: centres, radii, and how far the platform is from its target there at most.
    fn solution(&self) -> Option<(DVector<f64>, DVector<f64>, f64)> {
        let still = DVector::zeros(self.legs.coordinates.len());
        let mut centres = still.clone();
        let mut at = self.legs.at(&centres, &still);
        let svd = Svd::new(at.jacobian[0].select_columns(self.free));
        if svd.rank(DEPENDENT) < self.free.len() {
            return None;
        }
        let scales = svd.values.iter().map(|value| value.powi(-2));
        let scaled = DMatrix::from_diagonal(&DVector::from_iterator(self.free.len(), scales));
        let inverse = svd.right * scaled * svd.image.transpose();
        let mut image = &inverse * &at.values[0];
        for _ in 0..STEPS {
            for (&unknown, step) in self.free.iter().zip(image.iter()) {
                centres[unknown] -= step;
            }
            at = self.legs.at(&centres, &still);
            let before = image.amax();
            image = &inverse * &at.values[0];
            if image.amax() > 0.1 * before {
                break;
            }
        }
        // A F(0), to within the bounds of F and the rounding of the product.
        let absolute = inverse.abs();
        let rounded = &at.values[1] + at.values[0].abs() * SUMMED;
        let first = image.abs() + &absolute * rounded * (1.0 + SUMMED);
        let taken = |radii: &DVector<f64>| -> Option<DVector<f64>> {
            let over = self.legs.at(&centres, &self.all(radii));
            let jacobian = over.jacobian.each_ref().map(|part| part.select_columns(self.free));
            let product = &inverse * &jacobian[0];
            let wide = &jacobian[1] + jacobian[0].abs() * SUMMED;
            let rest = (DMatrix::identity(self.free.len(), self.free.len()) - product).abs()
                + &absolute * wide * (1.0 + SUMMED);
            let taken = (&first + rest * radii) * (1.0 + SUMMED);
            (over.near && taken.iter().all(|part| part.is_finite())).then_some(taken)
        };
        let mut radii = first.map(|part| f64::max(LARGER * part, ALONE));
        let mut image = taken(&radii)?;
        for _ in 0..BOXES {
            if image.iter().zip(radii.iter()).all(|(image, radius)| image < radius) {
                break;
            }
            radii = image.map(|part| f64::max(LARGER * part, ALONE));
            if radii.amax() > MOST {
                return None;
            }
            image = taken(&radii)?;
        }
        if image.iter().zip(radii.iter()).any(|(image, radius)| image >= radius) {
            return None;
        }
        // The solution is in the image of every box that has it.
        for _ in 0..SMALLER {
            image = taken(&image)?.zip_map(&image, f64::min);
        }
        let radii = self.all(&image);
        let off = self.legs.at(&centres, &radii).off;
        off.is_finite().then_some((centres, radii, off))
    }

    /// The radii of all unknowns: those that are held have none.
    fn all(&self, radii: &DVector<f64>) -> DVector<f64> {
        let mut all = DVector::zeros(self.legs.coordinates.len());
        for (&unknown, radius) in self.free.iter().zip(radii.iter()) {
            all[unknown] = *radius;
        }
        all
    }
}
