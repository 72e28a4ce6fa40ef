//! What can find one joint while others are not found yet, and how well.

use super::element::{Element, Kind, Vector};
use super::equation::{Equation, Kernel, Scalar};
use super::nodes::{Id, Nodes};
use super::objects::{Leg, Loop, Object, Objects, across};
use nalgebra::Vector3;

/// An equation holds if it does so to within this at every sample, relative to its scale.
const HOLDS: f64 = 1e-7;
/// A coefficient that is smaller at the middle one of the samples is zero.
const NONE: f64 = 1e-6;
/// A root with a smaller slope than this at the middle one of the samples is weak. Few legs are near it, so that congruent
/// ones have the same order whatever their samples.
const WEAK: f64 = 0.02;
/// The same for the rate of a slider's height, which is the same at most samples.
const WEAK_RATE: f64 = 0.1;

/// A kernel that finds a joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub joint: usize,
    pub kernel: Kernel<Id>,
    /// By which the best one is taken, least first: whether it is weak, and what depends on the leg's shape alone.
    pub rank: (bool, bool, u8, usize),
}

/// An equation at the samples: for an angle the coefficients over the scale, and the slope.
struct Sampled {
    equation: Equation<Id>,
    cost: usize,
    rows: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

/// The number in the middle.
fn middle(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

impl Leg<'_> {
    /// The best kernel that gives one root, and the best one that gives two.
    pub fn candidates(&self, nodes: &mut Nodes<'_>, seen: &Loop) -> Vec<Candidate> {
        let element = &self.elements[seen.joint];
        if element.kind == Kind::Ball {
            return Vec::new();
        }
        let mut equations = Vec::new();
        let mut found = Vec::new();
        let unknown: Vec<usize> =
            (0..seen.joints).filter(|&place| seen.unknown(place).is_some()).collect();
        for cut in 0..=unknown.len() {
            let first = cut.checked_sub(1).map_or(0, |last| unknown[last] + 1);
            let last = unknown.get(cut).copied().unwrap_or(seen.joints);
            let a = self.objects(nodes, seen, 0, first);
            let b = self.objects(nodes, seen, last, seen.joints);
            self.direct(nodes, seen, &a, &b, &mut found);
            self.invariants(nodes, seen, [first, last], &a, &b, &mut equations);
        }
        equations.extend(self.beside_circle(nodes, seen, &unknown));
        match element.kind {
            Kind::Turn | Kind::Circle(_) => self.angles(nodes, seen, equations, &mut found),
            Kind::Helix(_) => {
                let angle = |one: &&(Equation<Id>, usize)| matches!(one.0, Equation::Angle { .. });
                let angles = equations.iter().filter(angle).copied().collect();
                self.angles(nodes, seen, angles, &mut found);
                self.lengths(nodes, seen, equations, &mut found);
            }
            Kind::Slide => self.lengths(nodes, seen, equations, &mut found),
            Kind::Ball => {}
        }
        let best = |chooses: bool| {
            let these = found.iter().filter(|one| one.kernel.chooses() == chooses);
            these.min_by_key(|one| one.rank).copied()
        };
        [false, true].into_iter().filter_map(best).collect()
    }

    /// The equation where the only other unknown is a circle: what it carries stays at its arm's length from a point on its other
    /// side.
    fn beside_circle(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        unknown: &[usize],
    ) -> Option<(Equation<Id>, usize)> {
        let &[place] = unknown else { return None };
        let Kind::Circle(arm) = self.elements[seen.unknown(place)?].kind else { return None };
        let [near, far] = [self.centre - arm, self.centre].map(|point| nodes.constant(point));
        let moved = seen.carry(nodes, Vector::Point, near, place, 0);
        let fixed = seen.carry(nodes, Vector::Point, far, place + 1, seen.joints);
        let square = Scalar::Known(arm.norm_squared());
        Some((Equation::Distance { moved, fixed, square }, nodes.cost(moved) + nodes.cost(fixed)))
    }

    fn add(
        &self,
        seen: &Loop,
        kernel: Kernel<Id>,
        quality: f64,
        order: u8,
        cost: usize,
        to: &mut Vec<Candidate>,
    ) {
        if quality > NONE {
            let weak = if matches!(kernel, Kernel::Linear(_)) { WEAK_RATE } else { WEAK };
            let rank = (quality < weak, kernel.chooses(), order, cost);
            to.push(Candidate { joint: seen.joint, kernel, rank });
        }
    }

    /// Kernels by objects of one arc where the other one leaves everything alone.
    fn direct(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        a: &Objects,
        b: &Objects,
        to: &mut Vec<Candidate>,
    ) {
        let element = &self.elements[seen.joint];
        let end = seen.joints;
        let mut points: Vec<(usize, Id)> = Vec::new();
        let mut directions: Vec<(usize, Id)> = Vec::new();
        let mut lines: Vec<(usize, Id)> = Vec::new();
        for (one, other) in [(a, b), (b, a)] {
            for object in &one.some {
                match *object {
                    Object::Point { place, point } if other.everything => {
                        points.push((place, point));
                    }
                    Object::Direction { place, direction } if other.directions => {
                        directions.push((place, direction));
                    }
                    Object::Line { place, joint }
                        if other.everything
                            && element.kind != Kind::Slide
                            && self.parallel(joint, seen.joint) =>
                    {
                        lines.push((place, nodes.constant(self.foot(joint))));
                    }
                    Object::Point { .. }
                    | Object::Direction { .. }
                    | Object::Plane { .. }
                    | Object::Line { .. } => {}
                }
            }
        }
        if a.directions && b.directions {
            directions.push((0, nodes.constant(across(&element.direction))));
        }
        if a.everything && b.everything {
            points.push((0, nodes.constant(self.centre)));
        }
        let samples = self.samples.len();
        if element.turns() {
            for (place, v) in directions {
                let moved = seen.carry(nodes, Vector::Direction, v, place, 0);
                let fixed = seen.carry(nodes, Vector::Direction, v, place, end);
                let sines =
                    (1..samples).map(|s| nodes.value(moved, s).cross(&element.direction).norm());
                let (quality, cost) = (middle(sines), nodes.cost(moved) + nodes.cost(fixed));
                self.add(seen, Kernel::Direction { moved, fixed }, quality, 0, cost, to);
            }
        }
        let arm = |nodes: &Nodes<'_>, moved: Id| {
            middle((1..samples).map(|s| {
                let arm = match element.kind {
                    Kind::Circle(arm) => arm,
                    _ => nodes.value(moved, s) - element.point,
                };
                arm.cross(&element.direction).norm() / self.size
            }))
        };
        for (place, v) in points {
            let moved = seen.carry(nodes, Vector::Point, v, place, 0);
            let fixed = seen.carry(nodes, Vector::Point, v, place, end);
            let quality = match element.kind {
                Kind::Turn | Kind::Circle(_) => arm(nodes, moved),
                Kind::Helix(_) | Kind::Slide | Kind::Ball => 1.0,
            };
            let cost = nodes.cost(moved) + nodes.cost(fixed);
            self.add(seen, Kernel::Point { moved, fixed }, quality, 0, cost, to);
        }
        for (place, v) in lines {
            let moved = seen.carry(nodes, Vector::Point, v, place, 0);
            let fixed = seen.carry(nodes, Vector::Point, v, place, end);
            let cost = nodes.cost(moved) + nodes.cost(fixed);
            self.add(seen, Kernel::Line { moved, fixed }, arm(nodes, moved), 1, cost, to);
        }
    }

