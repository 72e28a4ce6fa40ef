//! The surface of a body of grid points, as triangles.
//!
//! It is a surface net (S. F. Gibson, *Constrained elastic surface nets*, 1998): between eight neighbouring points of which
//! some are inside, it has one corner, in the middle of where the edges between them cross the surface; and between two
//! neighbours of which one is inside, it has two triangles.

/// A surface: the corners in steps of the grid, the first point being at zero, and three numbers of corners for each
/// triangle. Seen from outside, they turn to the left.
#[derive(Debug, Default, PartialEq)]
pub struct Surface {
    pub corners: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// The surface of the points for which `inside` is true; the first coordinate is the fastest.
pub fn surface(counts: [usize; 3], inside: &[bool]) -> Surface {
    let at = |point: [usize; 3]| {
        // Points have numbers from 1 on here: all around them is outside.
        let known = (0..3).all(|i| (1..=counts[i]).contains(&point[i]));
        known && inside[(point[0] - 1) + counts[0] * ((point[1] - 1) + counts[1] * (point[2] - 1))]
    };
    let cells = counts.map(|count| count + 1);
    let number = |cell: [usize; 3]| cell[0] + cells[0] * (cell[1] + cells[1] * cell[2]);
    let mut known = vec![u32::MAX; cells.iter().product()];
    let mut surface = Surface::default();
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                if let Some(corner) = corner([x, y, z], at) {
                    known[number([x, y, z])] = surface.corners.len() as u32;
                    surface.corners.push(corner);
                }
            }
        }
    }
    for z in 0..cells[2] {
        for y in 0..cells[1] {
            for x in 0..cells[0] {
                let point = [x, y, z];
                for axis in 0..3 {
                    let mut next = point;
                    next[axis] += 1;
                    let (here, there) = (at(point), at(next));
                    if here == there {
                        continue;
                    }
                    // The four cells around the edge, turning to the left about the axis. Both points are within the grid
                    // or beside it, so that none of the cells is beyond.
                    let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                    let around = [(1, 1), (0, 1), (0, 0), (1, 0)].map(|(less_b, less_c)| {
                        let mut cell = point;
                        cell[b] -= less_b;
                        cell[c] -= less_c;
                        known[number(cell)]
                    });
                    let [p, q, r, s] = around;
                    let turned = if here { [[p, q, r], [p, r, s]] } else { [[p, r, q], [p, s, r]] };
                    surface.triangles.extend(turned);
                }
            }
        }
    }
    surface
}

/// The normals at corners that lie at these places: the sum of those of the triangles around, each as long as its triangle
/// is large.
pub fn normals(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0; 3]; corners.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|number| corners[number as usize]);
        let [u, v]: [[f32; 3]; 2] = [b, c].map(|end| std::array::from_fn(|i| end[i] - a[i]));
        for number in triangle {
            let sum = &mut normals[*number as usize];
            for (i, sum) in sum.iter_mut().enumerate() {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                *sum += u[j] * v[k] - u[k] * v[j];
            }
        }
    }
    normals
}

/// The corner between the eight points from this one on; `None` if all are inside or all outside.
fn corner(point: [usize; 3], at: impl Fn([usize; 3]) -> bool) -> Option<[f32; 3]> {
    let corners: [bool; 8] = std::array::from_fn(|i| {
        at([point[0] + (i & 1), point[1] + (i >> 1 & 1), point[2] + (i >> 2)])
    });
    let (mut sum, mut crossings) = ([0.0_f32; 3], 0.0);
    for i in 0..8 {
        for axis in 0..3 {
            let j = i | 1 << axis;
            if i != j && corners[i] != corners[j] {
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += 0.5 * ((i >> k & 1) + (j >> k & 1)) as f32;
                }
                crossings += 1.0;
            }
        }
    }
    (crossings > 0.0).then(|| std::array::from_fn(|k| point[k] as f32 - 1.0 + sum[k] / crossings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn ball(count: usize, radius: f64) -> Vec<bool> {
        let middle = (count as f64 - 1.0) / 2.0;
        let all =
            (0..count * count * count).map(|i| [i % count, i / count % count, i / count / count]);
        all.map(|p| p.iter().map(|&c| (c as f64 - middle).powi(2)).sum::<f64>() < radius * radius)
            .collect()
    }

    /// Six times the volume of the tetrahedra to the origin, by the divergence theorem.
    fn volume(surface: &Surface) -> f64 {
        let corner = |i: u32| surface.corners[i as usize].map(f64::from);
        let six = surface.triangles.iter().map(|t| {
            let [a, b, c] = t.map(corner);
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        });
        six.sum::<f64>() / 6.0
    }

    #[test]
    fn a_ball_has_the_volume_of_a_ball_and_looks_outwards() {
        let made = surface([41; 3], &ball(41, 17.0));
        let expected = 4.0 / 3.0 * std::f64::consts::PI * 17.0_f64.powi(3);
        assert!((volume(&made) / expected - 1.0).abs() < 0.03, "{}", volume(&made) / expected);
    }

    /// Those of a ball are along its radius.
    #[test]
    fn normals_look_outwards() {
        let made = surface([41; 3], &ball(41, 17.0));
        let found = normals(&made.corners, &made.triangles);
        for (corner, normal) in made.corners.iter().zip(&found) {
            let radius = corner.map(|c| c - 20.0);
            let dot = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
            let cosine =
                dot(&radius, normal) / (dot(&radius, &radius) * dot(normal, normal)).sqrt();
            assert!(cosine > 0.8, "{corner:?} {normal:?}");
        }
    }

    /// Each side of a triangle is that of another one, in the other direction: there is no hole.
    #[test]
    fn a_surface_is_closed_where_the_body_touches_the_ends_of_the_grid() {
        let made = surface([9; 3], &ball(9, 5.0));
        let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for [a, b, c] in made.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let way = if from < to { 1 } else { -1 };
                *sides.entry([from.min(to), from.max(to)]).or_default() += way;
            }
        }
        assert!(!sides.is_empty() && sides.values().all(|&count| count == 0));
    }

    #[test]
    fn nothing_has_no_surface_and_a_point_has_a_small_one() {
        assert_eq!(surface([3, 2, 1], &[false; 6]), Surface::default());
        let made = surface([1; 3], &[true]);
        assert_eq!((made.corners.len(), made.triangles.len()), (8, 12));
        assert!(made.corners.iter().flatten().all(|c| c.abs() < 0.5) && volume(&made) > 0.0);
    }
}
