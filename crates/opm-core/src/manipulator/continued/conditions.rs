//! What a displacement of the platform satisfies when the actuated joints are held.
//!
//! In Study parameters ([`super::quadrics::study`]) most of what legs demand are quadratic equations: a point stays on a sphere
//! or in a plane of the base or of the platform, two axes keep their angle, a line meets a line. Their coefficients are linear in
//! `1, cos q, sin q` of an actuated rotation, and in `1, q, q²` of an actuated slider. So they need not be derived for every kind
//! of leg: they are the equations of this form that all configurations have in common.

use super::fitted::{Equation, FitSample, HOLDS, SPARE, equations, product_of};
use super::quadrics::{C, Coordinates, Form};
use super::samples::{of_leg, of_platform};
use crate::manipulator::Manipulator;
use crate::mechanism::joint::{Joint, JointKind};
use crate::numeric::Quantity;
use crate::numeric::svd::Svd;
use fastrand::Rng;
use nalgebra::{DMatrix, SMatrix};
use std::ops::Range;

/// Equations are independent where their gradients are, by this share of the longest.
const INDEPENDENT: f64 = 1e-3;
/// More actuated joints of a leg take too long.
const MOST_ACTUATED: usize = 2;

/// A quadratic form of the coordinates, by its symmetric matrix.
pub type RealForm = SMatrix<f64, 8, 8>;

/// A quadratic form whose coefficients depend on the actuated joints of a leg.
#[derive(Clone, Debug)]
pub struct Condition {
    /// The numbers of the joints among the actuated ones.
    joints: Vec<usize>,
    /// A form for each product of what the joints give.
    forms: Vec<RealForm>,
    /// Whether it has the square of the distance, `p · p` of all eight parameters, once, whatever the joints are.
    pub sphere: bool,
}

/// All that is demanded.
#[derive(Clone, Debug)]
pub struct Conditions {
    /// Study parameters from coordinates. The first `free` of these are free, and the others are zero.
    pub basis: SMatrix<f64, 8, 8>,
    pub free: usize,
    /// The forms of which the others are sums.
    terms: Vec<RealForm>,
    /// Forms that are zero in all displacements: all, and sums of them, as many as are independent.
    pub all_fixed: Vec<RealForm>,
    pub fixed: Vec<RealForm>,
    /// Forms that hold the platform with the actuated joints, as many as it has freedoms.
    pub held: Vec<Condition>,
    /// What each actuated joint is.
    pub quantities: Vec<Quantity>,
    /// Lengths are over this, metres.
    pub size: f64,
}

impl Condition {
    fn new(joints: &[usize], mut forms: Vec<RealForm>, free: usize) -> Self {
        let mut squares = forms.iter().map(distance_squared);
        let square = squares.next().unwrap_or(0.0);
        let varies = squares.any(|square| square.abs() > HOLDS);
        let sphere = free == 8 && square.abs() > HOLDS && !varies;
        if sphere {
            forms.iter_mut().for_each(|form| *form /= square);
        }
        Self { joints: joints.to_vec(), forms, sphere }
    }

    /// The number of its forms.
    pub fn count(&self) -> usize {
        self.forms.len()
    }

    /// What its joints give for each form, where each joint gives `factors`: see [`Conditions::factors`].
    pub fn products(&self, factors: &[[C; 3]]) -> Vec<C> {
        let own: Vec<[C; 3]> = self.joints.iter().map(|&joint| factors[joint]).collect();
        (0..self.count()).map(|number| product_of(&own, number)).collect()
    }

    /// The form that it has where its joints, which are real, give `factors`: see [`Conditions::real_factors`].
    pub fn at(&self, factors: &[[f64; 3]]) -> RealForm {
        let own: Vec<[f64; 3]> = self.joints.iter().map(|&joint| factors[joint]).collect();
        let forms = self.forms.iter().enumerate();
        forms.fold(RealForm::zeros(), |sum, (number, form)| sum + form * product_of(&own, number))
    }

    /// The form in which each counts so much.
    pub fn mixed(&self, weights: impl IntoIterator<Item = C>) -> Form {
        let forms = self.forms.iter().zip(weights);
        forms.fold(Form::zeros(), |sum, (form, weight)| sum + form.map(|part| weight * part))
    }
}

