//! Six joints that close a loop, followed from one loop to another.
//!
//! A joint is a factor `a + b A` with its axis `A`: a line for a rotation by `2 atan(b / a)`, `ε` times a direction for a
//! translation by `2 b / a`. Here `(a, b)` is linear in one unknown, with complex coefficients, so that no real position is at
//! infinity. The product of all factors is a multiple of one: six equations for six unknowns, linear in each. While the axes and
//! the displacement to be closed move along a complex path, every solution moves along a smooth path of its own, with
//! probability one (Sommese and Wampler, "The numerical solution of systems of polynomials", 2005, chapter 7).

use super::dual_quaternion::{C, DualQuaternion, V};
use crate::numeric::continuation::{Moving, Pace, follow};
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

/// The joints at one `t`, each axis with its derivative.
pub struct HeldLoop {
    before: [DualQuaternion; 2],
    axes: [[DualQuaternion; 2]; 6],
}

/// The equations, their derivatives by the unknowns, and by `t`.
struct Equations {
    open: Unknowns,
    slopes: SMatrix<C, 6, 6>,
    drift: Unknowns,
}

/// The largest first correction of a step: a larger one may be on another path.
const NEAR: f64 = 1e-2;
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

    fn equations(&self, x: &Unknowns, HeldLoop { before, axes }: &HeldLoop) -> Equations {
        let factors: [[C; 2]; 6] = std::array::from_fn(|i| self.factor(i, x[i]));
        let one = DualQuaternion::ONE;
        let joint = |i: usize| one * factors[i][0] + axes[i][0] * factors[i][1];
        let mut after = [one; 7];
        for i in (0..6).rev() {
            after[i] = joint(i) * after[i + 1];
        }
        let [mut so_far, rate] = *before;
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

    fn velocity(&self, x: &Unknowns, held: &HeldLoop) -> Option<Unknowns> {
        let at = self.equations(x, held);
        at.slopes.lu().solve(&-at.drift)
    }

    /// Where a solution at `t = 0` is at `t = 1`. `None` if it goes to infinity, or where solutions meet.
    pub fn follow(&self, start: &Unknowns) -> Option<Unknowns> {
        follow(self, start, Pace { near: NEAR }).reached()
    }
}

impl Moving for Homotopy {
    type Unknowns = Unknowns;
    type Held = HeldLoop;
    const ORDER: f64 = 5.0;

    fn at(&self, t: f64) -> HeldLoop {
        HeldLoop { before: self.before.at(t), axes: self.axes.map(|axis| axis.at(t)) }
    }

    /// By the classical method of Runge and Kutta.
    fn ahead(&self, held: &HeldLoop, x: &Unknowns, t: f64, h: f64) -> Option<Unknowns> {
        let c = |value: f64| C::from(value);
        let (middle, end) = (self.at(t + 0.5 * h), self.at(t + h));
        let one = self.velocity(x, held)?;
        let two = self.velocity(&(x + one * c(0.5 * h)), &middle)?;
        let three = self.velocity(&(x + two * c(0.5 * h)), &middle)?;
        let four = self.velocity(&(x + three * c(h)), &end)?;
        Some(x + (one + (two + three) * c(2.0) + four) * c(h / 6.0))
    }

    fn corrected(&self, held: &HeldLoop, x: &Unknowns) -> Option<(Unknowns, f64)> {
        let at = self.equations(x, held);
        let step = at.slopes.lu().solve(&-at.open)?;
        let size = step.iter().zip(x.iter()).map(|(d, x)| d.norm() / (1.0 + x.norm()));
        let size = size.fold(0.0, f64::max);
        size.is_finite().then(|| (x + step, size))
    }

    fn is_far(&self, x: &Unknowns) -> bool {
        x.iter().any(|c| c.norm() > FAR)
    }
}
