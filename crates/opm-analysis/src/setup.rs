//! What a pose is judged by besides the pose itself: a load, springs, a length.

use crate::efforts::Efforts;
use crate::springs::Springs;
use crate::statics::{Statics, Velocity};
use crate::weights::{Gravity, JointMotion, Part, Weights};
use crate::wrench::{Load, Wrench};
use opm_core::manipulator::{Manipulator, Solution};

/// What indices and efforts are computed with.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The characteristic length, metres; usually [`Manipulator::characteristic_length`].
    pub length: f64,
    /// What acts on the platform.
    pub load: Option<Load>,
    /// What makes links and platform heavy.
    pub gravity: Option<Gravity>,
    /// How much the mechanism gives way.
    pub springs: Option<Springs>,
}

impl Setup {
    /// No load and no springs, with a characteristic length, metres.
    pub fn new(length: f64) -> Self {
        Self { length, load: None, gravity: None, springs: None }
    }

    /// The same with weights: [`Gravity::default`](crate::Gravity) if there is none.
    pub(crate) fn heavy(&self) -> Self {
        Self { gravity: Some(self.gravity.unwrap_or_default()), ..self.clone() }
    }

    /// Whether anything acts on the mechanism.
    pub fn has_load(&self) -> bool {
        self.load.is_some() || self.gravity.is_some()
    }
}

/// What acts on a mechanism, at one pose after the other.
///
/// ```
/// use nalgebra::Vector3;
/// use opm_analysis::{Gravity, Loads, Setup, Statics};
/// use opm_core::Manipulator;
/// use opm_core::skeleton::Density;
///
/// let manipulator = Manipulator::example("planar-3rrr")?;
/// let length = manipulator.characteristic_length();
/// let gravity = Gravity { acceleration: -9.81 * Vector3::y(), density: Density::default() };
/// let setup = Setup { gravity: Some(gravity), ..Setup::new(length) };
/// let mut loads = Loads::new(&manipulator, &setup).expect("links are heavy");
/// let mut statics = Statics::new(&manipulator, length);
/// let (mut buffer, home) = (manipulator.solution(), manipulator.home_pose());
/// let at = manipulator.inverse(&home, manipulator.home_mode(), &mut buffer)?;
/// let at = at.expect("home is in reach");
/// statics.update(at)?;
/// let efforts = loads.efforts(&statics, at);
/// assert!(efforts.actuated.iter().all(Option::is_some) && loads.mass() > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Loads<'a> {
    manipulator: &'a Manipulator,
    load: Load,
    pub(crate) weights: Option<Weights<'a>>,
    /// Working memory for a motion from rest: a rate and an acceleration for each joint coordinate.
    pub(crate) rest: Vec<f64>,
    pub(crate) accelerations: Vec<f64>,
}

impl<'a> Loads<'a> {
    /// The loads of a setup; `None` if it has none.
    pub fn new(manipulator: &'a Manipulator, setup: &Setup) -> Option<Self> {
        setup.has_load().then(|| Self::of(manipulator, setup))
    }

    /// The same, also if it has none.
    pub(crate) fn of(manipulator: &'a Manipulator, setup: &Setup) -> Self {
        let none = vec![0.0; manipulator.coordinates().len()];
        Self {
            manipulator,
            rest: none.clone(),
            accelerations: none,
            load: setup.load.unwrap_or_default(),
            weights: setup.gravity.map(|gravity| Weights::new(manipulator, &gravity)),
        }
    }

    /// The mass of the bodies whose weights act, kilograms; 0 without gravity.
    pub fn mass(&self) -> f64 {
        self.weights.as_ref().map_or(0.0, Weights::mass)
    }

    /// The same with another load on the platform.
    pub fn set_load(&mut self, load: Load) {
        self.load = load;
    }

    /// What acts on the platform, its own weight left out, as a wrench at its reference point.
    pub fn wrench(&self, at: &Solution) -> Wrench {
        self.load.on(&self.manipulator.platform_at(&at.displacement(self.manipulator)))
    }

    /// The work of all loads for each independent velocity at a pose, of which `statics` has taken the solution. `None` where
    /// the velocity of a link is not known.
    pub fn work(&mut self, statics: &Statics<'_>, at: &Solution) -> Option<Velocity> {
        self.work_in(statics, at, None)
    }

    /// The same with what resists a motion, if bodies have masses.
    pub fn work_in(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
    ) -> Option<Velocity> {
        let mut work = statics.work(&self.wrench(at));
        let own = self.work_of(statics, at, motion, Part::All)?;
        work.iter_mut().zip(own).for_each(|(part, own)| *part += own);
        Some(work)
    }

    /// The work of one part of what acts on the bodies, without the load on the platform.
    pub(crate) fn work_of(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
        part: Part,
    ) -> Option<Velocity> {
        match &mut self.weights {
            Some(weights) => weights.work_of(statics, at, motion, part),
            None => Some(Velocity::default()),
        }
    }

    /// The efforts that balance all loads.
    pub fn efforts(&mut self, statics: &Statics<'_>, at: &Solution) -> Efforts {
        self.efforts_in(statics, at, None)
    }

    /// The efforts that move the mechanism under all loads: inverse dynamics.
    ///
    /// ```
    /// use nalgebra::Vector3;
    /// use opm_analysis::{Gravity, JointMotion, Loads, Setup, Statics};
    /// use opm_core::Manipulator;
    /// use opm_core::skeleton::Density;
    ///
    /// let manipulator = Manipulator::example("delta")?;
    /// let gravity = Gravity { acceleration: -9.81 * Vector3::z(), density: Density::default() };
    /// let setup = Setup { gravity: Some(gravity), ..Setup::new(1.0) };
    /// let mut loads = Loads::new(&manipulator, &setup).expect("links are heavy");
    /// let mut statics = Statics::new(&manipulator, 1.0);
    /// let at = manipulator.solution(); // home
    /// statics.update(&at)?;
    /// // All cranks are accelerated downwards: their motors carry less.
    /// let (rates, mut accelerations) = ([0.0; 15], [0.0; 15]);
    /// let still = loads.efforts(&statics, &at).actuated[0].expect("an effort");
    /// let mut jacobians = manipulator.jacobians();
    /// manipulator.differentiate(&at, &mut jacobians)?;
    /// let down = jacobians.joints_by_pose().column(2) * -1.0; // 1 m/s² along -z
    /// accelerations.copy_from_slice(down.as_slice());
    /// let motion = JointMotion { rates: &rates, accelerations: &accelerations };
    /// let falling = loads.efforts_in(&statics, &at, Some(motion)).actuated[0].expect("an effort");
    /// assert!(falling.abs() < still.abs());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn efforts_in(
        &mut self,
        statics: &Statics<'_>,
        at: &Solution,
        motion: Option<JointMotion<'_>>,
    ) -> Efforts {
        let regular = statics.is_regular();
        match regular.then(|| self.work_in(statics, at, motion)).flatten() {
            Some(work) => statics.efforts_for(&work),
            None => Efforts::singular(self.manipulator),
        }
    }
}
