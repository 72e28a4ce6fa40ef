//! Poses that opm solved, which the programs beside generated code compare it with.

use opm_core::mechanism::joint::JointCoordinate;
use opm_core::numeric::Quantity;
use opm_core::{Manipulator, Mode, Solution};
use std::f64::consts::PI;

/// The most poses in reach, and out of it.
const POSES: [usize; 2] = [64, 16];

/// The most poses that are tried.
const TRIED: usize = 4000;

/// The largest changes of coordinates for which joints are compared, radians or sizes of the mechanism, and by how much
/// more than the pose the joints may move then: nearer to a singularity, float has too few digits to compare.
const STEP: f64 = 1e-4;
const GAIN: f64 = 200.0;

/// One of the poses.
#[derive(Clone, Debug)]
pub struct Golden {
    pub mode: Mode,
    /// The number of the first leg that does not reach it, from 1, or zero.
    pub status: usize,
    pub pose: Vec<f64>,
    /// Empty if it is out of reach.
    pub joints: Vec<f64>,
    pub imaginary: Vec<f64>,
}

/// The poses, in reach and out of it; the pose at home where there are no others.
pub fn poses(manipulator: &Manipulator) -> Vec<Golden> {
    let mut all = Vec::new();
    let (mut at, mut near) = (manipulator.solution(), manipulator.solution());
    let mut left = POSES;
    for number in 1..=TRIED {
        if left == [0; 2] {
            break;
        }
        let (pose, mode) = sample(manipulator, number);
        let Some(status) = status(manipulator, &pose, mode, &mut at) else { continue };
        let left = &mut left[usize::from(status != 0)];
        if *left == 0 || !is_plain(manipulator, &pose, mode, (&at, status), &mut near) {
            continue;
        }
        *left -= 1;
        all.push(Golden::new(pose, mode, status, &at));
    }
    if all.is_empty() {
        let (pose, mode) = (manipulator.home_pose(), manipulator.home_mode());
        if let Some(status) = status(manipulator, &pose, mode, &mut at) {
            all.push(Golden::new(pose, mode, status, &at));
        }
    }
    all
}

impl Golden {
    fn new(pose: Vec<f64>, mode: Mode, status: usize, at: &Solution) -> Self {
        let written = |values: &[f64]| match status {
            // Adding zero makes a negative zero positive.
            0 => values.iter().map(|value| value + 0.0).collect(),
            _ => Vec::new(),
        };
        let (joints, imaginary) = (written(at.joints()), written(at.imaginary()));
        let pose = pose.into_iter().map(|value| value + 0.0).collect();
        Self { mode, status, pose, joints, imaginary }
    }
}

/// A row of text for each pose: its mode, status, coordinates, joints and imaginary joints go into a language's form.
pub fn rows(m: &Manipulator, row: impl Fn(u64, usize, [String; 3]) -> String) -> String {
    let row = |golden: &Golden| {
        let lists = [&golden.pose, &golden.joints, &golden.imaginary].map(|list| listed(list));
        row(golden.mode.bits(), golden.status, lists)
    };
    poses(m).iter().map(row).collect()
}

/// Which joints are angles, by the words of a language.
pub fn angles(m: &Manipulator, [yes, no]: [&str; 2]) -> String {
    let word = |c: &JointCoordinate| if c.quantity == Quantity::Angle { yes } else { no };
    m.coordinates().iter().map(word).collect::<Vec<_>>().join(", ")
}

/// Numbers with all their digits, and commas between them.
pub fn listed(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    all.join(", ")
}

/// The number of the first leg that does not reach a pose, from 1, or zero; `None` for what is no pose.
fn status(m: &Manipulator, pose: &[f64], mode: Mode, at: &mut Solution) -> Option<usize> {
    m.inverse(pose, mode, at).ok()?;
    Some(at.unreachable().first().map_or(0, |missed| missed.leg + 1))
}

/// Whether the answer does not change, or only in proportion, where every coordinate of the pose does.
fn is_plain(
    m: &Manipulator,
    pose: &[f64],
    mode: Mode,
    (at, expected): (&Solution, usize),
    near: &mut Solution,
) -> bool {
    let size = m.characteristic_length();
    let unit = |quantity: Quantity| if quantity == Quantity::Angle { 1.0 } else { size };
    let mut moved = pose.to_vec();
    for (i, coordinate) in m.task_coordinates().iter().enumerate() {
        for step in [STEP, -STEP] {
            moved[i] = pose[i] + step * unit(coordinate.quantity);
            if status(m, &moved, mode, near) != Some(expected) {
                return false;
            }
            let joints = at.joints().iter().zip(near.joints()).zip(m.coordinates());
            let far =
                joints.map(|((a, b), c)| (a - b).abs() / unit(c.quantity)).fold(0.0, f64::max);
            if expected == 0 && far > GAIN * STEP {
                return false;
            }
        }
        moved[i] = pose[i];
    }
    true
}

/// A pose and a mode from a sequence that fills their space evenly (Halton's).
fn sample(m: &Manipulator, number: usize) -> (Vec<f64>, Mode) {
    const PRIMES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
    let halton = |base: usize| {
        let (mut rest, mut digit, mut sum) = (number, 1.0, 0.0);
        while rest > 0 {
            digit /= base as f64;
            sum += digit * (rest % base) as f64;
            rest /= base;
        }
        2.0 * sum - 1.0
    };
    // Every second one is near home.
    let far = if number % 4 < 2 { 1.0 } else { 0.3 };
    let around = |(i, c): (usize, &opm_core::TaskCoordinate)| {
        let unit = if c.quantity == Quantity::Angle { PI } else { m.characteristic_length() };
        c.home + far * unit * halton(PRIMES[i % PRIMES.len()])
    };
    let pose = m.task_coordinates().iter().enumerate().map(around).collect();
    // Signs that change in no order: the bits of a product.
    let bits = (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let signs: String =
        (0..m.choices()).map(|bit| if bits >> (63 - bit) & 1 == 1 { '-' } else { '+' }).collect();
    (pose, m.parse_mode(&signs).unwrap_or_else(|_| m.home_mode()))
}
