//! Least squares by Levenberg and Marquardt's method, of the crate `levenberg-marquardt` (MINPACK's `lmder`).

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::DMatrix;
use nalgebra_033::storage::Owned;
use nalgebra_033::{DMatrix as Matrix, DVector as Vector, Dyn};
use std::cell::RefCell;

/// Residuals at a point, and their derivatives if they were asked for: a row for each residual.
pub struct Evaluation {
    pub residuals: Vec<f64>,
    pub jacobian: Option<DMatrix<f64>>,
}

/// The residuals at a point, with derivatives if the flag is set; `None` where there are none.
pub type Evaluate<'a> = dyn FnMut(&[f64], bool) -> Option<Evaluation> + 'a;

/// Where the method ended.
pub struct Minimum {
    pub at: Vec<f64>,
    /// Whether it converged; `Err` says why it did not.
    pub converged: Result<(), &'static str>,
}

/// The residual of a point that cannot be evaluated, so that no step to it is taken.
const REFUSED: f64 = 1e12;

/// Minimises the sum of squares of `rows` residuals, until relative changes of the sum and of the point are below a
/// tolerance. `evaluate` says `None` where there are none: a step to there is refused.
pub fn minimise(
    start: &[f64],
    (rows, tolerance): (usize, f64),
    evaluate: &mut Evaluate<'_>,
) -> Minimum {
    let problem = Problem {
        at: Vector::from_column_slice(start),
        rows,
        evaluate: RefCell::new(evaluate),
        seen: RefCell::new(Seen::default()),
    };
    let method = LevenbergMarquardt::new().with_tol(tolerance);
    let (problem, report) = method.minimize(problem);
    let seen = problem.seen.into_inner();
    let converged = match report.termination {
        // Where nothing but rounding is left, no step improves the sum.
        TerminationReason::NoImprovementPossible(_) => Ok(()),
        reason if reason.was_successful() => Ok(()),
        TerminationReason::LostPatience => Err("too many steps without convergence"),
        TerminationReason::Numerical(_) if !seen.least.is_finite() => {
            Err("a residual is not a number")
        }
        // The method shrinks its steps beside the distance from zero. Where the start is zero and best, up to rounding, it
        // never comes to an end, and its region becomes too small for double precision.
        TerminationReason::Numerical(_) => {
            let converged = if seen.refused { Err("every step loses a pose") } else { Ok(()) };
            return Minimum { at: seen.at, converged };
        }
        TerminationReason::NoParameters => Err("nothing to vary"),
        _ => Err("the derivatives are not defined there"),
    };
    Minimum { at: problem.at.as_slice().to_vec(), converged }
}

struct Problem<'f> {
    at: Vector<f64>,
    rows: usize,
    evaluate: RefCell<&'f mut Evaluate<'f>>,
    seen: RefCell<Seen>,
}

/// What was seen on the way.
struct Seen {
    /// The point with the least sum of squares.
    at: Vec<f64>,
    /// That sum.
    least: f64,
    /// Whether the last step was refused.
    refused: bool,
}

impl Default for Seen {
    fn default() -> Self {
        Self { at: Vec::new(), least: f64::INFINITY, refused: false }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, at: &Vector<f64>) {
        self.at.copy_from(at);
    }

    fn params(&self) -> Vector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<Vector<f64>> {
        let found = (self.evaluate.borrow_mut())(self.at.as_slice(), false);
        let mut seen = self.seen.borrow_mut();
        seen.refused = found.is_none();
        let sum = |found: &Evaluation| found.residuals.iter().map(|r| r * r).sum::<f64>();
        if let Some(sum) = found.as_ref().map(sum).filter(|&sum| sum < seen.least) {
            (seen.at, seen.least) = (self.at.as_slice().to_vec(), sum);
        }
        Some(match found {
            Some(found) => Vector::from_vec(found.residuals),
            None => Vector::repeat(self.rows, REFUSED),
        })
    }

    fn jacobian(&self) -> Option<Matrix<f64>> {
        let jacobian = (self.evaluate.borrow_mut())(self.at.as_slice(), true)?.jacobian?;
        Some(Matrix::from_column_slice(jacobian.nrows(), jacobian.ncols(), jacobian.as_slice()))
    }
}
