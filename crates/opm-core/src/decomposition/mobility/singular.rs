//! Singularity of the home pose: its ranks compared with those of assembled poses nearby.
//!
//! Ranks drop in special poses and never rise, so a pose is singular if a pose nearby has a higher
//! rank. A singular value at home that is a small share of what it is nearby, but not zero, is regular still.
//! A pose nearby is found by a first-order motion of finite size, which is projected back onto the loop closure by
//! Levenberg-Marquardt steps with the remaining gap as damping. They converge quadratically even if the closure's
//! rank is deficient (Fan and Yuan, Computing 74, 2005), as it is in every overconstrained mechanism.

use super::linkage::{FirstOrder, Linkage, Pose, Ties};
use super::{absolute_values, loose_twists, platform};
use crate::group::screw::Screw;
use crate::group::subspace::{SubspaceClass, TOLERANCE};
use crate::mechanism::Mechanism;
use nalgebra::{DMatrix, DVector, Isometry3, Translation3, Vector6};
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
/// A singular value at home up to this is the rounding of numbers with all their digits.
const EXACT: f64 = 1e-10;
/// A singular value at home below this share of what it is nearby is zero. A home that is off a singular pose by an
/// angle of 1e-4 has a share of some 3e-4, since poses nearby are off by some 0.3; what is rounded to nine digits has
/// less than 1e-7.
const VANISHED: f64 = 1e-5;

/// One respect in which the home pose is more degenerate than assembled poses nearby.
#[derive(Clone, Debug, PartialEq)]
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
        /// The motions of the platform at home with the actuators locked: independent twists, each given as the motion
        /// that it generates.
        loose: Vec<SubspaceClass>,
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
            Self::Parallel { home, nearby, .. } => write!(
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

/// Assembled poses near home; none if no pose nearby closes.
pub(super) struct Nearby {
    /// The coordinates of one of them.
    pub coordinates: Option<Vec<f64>>,
    pub generic: Option<Generic>,
}

/// What is true at poses near home, but for special ones among them.
pub(super) struct Generic {
    all: Vec<f64>,
    legs: Vec<Vec<f64>>,
    ties: Vec<f64>,
    /// The motions at each pose, orthonormal columns.
    motions: Vec<DMatrix<f64>>,
    /// Mobility `N`.
    pub mobility: usize,
    controls: Vec<f64>,
    /// How many of the freedoms the actuators control.
    pub controlled: usize,
    /// How many motions the platform has with the actuators locked.
    pub loose: usize,
    /// How many motions do not move the platform.
    pub idle: usize,
}

/// Ranks at home, and the motions that they leave.
pub(super) struct AtHome {
    pub lambda: usize,
    pub legs: Vec<usize>,
    /// Orthonormal columns.
    pub motions: DMatrix<f64>,
}

impl AtHome {
    fn new(home: &FirstOrder, generic: Option<&Generic>) -> Self {
        let of = |of: fn(&Generic) -> &[f64]| generic.map_or(&[][..], of);
        let nearby: &[Vec<f64>] = generic.map_or(&[], |generic| &generic.legs);
        let own = |number: usize| nearby.get(number).map_or(&[][..], |values| &values[..]);
        let legs: Vec<usize> = home.legs().enumerate().map(|(i, leg)| rank(leg, own(i))).collect();
        let ties = home.ties(&legs);
        let tied = rank(ties.values(), of(|generic| &generic.ties));
        let motions = home.motions(&legs, &ties, tied);
        Self { lambda: rank(&home.all, of(|generic| &generic.all)), legs, motions }
    }

    /// The mobility `N`.
    pub fn mobility(&self) -> usize {
        self.motions.ncols()
    }
}

impl Generic {
    /// What poses have in common; `None` if there are none.
    fn new(linkage: &Linkage, poses: &[FirstOrder]) -> Option<Self> {
        let leg = |number: usize| {
            largest(poses.iter().map(move |pose| pose.legs().nth(number).unwrap_or_default()))
        };
        let legs: Vec<Vec<f64>> = (0..poses.first()?.legs().count()).map(leg).collect();
        let ranks: Vec<usize> = legs.iter().map(|values| clear(values)).collect();
        let all_ties: Vec<Ties> = poses.iter().map(|pose| pose.ties(&ranks)).collect();
        let ties = largest(all_ties.iter().map(Ties::values));
        let tied = clear(&ties);
        let motions =
            poses.iter().zip(&all_ties).map(|(pose, ties)| pose.motions(&ranks, ties, tied));
        let motions: Vec<DMatrix<f64>> = motions.collect();
        let mobility = motions[0].ncols();
        let all_controls: Vec<Vec<f64>> =
            motions.iter().map(|motions| linkage.controls(motions)).collect();
        let controls = largest(all_controls.iter().map(|values| &**values));
        let loose = motions
            .iter()
            .zip(&all_controls)
            .map(|(motions, values)| loose_twists(linkage, motions, clear(values)).dimension());
        let idle = motions.iter().map(|motions| mobility - platform(motions));
        Some(Self {
            all: largest(poses.iter().map(|pose| &*pose.all)),
            mobility,
            controlled: clear(&controls),
            loose: loose.min().unwrap_or_default(),
            idle: idle.min().unwrap_or_default(),
            legs,
            ties,
            controls,
            motions,
        })
    }
}

/// The largest of each singular value at some poses.
fn largest<'a>(poses: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut largest = vec![];
    for values in poses {
        largest.resize(values.len(), 0.0);
        largest.iter_mut().zip(values).for_each(|(x, y)| *x = y.max(*x));
    }
    largest
}

