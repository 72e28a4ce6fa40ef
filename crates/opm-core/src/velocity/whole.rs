//! Velocities of legs that are solved whole.
//!
//! All joints of a leg together move the platform: `V = J q̇`, with a displaced screw for each freedom. The columns of a leg
//! that has fewer than six freedoms span what it can do, and the platform's twist is among it. A strut that spins between two
//! balls has one freedom more: its first ball does not turn about the strut, which is one more row. So is that the hinges of a
//! parallelogram turn by opposite angles. Rates follow from the rows
//! of the inverse, each reciprocal to all columns but one. Nothing is decided by a tolerance but whether the leg is singular.
//!
//! With the actuated joints locked, each of them holds the platform by a wrench that no other joint of its leg feels: the part
//! of its screw that is perpendicular to the others. These wrenches are the rows of the parallel measure.

use super::rotation_vector::RotationVector;
use super::{
    Jacobians, JointMotion, Rows, SINGULAR, SectionTwists, SingularCause, SingularLeg,
    VelocityError,
};
use crate::chain::whole::{MOST_FREEDOMS as MOST, MOST_PARALLELOGRAMS};
use crate::group::screw::Screw;
use crate::group::{LocalTwist, Subspace, SubspaceKind};
use crate::manipulator::dependent::Whole as Constraining;
use crate::manipulator::{Dependent, Manipulator, Solution, WholeJoint};
use crate::task::Task;
use nalgebra::{
    DMatrix, Isometry3, Matrix3, Matrix6, SVector, Translation3, UnitQuaternion, Vector3, Vector6,
};

/// How many relations may hold between the joints of a leg alone: a strut does not spin, or hinges turn back.
const RELATIONS: usize = MOST_PARALLELOGRAMS;

/// A twist about the platform's reference point, lengths over the size, and the rates of what the joints of the leg hold at zero.
type Row = SVector<f64, { 6 + RELATIONS }>;

/// The differential of a whole leg at one configuration.
#[derive(Clone, Debug)]
pub(super) struct WholeDifferential {
    /// How many freedoms it has.
    pub count: usize,
    /// For each freedom, the platform's twist for a unit rate, rad/s or m/s.
    columns: [Row; MOST],
    /// For each freedom, what is reciprocal to all columns but its own, where it is one. Zeros where the leg is singular.
    duals: [Row; MOST],
    /// For each freedom, the unit wrench that no other joint of the leg feels; zeros where there is none.
    wrenches: [Vector6<f64>; MOST],
    /// The volume of the unit columns, with a sign where there are six.
    pub measure: f64,
    /// The number of the first coordinate of a spherical joint that has made a full revolution.
    revolved: bool,
}

impl WholeDifferential {
    /// That of a leg of which nothing is known yet.
    pub fn unknown() -> Self {
        Self {
            count: 0,
            columns: [Row::zeros(); MOST],
            duals: [Row::zeros(); MOST],
            wrenches: [Vector6::zeros(); MOST],
            measure: 1.0,
            revolved: false,
        }
    }

    /// Why the joints have no rates; `None` if they have.
    fn singular(&self) -> Option<SingularCause> {
        if self.revolved {
            return Some(SingularCause::RotationVector);
        }
        (self.measure.abs() < SINGULAR).then_some(SingularCause::Serial)
    }

    /// The rate of one joint for a twist of the platform.
    fn rate(&self, joint: usize, twist: &Vector6<f64>) -> f64 {
        self.duals[joint].fixed_rows::<6>(0).dot(twist)
    }

