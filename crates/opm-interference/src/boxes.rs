//! Whether all distances are large enough over boxes of poses, without a distance at each pose: by certain bounds ([`gap`]).
//!
//! [`gap`]: crate::gap

use crate::Interference;
use crate::distance::INACCURACY;
use crate::distances::Distances;
use crate::gap::{CapsuleOver, Gap, PointOver, Poses};
use crate::member::{End, Shape, scaled};
use opm_core::enclosure::{BodyPoint, MovingBody, Place, Side};
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

/// The pairs of shapes that bounds over a box leave open. The others are far enough apart.
#[derive(Clone, Debug, Default)]
pub struct Open {
    pairs: Vec<[usize; 2]>,
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
    found: Vec<Option<Place<2>>>,
    places: Vec<PointOver>,
    /// Whether each point is asked for, while they are collected.
    marked: Vec<bool>,
    /// Those sides of the last box that have a width: the number of the coordinate, the middle, and half of the width.
    wide: Vec<(usize, f64, f64)>,
    /// The pairs that the last box left open. One that is too near at a pose comes first at the next one.
    gaps: Vec<Gap>,
    /// The pair that was too near at the last pose that was tested and failed: a pose beside it mostly fails by the same.
    nearest: [usize; 2],
}

/// Where the end of a capsule is.
#[derive(Clone, Copy, Debug)]
enum EndPlace {
    AtRest(Vector),
    Moving(usize),
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
        Self {
            manipulator,
            distances: Distances::new(interference),
            least: least / interference.unit,
            places: vec![PointOver::at_rest(Vector::ZERO); points.len()],
            marked: vec![false; points.len()],
            points,
            ends,
            wanted: Vec::new(),
            asked: Vec::new(),
            found: Vec::new(),
            wide: Vec::new(),
            gaps: Vec::new(),
            nearest: [0; 2],
        }
    }

    /// Whether boxes are of any use for this mechanism: see [`Manipulator::encloses_places`].
    pub fn takes_boxes(&self) -> bool {
        self.manipulator.encloses_places()
    }

    /// All pairs.
    pub fn all(&self) -> Open {
        let pairs = self.distances.interference().pairs.iter();
        Open { pairs: pairs.flat_map(|pair| pair.shapes.iter().copied()).collect() }
    }

    /// Tests a box of poses in one working mode, for the pairs that a larger box left open, and writes those that this
    /// one leaves open. At most two sides have a width.
    pub fn over_box(
        &mut self,
        mode: Mode,
        sides: &[Side],
        open: &Open,
        left: &mut Open,
    ) -> Clearance {
        self.find_places(mode, sides, open);
        left.pairs.clear();
        self.gaps.clear();
        for &pair in &open.pairs {
            // The first shape of a pair is a capsule.
            let Some(gap) = self.gap(pair) else { continue };
            match decided(&gap, Poses::All, self.least) {
                Clearance::Clear => {}
                Clearance::Blocked => return Clearance::Blocked,
                Clearance::Open => {
                    left.pairs.push(pair);
                    self.gaps.push(gap);
                }
            }
        }
        if left.pairs.is_empty() { Clearance::Clear } else { Clearance::Open }
    }

    /// Tests one pose of the box that was tested last and left pairs open.
    pub fn in_box(&mut self, pose: &[f64]) -> Clearance {
        let mut at = [0.0; 2];
        for (at, &(number, middle, half)) in at.iter_mut().zip(&self.wide) {
            *at = (pose[number] - middle) / half;
        }
        let mut all = Clearance::Clear;
        for number in 0..self.gaps.len() {
            match decided(&self.gaps[number], Poses::At(at), self.least) {
                Clearance::Clear => {}
                Clearance::Open => all = Clearance::Open,
                Clearance::Blocked => {
                    self.gaps.swap(0, number);
                    return Clearance::Blocked;
                }
            }
        }
        all
    }

    /// Whether the pairs that were left open are far enough apart at one pose.
    pub fn at(&mut self, solution: &Solution, open: &Open) -> bool {
        self.distances.place(self.manipulator, solution);
        let apart = |pair: [usize; 2]| self.distances.are_apart(pair, self.least);
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
        self.wide.clear();
        let wide = sides.iter().enumerate().filter(|(_, side)| side.half > 0.0);
        self.wide.extend(wide.map(|(number, side)| (number, side.middle, side.half)));
        self.wanted.clear();
        for place in open.pairs.iter().flatten().flat_map(|&shape| self.ends[shape]) {
            if let EndPlace::Moving(point) = place {
                self.marked[point] = true;
            }
        }
        let marked = self.marked.iter_mut().enumerate();
        self.wanted.extend(marked.filter_map(|(p, mark)| std::mem::take(mark).then_some(p)));
        self.asked.clear();
        self.asked.extend(self.wanted.iter().map(|&point| self.points[point]));
        self.manipulator.places_over(mode, sides, &self.asked, &mut self.found);
        let unit = self.distances.interference().unit;
        for (&point, found) in self.wanted.iter().zip(&self.found) {
            self.places[point] = PointOver::new(found.as_ref(), unit);
        }
    }

    /// What bounds the distance of a pair.
    fn gap(&self, [one, other]: [usize; 2]) -> Option<Gap> {
        let capsule = self.capsule(one)?;
        Some(match &self.distances.interference().shapes[other] {
            Shape::Capsule { .. } => Gap::of_capsules(&capsule, &self.capsule(other)?),
            Shape::HalfSpace { normal, offset } => Gap::to_half_space(&capsule, *normal, *offset),
            &Shape::Box { pose, half } => Gap::Box { capsule, pose, half },
        })
    }

    /// A capsule over the last box.
    fn capsule(&self, number: usize) -> Option<CapsuleOver> {
        let Shape::Capsule { radius, .. } = self.distances.interference().shapes[number] else {
            return None;
        };
        let ends = self.ends[number].map(|end| match end {
            EndPlace::AtRest(centre) => PointOver::at_rest(centre),
            EndPlace::Moving(point) => self.places[point],
        });
        Some(CapsuleOver { ends, radius })
    }
}

/// What certain bounds tell. A bound that is not a number tells nothing.
fn decided(gap: &Gap, poses: Poses, least: f64) -> Clearance {
    if gap.least(poses) >= least + INACCURACY {
        Clearance::Clear
    } else if gap.most(poses) < least - INACCURACY {
        Clearance::Blocked
    } else {
        Clearance::Open
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
