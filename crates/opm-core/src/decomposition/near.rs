//! Mechanisms that nearly decompose: their coordinates are rounded to two or three digits, or an axis
//! is one degree off.
//!
//! [`nearly`] says which joints miss the subspaces of the others, and by how much. [`snap`] accepts
//! such a mechanism within a tolerance and corrects it: it puts every joint exactly into the subspace
//! of its section, so that everything downstream sees an exact mechanism.
//!
//! Both search for a split of all legs with a tolerance that grows until a split is found. Many joints
//! can be off at once, so leaving out one joint after the other would not find it. The group of each
//! section is fitted to all of its joints. A split counts only if the corrected mechanism has an
//! ordinary decomposition.

mod guides;
mod miss;
mod relation;
mod search;
mod snapped;

pub use miss::JointMiss;
pub(super) use miss::{misses_of, shown};
pub(super) use search::{MOST_DIMENSIONS, elements};

use super::{DecomposeError, Decomposition, passive};
use crate::decomposition::mobility::{MobilityError, frame, mobility};
use crate::group::subspace::{Frame, SubspaceClass, TOLERANCE};
use crate::mechanism::Mechanism;
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::Vector3;
use search::{NearSplit, Parts};
use std::fmt;

/// The tolerances of the search, from that of exact mechanisms to the largest that [`nearly`] still
/// calls near: radians, and shares of the characteristic length.
const TOLERANCES: [f64; 7] = [TOLERANCE, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, FARTHEST];
const FARTHEST: f64 = 5e-2;

/// The largest angle by which an axis is corrected, radians, and the largest length in characteristic lengths.
const LARGEST_ANGLE: f64 = 0.1;

/// An offset up to this size, in radians and characteristic lengths, is rounding of exact numbers.
/// Such joints stay as they are.
const EXACT: f64 = 1e-12;

/// The sections that a mechanism nearly has.
#[derive(Clone, Debug, PartialEq)]
pub struct NearMiss {
    /// The subspace of the lower section, fitted to its joints.
    pub lower: SubspaceClass,
    /// The subspace of the upper section, fitted to its joints.
    pub upper: SubspaceClass,
    /// The joints that miss the subspace of their section, the worst one first.
    pub joints: Vec<JointMiss>,
    /// The tolerance that [`snap`] needs to accept the mechanism, metres.
    pub tolerance: f64,
    /// The units of the mechanism's file, for messages.
    pub units: FileUnits,
}

/// Axes that miss a point by less than this share of the spread of the joints' points are nearly concurrent.
const CONCURRENT: f64 = 1e-2;

/// The frame of a mechanism. If its axes nearly meet in one point, the length is the spread of the joints' points, as
/// if they did: the length of [`frame`] would be that of the misses, against which none is small.
fn sized_frame(mechanism: &Mechanism) -> Frame {
    let frame = frame(mechanism);
    let placed = |joint: &&Joint| joint.kind != JointKind::Prismatic;
    let points = || mechanism.joints().filter(placed).map(|joint| joint.point.coords);
    let count = points().count() as f64;
    let mean = points().sum::<Vector3<f64>>() / count;
    let spread = (points().map(|p| (p - mean).norm_squared()).sum::<f64>() / count).sqrt();
    if frame.length < CONCURRENT * spread { Frame { length: spread, ..frame } } else { frame }
}

/// The number of joints that a message names.
const NAMED: usize = 3;

impl fmt::Display for NearMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named: Vec<String> = self.joints.iter().take(NAMED).map(JointMiss::to_string).collect();
        write!(f, "{}", named.join("; "))?;
        match self.joints.len().saturating_sub(NAMED) {
            0 => Ok(()),
            1 => write!(f, "; and 1 more joint misses by less"),
            more => write!(f, "; and {more} more joints miss by less"),
        }
    }
}

/// A mechanism whose joints were put exactly into the subspaces of their sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapped {
    /// The corrected mechanism.
    pub mechanism: Mechanism,
    /// The joints that were moved, the one that was farthest off first; empty if none had to be.
    pub joints: Vec<JointMiss>,
}

/// What a mechanism misses that nearly decomposes; `None` if it decomposes, or is not even near.
///
/// A slider that is slightly off the plane of its section makes that section a Schoenflies one. A
/// mechanism with such a large section decomposes, but may nearly decompose into smaller ones. Then
/// the result says what it misses of these.
///
/// # Errors
/// [`MobilityError`] if the mechanism is incomplete or has numbers that are not finite.
pub fn nearly(mechanism: &Mechanism) -> Result<Option<NearMiss>, MobilityError> {
    mobility(mechanism)?;
    Ok(match plain(mechanism) {
        Ok(found) => near_smaller(mechanism, &found),
        Err(_) => near_miss(mechanism, MOST_DIMENSIONS),
    })
}

/// A joint screw farther than this from its subspace (the sine of an angle, with lengths divided by the mechanism's size) is
/// told. Files with seven digits stay below.
const TOLD: f64 = 1e-6;

/// What joints miss of the subspaces of their sections in a mechanism that decomposes as it is, if it is more than rounding.
/// `None` for one that does not decompose, or nearly decomposes into smaller sections: [`nearly`] is about these.
pub fn slightly_off(mechanism: &Mechanism) -> Option<NearMiss> {
    let found = plain(mechanism).ok()?;
    let off = found.first().filter(|d| d.deviation > TOLD)?;
    near_miss(mechanism, dimensions(off)).filter(|_| near_smaller(mechanism, &found).is_none())
}

