//! An order as a flat list of operations on vectors, over any numbers.

use super::MOST_FREEDOMS;
use super::element::{Element, Kind, Moved, Vector, constant};
use super::equation::{Kernel, Roots};
use super::nodes::{Id, Link, Node, Nodes};
use super::objects::Leg;
use super::step::Candidate;
use crate::numbers::{Joint, Real, Rotation, Space};
use nalgebra::Vector3;

/// So many vectors are held at once, at most.
const REGISTERS: usize = 16;

/// Where a vector is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    Constant(u8),
    Register(u8),
}

/// An operation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    /// A vector moved by the target, or moved back.
    Target { back: bool, kind: Vector, of: Place, to: u8 },
    /// A vector moved by a joint, or moved back.
    Joint { joint: u8, back: bool, kind: Vector, of: Place, to: u8 },
    /// Where a line is nearest to another one.
    Meet { lines: [[Place; 2]; 2], to: u8 },
    /// The cross product.
    Cross { two: [Place; 2], to: u8 },
    /// A joint, by the sign of a choice.
    Solve { joint: u8, kernel: Kernel<Place>, choice: u8 },
}

/// Two ways to the same vector: what shows that the loop is closed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Check {
    Same(Vector, [Place; 2]),
    /// Two pairs of points have the same distance.
    Length([[Place; 2]; 2]),
}

/// How the rotations of balls are read off: by images of the first two base directions.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Balls {
    None,
    /// The images in the body before the ball of what is behind it.
    One {
        ball: usize,
        columns: [Place; 2],
    },
    /// The images before the first ball of what is behind the second; the second one's centre as it is behind the first one,
    /// and as it should be before it; the joints between them that rotate.
    Two {
        balls: [usize; 2],
        columns: [Place; 2],
        centre: Place,
        aim: Place,
        between: Vec<usize>,
    },
}

/// The operations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program {
    constants: Vec<Vector3<f64>>,
    operations: Vec<Operation>,
    checks: Vec<Check>,
    pub balls: Balls,
}

/// Room for the joints. It is a power of two: to stay within costs nothing.
const JOINTS: usize = 8;

/// What the operations give.
pub(super) struct Run<T: Real> {
    /// The displacement of each joint but balls.
    moved: [Moved<T>; JOINTS],
    /// That of each freedom.
    pub joints: [T::Joint; MOST_FREEDOMS],
    registers: [T::Space; REGISTERS],
}

impl<T: Real> Run<T> {
    /// Nothing yet.
    #[inline(always)]
    pub fn new() -> Self {
        let zero = T::constant(0.0);
        Self {
            moved: [Moved::home(); JOINTS],
            joints: [T::Joint::value(zero); MOST_FREEDOMS],
            registers: [T::Space::new(zero, zero, zero); REGISTERS],
        }
    }

    /// The displacement of a joint that is no ball.
    #[inline(always)]
    pub fn moved(&self, joint: usize) -> Moved<T> {
        self.moved[joint % JOINTS]
    }
}

#[inline(always)]
fn read<T: Real>(constants: &[Vector3<f64>], registers: &[T::Space], place: Place) -> T::Space {
    match place {
        Place::Constant(number) => constant::<T>(&constants[usize::from(number)]),
        Place::Register(number) => registers[usize::from(number) % REGISTERS],
    }
}

#[inline(always)]
fn image<T: Real>(rotation: T::Rotation, v: T::Space) -> T::Space {
    let [x, y, z] = rotation.rows().map(|[x, y, z]| T::Space::new(x, y, z).inner(v));
    T::Space::new(x, y, z)
}

