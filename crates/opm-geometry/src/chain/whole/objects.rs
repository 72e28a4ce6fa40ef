//! What the joints of an arc leave alone.

use super::element::{Element, Kind, Vector};
use super::nodes::{Id, Link, Nodes, meeting};
use super::samples::Sample;
use nalgebra::Vector3;

/// Lines meet, and directions are parallel, if they do so to within this at every sample: radians, or a share of the size.
const STRUCTURE: f64 = 1e-7;
/// Directions that enclose a smaller angle than this do not say well where their lines meet.
const APART: f64 = 0.02;

/// The loop of a leg as one of its joints sees it: the links after it, the target, and those before it. Place `i` is the body
/// before link `i`; what is before the first link is moved by the joint, what is after the last one is not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loop {
    /// The joint.
    pub joint: usize,
    /// The number of joints.
    pub joints: usize,
    /// The joints that are not found yet, as bits.
    pub unknown: u32,
}

/// An object that an arc leaves alone, as it is at a place of the loop.
#[derive(Clone, Copy, Debug)]
pub(super) enum Object {
    Point {
        place: usize,
        point: Id,
    },
    Direction {
        place: usize,
        direction: Id,
    },
    Plane {
        place: usize,
        normal: Id,
        base: Id,
    },
    /// The axis of a helical joint.
    Line {
        place: usize,
        joint: usize,
    },
}

/// The objects that an arc leaves alone.
#[derive(Clone, Debug, Default)]
pub(super) struct Objects {
    /// All of them: the arc is empty.
    pub everything: bool,
    /// All directions.
    pub directions: bool,
    /// Some of the others.
    pub some: Vec<Object>,
}

/// The leg whose arcs are asked for.
#[derive(Clone, Copy)]
pub(super) struct Leg<'a> {
    pub elements: &'a [Element],
    /// The first one is home.
    pub samples: &'a [Sample],
    pub centre: Vector3<f64>,
    pub size: f64,
}

impl Loop {
    /// The link at a place.
    pub fn link(&self, place: usize) -> Link {
        let number = (self.joint + 1 + place) % (self.joints + 1);
        if number == self.joints { Link::Target } else { Link::Joint(number) }
    }

    /// The joint at a place that is not found yet.
    pub fn unknown(&self, place: usize) -> Option<usize> {
        match self.link(place) {
            Link::Joint(joint) if self.unknown & (1 << joint) != 0 => Some(joint),
            Link::Joint(_) | Link::Target => None,
        }
    }

    /// A vector that is known at one place, as it is at another one. Joints that are not found yet leave it alone.
    pub fn carry(&self, nodes: &mut Nodes<'_>, kind: Vector, v: Id, from: usize, to: usize) -> Id {
        let mut all = v;
        let mut pass = |place: usize, outwards: bool| {
            if self.unknown(place).is_none() {
                let link = self.link(place);
                // The joints lead from the base to the platform, the target leads back.
                let back = outwards != (link == Link::Target);
                all = nodes.carried(link, back, kind, all);
            }
        };
        if from <= to {
            (from..to).for_each(|place| pass(place, true));
        } else {
            (to..from).rev().for_each(|place| pass(place, false));
        }
        all
    }
}

