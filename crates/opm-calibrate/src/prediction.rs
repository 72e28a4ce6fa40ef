//! What is measured at a pose, and its derivatives by the pose and by the parameters.
//!
//! The derivatives by the parameters are those at a fixed pose. With the pose held, each leg closes if the small
//! displacements `q̇` of its joints, the twist `E` of a change of a parameter, and the twists of the dependent coordinates
//! add up: `Σ s q̇ + E = Σ t ḋ`.

use crate::column::{Body, Column, ColumnKind};
use crate::parameter::{Instance, Parameter};
use nalgebra::{DMatrix, Isometry3, Vector6};
use opm_accuracy::Model;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::velocity::SINGULAR;

/// What is measured, predicted.
pub struct Prediction {
    /// The value of each column.
    pub values: Vec<f64>,
    /// A row for each column, a column for each task coordinate.
    pub by_pose: DMatrix<f64>,
    /// A row for each column, a column for each parameter; if it was asked for.
    pub by_parameter: Option<DMatrix<f64>>,
}

/// Predicts what one mechanism shows.
pub struct Predictor<'a> {
    pub instance: &'a Instance,
    pub columns: &'a [Column],
    pub mode: Mode,
}

impl Predictor<'_> {
    /// The values and their derivatives at a pose; `None` where it is out of reach or singular. With a model and parameters,
    /// those by the parameters too.
    pub fn at(
        &self,
        pose: &[f64],
        parameters: Option<(&Model<'_>, &[Parameter])>,
    ) -> Option<Prediction> {
        let manipulator = &self.instance.manipulator;
        let mut buffer = manipulator.solution();
        let at = manipulator.inverse(pose, self.mode, &mut buffer).ok()??;
        let mut jacobians = manipulator.jacobians();
        if !manipulator.differentiate(at, &mut jacobians).ok()? {
            return None;
        }
        let joints = jacobians.joints_by_pose();
        let twists = manipulator.twist_by_pose(&jacobians);
        let body = Body::new(manipulator, &at.displacement(manipulator));
        let values = self.columns.iter().map(|column| column.value(at, &body)).collect();
        let coordinates = manipulator.task_coordinates().len();
        let dependent =
            match self.columns.iter().any(|c| matches!(c.kind, ColumnKind::Dependent(_))) {
                true => dependent_by_pose(manipulator, at)?,
                false => DMatrix::zeros(0, coordinates),
            };
        let mut by_pose = DMatrix::zeros(self.columns.len(), coordinates);
        for (row, column) in self.columns.iter().enumerate() {
            match (column.kind, column.by_twist(&body)) {
                (ColumnKind::Coordinate(number), _) => by_pose[(row, number)] = 1.0,
                (ColumnKind::Joint(number), _) => by_pose.set_row(row, &joints.row(number)),
                (ColumnKind::Dependent(number), _) => by_pose.set_row(row, &dependent.row(number)),
                (_, Some(by_twist)) => by_pose.set_row(row, &(by_twist * &twists)),
                (_, None) => {}
            }
        }
        let by_parameter =
            parameters.map(|(model, parameters)| self.by_parameter(at, &body, model, parameters));
        let finite = by_pose.iter().chain(by_parameter.iter().flatten()).all(|x| x.is_finite());
        finite.then_some(Prediction { values, by_pose, by_parameter })
    }

    fn by_parameter(
        &self,
        at: &Solution,
        body: &Body,
        model: &Model<'_>,
        parameters: &[Parameter],
    ) -> DMatrix<f64> {
        let manipulator = &self.instance.manipulator;
        let closure = model.closure(at);
        let errors = self.instance.twists(parameters, &closure);
        let tied = dependent_twists(manipulator, at);
        let (rows, joints) = closure.joints.shape();
        let mut moving = DMatrix::zeros(rows, joints + tied.ncols());
        moving.columns_mut(0, joints).copy_from(&closure.joints);
        for leg in 0..rows / 6 {
            moving.view_mut((6 * leg, joints), (6, tied.ncols())).copy_from(&-&tied);
        }
        let svd = moving.svd(true, true);
        let zero = SINGULAR * svd.singular_values.max();
        let mut found = -svd.solve(&errors, zero).expect("both sides were asked for");
        // What moves nothing has no parts of rounding.
        for (column, error) in errors.column_iter().enumerate() {
            if error.amax() == 0.0 {
                found.column_mut(column).fill(0.0);
            }
        }
        let length = manipulator.characteristic_length();
        let mut by = DMatrix::zeros(self.columns.len(), parameters.len());
        for (row, column) in self.columns.iter().enumerate() {
            match (column.kind, column.by_twist(body)) {
                (ColumnKind::Coordinate(_), _) => {}
                (ColumnKind::Joint(number), _) => {
                    by.set_row(row, &found.row(number));
                    for (k, parameter) in parameters.iter().enumerate() {
                        by[(row, k)] += Instance::by_offset(parameter, number);
                    }
                }
                (ColumnKind::Dependent(number), _) => by.set_row(row, &found.row(joints + number)),
                (_, Some(mut by_twist)) => {
                    by_twist.fixed_columns_mut::<3>(3).scale_mut(length);
                    let rates = found.rows(joints, tied.ncols());
                    by.set_row(row, &(by_twist * (&tied * rates)));
                }
                (_, None) => {}
            }
        }
        by
    }
}

