//! Solutions of equations, followed while the equations change.
//!
//! The equations move with `t` from zero to one, and each of their solutions moves along a smooth curve of its own. A step
//! predicts, then corrects by Newton's method. Its length is chosen by what the correction was (Morgan and Sommese,
//! "Coefficient-parameter polynomial continuation", Appl. Math. Comput. 29, 1989; Bates, Hauenstein, Sommese and Wampler,
//! "Numerically Solving Polynomial Systems with Bertini", 2013).

/// Equations that move.
pub trait Moving {
    /// Their unknowns.
    type Unknowns: Copy;

    /// They at one `t`.
    type Held;

    /// The order in the step of what a prediction is wrong by.
    const ORDER: f64;

    /// They at `t`.
    fn at(&self, t: f64) -> Self::Held;

    /// What a solution at `t`, where the equations are `held`, is predicted to be at `t + h`; `None` where solutions meet.
    fn ahead(
        &self,
        held: &Self::Held,
        x: &Self::Unknowns,
        t: f64,
        h: f64,
    ) -> Option<Self::Unknowns>;

    /// One step of Newton's method, and its size.
    fn corrected(&self, held: &Self::Held, x: &Self::Unknowns) -> Option<(Self::Unknowns, f64)>;

    /// Whether a solution is so far away that it counts as being at infinity.
    fn is_far(&self, x: &Self::Unknowns) -> bool;
}

/// How carefully solutions are followed.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// The largest first correction of a step: after a larger one the solution may be another one.
    pub near: f64,
}

/// The second correction of a step is at most this share of the first, which is Newton's method at work.
const CONVERGES: f64 = 0.02;
/// A correction below this may be rounding.
const ROUNDING: f64 = 1e-8;
/// Steps aim at this share of the largest correction.
const AIM: f64 = 0.2;
const FIRST: f64 = 0.02;
const LONGEST: f64 = 0.25;
const SHORTEST: f64 = 1e-9;
const MOST_STEPS: usize = 4_000;

/// Where a solution ends.
#[derive(Clone, Copy, Debug)]
pub enum End<X> {
    /// The solution at `t = 1`.
    Reached(X),
    /// It was followed up to here: solutions meet.
    Met(X),
    /// It goes to infinity.
    Far,
}

impl<X> End<X> {
    /// The solution at `t = 1`, if it was reached.
    pub fn reached(self) -> Option<X> {
        match self {
            Self::Reached(x) => Some(x),
            Self::Met(_) | Self::Far => None,
        }
    }
}

/// Where a solution at `t = 0` is at `t = 1`.
pub fn follow<M: Moving>(equations: &M, start: &M::Unknowns, pace: Pace) -> End<M::Unknowns> {
    let (mut x, mut t, mut step) = (*start, 0.0, FIRST);
    let mut held = equations.at(t);
    for _ in 0..MOST_STEPS {
        if t >= 1.0 {
            return polished(equations, &held, x).map_or(End::Met(x), End::Reached);
        }
        let h = f64::min(step, 1.0 - t);
        let next = if h < 1.0 - t { t + h } else { 1.0 };
        let then = equations.at(next);
        let (found, off) = match equations.ahead(&held, &x, t, h) {
            Some(ahead) => trusted(equations, &then, &ahead, pace),
            None => (None, f64::INFINITY),
        };
        if let Some(found) = found {
            (x, t, held) = (found, next, then);
            if equations.is_far(&x) {
                return End::Far;
            }
        }
        let longer = (AIM * pace.near / off.max(1e-12)).powf(1.0 / M::ORDER);
        step = match found {
            Some(_) => f64::min(h * longer.clamp(0.3, 3.0), LONGEST),
            None => h * longer.clamp(0.1, 0.5),
        };
        if step < SHORTEST {
            return End::Met(x);
        }
    }
    End::Met(x)
}

/// What a prediction is corrected to, if that can be trusted, and the size of the first correction.
fn trusted<M: Moving>(
    equations: &M,
    held: &M::Held,
    ahead: &M::Unknowns,
    pace: Pace,
) -> (Option<M::Unknowns>, f64) {
    let failed = (None, f64::INFINITY);
    let Some((first, off)) = equations.corrected(held, ahead) else { return failed };
    if off > pace.near {
        return (None, off);
    }
    if off <= ROUNDING {
        return (Some(first), off);
    }
    let Some((second, left)) = equations.corrected(held, &first) else { return failed };
    match left <= CONVERGES * off || left <= ROUNDING {
        true => (Some(second), off),
        false => (None, off.max(0.5 * pace.near)),
    }
}

/// A solution to rounding.
fn polished<M: Moving>(equations: &M, held: &M::Held, mut x: M::Unknowns) -> Option<M::Unknowns> {
    for _ in 0..4 {
        let (better, size) = equations.corrected(held, &x)?;
        x = better;
        if size <= 1e-14 {
            break;
        }
    }
    Some(x)
}
