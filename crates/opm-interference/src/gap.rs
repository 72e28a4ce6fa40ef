//! Bounds of the distance of two shapes over a box of poses, which is linear to first order.
//!
//! Over a box, each end of a capsule is a linear function of the pose to within an error
//! ([`Manipulator::places_over`](opm_core::manipulator::Manipulator::places_over)), and each point of its axis is a mean of the
//! ends. With the two points of the axes that are nearest in the middle of the box, and the unit vector `n` between them,
//!
//! * the distance of the axes is at least `min n·p - max n·q` over their ends `p` and `q`, a least value of linear functions;
//! * it is at most the distance of these two points, which is largest in a corner of the box.
//!
//! Both are off by a quadratic function of the size of the box.

use crate::distance::Capsule;
use opm_core::enclosure::{Affine, Place};
use parry3d_f64::math::{Pose, Vector};

/// Which poses of a box a bound holds for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Poses {
    All,
    /// The one at this place in the box: for each side that has a width, from -1 to 1.
    At([f64; 2]),
}

/// Where a point is over a box, in units of the mechanism's size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointOver {
    /// The linear function: its value in the middle, and the change to the end of each side that has a width.
    centre: Vector,
    slopes: [Vector; 2],
    /// How far the point is from the linear function at most.
    error: f64,
}

impl PointOver {
    pub fn at_rest(centre: Vector) -> Self {
        Self { centre, slopes: [Vector::ZERO; 2], error: 0.0 }
    }

    /// A point of which nothing is known has an infinite error.
    pub fn new(place: Option<&Place<2>>, unit: f64) -> Self {
        let Some(place) = place else {
            return Self { error: f64::INFINITY, ..Self::at_rest(Vector::ZERO) };
        };
        let vector = |of: &dyn Fn(&Affine<2>) -> f64| Vector::from(place.each_ref().map(of)) / unit;
        Self {
            centre: vector(&|x| x.centre),
            slopes: [0, 1].map(|side| vector(&|x| x.slope[side])),
            error: vector(&Affine::total_error).length(),
        }
    }

    fn at(&self, [a, b]: [f64; 2]) -> Vector {
        self.centre + self.slopes[0] * a + self.slopes[1] * b
    }

    /// The component in a direction, at least or at most.
    fn along(&self, n: Vector, error: f64) -> Linear {
        Linear { centre: n.dot(self.centre) + error, slopes: self.slopes.map(|s| n.dot(s)) }
    }
}

/// A linear function on a box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linear {
    centre: f64,
    slopes: [f64; 2],
}

impl Linear {
    fn at(&self, [a, b]: [f64; 2]) -> f64 {
        self.centre + self.slopes[0] * a + self.slopes[1] * b
    }

    fn spread(&self) -> f64 {
        self.slopes[0].abs() + self.slopes[1].abs()
    }

    fn least(&self) -> f64 {
        self.centre - self.spread()
    }

    fn most(&self) -> f64 {
        self.centre + self.spread()
    }

    /// The least value of the difference from another one.
    fn least_above(&self, other: &Self) -> f64 {
        let slopes = [0, 1].map(|i| self.slopes[i] - other.slopes[i]);
        Self { centre: self.centre - other.centre, slopes }.least()
    }
}

/// A capsule over a box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CapsuleOver {
    pub ends: [PointOver; 2],
    pub radius: f64,
}

impl CapsuleOver {
    fn at(&self, at: [f64; 2]) -> Capsule {
        Capsule { ends: self.ends.each_ref().map(|end| end.at(at)), radius: self.radius }
    }

    /// How far a point of the axis is from the same mean of the linear functions.
    fn error(&self) -> f64 {
        self.ends[0].error.max(self.ends[1].error)
    }

    /// A capsule, and how far points of this one's axis may be from the same means of its ends.
    fn over(&self, poses: Poses) -> (Capsule, f64) {
        match poses {
            Poses::All => {
                let off = self
                    .ends
                    .each_ref()
                    .map(|end| (end.slopes[0].abs() + end.slopes[1].abs()).length() + end.error);
                (self.at([0.0; 2]), off[0].max(off[1]))
            }
            Poses::At(at) => (self.at(at), self.error()),
        }
    }