/// The rates of the dependent coordinates for unit rates of the task coordinates.
fn dependent_by_pose(manipulator: &Manipulator, at: &Solution) -> Option<DMatrix<f64>> {
    let count = manipulator.task_coordinates().len();
    let mut by = DMatrix::zeros(manipulator.dependent_coordinates().len(), count);
    let mut motion = manipulator.joint_motion();
    for column in 0..count {
        let mut rates = vec![0.0; count];
        rates[column] = 1.0;
        manipulator.velocity(at, &rates, &vec![0.0; count], &mut motion).ok()?;
        for (row, rate) in motion.dependent_rates.iter().enumerate() {
            by[(row, column)] = *rate;
        }
    }
    Some(by)
}

/// The twists of the platform for unit rates of each dependent coordinate alone, by central differences: the rotation, and
/// the displacement of the reference point over the characteristic length. No columns where no coordinate is dependent.
fn dependent_twists(manipulator: &Manipulator, at: &Solution) -> DMatrix<f64> {
    /// The error of a difference is about its square.
    const STEP: f64 = 1e-5;
    let length = manipulator.characteristic_length();
    let dependent = manipulator.dependent_coordinates();
    let task = manipulator.task();
    let value = |name: &str| {
        let of = |all: &[opm_core::task::TaskCoordinate], values: &[f64]| {
            all.iter().position(|c| c.name == name).map(|number| values[number])
        };
        of(manipulator.task_coordinates(), at.pose()).or_else(|| of(dependent, at.dependent()))
    };
    let all: Vec<f64> = task.coordinates.iter().map(|c| value(c.name).unwrap_or(c.home)).collect();
    let mut twists = DMatrix::zeros(6, dependent.len());
    for (column, c) in dependent.iter().enumerate() {
        let step = match c.quantity {
            opm_core::Quantity::Angle => STEP,
            opm_core::Quantity::Length => STEP * length,
        };
        let Some(number) = task.coordinates.iter().position(|other| other.name == c.name) else {
            continue;
        };
        let [more, less]: [Isometry3<f64>; 2] = [step, -step].map(|step| {
            let mut pose = all.clone();
            pose[number] += step;
            task.displacement(&pose)
        });
        let rotation = (more.rotation * less.rotation.inverse()).scaled_axis();
        let point = manipulator.mechanism().platform;
        let way = (more * point - less * point) / length;
        let twist = Vector6::new(rotation.x, rotation.y, rotation.z, way.x, way.y, way.z);
        twists.set_column(column, &(twist / (2.0 * step)));
    }
    twists
}
