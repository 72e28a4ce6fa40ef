//! Platforms that only translate, held by three spheres or planes: a Delta, a 3-UPU, a Tripteron.
//!
//! With `ℓ` the coordinate that is not of the translation, each condition is `s y·y + ℓ (a · x) = 0` with one quadratic part for all.
//! Differences are planes. Three planes have one point, two planes and a sphere two, by a quadratic equation.

use super::conditions::{Conditions, RealForm};
use super::quadrics::Coordinates;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, Vector3};

/// Quadratic parts are multiples of one another, or zero, to within this.
const ALIKE: f64 = 1e-9;
/// Planes are parallel where the sine of their angle is below this.
const PARALLEL: f64 = 1e-9;
/// A discriminant is zero to within this share of its parts.
const TOUCHES: f64 = 1e-13;

/// The coordinates of such a platform: `x = ℓ + Σ yᵢ eᵢ`.
#[derive(Clone, Debug)]
pub struct Translations {
    unit: Coordinates,
    axes: [Coordinates; 3],
    /// How many solutions there are, complex ones too.
    pub count: usize,
}

/// The solutions of the conditions.
pub enum Met {
    At(Vec<Coordinates>),
    /// The conditions depend on each other.
    Dependent,
}

impl Translations {
    /// Those of conditions, with the forms that they have for some joints in general position; `None` where the platform turns, or the
    /// conditions are others.
    pub fn new(conditions: &Conditions, forms: &[RealForm]) -> Option<Self> {
        if conditions.free != 4 || !conditions.fixed.is_empty() || forms.len() != 3 {
            return None;
        }
        let orientation = DMatrix::from_fn(4, 4, |i, j| conditions.basis[(i, j)]);
        let svd = Svd::new(orientation);
        if svd.rank(ALIKE) != 1 {
            return None;
        }
        let column =
            |k: usize| Coordinates::from_fn(|i, _| if i < 4 { svd.right[(i, k)] } else { 0.0 });
        let axes = [1, 2, 3].map(column);
        let mut found = Self { unit: column(0), axes, count: 0 };
        let quadratic = forms.iter().map(|form| found.quadratic(form));
        let largest = forms.iter().map(nalgebra::Matrix::amax).fold(0.0, f64::max);
        let mut parts: Vec<_> = quadratic.filter(|part| part.amax() > ALIKE * largest).collect();
        let alike = parts.pop().is_none_or(|first| {
            parts.iter().all(|part| {
                let ratio = part.dot(&first) / first.norm_squared();
                (part - first * ratio).amax() <= ALIKE * part.amax()
            })
        });
        let spheres = forms.iter().any(|form| found.quadratic(form).amax() > ALIKE * largest);
        found.count = if spheres { 2 } else { 1 };
        alike.then_some(found)
    }

    fn quadratic(&self, form: &RealForm) -> nalgebra::Matrix3<f64> {
        nalgebra::Matrix3::from_fn(|i, j| self.axes[i].dot(&(form * self.axes[j])))
    }

    /// The plane of a form without a quadratic part: its normal and where it is.
    fn plane(&self, form: &RealForm) -> (Vector3<f64>, f64) {
        let by = form * self.unit;
        let normal = Vector3::from_fn(|i, _| 2.0 * self.axes[i].dot(&by));
        (normal, self.unit.dot(&by))
    }

    /// The real solutions. One that is missed by no more than rounding is a double one.
    pub fn solve(&self, forms: &[RealForm]) -> Met {
        let parts: Vec<_> = forms.iter().map(|form| self.quadratic(form)).collect();
        let by = |i: &usize, j: &usize| parts[*i].amax().total_cmp(&parts[*j].amax());
        let Some(most) = (0..forms.len()).max_by(by) else { return Met::Dependent };
        let square = parts[most].norm_squared();
        let scale = |normal: Vector3<f64>, at: f64| {
            let length = normal.norm();
            (length > 0.0).then(|| (normal / length, at / length))
        };
        let planes: Option<Vec<(Vector3<f64>, f64)>> = (0..forms.len())
            .filter(|&i| self.count == 1 || i != most)
            .map(|i| {
                let (normal, at) = match self.count {
                    1 => self.plane(&forms[i]),
                    _ => self
                        .plane(&(forms[i] - forms[most] * (parts[i].dot(&parts[most]) / square))),
                };
                scale(normal, at)
            })
            .collect();
        let place = |y: &Vector3<f64>| (0..3).fold(self.unit, |x, i| x + self.axes[i] * y[i]);
        match planes.as_deref() {
            Some([(a, p), (b, q), (c, r)]) => {
                let volume = a.dot(&b.cross(c));
                if volume.abs() < PARALLEL {
                    return Met::Dependent;
                }
                let y = -(b.cross(c) * *p + c.cross(a) * *q + a.cross(b) * *r) / volume;
                Met::At(vec![place(&y)])
            }
            Some([(a, p), (b, q)]) => {
                let along = a.cross(b);
                let sine = along.norm_squared();
                if sine.sqrt() < PARALLEL {
                    return Met::Dependent;
                }
                // The point of both planes that is nearest to the origin.
                let foot = (along.cross(b) * *p + a.cross(&along) * *q) / sine;
                let (x, way) = (place(&foot), along / sine.sqrt());
                let way = (0..3).fold(Coordinates::zeros(), |sum, i| sum + self.axes[i] * way[i]);
                let form = &forms[most];
                let [two, one, zero] =
                    [(form * way).dot(&way), (form * x).dot(&way), (form * x).dot(&x)];
                let rest = one * one - two * zero;
                let size = one * one + (two * zero).abs();
                if rest < -TOUCHES * size {
                    return Met::At(Vec::new());
                }
                let root = rest.max(0.0).sqrt();
                // Without cancellation; Vieta's formula has the other one.
                let larger = -(one + root.copysign(one));
                let roots = match larger == 0.0 {
                    true => [0.0, 0.0],
                    false => [larger / two, zero / larger],
                };
                Met::At(roots.map(|t| x + way * t).to_vec())
            }
            _ => Met::Dependent,
        }
    }
}
