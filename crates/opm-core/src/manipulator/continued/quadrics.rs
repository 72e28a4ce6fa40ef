//! Quadratic equations between the coordinates of a displacement, and how their solutions move.

use crate::numeric::continuation::Moving;
use nalgebra::{Complex, Quaternion, SMatrix, SVector};

pub type C = Complex<f64>;
/// Eight homogeneous coordinates.
pub type Unknowns = SVector<C, 8>;
/// They where they are real.
pub type Coordinates = SVector<f64, 8>;
/// A symmetric matrix `A` of the quadratic form `xᵀ A x`.
pub type Form = SMatrix<C, 8, 8>;

/// A displacement with an orientation below this is at infinity.
const FAR: f64 = 1e-5;

/// Equations `xᵀ A x = 0`, as many as there are free coordinates but one. The coordinates after the free ones are zero.
#[derive(Clone, Debug)]
pub struct Quadrics {
    /// Each with what it is at `t = 0` and what is added to it up to `t = 1`, if it changes.
    pub forms: Vec<(Form, Option<Form>)>,
    /// How the quaternion of the orientation follows from the coordinates.
    pub orientation: SMatrix<f64, 4, 8>,
}

impl Quadrics {
    fn jacobian(&self, held: &[Form], x: &Unknowns) -> (Form, Unknowns) {
        let mut jacobian = Form::zeros();
        let mut values = Unknowns::zeros();
        for (i, form) in held.iter().enumerate() {
            let by = form * x;
            values[i] = by.dot(x);
            jacobian.set_row(i, &(by * C::from(2.0)).transpose());
        }
        // The coordinates that are zero.
        for row in self.forms.len()..7 {
            jacobian[(row, row + 1)] = C::ONE;
        }
        // All multiples of a solution are one: steps are perpendicular to it.
        jacobian.set_row(7, &x.adjoint());
        (jacobian, values)
    }

    /// Whether a solution at `t = 1` is isolated: no other one is near it.
    pub fn is_regular(&self, x: &Unknowns, least: f64) -> bool {
        let (jacobian, _) = self.jacobian(&self.at(1.0), x);
        let pivots = jacobian.lu().u().diagonal().map(C::norm);
        // Far away all pivots but one are small.
        pivots.min() > least * self.turned(x).powi(2) * pivots.max()
    }

    /// How far from infinity a displacement is.
    fn turned(&self, x: &Unknowns) -> f64 {
        let part = |f: fn(&C) -> f64| self.orientation * x.map(|c| f(&c));
        (part(|c| c.re).norm_squared() + part(|c| c.im).norm_squared()).sqrt()
    }
}

impl Moving for Quadrics {
    type Unknowns = Unknowns;
    type Held = Vec<Form>;
    const ORDER: f64 = 4.0;

    fn at(&self, t: f64) -> Vec<Form> {
        let at = |(form, change): &(Form, Option<Form>)| match change {
            Some(change) => form + change.map(|part| part * t),
            None => *form,
        };
        self.forms.iter().map(at).collect()
    }

    /// By the Taylor series to the third order: derivatives of `xᵀ A(t) x = 0`, one after the other.
    fn ahead(&self, held: &Vec<Form>, x: &Unknowns, _: f64, h: f64) -> Option<Unknowns> {
        let lu = self.jacobian(held, x).0.lu();
        // A x', and what changes of A: A' x.
        let (mut moved, mut drift) = ([Unknowns::zeros(); 7], [Unknowns::zeros(); 7]);
        let mut right = Unknowns::zeros();
        for (i, (_, change)) in self.forms.iter().enumerate() {
            if let Some(change) = change {
                drift[i] = change * x;
                right[i] = -drift[i].dot(x);
            }
        }
        let one = lu.solve(&right)?;
        for (i, form) in held.iter().enumerate() {
            moved[i] = form * one;
            right[i] = -(moved[i] * C::from(2.0) + drift[i] * C::from(4.0)).dot(&one);
        }
        let two = lu.solve(&right)?;
        for (i, (_, change)) in self.forms.iter().enumerate() {
            let turned = change.map_or(C::ZERO, |change| (change * one).dot(&one));
            right[i] = ((moved[i] + drift[i]).dot(&two) + turned) * C::from(-6.0);
        }
        let three = lu.solve(&right)?;
        let c = |value: f64| C::from(value);
        Some(x + (one + (two + three * c(h / 3.0)) * c(0.5 * h)) * c(h))
    }

    fn corrected(&self, held: &Vec<Form>, x: &Unknowns) -> Option<(Unknowns, f64)> {
        let (jacobian, values) = self.jacobian(held, x);
        let step = jacobian.lu().solve(&-values)?;
        let found = x + step;
        let length = found.map(C::norm).norm();
        let size = step.map(C::norm).norm() / self.turned(x).max(FAR);
        size.is_finite().then(|| (found / C::from(length), size))
    }

    fn is_far(&self, x: &Unknowns) -> bool {
        self.turned(x) < FAR
    }
}

/// The Study parameters of a displacement: its quaternion `q`, and `t q` with its translation `t`.
pub fn study(rotation: &Quaternion<f64>, translation: [f64; 3]) -> Coordinates {
    let [x, y, z] = translation;
    let moved = Quaternion::new(0.0, x, y, z) * rotation;
    Coordinates::from([
        rotation.w, rotation.i, rotation.j, rotation.k, moved.w, moved.i, moved.j, moved.k,
    ])
}

/// The translation of Study parameters.
pub fn translation(x: &Coordinates) -> [f64; 3] {
    let quaternion = |at: usize| Quaternion::new(x[at], x[at + 1], x[at + 2], x[at + 3]);
    let (q, p) = (quaternion(0), quaternion(4));
    let t = p * q.conjugate() / q.norm_squared();
    [t.i, t.j, t.k]
}