impl Program {
    /// Computes all joints but balls.
    #[inline(always)]
    pub fn run<T: Real>(
        &self,
        leg: (&[Element], f64),
        (rotation, translation): (T::Rotation, T::Space),
        signs: [T::Sign; 2],
        roots: &mut impl Roots<T>,
        run: &mut Run<T>,
    ) {
        let (elements, size) = leg;
        let back_rotation = rotation.inverse();
        for operation in &self.operations {
            let Run { moved, joints, registers } = &mut *run;
            let at = |place| read::<T>(&self.constants, registers, place);
            let (made, to) = match operation {
                &Operation::Target { back, kind, of, to } => {
                    let v = at(of);
                    let made = match (back, kind) {
                        (false, Vector::Direction) => image::<T>(rotation, v),
                        (false, Vector::Point) => {
                            image::<T>(rotation, v).plus(T::constant(1.0), translation)
                        }
                        (true, Vector::Direction) => image::<T>(back_rotation, v),
                        (true, Vector::Point) => {
                            image::<T>(back_rotation, v.plus(T::constant(-1.0), translation))
                        }
                    };
                    (made, to)
                }
                &Operation::Joint { joint, back, kind, of, to } => {
                    let joint = usize::from(joint);
                    (elements[joint].carry(moved[joint % JOINTS], back, kind, at(of)), to)
                }
                &Operation::Meet { lines: [[a, u], [b, v]], to } => {
                    let [a, u, b, v] = [a, u, b, v].map(at);
                    let normal = u.crossed(v);
                    let apart = b.plus(T::constant(-1.0), a);
                    let along = apart.crossed(v).inner(normal).over(normal.inner(normal));
                    (a.plus(along, u), to)
                }
                &Operation::Cross { two: [a, b], to } => (at(a).crossed(at(b)), to),
                Operation::Solve { joint, kernel, choice } => {
                    let joint = usize::from(*joint);
                    let (element, sign) = (&elements[joint], signs[usize::from(*choice) % 2]);
                    let (by, displacement) = kernel.solve(element, size, sign, at, roots);
                    moved[joint % JOINTS] = by;
                    joints[element.slot] = displacement;
                    continue;
                }
            };
            registers[usize::from(to) % REGISTERS] = made;
        }
    }

    /// The square of how far the loop is from closed; lengths relative to the size.
    #[inline(always)]
    pub fn open<T: Real>(&self, run: &Run<T>, size: f64) -> T {
        let per = 1.0 / size;
        let minus = T::constant(-1.0);
        let square = |v: T::Space| v.inner(v);
        let mut all = T::constant(0.0);
        for check in &self.checks {
            let off = match check {
                Check::Same(kind, [a, b]) => {
                    let off = square(self.at::<T>(run, *a).plus(minus, self.at::<T>(run, *b)));
                    match kind {
                        Vector::Point => off * (per * per),
                        Vector::Direction => off,
                    }
                }
                Check::Length(two) => {
                    let [a, b] = two.map(|[a, b]| {
                        square(self.at::<T>(run, a).plus(minus, self.at::<T>(run, b)))
                    });
                    ((a - b) * (per * per)).square()
                }
            };
            all = all + off;
        }
        all
    }

    /// A vector.
    #[inline(always)]
    pub fn at<T: Real>(&self, run: &Run<T>, place: Place) -> T::Space {
        read::<T>(&self.constants, &run.registers, place)
    }
}

/// Writes a program.
struct Writer<'n, 'l, 'a> {
    nodes: &'n mut Nodes<'a>,
    leg: Leg<'l>,
    /// The nodes in the order in which they are computed, and the joints between them.
    order: Vec<Written>,
    done: Vec<bool>,
}

enum Written {
    Node(Id),
    Joint(usize),
}

