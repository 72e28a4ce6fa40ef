//! Which coordinates determine a platform's motion.

use crate::numeric::svd::singular_values;
use nalgebra::DMatrix;

/// Coordinates are independent, in the order of preference, if with them the platform's motion at home is determined at least
/// this well, compared to the best ones.
const DETERMINED: f64 = 0.3;
/// Below this they do not determine it.
pub const UNDETERMINED: f64 = 1e-6;

/// The sets of coordinates that determine the platform's motion at home and suit, those first that do so well, and of these
/// those that are not `late`. Otherwise they are in the order in which the coordinates are `preferred`. `rates` has a row for
/// each coordinate, and a column for each of the orthonormal motions.
pub fn determining(
    rates: &DMatrix<f64>,
    preferred: &[usize],
    suits: impl Fn(&[usize]) -> bool,
    late: impl Fn(&[usize]) -> bool,
) -> impl Iterator<Item = Vec<usize>> {
    let freedoms = rates.ncols();
    let mut found: Vec<(f64, Vec<usize>)> = subsets(preferred, freedoms)
        .filter(|independent| suits(independent))
        .map(|independent| {
            let part = DMatrix::from_fn(freedoms, freedoms, |i, j| rates[(independent[i], j)]);
            (singular_values(part).into_iter().fold(f64::INFINITY, f64::min), independent)
        })
        .filter(|(determined, _)| *determined > UNDETERMINED)
        .collect();
    let best = found.iter().map(|(determined, _)| *determined).fold(0.0, f64::max);
    found.sort_by_key(|(determined, independent)| {
        (*determined < DETERMINED * best, late(independent))
    });
    found.into_iter().map(|(_, independent)| independent)
}

/// The subsets of some numbers with so many of them, in the order of the numbers; each is sorted.
fn subsets(numbers: &[usize], of: usize) -> impl Iterator<Item = Vec<usize>> {
    let count = numbers.len();
    let mut next = (of <= count).then(|| (0..of).collect::<Vec<usize>>());
    std::iter::from_fn(move || {
        let now = next.take()?;
        let mut following = now.clone();
        if let Some(place) = (0..of).rev().find(|&i| now[i] < count - of + i) {
            following[place] += 1;
            for i in place + 1..of {
                following[i] = following[i - 1] + 1;
            }
            next = Some(following);
        }
        let mut subset: Vec<usize> = now.into_iter().map(|i| numbers[i]).collect();
        subset.sort_unstable();
        Some(subset)
    })
}
