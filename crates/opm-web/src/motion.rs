//! Motions of the platform, followed from end to end as `opm trajectory` does.

use crate::explorer::Explorer;
use crate::pose::values;
use crate::problem::Problems;
use crate::session::Reply;
use crate::units::shown;
use opm_core::motion::examples::MOTIONS;
use opm_core::motion::table::TableOptions;
use opm_core::motion::{file, table};
use opm_core::trajectory::ViolationReport;
use opm_study::MotionRequest;
use opm_study::text::chain;
use serde::Serialize;

/// Most samples of a motion: more than a page draws.
const MOST_SAMPLES: u64 = 100_000;

/// A shipped motion.
#[derive(Serialize)]
struct Shipped {
    name: &'static str,
    mechanism: &'static str,
    description: &'static str,
    text: &'static str,
}

/// The answer to a motion. The bytes are a row of 32-bit numbers for each sample: the time in seconds, the task
/// coordinates, and the joint coordinates and imaginary joints in the file's units; NaN where a pose is out of reach.
#[derive(Serialize)]
struct Followed {
    name: String,
    mode: String,
    samples: u64,
    reached: u64,
    valid: u64,
    columns: usize,
    violations: Vec<Violation>,
    /// The number of all violations; the list may be shorter.
    violation_count: u64,
}

/// Where the mechanism cannot follow. Times are in seconds.
#[derive(Serialize)]
struct Violation {
    kind: &'static str,
    joint: Option<String>,
    start: f64,
    end: f64,
    text: String,
}

/// The motions that opm ships.
pub fn shipped() -> Reply {
    let shipped = MOTIONS.iter().map(|motion| Shipped {
        name: motion.name,
        mechanism: motion.mechanism,
        description: motion.description,
        text: motion.text,
    });
    Reply::new(&shipped.collect::<Vec<_>>())
}

/// Follows the motion of a file: a table of poses if its name ends in `.csv`. A motion without a mode of its own is
/// followed in this one.
pub fn follow(
    explorer: &Explorer,
    name: &str,
    text: &str,
    mode: Option<&str>,
) -> Result<Reply, Problems> {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let motion = match ending.eq_ignore_ascii_case("csv") {
        true => table::read(text, stem, manipulator, &TableOptions { units, ..Default::default() })
            .map(|read| read.motion),
        false => file::read(text, manipulator),
    }
    .map_err(|errors| Problems::from(errors).in_file(name))?;
    let mode = motion.mode.map_or_else(|| explorer.mode(mode), Ok)?;
    let request = MotionRequest::new(manipulator, &motion, name).mode(mode);
    let trajectory = request.trajectory().map_err(|error| Problems::of(&error))?;
    let samples = trajectory.samples();
    if samples > MOST_SAMPLES {
        let problem = format!("{name}: {samples} samples, expected at most {MOST_SAMPLES}");
        return Err(Problems::one(problem));
    }
    let coordinates = manipulator.task_coordinates();
    let joints = manipulator.coordinates().len() + manipulator.imaginary().len();
    let columns = 1 + coordinates.len() + joints;
    let mut rows: Vec<f32> = Vec::with_capacity(columns * samples as usize);
    let take = |_, sample: &opm_core::trajectory::Sample, _: &[_]| {
        rows.push(sample.time as f32);
        let pose = sample.instant.pose.iter().zip(coordinates);
        rows.extend(pose.map(|(&value, c)| (value / units.factor(c.quantity)) as f32));
        match sample.reached {
            true => {
                let solution = &sample.solution;
                let all = values(explorer, solution.joints(), solution.imaginary());
                rows.extend(all.into_iter().map(|value| value as f32));
            }
            false => rows.extend(std::iter::repeat_n(f32::NAN, joints)),
        }
        Ok(())
    };
    let summary =
        request.follow(trajectory, take, |_| true).map_err(|error| Problems::one(chain(&error)))?;
    let violation = |violation: &opm_core::trajectory::Violation| {
        let report = ViolationReport::new(violation, manipulator);
        let amount = violation.quantity.map_or_else(String::new, |quantity| {
            let amount = shown(violation.amount, quantity, units);
            let per_time = report.per_time();
            format!(" by {amount:.4} {}{per_time}", units.symbol(quantity))
        });
        Violation {
            kind: report.kind,
            joint: report.joint.map(str::to_owned),
            start: violation.start,
            end: violation.end,
            text: format!("{}{amount}", report.what()),
        }
    };
    let followed = Followed {
        name: motion.name.clone(),
        mode: manipulator.format_mode(mode),
        samples: summary.samples,
        reached: summary.reached,
        valid: summary.valid,
        columns,
        violations: summary.violations.iter().map(violation).collect(),
        violation_count: summary.violation_count,
    };
    Ok(Reply::with_bytes(&followed, rows.into_iter().flat_map(f32::to_le_bytes).collect()))
}
