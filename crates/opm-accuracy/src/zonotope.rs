//! The farthest point of a zonotope: the longest sum `Σ ± gₖ` of vectors with free signs.
//!
//! For a direction `d`, the sum that reaches farthest along it has the signs of `gₖ · d`. Directions are divided into cells,
//! each within an angle `θ` of its middle `m`. In a cell, vectors with `|gₖ · m| > |gₖ| sin θ` have fixed signs, and any other
//! contributes at most `|gₖ · m| cos θ + |gₖ| sin θ`; the sum of those with fixed signs reaches along directions of the cell as
//! far as the angle between them allows. So a cell in which no sum reaches farther than the longest that is known is done with;
//! others are divided into four (branch and bound).
//!
//! This ends. In the longest sum `S`, each vector has `± gₖ · S >= |gₖ|²`, or the opposite sign would give a longer one. So
//! around its direction is a cell in which all signs are fixed.

use nalgebra::Vector3;

/// Sums that are longer by less than this share count as equally long.
const EQUAL: f64 = 1e-10;

/// A cell of directions: a square on a face of the cube.
#[derive(Clone, Copy)]
struct Cell {
    /// The number of the axis that the face is across.
    face: usize,
    /// The middle, the other two coordinates from -1 to 1.
    middle: [f64; 2],
    /// Half of its side.
    half: f64,
}

impl Cell {
    fn direction(&self, [u, v]: [f64; 2]) -> Vector3<f64> {
        let mut direction = Vector3::zeros();
        direction[self.face] = 1.0;
        direction[(self.face + 1) % 3] = u;
        direction[(self.face + 2) % 3] = v;
        direction.normalize()
    }

    fn corners(&self) -> [[f64; 2]; 4] {
        let ([u, v], h) = (self.middle, self.half);
        [[u - h, v - h], [u - h, v + h], [u + h, v - h], [u + h, v + h]]
    }

    fn divided(&self) -> [Self; 4] {
        let half = 0.5 * self.half;
        let [u, v] = self.middle;
        let part = |x: f64, y: f64| Self { middle: [u + x * half, v + y * half], half, ..*self };
        [part(-1.0, -1.0), part(-1.0, 1.0), part(1.0, -1.0), part(1.0, 1.0)]
    }
}

/// The longest sum of the vectors with free signs, to within `1e-10` of its length.
pub fn farthest(generators: &[Vector3<f64>]) -> Vector3<f64> {
    let own: Vec<(Vector3<f64>, f64)> =
        generators.iter().map(|g| (*g, g.norm())).filter(|(_, length)| *length > 0.0).collect();
    let along = |direction: &Vector3<f64>| {
        let signed = own.iter().map(|(g, _)| *g * g.dot(direction).signum());
        signed.sum::<Vector3<f64>>()
    };
    let mut best = Vector3::zeros();
    let mut longest = 0.0;
    // Opposite directions give opposite sums.
    let mut cells: Vec<Cell> =
        (0..3).map(|face| Cell { face, middle: [0.0; 2], half: 1.0 }).collect();
    while let Some(cell) = cells.pop() {
        let middle = cell.direction(cell.middle);
        let mut sum = along(&middle);
        // The direction of a sum gives one that is at least as long.
        while sum.norm() > longest {
            (best, longest) = (sum, sum.norm());
            sum = along(&sum);
        }
        // By the sine: a cosine near 1 does not tell small angles apart, and small cells would never be done with.
        let sin = cell.corners().into_iter().map(|c| middle.cross(&cell.direction(c)).norm());
        let sin = sin.fold(0.0, f64::max);
        let cos = (1.0 - sin * sin).sqrt();
        let (mut fixed, mut open) = (Vector3::zeros(), 0.0);
        for (g, length) in &own {
            let part = g.dot(&middle);
            if part.abs() > length * sin {
                fixed += g * part.signum();
            } else {
                open += part.abs() * cos + length * sin;
            }
        }
        // How far the fixed part reaches along a direction of the cell.
        let (ahead, across) = (fixed.dot(&middle), fixed.cross(&middle).norm());
        let reach =
            if across <= fixed.norm() * sin { fixed.norm() } else { ahead * cos + across * sin };
        if reach + open > longest * (1.0 + EQUAL) {
            cells.extend(cell.divided());
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All signs, one after the other.
    fn exhausted(generators: &[Vector3<f64>]) -> f64 {
        let all = 0..1_u32 << generators.len();
        let sum = |signs: u32| -> Vector3<f64> {
            let each = generators.iter().enumerate();
            each.map(|(k, g)| if signs >> k & 1 == 1 { *g } else { -g }).sum()
        };
        all.map(|signs| sum(signs).norm()).fold(0.0, f64::max)
    }

    /// A hundred vectors of very different lengths take no time, and no drawn signs give a longer sum.
    #[test]
    fn many_vectors_of_different_lengths_take_no_time() {
        let mut rng = fastrand::Rng::with_seed(6);
        for (power, flat) in
            [(0.0, 1.0), (1.0, 1.0), (4.0, 1.0), (12.0, 1.0), (0.0, 1e-5), (3.0, 1e-9)]
        {
            // Some along one axis, some in a plane, some nearly so.
            let mut one = || {
                let size = 10_f64.powf(-power * rng.f64());
                let mut g = Vector3::from_fn(|_, _| rng.f64() - 0.5) * size;
                if rng.bool() {
                    g.y *= flat;
                }
                if rng.bool() {
                    g.z *= flat;
                }
                g
            };
            let generators: Vec<Vector3<f64>> = (0..100).map(|_| one()).collect();
            let found = farthest(&generators).norm();
            for _ in 0..2000 {
                let mut sum = Vector3::from_fn(|_, _| rng.f64() - 0.5);
                for _ in 0..20 {
                    sum = generators.iter().map(|g| g * g.dot(&sum).signum()).sum();
                }
                assert!(sum.norm() <= found * (1.0 + 1e-10));
            }
        }
    }

    #[test]
    fn the_farthest_point_is_that_of_all_signs() {
        let mut rng = fastrand::Rng::with_seed(5);
        for _ in 0..400 {
            let count = rng.usize(..9);
            // Small whole numbers: many vectors are parallel, in one plane, or zero.
            let whole = rng.bool();
            let mut component = || if whole { f64::from(rng.i32(-1..2)) } else { rng.f64() - 0.5 };
            let mut generators: Vec<Vector3<f64>> =
                (0..count).map(|_| Vector3::from_fn(|_, _| component())).collect();
            match rng.usize(..4) {
                0 => generators.iter_mut().for_each(|g| g.z = 0.0),
                1 => generators.iter_mut().for_each(|g| *g = Vector3::new(1.0, 2.0, -1.0) * g.x),
                _ => {}
            }
            let (found, expected) = (farthest(&generators).norm(), exhausted(&generators));
            assert!(
                (found - expected).abs() <= 1e-10 * expected,
                "{found} {expected} {generators:?}"
            );
        }
    }
}
