//! Monte Carlo: errors drawn at random.

use crate::assembly::{Assembled, Assembler};
use crate::response::Response;
use nalgebra::{DVector, Vector6};

/// What random errors do, each uniform between minus and plus its size and independent of all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// How many times all errors were drawn.
    pub count: u64,
    /// How many of these mechanisms cannot be assembled near the pose; all else is of the others.
    pub failed: u64,
    /// The standard deviation of each task coordinate from its nominal value, radians and metres; NaN where it is not
    /// determined.
    pub deviations: Vec<f64>,
    /// What 95 % of the displacements of the platform's reference point do not exceed, metres.
    pub length: f64,
    /// What 95 % of the platform's rotations do not exceed, radians.
    pub angle: f64,
    /// The same for the play of each joint, leg by leg: a length, metres, and an angle, radians.
    pub misfit: Vec<[f64; 2]>,
}

/// The share of samples that is within the reported lengths and angles.
const SHARE: f64 = 0.95;

impl Samples {
    /// Of mechanisms that are assembled, in the order of their numbers.
    pub fn of(samples: impl IntoIterator<Item = Option<Sample>>) -> Self {
        let (mut count, mut failed) = (0, 0);
        let mut squares: Vec<f64> = Vec::new();
        let mut sizes: Vec<Vec<f64>> = Vec::new();
        for sample in samples {
            count += 1;
            let Some(sample) = sample else {
                failed += 1;
                continue;
            };
            squares.resize(sample.coordinates.len(), 0.0);
            sizes.resize(sample.sizes.len(), Vec::new());
            for (sum, value) in squares.iter_mut().zip(&sample.coordinates) {
                *sum += value * value;
            }
            for (all, size) in sizes.iter_mut().zip(&sample.sizes) {
                all.push(*size);
            }
        }
        let within: Vec<f64> = sizes.into_iter().map(quantile).collect();
        let number = (count - failed) as f64;
        let of = |k: usize| within.get(k).copied().unwrap_or(f64::NAN);
        Self {
            count,
            failed,
            deviations: squares.into_iter().map(|square| (square / number).sqrt()).collect(),
            angle: of(0),
            length: of(1),
            misfit: within.get(2..).unwrap_or_default().chunks(2).map(|p| [p[1], p[0]]).collect(),
        }
    }
}

/// What one draw of the errors does.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The changes of the task coordinates, radians and metres.
    coordinates: Vec<f64>,
    /// The platform's rotation and displacement, then those of the play of each joint.
    sizes: Vec<f64>,
}

impl Sample {
    fn new(coordinates: Vec<f64>, twists: impl Iterator<Item = Vector6<f64>>) -> Self {
        let sizes = twists.flat_map(|t| [t.fixed_rows::<3>(0).norm(), t.fixed_rows::<3>(3).norm()]);
        Self { coordinates, sizes: sizes.collect() }
    }
}

/// The errors of one sample: the same seed and number give the same errors.
///
/// ```
/// let sizes = [1e-5, 2e-5];
/// assert_eq!(opm_accuracy::draw(&sizes, 7, 3), opm_accuracy::draw(&sizes, 7, 3));
/// assert_ne!(opm_accuracy::draw(&sizes, 7, 3), opm_accuracy::draw(&sizes, 7, 4));
/// ```
pub fn draw(sizes: &[f64], seed: u64, number: u64) -> Vec<f64> {
    // A generator begins far from those of neighbouring numbers.
    let mut rng = fastrand::Rng::with_seed(seed);
    let own = rng.u64(..) ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut rng = fastrand::Rng::with_seed(own);
    sizes.iter().map(|size| size * (2.0 * rng.f64() - 1.0)).collect()
}

/// The mechanism with drawn errors, assembled beyond first order; `None` if it cannot be.
pub fn sample_assembled(assembler: &Assembler<'_>, errors: &[f64]) -> Option<Sample> {
    let Assembled { coordinates, platform, plays } = assembler.assemble(errors)?;
    Some(Sample::new(coordinates, std::iter::once(platform).chain(plays)))
}

/// What drawn errors do to first order.
///
/// # Panics
/// If there is not one error for each source.
pub fn sample(response: &Response, errors: &[f64]) -> Sample {
    assert_eq!(response.twists.ncols(), errors.len(), "one error for each source");
    let drawn = DVector::from_column_slice(errors);
    let coordinates = &response.coordinates * &drawn;
    let twists = std::iter::once(&response.twists).chain(&response.plays);
    Sample::new(coordinates.as_slice().to_vec(), twists.map(|by| by * &drawn))
}

/// What the share of the values does not exceed.
fn quantile(mut values: Vec<f64>) -> f64 {
    let place = (SHARE * values.len() as f64).ceil() as usize;
    values.sort_by(f64::total_cmp);
    values[place.clamp(1, values.len()) - 1]
}
