//! How far a pose is from a singularity: condition number and manipulability.

use super::weighted::{Metric, Weighted};
use super::{Jacobians, SingularCause, SingularLeg};
use crate::manipulator::Manipulator;
use nalgebra::{DMatrix, Vector3};

/// A singular value below this share of the largest counts as zero: the rounding of the few dozen operations
/// that lead to it.
const RANK: f64 = 1e-13;

/// The conditioning of the actuated joints' Jacobian by the platform's twist.
///
/// The velocity of the platform's reference point and the rates of sliders are divided by the
/// characteristic length. So both numbers have no unit. They do not depend on the coordinates that the
/// pose is written in, on where the mechanism stands, nor on how large it is.
///
/// In a five-bar the platform is one of the forearms, and its rotation follows from where the hand is. Then the velocity
/// of a point stands for the platform's twist, so that both arms are seen alike: of the reference point in a plane, and
/// on the axis of the joint that joins the forearms on a sphere. More exactly, these are the mechanisms in one planar
/// subspace whose pose is `x` and `y` alone, and those of two driven legs in one spherical subspace with two freedoms.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mut buffer, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
/// // Home, where the Euler angles are singular: the conditioning does not depend on them.
/// let pose = manipulator.pose([])?;
/// let at = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
/// manipulator.differentiate(at.expect("home is in reach"), &mut jacobians)?;
/// let length = manipulator.characteristic_length();
/// let conditioning = manipulator.conditioning(&jacobians, length);
/// assert!(conditioning.condition >= 1.0 && conditioning.condition.is_finite());
/// assert!(conditioning.manipulability > 0.0 && conditioning.manipulability.is_finite());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// The largest over the smallest singular value, which is at least one: how unevenly joint rates move
    /// the platform. It is infinite at a serial or parallel singularity, and if fewer joints are actuated
    /// than the platform has degrees of freedom. If there are more, all of them count.
    pub condition: f64,
    /// The inverse of the product of the singular values: the volume of the platform's twists for unit
    /// rates of the actuated joints (Yoshikawa's measure). Zero at a serial singularity, infinite at a
    /// parallel one.
    pub manipulability: f64,
}

impl Conditioning {
    /// The conditioning at a serial singularity.
    pub(super) const SERIAL: Self = Self { condition: f64::INFINITY, manipulability: 0.0 };
    /// The conditioning at a parallel singularity.
    const PARALLEL: Self = Self { condition: f64::INFINITY, manipulability: f64::INFINITY };

    /// The conditioning for the extreme singular values and the product of all.
    #[inline(always)]
    pub(super) fn of_values(largest: f64, smallest: f64, product: f64) -> Self {
        // The pose is so far away that squares overflow.
        if !product.is_finite() || !largest.is_finite() {
            return Self::SERIAL;
        }
        if smallest <= RANK * largest {
            return Self::PARALLEL;
        }
        Self { condition: largest / smallest, manipulability: product.recip() }
    }
}

impl Manipulator {
    /// How well conditioned the actuated joints' Jacobian is at the pose of `jacobians`. The
    /// characteristic `length`, metres, is usually [`Manipulator::characteristic_length`]. Nothing is
    /// allocated.
    ///
    /// # Panics
    /// If the length is not a positive number.
    pub fn conditioning(&self, jacobians: &Jacobians, length: f64) -> Conditioning {
        assert!(
            length > 0.0 && length.is_finite(),
            "the characteristic length is {length} m, expected a positive number"
        );
        // The rotation vector of a spherical joint is singular after a full revolution. That does not matter
        // to the platform unless the joint is actuated.
        let serial = |singular: &SingularLeg| {
            singular.cause == SingularCause::Serial
                || self.rateless(singular).any(|c| self.actuated().contains(&c))
        };
        if jacobians.singular.iter().any(serial) {
            return Conditioning::SERIAL;
        }
        match jacobians.platform.ncols() {
            1 => self.weighted_conditioning::<1>(jacobians, length),
            2 => self.weighted_conditioning::<2>(jacobians, length),
            3 => self.weighted_conditioning::<3>(jacobians, length),
            4 => self.weighted_conditioning::<4>(jacobians, length),
            5 => self.weighted_conditioning::<5>(jacobians, length),
            _ => self.weighted_conditioning::<6>(jacobians, length),
        }
    }

    /// The same for `N` degrees of freedom, away from serial singularities.
    fn weighted_conditioning<const N: usize>(
        &self,
        jacobians: &Jacobians,
        length: f64,
    ) -> Conditioning {
        let entries = |matrix: &DMatrix<f64>, row: usize| {
            std::array::from_fn(|column| [matrix[(row, column)]])
        };
        let mut platform: [[[f64; 1]; 6]; N] =
            std::array::from_fn(|i| std::array::from_fn(|k| [jacobians.platform[(k, i)]]));
        let scale = length.recip();
        if let Some(offset) = &self.judged_at {
            of_point(&mut platform, offset, &entries(&jacobians.locked, 0), scale);
        }
        let metric = Metric::<N, 1>::new(&platform, scale);
        let mut weighted = Weighted::new(&metric);
        for &coordinate in self.actuated() {
            let quantity = self.coordinates()[coordinate].quantity;
            weighted.push(entries(&jacobians.joints, coordinate), quantity);
        }
        let locked = (0..jacobians.locked.nrows()).map(|row| entries(&jacobians.locked, row));
        let [found] = weighted.conditioning(locked);
        found
    }
}

/// Turns the platform's twists `(ω; v)` for the components of the section twist into what stands for them: the velocity of
/// a point. With the rate of the joint that the constraining leg lacks beside it, all components count. That rate is zero
/// wherever the platform can move, so that its scale does not matter; it is that of the velocities.
#[inline(always)]
pub(super) fn of_point<const N: usize, const L: usize>(
    platform: &mut [[[f64; L]; 6]; N],
    offset: &Vector3<f64>,
    locked: &[[f64; L]; N],
    scale: f64,
) {
    for lane in 0..L {
        let (mut velocities, mut rates) = (0.0, 0.0);
        for (column, locked) in platform.iter_mut().zip(locked) {
            let of = |first: usize| Vector3::from_fn(|k, _| column[first + k][lane]);
            let velocity = of(3) + of(0).cross(offset);
            let all = [locked[lane], 0.0, 0.0, velocity.x, velocity.y, velocity.z];
            column.iter_mut().zip(all).for_each(|(to, value)| to[lane] = value);
            velocities += velocity.norm_squared();
            rates += locked[lane] * locked[lane];
        }
        let weight = scale * (velocities / rates).sqrt();
        platform.iter_mut().for_each(|column| column[0][lane] *= weight);
    }
}