impl Writer<'_, '_, '_> {
    fn done(&self, id: Id) -> bool {
        self.done.get(id).copied().unwrap_or(false) || self.nodes.known(id).is_some()
    }

    fn inputs(&self, id: Id) -> Vec<Id> {
        match self.nodes.all[id] {
            Node::Constant(_) => Vec::new(),
            Node::Carried { of, .. } => vec![of],
            Node::Meet([[a, u], [b, v]]) => vec![a, u, b, v],
            Node::Cross(two) => two.to_vec(),
        }
    }

    fn need(&mut self, id: Id) {
        if self.done(id) {
            return;
        }
        for input in self.inputs(id) {
            self.need(input);
        }
        if self.done.len() <= id {
            self.done.resize(id + 1, false);
        }
        self.done[id] = true;
        self.order.push(Written::Node(id));
    }

    /// How many nodes are still to be computed.
    fn missing(&self, ids: [Id; 2]) -> usize {
        let mut open: Vec<Id> = ids.to_vec();
        let mut seen: Vec<Id> = Vec::new();
        while let Some(id) = open.pop() {
            if !self.done(id) && !seen.contains(&id) {
                seen.push(id);
                open.extend(self.inputs(id));
            }
        }
        seen.len()
    }

    /// A vector carried forwards along the loop over so many links, or backwards.
    fn carry(&mut self, kind: Vector, v: Id, body: usize, links: usize, forwards: bool) -> Id {
        let bodies = self.leg.elements.len() + 1;
        let mut all = v;
        for i in 0..links {
            let link = (if forwards { body + i } else { body + 2 * bodies - 1 - i }) % bodies;
            let link = if link + 1 == bodies { Link::Target } else { Link::Joint(link) };
            all = self.nodes.carried(link, forwards != (link == Link::Target), kind, all);
        }
        all
    }

    /// The cheapest two ways from a body, forwards and backwards, to what a vector is at the same body.
    fn ways(&mut self, kind: Vector, v: Vector3<f64>, body: usize) -> ([Id; 2], usize) {
        let bodies = self.leg.elements.len() + 1;
        let v = self.nodes.constant(v);
        let mut best = ([v; 2], usize::MAX);
        for links in 0..=bodies {
            let two = [
                self.carry(kind, v, body, links, true),
                self.carry(kind, v, body, bodies - links, false),
            ];
            let missing = self.missing(two);
            if missing < best.1 {
                best = (two, missing);
            }
        }
        best
    }

    /// Two ways to a point and to two directions, for as few operations as possible.
    fn same(&mut self) -> Vec<(Vector, [Id; 2])> {
        let elements = self.leg.elements;
        let mut found = Vec::new();
        let mut best: Option<([Id; 2], usize)> = None;
        let mut points = vec![(0, self.leg.centre)];
        for (joint, element) in elements.iter().enumerate() {
            if element.kind != Kind::Slide {
                points.push((joint, element.point));
                points.push((joint, self.leg.foot(joint)));
            }
        }
        for (body, point) in points {
            let (two, missing) = self.ways(Vector::Point, point, body);
            if best.is_none_or(|(_, least)| missing < least) {
                best = Some((two, missing));
            }
        }
        if let Some((two, _)) = best {
            two.into_iter().for_each(|id| self.need(id));
            found.push((Vector::Point, two));
        }
        let mut directions: Vec<(usize, Vector3<f64>, Option<usize>)> =
            (0..3).map(|i| (0, Vector3::ith(i, 1.0), None)).collect();
        for (joint, element) in elements.iter().enumerate() {
            directions.push((joint, element.direction, Some(joint)));
        }
        let samples = self.leg.samples;
        let place = |one: &(usize, Vector3<f64>, Option<usize>), sample: usize| match one.2 {
            Some(joint) => samples[sample].axes[joint].1,
            None => one.1,
        };
        let mut taken: Vec<(usize, Vector3<f64>, Option<usize>)> = Vec::new();
        for _ in 0..2 {
            let mut best = None;
            for one in &directions {
                let apart = taken.iter().all(|other| {
                    (0..samples.len()).all(|s| place(one, s).cross(&place(other, s)).norm() > 0.1)
                });
                if !apart {
                    continue;
                }
                let (two, missing) = self.ways(Vector::Direction, one.1, one.0);
                if best.is_none_or(|(_, _, least)| missing < least) {
                    best = Some((*one, two, missing));
                }
            }
            // There always is one of the base directions.
            if let Some((one, two, _)) = best {
                two.into_iter().for_each(|id| self.need(id));
                found.push((Vector::Direction, two));
                taken.push(one);
            }
        }
        found
    }
}

