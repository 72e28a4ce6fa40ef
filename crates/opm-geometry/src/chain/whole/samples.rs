//! Assembled configurations of a leg, by which its structure is recognised and an order is tested.

use super::element::{Element, Kind};
use super::solve::VALUES;
use super::{CLOSURE, MOST_FREEDOMS};
use nalgebra::{Isometry3, SMatrix, SVector, UnitQuaternion, Vector3};

/// A configuration of the leg.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// The displacement of the platform.
    pub target: Isometry3<f64>,
    /// That of each joint.
    pub joints: Vec<Isometry3<f64>>,
    /// The freedoms' values, and those of joints that are given; those of a ball are not kept.
    pub values: Vec<f64>,
    /// The axis of each joint where it is: its point and direction.
    pub axes: Vec<(Vector3<f64>, Vector3<f64>)>,
}

/// A step of Newton's method is not longer than this, radians or sizes.
const LONGEST_STEP: f64 = 0.6;
/// Newton's method takes at most so many steps from one start.
const MOST_STEPS: usize = 80;
/// A misfit below this is rounding, relative to the size.
const CLOSED: f64 = 1e-12;
/// Starts away from home, where home does not lead to the target.
const STARTS: usize = 6;

/// The misfit of a leg: what is left to the target, about a point, lengths over the size.
pub(super) fn misfit(
    joints: &[Isometry3<f64>],
    target: &Isometry3<f64>,
    centre: &Vector3<f64>,
    size: f64,
) -> SVector<f64, 6> {
    let end = joints.iter().fold(Isometry3::identity(), |all, one| all * one);
    let rest = target * end.inverse();
    let angles = rest.rotation.scaled_axis();
    // Where the platform's point is, about which the rest turns.
    let at = end * nalgebra::Point3::from(*centre);
    let shift = (rest * at - at) / size;
    SVector::<f64, 6>::new(angles.x, angles.y, angles.z, shift.x, shift.y, shift.z)
}

/// A damped step of Newton's method towards the target; the misfit before it.
pub(super) fn step(
    elements: &[Element],
    joints: &mut [Isometry3<f64>],
    values: &mut [f64],
    target: &Isometry3<f64>,
    centre: &Vector3<f64>,
    size: f64,
    damping: f64,
) -> f64 {
    let rest = misfit(joints, target, centre, size);
    let end = joints.iter().fold(Isometry3::identity(), |all, one| all * one);
    let at = (end * nalgebra::Point3::from(*centre)).coords;
    let mut columns = SMatrix::<f64, 6, MOST_FREEDOMS>::zeros();
    let mut inner = Isometry3::identity();
    for (element, joint) in elements.iter().zip(joints.iter()) {
        let point = (inner * nalgebra::Point3::from(element.point)).coords;
        let direction = inner.rotation * element.direction;
        let mut write = |slot: usize, angular: Vector3<f64>, linear: Vector3<f64>| {
            let linear = (linear + angular.cross(&(at - point))) / size;
            if slot < MOST_FREEDOMS {
                columns.fixed_view_mut::<3, 1>(0, slot).copy_from(&angular);
                columns.fixed_view_mut::<3, 1>(3, slot).copy_from(&linear);
            }
        };
        let zero = Vector3::zeros();
        match element.kind {
            Kind::Turn => write(element.slot, direction, zero),
            Kind::Helix(pitch) => write(element.slot, direction, direction * pitch),
            Kind::Slide => write(element.slot, zero, direction * size),
            Kind::Circle(arm) => {
                let arm = inner.rotation * (arm + joint.translation.vector);
                write(element.slot, zero, direction.cross(&arm));
            }
            Kind::Ball => {
                for i in 0..3 {
                    write(element.slot + i, inner.rotation * Vector3::ith(i, 1.0), zero);
                }
            }
        }
        inner *= joint;
    }
    let square = columns.transpose() * columns
        + SMatrix::<f64, MOST_FREEDOMS, MOST_FREEDOMS>::identity() * damping;
    let Some(cholesky) = square.cholesky() else { return rest.norm() };
    let mut by = cholesky.solve(&(columns.transpose() * rest));
    let longest = by.amax();
    if longest > LONGEST_STEP {
        by *= LONGEST_STEP / longest;
    }
    for (element, joint) in elements.iter().zip(joints.iter_mut()) {
        let slot = element.slot;
        match element.kind {
            _ if element.is_given() => {}
            Kind::Turn | Kind::Helix(_) | Kind::Circle(_) => {
                values[slot] += by[slot];
                *joint = element.exp(&values[slot..]);
            }
            Kind::Slide => {
                values[slot] += by[slot] * size;
                *joint = element.exp(&values[slot..]);
            }
            Kind::Ball => {
                let small = element.exp(&[by[slot], by[slot + 1], by[slot + 2]]);
                let mut next = small * *joint;
                next.rotation = UnitQuaternion::new_normalize(next.rotation.into_inner());
                *joint = next;
            }
        }
    }
    rest.norm()
}

impl Sample {
    /// The leg at home.
    pub fn home(elements: &[Element]) -> Self {
        Self::with(elements, vec![0.0; VALUES])
    }

    /// The leg with its freedoms at these values, those of joints that are given last.
    pub fn with(elements: &[Element], values: Vec<f64>) -> Self {
        let joints: Vec<Isometry3<f64>> =
            elements.iter().map(|element| element.exp(&values[element.slot..])).collect();
        let target = joints.iter().fold(Isometry3::identity(), |all, joint| all * joint);
        Self::new(elements, target, joints, values)
    }

    fn new(
        elements: &[Element],
        target: Isometry3<f64>,
        joints: Vec<Isometry3<f64>>,
        values: Vec<f64>,
    ) -> Self {
        let mut inner = Isometry3::identity();
        let mut axes = Vec::with_capacity(elements.len());
        for (element, joint) in elements.iter().zip(&joints) {
            let point = (inner * nalgebra::Point3::from(element.point)).coords;
            axes.push((point, inner.rotation * element.direction));
            inner *= joint;
        }
        Self { target, joints, values, axes }
    }

    /// A configuration with the platform at the target; `None` where none is found.
    pub fn at(
        elements: &[Element],
        target: &Isometry3<f64>,
        centre: &Vector3<f64>,
        size: f64,
    ) -> Option<Self> {
        // A congruential sequence: starts that are no special configurations, the same for all legs.
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1_u32 << 23) - 1.0
        };
        for start in 0..STARTS {
            let mut values = vec![0.0; VALUES];
            let mut joints = vec![Isometry3::identity(); elements.len()];
            for (element, joint) in elements.iter().zip(&mut joints) {
                for value in &mut values[element.slot..element.slot + element.freedoms()] {
                    let unit = if element.kind == Kind::Slide { size } else { 1.0 };
                    *value = random() * unit * if start == 0 { 1e-3 } else { 0.5 };
                }
                *joint = element.exp(&values[element.slot..]);
            }
            let mut last = f64::INFINITY;
            for _ in 0..MOST_STEPS {
                let damping = (1e-3 * last.min(1.0).powi(2)).max(1e-13);
                let now = step(elements, &mut joints, &mut values, target, centre, size, damping);
                // What an inexact leg misses its motions by is left over.
                let stays = now <= 0.3 * CLOSURE && now > 0.5 * last;
                if stays || now < CLOSED && last < 1e-6 {
                    return Some(Self::new(elements, *target, joints, values));
                }
                last = now;
            }
        }
        None
    }
}
