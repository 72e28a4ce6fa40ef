//! Six joints that close a loop, followed from one loop to another.
//!
//! A joint is a factor `a + b A` with its axis `A`: a line for a rotation by `2 atan(b / a)`, `ε` times a direction for a
//! translation by `2 b / a`. Here `(a, b)` is linear in one unknown, with complex coefficients, so that no real position is at
//! infinity. The product of all factors is a multiple of one: six equations for six unknowns, linear in each. While the axes and
//! the displacement to be closed move along a complex path, every solution moves along a smooth path of its own, with
//! probability one (Sommese and Wampler, "The numerical solution of systems of polynomials", 2005, chapter 7).

use super::dual_quaternion::{C, DualQuaternion, V};
use nalgebra::{SMatrix, SVector};

pub type Unknowns = SVector<C, 6>;

/// An axis that moves with `t`: between those of two loops.
#[derive(Clone, Copy, Debug)]
pub enum Axis {
    /// The line through two points, each at `t = 0` and `t = 1`.
    Turn([[V; 2]; 2]),
    /// A direction.
    Slide([V; 2]),
}

/// The displacement before the first joint.
#[derive(Clone, Copy, Debug)]
pub enum Before {
    /// Any: a quaternion and a translation.
    Free([([C; 4], V); 2]),
    /// A joint whose factor moves.
    Joint { axis: DualQuaternion, factors: [[C; 2]; 2] },
}

/// Six joints between two loops.
#[derive(Clone, Debug)]
pub struct Homotopy {
    pub before: Before,
    pub axes: [Axis; 6],
    /// Of each joint, `a` and `b` as `[constant, slope]` of its unknown.
    pub charts: [[[C; 2]; 2]; 6],
}

/// The equations, their derivatives by the unknowns, and by `t`.
struct Equations {
    open: Unknowns,
    slopes: SMatrix<C, 6, 6>,
    drift: Unknowns,
}

/// A step is accepted if its last correction is as small as this.
const CONVERGED: f64 = 1e-9;
/// The largest first correction of a step: a larger one may be on another path.
const NEAR: f64 = 1e-2;
const FIRST: f64 = 0.02;
const SHORTEST: f64 = 1e-8;
const MOST_STEPS: usize = 5_000;
/// An unknown that is so large is at infinity.
const FAR: f64 = 1e8;

fn mix(from: &V, to: &V, t: f64) -> V {
    from * C::from(1.0 - t) + to * C::from(t)
}

impl Axis {
    /// The axis at `t`, and its derivative.
    pub fn at(&self, t: f64) -> [DualQuaternion; 2] {
        match self {
            Self::Turn([[p0, p1], [r0, r1]]) => {
                let (p, r, dp, dr) = (mix(p0, p1, t), mix(r0, r1, t), p1 - p0, r1 - r0);
                [
                    DualQuaternion::vectors(&(r - p), &p.cross(&r)),
                    DualQuaternion::vectors(&(dr - dp), &(dp.cross(&r) + p.cross(&dr))),
                ]
            }
            Self::Slide([from, to]) => {
                let still = V::zeros();
                [
                    DualQuaternion::vectors(&still, &mix(from, to, t)),
                    DualQuaternion::vectors(&still, &(to - from)),
                ]
            }
        }
    }

    /// The axis at one end, for good.
    pub fn held(&self, end: usize) -> Self {
        match self {
            Self::Turn([p, r]) => Self::Turn([[p[end]; 2], [r[end]; 2]]),
            Self::Slide(d) => Self::Slide([d[end]; 2]),
        }
    }

    /// From the end of this axis to that of another one of its kind.
    pub fn towards(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::Turn([p, r]), Self::Turn([q, s])) => Self::Turn([[p[1], q[1]], [r[1], s[1]]]),
            (Self::Slide(from), Self::Slide(to)) => Self::Slide([from[1], to[1]]),
            _ => unreachable!("both have the kinds of one structure"),
        }
    }
}

impl Before {
    fn at(&self, t: f64) -> [DualQuaternion; 2] {
        let line = |from: C, to: C| (from * (1.0 - t) + to * t, to - from);
        match self {
            Self::Free([(q0, t0), (q1, t1)]) => {
                let both: [(C, C); 4] = std::array::from_fn(|i| line(q0[i], q1[i]));
                let (q, dq) = (both.map(|b| b.0), both.map(|b| b.1));
                let (moved, rate) = (mix(t0, t1, t), t1 - t0);
                let still = DualQuaternion::displacement(dq, &moved);
                let carried = DualQuaternion::displacement(q, &rate);
                let rate = DualQuaternion { real: [C::ZERO; 4], dual: carried.dual };
                [DualQuaternion::displacement(q, &moved), still + rate]
            }
            Self::Joint { axis, factors: [[a0, b0], [a1, b1]] } => {
                let ((a, da), (b, db)) = (line(*a0, *a1), line(*b0, *b1));
                let of = |a, b| DualQuaternion::ONE * a + *axis * b;
                [of(a, b), of(da, db)]
            }
        }
    }
}