    /// The equations between the objects of two arcs, which meet at one of the places `gap`.
    fn invariants(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        [first, last]: [usize; 2],
        a: &Objects,
        b: &Objects,
        to: &mut Vec<(Equation<Id>, usize)>,
    ) {
        let shifts = self.elements[seen.joint].kind != Kind::Turn;
        let end = seen.joints;
        let (mut moved, mut fixed) = (a.some.clone(), b.some.clone());
        if shifts {
            // Any point will do for the height over a plane of the other arc.
            let centre = nodes.constant(self.centre);
            if a.everything && !b.everything {
                moved.push(Object::Point { place: 0, point: centre });
            }
            if b.everything && !a.everything {
                fixed.push(Object::Point { place: end, point: centre });
            }
        }
        use Vector::{Direction, Point};
        for one in &moved {
            for other in &fixed {
                // At the place where the least is to be done to see both objects.
                let mut best: Option<(Equation<Id>, usize)> = None;
                for at in first..=last {
                    let mut go = |kind, v, from, to| seen.carry(nodes, kind, v, from, to);
                    let (equation, ids) = match (*one, *other) {
                        (
                            Object::Point { place: i, point: p },
                            Object::Point { place: j, point: r },
                        ) => {
                            let (moved, fixed) = (go(Point, p, i, 0), go(Point, r, j, end));
                            let two = [go(Point, p, i, at), go(Point, r, j, at)];
                            let square = self.scalar(nodes, Scalar::Square(two));
                            (
                                Equation::Distance { moved, fixed, square },
                                [moved, fixed, two[0], two[1], two[0], two[0]],
                            )
                        }
                        (
                            Object::Point { place, point },
                            Object::Plane { place: of, normal, base },
                        ) => {
                            let two = [(place, point, 0), (of, normal, end)];
                            self.height(nodes, seen, two, base, at, false)
                        }
                        (
                            Object::Plane { place: of, normal, base },
                            Object::Point { place, point },
                        ) => {
                            let two = [(place, point, end), (of, normal, 0)];
                            self.height(nodes, seen, two, base, at, true)
                        }
                        (
                            Object::Direction { place: i, direction: u },
                            Object::Direction { place: j, direction: v },
                        ) => {
                            let (moved, fixed) = (go(Direction, u, i, 0), go(Direction, v, j, end));
                            let two = [go(Direction, u, i, at), go(Direction, v, j, at)];
                            let cosine = self.scalar(nodes, Scalar::Cosine(two));
                            (
                                Equation::Angle { moved, fixed, cosine },
                                [moved, fixed, two[0], two[1], two[0], two[0]],
                            )
                        }
                        (Object::Point { .. }, Object::Direction { .. } | Object::Line { .. })
                        | (
                            Object::Direction { .. },
                            Object::Point { .. } | Object::Plane { .. } | Object::Line { .. },
                        )
                        | (
                            Object::Plane { .. },
                            Object::Direction { .. } | Object::Plane { .. } | Object::Line { .. },
                        )
                        | (
                            Object::Line { .. },
                            Object::Point { .. }
                            | Object::Direction { .. }
                            | Object::Plane { .. }
                            | Object::Line { .. },
                        ) => break,
                    };
                    let cost = ids.iter().map(|&id| nodes.cost(id)).sum();
                    if best.is_none_or(|(_, least)| cost < least) {
                        best = Some((equation, cost));
                    }
                }
                to.extend(best);
            }
        }
    }

