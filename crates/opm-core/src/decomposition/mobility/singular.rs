//! Singularity of the home pose: its ranks compared with those of assembled poses nearby.
//!
//! Ranks drop in special poses and never rise, so a pose is singular if a pose nearby has a higher
//! rank. Such a pose is found by a first-order motion of finite size, which is projected back onto
//! the loop closure by Levenberg-Marquardt steps with the remaining gap as damping. They converge
//! quadratically even if the closure's rank is deficient (Fan and Yuan, Computing 74, 2005), as it
//! is in every overconstrained mechanism.

use super::linkage::{Linkage, Pose, Ranks};
use crate::group::screw::Screw;
use crate::group::subspace::TOLERANCE;
use crate::mechanism::Mechanism;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, DVector, Isometry3, Vector6};
use std::fmt;

/// Sizes of the motion to a nearby pose, in the order in which they are tried: radians, and shares
/// of the characteristic length. Near a singular pose its ranks cannot be distinguished from those
/// nearby, so the largest motion that closes is taken.
const NEARBY: [f64; 3] = [0.3, 0.1, 0.03];
/// A projection that leaves less than this share of the motion has returned to home.
const AWAY: f64 = 0.3;
/// The number of first-order motions that are tried. Each one is generic; more of them only guard
/// against coincidences.
const SAMPLES: usize = 3;
/// The largest number of projection steps, and the gap that counts as closed. Coordinates with six
/// digits close an overconstrained mechanism only to within the tolerance of ranks.
const MAX_STEPS: usize = 40;
const CLOSED: f64 = 1e-12;
/// A step that leaves more than this share of the gap has reached the rounding of the input.
const STALLED: f64 = 0.99;
/// A singular value that is zero at home, but not in general, grows with the distance from home.
/// One of this size is neither rounding nor the zero at home itself.
const CLEARLY_NONZERO: f64 = 3.0 * TOLERANCE;

/// One respect in which the home pose is more degenerate than assembled poses nearby.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HomeSingularity {
    /// Serial singularity: the joint screws of a leg are linearly dependent. The leg cannot move
    /// the platform in some direction, and two of its working modes meet.
    Serial {
        /// The name of the leg.
        leg: String,
        /// Dimension of the span of the leg's screws at home.
        home: usize,
        /// Dimension of the span of the leg's screws nearby.
        nearby: usize,
    },
    /// Parallel singularity: with the actuators locked, more motions are left than nearby.
    Parallel {
        /// The number of freedoms at home with the actuators locked.
        home: usize,
        /// The number of freedoms nearby with the actuators locked.
        nearby: usize,
    },
    /// Constraint singularity: the mobility `N` at home is larger than nearby.
    Constraint {
        /// Mobility `N` at home.
        home: usize,
        /// Mobility `N` nearby.
        nearby: usize,
    },
    /// No assembled pose nearby: the structure moves to first order (it is shaky), but not
    /// finitely.
    Isolated {
        /// Mobility `N` at home.
        mobility: usize,
    },
    /// The span of all joint screws is smaller at home than nearby.
    Span {
        /// Dimension `lambda` of the span at home.
        home: usize,
        /// Dimension `lambda` of the span nearby.
        nearby: usize,
    },
}

impl fmt::Display for HomeSingularity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { leg, home, nearby } => write!(
                f,
                "serial: the joints of leg {leg:?} have {home} independent screws at home, \
                 {nearby} nearby"
            ),
            Self::Parallel { home, nearby } => write!(
                f,
                "parallel: with the actuators locked, mobility is {home} at home, {nearby} nearby"
            ),
            Self::Constraint { home, nearby } => {
                write!(f, "constraint: mobility N is {home} at home, {nearby} nearby")
            }
            Self::Isolated { mobility } => {
                write!(f, "isolated: mobility N is {mobility} at home, but no pose nearby closes")
            }
            Self::Span { home, nearby } => {
                write!(f, "span: all joint screws have rank lambda {home} at home, {nearby} nearby")
            }
        }
    }
}

