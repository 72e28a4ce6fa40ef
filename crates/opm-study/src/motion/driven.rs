//! The efforts of the actuators along a motion: inverse dynamics.

use opm_analysis::{JointMotion, Loads, Setup, Statics};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::DriveLimit;
use opm_core::trajectory::Sample;

/// A rate below this share of the largest is none, nor is such an acceleration.
const STILL: f64 = 1e-9;

/// The efforts of samples of a motion, which come in the order of time.
pub struct Driven<'a> {
    statics: Statics<'a>,
    loads: Option<Loads<'a>>,
    values: Vec<f64>,
    senses: Senses,
}

/// Which way the joints move, for their dry friction, in the order of time.
#[derive(Clone, Debug, Default)]
pub(super) struct Senses {
    /// For each joint coordinate.
    senses: Vec<Sense>,
    rates: Vec<f64>,
}

impl Senses {
    /// How the joints move at the next sample, with rates that have a sign where friction has one.
    pub(super) fn next<'b>(&'b mut self, sample: &'b Sample) -> JointMotion<'b> {
        let (rates, accelerations) =
            (&sample.motion.joint_rates, &*sample.motion.joint_accelerations);
        self.senses.resize(rates.len(), Sense::default());
        let moved = self.senses.iter_mut().zip(rates).zip(accelerations);
        self.rates.clear();
        self.rates.extend(moved.map(|((sense, &rate), &own)| sense.next(rate, own)));
        JointMotion { rates: &self.rates, accelerations }
    }
}

/// Which way a joint moves, for its dry friction, also where it only just begins or ends to move.
#[derive(Clone, Copy, Debug, Default)]
struct Sense {
    /// The largest rate and acceleration so far, without signs.
    largest: [f64; 2],
    /// The sign of the rate before; zero at rest.
    before: f64,
}

impl Sense {
    /// The rate of the next sample. At rest it is the smallest one with the sign that friction has: where the joint comes to rest
    /// that of the rate before, where it leaves rest that of its acceleration, and else zero.
    fn next(&mut self, rate: f64, acceleration: f64) -> f64 {
        let [rates, accelerations] = &mut self.largest;
        *rates = rates.max(rate.abs());
        *accelerations = accelerations.max(acceleration.abs());
        // A joint that has this acceleration for a second has a rate of the same number.
        let moves = rate.abs() > STILL * rates.max(*accelerations);
        let speeds = acceleration.abs() > STILL * *accelerations;
        let (rate, before) = match (moves, speeds, self.before) {
            (true, ..) => (rate, rate.signum()),
            (false, false, _) => (0.0, 0.0),
            (false, true, 0.0) => (acceleration.signum() * f64::MIN_POSITIVE, 0.0),
            (false, true, before) => (before * f64::MIN_POSITIVE, 0.0),
        };
        self.before = before;
        rate
    }
}

impl<'a> Driven<'a> {
    pub fn new(manipulator: &'a Manipulator, setup: &Setup) -> Self {
        Self {
            statics: Statics::new(manipulator, setup.length),
            loads: Loads::new(manipulator, setup),
            values: vec![f64::NAN; manipulator.actuated().len()],
            senses: Senses::default(),
        }
    }

    /// The names of the columns of [`Driven::values`], `effort.NAME`, with their units.
    pub fn columns(manipulator: &Manipulator) -> impl Iterator<Item = (String, &'static str)> + '_ {
        let all = manipulator.coordinates();
        let unit = |&number: &usize| DriveLimit::Effort.unit(all[number].quantity);
        // Those of imaginary joints come after.
        crate::columns::efforts(manipulator).zip(manipulator.actuated().iter().map(unit))
    }

    /// The effort of each actuated coordinate, N and N m; not a number where it is not known: out of reach, at singularities, and
    /// where redundant actuators can work against each other.
    pub fn values(&mut self, sample: &Sample) -> &[f64] {
        self.values.fill(f64::NAN);
        let moving = sample.reached && sample.regular;
        let regular = moving && self.statics.update(&sample.solution).unwrap_or(false);
        if let Some(loads) = self.loads.as_mut().filter(|_| regular) {
            let motion = self.senses.next(sample);
            let efforts = loads.efforts_in(&self.statics, &sample.solution, Some(motion));
            for (value, effort) in self.values.iter_mut().zip(efforts.actuated) {
                *value = effort.unwrap_or(f64::NAN);
            }
        }
        &self.values
    }
}

/// What a motor has to do along a motion, over the samples at which that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Duty {
    /// The largest effort without its sign, N or N m, and its time, seconds; `None` if no effort is known.
    pub peak: Option<[f64; 2]>,
    /// The rate of the joint at that time, rad/s or m/s; positive where the motor drives it.
    pub rate_at_peak: f64,
    /// The largest power that it gives, and the largest that it takes (negative), W.
    pub power: [f64; 2],
    /// The number of samples, and the sum of the squares of the efforts.
    samples: u64,
    squares: f64,
}

impl Duty {
    pub(super) fn add(&mut self, effort: f64, rate: f64, time: f64) {
        if !effort.is_finite() {
            return;
        }
        if self.peak.is_none_or(|[peak, _]| effort.abs() > peak) {
            self.peak = Some([effort.abs(), time]);
            // Not -0.
            self.rate_at_peak = rate * effort.signum() + 0.0;
        }
        let power = effort * rate;
        self.power = [self.power[0].max(power), self.power[1].min(power)];
        self.samples += 1;
        self.squares += effort * effort;
    }

    /// The root of the mean of the squares of the effort, by which a motor gets warm; N or N m.
    pub fn rms(&self) -> Option<f64> {
        (self.samples > 0).then(|| (self.squares / self.samples as f64).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_at_rest_has_the_sign_of_the_motion_beside_it() {
        let mut sense = Sense::default();
        let signs = |sense: &mut Sense, samples: &[[f64; 2]]| -> Vec<f64> {
            let sign = |rate: f64| if rate == 0.0 { 0.0 } else { rate.signum() };
            samples.iter().map(|&[rate, own]| sign(sense.next(rate, own))).collect()
        };
        // It starts with the acceleration, whatever rounding says, ends with the rate before, and rests without.
        let there = [[-1e-18, 2.0], [1.0, 0.0], [0.5, -2.0], [1e-17, -2.0], [-1e-17, 0.0]];
        assert_eq!(signs(&mut sense, &there), [1.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(signs(&mut sense, &[[1e-17, -2.0], [-1.0, 0.0], [0.0, 2.0]]), [-1.0; 3]);
        // Where it turns about it has that of before; slow motion is motion.
        assert_eq!(signs(&mut sense, &[[-1.0, 2.0], [0.0, 2.0], [1e-3, 2.0]]), [-1.0, -1.0, 1.0]);
    }
}
