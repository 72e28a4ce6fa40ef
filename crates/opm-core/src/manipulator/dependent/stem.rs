//! Dependent coordinates of a platform that moves as one leg, the stem, lets it.
//!
//! The stem and the coordinates make a loop: `E(q) = T(x y z) · R(angles)` about the platform's reference point. Where the stem
//! moves in a plane that is `T(x y) · R(theta)`, and where it only rotates about a centre, `R(angles)`. The independent coordinates are known joints of that loop, the dependent
//! ones and those of the stem are found as a whole leg's are: by [`WholeLeg::solve_given`].

use super::determining::{UNDETERMINED, determining};
use super::form::{StemForm, StemPart};
use crate::chain::whole::{LegJoint, MOST_FREEDOMS, NoOrder, WholeLeg};
use crate::chain::{Branch, ReachDeficit};
use crate::decomposition::whole::{configurations, end, joints};
use crate::group::{JointDisplacement, SubspaceKind};
use crate::manipulator::Mode;
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use crate::task::{Task, TaskCoordinate};
use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// The most coordinates.
const MOST: usize = 6;

/// How coordinates follow from the others.
#[derive(Clone, Debug)]
pub(crate) struct Stem {
    /// The number of the leg.
    pub leg: usize,
    closure: WholeLeg,
    /// The bits of its choices in a [`Mode`].
    pub bits: [Option<u32>; 4],
    /// Whether all angles are known: then they are part of the target.
    turned: bool,
    /// The rotations that are known, by their numbers among the three factors of the orientation, in the order of the loop.
    given: Vec<usize>,
    /// What is found: dependent lengths and factors of the orientation, with their places among what the closure gives.
    found: Vec<(Part, usize)>,
    /// The dependent coordinates.
    coordinates: Vec<usize>,
    angles: Angles,
    /// What rotations are about.
    centre: Point3<f64>,
}

/// A part of the displacement that follows.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// The length with this number among the coordinates.
    Length(usize),
    /// The factor of the orientation.
    Factor(usize),
    /// The whole orientation, as a rotation vector back to home.
    Orientation,
}

/// The rotations of a task at home: their axes in base directions, and the point that they are about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rotations {
    pub angles: Angles,
    axes: [Vector3<f64>; 3],
    centre: Point3<f64>,
}

/// The angles among the coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Angles {
    /// How many there are: three of a sphere, one of a plane, or none.
    count: usize,
    /// The number of the first one.
    pub first: usize,
}

impl Rotations {
    pub fn new(task: &Task, reference: Point3<f64>) -> Self {
        let home = task.home();
        let angle = |c: &TaskCoordinate| c.quantity == Quantity::Angle;
        let first = task.coordinates.iter().position(angle).unwrap_or(home.len());
        let count = task.coordinates.iter().filter(|c| angle(c)).count();
        let (subspace, screws, centre) = match task.upper.kind {
            SubspaceKind::Identity => (&task.lower, task.lower_screws(&home), task.lower.origin),
            // A sphere above translations has its centre at the reference point.
            _ => (&task.upper, task.upper_screws(&home), reference),
        };
        let axes = match count {
            3 => screws.moved.map(|axis| subspace.axes * axis),
            _ => [subspace.axes.column(2).into(); 3],
        };
        Self { angles: Angles { count, first }, axes, centre }
    }

    /// Writes the angles of an orientation from home to a pose: those nearest to what it holds.
    pub fn write_angles(&self, task: &Task, rotation: UnitQuaternion<f64>, pose: &mut [f64]) {
        let Angles { first, .. } = self.angles;
        let found = self.angles.of_rotation(task, rotation, &self.centre);
        for (value, held) in found.into_iter().zip(&mut pose[first..]) {
            *held = near(value, *held);
        }
    }
}

impl Angles {
    /// The three angles of a rotation about a centre, from home.
    fn of_rotation(
        self,
        task: &Task,
        rotation: UnitQuaternion<f64>,
        centre: &Point3<f64>,
    ) -> [f64; 3] {
        let at = centre.coords;
        let g = Isometry3::from_parts(Translation3::from(at - rotation * at), rotation);
        let ([v, b], _) = task.factors(&g);
        let section = if self.first < task.lower_count { v } else { b };
        task.angles(section.spherical(), [0, 1, 2].map(|i| task.coordinates[self.first + i].home))
    }

