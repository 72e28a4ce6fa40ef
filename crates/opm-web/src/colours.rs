//! Numbers that colour a slice: conditioning, transmission, clearance, or a joint.

use crate::explorer::Explorer;
use crate::pose::quantities;
use crate::problem::Problems;
use crate::request::{AxisRequest, Coordinates};
use crate::session::Reply;
use crate::workspace::Plane;
use opm_analysis::{Index, Transmissions};
use opm_core::Quantity;
use opm_core::manipulator::Solution;
use opm_interference::Distances;
use opm_workspace::{Conditioned, GridSet, PoseLimit, Progress};
use serde::Serialize;

/// The colour that is the local conditioning index.
const CONDITION: &str = "condition";
/// The colour that is the local transmission index, and that which is the distance of the nearest two bodies.
const TRANSMISSION: &str = Index::Lti.name();
const CLEARANCE: &str = Index::Clearance.name();

/// The range of the numbers that colour a slice. The bytes are a 32-bit number for each pose, in the order of those of
/// the slice; NaN where it is not reachable.
#[derive(Serialize)]
struct Colours {
    unit: &'static str,
    min: Option<f64>,
    max: Option<f64>,
}

/// A number for each reachable pose of a plane grid.
pub fn colours(
    explorer: &Explorer,
    axes: [&AxisRequest; 2],
    pose: &Coordinates,
    mode: Option<&str>,
    by: &str,
) -> Result<Reply, Problems> {
    let (manipulator, units) = (explorer.manipulator(), explorer.units());
    let mut picture = Picture::new(explorer, axes, pose, mode)?;
    let unit = match by {
        CONDITION => {
            picture.condition(explorer);
            ""
        }
        TRANSMISSION => {
            let mut transmissions = Transmissions::new(manipulator)
                .map_err(|error| Problems::one(format!("{TRANSMISSION}: {error}")))?;
            picture.of_solutions(explorer, mode, |at| {
                transmissions.update(at);
                transmissions.whole().local()
            })?;
            ""
        }
        CLEARANCE => {
            let interference = explorer.interference();
            if interference.pairs() == 0 {
                let problem = "no two bodies that could interfere";
                return Err(Problems::one(format!("{CLEARANCE}: {problem}")));
            }
            let mut distances = Distances::new(interference);
            picture.of_solutions(explorer, mode, |at| {
                distances.place(manipulator, at);
                let nearest = distances.nearest().map_or(f64::NAN, |nearest| nearest.distance);
                nearest / units.factor(Quantity::Length)
            })?;
            units.symbol(Quantity::Length)
        }
        joint => {
            let names = manipulator.coordinates().iter().map(|c| &c.name);
            let mut names = names.chain(manipulator.imaginary().iter().map(|joint| &joint.name));
            let place = names.position(|name| name == joint);
            let quantity = place.and_then(|place| quantities(manipulator).nth(place));
            let (Some(place), Some(quantity)) = (place, quantity) else {
                return Err(Problems::one(format!(
                    "{by:?} is not a joint, nor {CONDITION:?}, {TRANSMISSION:?} or {CLEARANCE:?}"
                )));
            };
            picture.of_solutions(explorer, mode, |at| {
                let mut values = at.joints().iter().chain(at.imaginary());
                values.nth(place).map_or(f64::NAN, |value| value / units.factor(quantity))
            })?;
            units.symbol(quantity)
        }
    };
    let bytes = picture.numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    let [min, max] = picture.range.map_or([None; 2], |range| range.map(Some));
    Ok(Reply::with_bytes(&Colours { unit, min, max }, bytes))
}

/// The reachable poses of a plane grid, and their numbers.
struct Picture {
    plane: Plane,
    set: GridSet,
    numbers: Vec<f32>,
    range: Option<[f64; 2]>,
}

impl Picture {
    fn new(
        explorer: &Explorer,
        axes: [&AxisRequest; 2],
        pose: &Coordinates,
        mode: Option<&str>,
    ) -> Result<Self, Problems> {
        let plane = Plane::new(explorer, axes, pose, mode)?;
        let set = GridSet::reached(&plane.workspace.poses(), &Progress::default());
        let set = set.map_err(|error| Problems::of(&error))?;
        let numbers = vec![f32::NAN; plane.points()];
        Ok(Self { plane, set, numbers, range: None })
    }

    /// Notes the value of a pose.
    fn note(&mut self, number: u64, value: f64) {
        self.numbers[self.plane.place(number)] = value as f32;
        if !value.is_nan() {
            let [min, max] = self.range.get_or_insert([value; 2]);
            (*min, *max) = (min.min(value), max.max(value));
        }
    }

    fn condition(&mut self, explorer: &Explorer) {
        let manipulator = explorer.manipulator();
        let limit = PoseLimit::none(manipulator.characteristic_length()).with_condition(f64::MAX);
        let mut conditioned = Conditioned::new(manipulator, limit);
        let poses: Vec<f64> =
            self.set.numbers().flat_map(|number| self.set.point(number)).collect();
        let mut indices = vec![0.0; self.set.count() as usize];
        conditioned.local_indices(&poses, self.plane.workspace.modes(), &mut indices);
        let numbers: Vec<u64> = self.set.numbers().collect();
        for (number, index) in numbers.into_iter().zip(indices) {
            // A pose without a finite condition number is singular.
            self.note(number, if index.is_nan() { 0.0 } else { index });
        }
    }

    /// Notes what is found at each solved pose.
    fn of_solutions(
        &mut self,
        explorer: &Explorer,
        mode: Option<&str>,
        mut value: impl FnMut(&Solution) -> f64,
    ) -> Result<(), Problems> {
        let manipulator = explorer.manipulator();
        let (mode, mut buffer) = (explorer.mode(mode)?, manipulator.solution());
        let numbers: Vec<u64> = self.set.numbers().collect();
        for number in numbers {
            let found = manipulator.inverse(&self.set.point(number), mode, &mut buffer);
            if let Some(solution) = found.map_err(|error| Problems::of(&error))? {
                self.note(number, value(solution));
            }
        }
        Ok(())
    }
}
