//! Interference: how far the links, the platform and what stands around a mechanism are from each other.
//!
//! A mechanism is given by its joint screws, so its bodies have no shapes. Here a link is a rod between its two joints, the
//! platform a rod from each of its joints to the reference point, and a guide a rod as long as its slider's travel: capsules,
//! as [`skeleton`](opm_core::skeleton) draws them, with the radii of the mechanism's
//! [`Shapes`](opm_core::mechanism::Shapes). Obstacles are boxes, capsules and half-spaces. [`member`] says which parts are
//! shapes, and [`neighbours`] which pairs are not tested because they meet by construction.
//!
//! * [`Interference`]: the shapes of a mechanism, and the pairs that are tested.
//! * [`Distances`]: the distance of each pair at one configuration, the nearest pair.
//! * [`Watch`]: contacts along a motion, between samples too.
//! * [`BoxTest`]: whether all distances are large enough at every pose of a box, decided by certain bounds.
//!
//! Distances are signed: negative where two shapes overlap. An overlap is measured as far as the axes of the capsules stay
//! apart from each other, or out of a box: there it is the sum of the radii.
//!
//! ```
//! use opm_core::Manipulator;
//! use opm_interference::{Distances, Interference};
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! let interference = Interference::new(manipulator.mechanism());
//! let mut distances = Distances::new(&interference);
//! let mut solution = manipulator.solution();
//! let pose = manipulator.pose([("x", 0.05)])?;
//! let solution = manipulator.inverse(&pose, manipulator.home_mode(), &mut solution)?.expect("in reach");
//! distances.place(&manipulator, solution);
//! let nearest = distances.nearest().expect("pairs to test");
//! let [one, other] = interference.names_of(nearest.pair);
//! assert!(one != other && nearest.distance.is_finite());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boxes;
mod distance;
mod distances;
mod gap;
pub mod member;
mod motion;
pub mod neighbours;

pub use boxes::{BoxTest, Clearance, Open};
pub use distances::{Distances, Nearest};
pub use motion::{Contact, Watch, Watched};

use member::{Member, Shape};
use neighbours::Meetings;
use opm_core::mechanism::Mechanism;
use opm_core::skeleton::{Configuration, Skeleton};

/// Shapes that are nearer than this at home, as a share of the mechanism's size, touch there.
const TOUCH: f64 = 1e-9;

/// The shapes of a mechanism and of its surroundings, and the pairs of them that are tested.
#[derive(Clone, Debug)]
pub struct Interference {
    skeleton: Skeleton,
    members: Vec<Member>,
    shapes: Vec<Shape>,
    pairs: Vec<Pair>,
    set_aside: Vec<SetAside>,
    /// The size of the mechanism, metres: the unit of lengths inside of this crate.
    unit: f64,
}

/// Two members that are tested against each other.
#[derive(Clone, Debug)]
struct Pair {
    members: [usize; 2],
    /// The shapes of each; the first of two is a capsule.
    shapes: Vec<[usize; 2]>,
}

/// A pair that is not tested, because its shapes overlap at home.
///
/// The mechanism is assembled at home, so the shapes, not the mechanism, are wrong there: a link is mounted on an obstacle,
/// say, or rods that pass each other in different layers are given in one plane.
#[derive(Clone, Debug, PartialEq)]
pub struct SetAside {
    /// The names of the two.
    pub names: [String; 2],
    /// By how much they overlap at home, metres.
    pub overlap: f64,
}

impl Interference {
    /// The shapes of a mechanism, and the pairs that are tested.
    pub fn new(mechanism: &Mechanism) -> Self {
        let skeleton = Skeleton::new(mechanism, None);
        let unit = skeleton.size();
        let (members, shapes) = member::collect(mechanism, &skeleton);
        let meetings = Meetings::new(mechanism, &skeleton);
        let mut pairs = Vec::new();
        for (second, other) in members.iter().enumerate() {
            for (first, one) in members[..second].iter().enumerate() {
                if (one.is_at_rest() && other.is_at_rest()) || meetings.meet(one, other) {
                    continue;
                }
                let all =
                    one.shapes.clone().flat_map(|i| other.shapes.clone().map(move |j| [i, j]));
                // What is not a capsule is at rest.
                let sorted = all.map(|[i, j]| if shapes[i].is_capsule() { [i, j] } else { [j, i] });
                let shapes: Vec<_> = sorted.collect();
                if !shapes.is_empty() {
                    pairs.push(Pair { members: [first, second], shapes });
                }
            }
        }
        let mut whole = Self { skeleton, members, shapes, pairs, set_aside: Vec::new(), unit };
        whole.set_aside(mechanism);
        whole
    }

    /// Sets those pairs aside that overlap at home.
    fn set_aside(&mut self, mechanism: &Mechanism) {
        let mut distances = Distances::new(self);
        let joints: Vec<f64> = mechanism.coordinates().map(|c| c.home).collect();
        let platform = nalgebra::Isometry3::identity();
        let home = Configuration { joints: &joints, imaginary: &[], platform };
        distances.place_in(&home).expect("the mechanism's own coordinates");
        let at_home: Vec<f64> = (0..self.pairs.len()).map(|pair| distances.of(pair)).collect();
        for (number, &distance) in at_home.iter().enumerate() {
            if distance <= TOUCH * self.unit {
                let names = self.names_of(number).map(str::to_owned);
                self.set_aside.push(SetAside { names, overlap: -distance });
            }
        }
        let mut of_pair = at_home.into_iter();
        let unit = self.unit;
        self.pairs.retain(|_| of_pair.next().is_some_and(|distance| distance > TOUCH * unit));
    }

    /// The number of pairs that are tested.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// The names of the two members of a pair.
    ///
    /// # Panics
    /// There is no pair of this number.
    pub fn names_of(&self, pair: usize) -> [&str; 2] {
        self.pairs[pair].members.map(|member| &*self.members[member].name)
    }

    /// The two members of a pair: see [`Interference::members`].
    ///
    /// # Panics
    /// There is no pair of this number.
    pub fn members_of(&self, pair: usize) -> [&Member; 2] {
        self.pairs[pair].members.map(|member| &self.members[member])
    }

    /// The links, the guides of sliders on the base, the platform and the obstacles, in this order.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// The pairs that are not tested because they overlap at home.
    pub fn set_aside_pairs(&self) -> &[SetAside] {
        &self.set_aside
    }
}