/// The program of an order, or `None` where it needs more vectors than are held.
pub(super) fn write(leg: Leg<'_>, nodes: &mut Nodes<'_>, steps: &[Candidate]) -> Option<Program> {
    let mut writer = Writer { nodes, leg, order: Vec::new(), done: Vec::new() };
    for step in steps {
        let mut inputs = Vec::new();
        step.kernel.map(&mut |id| inputs.push(id));
        for id in inputs {
            writer.need(id);
        }
        writer.order.push(Written::Joint(step.joint));
    }
    let elements = leg.elements;
    let bodies = elements.len() + 1;
    let balls: Vec<usize> =
        (0..elements.len()).filter(|&joint| elements[joint].kind == Kind::Ball).collect();
    let basis = [Vector3::x(), Vector3::y()].map(|v| writer.nodes.constant(v));
    let mut checks = Vec::new();
    let mut kept: Vec<Id> = Vec::new();
    let balls_of_ids = match balls[..] {
        [ball] => {
            let columns =
                basis.map(|v| writer.carry(Vector::Direction, v, ball + 1, bodies - 1, true));
            columns.into_iter().for_each(|id| writer.need(id));
            let mut best = None;
            let centre = writer.nodes.constant(elements[ball].point);
            for links in 0..bodies {
                let two = [
                    writer.carry(Vector::Point, centre, ball + 1, links, true),
                    writer.carry(Vector::Point, centre, ball, bodies - 1 - links, false),
                ];
                let missing = writer.missing(two);
                if best.is_none_or(|(_, least)| missing < least) {
                    best = Some((two, missing));
                }
            }
            if let Some((two, _)) = best {
                two.into_iter().for_each(|id| writer.need(id));
                kept.extend(two);
                checks.push(Checked::Same(Vector::Point, two));
            }
            kept.extend(columns);
            Found::One(ball, columns)
        }
        [one, two] => {
            let first = writer.nodes.constant(elements[one].point);
            let centre = writer.nodes.constant(elements[two].point);
            let behind = writer.carry(Vector::Point, centre, two, two - one - 1, false);
            let around = bodies - 1 - two + one;
            let aim = writer.carry(Vector::Point, centre, two + 1, around, true);
            let columns = basis.map(|v| writer.carry(Vector::Direction, v, two + 1, around, true));
            for id in [behind, aim].into_iter().chain(columns) {
                writer.need(id);
                kept.push(id);
            }
            checks.push(Checked::Length([[behind, first], [aim, first]]));
            Found::Two([one, two], columns, behind, aim)
        }
        _ => {
            for (kind, two) in writer.same() {
                kept.extend(two);
                checks.push(Checked::Same(kind, two));
            }
            Found::None
        }
    };
    let order = writer.order;
    Assembly::new(leg, nodes, steps, &order, &kept)?.program(nodes, &checks, balls_of_ids)
}

enum Checked {
    Same(Vector, [Id; 2]),
    Length([[Id; 2]; 2]),
}

#[derive(Clone, Copy)]
enum Found {
    None,
    One(usize, [Id; 2]),
    Two([usize; 2], [Id; 2], Id, Id),
}

/// Nodes as places.
struct Assembly<'l> {
    leg: Leg<'l>,
    places: Vec<Option<Place>>,
    constants: Vec<Vector3<f64>>,
    operations: Vec<Operation>,
}

impl<'l> Assembly<'l> {
    fn place(&mut self, nodes: &Nodes<'_>, id: Id) -> Place {
        if let Some(place) = self.places[id] {
            return place;
        }
        let place = match nodes.known(id) {
            Some(vector) => {
                self.constants.push(vector);
                Place::Constant(u8::try_from(self.constants.len() - 1).unwrap_or(u8::MAX))
            }
            // It is computed before it is used.
            None => Place::Register(u8::MAX),
        };
        self.places[id] = Some(place);
        place
    }

