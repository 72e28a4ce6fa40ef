//! The continuous numbers that decide about an aspect, at one pose: measures of singularity and distances from
//! the limits of joints.

use opm_core::Quantity;
use opm_core::chain::limits::Limits;
use opm_core::manipulator::{Manipulator, Mode, Section, Solution};
use opm_core::velocity::{Jacobians, SINGULAR, Singularities};

/// Evaluates the levels of poses in one working mode. It holds the working memory for that.
///
/// The levels of a pose are, in this order: the parallel measures; both serial measures of every leg; and for
/// every limited joint coordinate the distances from its lower and from its upper limit.
pub struct Levels<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    solution: Solution,
    jacobians: Jacobians,
    measured: Singularities,
    parallel: Parallel,
    /// For both sections of each leg, whether it constrains the platform. Joints that never move complete it, and others
    /// may at the next pose: the sign of its serial measure means nothing.
    constrains: Vec<[bool; 2]>,
    limited: Vec<Limited>,
}

/// The parallel measures that a mechanism has.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Parallel {
    /// One of each section.
    Sections,
    /// One of the whole mechanism, because a section by itself has none.
    Whole,
    /// None: there are fewer inputs than degrees of freedom.
    Missing,
}

/// A joint coordinate with limits.
struct Limited {
    coordinate: usize,
    home: f64,
    low: f64,
    high: f64,
    angle: bool,
}

impl<'a> Levels<'a> {
    pub fn new(manipulator: &'a Manipulator, mode: Mode) -> Self {
        let mut measured = manipulator.singularities();
        let (solution, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
        // A new solution is home. Whether there are measures does not depend on the pose.
        let _ = manipulator.differentiate(&solution, &mut jacobians);
        manipulator.measure_singularities(&jacobians, &mut measured);
        let parallel = match (measured.lower.parallel, measured.upper.parallel) {
            (Some(_), Some(_)) => Parallel::Sections,
            _ if measured.whole.parallel.is_some() => Parallel::Whole,
            _ => Parallel::Missing,
        };
        let coordinates = manipulator.coordinates().iter().zip(manipulator.limits()).enumerate();
        let limited = coordinates.filter_map(|(coordinate, (c, limits))| {
            let Limits::Range { low, high, .. } = *limits else { return None };
            let angle = c.quantity == Quantity::Angle;
            Some(Limited { coordinate, home: c.home, low, high, angle })
        });
        let limited = limited.collect();
        let mut constrains = vec![[false; 2]; manipulator.mechanism().legs.len()];
        for (leg, section) in manipulator.constraining_legs() {
            constrains[leg][usize::from(section == Some(Section::Upper))] = true;
        }
        Self { manipulator, mode, solution, jacobians, measured, parallel, constrains, limited }
    }

    /// Whether the mechanism has parallel measures.
    pub fn exist(&self) -> bool {
        self.parallel != Parallel::Missing
    }

    /// The number of the parallel measures, which are the first levels.
    pub fn parallel(&self) -> usize {
        match self.parallel {
            Parallel::Sections => 2,
            Parallel::Whole => 1,
            Parallel::Missing => 0,
        }
    }

    /// The number of levels that must not change their signs within an aspect: all measures.
    pub fn signed(&self) -> usize {
        self.parallel() + 2 * self.manipulator.mechanism().legs.len()
    }

    /// The number of levels.
    pub fn count(&self) -> usize {
        self.signed() + 2 * self.limited.len()
    }

    /// Puts the levels of a pose into `out`, and returns whether it is in reach.
    pub fn at(&mut self, pose: &[f64], out: &mut Vec<f64>) -> bool {
        out.clear();
        let Self {
            manipulator,
            mode,
            solution,
            jacobians,
            measured,
            parallel,
            constrains,
            limited,
        } = self;
        let Ok(Some(solution)) = manipulator.inverse(pose, *mode, solution) else { return false };
        if manipulator.differentiate(solution, jacobians).is_err() {
            return false;
        }
        manipulator.measure_singularities(jacobians, measured);
        match parallel {
            Parallel::Sections => {
                out.extend(
                    [measured.lower.parallel, measured.upper.parallel].into_iter().flatten(),
                );
            }
            Parallel::Whole => out.extend(measured.whole.parallel),
            Parallel::Missing => {}
        }
        let serial = measured.legs.iter().flatten().zip(constrains.iter().flatten());
        out.extend(serial.map(|(level, unsigned)| if *unsigned { level.abs() } else { *level }));
        for Limited { coordinate, home, low, high, .. } in limited {
            let value = solution.joints()[*coordinate] - *home;
            out.extend([value - *low, *high - value]);
        }
        out.iter().all(|level| level.is_finite())
    }

    /// Whether a pose with these levels is singular.
    pub fn singular(&self, levels: &[f64]) -> bool {
        !self.exist() || levels[..self.signed()].iter().any(|level| level.abs() < SINGULAR)
    }

    /// The smallest measure without its sign: how far from a singularity the pose is, without dimension.
    pub fn clearance(&self, levels: &[f64]) -> f64 {
        levels[..self.signed()].iter().fold(f64::INFINITY, |least, level| least.min(level.abs()))
    }

    /// Whether a limited angle jumps by half a revolution or more between two poses: it goes round the other way.
    pub fn jump(&self, a: &[f64], b: &[f64]) -> bool {
        let first = self.signed();
        let mut angles = self.limited.iter().enumerate().filter(|(_, limited)| limited.angle);
        angles.any(|(i, _)| (a[first + 2 * i] - b[first + 2 * i]).abs() >= std::f64::consts::PI)
    }
}
