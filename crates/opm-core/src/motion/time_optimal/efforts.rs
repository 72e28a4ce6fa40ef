//! Limits of efforts along a path.
//!
//! With rates `q' √x` and accelerations `q' u + q'' x`, the effort of an actuator is `a u + b x + d √x + c`: inertia, viscous
//! friction, and what there is without motion, weight and dry friction. But for `d` that is a limit like those of accelerations,
//! with a room on each side of `c` that contains rest. The root is replaced by lines on the safe side of it: for efforts that grow with it by
//! its tangent at an `x₀`, the last solution, so that the fastest timing is found by a few repetitions; for those that shrink by its chord
//! up to an `x` a little above the last one. Where friction alone takes all the room, the speed is limited.

use crate::manipulator::Solution;
use crate::velocity::JointMotion;

/// The least `x₀` as a share of the largest `x`.
pub(super) const LEAST: f64 = 1e-6;

/// The effort of an actuator along a path, with the parameter's rate `√x` and acceleration `u`: `a u + b x + d √x + c`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathEffort {
    /// `a`: the effort for a unit of `u`, N or N m, by 1/s².
    pub by_acceleration: f64,
    /// `b`: the effort for a unit of `x`.
    pub by_square: f64,
    /// `d`: the effort of viscous friction for a unit of `√x`.
    pub viscous: f64,
    /// `c`: the effort of weight, load and dry friction.
    pub still: f64,
}

/// What gives the efforts of actuators along a path.
pub trait PathEfforts {
    /// The actuated coordinates that have a `max_effort`, by their numbers, and these efforts.
    fn limits(&self) -> &[(usize, f64)];

    /// The efforts of these at a solved pose, for the first and second derivatives of the joints by the parameter; `false` if one
    /// is not determined.
    fn at(&mut self, at: &Solution, derivatives: &JointMotion, out: &mut [PathEffort]) -> bool;
}

/// The effort of an actuator at a point of a path, and what is left of its limit above and below what it needs without motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    pub of: PathEffort,
    pub room: [f64; 2],
}

impl Effort {
    /// The largest `x` for which viscous friction alone stays within the room.
    pub fn largest_square(&self) -> f64 {
        let room = if self.of.viscous > 0.0 { self.room[0] } else { self.room[1] };
        (room / self.of.viscous).powi(2)
    }

    /// The largest `x` that is usual for it, for a parameter that takes so long.
    pub fn usual_square(&self, duration: f64) -> f64 {
        let size = self.of.by_square.abs() + self.of.by_acceleration.abs() / duration;
        (self.room[0].min(self.room[1]) / size).min(self.largest_square())
    }

    /// The shares of the room above and below that a motion takes; negative for none.
    pub fn shares(&self, u: f64, x: f64) -> [f64; 2] {
        let PathEffort { by_acceleration, by_square, viscous, .. } = self.of;
        let effort = by_acceleration * u + by_square * x + viscous * x.sqrt();
        [effort / self.room[0], -effort / self.room[1]].map(|share| share.max(0.0))
    }

    /// Adds the limits as `by_u u + by_x x <= room`. `guess` is about where `x` is, `most` the largest.
    pub fn half_planes(&self, [guess, most]: [f64; 2], mut add: impl FnMut(f64, f64, f64)) {
        let PathEffort { by_acceleration, by_square, viscous, .. } = self.of;
        for (sign, room) in [1.0, -1.0].into_iter().zip(self.room) {
            let root = viscous * sign;
            let (slope, taken) = if root == 0.0 {
                (0.0, 0.0)
            } else if root > 0.0 {
                let guess = guess.clamp(LEAST * most, most).sqrt();
                (0.5 * root / guess, 0.5 * root * guess)
            } else {
                (root / most.sqrt(), 0.0)
            };
            add(sign * by_acceleration, sign * by_square + slope, room - taken);
        }
    }
}
