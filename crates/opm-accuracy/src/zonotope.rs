//! The farthest point of a zonotope: the longest sum `Σ ± gₖ` of vectors with free signs.
//!
//! A sum of greatest length is a vertex. Each vertex is at an end of an edge along some `gᵢ`, and if the vectors span space
//! each edge bounds a face that is spanned by `gᵢ` and some `gⱼ`. The signs of a vertex are those of the inner products with
//! the face's normal; those of vectors in the face are decided by the perpendicular to `gᵢ` in it, and those along `gᵢ` by
//! `gᵢ`. So all vertices are found, whatever vectors are parallel or in one plane, in a time like the cube of their number
//! (G. Ziegler, *Lectures on Polytopes*, 1995, section 7.3).

use nalgebra::Vector3;

/// Inner products of unit vectors below this one count as zero.
const ROUNDING: f64 = 1e-12;

/// The longest sum of the vectors with free signs.
pub fn farthest(generators: &[Vector3<f64>]) -> Vector3<f64> {
    let largest = generators.iter().map(Vector3::norm).fold(0.0, f64::max);
    let own: Vec<(Vector3<f64>, Vector3<f64>)> = generators
        .iter()
        .filter(|g| g.norm() > f64::EPSILON * largest)
        .map(|g| (*g, g.normalize()))
        .collect();
    let mut best = Vector3::zeros();
    let mut consider = |order: [Vector3<f64>; 3]| {
        let signed = own.iter().map(|(g, unit)| {
            let decides = order.iter().map(|d| d.dot(unit)).find(|s| s.abs() > ROUNDING);
            *g * decides.map_or(0.0, f64::signum)
        });
        let sum: Vector3<f64> = signed.sum();
        if sum.norm_squared() > best.norm_squared() {
            best = sum;
        }
    };
    for (i, (_, edge)) in own.iter().enumerate() {
        // All vectors are parallel to this one, or decided by it.
        consider([*edge, Vector3::zeros(), Vector3::zeros()]);
        for (_, other) in &own[..i] {
            let normal = edge.cross(other);
            if normal.norm() <= ROUNDING {
                continue;
            }
            let normal = normal.normalize();
            // Opposite vertices are equally far.
            for line in [edge, other] {
                let beside = normal.cross(line);
                for order in [[beside, *line], [beside, -line], [-beside, *line], [-beside, -line]]
                {
                    consider([normal, order[0], order[1]]);
                }
            }
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
            assert!((found - expected).abs() < 1e-12, "{found} {expected} {generators:?}");
        }
    }
}
