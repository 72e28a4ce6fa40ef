//! Every displacement that actuated joints allow, by continuation.
//!
//! What the legs demand are [quadratic equations](conditions) in the Study parameters of the platform. They are solved once for
//! joints that give complex numbers, in general position: from equations with known solutions, as many as the product of the
//! degrees says (Bézout). The solutions for given joints are those to which these go: with probability one that is every isolated one
//! (Sommese and Wampler, "The Numerical Solution of Systems of Polynomials", 2005, chapter 7).
//!
//! Where the platform only translates, the equations are spheres or planes, and have a [closed form](translations).

mod conditions;
mod fitted;
mod quadrics;
mod samples;
mod translations;

use super::Manipulator;
use crate::numeric::Quantity;
use crate::numeric::continuation::{End, Pace, follow};
use conditions::{Condition, Conditions, RealForm};
use fastrand::Rng;
use nalgebra::{Isometry3, Quaternion, SVector, Translation3, UnitQuaternion};
use quadrics::{C, Form, Quadrics, Unknowns, translation};
use translations::{Met, Translations};

/// How solutions are followed, at first and where some are missing.
const PACES: [Pace; 2] = [Pace { near: 1e-3 }, Pace { near: 1e-5 }];
/// Two solutions are one, and an equation holds, to within this.
const SAME: f64 = 1e-6;
/// Two solutions that nearly meet are known to half of their digits, and so are their imaginary parts.
const REAL: f64 = 1e-5;
/// Solutions meet where a pivot is below this share of the largest: in general position, and nearly, where joints are given.
const REGULAR: f64 = 1e-9;
const MEETING: f64 = 1e-6;
/// A real solution may be near one that was lost with imaginary parts up to this.
const NEARLY: f64 = 0.1;
/// So many round trips at most look for further solutions.
const MOST_ROUNDS: usize = 8;
/// Joints in general position, radians and metres.
const SOMEWHERE: f64 = 0.7;

/// The equations of a manipulator, and their solutions for joints in general position.
#[derive(Clone, Debug)]
pub(crate) struct Continued {
    conditions: Conditions,
    /// The forms of the conditions on joints, with joints that give complex numbers.
    forms: Vec<Form>,
    starts: Vec<Unknowns>,
    /// Others, by which to go where solutions are missing.
    detour: Vec<Form>,
    /// How many solutions there are for joints in general position whose numbers are a cosine and a sine, or a value and its square.
    count: usize,
    /// Where the solutions have a closed form.
    translations: Option<Translations>,
}

/// The displacements that actuated joints allow.
#[derive(Clone, Debug)]
pub(crate) struct FoundDisplacements {
    /// Those that are real.
    pub real: Vec<Isometry3<f64>>,
    /// Real ones near where others end that were not found.
    pub near: Vec<Isometry3<f64>>,
    /// The number of all that were found, complex ones too.
    pub found: usize,
    /// How many there are in general.
    pub of: usize,
    /// Whether they are all that there are, by a closed form.
    pub closed: bool,
}

fn number(rng: &mut Rng) -> C {
    C::new(2.0 * rng.f64() - 1.0, 2.0 * rng.f64() - 1.0)
}

fn complex(form: &RealForm) -> Form {
    form.map(C::from)
}

/// Whether two are multiples of each other; both have length one.
fn same(one: &Unknowns, other: &Unknowns) -> bool {
    let along = one.dotc(other);
    (other - one * along).map(C::norm).norm() < SAME
}

/// Adds a solution unless it is known.
fn add(found: &mut Vec<Unknowns>, solution: Unknowns) -> bool {
    let new = !found.iter().any(|known| same(known, &solution));
    if new {
        found.push(solution);
    }
    new
}