    /// Finds the duals, the wrenches and the measure from the columns.
    fn complete(&mut self) {
        let count = self.count;
        let mut volume = 1.0;
        for joint in 0..count {
            // What is left of the column without the others', twice, so that rounding does not remain.
            let mut basis = [Row::zeros(); MOST];
            let mut known = 0;
            let own = self.columns[joint];
            let mut rest = own;
            for other in (0..count).filter(|&other| other != joint) {
                let column = without(self.columns[other], &basis[..known]);
                let length = column.norm();
                if length > SINGULAR * self.columns[other].norm() {
                    basis[known] = column / length;
                    known += 1;
                }
            }
            rest = without(rest, &basis[..known]);
            let square = rest.norm_squared();
            let over = own.dot(&rest);
            let alone = square > SINGULAR * SINGULAR * own.norm_squared();
            self.duals[joint] = if alone { rest / over } else { Row::zeros() };
            let wrench: Vector6<f64> = rest.fixed_rows::<6>(0).into();
            let length = wrench.norm();
            self.wrenches[joint] = if alone { wrench / length } else { Vector6::zeros() };
        }
        let mut basis = [Row::zeros(); MOST];
        for joint in 0..count {
            let own = self.columns[joint];
            let rest = without(own, &basis[..joint]);
            let length = rest.norm();
            volume *= length / own.norm();
            basis[joint] = if length > 0.0 { rest / length } else { rest };
        }
        let related = self.columns[..count]
            .iter()
            .any(|column| column.fixed_rows::<RELATIONS>(6).amax() > 0.0);
        if count == 6 && !related {
            let columns: [Vector6<f64>; 6] =
                std::array::from_fn(|i| self.columns[i].fixed_rows::<6>(0).normalize());
            volume = Matrix6::from_columns(&columns).determinant();
        }
        self.measure = if volume.is_nan() { 0.0 } else { volume };
        if self.singular().is_some() {
            self.duals = [Row::zeros(); MOST];
        }
    }
}

/// A vector without its components along orthonormal ones, twice: rounding of the first time is not left.
fn without(mut vector: Row, basis: &[Row]) -> Row {
    for _ in 0..2 {
        for unit in basis {
            vector -= unit * unit.dot(&vector);
        }
    }
    vector
}

/// The screw of no motion.
const STILL: Screw =
    Screw { angular: Vector3::new(0.0, 0.0, 0.0), linear: Vector3::new(0.0, 0.0, 0.0) };

/// A twist `(ω; v)` about a point, lengths over the size.
pub(super) fn about(screw: &Screw, point: &Vector3<f64>, size: f64) -> Vector6<f64> {
    let (w, v) = (&screw.angular, (screw.linear + screw.angular.cross(point)) / size);
    Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z)
}

/// The sum of a screw and a multiple of another one.
fn plus(a: &Screw, times: f64, b: &Screw) -> Screw {
    Screw { angular: a.angular + b.angular * times, linear: a.linear + b.linear * times }
}

/// A spherical joint of a leg at one configuration.
#[derive(Clone, Copy)]
struct Ball {
    /// The number of its first freedom.
    first: usize,
    vector: RotationVector,
    /// What turns its rates into the angular velocity, before the joints below it move.
    angular: Matrix3<f64>,
    /// The displacement of the joints below it.
    below: Isometry3<f64>,
    /// Its centre, base coordinates.
    centre: Vector3<f64>,
}

impl Ball {
    /// The screw of an angular velocity, or an angular acceleration, before the joints below it move.
    fn screw(&self, angular: Vector3<f64>) -> Screw {
        let angular = self.below.rotation * angular;
        Screw { angular, linear: self.centre.cross(&angular) }
    }
}

/// The displaced screws of a leg at one configuration, from base to platform.
struct DisplacedLeg {
    count: usize,
    screws: [Screw; MOST],
    /// The rates of what the joints hold at zero for a unit rate of each freedom.
    relations: [[f64; RELATIONS]; MOST],
    balls: [Option<Ball>; 2],
}

