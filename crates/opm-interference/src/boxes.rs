//! Whether all distances are large enough over boxes of poses, without a distance at each pose.
//!
//! Over a box, each end of a capsule is in a ball ([`Manipulator::places_over`]). Every point of the capsule's axis is a
//! mean of its ends, and so within the larger of their radii of the same mean of the balls' centres. So with `d` the
//! distance of the capsules between the centres, and `r` and `s` these radii,
//!
//! ```text
//! d - r - s  <=  the distance at each pose of the box  <=  d + r + s
//! ```

use crate::distance::{Capsule, INACCURACY};
use crate::distances::Distances;
use crate::member::{End, Shape, scaled};
use crate::{Interference, Pair};
use opm_core::enclosure::{Ball, BodyPoint, MovingBody, Side};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::joint::JointKind;
use parry3d_f64::math::Vector;

/// Points nearer than this, as a share of the mechanism's size, are one: far less than distances may be off.
const ONE_POINT: f64 = 1e-12;

/// Whether the members of a mechanism keep a clearance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clearance {
    /// At every pose of the box that is in reach, all pairs are far enough apart.
    Clear,
    /// At none of them.
    Blocked,
    /// The bounds do not tell.
    Open,
}

/// The pairs that bounds over a box leave open. The others are far enough apart.
#[derive(Clone, Debug, Default)]
pub struct Open {
    pairs: Vec<usize>,
}

/// Decides by a clearance, over boxes of poses and at single poses, with working memory of its own.
#[derive(Clone, Debug)]
pub struct BoxTest<'a> {
    manipulator: &'a Manipulator,
    distances: Distances<'a>,
    /// The least distance, in units of the mechanism's size.
    least: f64,
    /// The ends of capsules that move, each once.
    points: Vec<BodyPoint>,
    /// The numbers of these points, or the place of an end at rest, for the ends of every capsule.
    ends: Vec<[EndPlace; 2]>,
    /// The points that are asked for, and where they are.
    wanted: Vec<usize>,
    asked: Vec<BodyPoint>,
    balls: Vec<Ball>,
    places: Vec<ScaledBall>,
    /// Whether each point is asked for, while they are collected.
    marked: Vec<bool>,
    /// The pair that was too near at the last pose that was tested and failed: a pose beside it mostly fails by the same.
    nearest: usize,
}

/// Where the end of a capsule is.
#[derive(Clone, Copy, Debug)]
enum EndPlace {
    AtRest(Vector),
    Moving(usize),
}

/// A ball in units of the mechanism's size.
#[derive(Clone, Copy, Debug)]
struct ScaledBall {
    centre: Vector,
    radius: f64,
}

impl<'a> BoxTest<'a> {
    /// Tests the pairs of a mechanism by a least distance, metres.
    pub fn new(manipulator: &'a Manipulator, interference: &'a Interference, least: f64) -> Self {
        let mut points: Vec<BodyPoint> = Vec::new();
        let carriers = carriers(manipulator);
        let bodies = interference.skeleton.bodies();
        let mut place = |end: &End| {
            let home = end.point + bodies[end.body].origin.coords;
            let Some(body) = carriers[end.body] else {
                return EndPlace::AtRest(scaled(&home.coords, interference.unit));
            };
            let point = BodyPoint { body, home };
            let known = points.iter().position(|known| {
                *known == point || stay_together(manipulator, known, &point, interference.unit)
            });
            EndPlace::Moving(known.unwrap_or_else(|| {
                points.push(point);
                points.len() - 1
            }))
        };
        let nowhere = EndPlace::AtRest(Vector::ZERO);
        let ends = interference.shapes.iter().map(|shape| match shape {
            Shape::Capsule { ends: [a, b], .. } => [place(a), place(b)],
            Shape::Box { .. } | Shape::HalfSpace { .. } => [nowhere; 2],
        });
        let ends = ends.collect();
        let anywhere = ScaledBall { centre: Vector::ZERO, radius: f64::INFINITY };
        Self {
            manipulator,
            distances: Distances::new(interference),
            least: least / interference.unit,
            places: vec![anywhere; points.len()],
            marked: vec![false; points.len()],
            points,
            ends,
            wanted: Vec::new(),
            asked: Vec::new(),
            balls: Vec::new(),
            nearest: 0,
        }
    }

    /// Whether boxes are of any use for this mechanism: see [`Manipulator::encloses_places`].
    pub fn takes_boxes(&self) -> bool {
        self.manipulator.encloses_places()
    }

    /// All pairs.
    pub fn all(&self) -> Open {
        Open { pairs: (0..self.distances.interference().pairs()).collect() }
    }

    /// Tests a box of poses in one working mode, for the pairs that a larger box left open, and writes those that this
    /// one leaves open.
    pub fn over_box(
        &mut self,
        mode: Mode,
        sides: &[Side],
        open: &Open,
        left: &mut Open,
    ) -> Clearance {
        self.find_places(mode, sides, open);
        let interference = self.distances.interference();
        left.pairs.clear();
        for &number in &open.pairs {
            let [low, high] = self.bounds(&interference.pairs[number]);
            if high < self.least - INACCURACY {
                return Clearance::Blocked;
            }
            // A bound that is not a number leaves the pair open, too.
            let apart = low >= self.least + INACCURACY;
            if !apart {
                left.pairs.push(number);
            }
        }
        if left.pairs.is_empty() { Clearance::Clear } else { Clearance::Open }
    }