/// What a mechanism misses of smaller sections, if it has a section that is large or has a pitch.
pub(super) fn near_smaller(mechanism: &Mechanism, found: &[Decomposition]) -> Option<NearMiss> {
    near_miss(mechanism, smaller(found)?)
}

/// The most dimensions that smaller sections have together, if the preferred decomposition has a section that
/// is large or has a pitch; `None` if it has none.
fn smaller(found: &[Decomposition]) -> Option<usize> {
    let large = |group: &SubspaceClass| match group {
        SubspaceClass::TranslationalSpace
        | SubspaceClass::PlanarHelical { .. }
        | SubspaceClass::Schoenflies { .. }
        | SubspaceClass::Full => true,
        SubspaceClass::Identity
        | SubspaceClass::Rotation { .. }
        | SubspaceClass::Translation { .. }
        | SubspaceClass::Helical { .. }
        | SubspaceClass::TranslationalPlane { .. }
        | SubspaceClass::Cylindrical { .. }
        | SubspaceClass::Planar { .. }
        | SubspaceClass::Spherical { .. } => false,
    };
    let first = found.first().filter(|d| large(&d.lower) || large(&d.upper))?;
    Some(dimensions(first) - 1)
}

/// The dimensions of both sections together.
fn dimensions(decomposition: &Decomposition) -> usize {
    decomposition.lower.dimension() + decomposition.upper.dimension()
}

/// What a mechanism misses to decompose into sections that have at most `dimensions` together. It must
/// be complete, and must not decompose so already.
pub(super) fn near_miss(mechanism: &Mechanism, dimensions: usize) -> Option<NearMiss> {
    let length = sized_frame(mechanism).length;
    let Correction { split, snapped } = correction(mechanism, FARTHEST, dimensions)?;
    let off = |joint: &JointMiss| joint.relative(length) > TOLERANCE;
    // Without a joint that is moved, the mechanism is as it was.
    let worst = snapped.joints.first()?.clone();
    let tolerance = worst.relative(length) * length;
    let mut joints: Vec<_> = snapped.joints.into_iter().filter(off).collect();
    if joints.is_empty() {
        joints.push(worst);
    }
    let units = mechanism.units;
    Some(NearMiss { lower: split.lower, upper: split.upper, joints, tolerance, units })
}

/// Puts every joint exactly into the subspace of its section, if none is farther from it than
/// `tolerance`: a length in metres. Angles count as lengths at the mechanism's characteristic length.
///
/// A mechanism that does not decompose within the tolerance is returned as it is. No axis is rotated by more
/// than some six degrees, however small the mechanism is: then it would be another one.
///
/// # Errors
/// [`MobilityError`] if the mechanism is incomplete or has numbers that are not finite.
pub fn snap(mechanism: &Mechanism, tolerance: f64) -> Result<Snapped, MobilityError> {
    mobility(mechanism)?;
    let unchanged = || Snapped { mechanism: mechanism.clone(), joints: vec![] };
    let most = match plain(mechanism) {
        Ok(found) if is_exact(&found) => match smaller(&found) {
            Some(most) => most,
            None => return Ok(unchanged()),
        },
        Ok(_) | Err(_) => MOST_DIMENSIONS,
    };
    let tolerance = (tolerance / sized_frame(mechanism).length).min(LARGEST_ANGLE);
    let correction = correction(mechanism, tolerance, most);
    Ok(correction.map_or_else(unchanged, |correction| correction.snapped))
}

/// A split within some tolerance, and the mechanism that it gives.
struct Correction {
    split: NearSplit,
    snapped: Snapped,
}

/// The correction with the smallest tolerance up to `most` (in characteristic lengths), to sections that
/// have at most `dimensions` together.
fn correction(mechanism: &Mechanism, most: f64, dimensions: usize) -> Option<Correction> {
    let frame = sized_frame(mechanism);
    let larger = std::iter::successors(Some(2.0 * FARTHEST), |t| (*t < 1.0).then_some(2.0 * t));
    let mut tolerances: Vec<f64> = TOLERANCES.into_iter().chain(larger).collect();
    tolerances.retain(|t| *t < most);
    tolerances.push(most);
    let mut refused: Vec<(Vec<Parts>, [&str; 2])> = vec![];
    for tolerance in tolerances {
        for split in search::splits(mechanism, &frame, tolerance) {
            if split.lower.dimension() + split.upper.dimension() > dimensions {
                continue;
            }
            let key = (split.legs.clone(), [split.lower.name(), split.upper.name()]);
            if refused.contains(&key) {
                continue;
            }
            let Some(snapped) = snapped::snapped(mechanism, &split, frame.length, tolerance) else {
                continue;
            };
            // A mechanism in one subspace has no upper section, whatever of it a split calls so.
            let whole = split.upper == SubspaceClass::Identity;
            let small = |d: &Decomposition| {
                self::dimensions(d) <= dimensions && (whole || d.upper != SubspaceClass::Identity)
            };
            let fits =
                |found: Vec<Decomposition>| is_exact(&found) && found.first().is_some_and(small);
            if plain(&snapped.mechanism).is_ok_and(fits) {
                return Some(Correction { split, snapped });
            }
            refused.push(key);
        }
    }
    None
}

/// The decompositions of a mechanism as it is.
fn plain(mechanism: &Mechanism) -> Result<Vec<Decomposition>, DecomposeError> {
    passive(mechanism, &mobility(mechanism)?)
}

fn is_exact(found: &[Decomposition]) -> bool {
    found.first().is_some_and(|d| d.deviation <= EXACT)
}

#[cfg(all(test, feature = "files"))]
mod tests;