    /// The angles of the rotations of a pose; zeros for those that there are not.
    pub fn factors(self, task: &Task, pose: &[f64]) -> [f64; 3] {
        match self.count {
            3 => task.angles.to_factors([0, 1, 2].map(|i| pose[self.first + i])),
            _ => std::array::from_fn(|i| if i < self.count { pose[self.first + i] } else { 0.0 }),
        }
    }

    /// The angles among the coordinates for those of the rotations.
    fn of_factors(self, task: &Task, factors: [f64; 3]) -> [f64; 3] {
        if self.count == 3 { task.angles.of_factors(factors) } else { factors }
    }
}

impl Stem {
    /// The independent coordinates, and how the others follow from them: for the leg with this number.
    ///
    /// # Errors
    /// Where no choice of coordinates has a closed form: why the last one has none, or `None` where no coordinates
    /// determine the motion.
    pub fn new(
        task: &Task,
        mechanism: &Mechanism,
        leg: usize,
        size: f64,
    ) -> Result<(Vec<usize>, Self), Option<NoOrder>> {
        let rotations = Rotations::new(task, mechanism.platform);
        let twists = twists(&mechanism.legs[leg], &rotations.centre, size);
        let rates = rates(task, &twists, &rotations);
        let all: Vec<usize> = (0..task.coordinates.len()).collect();
        // Positions come first; of a crank, its angle does.
        let Angles { count, first } = rotations.angles;
        let is_crank = rates.ncols() == 1 && count == 1;
        let late = |independent: &[usize]| is_crank && !independent.contains(&first);
        let suits = |independent: &[usize]| separable(task, &rotations, independent);
        let mut reason = None;
        for independent in determining(&rates, &all, suits, late) {
            match Self::of(task, mechanism, leg, &independent, &rotations, size) {
                Ok(stem) => return Ok((independent, stem)),
                Err(error) => reason = Some(error),
            }
        }
        Err(reason)
    }

    fn of(
        task: &Task,
        mechanism: &Mechanism,
        leg: usize,
        independent: &[usize],
        rotations: &Rotations,
        size: f64,
    ) -> Result<Self, NoOrder> {
        let all = 0..task.coordinates.len();
        let coordinates: Vec<usize> = all.filter(|i| !independent.contains(i)).collect();
        let dependent_factors = factors(task, rotations, &coordinates);
        let lengths: Vec<usize> = (coordinates.iter().copied())
            .filter(|&i| task.coordinates[i].quantity == Quantity::Length)
            .collect();
        let own: Vec<LegJoint> = joints(&mechanism.legs[leg]).map(|(joint, _)| joint).collect();
        let turned = dependent_factors == [false; 3];
        // Axes point back: the values of the joints are those of the coordinates.
        let back = |axis: Vector3<f64>| Unit::new_normalize(-axis);
        let slides = lengths.iter().map(|&i| {
            (Part::Length(i), LegJoint::Slide { axis: back(task.lower.axes.column(i).into()) })
        });
        let ball = (Part::Orientation, LegJoint::Ball { point: rotations.centre });
        let turn = |factor: usize| {
            let (axis, point) = (back(rotations.axes[factor]), rotations.centre);
            (Part::Factor(factor), LegJoint::Screw { axis, point, pitch: 0.0 })
        };
        let turns: Vec<(Part, LegJoint)> = match dependent_factors {
            [false, false, false] => vec![],
            [true, true, true] => vec![ball],
            _ => (0..rotations.angles.count).rev().map(turn).collect(),
        };
        let [before, after]: [Vec<(Part, LegJoint)>; 2] = match turned {
            true => [slides.collect(), vec![]],
            false => [vec![], turns.into_iter().chain(slides).collect()],
        };
        let is_given = |part: &Part| match part {
            Part::Factor(factor) => !dependent_factors[*factor],
            Part::Length(_) | Part::Orientation => false,
        };
        let joints: Vec<LegJoint> = (before.iter().map(|(_, joint)| *joint))
            .chain(own.iter().copied())
            .chain(after.iter().map(|(_, joint)| *joint))
            .collect();
        let given: Vec<bool> = (before.iter().map(|(part, _)| is_given(part)))
            .chain(own.iter().map(|_| false))
            .chain(after.iter().map(|(part, _)| is_given(part)))
            .collect();
        let configurations: Vec<Vec<f64>> = configurations(&mechanism.legs[leg], size)
            .map(|values| {
                let g = end(&mechanism.legs[leg], &values);
                let parts = |parts: &[(Part, LegJoint)]| -> Vec<f64> {
                    parts.iter().flat_map(|(part, _)| part.value(task, &g, rotations)).collect()
                };
                [parts(&before), values, parts(&after)].concat()
            })
            .collect();
        let closure = WholeLeg::with_given(&joints, &given, &configurations, size)?;
        // What the closure gives is in the order of the joints that are not given.
        let (mut place, mut found) = (0, Vec::new());
        let stem_freedoms: usize = own.iter().map(LegJoint::freedoms).sum();
        for (part, joint) in &before {
            found.push((*part, place));
            place += joint.freedoms();
        }
        place += stem_freedoms;
        for (part, joint) in after.iter().filter(|(part, _)| !is_given(part)) {
            found.push((*part, place));
            place += joint.freedoms();
        }
        let given = after.iter().filter_map(|(part, _)| match part {
            Part::Factor(factor) if is_given(part) => Some(*factor),
            Part::Factor(_) | Part::Length(_) | Part::Orientation => None,
        });
        Ok(Self {
            leg,
            closure,
            bits: [None; 4],
            turned,
            given: given.collect(),
            found,
            coordinates,
            angles: rotations.angles,
            centre: rotations.centre,
        })
    }