    fn new(
        leg: Leg<'l>,
        nodes: &Nodes<'_>,
        steps: &[Candidate],
        order: &[Written],
        kept: &[Id],
    ) -> Option<Self> {
        let kernel = |joint: usize| steps.iter().find(|step| step.joint == joint);
        let inputs = |written: &Written| -> Vec<Id> {
            match *written {
                Written::Node(id) => match nodes.all[id] {
                    Node::Constant(_) => Vec::new(),
                    Node::Carried { of, .. } => vec![of],
                    Node::Meet([[a, u], [b, v]]) => vec![a, u, b, v],
                    Node::Cross(two) => two.to_vec(),
                },
                Written::Joint(joint) => {
                    let mut all = Vec::new();
                    if let Some(step) = kernel(joint) {
                        step.kernel.map(&mut |id| all.push(id));
                    }
                    all
                }
            }
        };
        // Until when each vector is held.
        let mut last = vec![0; nodes.all.len()];
        for (time, written) in order.iter().enumerate() {
            for id in inputs(written) {
                last[id] = time;
            }
        }
        for &id in kept {
            last[id] = usize::MAX;
        }
        let mut choosing: Vec<usize> =
            steps.iter().filter(|step| step.kernel.chooses()).map(|step| step.joint).collect();
        choosing.sort_unstable();
        let mut all = Self {
            leg,
            places: vec![None; nodes.all.len()],
            constants: Vec::new(),
            operations: Vec::new(),
        };
        let mut holders: [Option<Id>; REGISTERS] = [None; REGISTERS];
        for (time, written) in order.iter().enumerate() {
            match *written {
                Written::Node(id) => {
                    let node = nodes.all[id];
                    let at = |all: &mut Self, id| all.place(nodes, id);
                    for holder in &mut holders {
                        if holder.is_some_and(|held| last[held] <= time) {
                            *holder = None;
                        }
                    }
                    let free = holders.iter().position(Option::is_none)?;
                    let to = u8::try_from(free).ok()?;
                    let operation = match node {
                        Node::Constant(_) => continue,
                        Node::Carried { by, back, kind, of } => {
                            let of = at(&mut all, of);
                            match by {
                                Link::Target => Operation::Target { back, kind, of, to },
                                Link::Joint(joint) => {
                                    let joint = u8::try_from(joint).ok()?;
                                    Operation::Joint { joint, back, kind, of, to }
                                }
                            }
                        }
                        Node::Meet(lines) => {
                            let lines = lines.map(|line| line.map(|id| at(&mut all, id)));
                            Operation::Meet { lines, to }
                        }
                        Node::Cross(two) => {
                            Operation::Cross { two: two.map(|id| at(&mut all, id)), to }
                        }
                    };
                    holders[free] = Some(id);
                    all.places[id] = Some(Place::Register(to));
                    all.operations.push(operation);
                }
                Written::Joint(joint) => {
                    let step = kernel(joint)?;
                    let kernel = step.kernel.map(&mut |id| all.place(nodes, id));
                    let choice = choosing.iter().position(|&one| one == joint).unwrap_or(0);
                    let (joint, choice) = (u8::try_from(joint).ok()?, u8::try_from(choice).ok()?);
                    all.operations.push(Operation::Solve { joint, kernel, choice });
                }
            }
        }
        Some(all)
    }

    fn program(mut self, nodes: &Nodes<'_>, checks: &[Checked], found: Found) -> Option<Program> {
        let checks = checks
            .iter()
            .map(|check| match *check {
                Checked::Same(kind, two) => Check::Same(kind, two.map(|id| self.place(nodes, id))),
                Checked::Length(two) => {
                    Check::Length(two.map(|pair| pair.map(|id| self.place(nodes, id))))
                }
            })
            .collect();
        let balls = match found {
            Found::None => Balls::None,
            Found::One(ball, columns) => {
                Balls::One { ball, columns: columns.map(|id| self.place(nodes, id)) }
            }
            Found::Two(balls, columns, centre, aim) => {
                let turns = |joint: &usize| match self.leg.elements[*joint].kind {
                    Kind::Turn | Kind::Helix(_) => true,
                    Kind::Slide | Kind::Ball => false,
                };
                let between = (balls[0] + 1..balls[1]).filter(turns).collect();
                let columns = columns.map(|id| self.place(nodes, id));
                let [centre, aim] = [centre, aim].map(|id| self.place(nodes, id));
                Balls::Two { balls, columns, centre, aim, between }
            }
        };
        let fits = self.constants.len() <= usize::from(u8::MAX);
        let Self { constants, operations, .. } = self;
        fits.then_some(Program { constants, operations, checks, balls })
    }
}