    /// The height of a point over a plane, each with its place and that to which it is carried, and what both need. It is the
    /// same number at the place `at`. `back` says that the plane moves.
    fn height(
        &self,
        nodes: &mut Nodes<'_>,
        seen: &Loop,
        [(place, point, to), (of, normal, end)]: [(usize, Id, usize); 2],
        base: Id,
        at: usize,
        back: bool,
    ) -> (Equation<Id>, [Id; 6]) {
        use Vector::{Direction, Point};
        let mut go = |kind, v, from, to| seen.carry(nodes, kind, v, from, to);
        let moved = go(Point, point, place, to);
        let [n, o] = [go(Direction, normal, of, end), go(Point, base, of, end)];
        let point = go(Point, point, place, at);
        let [m, q] = [go(Direction, normal, of, at), go(Point, base, of, at)];
        let height = self.scalar(nodes, Scalar::Height { point, normal: m, base: q });
        (Equation::Height { moved, normal: n, base: o, height, back }, [moved, n, o, point, m, q])
    }

    /// A number, as a constant where it is one.
    fn scalar(&self, nodes: &Nodes<'_>, scalar: Scalar<Id>) -> Scalar<Id> {
        let ids: &[Id] = match &scalar {
            Scalar::Known(_) => &[],
            Scalar::Square(two) | Scalar::Cosine(two) => two,
            Scalar::Height { point, normal, base } => &[*point, *normal, *base],
        };
        if ids.iter().all(|&id| nodes.known(id).is_some()) {
            return Scalar::Known(scalar.of::<f64>(|id| nodes.value(id, 0)));
        }
        scalar
    }

    /// Kernels of a revolute joint.
    fn angles(
        &self,
        nodes: &Nodes<'_>,
        seen: &Loop,
        equations: Vec<(Equation<Id>, usize)>,
        to: &mut Vec<Candidate>,
    ) {
        let element = &self.elements[seen.joint];
        let mut all = Vec::new();
        for (equation, cost) in equations {
            if let Some(sampled) = self.sampled(nodes, element, equation, cost) {
                all.push(sampled);
            }
        }
        for one in &all {
            let order = match one.equation {
                Equation::Height { .. } => 0,
                Equation::Angle { .. } => 1,
                Equation::Distance { .. } => 2,
            };
            let length = |row: &[f64; 2]| row[0].hypot(row[1]);
            let rows = || one.rows.iter().skip(1);
            let slopes = || one.slopes.iter().skip(1);
            let double = rows().zip(slopes()).all(|(row, slope)| slope.abs() <= 1e-5 * length(row));
            let (kernel, quality) = if double {
                (Kernel::Double(one.equation), middle(rows().map(length)))
            } else {
                (Kernel::Twofold(one.equation), middle(slopes().map(|slope| slope.abs())))
            };
            self.add(seen, kernel, quality, if double { 5 } else { order }, one.cost, to);
        }
        for (i, one) in all.iter().enumerate() {
            for two in &all[i + 1..] {
                let sines = one.rows.iter().zip(&two.rows).skip(1).map(|(a, b)| {
                    let lengths = a[0].hypot(a[1]) * b[0].hypot(b[1]);
                    (a[0] * b[1] - a[1] * b[0]).abs() / lengths.max(f64::MIN_POSITIVE)
                });
                let length =
                    |rows: &[[f64; 2]]| middle(rows.iter().skip(1).map(|row| row[0].hypot(row[1])));
                let quality = middle(sines) * length(&one.rows).min(length(&two.rows)).min(1.0);
                let kernel = Kernel::Pair([one.equation, two.equation]);
                self.add(seen, kernel, quality, 3, one.cost + two.cost, to);
            }
        }
    }

