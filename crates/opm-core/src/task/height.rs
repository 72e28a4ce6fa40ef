//! The height of a Schoenflies section.

use super::{IntersectionAxis, Task};
use crate::decomposition::Decomposition;
use crate::group::subspace::{SubspaceClass, TOLERANCE};
use crate::group::{Displacement, JointDisplacement, Placed};
use crate::mechanism::leg::Section;
use crate::numbers::Real;
use nalgebra::{Isometry3, Translation3, Vector3};
use std::ops::Range;

/// The height of a Schoenflies section. A Schoenflies displacement is a planar one followed by a translation along the
/// plane's normal, and the two commute. So the section is treated as a planar one, and the height by itself.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Height {
    /// The section.
    pub section: Section,
    /// The number of its task coordinate.
    pub coordinate: usize,
    /// The unit direction in which it grows, as it is at home, in base coordinates.
    pub up: Vector3<f64>,
    /// What a unit of a leg's displacement τ along the intersection motion adds to the height of the leg's section. It is
    /// zero, but for a translation that is inclined to the direction.
    pub slope: f64,
}

impl Height {
    /// The section of a decomposition that has a height. Two such sections would have all translations in common, and
    /// are no decomposition.
    pub(super) fn of(decomposition: &Decomposition) -> Option<Section> {
        let has = |class: &SubspaceClass| matches!(class, SubspaceClass::Schoenflies { .. });
        match (has(&decomposition.lower), has(&decomposition.upper)) {
            (true, _) => Some(Section::Lower),
            (false, true) => Some(Section::Upper),
            (false, false) => None,
        }
    }
}

/// The slope of a height. With `I` the shared translation, of which `up · I` is along the direction, and `L`, `U` a leg's
/// sections:
///
/// * below, `L = v · exp(I τ)` is raised by `τ up · I` more than `v`;
/// * above, `U = exp(-I τ) · b` by as much less than `b`.
pub(super) fn slope(
    section: Section,
    up: &Vector3<f64>,
    intersection: Option<&IntersectionAxis>,
) -> f64 {
    let Some(IntersectionAxis { direction, point: None }) = intersection else { return 0.0 };
    let cosine = up.dot(direction);
    match section {
        _ if cosine.abs() <= TOLERANCE => 0.0,
        Section::Lower => cosine,
        Section::Upper => -cosine,
    }
}

impl Task {
    /// The slope of the height; zero where there is none.
    #[inline]
    pub(crate) fn slope(&self) -> f64 {
        self.height.as_ref().map_or(0.0, |height| height.slope)
    }

    /// The height above home of a leg's own section, where the Schoenflies section is at `rise`, and the leg is displaced
    /// by `tau` along the intersection motion; metres.
    #[inline]
    pub(crate) fn rise_of_leg(&self, rise: f64, tau: JointDisplacement) -> f64 {
        let slope = self.slope();
        // The value of a rotation costs time.
        if slope == 0.0 { rise } else { rise + slope * tau.value() }
    }

    /// Whether the sections share a translation that is inclined to the direction of a Schoenflies section. Then the
    /// displacements of imaginary joints have a part in the height, and each leg has a height of its own.
    pub fn shares_height(&self) -> bool {
        self.slope() != 0.0
    }

    /// The height of the Schoenflies section above its home at a pose, metres; zero where there is none.
    #[inline]
    pub fn rise(&self, pose: &[f64]) -> f64 {
        self.height.as_ref().map_or(0.0, |height| {
            pose[height.coordinate] - self.coordinates[height.coordinate].home
        })
    }

    /// Changes the height in the coordinates of a pose to this one above home, metres, if there is one.
    #[inline]
    pub(crate) fn set_rise(&self, rise: f64, pose: &mut [f64]) {
        if let Some(height) = &self.height {
            pose[height.coordinate] = self.coordinates[height.coordinate].home + rise;
        }
    }

    /// The height above its home, metres, for the values of a section's coordinates; `None` if the section has no height.
    pub fn rise_in(&self, section: Section, of_section: &[f64]) -> Option<f64> {
        let place = self.height_in(section)?;
        Some(of_section[place] - self.coordinates[self.range(section)][place].home)
    }

    /// The components of the height among rates and accelerations of all task coordinates, m/s and m/s²; zeros where
    /// there is no height.
    #[inline]
    pub(crate) fn height_rates(&self, all: [&[f64]; 2]) -> [f64; 2] {
        self.height.as_ref().map_or([0.0; 2], |height| all.map(|values| values[height.coordinate]))
    }

    /// A displacement `v · b` of the platform, raised by `rise` metres along the direction of the Schoenflies section.
    pub(crate) fn raised(&self, rise: f64, g: Isometry3<f64>) -> Isometry3<f64> {
        match &self.height {
            None => g,
            Some(Height { section: Section::Lower, up, .. }) => Translation3::from(up * rise) * g,
            Some(Height { section: Section::Upper, up, .. }) => g * Translation3::from(up * rise),
        }
    }

    /// The same over any numbers, in base coordinates.
    #[inline(always)]
    pub(crate) fn placed<T: Real>(
        &self,
        v: &Displacement<T>,
        b: &Displacement<T>,
        rise: T,
    ) -> Placed<T> {
        let g = self.lower.placed(v).after(self.upper.placed(b));
        match &self.height {
            None => g,
            Some(Height { section: Section::Lower, up, .. }) => Placed::slid(up, rise).after(g),
            Some(Height { section: Section::Upper, up, .. }) => g.after(Placed::slid(up, rise)),
        }
    }

    /// The numbers of a section's coordinates.
    #[inline]
    pub(crate) fn range(&self, section: Section) -> Range<usize> {
        match section {
            Section::Lower => 0..self.lower_count,
            Section::Upper => self.lower_count..self.coordinates.len(),
        }
    }

    /// The values of a section's coordinates in the plane, without that of its height.
    #[inline]
    pub(crate) fn in_plane<T>(
        &self,
        section: Section,
        values: impl IntoIterator<Item = T>,
    ) -> impl Iterator<Item = T> {
        let height = self.height_in(section).unwrap_or(usize::MAX);
        let others = values.into_iter().enumerate().filter(move |(place, _)| *place != height);
        others.map(|(_, value)| value)
    }

    /// The place of the height among a section's coordinates; `None` if the section has none.
    #[inline]
    pub(crate) fn height_in(&self, section: Section) -> Option<usize> {
        let height = self.height.as_ref().filter(|height| height.section == section)?;
        Some(height.coordinate - self.range(section).start)
    }
}