impl Continued {
    /// Those of a manipulator; `None` where the legs' demands are not of this form.
    pub fn new(manipulator: &Manipulator) -> Option<Self> {
        let conditions = Conditions::new(manipulator)?;
        let mut rng = Rng::with_seed(40);
        let any = |rng: &mut Rng| -> Vec<Form> {
            let mut forms = Vec::with_capacity(conditions.held.len());
            for condition in &conditions.held {
                let weight = |i: usize| if i == 0 { C::ONE } else { number(rng) };
                forms.push(condition.mixed((0..condition.count()).map(weight)));
            }
            forms
        };
        let (forms, others) = (any(&mut rng), [any(&mut rng), any(&mut rng)]);
        let detour = others[0].clone();
        let starts = Vec::new();
        let mut found = Self { starts, forms, detour, conditions, count: 0, translations: None };
        let quantities = found.conditions.quantities.len();
        let somewhere: Vec<f64> = (0..quantities).map(|_| SOMEWHERE * rng.f64()).collect();
        let held = found.held_at(&somewhere);
        found.translations = Translations::new(&found.conditions, &held);
        if let Some(translations) = &found.translations {
            found.count = translations.count;
            return Some(found);
        }
        found.starts = found.general();
        // A round trip permutes the solutions; one that was lost comes with another one that leads there.
        for _ in 0..MOST_ROUNDS {
            let known = found.starts.len();
            let mut here = (found.forms.clone(), found.starts.clone());
            for there in others.iter().chain([&found.forms]) {
                let moving = found.between(&here.0, there);
                let moved =
                    here.1.iter().filter_map(|start| follow(&moving, start, PACES[0]).reached());
                here = (there.clone(), moved.collect());
            }
            for solution in here.1 {
                add(&mut found.starts, solution);
            }
            if found.starts.len() == known {
                break;
            }
        }
        let size = found.conditions.size;
        let joint =
            |quantity| number(&mut rng) * if quantity == Quantity::Length { size } else { 1.0 };
        let joints: Vec<C> = found.conditions.quantities.iter().copied().map(joint).collect();
        found.count = found.ends(&joints).0.len();
        (found.count > 0).then_some(found)
    }

    /// The solutions for displacements of the joints, which may be complex, and where others were lost.
    fn ends(&self, joints: &[C]) -> (Vec<Unknowns>, Vec<Unknowns>) {
        let factors = self.conditions.factors(joints);
        let at = |condition: &Condition| condition.mixed(condition.products(&factors));
        let to: Vec<Form> = self.conditions.held.iter().map(at).collect();
        let moving = self.between(&self.forms, &to);
        let (mut found, mut met, mut twice) = (Vec::new(), Vec::new(), false);
        let mut left: Vec<Unknowns> = self.starts.clone();
        for pace in PACES {
            met.clear();
            let missed = |start: &Unknowns| match follow(&moving, start, pace) {
                End::Reached(solution) if !moving.is_regular(&solution, MEETING) => {
                    met.push(solution);
                    true
                }
                End::Reached(solution) => {
                    twice |= !add(&mut found, solution);
                    false
                }
                End::Met(near) => {
                    met.push(near);
                    true
                }
                End::Far => false,
            };
            left.retain(missed);
            // One of two that come to one solution has left its way.
            if twice {
                left.clone_from(&self.starts);
            }
        }
        // Another way around places where solutions meet.
        if found.len() < self.count {
            let [there, on] =
                [self.between(&self.forms, &self.detour), self.between(&self.detour, &to)];
            for start in &self.starts {
                let end = follow(&there, start, PACES[1]).reached();
                let end = end.and_then(|start| follow(&on, &start, PACES[1]).reached());
                if let Some(end) = end.filter(|end| on.is_regular(end, MEETING)) {
                    add(&mut found, end);
                }
            }
        }
        (found, met)
    }

    /// The equations with some forms of the conditions on joints at `t = 0`, and others at `t = 1`.
    fn between(&self, from: &[Form], to: &[Form]) -> Quadrics {
        let fixed = self.conditions.fixed.iter().map(|form| (complex(form), None));
        let [from, to] = [from, to].map(|forms| self.without_squares(forms));
        let moving = from.into_iter().zip(to).map(|(from, to)| (from, Some(to - from)));
        self.quadrics(fixed.chain(moving).collect())
    }

    fn quadrics(&self, forms: Vec<(Form, Option<Form>)>) -> Quadrics {
        Quadrics { forms, orientation: self.conditions.basis.fixed_rows::<4>(0).into_owned() }
    }

    /// Takes the first sphere from the others. Each has `p · p` once, so that far away they are nearly equal.
    fn without_squares(&self, forms: &[Form]) -> Vec<Form> {
        let held = &self.conditions.held;
        let first = held.iter().position(|condition| condition.sphere);
        let less = |(i, form): (usize, &Form)| match first {
            Some(first) if i != first && held[i].sphere => form - forms[first],
            _ => *form,
        };
        forms.iter().enumerate().map(less).collect()
    }

