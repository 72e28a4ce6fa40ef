//! An order written as a program, and the ways that close the loop.

use super::element::{Kind, Vector};
use super::equation::Kernel;
use super::nodes::{Id, Link, Node, Nodes};
use super::objects::Leg;
use super::program::{Balls, Check, Operation, Place, Program, REGISTERS};
use super::step::Candidate;
use nalgebra::Vector3;

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

    fn inputs(&self, id: Id) -> impl Iterator<Item = Id> + use<> {
        let (ids, count) = match self.nodes.all[id] {
            Node::Constant(_) => ([id; 4], 0),
            Node::Carried { of, .. } => ([of; 4], 1),
            Node::Meet([[a, u], [b, v]]) => ([a, u, b, v], 4),
            Node::Cross([a, b]) => ([a, b, a, b], 2),
        };
        ids.into_iter().take(count)
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

    /// A vector carried forwards along the loop, or backwards: over no link, over one, up to so many.
    fn carry(&mut self, kind: Vector, v: Id, body: usize, links: usize, forwards: bool) -> Vec<Id> {
        let bodies = self.leg.elements.len() + 1;
        let mut all = vec![v];
        for i in 0..links {
            let link = (if forwards { body + i } else { body + 2 * bodies - 1 - i }) % bodies;
            let link = if link + 1 == bodies { Link::Target } else { Link::Joint(link) };
            all.push(self.nodes.carried(link, forwards != (link == Link::Target), kind, all[i]));
        }
        all
    }

    /// The cheapest two of the ways that meet: forwards over some links, and backwards over the others.
    fn cheapest(&self, forwards: &[Id], backwards: &[Id]) -> [Id; 2] {
        let pairs = forwards.iter().zip(backwards.iter().rev()).map(|(&one, &other)| [one, other]);
        // There is one over no link.
        pairs.min_by_key(|&two| self.missing(two)).unwrap_or([forwards[0]; 2])
    }

    /// The cheapest two ways from a body, forwards and backwards, to what a vector is at the same body.
    fn ways(&mut self, kind: Vector, v: Vector3<f64>, body: usize) -> [Id; 2] {
        let bodies = self.leg.elements.len() + 1;
        let v = self.nodes.constant(v);
        let forwards = self.carry(kind, v, body, bodies, true);
        let backwards = self.carry(kind, v, body, bodies, false);
        self.cheapest(&forwards, &backwards)
    }

    /// What a direct kernel takes one vector to: it moves a vector, of which it uses a part, to another one.
    fn used(&mut self, step: &Candidate, kind: Vector) -> Option<[Id; 2]> {
        let (moved, fixed) = match (kind, step.kernel) {
            (Vector::Point, Kernel::Point { moved, fixed })
            | (Vector::Direction, Kernel::Direction { moved, fixed }) => (moved, fixed),
            (
                Vector::Point | Vector::Direction,
                Kernel::Linear(_)
                | Kernel::Difference(_)
                | Kernel::Quadratic(_)
                | Kernel::Point { .. }
                | Kernel::Line { .. }
                | Kernel::Direction { .. }
                | Kernel::Pair(_)
                | Kernel::Double(_)
                | Kernel::Twofold(_),
            ) => return None,
        };
        Some([self.nodes.carried(Link::Joint(step.joint), false, kind, moved), fixed])
    }

    /// Two ways to a point and to two directions, for as few operations as possible.
    fn same(&mut self, steps: &[Candidate]) -> Vec<(Vector, [Id; 2])> {
        let Leg { elements, samples, centre, .. } = self.leg;
        let mut found = Vec::new();
        let mut ways: Vec<[Id; 2]> =
            steps.iter().filter_map(|step| self.used(step, Vector::Point)).collect();
        ways.push(self.ways(Vector::Point, centre, 0));
        for (joint, element) in elements.iter().enumerate() {
            if element.has_place() {
                ways.push(self.ways(Vector::Point, element.point, joint));
                ways.push(self.ways(Vector::Point, self.leg.foot(joint), joint));
            }
        }
        if let Some(two) = ways.into_iter().min_by_key(|&two| self.missing(two)) {
            two.into_iter().for_each(|id| self.need(id));
            found.push((Vector::Point, two));
        }
        // With the direction in base coordinates at each sample.
        let mut ways: Vec<([Id; 2], Vec<Vector3<f64>>)> = Vec::new();
        for step in steps {
            if let Some(two) = self.used(step, Vector::Direction) {
                let seen = samples.iter().enumerate().map(|(i, sample)| {
                    let inner = &sample.joints[..step.joint];
                    let value = self.nodes.value(two[1], i);
                    inner.iter().rev().fold(value, |v, joint| joint.rotation * v)
                });
                ways.push((two, seen.collect()));
            }
        }
        for (joint, element) in elements.iter().enumerate() {
            let two = self.ways(Vector::Direction, element.direction, joint);
            ways.push((two, samples.iter().map(|sample| sample.axes[joint].1).collect()));
        }
        for i in 0..3 {
            let two = self.ways(Vector::Direction, Vector3::ith(i, 1.0), 0);
            ways.push((two, vec![Vector3::ith(i, 1.0); samples.len()]));
        }
        let mut taken: Option<Vec<Vector3<f64>>> = None;
        for _ in 0..2 {
            let apart = |one: &[Vector3<f64>]| {
                let mut pairs = one.iter().zip(taken.iter().flatten());
                pairs.all(|(a, b)| a.cross(b).norm() > 0.1)
            };
            let open = ways.iter().filter(|(_, seen)| apart(seen));
            // There always is one of the base directions.
            if let Some((two, seen)) = open.min_by_key(|&&(two, _)| self.missing(two)) {
                let two = *two;
                taken = Some(seen.clone());
                two.into_iter().for_each(|id| self.need(id));
                found.push((Vector::Direction, two));
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
    let mut checks = Vec::new();
    let mut kept: Vec<Id> = Vec::new();
    let balls_of_ids = match balls[..] {
        [ball] => {
            let centre = writer.nodes.constant(elements[ball].point);
            let forwards = writer.carry(Vector::Point, centre, ball + 1, bodies - 1, true);
            let backwards = writer.carry(Vector::Point, centre, ball, bodies - 1, false);
            let two = writer.cheapest(&forwards, &backwards);
            two.into_iter().for_each(|id| writer.need(id));
            kept.extend(two);
            checks.push(Checked::Same(Vector::Point, two));
            Found::One(ball)
        }
        [one, two] => {
            let first = writer.nodes.constant(elements[one].point);
            let centre = writer.nodes.constant(elements[two].point);
            let (between, around) = (two - one - 1, bodies - 1 - two + one);
            let behind = writer.carry(Vector::Point, centre, two, between, false)[between];
            let aim = writer.carry(Vector::Point, centre, two + 1, around, true)[around];
            for id in [behind, aim] {
                writer.need(id);
                kept.push(id);
            }
            checks.push(Checked::Length([[behind, first], [aim, first]]));
            Found::Two([one, two], behind, aim)
        }
        _ => {
            for (kind, two) in writer.same(steps) {
                kept.extend(two);
                checks.push(Checked::Same(kind, two));
            }
            Found::None
        }
    };
    let order = writer.order;
    Assembly::new(nodes, steps, &order, &kept)?.program(nodes, &checks, balls_of_ids)
}

enum Checked {
    Same(Vector, [Id; 2]),
    Length([[Id; 2]; 2]),
}

#[derive(Clone, Copy)]
enum Found {
    None,
    One(usize),
    Two([usize; 2], Id, Id),
}

/// Nodes as places.
struct Assembly {
    places: Vec<Option<Place>>,
    constants: Vec<Vector3<f64>>,
    operations: Vec<Operation>,
}

impl Assembly {
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

    fn new(nodes: &Nodes<'_>, steps: &[Candidate], order: &[Written], kept: &[Id]) -> Option<Self> {
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
            Found::One(ball) => Balls::One(ball),
            Found::Two(balls, centre, aim) => {
                let [centre, aim] = [centre, aim].map(|id| self.place(nodes, id));
                Balls::Two { balls, centre, aim }
            }
        };
        let fits = self.constants.len() <= usize::from(u8::MAX);
        let Self { constants, operations, .. } = self;
        fits.then_some(Program { constants, operations, checks, balls })
    }
}
