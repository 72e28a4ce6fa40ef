//! Legs as chains of unit freedoms in the normalised frame: loop closure, ranks and displaced
//! poses.

use super::{MAX_FREEDOMS, MobilityError, frame};
use crate::group::screw::Screw;
use crate::group::subspace::Frame;
use crate::mechanism::Mechanism;
use crate::numeric::svd;
use nalgebra::{DMatrix, Isometry3, Vector6};

/// A mechanism as screws in its normalised frame: freedom by freedom, leg by leg.
pub(crate) struct Linkage {
    pub frame: Frame,
    /// For every freedom, leg by leg, whether it is actuated.
    pub actuated: Vec<bool>,
    /// The normalised screws at home.
    legs: Vec<Vec<Screw>>,
}

/// The screws of every leg in a pose, and the displacement of the platform that each leg gives.
pub(crate) struct Pose {
    screws: Vec<Vec<Screw>>,
    tips: Vec<Isometry3<f64>>,
}

/// The ranks of the first-order kinematics in a pose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ranks {
    /// Dimension of the span of all screws.
    pub lambda: usize,
    /// The number of independent first-order motions.
    pub mobility: usize,
    /// The number of independent first-order motions with the actuators locked.
    pub locked: usize,
    /// Dimension of the span of each leg's screws.
    pub legs: Vec<usize>,
}

/// The loop-closure matrix of unit screws: six rows per leg, one column per screw (leg by leg), and
/// six columns for the platform's twist. Its kernel is the set of first-order motions `(q̇, t)`
/// with `J_k q̇_k − t = 0`. No leg is singled out, so a permutation of the legs only permutes rows
/// and columns.
pub(crate) fn loop_closure(legs: &[Vec<Vector6<f64>>]) -> DMatrix<f64> {
    let freedoms: usize = legs.iter().map(Vec::len).sum();
    let mut closure = DMatrix::zeros(6 * legs.len(), freedoms + 6);
    let mut column = 0;
    for (k, leg) in legs.iter().enumerate() {
        for screw in leg {
            closure.fixed_view_mut::<6, 1>(6 * k, column).copy_from(screw);
            column += 1;
        }
        closure.fixed_view_mut::<6, 6>(6 * k, freedoms).fill_diagonal(-1.0);
    }
    closure
}

impl Linkage {
    pub fn new(mechanism: &Mechanism) -> Result<Self, MobilityError> {
        if mechanism.legs.len() < 2 {
            let (mechanism, legs) = (mechanism.name.clone(), mechanism.legs.len());
            return Err(MobilityError::TooFewLegs { mechanism, legs });
        }
        for leg in &mechanism.legs {
            if leg.joints.is_empty() {
                return Err(MobilityError::EmptyLeg { leg: leg.name.clone() });
            }
            for joint in &leg.joints {
                let finite = |s: &Screw| s.to_vector().norm_squared().is_finite();
                if !joint.screws().iter().all(finite) || !joint.point.coords.norm().is_finite() {
                    let (leg, joint) = (leg.name.clone(), joint.name.clone());
                    return Err(MobilityError::NotFinite { leg, joint });
                }
            }
        }
        let freedoms = mechanism.coordinates().count();
        if freedoms > MAX_FREEDOMS {
            return Err(MobilityError::TooLarge { freedoms });
        }
        let frame = frame(mechanism);
        let normalised = |screw: &Screw| frame.normalised(screw);
        Ok(Self {
            frame,
            actuated: mechanism
                .joints()
                .flat_map(|joint| std::iter::repeat_n(joint.actuated, joint.freedoms()))
                .collect(),
            legs: mechanism
                .legs
                .iter()
                .map(|leg| leg.screws().iter().map(normalised).collect())
                .collect(),
        })
    }

    /// The pose with all coordinates zero.
    pub fn home(&self) -> Pose {
        self.pose(&vec![0.0; self.actuated.len()])
    }

