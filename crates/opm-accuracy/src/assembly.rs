//! Mechanisms that are made with errors and assembled: what happens beyond first order.
//!
//! The actuators hold their values. Of all plays with which the legs close, those are found whose sum of squares is least, by
//! Lagrange's method: with the motions `z` of the platform and the passive joints, plays `p`, and closure `c(z, p) = 0`
//! that is linearised anew in each step (J. Nocedal, S. Wright, *Numerical Optimization*, 2006, section 18.1),
//!
//! ```text
//! A Δz + B p = B p₀ - c₀        p = -Bᵀ λ        Aᵀ λ = 0
//! ```
//!
//! The play of a joint is a displacement of all that it carries: a rotation about the place of the joint's point at the
//! nominal pose, and a translation. It has no part along what the joint allows there.

use crate::chain::{Chain, at_point, by_rotation_vector, difference, displaced, from_point, unit};
use crate::inverse::PseudoInverse;
use crate::made::Made;
use crate::response::{Model, across};
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix6, Matrix6xX, Point3, Translation3, Vector3, Vector6,
};
use opm_core::group::screw::Screw;
use opm_core::manipulator::{Mode, Solution};
use opm_core::velocity::VelocityError;

/// Most steps. Errors that are small beside the mechanism take three or four.
const MOST_STEPS: usize = 40;
/// Steps below this are rounding; radians and characteristic lengths.
const SETTLED: f64 = 1e-13;
/// What motions cost beside plays. It only decides those that move nothing else.
const FREE: f64 = 1e-10;

/// Assembles a mechanism with errors near one pose.
#[derive(Clone, Debug)]
pub struct Assembler<'m> {
    model: &'m Model<'m>,
    mode: Mode,
    pose: Vec<f64>,
    joints: Vec<f64>,
    passive: Vec<usize>,
    /// The displacement of the platform, and where its reference point is.
    nominal: Isometry3<f64>,
    reference: Point3<f64>,
    weight: Matrix6<f64>,
    plays: Vec<JointPlay>,
    /// The twists for unit rates of the task coordinates, weighted.
    by_pose: DMatrix<f64>,
    /// Whether these can be told apart.
    regular: bool,
}

/// Where a joint gives way.
#[derive(Clone, Debug)]
struct JointPlay {
    leg: usize,
    point: Point3<f64>,
    /// The projection to what it does not allow, with lengths over the characteristic length.
    across: Matrix6<f64>,
}

/// A mechanism with errors, assembled.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembled {
    /// The changes of the task coordinates, radians and metres; NaN where they are not determined.
    pub coordinates: Vec<f64>,
    /// The rotation vector of the platform, radians, and the displacement of its reference point, metres; base axes.
    pub platform: Vector6<f64>,
    /// The play of each joint, leg by leg: a rotation vector, and the displacement of the joint's point.
    pub plays: Vec<Vector6<f64>>,
}

