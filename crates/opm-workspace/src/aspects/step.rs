//! Motions that are watched for singularities between their poses.

use opm_core::manipulator::{Manipulator, Mode};
use opm_core::motion::{Ends, Path, PlatformMotion, Spline};
use opm_core::trajectory::{Change, Gauge, Trajectory, TrajectoryError, Violation};

/// Whether the platform can go from one pose straight to another in one working mode: in reach, within the limits
/// of all joints, and without a singularity.
///
/// The way is watched as every motion is ([`opm_core::trajectory`]): what comes and goes once between the two
/// poses is found.
pub fn is_clear(manipulator: &Manipulator, mode: Mode, from: &[f64], to: &[f64]) -> bool {
    let columns = from.iter().zip(to).map(|(&from, &to)| vec![from, to]).collect();
    // The natural spline of two points is the line between them.
    let line = Spline::new(vec![0.0, 1.0], columns, Ends::Natural);
    line.is_ok_and(|line| matches!(violation(manipulator, mode, line, 1.0), Ok(None)))
}

/// The first violation along a motion that is sampled at a rate, in hertz. Limits of rates and of accelerations do not
/// count: they depend on the timing alone.
///
/// # Errors
/// The motion is not one of this manipulator.
pub fn violation(
    manipulator: &Manipulator,
    mode: Mode,
    path: Spline,
    rate: f64,
) -> Result<Option<Violation>, TrajectoryError> {
    let times = path.times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let motion = PlatformMotion {
        name: String::new(),
        start,
        duration: end - start,
        rate: None,
        mode: None,
        path: Path::Spline(path),
    };
    let mut trajectory = Trajectory::new(manipulator, &motion, mode, rate)?;
    while trajectory.advance()? {
        let of_pose = |change: &Change| match *change {
            Change::Begins(violation) | Change::Ends(violation) => {
                (!matches!(violation.gauge, Gauge::Motion { .. })).then_some(violation)
            }
        };
        if let Some(found) = trajectory.changes().iter().find_map(of_pose) {
            return Ok(Some(found));
        }
    }
    Ok(None)
}