impl DisplacedLeg {
    fn new(manipulator: &Manipulator, at: &Solution, number: usize, rows: Rows) -> Self {
        let mut found = Self {
            count: 0,
            screws: [STILL; MOST],
            relations: Default::default(),
            balls: [None; 2],
        };
        let Some(whole) = &manipulator.legs[number].whole else { return found };
        let (idle, solution) = (whole.leg.idle(), &at.legs[number]);
        let first = manipulator.coordinates_of(number).start;
        let mut g = Isometry3::identity();
        let mut parallelograms = 0;
        for joint in &whole.joints {
            let start = found.count;
            let displacement = |i: usize| whole.displacement(solution, start + i);
            match joint {
                WholeJoint::Ball(point, home) => {
                    let own = Vector3::from_fn(|i, _| match rows {
                        // Full revolutions count.
                        Rows::All => at.joints[first + start + i] - home[i],
                        Rows::Driven => displacement(i).value(),
                    });
                    let vector = RotationVector::new(own);
                    let inverse = vector.angular_velocity_to_rates().try_inverse();
                    let ball = Ball {
                        first: start,
                        vector,
                        angular: inverse.unwrap_or_else(Matrix3::identity),
                        below: g,
                        centre: (g * point).coords,
                    };
                    let line = idle.filter(|(first, _)| *first == ball.first);
                    for i in 0..3 {
                        found.push(
                            ball.screw(ball.angular.column(i).into()),
                            [line.map_or(0.0, |(_, direction)| direction[i]), 0.0],
                        );
                    }
                    if let Some(free) = found.balls.iter_mut().find(|ball| ball.is_none()) {
                        *free = Some(ball);
                    }
                    let turned = UnitQuaternion::from_scaled_axis(own);
                    let place = point.coords;
                    g *= Isometry3::from_parts(Translation3::from(place - turned * place), turned);
                }
                WholeJoint::Screw(screw) => {
                    found.push(screw.transformed(&g), [0.0; RELATIONS]);
                    g *= screw.exp(displacement(0).value());
                }
                WholeJoint::Back(screw) => {
                    let mut opposite = [0.0; RELATIONS];
                    opposite[parallelograms] = 1.0;
                    parallelograms += 1;
                    found.relations[start - 1] = opposite;
                    found.push(screw.transformed(&g), opposite);
                    g *= screw.exp(displacement(0).value());
                }
            }
        }
        found
    }

    fn push(&mut self, screw: Screw, relations: [f64; RELATIONS]) {
        // A leg with more freedoms has no closed form.
        if self.count < MOST {
            (self.screws[self.count], self.relations[self.count]) = (screw, relations);
            self.count += 1;
        }
    }

    /// The change of the platform's twist at constant rates: each screw moves with the joints before it. The freedoms of a
    /// ball move together, and its rates turn into an angular velocity that depends on its vector.
    fn bias(&self, rates: &[f64; MOST]) -> Screw {
        let (mut twist, mut bias, mut freedom) = (STILL, STILL, 0);
        while freedom < self.count {
            let mut own = STILL;
            let ball = self.balls.iter().flatten().find(|ball| ball.first == freedom);
            let together = if ball.is_some() { 3 } else { 1 };
            let end = (freedom + together).min(self.count);
            for (rate, screw) in rates[freedom..end].iter().zip(&self.screws[freedom..end]) {
                own = plus(&own, *rate, screw);
            }
            if let Some(ball) = ball {
                let own = Vector3::from_fn(|i, _| rates[freedom + i]);
                let change = ball.vector.bias(&own, &(ball.angular * own));
                bias = plus(&bias, -1.0, &ball.screw(ball.angular * change));
            }
            bias = plus(&bias, 1.0, &twist.bracket(&own));
            twist = plus(&twist, 1.0, &own);
            freedom += together;
        }
        bias
    }
}

impl SectionTwists {
    /// The twist of the platform in base coordinates, and its derivative: `V_v + Ad(v) V_b`.
    pub(super) fn of_platform(&self, task: &Task, v: &crate::group::Displacement) -> [Screw; 2] {
        let embedded = |subspace: &Subspace, twist: &LocalTwist| {
            let [angular, linear] = subspace.embedded(twist);
            Screw { angular, linear: linear + subspace.origin.coords.cross(&angular) }
        };
        let lower = task.lower.isometry(v);
        let below = self.v.map(|twist| embedded(&task.lower, &twist));
        let above = self.b.map(|twist| embedded(&task.upper, &twist).transformed(&lower));
        let rise = self.rise.map(|rate| Screw {
            angular: Vector3::zeros(),
            linear: task.height.as_ref().map_or_else(Vector3::zeros, |height| height.up * rate),
        });
        let twist = plus(&plus(&below[0], 1.0, &above[0]), 1.0, &rise[0]);
        let derivative = plus(&plus(&below[1], 1.0, &above[1]), 1.0, &rise[1]);
        [twist, plus(&derivative, 1.0, &below[0].bracket(&above[0]))]
    }
}