impl Conditions {
    /// Those of a manipulator; `None` where they are not as many as hold the platform.
    pub fn new(manipulator: &Manipulator) -> Option<Self> {
        let of_legs = actuated_of_legs(manipulator)?;
        let most = of_legs.iter().map(Vec::len).max()?;
        if most > MOST_ACTUATED {
            return None;
        }
        // Where the platform has few coordinates, legs demand less there; elsewhere what each demands by itself is simplest.
        let platform = of_platform(manipulator, &mut Rng::with_seed(16), 8 + SPARE)?;
        let of_samples = Svd::new(DMatrix::from_fn(platform.len(), 8, |i, j| platform[i].x[j]));
        let free = of_samples.rank(HOLDS);
        let by_leg_first = manipulator.dependent.is_some() && free == 8;
        // All terms only where the others do not suffice: with them there are many solutions at infinity.
        for all_terms in [false, true] {
            for by_leg in [by_leg_first, !by_leg_first] {
                let (basis, free) = match by_leg || free == 8 {
                    true => (SMatrix::identity(), 8),
                    false => (SMatrix::from_fn(|i, j| of_samples.right[(i, j)]), free),
                };
                let quantity = |&c: &usize| manipulator.coordinates()[c].quantity;
                let found = Self {
                    basis,
                    free,
                    terms: terms(&basis, free, all_terms),
                    fixed: Vec::new(),
                    all_fixed: Vec::new(),
                    held: Vec::new(),
                    quantities: manipulator.actuated().iter().map(quantity).collect(),
                    size: manipulator.closure.size,
                };
                if let Some(found) = found.filled(manipulator, &of_legs, by_leg) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// With the equations of the legs wherever they reach, or only where the platform moves.
    fn filled(mut self, m: &Manipulator, of_legs: &[Vec<usize>], by_leg: bool) -> Option<Self> {
        let mut rng = Rng::with_seed(17);
        let count = |joints: usize| self.terms.len() * 3_usize.pow(joints as u32) + SPARE;
        let most = of_legs.iter().map(Vec::len).max()?;
        let shared = of_platform(m, &mut rng, if by_leg { 1 } else { count(most) })?;
        // A place of the platform that is not special.
        let place = self.basis.transpose() * shared[0].x;
        let mut gradients = Gradients::default();
        let mut demands = Vec::new();
        for (leg, joints) in of_legs.iter().enumerate() {
            let own = by_leg.then(|| of_leg(m, leg, &mut rng, count(joints.len())));
            let samples = own.as_ref().unwrap_or(&shared).iter().map(|sample| {
                let x = self.basis.transpose() * sample.x;
                let values = self.terms.iter().map(|term| (term * x).dot(&x)).collect();
                let factors = self.real_factors(&sample.actuated);
                FitSample { values, factors: joints.iter().map(|&joint| factors[joint]).collect() }
            });
            let quantities: Vec<Quantity> = joints.iter().map(|&j| self.quantities[j]).collect();
            let mut own = Vec::new();
            for Equation { degree, coefficients } in
                equations(&samples.collect::<Vec<_>>(), &quantities)
            {
                let parts = coefficients.as_slice().chunks(self.terms.len());
                let mut forms: Vec<RealForm> = parts.map(|part| self.form(part)).collect();
                if degree > 0 {
                    own.push((degree, Condition::new(joints, forms, self.free)));
                    continue;
                }
                let form = forms.swap_remove(0);
                gradients.take(&(form * place));
                self.all_fixed.push(form);
            }
            demands.extend(in_general_position(&own, &mut rng));
        }
        // At special places, as where the platform is turned by half a turn, some depend on each other that do not elsewhere.
        for _ in 0..gradients.units.len() {
            let mixed = |sum, form: &RealForm| sum + form * (2.0 * rng.f64() - 1.0);
            self.fixed.push(self.all_fixed.iter().fold(RealForm::zeros(), mixed));
        }
        demands.sort_by_key(|(degree, _)| *degree);
        let factors = self.factors(&complex(&shared[0].actuated));
        for (_, condition) in demands {
            let at_place = condition.mixed(condition.products(&factors)).map(|part| part.re);
            if gradients.take(&(at_place * place)) {
                self.held.push(condition);
            }
        }
        (self.fixed.len() + self.held.len() + 1 == self.free).then_some(self)
    }

    /// The form with these coefficients of the terms.
    fn form(&self, coefficients: &[f64]) -> RealForm {
        let parts = self.terms.iter().zip(coefficients);
        parts.fold(RealForm::zeros(), |sum, (term, coefficient)| sum + term * *coefficient)
    }

    /// The same of real values.
    pub fn real_factors(&self, actuated: &[f64]) -> Vec<[f64; 3]> {
        let of = |(&value, quantity): (&f64, &Quantity)| match quantity {
            Quantity::Angle => [1.0, value.cos(), value.sin()],
            Quantity::Length => {
                let value = value / self.size;
                [1.0, value, value * value]
            }
        };
        actuated.iter().zip(&self.quantities).map(of).collect()
    }

    /// What each actuated joint gives: `1, cos q, sin q`, or `1, q, q²`.
    pub fn factors(&self, actuated: &[C]) -> Vec<[C; 3]> {
        let of = |(&value, quantity): (&C, &Quantity)| match quantity {
            Quantity::Angle => [C::ONE, value.cos(), value.sin()],
            Quantity::Length => {
                let value = value / self.size;
                [C::ONE, value, value * value]
            }
        };
        actuated.iter().zip(&self.quantities).map(of).collect()
    }
}

/// Sums of a leg's demands in place of these: `a (b - q c) = 0` says nothing where `a` is zero, and there another one says it. Spheres
/// say all that they can.
fn in_general_position(demands: &[(usize, Condition)], rng: &mut Rng) -> Vec<(usize, Condition)> {
    let mut mixed = demands.to_vec();
    for (i, (degree, sum)) in mixed.iter_mut().enumerate().filter(|(_, (_, sum))| !sum.sphere) {
        for (j, (other, of)) in demands.iter().enumerate() {
            if i != j && other == degree && !of.sphere {
                let weight = 2.0 * rng.f64() - 1.0;
                let forms = sum.forms.iter_mut().zip(&of.forms);
                forms.for_each(|(form, more)| *form += more * weight);
            }
        }
    }
    mixed
}

fn complex(values: &[f64]) -> Vec<C> {
    values.iter().map(|&value| C::from(value)).collect()
}

/// The factor of `p · p` in a form of all eight parameters.
fn distance_squared(form: &RealForm) -> f64 {
    form[(4, 4)]
}

/// Gradients that are independent of those before them.
#[derive(Default)]
struct Gradients {
    units: Vec<Coordinates>,
}

impl Gradients {
    /// Takes one if it is.
    fn take(&mut self, gradient: &Coordinates) -> bool {
        let mut rest = *gradient;
        for _ in 0..2 {
            rest = self.units.iter().fold(rest, |rest, unit| rest - unit * unit.dot(&rest));
        }
        let new = rest.norm() > INDEPENDENT * gradient.norm().max(INDEPENDENT);
        if new {
            self.units.push(rest.normalize());
        }
        new
    }
}

/// For each leg, the numbers of its actuated joints among all of them; `None` if a joint turns about a point.
fn actuated_of_legs(m: &Manipulator) -> Option<Vec<Vec<usize>>> {
    let turns = |joint: &Joint| joint.kind == JointKind::Spherical && joint.actuated;
    if m.mechanism().joints().any(turns) {
        return None;
    }
    let own = |coordinates: Range<usize>| {
        let actuated = m.actuated().iter().enumerate();
        actuated.filter(|(_, c)| coordinates.contains(c)).map(|(number, _)| number).collect()
    };
    Some(m.coordinates_of_legs().into_iter().map(own).collect())
}

/// The terms of equations, as independent forms of the free coordinates: products of two parts of `q`, those of one of `q` and
/// one of `p = t q`, and `p · p`; or `all` products.
fn terms(basis: &SMatrix<f64, 8, 8>, free: usize, all: bool) -> Vec<RealForm> {
    let product = |i: usize, j: usize| {
        let mut form = RealForm::zeros();
        form[(i, j)] += 0.5;
        form[(j, i)] += 0.5;
        form
    };
    let of_orientation = (0..4).flat_map(|i| (i..8).map(move |j| product(i, j)));
    let square = (4..8).fold(RealForm::zeros(), |sum, i| sum + product(i, i));
    let squares: Vec<RealForm> = match all {
        true => (4..8).flat_map(|i| (i..8).map(move |j| product(i, j))).collect(),
        false => vec![square],
    };
    let products: Vec<RealForm> = of_orientation
        .chain(squares)
        .map(|form| {
            let mut of_free = RealForm::zeros();
            let form = basis.transpose() * form * basis;
            of_free.view_mut((0, 0), (free, free)).copy_from(&form.view((0, 0), (free, free)));
            of_free
        })
        .collect();
    let svd = Svd::new(DMatrix::from_fn(64, products.len(), |i, j| products[j][i]));
    let independent = svd.rank(HOLDS);
    let image = svd.image.columns(0, independent);
    image
        .column_iter()
        .map(|column| RealForm::from_column_slice(column.normalize().as_slice()))
        .collect()
}
