//! Vectors that the steps of an order need: constants, what joints and the platform make of them, and where lines meet.

use super::element::{Element, Kind, Vector};
use super::samples::Sample;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// The number of a node.
pub(super) type Id = usize;

/// A link of the closed loop: a joint, or the target, which leads from the platform back to the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Link {
    Joint(usize),
    Target,
}

/// How a vector is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Node {
    /// A constant: its number among them.
    Constant(usize),
    /// A vector moved by a link, or moved back.
    Carried { by: Link, back: bool, kind: Vector, of: Id },
    /// Where the first of two lines, each a point and a direction, is nearest to the second.
    Meet([[Id; 2]; 2]),
    /// The cross product.
    Cross([Id; 2]),
}

/// All vectors, with their values at the samples.
pub(super) struct Nodes<'a> {
    elements: &'a [Element],
    samples: &'a [Sample],
    /// Relative to which a length is zero.
    tiny: f64,
    pub constants: Vec<Vector3<f64>>,
    pub all: Vec<Node>,
    /// At each sample, node after node.
    values: Vec<Vector3<f64>>,
    costs: Vec<usize>,
    found: BTreeMap<Node, Id>,
}

impl<'a> Nodes<'a> {
    pub fn new(elements: &'a [Element], samples: &'a [Sample], size: f64) -> Self {
        Self {
            elements,
            samples,
            tiny: 1e-9 * size,
            constants: Vec::new(),
            all: Vec::new(),
            values: Vec::new(),
            costs: Vec::new(),
            found: BTreeMap::new(),
        }
    }

    /// The value at a sample.
    pub fn value(&self, node: Id, sample: usize) -> Vector3<f64> {
        self.values[node * self.samples.len() + sample]
    }

    /// How many operations it takes, each counted as often as it is used.
    pub fn cost(&self, node: Id) -> usize {
        self.costs[node]
    }

    /// The constant that a node is.
    pub fn known(&self, node: Id) -> Option<Vector3<f64>> {
        match self.all[node] {
            Node::Constant(number) => Some(self.constants[number]),
            Node::Carried { .. } | Node::Meet(_) | Node::Cross(_) => None,
        }
    }

    fn add(&mut self, node: Node, cost: usize, value: impl Fn(&Self, usize) -> Vector3<f64>) -> Id {
        if let Some(&id) = self.found.get(&node) {
            return id;
        }
        for sample in 0..self.samples.len() {
            let value = value(self, sample);
            self.values.push(value);
        }
        let id = self.all.len();
        self.all.push(node);
        self.costs.push(cost);
        self.found.insert(node, id);
        id
    }

    /// A constant.
    pub fn constant(&mut self, vector: Vector3<f64>) -> Id {
        let found = self.constants.iter().position(|one| *one == vector);
        let number = found.unwrap_or_else(|| {
            self.constants.push(vector);
            self.constants.len() - 1
        });
        self.add(Node::Constant(number), 0, |_, _| vector)
    }

    /// Whether a joint leaves a constant alone.
    pub fn leaves(&self, joint: usize, kind: Vector, vector: &Vector3<f64>) -> bool {
        let element = &self.elements[joint];
        match (element.kind, kind) {
            (Kind::Turn, Vector::Point) => {
                (vector - element.point).cross(&element.direction).norm() <= self.tiny
            }
            (Kind::Turn | Kind::Helix(_), Vector::Direction) => {
                vector.cross(&element.direction).norm() <= 1e-9
            }
            (Kind::Slide | Kind::Circle(_), Vector::Direction) => true,
            (Kind::Ball, Vector::Point) => (vector - element.point).norm() <= self.tiny,
            (Kind::Helix(_) | Kind::Slide | Kind::Circle(_), Vector::Point)
            | (Kind::Ball, Vector::Direction) => false,
        }
    }

    /// A vector moved by a link, or moved back.
    pub fn carried(&mut self, by: Link, back: bool, kind: Vector, of: Id) -> Id {
        if let Link::Joint(joint) = by {
            let known = self.known(of).is_some_and(|vector| self.leaves(joint, kind, &vector));
            if known || (!self.elements[joint].turns() && kind == Vector::Direction) {
                return of;
            }
        }
        if let Node::Carried { by: last, back: other, of: before, .. } = self.all[of]
            && last == by
            && other != back
        {
            return before;
        }
        let cost = 1 + self.costs[of];
        self.add(Node::Carried { by, back, kind, of }, cost, |nodes, sample| {
            let sampled = &nodes.samples[sample];
            let g = match by {
                Link::Joint(joint) => sampled.joints[joint],
                Link::Target => sampled.target,
            };
            let g = if back { g.inverse() } else { g };
            let vector = nodes.value(of, sample);
            match kind {
                Vector::Point => (g * Point3::from(vector)).coords,
                Vector::Direction => g.rotation * vector,
            }
        })
    }

    /// Where the first of two lines is nearest to the second.
    pub fn meet(&mut self, lines: [[Id; 2]; 2]) -> Id {
        let [[a, u], [b, v]] = lines;
        if let [Some(a), Some(u), Some(b), Some(v)] = [a, u, b, v].map(|id| self.known(id)) {
            return self.constant(meeting(&a, &u, &b, &v));
        }
        let cost = 2 + [a, u, b, v].iter().map(|&id| self.costs[id]).sum::<usize>();
        self.add(Node::Meet(lines), cost, |nodes, sample| {
            let [a, u, b, v] = [a, u, b, v].map(|id| nodes.value(id, sample));
            meeting(&a, &u, &b, &v)
        })
    }

    /// The cross product.
    pub fn cross(&mut self, two: [Id; 2]) -> Id {
        if let [Some(a), Some(b)] = two.map(|id| self.known(id)) {
            return self.constant(a.cross(&b));
        }
        let cost = 1 + two.iter().map(|&id| self.costs[id]).sum::<usize>();
        self.add(Node::Cross(two), cost, |nodes, sample| {
            let [a, b] = two.map(|id| nodes.value(id, sample));
            a.cross(&b)
        })
    }
}

/// The point of the first line that is nearest to the second one.
pub(super) fn meeting(
    a: &Vector3<f64>,
    u: &Vector3<f64>,
    b: &Vector3<f64>,
    v: &Vector3<f64>,
) -> Vector3<f64> {
    let normal = u.cross(v);
    let along = (b - a).cross(v).dot(&normal) / normal.norm_squared();
    a + u * along
}