    /// The rows at the samples; `None` where there is no equation.
    fn sampled(
        &self,
        nodes: &Nodes<'_>,
        element: &Element,
        equation: Equation<Id>,
        cost: usize,
    ) -> Option<Sampled> {
        let (mut rows, mut slopes) = (Vec::new(), Vec::new());
        for (s, sample) in self.samples.iter().enumerate() {
            let (row, _) = equation.row::<f64>(element, |id| nodes.value(id, s));
            let scale = self.scale(nodes, &equation, s);
            let (sin, cos) = sample.values[element.slot].sin_cos();
            let off = row.cosine * cos + row.sine * sin - row.constant;
            let holds = off.abs() <= HOLDS * scale;
            if !holds {
                return None;
            }
            rows.push([row.cosine / scale, row.sine / scale]);
            slopes.push((row.sine * cos - row.cosine * sin) / scale);
        }
        let length = middle(rows.iter().skip(1).map(|row| row[0].hypot(row[1])));
        (length > NONE).then_some(Sampled { equation, cost, rows, slopes })
    }

    /// What an equation is compared with: the distance of two points counts, as rows of far ones are no better.
    fn scale(&self, nodes: &Nodes<'_>, equation: &Equation<Id>, sample: usize) -> f64 {
        match *equation {
            Equation::Distance { square, .. } => {
                let distance = square.of::<f64>(|id| nodes.value(id, sample)).sqrt();
                self.size * distance.max(1e-3 * self.size)
            }
            Equation::Height { normal, .. } => self.size * nodes.value(normal, sample).norm(),
            Equation::Angle { .. } => 1.0,
        }
    }

    /// Kernels of a slider or a helical joint.
    fn lengths(
        &self,
        nodes: &Nodes<'_>,
        seen: &Loop,
        equations: Vec<(Equation<Id>, usize)>,
        to: &mut Vec<Candidate>,
    ) {
        let element = &self.elements[seen.joint];
        let samples = self.samples.len();
        let moved = |s: usize| {
            let value = self.samples[s].values[element.slot];
            match element.kind {
                Kind::Helix(pitch) => value * pitch,
                Kind::Turn | Kind::Slide | Kind::Ball | Kind::Circle(_) => value,
            }
        };
        let mut distances: Vec<(Equation<Id>, usize, Vec<f64>)> = Vec::new();
        for (equation, cost) in equations {
            match equation {
                Equation::Height { normal, .. } => {
                    let level = |s: usize| {
                        let across: Vector3<f64> = nodes.value(normal, s).cross(&element.direction);
                        element.kind == Kind::Slide || across.norm() <= HOLDS
                    };
                    let rows: Vec<_> = (0..samples)
                        .map(|s| equation.linear::<f64>(element, |id| nodes.value(id, s)))
                        .collect();
                    let holds = rows.iter().enumerate().all(|(s, (rate, constant))| {
                        level(s) && (rate * moved(s) - constant).abs() <= HOLDS * self.size
                    });
                    if holds {
                        let quality = middle(rows.iter().skip(1).map(|(rate, _)| rate.abs()));
                        self.add(seen, Kernel::Linear(equation), quality, 1, cost, to);
                    }
                }
                Equation::Distance { .. } if element.kind == Kind::Slide => {
                    let rows: Vec<_> = (0..samples)
                        .map(|s| equation.quadratic::<f64>(element, |id| nodes.value(id, s)))
                        .collect();
                    let holds = rows.iter().enumerate().all(|(s, (half, constant, _))| {
                        let x = moved(s);
                        let off = x * (x + 2.0 * half) + constant;
                        off.abs() <= HOLDS * self.size * self.size
                    });
                    if holds {
                        let halves: Vec<f64> = rows.iter().map(|(half, ..)| *half).collect();
                        let slopes = (1..samples).map(|s| (moved(s) + halves[s]).abs() / self.size);
                        let quality = middle(slopes);
                        self.add(seen, Kernel::Quadratic(equation), quality, 4, cost, to);
                        distances.push((equation, cost, halves));
                    }
                }
                Equation::Distance { .. } | Equation::Angle { .. } => {}
            }
        }
        for (i, (one, cost, halves)) in distances.iter().enumerate() {
            for (two, more, others) in &distances[i + 1..] {
                let apart = halves.iter().zip(others).skip(1);
                let quality = middle(apart.map(|(a, b)| (a - b).abs() / self.size));
                let kernel = Kernel::Difference([*one, *two]);
                self.add(seen, kernel, quality, 2, cost + more, to);
            }
        }
    }
}