impl Manipulator {
    /// The differential of a whole leg at a solution.
    fn whole_differential(&self, leg: &DisplacedLeg, point: &Vector3<f64>) -> WholeDifferential {
        let size = self.characteristic_length();
        let mut found = WholeDifferential { count: leg.count, ..WholeDifferential::unknown() };
        for (i, column) in found.columns[..leg.count].iter_mut().enumerate() {
            column.fixed_rows_mut::<6>(0).copy_from(&about(&leg.screws[i], point, size));
            column.fixed_rows_mut::<RELATIONS>(6).copy_from_slice(&leg.relations[i]);
        }
        found.revolved = leg.balls.iter().flatten().any(|ball| ball.vector.is_singular());
        found.complete();
        found
    }

    /// The serial measure of a leg at a solution, which the leg reaches.
    pub(super) fn whole_measure(&self, at: &Solution, leg: usize) -> f64 {
        let displaced = DisplacedLeg::new(self, at, leg, Rows::Driven);
        self.whole_differential(&displaced, &self.reference(at)).measure
    }

    /// The place of the platform's reference point at a solution.
    fn reference(&self, at: &Solution) -> Vector3<f64> {
        (at.displacement(self) * self.mechanism().platform).coords
    }

    /// The numbers of the joint coordinates of a leg.
    pub(super) fn coordinates_of(&self, leg: usize) -> std::ops::Range<usize> {
        let count = |number: usize| self.mechanism().legs[number].coordinates().count();
        let first: usize = (0..leg).map(count).sum();
        first..first + count(leg)
    }

    /// Rates and accelerations of every joint: see [`Manipulator::velocity`].
    pub(super) fn whole_velocity(
        &self,
        at: &Solution,
        twists: &SectionTwists,
        out: &mut JointMotion,
    ) -> Result<bool, VelocityError> {
        out.singular.clear();
        let (point, size) = (self.reference(at), self.characteristic_length());
        let [twist, derivative] = twists.of_platform(self.task(), &at.solved.v);
        for number in 0..self.legs.len() {
            let leg = DisplacedLeg::new(self, at, number, Rows::All);
            let differential = self.whole_differential(&leg, &point);
            let own = self.coordinates_of(number);
            let (mut rates, mut accelerations) = ([0.0; MOST], [0.0; MOST]);
            match differential.singular() {
                Some(cause) => {
                    out.singular.push(SingularLeg { leg: number, section: None, cause });
                }
                None => {
                    let moved = about(&twist, &point, size);
                    rates = std::array::from_fn(|i| differential.rate(i, &moved));
                    let rest = plus(&derivative, -1.0, &leg.bias(&rates));
                    let change = about(&rest, &point, size);
                    accelerations = std::array::from_fn(|i| differential.rate(i, &change));
                }
            }
            if !rates.iter().chain(&accelerations).all(|value| value.is_finite()) {
                return Err(VelocityError::Overflow { leg: number });
            }
            let count = own.len();
            out.joint_rates[own.clone()].copy_from_slice(&rates[..count]);
            out.joint_accelerations[own].copy_from_slice(&accelerations[..count]);
        }
        Ok(out.singular.is_empty())
    }

    /// Computes the rates of all joints for each component of the section twist, whose columns of the platform are known.
    pub(super) fn whole_rows(&self, at: &Solution, rows: Rows, out: &mut Jacobians) -> bool {
        out.singular.clear();
        let (point, size) = (self.reference(at), self.characteristic_length());
        let lower = self.task().lower.isometry(&at.solved.v).rotation;
        for number in 0..self.legs.len() {
            let leg = DisplacedLeg::new(self, at, number, rows);
            let differential = self.whole_differential(&leg, &point);
            if let Some(cause) = differential.singular() {
                out.singular.push(SingularLeg { leg: number, section: None, cause });
            }
            for (column, twist) in out.platform.column_iter().enumerate() {
                let angular = lower * twist.fixed_rows::<3>(0);
                let linear = lower * twist.fixed_rows::<3>(3) / size;
                let (w, v) = (&angular, &linear);
                let twist = Vector6::new(w.x, w.y, w.z, v.x, v.y, v.z);
                for (joint, row) in self.coordinates_of(number).enumerate() {
                    out.joints[(row, column)] = differential.rate(joint, &twist);
                }
            }
            out.whole[number] = differential;
        }
        out.singular.is_empty()
    }