/// Every respect in which home, with the given `ranks`, is singular.
pub(super) fn singularities(
    linkage: &Linkage,
    ranks: &Ranks,
    mechanism: &Mechanism,
) -> Vec<HomeSingularity> {
    if ranks.mobility == 0 {
        return vec![];
    }
    let Some(generic) = generic_ranks(linkage) else {
        return vec![HomeSingularity::Isolated { mobility: ranks.mobility }];
    };
    let mut found = vec![];
    for (i, leg) in mechanism.legs.iter().enumerate() {
        let (home, nearby) = (ranks.legs[i], generic.legs[i]);
        if home < nearby {
            found.push(HomeSingularity::Serial { leg: leg.name.clone(), home, nearby });
        }
    }
    if ranks.locked > generic.locked {
        let (home, nearby) = (ranks.locked, generic.locked);
        found.push(HomeSingularity::Parallel { home, nearby });
    }
    if ranks.mobility > generic.mobility {
        let (home, nearby) = (ranks.mobility, generic.mobility);
        found.push(HomeSingularity::Constraint { home, nearby });
    }
    if ranks.lambda < generic.lambda {
        let (home, nearby) = (ranks.lambda, generic.lambda);
        found.push(HomeSingularity::Span { home, nearby });
    }
    found
}

/// The least degenerate ranks found nearby; `None` if no pose nearby closes.
fn generic_ranks(linkage: &Linkage) -> Option<Ranks> {
    let regular = |a: Ranks, b: Ranks| Ranks {
        lambda: a.lambda.max(b.lambda),
        mobility: a.mobility.min(b.mobility),
        locked: a.locked.min(b.locked),
        legs: a.legs.iter().zip(&b.legs).map(|(x, y)| *x.max(y)).collect(),
    };
    let kernel = Svd::new(linkage.home().derivative()).kernel(TOLERANCE);
    (0..SAMPLES)
        .filter_map(|sample| nearby(linkage, &kernel, sample))
        .map(|pose| linkage.ranks(&pose, CLEARLY_NONZERO))
        .reduce(regular)
}

/// An assembled pose at some distance from home, found with a first-order motion in `kernel`. Each
/// sample is another pose.
fn nearby(linkage: &Linkage, kernel: &DMatrix<f64>, sample: usize) -> Option<Pose> {
    // Fixed coefficients without a pattern: multiples of the golden ratio modulo one.
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let coefficient =
        |i: usize, _| ((1 + i + sample * kernel.ncols()) as f64 * golden).fract() - 0.5;
    let motion = kernel * DVector::from_fn(kernel.ncols(), coefficient);
    NEARBY.iter().find_map(|size| project(linkage, &(&motion * (size / motion.amax()))))
}

/// The assembled pose nearest to given coordinates and a platform twist, stacked; `None` if there
/// is none, or if it is home.
fn project(linkage: &Linkage, start: &DVector<f64>) -> Option<Pose> {
    let n = linkage.actuated.len();
    let mut q = start.rows(0, n).into_owned();
    let away = AWAY * q.amax();
    let mut platform = displacement(&start.rows(n, 6).into_owned());
    let mut pose = linkage.pose(q.as_slice());
    let mut gaps = pose.gaps(&platform);
    for _ in 0..MAX_STEPS {
        let gap = gaps.norm();
        if gap <= CLOSED {
            break;
        }
        let derivative = pose.derivative();
        let mut normal = derivative.tr_mul(&derivative);
        (0..n + 6).for_each(|i| normal[(i, i)] += gap);
        let Some(factors) = normal.cholesky() else { break };
        let step = -factors.solve(&derivative.tr_mul(&gaps));
        q += step.rows(0, n);
        platform = displacement(&step.rows(n, 6).into_owned()) * platform;
        pose = linkage.pose(q.as_slice());
        gaps = pose.gaps(&platform);
        if gaps.norm() > STALLED * gap {
            break;
        }
    }
    (gaps.norm() <= TOLERANCE && q.amax() >= away).then_some(pose)
}

fn displacement(twist: &DVector<f64>) -> Isometry3<f64> {
    Screw::from_vector(&Vector6::from_column_slice(twist.as_slice())).exp(1.0)
}