    /// The mean of the ends with these weights.
    fn mean(&self, [a, b]: [f64; 2]) -> PointOver {
        let [one, other] = &self.ends;
        PointOver {
            centre: one.centre * a + other.centre * b,
            slopes: [0, 1].map(|i| one.slopes[i] * a + other.slopes[i] * b),
            error: self.error(),
        }
    }

    fn along(&self, n: Vector, sign: f64) -> [Linear; 2] {
        self.ends.each_ref().map(|end| end.along(n, sign * end.error))
    }
}

/// Two shapes over a box, and what bounds their distance.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Gap {
    Capsules {
        /// The components of the ends along `n`: of the one capsule at least, of the other at most.
        one: [Linear; 2],
        other: [Linear; 2],
        /// From one of the two points to the other.
        between: PointOver,
        radii: f64,
    },
    /// The heights of the ends above a half-space less the radius, and by how much they may be off.
    HalfSpace {
        heights: [Linear; 2],
        error: f64,
    },
    Box {
        capsule: CapsuleOver,
        pose: Pose,
        half: Vector,
    },
}

impl Gap {
    pub fn of_capsules(one: &CapsuleOver, other: &CapsuleOver) -> Self {
        let [p, q] = one.at([0.0; 2]).nearest_points(&other.at([0.0; 2]));
        let (p, q) = (one.mean(p), other.mean(q));
        let between = PointOver {
            centre: p.centre - q.centre,
            slopes: [0, 1].map(|i| p.slopes[i] - q.slopes[i]),
            error: p.error + q.error,
        };
        // Where the axes meet, there is no direction, and nothing is known of the least distance.
        let n = between.centre.normalize_or_zero();
        let radii = one.radius + other.radius;
        Self::Capsules { one: one.along(n, -1.0), other: other.along(n, 1.0), between, radii }
    }

    pub fn to_half_space(capsule: &CapsuleOver, normal: Vector, offset: f64) -> Self {
        let above = -offset - capsule.radius;
        let heights = capsule.ends.each_ref().map(|end| end.along(normal, above));
        Self::HalfSpace { heights, error: capsule.error() }
    }

    /// At most the distance.
    pub fn least(&self, poses: Poses) -> f64 {
        match (self, poses) {
            (Self::Capsules { one: [a, b], other: [c, d], radii, .. }, Poses::All) => {
                let [ac, ad] = [a.least_above(c), a.least_above(d)];
                let [bc, bd] = [b.least_above(c), b.least_above(d)];
                ac.min(ad).min(bc).min(bd) - radii
            }
            (Self::Capsules { one: [a, b], other: [c, d], radii, .. }, Poses::At(at)) => {
                a.at(at).min(b.at(at)) - c.at(at).max(d.at(at)) - radii
            }
            (Self::HalfSpace { heights: [a, b], error }, Poses::All) => {
                a.least().min(b.least()) - error
            }
            (Self::HalfSpace { heights: [a, b], error }, Poses::At(at)) => {
                a.at(at).min(b.at(at)) - error
            }
            (Self::Box { capsule, pose, half }, _) => {
                let (capsule, off) = capsule.over(poses);
                capsule.distance_to_box(pose, *half) - off
            }
        }
    }

    /// At least the distance.
    pub fn most(&self, poses: Poses) -> f64 {
        match (self, poses) {
            (Self::Capsules { between, radii, .. }, Poses::All) => {
                let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
                let far = corners.map(|corner| between.at(corner).length());
                far.into_iter().fold(0.0, f64::max) + between.error - radii
            }
            (Self::Capsules { between, radii, .. }, Poses::At(at)) => {
                between.at(at).length() + between.error - radii
            }
            (Self::HalfSpace { heights: [a, b], error }, Poses::All) => {
                a.most().min(b.most()) + error
            }
            (Self::HalfSpace { heights: [a, b], error }, Poses::At(at)) => {
                a.at(at).min(b.at(at)) + error
            }
            (Self::Box { capsule, pose, half }, _) => {
                let (capsule, off) = capsule.over(poses);
                capsule.distance_to_box(pose, *half) + off
            }
        }
    }
}
