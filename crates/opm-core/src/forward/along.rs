//! Where a displacement that moves along the intersection motion satisfies a condition: a link swings about
//! a point until its end is on a circle or a line, or an axis rotates until it lies on a cone.

use crate::chain::ReachDeficit;
use crate::chain::condition::{Condition, VERGE, dot, length};
use crate::group::{
    Displacement, IntersectionMotion, JointDisplacement, PlanarMotion, SphericalMotion,
};
use nalgebra::Complex;

/// The values of τ for which `v · exp(I τ)` satisfies a condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solutions {
    /// One value of τ, or two.
    At([Option<JointDisplacement>; 2]),
    /// No τ satisfies the condition, which is missed by this deficit at least.
    None(ReachDeficit),
    /// The condition does not depend on τ.
    Any,
}

/// The values of τ for which `v · exp(I τ)` satisfies `condition`. Lengths are compared with `size`, that of
/// the mechanism in metres.
pub fn along(
    condition: &Condition,
    v: &Displacement,
    motion: &IntersectionMotion,
    size: f64,
) -> Solutions {
    if motion.motion_type().is_none() {
        return Solutions::Any;
    }
    match condition {
        Condition::Circle { point, centre, radius } => {
            let v = v.planar();
            match motion.planar() {
                PlanarMotion::Rotation => {
                    // |P − c + r w e(τ)| = a, P − c = d
                    let (d, w) = (v.translation - centre, v.rotation * point);
                    let arm = length(*point);
                    let constant = d.norm_sqr() + arm * arm - radius * radius;
                    rotations(2.0 * d.conj() * w, constant, size * size, || {
                        let far = d.norm() - (arm + radius);
                        ReachDeficit::length(far.max((arm - radius).abs() - d.norm()))
                    })
                }
                PlanarMotion::Translation(d) => {
                    // |z + r d τ| = a, z = g w − c, with |d| = 1
                    let rate = length(*d);
                    let (z, d) = (v.apply(*point) - centre, v.rotation * d / rate);
                    let (foot, aside) = (dot(d, z), d.re * z.im - d.im * z.re);
                    let square = radius * radius - aside * aside;
                    if square < -2.0 * VERGE * size * size {
                        return Solutions::None(ReachDeficit::length(aside.abs() - radius));
                    }
                    let root = square.max(0.0).sqrt();
                    let at = |root: f64| JointDisplacement::Value((root - foot) / rate);
                    two(at(root), at(-root), root == 0.0)
                }
            }
        }
        Condition::Line { point, normal, offset } => {
            let v = v.planar();
            match motion.planar() {
                PlanarMotion::Rotation => {
                    let constant = dot(*normal, v.translation) - offset;
                    let w = normal.conj() * v.rotation * point;
                    rotations(w, constant, size, || ReachDeficit::length(constant.abs() - w.norm()))
                }
                PlanarMotion::Translation(d) => {
                    let slope = dot(*normal, v.rotation * d);
                    translation(slope, dot(*normal, v.apply(*point)) - offset, size)
                }
            }
        }
        Condition::CarriedLine { point, normal, offset } => {
            let v = v.planar();
            let z = v.rotation.conj() * (point - v.translation);
            match motion.planar() {
                PlanarMotion::Rotation => {
                    // normal · e(−τ) z = Re(conj(normal) conj(e) z) = Re(normal conj(z) e)
                    let w = normal * z.conj();
                    rotations(w, -offset, size, || ReachDeficit::length(offset.abs() - w.norm()))
                }
                PlanarMotion::Translation(d) => {
                    translation(-dot(*normal, *d), dot(*normal, z) - offset, size)
                }
            }
        }
        Condition::Heading { rotation } => match motion.planar() {
            PlanarMotion::Rotation => {
                one(JointDisplacement::Direction(v.planar().rotation.conj() * rotation))
            }
            PlanarMotion::Translation(_) => Solutions::Any,
        },
        Condition::Cone { fixed, carried, cosine } => match motion.spherical() {
            SphericalMotion::Rotation => {
                let (f, w) = (v.spherical().tr_mul(fixed), carried);
                // f · Rz(τ) w = (f.x w.x + f.y w.y) cos τ + (f.y w.x − f.x w.y) sin τ + f.z w.z
                let z = Complex::new(f.x * w.x + f.y * w.y, f.x * w.y - f.y * w.x);
                let constant = f.z * w.z - cosine;
                rotations(z, constant, 1.0, || {
                    let arc = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
                    // The angle between the two ranges over an interval as the axis rotates.
                    let [a, b] = [arc(f.z), arc(w.z)];
                    let (least, most) = ((a - b).abs(), (a + b).min(std::f64::consts::TAU - a - b));
                    ReachDeficit::angle((least - arc(*cosine)).max(arc(*cosine) - most))
                })
            }
        },
        Condition::Flat { normal, value } => {
            let scale = normal.norm() * size.max(1.0);
            translation(normal.dot(&motion.sum()), normal.dot(&v.sum()) - value, scale)
        }
    }
}

/// One solution.
fn one(tau: JointDisplacement) -> Solutions {
    Solutions::At([Some(tau), None])
}

/// Two solutions, or one if they coincide.
fn two(first: JointDisplacement, second: JointDisplacement, coincide: bool) -> Solutions {
    Solutions::At([Some(first), (!coincide).then_some(second)])
}

/// The rotations `e`, `|e| = 1`, with `Re(z e) + constant = 0`. `scale` is the size of the terms that `z` and
/// `constant` are computed from. `deficit` is evaluated if there is no solution.
fn rotations(
    z: Complex<f64>,
    constant: f64,
    scale: f64,
    deficit: impl FnOnce() -> ReachDeficit,
) -> Solutions {
    let square = z.norm_sqr();
    if square <= VERGE * VERGE * scale * scale {
        // The arm has no length, or it swings about the circle's centre.
        return if constant.abs() <= VERGE * scale {
            Solutions::Any
        } else {
            Solutions::None(deficit())
        };
    }
    let root = square - constant * constant;
    if root < -2.0 * VERGE * square.max(scale * square.sqrt()) {
        return Solutions::None(deficit());
    }
    let root = Complex::new(0.0, root.max(0.0).sqrt());
    let at = |sign: f64| JointDisplacement::Direction(z.conj() * (root * sign - constant) / square);
    two(at(1.0), at(-1.0), root.im == 0.0)
}

/// The translation τ with `slope τ + constant = 0`. `scale` is the size of the terms of `constant`.
fn translation(slope: f64, constant: f64, scale: f64) -> Solutions {
    if slope.abs() > VERGE {
        one(JointDisplacement::Value(-constant / slope))
    } else if constant.abs() <= VERGE * scale {
        Solutions::Any
    } else {
        Solutions::None(ReachDeficit::length(constant.abs()))
    }
}
