//! The distances of all pairs at one configuration.

use crate::Interference;
use crate::distance::Capsule;
use crate::member::{Shape, scaled};
use nalgebra::Isometry3;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::joint::ValueCountError;
use opm_core::skeleton::Configuration;
use parry3d_f64::math::Vector;
use std::borrow::Cow;

/// A pair and its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The number of the pair: see [`Interference::names_of`].
    pub pair: usize,
    /// Its signed distance, metres; negative where the two overlap.
    pub distance: f64,
}

/// Measures the pairs of a mechanism at one configuration after the other, with working memory of its own.
#[derive(Clone, Debug)]
pub struct Distances<'a> {
    interference: Cow<'a, Interference>,
    bodies: Vec<Isometry3<f64>>,
    /// The ends of every capsule; unused for other shapes.
    ends: Vec<[Vector; 2]>,
}

impl Distances<'static> {
    /// The same as [`Distances::new`], for pairs that nothing else keeps.
    pub fn owned(interference: Interference) -> Self {
        Self::of_either(Cow::Owned(interference))
    }
}

impl<'a> Distances<'a> {
    /// Working memory for the pairs of a mechanism. The distances are those at home until a configuration is placed.
    pub fn new(interference: &'a Interference) -> Self {
        Self::of_either(Cow::Borrowed(interference))
    }

    fn of_either(interference: Cow<'a, Interference>) -> Self {
        let bodies = interference.skeleton.bodies().iter();
        let bodies = bodies.map(|body| Isometry3::from(body.origin)).collect();
        let ends = vec![[Vector::ZERO; 2]; interference.shapes.len()];
        let mut new = Self { interference, bodies, ends };
        new.take_ends();
        new
    }

    /// The mechanism whose pairs are measured.
    pub fn interference(&self) -> &Interference {
        &self.interference
    }

    /// Places the bodies as in a solution of the mechanism's inverse kinematics.
    ///
    /// # Panics
    /// If it is a solution of another mechanism.
    pub fn place(&mut self, manipulator: &Manipulator, solution: &Solution) {
        let platform = solution.displacement(manipulator);
        let joints = solution.joints();
        let configuration = Configuration { joints, imaginary: &[], platform };
        self.place_in(&configuration).expect("a solution of this mechanism");
    }

    /// Places the bodies in a configuration. Its imaginary joints have to be left out.
    ///
    /// # Errors
    /// The configuration does not have as many coordinates as the mechanism.
    pub fn place_in(&mut self, configuration: &Configuration<'_>) -> Result<(), ValueCountError> {
        // The parent of every body is the base, which is at rest.
        self.interference.skeleton.place(configuration, &mut self.bodies)?;
        self.take_ends();
        Ok(())
    }

    fn take_ends(&mut self) {
        let Self { interference, bodies, ends } = self;
        for (shape, to) in interference.shapes.iter().zip(ends) {
            if let Shape::Capsule { ends, .. } = shape {
                *to = ends
                    .map(|end| scaled(&(bodies[end.body] * end.point).coords, interference.unit));
            }
        }
    }

    /// The signed distance of a pair, metres.
    ///
    /// # Panics
    /// There is no pair of this number.
    pub fn of(&self, pair: usize) -> f64 {
        self.interference.distance(&self.ends, pair)
    }

    /// The nearest pair; the first one of several. `None` without pairs.
    pub fn nearest(&self) -> Option<Nearest> {
        let mut nearest: Option<(usize, f64)> = None;
        for pair in 0..self.interference.pairs.len() {
            let below = nearest.map_or(f64::INFINITY, |(_, distance)| distance);
            let distance = self.interference.distance_below(&self.ends, pair, below);
            if distance < below {
                nearest = Some((pair, distance));
            }
        }
        let unit = self.interference.unit;
        nearest.map(|(pair, distance)| Nearest { pair, distance: distance * unit })
    }

    /// The pairs that are nearer than a distance, metres: those that overlap, for zero.
    pub fn nearer_than(&self, distance: f64) -> impl Iterator<Item = Nearest> + '_ {
        let unit = self.interference.unit;
        (0..self.interference.pairs.len()).filter_map(move |pair| {
            let found = self.interference.distance_below(&self.ends, pair, distance / unit) * unit;
            (found < distance).then_some(Nearest { pair, distance: found })
        })
    }

    /// Whether two shapes of a pair are at least this far apart, in units of the mechanism's size.
    pub(crate) fn are_apart(&self, shapes: [usize; 2], least: f64) -> bool {
        self.interference.between(&self.ends, shapes, least) >= least
    }

    /// The ends of every capsule, in units of the mechanism's size; unused for other shapes.
    pub(crate) fn ends(&self) -> &[[Vector; 2]] {
        &self.ends
    }
}

impl Interference {
    /// The signed distance of a pair, metres, where the ends of every capsule are given.
    pub(crate) fn distance(&self, ends: &[[Vector; 2]], pair: usize) -> f64 {
        self.distance_below(ends, pair, f64::INFINITY) * self.unit
    }

    /// The distance of a pair, in units of the mechanism's size, if it is below `most`; else some number that is not.
    fn distance_below(&self, ends: &[[Vector; 2]], pair: usize, most: f64) -> f64 {
        let shapes = self.pairs[pair].shapes.iter();
        shapes.fold(f64::INFINITY, |least, &pair| {
            least.min(self.between(ends, pair, least.min(most)))
        })
    }

    /// The same for two shapes, of which the first one is a capsule.
    fn between(&self, ends: &[[Vector; 2]], [one, other]: [usize; 2], most: f64) -> f64 {
        let shapes = &self.shapes;
        let capsule = |number: usize| match &shapes[number] {
            Shape::Capsule { radius, .. } => Some(Capsule { ends: ends[number], radius: *radius }),
            Shape::Box { .. } | Shape::HalfSpace { .. } => None,
        };
        let Some(one) = capsule(one) else { return f64::INFINITY };
        match (&shapes[other], capsule(other)) {
            (_, Some(other)) => {
                let at_least = one.at_least_to(&other);
                if at_least >= most { at_least } else { one.distance_to_capsule(&other) }
            }
            (Shape::Box { pose, half }, _) => one.distance_to_box(pose, *half),
            (Shape::HalfSpace { normal, offset }, _) => {
                one.distance_to_half_space(*normal, *offset)
            }
            (Shape::Capsule { .. }, None) => f64::INFINITY,
        }
    }
}