    /// The pose at given coordinates (radians, and lengths in the frame's unit), whether it closes
    /// or not.
    pub fn pose(&self, coordinates: &[f64]) -> Pose {
        let mut coordinates = coordinates.iter();
        let (mut screws, mut tips) = (vec![], vec![]);
        for leg in &self.legs {
            let mut tip = Isometry3::identity();
            let mut moved = vec![];
            for (screw, amount) in leg.iter().zip(&mut coordinates) {
                moved.push(screw.transformed(&tip));
                tip *= screw.exp(*amount);
            }
            screws.push(moved);
            tips.push(tip);
        }
        Pose { screws, tips }
    }

    /// The unit screws of a pose, leg by leg.
    pub fn units(&self, pose: &Pose) -> Vec<Vec<Vector6<f64>>> {
        let unit = |screw: &Screw| screw.to_vector().normalize();
        pose.screws.iter().map(|leg| leg.iter().map(unit).collect()).collect()
    }

    /// The unit screws of the passive freedoms, leg by leg.
    pub fn passive(&self, units: &[Vec<Vector6<f64>>]) -> Vec<Vec<Vector6<f64>>> {
        let mut actuated = self.actuated.iter();
        let keep = |leg: &Vec<Vector6<f64>>| {
            leg.iter().zip(&mut actuated).filter(|(_, a)| !**a).map(|(unit, _)| *unit).collect()
        };
        units.iter().map(keep).collect()
    }

    /// The ranks in a pose. Singular values below `tolerance` of the largest count as zero.
    pub fn ranks(&self, pose: &Pose, tolerance: f64) -> Ranks {
        let units = self.units(pose);
        let nullity = |legs: &[Vec<Vector6<f64>>]| {
            let closure = loop_closure(legs);
            let columns = closure.ncols();
            columns - svd::rank(closure, tolerance)
        };
        Ranks {
            lambda: rank(&units.concat(), tolerance),
            mobility: nullity(&units),
            locked: nullity(&self.passive(&units)),
            legs: units.iter().map(|leg| rank(leg, tolerance)).collect(),
        }
    }
}

fn rank(vectors: &[Vector6<f64>], tolerance: f64) -> usize {
    svd::rank(DMatrix::from_fn(vectors.len(), 6, |i, j| vectors[i][j]), tolerance)
}

impl Pose {
    /// The difference between each leg's displacement and that of the platform: one twist (six
    /// rows) per leg, to first order.
    pub fn gaps(&self, platform: &Isometry3<f64>) -> nalgebra::DVector<f64> {
        let gap = |tip: &Isometry3<f64>| {
            let error = tip * platform.inverse();
            Screw { angular: error.rotation.scaled_axis(), linear: error.translation.vector }
        };
        let twists: Vec<f64> =
            self.tips.iter().flat_map(|tip| gap(tip).to_vector().data.0[0]).collect();
        twists.into()
    }

    /// The derivative of [`Pose::gaps`] by the coordinates and by a twist of the platform.
    pub fn derivative(&self) -> DMatrix<f64> {
        let vectors = |leg: &Vec<Screw>| leg.iter().map(|s| s.to_vector()).collect();
        loop_closure(&self.screws.iter().map(vectors).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::samples;

    /// The error of central differences with step 1e-6 is its square, plus rounding divided by it.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn derivative_of_the_gaps_is_what_differences_give() {
        let mechanism = samples::PlanoSpherical::default().mechanism();
        let linkage = Linkage::new(&mechanism).unwrap();
        let n = linkage.actuated.len();
        // The formula holds where the legs meet: at home.
        let derivative = linkage.home().derivative();
        let step = 1e-6;
        for column in 0..n + 6 {
            let side = |sign: f64| {
                let mut q = vec![0.0; n];
                let mut twist = Vector6::zeros();
                if column < n {
                    q[column] = sign * step;
                } else {
                    twist[column - n] = sign * step;
                }
                linkage.pose(&q).gaps(&Screw::from_vector(&twist).exp(1.0))
            };
            let difference = (side(1.0) - side(-1.0)) / (2.0 * step);
            assert!((difference - derivative.column(column)).amax() < DIFFERENCE, "{column}");
        }
    }
}