impl Homotopy {
    /// The factor of a joint at its unknown: `[a, b]`.
    pub fn factor(&self, joint: usize, unknown: C) -> [C; 2] {
        self.charts[joint].map(|[constant, slope]| constant + slope * unknown)
    }

    fn equations(&self, x: &Unknowns, t: f64) -> Equations {
        let axes = self.axes.map(|axis| axis.at(t));
        let factors: [[C; 2]; 6] = std::array::from_fn(|i| self.factor(i, x[i]));
        let one = DualQuaternion::ONE;
        let joint = |i: usize| one * factors[i][0] + axes[i][0] * factors[i][1];
        let mut after = [one; 7];
        for i in (0..6).rev() {
            after[i] = joint(i) * after[i + 1];
        }
        let [mut so_far, rate] = self.before.at(t);
        let mut drift = rate * after[0];
        let mut slopes: SMatrix<C, 6, 6> = SMatrix::zeros();
        for i in 0..6 {
            let [[_, da], [_, db]] = self.charts[i];
            let slope = so_far * (one * da + axes[i][0] * db) * after[i + 1];
            slopes.set_column(i, &Unknowns::from(slope.open()));
            drift = drift + so_far * (axes[i][1] * factors[i][1]) * after[i + 1];
            so_far = so_far * joint(i);
        }
        Equations { open: so_far.open().into(), slopes, drift: drift.open().into() }
    }

    /// The product of all factors at `t = 0` without the displacement before them.
    pub fn joints_at_start(&self, x: &Unknowns) -> DualQuaternion {
        (0..6).fold(DualQuaternion::ONE, |so_far, i| {
            let [a, b] = self.factor(i, x[i]);
            so_far * (DualQuaternion::ONE * a + self.axes[i].at(0.0)[0] * b)
        })
    }

    /// One step of Newton's method, and its size.
    fn corrected(&self, x: &Unknowns, t: f64) -> Option<(Unknowns, f64)> {
        let at = self.equations(x, t);
        let step = at.slopes.lu().solve(&-at.open)?;
        let size = step.iter().zip(x.iter()).map(|(d, x)| d.norm() / (1.0 + x.norm()));
        let size = size.fold(0.0, f64::max);
        size.is_finite().then(|| (x + step, size))
    }

    fn velocity(&self, x: &Unknowns, t: f64) -> Option<Unknowns> {
        let at = self.equations(x, t);
        at.slopes.lu().solve(&-at.drift)
    }

    /// Where a solution at `t = 0` is at `t = 1`. `None` if it goes to infinity, or where paths meet.
    pub fn follow(&self, start: &Unknowns) -> Option<Unknowns> {
        let (mut x, mut t, mut step, mut good) = (*start, 0.0, FIRST, 0);
        for _ in 0..MOST_STEPS {
            if t >= 1.0 {
                return self.polished(x);
            }
            let h = f64::min(step, 1.0 - t);
            let reached = self.ahead(&x, t, h).and_then(|ahead| {
                let (first, size) = self.corrected(&ahead, t + h)?;
                if size > NEAR {
                    return None;
                }
                let (second, size) = self.corrected(&first, t + h)?;
                if size <= CONVERGED {
                    return Some(second);
                }
                let (third, size) = self.corrected(&second, t + h)?;
                (size <= CONVERGED).then_some(third)
            });
            match reached {
                Some(found) => {
                    (x, t, good) = (found, t + h, good + 1);
                    if x.iter().any(|c| c.norm() > FAR) {
                        return None;
                    }
                    if good >= 3 {
                        (step, good) = (2.0 * step, 0);
                    }
                }
                None => {
                    (step, good) = (0.5 * h, 0);
                    if step < SHORTEST {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// The prediction by the classical method of Runge and Kutta.
    fn ahead(&self, x: &Unknowns, t: f64, h: f64) -> Option<Unknowns> {
        let c = |value: f64| C::from(value);
        let one = self.velocity(x, t)?;
        let two = self.velocity(&(x + one * c(0.5 * h)), t + 0.5 * h)?;
        let three = self.velocity(&(x + two * c(0.5 * h)), t + 0.5 * h)?;
        let four = self.velocity(&(x + three * c(h)), t + h)?;
        Some(x + (one + (two + three) * c(2.0) + four) * c(h / 6.0))
    }

    fn polished(&self, mut x: Unknowns) -> Option<Unknowns> {
        for _ in 0..4 {
            let (better, size) = self.corrected(&x, 1.0)?;
            x = better;
            if size <= 1e-14 {
                break;
            }
        }
        Some(x)
    }
}
