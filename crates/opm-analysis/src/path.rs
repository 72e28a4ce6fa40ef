//! The fastest timing of a motion within the efforts of its actuators.

use crate::setup::{Loads, Setup};
use crate::statics::{Statics, Velocity};
use crate::weights::{JointMotion, Part};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::motion::{
    PathEffort, PathEfforts, PathLimits, PlatformMotion, TimingError, ToolLimits,
};
use opm_core::velocity::JointMotion as Derivatives;

/// A motion along the same path, from rest to rest, in the shortest time within `max_rate`, `max_acceleration` and `max_effort` of all
/// joints that have them ([`PlatformMotion::time_optimal_within`]). Efforts are those of the inverse dynamics with the load and the
/// gravity of a setup ([`Gravity::default`](crate::Gravity) if it has none).
///
/// ```
/// use opm_analysis::{Setup, time_optimal};
/// use opm_core::Manipulator;
/// use opm_core::motion::{Ends, Path, PlatformMotion, Spline};
///
/// let text = opm_core::mechanism::examples::find("delta").expect("shipped").text;
/// let limits = "max_effort = 60";
/// let text = text.replace("actuated = true", &format!("actuated = true, {limits}"));
/// let manipulator = Manipulator::read(&text)?;
/// let home = manipulator.home_pose();
/// let columns = vec![vec![home[0], home[0] + 0.1], vec![home[1]; 2], vec![home[2]; 2]];
/// let path = Path::Spline(Spline::new(vec![0.0, 1.0], columns, Ends::Rest)?);
/// let name = "ahead".to_owned();
/// let slow = PlatformMotion { name, start: 0.0, duration: 1.0, rate: None, mode: None, path };
/// let fast = time_optimal(&slow, &manipulator, manipulator.home_mode(), &Setup::new(1.0))?;
/// assert!(fast.duration < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TimingError`]: an actuated joint has no limit, an actuator cannot stand what acts at rest, nothing moves, or the motion cannot be
/// followed.
pub fn time_optimal(
    motion: &PlatformMotion,
    manipulator: &Manipulator,
    mode: Mode,
    setup: &Setup,
) -> Result<PlatformMotion, TimingError> {
    time_optimal_with_tool(motion, (manipulator, mode), setup, ToolLimits::default())
}

/// The same ([`time_optimal`]), also within caps of the tool's speed and acceleration.
///
/// # Errors
/// As there, and for a cap that is not above zero.
pub fn time_optimal_with_tool(
    motion: &PlatformMotion,
    (manipulator, mode): (&Manipulator, Mode),
    setup: &Setup,
    tool: ToolLimits,
) -> Result<PlatformMotion, TimingError> {
    let mut limited = Limited::new(manipulator, setup);
    let efforts = limited.as_mut().map(|limited| limited as &mut dyn PathEfforts);
    motion.time_optimal_within(manipulator, mode, PathLimits { tool, efforts })
}

/// The actuators that have a `max_effort`.
struct Limited<'a> {
    loads: Loads<'a>,
    statics: Statics<'a>,
    /// Their places among the actuated coordinates.
    actuated: Vec<usize>,
    limits: Vec<(usize, f64)>,
    rest: Vec<f64>,
}

impl<'a> Limited<'a> {
    fn new(manipulator: &'a Manipulator, setup: &Setup) -> Option<Self> {
        let coordinates = manipulator.coordinates();
        let each = manipulator.actuated().iter().enumerate();
        let each = each.filter_map(|(i, &c)| Some((i, (c, coordinates[c].max_effort?))));
        let (actuated, limits): (Vec<_>, Vec<_>) = each.unzip();
        let setup = setup.heavy();
        (!limits.is_empty()).then(|| Self {
            loads: Loads::of(manipulator, &setup),
            statics: Statics::new(manipulator, setup.length),
            actuated,
            limits,
            rest: vec![0.0; coordinates.len()],
        })
    }

    /// The works of the parts of a motion with these derivatives: for a unit of `u`, of `x` and of `√x`, and what there is without.
    fn works(&mut self, at: &Solution, derivatives: &Derivatives) -> Option<[Velocity; 4]> {
        let Self { loads, statics, rest, .. } = self;
        if !statics.update(at).ok()? {
            return None;
        }
        let (first, second) = (&derivatives.joint_rates, &derivatives.joint_accelerations);
        let along = JointMotion { rates: first, accelerations: second };
        let speeding = JointMotion { rates: rest, accelerations: first };
        let mut part = |motion, part| loads.work_of(statics, at, Some(motion), part);
        let moving = [
            part(speeding, Part::Inertia)?,
            part(along, Part::Inertia)?,
            part(along, Part::Viscous)?,
        ];
        let still = [part(along, Part::Weight)?, part(along, Part::Coulomb)?];
        let load = statics.work(&loads.wrench(at));
        let still = std::array::from_fn(|k| load[k] + still[0][k] + still[1][k]);
        let [by_u, by_x, viscous] = moving;
        Some([by_u, by_x, viscous, still])
    }
}

impl PathEfforts for Limited<'_> {
    fn limits(&self) -> &[(usize, f64)] {
        &self.limits
    }

    fn at(&mut self, at: &Solution, derivatives: &Derivatives, out: &mut [PathEffort]) -> bool {
        let Some(works) = self.works(at, derivatives) else { return false };
        for (out, &actuated) in out.iter_mut().zip(&self.actuated) {
            let efforts = works.each_ref().map(|work| self.statics.effort_under(actuated, work));
            let [Some(by_acceleration), Some(by_square), Some(viscous), Some(still)] = efforts
            else {
                return false;
            };
            let all = [by_acceleration, by_square, viscous, still];
            if all.iter().any(|effort| !effort.is_finite()) {
                return false;
            }
            *out = PathEffort { by_acceleration, by_square, viscous, still };
        }
        true
    }
}