    /// The wrenches by which a stem holds the platform: unit rows that its joints do no work on, as many as there are dependent
    /// coordinates, among the twists that all coordinates together describe. `point` is the platform's reference point.
    pub(super) fn stem_wrenches(
        &self,
        stem: &WholeDifferential,
        point: &Vector3<f64>,
        most: usize,
    ) -> impl Iterator<Item = Vector6<f64>> + use<> {
        let (task, size) = (self.task(), self.characteristic_length());
        let (mut basis, mut known) = ([Row::zeros(); 2 * MOST], 0);
        for column in &stem.columns[..stem.count] {
            let rest = without(*column, &basis[..known]);
            if rest.norm() > SINGULAR * column.norm() {
                basis[known] = rest.normalize();
                known += 1;
            }
        }
        let own = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
        let alone = task.upper.kind == SubspaceKind::Identity;
        let count = if alone { task.lower.kind.dimension() } else { 6 };
        let described: [Row; 6] = std::array::from_fn(|i| {
            let mut twist = Row::zeros();
            match own.get(i).filter(|_| alone) {
                // Twists of a group stay twists of the group as the platform moves.
                Some(basis) => {
                    let [angular, linear] = task.lower.embedded(basis);
                    let arm = point - task.lower.origin.coords;
                    twist.fixed_rows_mut::<3>(0).copy_from(&angular);
                    let linear = linear + angular.cross(&arm);
                    twist.fixed_rows_mut::<3>(3).copy_from(&(linear / size));
                }
                None => twist[i] = 1.0,
            }
            twist
        });
        let described = &described[..count];
        let start = known;
        for _ in 0..most {
            let rests = described.iter().map(|twist| without(*twist, &basis[..known]));
            let Some(longest) = rests.max_by(|a, b| a.norm().total_cmp(&b.norm())) else { break };
            basis[known] = longest.normalize();
            known += 1;
        }
        // Measures change their sign at singularities alone: joints and wrenches together have the same orientation everywhere.
        let columns = stem.columns[..stem.count].iter().chain(&basis[start..known]);
        let mut together = Matrix6::identity();
        for (j, column) in columns.enumerate().take(described.len()) {
            for (i, twist) in described.iter().enumerate() {
                together[(i, j)] = twist.dot(column);
            }
        }
        let all = stem.count + known - start == described.len() && known > start;
        if all && together.determinant() < 0.0 {
            basis[known - 1] = -basis[known - 1];
        }
        basis.into_iter().take(known).skip(start).map(|row| row.fixed_rows::<6>(0).into_owned())
    }

    /// The wrenches by which constraining legs hold the platform, as many as there are dependent coordinates, each with the number of
    /// its leg. `differential` gives that of a leg.
    fn holding(
        &self,
        at: &Solution,
        point: &Vector3<f64>,
        differential: impl Fn(usize) -> WholeDifferential,
    ) -> ([(usize, Vector6<f64>); 6], usize) {
        let (mut found, mut count) = ([(0, Vector6::zeros()); 6], 0);
        let mut add = |leg: usize, wrench: Vector6<f64>| {
            if let Some(free) = found.get_mut(count) {
                *free = (leg, wrench);
                count += 1;
            }
        };
        match self.dependent.as_ref().and_then(Dependent::whole) {
            Some(Constraining::Stem(stem)) => {
                let most = self.dependent_coordinates().len();
                let wrenches = self.stem_wrenches(&differential(stem.leg), point, most);
                wrenches.for_each(|wrench| add(stem.leg, wrench));
            }
            Some(Constraining::Rows(rows)) => {
                let g = at.displacement(self);
                for (leg, wrench) in rows.wrenches(&g) {
                    match wrench {
                        Some(wrench) => add(leg, wrench),
                        None => self
                            .stem_wrenches(&differential(leg), point, 1)
                            .for_each(|wrench| add(leg, wrench)),
                    }
                }
            }
            Some(Constraining::Mirror(mirror)) => {
                let wrenches = self.mirror_wrenches(at, &mirror.legs, point, differential);
                wrenches.into_iter().flatten().for_each(|(leg, wrench)| add(leg, wrench));
            }
            None => {}
        }
        (found, count)
    }

