//! Legs as chains of unit freedoms in the normalised frame: loop closure, ranks and displaced
//! poses.

use super::{MAX_FREEDOMS, MobilityError, absolute_values, frame};
use crate::group::screw::Screw;
use crate::group::subspace::Frame;
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use crate::numeric::svd::{self, Svd};
use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, Vector6};

/// A mechanism as screws in its normalised frame: freedom by freedom, leg by leg.
pub(super) struct Linkage {
    pub frame: Frame,
    /// For every freedom, leg by leg, whether it is actuated.
    pub actuated: Vec<bool>,
    /// The normalised screws at home.
    legs: Vec<Vec<Screw>>,
    /// Of every freedom, whether it turns back what the one before it turned.
    backs: Vec<Vec<bool>>,
}

/// The screws of every leg in a pose, and the displacement of the platform that each leg gives.
pub(super) struct Pose {
    screws: Vec<Vec<Screw>>,
    /// The screw of every freedom that moves by itself: one for the two hinges of a parallelogram.
    moving: Vec<Vec<Moving>>,
    tips: Vec<Isometry3<f64>>,
}

/// A freedom that moves by itself, with the one that turns it back, if there is one.
#[derive(Clone, Copy)]
struct Moving {
    screw: Screw,
    /// Its number in the leg; that of the one that turns it back is the next.
    freedom: usize,
    is_turned_back: bool,
}

impl Moving {
    /// The freedoms of a leg that move by themselves, where these are all its screws in a pose.
    fn of(screws: &[Screw], backs: &[bool]) -> Vec<Self> {
        let mut moving: Vec<Self> = Vec::new();
        for (freedom, (screw, back)) in screws.iter().zip(backs).enumerate() {
            match moving.last_mut().filter(|_| *back) {
                Some(first) => {
                    *first = Self { screw: first.screw - *screw, is_turned_back: true, ..*first };
                }
                None => moving.push(Self { screw: *screw, freedom, is_turned_back: false }),
            }
        }
        moving
    }

    /// The rates of its freedoms for a rate of one, with their numbers in the leg.
    fn rates(&self) -> impl Iterator<Item = (usize, f64)> {
        let back = self.is_turned_back.then_some((self.freedom + 1, -1.0));
        [(self.freedom, 1.0)].into_iter().chain(back)
    }
}

/// The first-order kinematics in a pose, leg by leg.
pub(super) struct FirstOrder {
    /// The singular values of all screws together, largest first, divided by the largest.
    pub all: Vec<f64>,
    legs: Vec<LegOrder>,
}

/// The unit screws `J` of a leg as `Jᵀ U = V Σ`: the platform's twists `U`, and the rates `V` that give them.
struct LegOrder {
    svd: Svd,
    /// The singular values, divided by the largest.
    values: Vec<f64>,
    /// The rates of all unit screws of the leg for those of the ones that move by themselves; `None` where all of them do.
    spread: Option<DMatrix<f64>>,
}

impl LegOrder {
    fn new(screws: &[Screw], moving: &[Moving]) -> Self {
        let unit = |moving: &Moving| moving.screw.to_vector().normalize();
        let svd = Svd::new(rows(&moving.iter().map(unit).collect::<Vec<_>>()));
        let spread = (moving.len() < screws.len()).then(|| {
            let mut spread = DMatrix::zeros(screws.len(), moving.len());
            for (column, moving) in moving.iter().enumerate() {
                let size = moving.screw.to_vector().norm();
                for (row, rate) in moving.rates() {
                    spread[(row, column)] = rate * screws[row].to_vector().norm() / size;
                }
            }
            spread
        });
        Self { values: relative(&svd.values[..moving.len().min(6)]), svd, spread }
    }

    /// The number of freedoms of its joints.
    fn freedoms(&self) -> usize {
        self.spread.as_ref().map_or(self.svd.image.nrows(), DMatrix::nrows)
    }

    /// Rates of all unit screws by those of the ones that move by themselves.
    fn spread(&self, rates: DMatrix<f64>) -> DMatrix<f64> {
        match &self.spread {
            Some(spread) => spread * rates,
            None => rates,
        }
    }
}