impl Leg<'_> {
    /// The samples without home, where axes may coincide by accident.
    fn moved(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter().skip(1)
    }

    /// Whether the axes of two joints are parallel.
    pub fn parallel(&self, a: usize, b: usize) -> bool {
        self.moved().all(|one| one.axes[a].1.cross(&one.axes[b].1).norm() <= STRUCTURE)
    }

    fn across(&self, a: usize, b: usize) -> bool {
        self.moved().all(|one| one.axes[a].1.dot(&one.axes[b].1).abs() <= STRUCTURE)
    }

    fn least_sine(&self, a: usize, b: usize) -> f64 {
        let sines = self.moved().map(|one| one.axes[a].1.cross(&one.axes[b].1).norm());
        sines.fold(f64::INFINITY, f64::min)
    }

    /// Whether the axis of a joint passes through a point, which is given at each sample; a ball has its centre there.
    fn passes(&self, joint: usize, points: &[Vector3<f64>]) -> bool {
        let ball = self.elements[joint].kind == Kind::Ball;
        self.moved().zip(points).all(|(one, point)| {
            let (at, direction) = one.axes[joint];
            let off = if ball { at - point } else { (at - point).cross(&direction) };
            off.norm() <= STRUCTURE * self.size
        })
    }

    /// The foot of the leg's centre on the axis of a joint.
    pub fn foot(&self, joint: usize) -> Vector3<f64> {
        let Element { point, direction, .. } = self.elements[joint];
        point + direction * direction.dot(&(self.centre - point))
    }

    /// What the joints at the places `from..to` leave alone; `towards` is the direction of a slider that is asked about.
    pub fn objects(&self, nodes: &mut Nodes<'_>, seen: &Loop, from: usize, to: usize) -> Objects {
        let arc: Vec<(usize, usize)> =
            (from..to).filter_map(|place| Some((place, seen.unknown(place)?))).collect();
        let of = |kind: fn(&Kind) -> bool| -> Vec<(usize, usize)> {
            arc.iter().copied().filter(|&(_, joint)| kind(&self.elements[joint].kind)).collect()
        };
        if arc.is_empty() {
            return Objects { everything: true, directions: true, some: Vec::new() };
        }
        let balls = of(|kind| matches!(kind, Kind::Ball));
        let turns = of(|kind| matches!(kind, Kind::Turn));
        let helices = of(|kind| matches!(kind, Kind::Helix(_)));
        let slides = of(|kind| matches!(kind, Kind::Slide));
        let circles = of(|kind| matches!(kind, Kind::Circle(_)));
        let mut found = Objects::default();
        if slides.is_empty() && helices.is_empty() && circles.is_empty() {
            self.points(nodes, seen, &balls, &turns, &mut found);
        }
        if !balls.is_empty() {
            return found;
        }
        if let ([(place, joint)], [], [], []) =
            (&helices[..], &turns[..], &slides[..], &circles[..])
        {
            found.some.push(Object::Line { place: *place, joint: *joint });
        }
        // Sliders across a direction, and circles about it, keep the height along it.
        let level = |along: usize| {
            slides.iter().all(|&(_, one)| self.across(along, one))
                && circles.iter().all(|&(_, one)| self.parallel(along, one))
        };
        let axes = || turns.iter().chain(&helices);
        if let Some(&(place, first)) = axes().next() {
            if axes().all(|&(_, joint)| self.parallel(first, joint)) {
                let direction = nodes.constant(self.elements[first].direction);
                found.some.push(Object::Direction { place, direction });
                if helices.is_empty() && level(first) {
                    let base = nodes.constant(self.foot(first));
                    found.some.push(Object::Plane { place, normal: direction, base });
                }
            }
        } else {
            found.directions = true;
            match circles.first() {
                // What circles about one direction, and sliders across it, move in planes across it.
                Some(&(place, first)) => {
                    if level(first) {
                        let normal = nodes.constant(self.elements[first].direction);
                        let base = nodes.constant(self.centre);
                        found.some.push(Object::Plane { place, normal, base });
                    }
                }
                None => self.planes(nodes, seen, &slides, &mut found),
            }
        }
        found
    }

    /// The points that joints with axes or centres leave alone.
    fn points(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        balls: &[(usize, usize)],
        turns: &[(usize, usize)],
        found: &mut Objects,
    ) {
        if let &[(place, ball), ..] = balls {
            let points: Vec<_> = self.moved().map(|one| one.axes[ball].0).collect();
            if balls.iter().chain(turns).all(|&(_, joint)| self.passes(joint, &points)) {
                let point = nodes.constant(self.elements[ball].point);
                found.some.push(Object::Point { place, point });
            }
            return;
        }
        if let &[(place, joint)] = turns {
            let foot = self.foot(joint);
            for along in [0.0, 0.5] {
                let at = foot + self.elements[joint].direction * (along * self.size);
                let point = nodes.constant(at);
                found.some.push(Object::Point { place, point });
            }
            return;
        }
        let pairs = || {
            turns.iter().enumerate().flat_map(|(i, &a)| turns[i + 1..].iter().map(move |&b| (a, b)))
        };
        let sine = |pair: &((usize, usize), (usize, usize))| self.least_sine(pair.0.1, pair.1.1);
        let clear = pairs().find(|pair| sine(pair) > 0.3);
        let Some(((place, a), (other, b))) =
            clear.or_else(|| pairs().max_by(|x, y| sine(x).total_cmp(&sine(y))))
        else {
            return;
        };
        if self.least_sine(a, b) < APART {
            return;
        }
        let points: Vec<_> = self
            .moved()
            .map(|one| {
                let ((p, u), (q, v)) = (one.axes[a], one.axes[b]);
                meeting(&p, &u, &q, &v)
            })
            .collect();
        if !turns.iter().all(|&(_, joint)| self.passes(joint, &points)) {
            return;
        }
        let [one, two] = [a, b].map(|joint| self.elements[joint]);
        let home = meeting(&one.point, &one.direction, &two.point, &two.direction);
        let between = (place + 1..other).all(|at| match seen.link(at) {
            Link::Joint(joint) => nodes.leaves(joint, Vector::Point, &home),
            Link::Target => false,
        });
        let near = (home - two.point).cross(&two.direction).norm() <= STRUCTURE * self.size;
        let point = if between && near {
            nodes.constant(home)
        } else {
            let ends = [one.point, one.direction, two.point, two.direction];
            let [p, u, q, v] = ends.map(|vector| nodes.constant(vector));
            let q = seen.carry(nodes, Vector::Point, q, other, place);
            let v = seen.carry(nodes, Vector::Direction, v, other, place);
            nodes.meet([[p, u], [q, v]])
        };
        found.some.push(Object::Point { place, point });
    }

    /// The planes that sliders leave alone.
    fn planes(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        slides: &[(usize, usize)],
        found: &mut Objects,
    ) {
        let Some(&(place, first)) = slides.first() else { return };
        let base = nodes.constant(self.centre);
        let along = self.elements[first].direction;
        let second =
            slides.iter().skip(1).find(|&&(_, other)| self.least_sine(first, other) > APART);
        let Some(&(other, second)) = second else {
            if slides.len() == 1 {
                // Towards the direction of the joint that is asked about, and across it.
                let towards = self.elements[seen.joint].direction;
                let towards = towards - along * along.dot(&towards);
                let one = towards.try_normalize(APART).unwrap_or_else(|| across(&along));
                for normal in [one, along.cross(&one)] {
                    let normal = nodes.constant(normal);
                    found.some.push(Object::Plane { place, normal, base });
                }
            }
            return;
        };
        let flat = slides.iter().all(|&(_, third)| {
            self.moved().all(|one| {
                let [a, b, c] = [first, second, third].map(|joint| one.axes[joint].1);
                a.cross(&b).dot(&c).abs() <= STRUCTURE
            })
        });
        if flat {
            let [u, v] = [along, self.elements[second].direction].map(|v| nodes.constant(v));
            let v = seen.carry(nodes, Vector::Direction, v, other, place);
            let normal = nodes.cross([u, v]);
            found.some.push(Object::Plane { place, normal, base });
        }
    }
}

/// A unit vector across another one.
pub(super) fn across(direction: &Vector3<f64>) -> Vector3<f64> {
    let axis = Vector3::ith(direction.iamin(), 1.0);
    direction.cross(&axis).normalize()
}