    /// The rates and accelerations of the platform along the wrenches of constraining legs, which are zero where it moves as these
    /// let it.
    pub(super) fn held_motion(&self, at: &Solution, twists: &SectionTwists) -> [[f64; 6]; 2] {
        let (point, size) = (self.reference(at), self.characteristic_length());
        let leg = |number: usize| DisplacedLeg::new(self, at, number, Rows::All);
        let (wrenches, count) =
            self.holding(at, &point, |number| self.whole_differential(&leg(number), &point));
        let [twist, derivative] = twists.of_platform(self.task(), &at.solved.v);
        let moved = about(&twist, &point, size);
        let mut found = [[0.0; 6]; 2];
        for (row, (number, wrench)) in wrenches.iter().enumerate().take(count) {
            let displaced = leg(*number);
            let differential = self.whole_differential(&displaced, &point);
            let rates: [f64; MOST] = std::array::from_fn(|i| differential.rate(i, &moved));
            let rest = plus(&derivative, -1.0, &displaced.bias(&rates));
            let change = about(&rest, &point, size);
            (found[0][row], found[1][row]) = (wrench.dot(&moved), wrench.dot(&change));
        }
        found
    }

    /// Computes the rates along the wrenches of constraining legs for each component of the section twist, whose columns are known.
    pub(super) fn held_rows(&self, at: &Solution, out: &mut Jacobians) {
        if self.dependent.is_none() {
            return;
        }
        let (point, size) = (self.reference(at), self.characteristic_length());
        let lower = self.task().lower.isometry(&at.solved.v).rotation;
        let (wrenches, count) = self.holding(at, &point, |leg| out.whole[leg].clone());
        // Where too few hold, dependent coordinates have no rates.
        out.locked.fill(0.0);
        for (row, (_, wrench)) in wrenches.iter().enumerate().take(count) {
            for (column, twist) in out.platform.column_iter().enumerate() {
                let angular: Vector3<f64> = lower * twist.fixed_rows::<3>(0);
                let linear: Vector3<f64> = lower * twist.fixed_rows::<3>(3);
                out.locked[(row, column)] = wrench.fixed_rows::<3>(0).dot(&angular)
                    + wrench.fixed_rows::<3>(3).dot(&linear) / size;
            }
        }
    }

    /// Fills the closure with the actuated joints locked: a row for each of them, and for each wrench of constraining legs, a column for each
    /// component of the section twist, in units of one radian or the size.
    pub(super) fn fill_whole_closure(&self, jacobians: &Jacobians, closure: &mut DMatrix<f64>) {
        let size = self.characteristic_length();
        let lower = self.task().lower.isometry(&jacobians.v).rotation;
        let mut row = 0;
        for (number, differential) in jacobians.whole.iter().enumerate() {
            for (joint, coordinate) in self.coordinates_of(number).enumerate() {
                if self.actuated().binary_search(&coordinate).is_err() {
                    continue;
                }
                for (column, twist) in jacobians.platform.column_iter().enumerate() {
                    let angular: Vector3<f64> = lower * twist.fixed_rows::<3>(0);
                    let linear: Vector3<f64> = lower * twist.fixed_rows::<3>(3);
                    // A translation counts in sizes, a rotation in radians.
                    let unit = if angular == Vector3::zeros() { size } else { 1.0 };
                    let wrench = &differential.wrenches[joint];
                    let power = wrench.fixed_rows::<3>(0).dot(&angular)
                        + wrench.fixed_rows::<3>(3).dot(&linear) / size;
                    closure[(row, column)] = power * unit;
                }
                row += 1;
            }
        }
        for held in jacobians.locked.row_iter() {
            for (column, twist) in jacobians.platform.column_iter().enumerate() {
                let turns = twist.fixed_rows::<3>(0).iter().any(|part| *part != 0.0);
                closure[(row, column)] = held[column] * if turns { 1.0 } else { size };
            }
            row += 1;
        }
    }
}