    /// It as plain data.
    pub fn form(&self) -> StemForm {
        let part = |part: Part| match part {
            Part::Length(i) => StemPart::Length(i),
            Part::Factor(factor) => StemPart::Factor(factor),
            Part::Orientation => StemPart::Orientation,
        };
        StemForm {
            leg: self.leg,
            closure: self.closure.clone(),
            bits: self.bits,
            turned: self.turned,
            given: self.given.clone(),
            found: self.found.iter().map(|&(of, place)| (part(of), place)).collect(),
            coordinates: self.coordinates.clone(),
            angles: [self.angles.first, self.angles.count],
        }
    }

    /// The number of its two-valued choices.
    pub fn choices(&self) -> usize {
        self.closure.choices()
    }

    /// Writes the dependent coordinates of a pose in a mode. Angles are those nearest to what `pose` holds.
    ///
    /// # Errors
    /// By how much the stem misses the pose.
    pub fn complete(&self, task: &Task, mode: Mode, pose: &mut [f64]) -> Result<(), ReachDeficit> {
        let Angles { count, first } = self.angles;
        let home = |i: usize| task.coordinates[i].home;
        let mut held = [0.0; MOST];
        held[..pose.len()].copy_from_slice(pose);
        for &i in &self.coordinates {
            pose[i] = home(i);
        }
        let mut homes = [0.0; MOST];
        homes.iter_mut().zip(&task.coordinates).for_each(|(to, c)| *to = c.home);
        let factors_home = self.angles.factors(task, &homes);
        let mut factors = self.angles.factors(task, pose);
        if !self.turned {
            // What is known of the rotation is in the loop, not in the target.
            pose[first..first + count].copy_from_slice(&homes[first..first + count]);
        }
        let target = task.displacement(pose);
        let mut given = [0.0; 3];
        for (value, &factor) in given.iter_mut().zip(&self.given) {
            *value = factors[factor] - factors_home[factor];
        }
        let branch = |bit: Option<u32>| match bit {
            Some(bit) if mode.0 >> bit & 1 == 1 => Branch::Minus,
            Some(_) | None => Branch::Plus,
        };
        let mut out = [JointDisplacement::Value(0.0); MOST_FREEDOMS];
        let given = &given[..self.given.len()];
        self.closure.solve_given(&target, given, self.bits.map(branch), &mut out)?;
        let mut turned = None;
        for &(part, place) in &self.found {
            match part {
                Part::Length(i) => pose[i] = home(i) + out[place].value(),
                Part::Factor(factor) => {
                    factors[factor] = factors_home[factor] + out[place].value();
                }
                Part::Orientation => {
                    let vector = Vector3::from_fn(|i, _| -out[place + i].value());
                    turned = Some(UnitQuaternion::from_scaled_axis(vector));
                }
            }
        }
        let found = match turned {
            None => self.angles.of_factors(task, factors),
            Some(rotation) => self.angles.of_rotation(task, rotation, &self.centre),
        };
        for (i, value) in (first..first + count).zip(found) {
            let follows = self.coordinates.contains(&i);
            pose[i] = if follows { near(value, held[i]) } else { held[i] };
        }
        Ok(())
    }
}

