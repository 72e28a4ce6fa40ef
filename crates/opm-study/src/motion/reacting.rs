//! What passes through the joints along a motion.

use super::driven::Senses;
use opm_analysis::{Compliant, Loads, Setup, Wrench};
use opm_core::manipulator::Manipulator;
use opm_core::trajectory::Sample;

/// The reactions at samples of a motion, which come in the order of time.
pub struct Reacting<'a> {
    compliant: Compliant<'a>,
    /// What acts on the platform.
    loads: Loads<'a>,
    senses: Senses,
    values: Vec<f64>,
}

/// The components of a wrench, and their units.
#[cfg(feature = "recording")]
const COMPONENTS: [(&str, &str); 6] =
    [("FX", "N"), ("FY", "N"), ("FZ", "N"), ("MX", "N m"), ("MY", "N m"), ("MZ", "N m")];

impl<'a> Reacting<'a> {
    /// With the springs of a setup, and its gravity ([`Gravity::default`](opm_analysis::Gravity) if it has none); `None` if it has no
    /// springs, or such that do not suit the manipulator.
    pub fn new(manipulator: &'a Manipulator, setup: &Setup) -> Option<Self> {
        let gravity = setup.gravity.unwrap_or_default();
        let compliant = Compliant::new(manipulator, setup.springs.clone()?).ok()?;
        let setup = Setup { gravity: Some(gravity), ..setup.clone() };
        let joints = manipulator.mechanism().joints().count();
        Some(Self {
            compliant: compliant.with_gravity(&gravity),
            loads: Loads::new(manipulator, &setup)?,
            senses: Senses::default(),
            values: vec![f64::NAN; 6 * joints],
        })
    }

    /// The names of the columns of [`Reacting::values`], `reaction.NAME.FX`, with their units.
    #[cfg(feature = "recording")]
    pub fn columns(manipulator: &Manipulator) -> impl Iterator<Item = (String, &'static str)> + '_ {
        manipulator.mechanism().joints().flat_map(|joint| {
            let name = &joint.name;
            COMPONENTS.map(|(part, unit)| (format!("reaction.{name}.{part}"), unit))
        })
    }

    /// The wrench through each joint at its point, base directions, six numbers for each; not numbers where they are not known: out of
    /// reach, at serial singularities, and where the platform moves without resistance.
    pub fn values(&mut self, sample: &Sample) -> &[f64] {
        self.values.fill(f64::NAN);
        if !sample.reached || !sample.regular {
            return &self.values;
        }
        let (at, motion) = (&sample.solution, self.senses.next(sample));
        let stiffness = self.compliant.stiffness_in(at, Some(motion));
        let load = self.loads.wrench(at);
        let found = stiffness.and_then(|stiffness| self.compliant.reactions(&stiffness, &load));
        let each = found.iter().flat_map(|found| &found.joints).flat_map(Wrench::components);
        self.values.iter_mut().zip(each).for_each(|(to, part)| *to = part);
        &self.values
    }
}

/// What a joint has to bear along a motion, over the samples at which that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bearing {
    /// The largest force, N, and its time, seconds; `None` if none is known.
    pub force: Option<[f64; 2]>,
    /// The largest moment, N m, and its time, seconds.
    pub moment: Option<[f64; 2]>,
}

impl Bearing {
    /// Takes a wrench.
    pub(super) fn add(&mut self, wrench: &[f64], time: f64) {
        let norm = |parts: &[f64]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        let (force, moment) = wrench.split_at(3);
        for (largest, size) in [(&mut self.force, norm(force)), (&mut self.moment, norm(moment))] {
            if size.is_finite() && largest.is_none_or(|[known, _]| size > known) {
                *largest = Some([size, time]);
            }
        }
    }
}
