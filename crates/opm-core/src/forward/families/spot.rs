//! Places on families, with the directions along them.

use super::{BENT, KERNEL};
use crate::forward::certified::{Legs, free};
use crate::manipulator::Manipulator;
use crate::numeric::svd::{Svd, rank};
use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Isometry3};

/// A place on a family, with the directions along it and across.
pub struct Spot {
    pub joints: Vec<f64>,
    legs: Legs,
    pub free: Vec<usize>,
    pub along: DMatrix<f64>,
    pub across: DMatrix<f64>,
    /// Whether some of the kernel is not along the family.
    pub multiple: bool,
}

/// A step of Newton's method that is short where equations depend on each other (Levenberg and Marquardt).
pub fn damped(jacobian: &DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    let n = jacobian.ncols();
    let damping = 1e-14 + 1e-3 * values.norm_squared();
    let normal = jacobian.tr_mul(jacobian) + DMatrix::identity(n, n) * damping;
    Some(-normal.cholesky()?.solve(&jacobian.tr_mul(values)))
}

impl Spot {
    /// Joints from which the legs can move, with the directions. `idle` counts the joints of each leg that are held where they are.
    pub fn new(
        (m, idle): (&Manipulator, &[usize]),
        joints: &[f64],
        place: &Isometry3<f64>,
    ) -> Option<Self> {
        let legs = Legs::new(m, joints, place, 0.0);
        let free = free(&legs, idle);
        let still = DVector::zeros(legs.coordinates.len());
        let at = legs.at(&still, &still);
        let svd = Svd::new(at.jacobian[0].select_columns(&free));
        let rank = svd.rank(KERNEL);
        let across = svd.right.columns(0, rank).into_owned();
        let along = svd.right.columns(rank, free.len() - rank).into_owned();
        let joints = joints.to_vec();
        at.near.then_some(Self { joints, legs, free, along, across, multiple: false })
    }

    /// The equations and their derivatives where the free unknowns have moved.
    pub fn at(&self, moved: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let all = self.all(moved);
        let at = self.legs.at(&all, &DVector::zeros(all.len()));
        let [values, _] = at.values;
        let [jacobian, _] = at.jacobian;
        (values, jacobian.select_columns(&self.free))
    }

    fn all(&self, moved: &DVector<f64>) -> DVector<f64> {
        let mut all = DVector::zeros(self.legs.coordinates.len());
        for (&unknown, value) in self.free.iter().zip(moved.iter()) {
            all[unknown] = *value;
        }
        all
    }

    pub fn moved(&self, m: &Manipulator, moved: &DVector<f64>) -> Vec<f64> {
        self.legs.moved(m, &self.joints, &self.all(moved))
    }

    /// The twist of the platform along the family.
    pub fn twist(&self, way: &DVector<f64>) -> DVector<f64> {
        let all = self.all(&(&self.along * way));
        let own = all.rows_range(self.legs.unknowns[0].clone());
        self.legs.twists(0, &DVector::zeros(all.len())) * own
    }

    /// Directions of the kernel to try, of this length.
    pub fn ways(&self, length: f64) -> Vec<DVector<f64>> {
        let mut rng = Rng::with_seed(77);
        let kernel = self.along.ncols();
        let units = DMatrix::<f64>::identity(kernel, kernel);
        let mut ways: Vec<DVector<f64>> = units
            .column_iter()
            .flat_map(|unit| [length, -length].map(|length| unit * length))
            .collect();
        for _ in 0..6 * kernel {
            let way = DVector::from_fn(kernel, |_, _| 2.0 * rng.f64() - 1.0);
            ways.push(way.normalize() * length);
        }
        ways
    }

    /// The freedoms of the platform along the family.
    pub fn platform(&self) -> usize {
        let n = self.along.ncols();
        let unit = |i: usize| DVector::from_fn(n, |k, _| f64::from(u8::from(k == i)));
        let twists: Vec<DVector<f64>> = (0..n).map(|i| self.twist(&unit(i))).collect();
        let least = if self.multiple { BENT } else { KERNEL };
        match twists.iter().all(|twist| twist.amax() < least) {
            true => 0,
            false => rank(DMatrix::from_columns(&twists), least),
        }
    }
}