impl Nearby {
    /// Poses near home, whose first-order kinematics are `home`.
    pub fn new(linkage: &Linkage, home: &FirstOrder) -> Self {
        let (mut coordinates, mut poses) = (None, vec![]);
        // A home that is nearly singular has motions to within the tolerance that lead nowhere: then those that are exact.
        for tolerance in [TOLERANCE, EXACT] {
            let first = first_motions(linkage, home, tolerance);
            let samples = if first.is_empty() { 0 } else { SAMPLES };
            for (own, pose) in (0..samples).filter_map(|sample| nearby(linkage, &first, sample)) {
                coordinates.get_or_insert(own);
                poses.push(linkage.first_order(&pose));
            }
            if !poses.is_empty() {
                break;
            }
        }
        Self { coordinates, generic: Generic::new(linkage, &poses) }
    }

    /// The ranks and motions at home, whose first-order kinematics are `home`.
    pub fn at_home(&self, home: &FirstOrder) -> AtHome {
        AtHome::new(home, self.generic.as_ref())
    }

    /// How many of the freedoms the actuators control at home, where these are the singular values of what they
    /// control.
    pub fn controlled(&self, home: &[f64]) -> usize {
        rank(home, self.generic.as_ref().map_or(&[], |generic| &generic.controls))
    }

    /// Whether the other actuated freedoms control as much without some of them, at every pose nearby.
    pub fn spares(&self, linkage: &Linkage, without: &[usize]) -> bool {
        let Some(generic) = &self.generic else { return false };
        let rest: Vec<usize> =
            linkage.actuated_rows().filter(|row| !without.contains(row)).collect();
        generic.motions.iter().all(|motions| {
            clear(&absolute_values(motions.select_rows(&rest))) == generic.controlled
        })
    }
}

/// The motions of first order at home, rates of the coordinates and a twist. Singular values up to `tolerance` are zero.
fn first_motions(linkage: &Linkage, home: &FirstOrder, tolerance: f64) -> DMatrix<f64> {
    let count = |values: &[f64]| values.iter().filter(|&&value| value > tolerance).count();
    let ranks: Vec<usize> = home.legs().map(count).collect();
    let ties = home.ties(&ranks);
    let motions = home.motions(&ranks, &ties, count(ties.values()));
    linkage.rates(&linkage.home(), motions)
}

/// The number of values that are clearly not zero.
fn clear(values: &[f64]) -> usize {
    values.iter().filter(|&&value| value > CLEARLY_NONZERO).count()
}

/// A rank at home, by singular values there and nearby.
fn rank(home: &[f64], nearby: &[f64]) -> usize {
    let regular = clear(nearby);
    let counts = |(i, &value): (usize, &f64)| {
        value > TOLERANCE || (i < regular && value > VANISHED * nearby[i])
    };
    home.iter().enumerate().filter(|&(i, value)| counts((i, value))).count()
}