fn rows(vectors: &[Vector6<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(vectors.len(), 6, |i, j| vectors[i][j])
}

/// The constraints of all legs on the platform's twist: orthonormal rows for each leg.
pub(super) struct Ties {
    svd: Svd,
}

impl FirstOrder {
    /// The singular values of each leg's screws, largest first, divided by the largest.
    pub fn legs(&self) -> impl Iterator<Item = &[f64]> {
        self.legs.iter().map(|leg| &*leg.values)
    }

    /// The number of freedoms of all joints.
    pub fn freedoms(&self) -> usize {
        self.legs.iter().map(LegOrder::freedoms).sum()
    }

    /// The constraints of all legs, whose screws have these ranks.
    pub fn ties(&self, ranks: &[usize]) -> Ties {
        let constraints =
            |(leg, &rank): (&LegOrder, &usize)| leg.svd.right.columns(rank, 6 - rank).transpose();
        let all: Vec<DMatrix<f64>> = self.legs.iter().zip(ranks).map(constraints).collect();
        let mut rows = DMatrix::zeros(all.iter().map(DMatrix::nrows).sum(), 6);
        let mut row = 0;
        for own in &all {
            rows.rows_mut(row, own.nrows()).copy_from(own);
            row += own.nrows();
        }
        Ties { svd: Svd::new(rows) }
    }

    /// The motions `(q̇, t)` with `J_k q̇_k = t` for every leg: orthonormal columns. The platform's twists are those that
    /// all legs allow, whose screws have these ranks, and whose constraints have rank `tied`. Then come the motions
    /// within each leg.
    pub fn motions(&self, ranks: &[usize], ties: &Ties, tied: usize) -> DMatrix<f64> {
        let freedoms = self.freedoms();
        let twists = ties.svd.right.columns(tied, 6 - tied);
        let mut moved = DMatrix::zeros(freedoms + 6, twists.ncols());
        let mut within = vec![];
        let mut row = 0;
        for (leg @ LegOrder { svd, .. }, &rank) in self.legs.iter().zip(ranks) {
            let mut rates = DMatrix::zeros(svd.image.nrows(), twists.ncols());
            for i in 0..rank {
                // The column of the image is a unit vector times the singular value.
                let shares = svd.right.column(i).tr_mul(&twists) / svd.values[i].powi(2);
                rates.ger(1.0, &svd.image.column(i), &shares.transpose(), 1.0);
            }
            moved.rows_mut(row, leg.freedoms()).copy_from(&leg.spread(rates));
            if svd.image.nrows() > rank {
                let own = complement(svd.image.columns(0, rank).into_owned());
                within.push((row, leg.spread(own)));
            }
            row += leg.freedoms();
        }
        moved.rows_mut(freedoms, 6).copy_from(&twists);
        let mut all = match moved.ncols() {
            0 => moved,
            _ => moved.qr().q(),
        };
        for (row, own) in within {
            let column = all.ncols();
            all = all.resize_horizontally(column + own.ncols(), 0.0);
            all.view_mut((row, column), own.shape()).copy_from(&own);
        }
        // Rates of two hinges for one make lengths and angles others.
        let is_spread = self.legs.iter().any(|leg| leg.spread.is_some());
        if is_spread && all.ncols() > 0 { all.qr().q() } else { all }
    }
}

impl Ties {
    /// The singular values, largest first. Their natural size is one.
    pub fn values(&self) -> &[f64] {
        &self.svd.values
    }
}

/// Orthonormal columns across independent columns.
fn complement(columns: DMatrix<f64>) -> DMatrix<f64> {
    let (n, rank) = columns.shape();
    let mut all = DMatrix::identity(n, n);
    if rank > 0 {
        columns.qr().q_tr_mul(&mut all);
    }
    all.rows(rank, n - rank).transpose()
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
            backs: mechanism.legs.iter().map(Leg::turn_back).collect(),
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
        let (mut screws, mut moving, mut tips) = (vec![], vec![], vec![]);
        for (leg, backs) in self.legs.iter().zip(&self.backs) {
            let mut tip = Isometry3::identity();
            let mut moved = vec![];
            for (screw, amount) in leg.iter().zip(&mut coordinates) {
                moved.push(screw.transformed(&tip));
                tip *= screw.exp(*amount);
            }
            moving.push(Moving::of(&moved, backs));
            screws.push(moved);
            tips.push(tip);
        }
        Pose { screws, moving, tips }
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

    /// The first-order kinematics in a pose.
    pub fn first_order(&self, pose: &Pose) -> FirstOrder {
        let unit = |moving: &Moving| moving.screw.to_vector().normalize();
        let units: Vec<Vector6<f64>> = pose.moving.iter().flatten().map(unit).collect();
        let mut all = svd::singular_values(rows(&units));
        all.sort_by(|a, b| b.total_cmp(a));
        let legs = pose.screws.iter().zip(&pose.moving);
        FirstOrder {
            all: relative(&all),
            legs: legs.map(|(screws, moving)| LegOrder::new(screws, moving)).collect(),
        }
    }

    /// Motions of unit screws in a pose, which are columns, as rates of the coordinates.
    pub fn rates(&self, pose: &Pose, mut motions: DMatrix<f64>) -> DMatrix<f64> {
        for (row, screw) in pose.screws.iter().flatten().enumerate() {
            motions.row_mut(row).unscale_mut(screw.to_vector().norm());
        }
        motions
    }
}

/// Singular values, largest first, divided by the largest.
fn relative(values: &[f64]) -> Vec<f64> {
    let largest = values.first().copied().filter(|&v| v > 0.0).unwrap_or(1.0);
    values.iter().map(|value| value / largest).collect()
}

impl Pose {
    /// The displacement of the platform that each leg gives.
    pub fn tips(&self) -> impl Iterator<Item = &Isometry3<f64>> {
        self.tips.iter()
    }

    /// The difference between each leg's displacement and that of the platform: one twist (six
    /// rows) per leg, to first order.
    pub fn gaps(&self, platform: &Isometry3<f64>) -> DVector<f64> {
        let gap = |tip: &Isometry3<f64>| {
            let error = tip * platform.inverse();
            Screw { angular: error.rotation.scaled_axis(), linear: error.translation.vector }
        };
        let twists: Vec<f64> =
            self.tips.iter().flat_map(|tip| gap(tip).to_vector().data.0[0]).collect();
        twists.into()
    }

    /// The rates `q̇` and the twist `t` of the platform that make `|J_k q̇_k - t + g_k|² + damping (|q̇|² + |t|²)` least, summed
    /// over the legs, whose gaps are `g`: a Levenberg-Marquardt step. `None` if it is lost in rounding.
    ///
    /// With `M_k = (J_k J_kᵀ + damping)⁻¹`, each leg answers `q̇_k = J_kᵀ M_k (t - g_k)`, and the rest is six equations:
    /// `(Σ M_k + 1) t = Σ M_k g_k`.
    pub fn step(&self, gaps: &DVector<f64>, damping: f64) -> Option<(DVector<f64>, Vector6<f64>)> {
        let columns = |leg: &Vec<Moving>| -> Vec<Vector6<f64>> {
            leg.iter().map(|moving| moving.screw.to_vector()).collect()
        };
        let factors = |leg: &Vec<Vector6<f64>>| {
            let own = Matrix6::from_diagonal_element(damping);
            leg.iter().fold(own, |sum, column| sum + column * column.transpose()).cholesky()
        };
        let legs: Vec<_> = self.moving.iter().map(columns).collect();
        let factors: Vec<_> = legs.iter().map(factors).collect::<Option<_>>()?;
        let gap = |leg: usize| Vector6::from(gaps.fixed_rows::<6>(6 * leg));
        let (mut sum, mut right) = (Matrix6::identity(), Vector6::zeros());
        for (leg, own) in factors.iter().enumerate() {
            sum += own.inverse();
            right += own.solve(&gap(leg));
        }
        let twist = sum.cholesky()?.solve(&right);
        let rates = legs.iter().zip(&factors).enumerate().flat_map(|(leg, (columns, own))| {
            let force = own.solve(&(twist - gap(leg)));
            let moving = self.moving[leg].iter().zip(columns);
            moving.flat_map(move |(moving, column)| {
                moving.rates().map(move |(_, rate)| rate * column.dot(&force))
            })
        });
        Some((DVector::from_vec(rates.collect()), twist))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::samples;

    /// The derivative of [`Pose::gaps`] by the coordinates and by a twist of the platform: six rows for each leg.
    fn derivative(pose: &Pose) -> DMatrix<f64> {
        let freedoms: usize = pose.screws.iter().map(Vec::len).sum();
        let mut closure = DMatrix::zeros(6 * pose.screws.len(), freedoms + 6);
        let mut column = 0;
        for (k, leg) in pose.screws.iter().enumerate() {
            for screw in leg {
                closure.fixed_view_mut::<6, 1>(6 * k, column).copy_from(&screw.to_vector());
                column += 1;
            }
            closure.fixed_view_mut::<6, 6>(6 * k, freedoms).fill_diagonal(-1.0);
        }
        closure
    }

    /// The error of central differences with step 1e-6 is its square, plus rounding divided by it.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn derivative_of_the_gaps_is_what_differences_give() {
        let mechanism = samples::PlanoSpherical::default().mechanism();
        let linkage = Linkage::new(&mechanism).unwrap();
        let n = linkage.actuated.len();
        // The formula holds where the legs meet: at home.
        let derivative = derivative(&linkage.home());
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

    /// Two solutions of equations whose condition is one over the damping.
    const STEP: f64 = 1e-10;

    #[test]
    fn step_solves_the_damped_normal_equations() {
        let mechanism = samples::PlanoSpherical::default().mechanism();
        let linkage = Linkage::new(&mechanism).unwrap();
        let n = linkage.actuated.len();
        let coordinates: Vec<f64> = (0..n).map(|i| 0.3 * (i as f64).sin()).collect();
        let pose = linkage.pose(&coordinates);
        let gaps = pose.gaps(&Isometry3::translation(0.1, -0.2, 0.05));
        for damping in [1e-3, 0.1, 2.0] {
            let derivative = derivative(&pose);
            let normal = derivative.tr_mul(&derivative)
                + DMatrix::from_diagonal_element(n + 6, n + 6, damping);
            let expected = normal.lu().solve(&-derivative.tr_mul(&gaps)).unwrap();
            let (rates, twist) = pose.step(&gaps, damping).unwrap();
            assert!((rates - expected.rows(0, n)).amax() < STEP);
            assert!((twist - expected.rows(n, 6)).amax() < STEP);
        }
    }
}
