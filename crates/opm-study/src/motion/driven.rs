//! The efforts of the actuators along a motion: inverse dynamics.

use opm_analysis::{JointMotion, Loads, Setup, Statics};
use opm_core::manipulator::Manipulator;
use opm_core::trajectory::Sample;

/// The efforts of samples of a motion.
pub struct Driven<'a> {
    statics: Statics<'a>,
    loads: Option<Loads<'a>>,
    values: Vec<f64>,
}

impl<'a> Driven<'a> {
    pub fn new(manipulator: &'a Manipulator, setup: &Setup) -> Self {
        Self {
            statics: Statics::new(manipulator, setup.length),
            loads: Loads::new(manipulator, setup),
            values: vec![f64::NAN; manipulator.actuated().len()],
        }
    }

    /// The effort of each actuated coordinate, N and N m; not a number where it is not known: out of reach, at singularities, and
    /// where redundant actuators can work against each other.
    pub fn values(&mut self, sample: &Sample) -> &[f64] {
        self.values.fill(f64::NAN);
        let moving = sample.reached && sample.regular;
        let regular = moving && self.statics.update(&sample.solution).unwrap_or(false);
        if let Some(loads) = self.loads.as_mut().filter(|_| regular) {
            let (rates, accelerations) =
                (&*sample.motion.joint_rates, &*sample.motion.joint_accelerations);
            let motion = JointMotion { rates, accelerations };
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