/// Every respect in which home, with the given `ranks`, is singular, the parallel one excepted. `legs` are the legs'
/// names.
pub(super) fn singularities<'a>(
    nearby: &Nearby,
    ranks: &AtHome,
    legs: impl Iterator<Item = &'a str>,
) -> Vec<HomeSingularity> {
    if ranks.mobility() == 0 {
        return vec![];
    }
    let Some(generic) = &nearby.generic else {
        return vec![HomeSingularity::Isolated { mobility: ranks.mobility() }];
    };
    let mut found = vec![];
    for (i, leg) in legs.enumerate() {
        let (home, nearby) = (ranks.legs[i], clear(&generic.legs[i]));
        if home < nearby {
            found.push(HomeSingularity::Serial { leg: leg.to_owned(), home, nearby });
        }
    }
    if ranks.mobility() > generic.mobility {
        let (home, nearby) = (ranks.mobility(), generic.mobility);
        found.push(HomeSingularity::Constraint { home, nearby });
    }
    let nearby = clear(&generic.all);
    if ranks.lambda < nearby {
        found.push(HomeSingularity::Span { home: ranks.lambda, nearby });
    }
    found
}

/// Displacements of the platform at assembled poses of a mechanism, at random.
pub(crate) fn assembled(mechanism: &Mechanism) -> Vec<Isometry3<f64>> {
    /// How large the first-order motions are: radians, and shares of the size.
    const SIZES: [f64; 12] = [0.3, 0.3, 0.3, 0.3, 0.2, 0.2, 0.2, 0.2, 0.1, 0.1, 0.1, 0.1];
    let Ok(linkage) = Linkage::new(mechanism) else { return Vec::new() };
    let kernel = first_motions(&linkage, &linkage.first_order(&linkage.home()), TOLERANCE);
    let frame = linkage.frame;
    let found = SIZES.iter().enumerate().filter_map(|(sample, size)| {
        let motion = random(&kernel, sample);
        let (_, pose) = project(&linkage, &(&motion * (size / motion.amax())))?;
        let tip = pose.tips().next()?;
        let origin = frame.origin.coords;
        let shift = tip.translation.vector * frame.length + origin - tip.rotation * origin;
        Some(Isometry3::from_parts(Translation3::from(shift), tip.rotation))
    });
    found.collect()
}

/// A first-order motion of those in `kernel`. Each sample is another one.
fn random(kernel: &DMatrix<f64>, sample: usize) -> DVector<f64> {
    let coefficient = |i: usize, _| share(1 + i + sample * kernel.ncols());
    kernel * DVector::from_fn(kernel.ncols(), coefficient)
}

/// Numbers between -1/2 and 1/2 without a pattern: multiples of the golden ratio modulo one.
pub(crate) fn share(number: usize) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    (number as f64 * golden).fract() - 0.5
}

/// An assembled pose at some distance from home, found with a first-order motion in `kernel`. Each
/// sample is another pose.
fn nearby(linkage: &Linkage, kernel: &DMatrix<f64>, sample: usize) -> Option<(Vec<f64>, Pose)> {
    let motion = random(kernel, sample);
    NEARBY.iter().find_map(|size| project(linkage, &(&motion * (size / motion.amax()))))
}

/// The assembled pose nearest to given coordinates and a platform twist, stacked, and its coordinates; `None` if there
/// is none, or if it is home.
fn project(linkage: &Linkage, start: &DVector<f64>) -> Option<(Vec<f64>, Pose)> {
    let n = linkage.actuated.len();
    let mut q = start.rows(0, n).into_owned();
    let away = AWAY * q.amax();
    let mut platform = displacement(&start.fixed_rows::<6>(n).into_owned());
    let mut pose = linkage.pose(q.as_slice());
    let mut gaps = pose.gaps(&platform);
    for _ in 0..MAX_STEPS {
        let gap = gaps.norm();
        if gap <= CLOSED {
            break;
        }
        let Some((rates, twist)) = pose.step(&gaps, gap) else { break };
        q += rates;
        platform = displacement(&twist) * platform;
        pose = linkage.pose(q.as_slice());
        gaps = pose.gaps(&platform);
        if gaps.norm() > STALLED * gap {
            break;
        }
    }
    (gaps.norm() <= TOLERANCE && q.amax() >= away).then(|| (q.as_slice().to_vec(), pose))
}

fn displacement(twist: &Vector6<f64>) -> Isometry3<f64> {
    Screw::from_vector(twist).exp(1.0)
}