impl Part {
    /// The value of its joint where the platform is displaced by `g`.
    fn value(self, task: &Task, g: &Isometry3<f64>, rotations: &Rotations) -> Vec<f64> {
        let ([v, b], rise) = task.factors(g);
        let all = task.pose(&v, &b, rise);
        let home = task.home();
        match self {
            Self::Length(i) => vec![all[i] - home[i]],
            Self::Factor(factor) => {
                let of = |pose: &[f64]| rotations.angles.factors(task, pose)[factor];
                vec![of(&all) - of(&home)]
            }
            Self::Orientation => {
                let vector = g.rotation.inverse().scaled_axis();
                vec![vector.x, vector.y, vector.z]
            }
        }
    }
}

/// Which factors of the orientation are not known where these coordinates are not.
fn factors(task: &Task, rotations: &Rotations, coordinates: &[usize]) -> [bool; 3] {
    let Angles { count, first } = rotations.angles;
    let known = [0, 1, 2].map(|i| Known(i >= count || !coordinates.contains(&(first + i))));
    let known = if count == 3 { task.angles.to_factors(known) } else { known };
    known.map(|known| !known.0)
}

/// Whether a number is known; the difference of two is if both are.
#[derive(Clone, Copy)]
struct Known(bool);

impl std::ops::Sub for Known {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 && other.0)
    }
}

/// Whether the known coordinates are as many as what is known of the displacement: of tilt and torsion, a known torsion says
/// nothing of the factors while the azimuth is not known.
fn separable(task: &Task, rotations: &Rotations, independent: &[usize]) -> bool {
    let all = 0..task.coordinates.len();
    let coordinates: Vec<usize> = all.filter(|i| !independent.contains(i)).collect();
    let unknown = factors(task, rotations, &coordinates).into_iter().filter(|unknown| *unknown);
    let angles = coordinates.iter().filter(|&&i| task.coordinates[i].quantity == Quantity::Angle);
    unknown.count() == angles.count()
}

/// Orthonormal twists `(ω; v)` of a leg at home about a point, lengths over the size.
fn twists(leg: &Leg, point: &Point3<f64>, size: f64) -> DMatrix<f64> {
    let screws = leg.screws();
    let mut twists = DMatrix::zeros(6, screws.len());
    for (mut column, screw) in twists.column_iter_mut().zip(&screws) {
        let linear = (screw.linear + screw.angular.cross(&point.coords)) / size;
        column.fixed_rows_mut::<3>(0).copy_from(&screw.angular);
        column.fixed_rows_mut::<3>(3).copy_from(&linear);
        // A slider counts as much as a rotation.
        let length = column.norm();
        column /= length;
    }
    twists.qr().q()
}

/// The rates of all coordinates at home, lengths over the size, for twists about the point that rotations are about. Those of
/// angles are zeros where home is a pole of the angles.
pub(super) fn rates(task: &Task, twists: &DMatrix<f64>, rotations: &Rotations) -> DMatrix<f64> {
    let Angles { count, first } = rotations.angles;
    let axes = Matrix3::from_columns(&rotations.axes);
    let regular = axes.determinant().abs() > UNDETERMINED;
    let by_axes = if regular { axes.try_inverse() } else { None };
    DMatrix::from_fn(task.coordinates.len(), twists.ncols(), |i, j| {
        let twist = twists.column(j);
        if task.coordinates[i].quantity == Quantity::Length {
            let linear: Vector3<f64> = twist.fixed_rows::<3>(3).into();
            return task.lower.axes.column(i).dot(&linear);
        }
        let angular: Vector3<f64> = twist.fixed_rows::<3>(0).into();
        let by_factors = match count {
            3 => by_axes.map_or_else(Vector3::zeros, |by_axes| by_axes * angular),
            _ => Vector3::new(rotations.axes[0].dot(&angular), 0.0, 0.0),
        };
        rotations.angles.of_factors(task, by_factors.into())[i - first]
    })
}
