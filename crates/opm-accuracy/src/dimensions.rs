//! Rates of joints and of the pose with the dimensions that a file gives by name.

use crate::chain::unit;
use crate::source::{STEP, changed_file, parts, stepped};
use nalgebra::DMatrix;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::file::MechanismFile;
use opm_core::velocity::VelocityError;
use std::f64::consts::TAU;

/// A manipulator, and what it is with a larger and with a smaller value of each dimension. Central differences of closed forms are
/// exact to some 1e-9.
#[derive(Clone, Debug)]
pub struct Dimensions<'a> {
    manipulator: &'a Manipulator,
    all: Vec<Dimension>,
}

#[derive(Clone, Debug)]
struct Dimension {
    name: String,
    /// With a larger and with a smaller value.
    ends: [Manipulator; 2],
    apart: f64,
}

/// What a unit of each dimension does at one pose, to first order: a column for each, radians and metres.
#[derive(Clone, Debug)]
pub struct DimensionRates {
    /// The change of each joint coordinate (rows) while the pose stays. NaN at the boundary of reach.
    pub joints: DMatrix<f64>,
    /// The change of each task coordinate (rows) while the actuated joints keep their values. NaN where these do not hold the
    /// platform.
    pub pose: DMatrix<f64>,
}

impl<'a> Dimensions<'a> {
    /// The dimensions of the file of a manipulator ([`MechanismFile::dimensions`]) that are lengths or angles and can change
    /// alone.
    pub fn new(manipulator: &'a Manipulator, file: &MechanismFile) -> Self {
        let length = manipulator.characteristic_length();
        let mechanism = manipulator.mechanism();
        let mut all = Vec::new();
        for (name, value) in file.dimensions() {
            // Limits do not move anything.
            let Some(quantity) = file.quantity_of(&name).filter(|_| !is_limit(&name)) else {
                continue;
            };
            let step = STEP * unit(quantity, length);
            for (part, suffix) in parts(value).iter().enumerate() {
                let made = |step: f64| {
                    let change = (&*name, stepped(value, part, step));
                    Manipulator::new(changed_file(file, mechanism, change)?).ok()
                };
                let (Some(more), Some(less)) = (made(step), made(-step)) else { continue };
                let (name, ends) = (format!("{name}{suffix}"), [more, less]);
                all.push(Dimension { name, ends, apart: 2.0 * step });
            }
        }
        Self { manipulator, all }
    }

    /// Their names, in the order of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.all.iter().map(|dimension| &*dimension.name)
    }

    /// The rates at a pose that is solved in a working mode.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn at(&self, at: &Solution, mode: Mode) -> Result<DimensionRates, VelocityError> {
        let m = self.manipulator;
        let mut jacobians = m.jacobians();
        m.differentiate(at, &mut jacobians)?;
        let coordinates = m.coordinates();
        let mut joints = DMatrix::from_element(coordinates.len(), self.all.len(), f64::NAN);
        for (mut column, dimension) in joints.column_iter_mut().zip(&self.all) {
            let [more, less] = dimension.ends.each_ref().map(|end| {
                let mut there = end.solution();
                let found = end.inverse(at.pose(), mode, &mut there).ok().flatten();
                found.map(|found| found.joints().to_vec())
            });
            let (Some(more), Some(less)) = (more, less) else { continue };
            for (i, c) in coordinates.iter().enumerate() {
                let mut apart = more[i] - less[i];
                // An angle may be told a full turn on.
                if c.quantity == Quantity::Angle {
                    apart -= (apart / TAU).round() * TAU;
                }
                column[i] = apart / dimension.apart;
            }
        }
        let by_pose = jacobians.joints_by_pose();
        let actuated = |all: &DMatrix<f64>| all.select_rows(m.actuated());
        let (rates, moved) = (
            actuated(&DMatrix::from_fn(by_pose.nrows(), by_pose.ncols(), |i, j| by_pose[(i, j)])),
            actuated(&joints),
        );
        // More actuators than freedoms agree.
        let normal = rates.tr_mul(&rates);
        let pose = match normal.try_inverse() {
            Some(inverse) => -inverse * rates.tr_mul(&moved),
            None => DMatrix::from_element(rates.ncols(), self.all.len(), f64::NAN),
        };
        Ok(DimensionRates { joints, pose })
    }
}

/// Whether a name is that of a limit or of an offset of a joint of a family.
fn is_limit(name: &str) -> bool {
    name.split('.').any(|part| {
        matches!(
            part,
            "limits" | "max_rate" | "max_acceleration" | "max_effort" | "offset" | "home"
        )
    })
}