    /// Whether the pairs that were left open are far enough apart at one pose.
    pub fn at(&mut self, solution: &Solution, open: &Open) -> bool {
        self.distances.place(self.manipulator, solution);
        let apart = |pair: usize| self.distances.are_apart(pair, self.least);
        if open.pairs.contains(&self.nearest) && !apart(self.nearest) {
            return false;
        }
        match open.pairs.iter().find(|&&pair| !apart(pair)) {
            Some(&near) => self.nearest = near,
            None => return true,
        }
        false
    }

    /// Finds where the ends of the capsules of some pairs are.
    fn find_places(&mut self, mode: Mode, sides: &[Side], open: &Open) {
        let interference = self.distances.interference();
        self.wanted.clear();
        for &number in &open.pairs {
            let shapes = interference.pairs[number].shapes.iter().flatten();
            for place in shapes.flat_map(|&shape| self.ends[shape]) {
                if let EndPlace::Moving(point) = place {
                    self.marked[point] = true;
                }
            }
        }
        let marked = self.marked.iter_mut().enumerate();
        self.wanted.extend(marked.filter_map(|(p, mark)| std::mem::take(mark).then_some(p)));
        self.asked.clear();
        self.asked.extend(self.wanted.iter().map(|&point| self.points[point]));
        self.manipulator.places_over(mode, sides, &self.asked, &mut self.balls);
        let unit = interference.unit;
        for (&point, ball) in self.wanted.iter().zip(&self.balls) {
            let centre = scaled(&ball.centre.coords, unit);
            self.places[point] = ScaledBall { centre, radius: ball.radius / unit };
        }
    }

    /// Certain bounds of the distance of a pair, in units of the mechanism's size.
    fn bounds(&self, pair: &Pair) -> [f64; 2] {
        let bounds = pair.shapes.iter().map(|&shapes| self.bounds_between(shapes));
        bounds.fold([f64::INFINITY; 2], |all, one| [all[0].min(one[0]), all[1].min(one[1])])
    }

    fn bounds_between(&self, [one, other]: [usize; 2]) -> [f64; 2] {
        let shapes = &self.distances.interference().shapes;
        let Some((capsule, r)) = self.capsule(one) else { return [f64::INFINITY; 2] };
        let (distance, s) = match &shapes[other] {
            Shape::Capsule { .. } => match self.capsule(other) {
                Some((other, s)) if r.is_finite() && s.is_finite() => {
                    (capsule.distance_to_capsule(&other), s)
                }
                Some(_) | None => return [f64::NEG_INFINITY, f64::INFINITY],
            },
            _ if !r.is_finite() => return [f64::NEG_INFINITY, f64::INFINITY],
            Shape::Box { pose, half } => (capsule.distance_to_box(pose, *half), 0.0),
            Shape::HalfSpace { normal, offset } => {
                (capsule.distance_to_half_space(*normal, *offset), 0.0)
            }
        };
        [distance - r - s, distance + r + s]
    }

    /// The capsule between the centres, and how far its points may be from there.
    fn capsule(&self, number: usize) -> Option<(Capsule, f64)> {
        let Shape::Capsule { radius, .. } = self.distances.interference().shapes[number] else {
            return None;
        };
        let balls = self.ends[number].map(|end| match end {
            EndPlace::AtRest(centre) => ScaledBall { centre, radius: 0.0 },
            EndPlace::Moving(point) => self.places[point],
        });
        let off = balls[0].radius.max(balls[1].radius);
        Some((Capsule { ends: balls.map(|ball| ball.centre), radius }, off))
    }
}

/// Whether points of two bodies are one at every pose: the bodies share a joint, and the points are at its centre, or on its
/// axis if it is revolute.
fn stay_together(manipulator: &Manipulator, one: &BodyPoint, other: &BodyPoint, size: f64) -> bool {
    let legs = &manipulator.mechanism().legs;
    let last = |leg: usize| legs[leg].joints.len();
    let joint = match (one.body, other.body) {
        (MovingBody::Link { leg, joints }, MovingBody::Link { leg: same, joints: next })
            if leg == same && joints.abs_diff(next) == 1 =>
        {
            &legs[leg].joints[joints.min(next)]
        }
        (MovingBody::Link { leg, joints }, MovingBody::Platform)
        | (MovingBody::Platform, MovingBody::Link { leg, joints })
            if joints + 1 == last(leg) =>
        {
            &legs[leg].joints[joints]
        }
        _ => return false,
    };
    let arm = one.home - joint.point;
    let off = match joint.kind {
        JointKind::Revolute => arm.cross(&joint.axis).norm(),
        JointKind::Universal { .. } | JointKind::Spherical => arm.norm(),
        JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Cylindrical => return false,
    };
    off.max((one.home - other.home).norm()) <= ONE_POINT * size
}

/// What each body of the skeleton is; `None` for the base.
fn carriers(manipulator: &Manipulator) -> Vec<Option<MovingBody>> {
    let legs = manipulator.mechanism().legs.iter().enumerate();
    let links = legs.flat_map(|(leg, joints)| {
        (1..joints.joints.len()).map(move |joints| Some(MovingBody::Link { leg, joints }))
    });
    [None].into_iter().chain(links).chain([Some(MovingBody::Platform)]).collect()
}