    /// The solutions for the joints in general position, from those of `a x² = b x₀²` in each coordinate.
    fn general(&self) -> Vec<Unknowns> {
        let (c, mut rng) = (&self.conditions, Rng::with_seed(41));
        let squares: Vec<[C; 2]> =
            (1..c.free).map(|_| [number(&mut rng), number(&mut rng)]).collect();
        let plain = |place: usize| {
            let [a, b] = squares[place];
            let mut form = Form::zeros();
            (form[(place + 1, place + 1)], form[(0, 0)]) = (a, -b);
            form
        };
        let wanted = c.fixed.iter().map(complex).chain(self.without_squares(&self.forms));
        let moving = wanted.enumerate().map(|(place, form)| {
            let plain = plain(place);
            (plain, Some(form - plain))
        });
        let moving = self.quadrics(moving.collect());
        let mut found = Vec::new();
        for signs in 0..1_u32 << (c.free - 1) {
            let start = Unknowns::from_fn(|i, _| match i {
                0 => C::ONE,
                i if i < c.free => {
                    let [a, b] = squares[i - 1];
                    (b / a).sqrt() * if signs >> (i - 1) & 1 == 1 { -1.0 } else { 1.0 }
                }
                _ => C::ZERO,
            });
            let start = start / C::from(start.map(C::norm).norm());
            let Some(solution) = follow(&moving, &start, PACES[0]).reached() else { continue };
            let holds = |form: &RealForm| (complex(form) * solution).dot(&solution).norm() < SAME;
            if moving.is_regular(&solution, REGULAR) && c.all_fixed.iter().all(holds) {
                add(&mut found, solution);
            }
        }
        found
    }

    /// Whether the solutions have a closed form.
    pub fn is_closed(&self) -> bool {
        self.translations.is_some()
    }

    /// The forms of the conditions on joints that are real.
    fn held_at(&self, actuated: &[f64]) -> Vec<RealForm> {
        let factors = self.conditions.real_factors(actuated);
        self.conditions.held.iter().map(|condition| condition.at(&factors)).collect()
    }

    /// The displacements of the platform for displacements of the actuated joints, radians and metres.
    pub fn solve(&self, actuated: &[f64]) -> FoundDisplacements {
        if let Some(translations) = &self.translations {
            let (found, of) = (self.count, self.count);
            return match translations.solve(&self.held_at(actuated)) {
                Met::At(met) => {
                    let real = met.iter().map(|x| self.displacement(x)).collect();
                    FoundDisplacements { real, near: Vec::new(), found, of, closed: true }
                }
                Met::Dependent => FoundDisplacements {
                    real: Vec::new(),
                    near: Vec::new(),
                    found: 0,
                    of,
                    closed: false,
                },
            };
        }
        let joints: Vec<C> = actuated.iter().map(|&value| C::from(value)).collect();
        let (found, met) = self.ends(&joints);
        let of = |solutions: &[Unknowns], within: f64| {
            let real = solutions.iter().filter_map(|solution| self.real(solution, within));
            real.collect::<Vec<_>>()
        };
        let (near, real) = (of(&met, NEARLY), [of(&found, REAL), of(&met, REAL)].concat());
        let (found, of) = (found.len(), self.count);
        FoundDisplacements { real, near, found, of, closed: false }
    }

    /// The displacement that a solution is; `None` if it is not real to within this.
    fn real(&self, solution: &Unknowns, within: f64) -> Option<Isometry3<f64>> {
        let largest = solution.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let turned = solution * (largest.conj() / largest.norm());
        if turned.iter().any(|c| c.im.abs() > within) {
            return None;
        }
        Some(self.displacement(&turned.map(|c| c.re)))
    }

    /// The displacement of coordinates.
    fn displacement(&self, coordinates: &SVector<f64, 8>) -> Isometry3<f64> {
        let x = self.conditions.basis * coordinates;
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(x[0], x[1], x[2], x[3]));
        let moved = SVector::from(translation(&x)) * self.conditions.size;
        Isometry3::from_parts(Translation3::from(moved), rotation)
    }
}
