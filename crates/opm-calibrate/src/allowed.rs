//! Displacements of a joint that leave its axes in the subspaces of their sections.
//!
//! A displacement `η` of an axis with the screw `s` changes it by the bracket `[η, s]`. The axis stays in the algebra of its
//! section if the bracket is in it. These are linear conditions on the rotations and offsets of the joint's axes.

use nalgebra::{DMatrix, DVector, Matrix6, Point3, Vector6};
use opm_accuracy::{Model, Source};
use opm_core::Quantity;
use opm_core::decomposition::Freedom;
use opm_core::group::screw::Screw;
use opm_core::group::subspace::TOLERANCE;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::{Joint, JointKind};

/// A displacement of the axes of one joint at home.
#[derive(Clone, Debug)]
pub struct Displacement {
    /// `leg1.r1.offset.1`; where a rotation goes with offsets, the name of the rotation.
    pub name: String,
    pub quantity: Quantity,
    pub leg: usize,
    pub joint: usize,
    /// The number of the joint's first axis in its leg.
    pub axis: usize,
    /// The twist of each axis of the joint for a unit, base coordinates.
    pub twists: Vec<Screw>,
}

/// The directions in which a joint may be displaced.
pub fn allowed(
    manipulator: &Manipulator,
    model: &Model<'_>,
    leg: usize,
    joint: usize,
) -> Vec<Displacement> {
    let own = &manipulator.mechanism().legs[leg];
    let axes =
        |joint: &Joint| if matches!(joint.kind, JointKind::Universal { .. }) { 2 } else { 1 };
    let axis: usize = own.joints[..joint].iter().map(axes).sum();
    let range = axis..axis + axes(&own.joints[joint]);
    let within = |source: &&Source| {
        let axes = source.axes();
        axes.is_some_and(|(of, axes, _)| {
            of == leg && !axes.is_empty() && range.contains(&axes.start)
        })
    };
    let sources: Vec<&Source> = model.sources().iter().filter(within).collect();
    let length = manipulator.characteristic_length();
    let scale = |source: &Source| match source.quantity {
        Quantity::Angle => 1.0,
        Quantity::Length => length,
    };
    let twist = |source: &Source, axis: usize| {
        let (_, axes, twist) = source.axes().expect("errors of axes were chosen");
        let on = if axes.contains(&axis) { scale(source) } else { 0.0 };
        Screw::from_vector(&(twist.to_vector() * on))
    };
    // Rows: what each bracket has outside of its subspace. Angles come last, so that they lead.
    let mut order: Vec<&Source> = sources.clone();
    order.sort_by_key(|source| source.quantity == Quantity::Angle);
    let screws = own.joints[joint].screws();
    let mut rows = DMatrix::zeros(6 * screws.len(), order.len());
    for (index, screw) in screws.iter().enumerate() {
        let of = if range.len() == 2 { axis + index } else { axis };
        let outside = outside(manipulator, leg, Freedom { joint, index });
        for (column, source) in order.iter().enumerate() {
            let bracket = twist(source, of).bracket(screw);
            let rest = outside * normalised(manipulator, &bracket);
            rows.fixed_view_mut::<6, 1>(6 * index, column).copy_from(&rest);
        }
    }
    let null = null_space(&rows);
    let named = null.into_iter().map(|vector| {
        let leading = (0..order.len()).rev().find(|&k| vector[k] != 0.0).unwrap_or(0);
        let leading = order[leading];
        let unit = scale(leading);
        let twists = range.clone().map(|axis| {
            let parts = order.iter().zip(vector.iter());
            let sum: Vector6<f64> =
                parts.map(|(source, part)| twist(source, axis).to_vector() * *part / unit).sum();
            Screw::from_vector(&sum)
        });
        Displacement {
            name: leading.name.clone(),
            quantity: leading.quantity,
            leg,
            joint,
            axis,
            twists: twists.collect(),
        }
    });
    let mut all: Vec<Displacement> = named.collect();
    let place = |of: &Displacement| sources.iter().position(|source| source.name == of.name);
    all.sort_by_key(place);
    all
}

/// Whether a helical joint may have another pitch: its section has the translation along its axis.
pub fn pitch(manipulator: &Manipulator, leg: usize, joint: usize) -> bool {
    let axis = manipulator.mechanism().legs[leg].joints[joint].axis;
    let outside = outside(manipulator, leg, Freedom { joint, index: 0 });
    (outside * normalised(manipulator, &Screw::translation(axis))).norm() < TOLERANCE
}

/// The twist about the platform's point, with lengths over the characteristic length.
fn normalised(manipulator: &Manipulator, screw: &Screw) -> Vector6<f64> {
    let point: Point3<f64> = manipulator.mechanism().platform;
    let linear = screw.linear + screw.angular.cross(&point.coords);
    let moved =
        Screw { angular: screw.angular, linear: linear / manipulator.characteristic_length() };
    moved.to_vector()
}

/// The projection to what is not in the subspace of a freedom's section.
fn outside(manipulator: &Manipulator, leg: usize, freedom: Freedom) -> Matrix6<f64> {
    let decomposition = manipulator.decomposition();
    let upper = decomposition.legs[leg].upper.contains(&freedom);
    let subspace = if upper { &decomposition.upper } else { &decomposition.lower };
    let mut basis: Vec<Vector6<f64>> = Vec::new();
    for screw in subspace.screws() {
        let mut rest = normalised(manipulator, &screw).normalize();
        for _ in 0..2 {
            for known in &basis {
                rest -= known * known.dot(&rest);
            }
        }
        basis.push(rest.normalize());
    }
    basis.iter().fold(Matrix6::identity(), |rest, known| rest - known * known.transpose())
}

/// A basis of the vectors that a matrix takes to zero, each with a one where all others have a zero: as far to the end as can
/// be. Found by elimination with pivots from the first column on.
fn null_space(matrix: &DMatrix<f64>) -> Vec<DVector<f64>> {
    let mut rows = matrix.clone();
    let (mut pivots, mut rank) = (Vec::new(), 0);
    for column in 0..rows.ncols() {
        let largest = (rank..rows.nrows())
            .max_by(|&a, &b| rows[(a, column)].abs().total_cmp(&rows[(b, column)].abs()));
        let Some(row) = largest.filter(|&row| rows[(row, column)].abs() > TOLERANCE) else {
            continue;
        };
        rows.swap_rows(rank, row);
        let pivot = rows[(rank, column)];
        rows.row_mut(rank).unscale_mut(pivot);
        for other in (0..rows.nrows()).filter(|&other| other != rank) {
            let factor = rows[(other, column)];
            let own = rows.row(rank) * factor;
            let mut row = rows.row_mut(other);
            row -= own;
        }
        pivots.push(column);
        rank += 1;
    }
    let free = (0..rows.ncols()).filter(|column| !pivots.contains(column));
    let vector = |column: usize| {
        let mut vector = DVector::zeros(rows.ncols());
        vector[column] = 1.0;
        for (row, &pivot) in pivots.iter().enumerate() {
            let entry = -rows[(row, column)];
            // What is rounding would make exact directions inexact.
            vector[pivot] = if entry.abs() < TOLERANCE { 0.0 } else { entry };
        }
        vector
    };
    free.map(vector).collect()
}
