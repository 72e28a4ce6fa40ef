//! Legs as chains of unit freedoms in the normalised frame: loop closure, ranks and displaced
//! poses.

use super::{MAX_FREEDOMS, MobilityError, absolute_values, frame};
use crate::group::screw::Screw;
use crate::group::subspace::Frame;
use crate::mechanism::Mechanism;
use crate::numeric::svd::{self, Svd};
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

/// The first-order kinematics in a pose, by singular values. A list of them is sorted, largest first, and divided by
/// its largest.
pub(crate) struct FirstOrder {
    /// Of all screws together.
    pub all: Vec<f64>,
    /// Of each leg's screws.
    pub legs: Vec<Vec<f64>>,
    /// Of the loop closure.
    pub closure: Vec<f64>,
    /// The right singular vectors of the loop closure, in the order of its singular values: the last ones are the
    /// motions.
    vectors: DMatrix<f64>,
}

impl FirstOrder {
    /// The motions `(q̇, t)`, orthonormal columns, of a mechanism that has this many.
    pub fn motions(&self, mobility: usize) -> DMatrix<f64> {
        let columns = self.vectors.ncols();
        self.vectors.columns(columns - mobility, mobility).into_owned()
    }
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

    /// The rows of the actuated freedoms among those of all freedoms.
    pub fn actuated_rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.actuated.len()).filter(|&row| self.actuated[row])
    }

    /// The singular values of the actuated freedoms' rates in motions that are orthonormal columns, largest first.
    pub fn controls(&self, motions: &DMatrix<f64>) -> Vec<f64> {
        let rows: Vec<usize> = self.actuated_rows().collect();
        absolute_values(motions.select_rows(&rows))
    }

    /// The unit screws of a pose, leg by leg.
    pub fn units(&self, pose: &Pose) -> Vec<Vec<Vector6<f64>>> {
        let unit = |screw: &Screw| screw.to_vector().normalize();
        pose.screws.iter().map(|leg| leg.iter().map(unit).collect()).collect()
    }

    /// The first-order kinematics in a pose.
    pub fn first_order(&self, pose: &Pose) -> FirstOrder {
        let units = self.units(pose);
        let closure = Svd::new(loop_closure(&units));
        let of = |vectors: &[Vector6<f64>]| {
            let mut values =
                svd::singular_values(DMatrix::from_fn(vectors.len(), 6, |i, j| vectors[i][j]));
            values.sort_by(|a, b| b.total_cmp(a));
            relative(values)
        };
        FirstOrder {
            all: of(&units.concat()),
            legs: units.iter().map(|leg| of(leg)).collect(),
            closure: relative(closure.values),
            vectors: closure.right,
        }
    }
}

/// Singular values, largest first, divided by the largest.
fn relative(values: Vec<f64>) -> Vec<f64> {
    let largest = values.first().copied().filter(|&v| v > 0.0).unwrap_or(1.0);
    values.into_iter().map(|value| value / largest).collect()
}

impl Pose {
    /// The displacement of the platform that each leg gives.
    pub fn tips(&self) -> impl Iterator<Item = &Isometry3<f64>> {
        self.tips.iter()
    }

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