impl<'m> Assembler<'m> {
    /// Near a solved pose, in the working mode that it was solved in.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn new(model: &'m Model<'m>, at: &Solution, mode: Mode) -> Result<Self, VelocityError> {
        let (manipulator, length) = (model.manipulator(), model.length());
        let mut jacobians = manipulator.jacobians();
        manipulator.differentiate(at, &mut jacobians)?;
        let mut twists: Matrix6xX<f64> = manipulator.twist_by_pose(&jacobians);
        twists.rows_mut(3, 3).unscale_mut(length);
        for (mut column, c) in twists.column_iter_mut().zip(manipulator.task_coordinates()) {
            column.scale_mut(unit(c.quantity, length));
        }
        let nominal = at.displacement(manipulator);
        let chains = Chain::all(manipulator.mechanism(), at.joints());
        let plays = chains.iter().enumerate().flat_map(|(leg, chain)| {
            chain.joints.iter().map(move |joint| JointPlay {
                leg,
                point: joint.point,
                across: across(&joint.screws, &at_point(&joint.point, length)),
            })
        });
        let actuated = manipulator.actuated();
        Ok(Self {
            model,
            mode,
            pose: at.pose().to_vec(),
            joints: at.joints().to_vec(),
            passive: (0..at.joints().len()).filter(|i| !actuated.contains(i)).collect(),
            reference: nominal * manipulator.mechanism().platform,
            nominal,
            weight: model.weight(at),
            plays: plays.collect(),
            regular: twists.iter().all(|number| number.is_finite()),
            by_pose: DMatrix::from_fn(6, twists.ncols(), |i, j| twists[(i, j)]),
        })
    }

    /// The mechanism with an error for each source of the model, radians and metres; `None` if it cannot be assembled near
    /// the pose.
    ///
    /// # Panics
    /// If there is not one error for each source.
    pub fn assemble(&self, errors: &[f64]) -> Option<Assembled> {
        assert_eq!(errors.len(), self.model.sources().len(), "one error for each source");
        let made = Made::new(self.model, errors)?;
        let length = self.model.length();
        let coordinates = self.model.manipulator().coordinates();
        let mut joints = self.joints.clone();
        for &(number, error) in &made.actuators {
            joints[number] += error;
        }
        let mut platform = Isometry3::identity();
        let mut plays = DVector::zeros(6 * self.plays.len());
        let (motions, rows) = (6 + self.passive.len(), 6 * made.mechanism.legs.len());
        for _ in 0..MOST_STEPS {
            let Closure { residual, moving, play } =
                self.closure(&made, &joints, &platform, &plays);
            let mut system = DMatrix::zeros(motions + rows, motions + rows);
            system.view_mut((0, 0), (motions, motions)).fill_diagonal(FREE);
            system.view_mut((0, motions), (motions, rows)).copy_from(&moving.transpose());
            system.view_mut((motions, 0), (rows, motions)).copy_from(&moving);
            system
                .view_mut((motions, motions), (rows, rows))
                .copy_from(&-(&play * play.transpose()));
            let mut right = DVector::zeros(motions + rows);
            right.rows_mut(motions, rows).copy_from(&(&play * &plays - residual));
            let solved = system.lu().solve(&right)?;
            let next = -play.tr_mul(&solved.rows(motions, rows));
            let step = solved.rows(0, motions);
            let largest = step.amax().max((&next - &plays).amax());
            if !largest.is_finite() {
                return None;
            }
            let way = step.fixed_rows::<3>(3) * length;
            platform = displaced(step.fixed_rows::<3>(0).into(), &self.reference, way) * platform;
            for (&number, step) in self.passive.iter().zip(step.iter().skip(6)) {
                joints[number] += step * unit(coordinates[number].quantity, length);
            }
            plays = next;
            if largest < SETTLED {
                return Some(self.assembled(&platform, &plays));
            }
        }
        None
    }

    fn assembled(&self, platform: &Isometry3<f64>, plays: &DVector<f64>) -> Assembled {
        let length = self.model.length();
        let play = |number: usize| {
            let mut play = plays.fixed_rows::<6>(6 * number).into_owned();
            play.fixed_rows_mut::<3>(3).scale_mut(length);
            play
        };
        Assembled {
            coordinates: self.coordinates(platform),
            platform: difference(platform, &self.reference),
            plays: (0..self.plays.len()).map(play).collect(),
        }
    }

    /// The changes of the task coordinates with which the ideal platform comes nearest, by Newton's method with the nominal
    /// derivatives.
    fn coordinates(&self, platform: &Isometry3<f64>) -> Vec<f64> {
        let manipulator = self.model.manipulator();
        let all = manipulator.task_coordinates();
        let unknown = || vec![f64::NAN; all.len()];
        if !self.regular {
            return unknown();
        }
        let inverse = PseudoInverse::new(&self.by_pose);
        let goal = platform * self.nominal;
        let mut pose = self.pose.clone();
        for _ in 0..MOST_STEPS {
            let Ok(found) = manipulator.displacement_in(&pose, self.mode) else { return unknown() };
            let mut off = difference(&(goal * found.inverse()), &self.reference);
            off.fixed_rows_mut::<3>(3).unscale_mut(self.model.length());
            let step = inverse.solve(&DMatrix::from_column_slice(6, 1, off.as_slice()));
            for ((value, step), c) in pose.iter_mut().zip(step.iter()).zip(all) {
                *value += step * unit(c.quantity, self.model.length());
            }
            if step.amax() < SETTLED {
                break;
            }
        }
        let changes = pose.iter().zip(&self.pose).enumerate();
        changes.map(|(i, (a, b))| if inverse.determines(i) { a - b } else { f64::NAN }).collect()
    }

    /// The closure of all legs, and its derivatives.
    fn closure(
        &self,
        made: &Made,
        joints: &[f64],
        platform: &Isometry3<f64>,
        plays: &DVector<f64>,
    ) -> Closure {
        let length = self.model.length();
        let coordinates = self.model.manipulator().coordinates();
        let at = |mechanism: &opm_core::mechanism::Mechanism| {
            Isometry3::from(Translation3::from(mechanism.platform.coords))
        };
        let goal = platform * self.nominal * at(self.model.manipulator().mechanism());
        let chains = made.chains(joints);
        let rows = 6 * chains.len();
        let mut closure = Closure {
            residual: DVector::zeros(rows),
            moving: DMatrix::zeros(rows, 6 + self.passive.len()),
            play: DMatrix::zeros(rows, 6 * self.plays.len()),
        };
        let (mut column, mut coordinate, mut number) = (6, 0, 0);
        for (leg, chain) in chains.iter().enumerate() {
            let mut before = Isometry3::identity();
            for _ in &chain.joints {
                let joint = &self.plays[number];
                debug_assert_eq!(joint.leg, leg);
                let play = plays.fixed_rows::<6>(6 * number);
                let (w, way): (Vector3<f64>, Vector3<f64>) =
                    (play.fixed_rows::<3>(0).into(), play.fixed_rows::<3>(3) * length);
                // The twist of the displacement by its parameters: it rotates about where the point has gone to.
                let mut rates = Matrix6::identity();
                rates.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_rotation_vector(&w));
                let rates = from_point(&(joint.point + way), length) * rates * joint.across;
                let columns = self.weight * adjoint(&before) * rates;
                closure.play.fixed_view_mut::<6, 6>(6 * leg, 6 * number).copy_from(&columns);
                before *= displaced(w, &joint.point, way);
                number += 1;
            }
            closure.moving.fixed_view_mut::<6, 6>(6 * leg, 0).fill_with_identity();
            closure.moving.fixed_view_mut::<6, 6>(6 * leg, 0).neg_mut();
            for screw in chain.joints.iter().flat_map(|joint| &joint.screws) {
                if self.passive.binary_search(&coordinate).is_ok() {
                    let unit = unit(coordinates[coordinate].quantity, length);
                    let rates = self.weight * screw.transformed(&before).to_vector() * unit;
                    closure.moving.fixed_view_mut::<6, 1>(6 * leg, column).copy_from(&rates);
                    column += 1;
                }
                coordinate += 1;
            }
            let end = before * chain.end() * at(&made.mechanism);
            let mut off = difference(&(end * goal.inverse()), &self.reference);
            off.fixed_rows_mut::<3>(3).unscale_mut(length);
            closure.residual.fixed_rows_mut::<6>(6 * leg).copy_from(&off);
        }
        closure
    }
}

/// The closure of all legs by motions and plays.
struct Closure {
    residual: DVector<f64>,
    moving: DMatrix<f64>,
    play: DMatrix<f64>,
}

/// The matrix that displaces twists `(ω; v)`.
fn adjoint(g: &Isometry3<f64>) -> Matrix6<f64> {
    let unit = |k: usize| {
        let mut twist = Vector6::zeros();
        twist[k] = 1.0;
        let screw = Screw {
            angular: twist.fixed_rows::<3>(0).into(),
            linear: twist.fixed_rows::<3>(3).into(),
        };
        screw.transformed(g).to_vector()
    };
    Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(unit))
}
