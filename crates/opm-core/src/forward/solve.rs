//! The displacements of a section that satisfy conditions: all of them, or the one near another displacement.

use super::three::{self, Solutions};
use crate::chain::condition::{Condition, VERGE};
use crate::group::{Displacement, LocalTwist, PlanarDisplacement, SubspaceKind};

/// The displacements that satisfy the first independent conditions, as many as the subspace has dimensions; `None` if
/// there are not enough independent conditions. `size` is that of the mechanism, metres.
pub(super) fn all(
    kind: SubspaceKind,
    conditions: &[Condition],
    size: f64,
) -> Option<Vec<Displacement>> {
    let of_plane = |solutions| match solutions {
        Solutions::At(found) => {
            Some(found.into_iter().map(|g: PlanarDisplacement| in_metres(g, size)).collect())
        }
        Solutions::Dependent => None,
    };
    let of_sphere = |solutions| match solutions {
        Solutions::At(found) => Some(found.into_iter().map(Displacement::Spherical).collect()),
        Solutions::Dependent => None,
    };
    match kind {
        SubspaceKind::Identity => Some(vec![SubspaceKind::Identity.identity()]),
        SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => crossing(kind, conditions, size).map(|g| vec![g]),
        SubspaceKind::Planar => by_threes(conditions, size, |three| of_plane(three::planar(three))),
        SubspaceKind::Spherical => {
            by_threes(conditions, size, |three| of_sphere(three::spherical(three)))
        }
    }
}

/// The displacement near another one that satisfies the first independent conditions; `None` if there is none, or if there
/// are not enough independent conditions. Nothing is allocated.
pub(super) fn near(
    start: &Displacement,
    conditions: &[Condition],
    size: f64,
) -> Option<Displacement> {
    match start {
        Displacement::Planar(start) => {
            let start = PlanarDisplacement { translation: start.translation / size, ..*start };
            by_threes(conditions, size, |three| {
                three::near(start, three).map(|g| in_metres(g, size))
            })
        }
        Displacement::Spherical(start) => by_threes(conditions, size, |three| {
            three::near(*start, three).map(Displacement::Spherical)
        }),
        Displacement::Identity(_) => Some(*start),
        Displacement::Cylindrical(_)
        | Displacement::Translational(_)
        | Displacement::Spatial(_) => crossing(start.kind(), conditions, size),
    }
}

/// A displacement whose lengths are shares of the size.
fn in_metres(g: PlanarDisplacement, size: f64) -> Displacement {
    PlanarDisplacement { translation: g.translation * size, ..g }.into()
}

/// What the first three conditions give that give something. They are solved with lengths over the size.
fn by_threes<T>(
    conditions: &[Condition],
    size: f64,
    solve: impl Fn(&[Condition; 3]) -> Option<T>,
) -> Option<T> {
    let scaled = |i: usize| conditions[i].scaled(1.0 / size);
    let n = conditions.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                if let Some(found) = solve(&[scaled(i), scaled(j), scaled(k)]) {
                    return Some(found);
                }
            }
        }
    }
    None
}

/// The displacement of a commutative subspace that satisfies as many of several linear conditions as the subspace has
/// dimensions, two or three: those whose normals are most nearly perpendicular. `None` if too few are independent.
fn crossing(kind: SubspaceKind, conditions: &[Condition], size: f64) -> Option<Displacement> {
    // The units of the coordinates: radians, or lengths over the size.
    let scale = kind.sum_units(size);
    // Two conditions are completed by one on the third number, which is zero.
    let padding = [Condition::Flat { normal: LocalTwist::z(), value: 0.0 }];
    let mut best: Option<(f64, [(LocalTwist, f64); 3])> = None;
    for (k, third) in rows(conditions, &scale) {
        for (j, second) in rows(&conditions[..k], &scale) {
            let firsts = if kind.dimension() == 3 { &conditions[..j] } else { &padding };
            for (_, first) in rows(firsts, &scale) {
                let determinant = first.0.dot(&second.0.cross(&third.0));
                if best.is_none_or(|(most, _)| determinant.abs() > most.abs()) {
                    best = Some((determinant, [first, second, third]));
                }
            }
        }
    }
    let (determinant, [(a, p), (b, q), (c, r)]) =
        best.filter(|(determinant, _)| determinant.abs() > VERGE)?;
    let sum = (b.cross(&c) * p + c.cross(&a) * q + a.cross(&b) * r) / determinant;
    Some(kind.of_sum(&sum.component_mul(&scale)))
}

/// The linear conditions with their numbers: a unit normal in units of the coordinates, and the value.
fn rows(
    conditions: &[Condition],
    scale: &LocalTwist,
) -> impl Iterator<Item = (usize, (LocalTwist, f64))> {
    conditions.iter().enumerate().filter_map(|(number, condition)| match condition {
        Condition::Flat { normal, value } => {
            let normal = normal.component_mul(scale);
            let length = normal.norm();
            Some((number, (normal / length, value / length)))
        }
        _ => None,
    })
}
