//! The joints of a closed loop as single freedoms, over numbers: what is left open, and the rates that close it.
//!
//! The joints of both legs stand in the order of the loop, those of the second leg from its end:
//! `exp(±S₁x₁) exp(±S₂x₂) ... = 1`. Lengths are in units of the mechanism's size, seen from its centre.

use crate::decomposition::mobility::frame;
use crate::group::screw::Screw;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointKind;
use crate::numeric::svd::Svd;
use crate::velocity::rotation_vector::RotationVector;
use nalgebra::{DMatrix, DVector, Isometry3, Point3, Unit, UnitQuaternion, Vector3, Vector6};
use std::f64::consts::TAU;

/// What a freedom does to the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreedomKind {
    /// A rotation: after 2π the loop is as before.
    Turn,
    /// A translation.
    Slide,
    /// A rotation with an advance.
    Helix,
}

/// One freedom of the loop.
#[derive(Clone, Debug)]
pub struct LoopFreedom {
    pub kind: FreedomKind,
    /// Its screw at home.
    pub screw: Screw,
}

/// The motions near a position.
pub enum Motions {
    /// None: the loop is rigid.
    None,
    /// One, of unit length.
    One(DVector<f64>),
    /// Several: orthonormal columns.
    Several(DMatrix<f64>),
}

/// A ball of the loop.
#[derive(Clone, Debug)]
struct Ball {
    /// Its first freedom. The three are rotations about these axes at home.
    first: usize,
    /// 1 in the first leg, -1 in the second one, which the loop passes backwards.
    sign: f64,
    /// If a rod lies between this ball and the next one: the number of the next ball.
    rod_to: Option<usize>,
}

/// A loop of joints.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    /// One for each coordinate of the mechanism; those of a ball are perpendicular rotations in place of its rotation vector.
    pub freedoms: Vec<LoopFreedom>,
    /// The freedoms in the order of the loop, and the sign of each.
    pub order: Vec<(usize, f64)>,
    balls: Vec<Ball>,
    /// The rotations of rods between two balls about themselves. They are held: nothing else moves with them.
    idle: Vec<usize>,
    /// The size of the mechanism, metres.
    pub length: f64,
}

/// A position of the loop's joints.
#[derive(Clone, Debug)]
pub struct Posture {
    /// The displacements of the freedoms from home; those of balls are zero.
    pub values: DVector<f64>,
    /// The rotation of each ball, as the loop passes it.
    balls: Vec<UnitQuaternion<f64>>,
}

/// Singular values below this share of the largest are zero: files have twelve digits.
const RANK: f64 = 1e-7;
/// How far a closed loop may be open, in radians and sizes.
const CLOSED: f64 = 1e-9;
/// A step as small as this is rounding.
const STILL: f64 = 1e-14;
const MOST_STEPS: usize = 12;

/// Three perpendicular axes without a relation to any mechanism: a ball's second rotation is a right angle, where the three
/// depend on each other, at no symmetric position.
fn ball_axes() -> [Unit<Vector3<f64>>; 3] {
    let turned = UnitQuaternion::from_euler_angles(0.4142, 1.1371, -0.7315);
    [Vector3::z_axis(), Vector3::y_axis(), Vector3::x_axis()].map(|axis| turned * axis)
}

impl ClosedLoop {
    pub fn new(mechanism: &Mechanism) -> Self {
        let frame = frame(mechanism);
        let centred = |point: Point3<f64>| Point3::from((point - frame.origin) / frame.length);
        let (mut freedoms, mut order) = (Vec::new(), Vec::new());
        let (mut balls, mut centres) = (Vec::new(), Vec::new());
        for (leg, sign) in mechanism.legs.iter().zip([1.0, -1.0]) {
            let first = freedoms.len();
            for joint in &leg.joints {
                let point = centred(joint.point);
                let turn = |axis| LoopFreedom {
                    kind: FreedomKind::Turn,
                    screw: Screw::rotation(axis, point),
                };
                let slide = |axis| LoopFreedom {
                    kind: FreedomKind::Slide,
                    screw: Screw::translation(axis),
                };
                match joint.kind {
                    JointKind::Revolute => freedoms.push(turn(joint.axis)),
                    JointKind::Prismatic => freedoms.push(slide(joint.axis)),
                    JointKind::Helical { pitch } => freedoms.push(LoopFreedom {
                        kind: FreedomKind::Helix,
                        screw: Screw::helical(joint.axis, point, pitch / frame.length),
                    }),
                    JointKind::Cylindrical => {
                        freedoms.extend([turn(joint.axis), slide(joint.axis)]);
                    }
                    JointKind::Universal { second } => {
                        freedoms.extend([turn(joint.axis), turn(second)]);
                    }
                    JointKind::Spherical => {
                        centres.push(point);
                        balls.push(Ball { first: freedoms.len(), sign, rod_to: None });
                        freedoms.extend(ball_axes().map(turn));
                    }
                }
            }
            order.extend((first..freedoms.len()).map(|i| (i, sign)));
            if sign < 0.0 {
                order[first..].reverse();
            }
        }
        let (idle, length) = (Vec::new(), frame.length);
        let mut closed = Self { freedoms, order, balls, idle, length };
        closed.hold_rods(&centres);
        closed
    }

    /// Of each rod between two balls, the first ball in the order of the loop does not turn it about itself.
    fn hold_rods(&mut self, centres: &[Point3<f64>]) {
        let ball_at = |place: usize| self.ball_of(self.order[place % self.order.len()].0);
        let pairs: Vec<(usize, usize)> = (0..self.order.len())
            .filter_map(|place| ball_at(place).zip(ball_at(place + 1)))
            .filter(|(one, two)| one != two)
            .collect();
        for (one, two) in pairs {
            let Some(rod) = Unit::try_new(centres[two] - centres[one], 1e-9) else { continue };
            let axes = ball_axes();
            let Some(other) = axes.iter().find(|axis| rod.dot(axis).abs() < 0.9) else { continue };
            let across = Unit::new_normalize(rod.cross(other));
            let third = Unit::new_normalize(rod.cross(&across));
            let Ball { first, sign, .. } = self.balls[one];
            // The rotation about the rod is the last one that the loop passes.
            let axes = if sign > 0.0 { [across, third, rod] } else { [rod, third, across] };
            for (i, axis) in axes.into_iter().enumerate() {
                self.freedoms[first + i].screw = Screw::rotation(axis, centres[one]);
            }
            self.balls[one].rod_to = Some(two);
            self.idle.push(self.rod(one));
        }
        self.order.retain(|(i, _)| !self.idle.contains(i));
    }

    /// The freedom of a ball that turns the rod beyond it about itself.
    fn rod(&self, ball: usize) -> usize {
        let Ball { first, sign, .. } = self.balls[ball];
        if sign > 0.0 { first + 2 } else { first }
    }

    /// The number of freedoms.
    pub fn count(&self) -> usize {
        self.freedoms.len()
    }

    /// The position in which the loop is given.
    pub fn home(&self) -> Posture {
        let balls = vec![UnitQuaternion::identity(); self.balls.len()];
        Posture { values: DVector::zeros(self.count()), balls }
    }

    /// The position that has these displacements, those of balls as successive rotations.
    pub fn posture(&self, mut values: DVector<f64>) -> Posture {
        let turned = |ball: &Ball| {
            let turn = |i: usize| {
                let axis = self.freedoms[i].screw.angular;
                UnitQuaternion::from_scaled_axis(axis * values[i])
            };
            let own = turn(ball.first) * turn(ball.first + 1) * turn(ball.first + 2);
            if ball.sign > 0.0 { own } else { own.inverse() }
        };
        let balls = self.balls.iter().map(turned).collect();
        for ball in &self.balls {
            values.rows_mut(ball.first, 3).fill(0.0);
        }
        Posture { values, balls }
    }

    /// The same position, every rod between two balls turned from home the shortest way. (Traced, its rotation about itself is that
    /// of the way there.)
    fn unspun(&self, mut posture: Posture) -> Posture {
        for (number, ball) in self.balls.iter().enumerate() {
            let Some(next) = ball.rod_to else { continue };
            let axis = self.freedoms[self.rod(number)].screw.angular;
            let turned = posture.balls[number];
            let half = turned.imag().dot(&axis).atan2(turned.w);
            let spin = UnitQuaternion::from_scaled_axis(axis * (2.0 * half));
            posture.balls[number] = turned * spin.inverse();
            posture.balls[next] = spin * posture.balls[next];
        }
        posture
    }

    /// The position after a small step of the freedoms; balls turn about their axes beyond them.
    pub fn moved(&self, posture: &Posture, step: &DVector<f64>) -> Posture {
        let mut moved = posture.clone();
        for (turned, ball) in moved.balls.iter_mut().zip(&self.balls) {
            let axis = |i: usize| self.freedoms[i].screw.angular * (ball.sign * step[i]);
            let by: Vector3<f64> = (ball.first..ball.first + 3).map(axis).sum();
            *turned *= UnitQuaternion::from_scaled_axis(by);
        }
        moved.values += step;
        for ball in &self.balls {
            moved.values.rows_mut(ball.first, 3).fill(0.0);
        }
        moved
    }

    /// The step from one position to another one. Full revolutions of revolutes count.
    pub fn step(&self, from: &Posture, to: &Posture) -> DVector<f64> {
        let mut step = &to.values - &from.values;
        for (number, ball) in self.balls.iter().enumerate() {
            let by = (from.balls[number].inverse() * to.balls[number]).scaled_axis();
            for i in ball.first..ball.first + 3 {
                step[i] = ball.sign * self.freedoms[i].screw.angular.dot(&by);
            }
        }
        step
    }

    /// The step from one position to another one, the revolutes by no more than half a revolution. Balls at the ends of a rod are
    /// left out: the other joints say where they are.
    pub fn nearest_step(&self, from: &Posture, to: &Posture) -> DVector<f64> {
        let mut step = self.without_rods(self.step(from, to));
        for (by, freedom) in step.iter_mut().zip(&self.freedoms) {
            if freedom.kind == FreedomKind::Turn {
                *by -= (*by / TAU).round() * TAU;
            }
        }
        step
    }

    /// Adds full revolutions to the revolutes, so that they are near those of another position.
    pub fn turn_on(&self, at: &mut Posture, near: &Posture) {
        let by = self.nearest_step(near, at);
        for (i, freedom) in self.freedoms.iter().enumerate() {
            if freedom.kind == FreedomKind::Turn && !self.is_ball(i) {
                at.values[i] = near.values[i] + by[i];
            }
        }
    }

    /// How far along a tangent a position is, nearest.
    pub fn along(&self, from: &Posture, tangent: &DVector<f64>, to: &Posture) -> f64 {
        let own = self.without_rods(tangent.clone());
        self.nearest_step(from, to).dot(&own) / own.norm_squared().max(f64::MIN_POSITIVE)
    }

    /// A step without the balls at the ends of rods.
    pub fn without_rods(&self, mut step: DVector<f64>) -> DVector<f64> {
        for (number, ball) in self.balls.iter().enumerate() {
            if self.holds_rod(number) {
                step.rows_mut(ball.first, 3).fill(0.0);
            }
        }
        step
    }

    /// Takes the balls at the ends of rods from another position.
    pub fn keep_rods(&self, at: &mut Posture, from: &Posture) {
        for number in 0..self.balls.len() {
            if self.holds_rod(number) {
                at.balls[number] = from.balls[number];
            }
        }
    }

    fn holds_rod(&self, ball: usize) -> bool {
        self.balls[ball].rod_to.is_some()
            || self.balls.iter().any(|other| other.rod_to == Some(ball))
    }

    /// How far the loop is open, `(ω; v)`, and the columns of its rates.
    fn gap(&self, at: &Posture) -> (DVector<f64>, DMatrix<f64>) {
        let mut rates = DMatrix::zeros(6, self.count());
        let mut so_far = Isometry3::identity();
        let mut passed = None;
        for &(i, sign) in &self.order {
            let screw = &self.freedoms[i].screw;
            let ball = self.ball_of(i);
            match ball {
                None => {
                    rates.set_column(i, &(screw.transformed(&so_far).to_vector() * sign));
                    so_far *= screw.exp(sign * at.values[i]);
                }
                Some(number) => {
                    if passed != ball {
                        // The rotation about the centre, which all three axes pass.
                        let turned = at.balls[number].scaled_axis();
                        let (first, mut about) =
                            (self.balls[number].first, Screw::from_vector(&Vector6::zeros()));
                        for j in first..first + 3 {
                            let axis = &self.freedoms[j].screw;
                            let share = axis.angular.dot(&turned);
                            about.angular += axis.angular * share;
                            about.linear += axis.linear * share;
                        }
                        so_far *= about.exp(1.0);
                        passed = ball;
                    }
                    rates.set_column(i, &(screw.transformed(&so_far).to_vector() * sign));
                }
            }
        }
        let turned = so_far.rotation.imag() * (2.0 * so_far.rotation.w.signum());
        let moved = so_far.translation.vector;
        (DVector::from_iterator(6, turned.iter().chain(moved.iter()).copied()), rates)
    }

    /// The motions at a closed position.
    pub fn motions(&self, at: &Posture) -> Motions {
        let moving: Vec<usize> = (0..self.count()).filter(|i| !self.idle.contains(i)).collect();
        let svd = Svd::new(self.gap(at).1.select_columns(&moving));
        let own = svd.kernel(RANK);
        let mut kernel = DMatrix::zeros(self.count(), own.ncols());
        for (row, &i) in moving.iter().enumerate() {
            kernel.set_row(i, &own.row(row));
        }
        match kernel.ncols() {
            0 => Motions::None,
            1 => Motions::One(kernel.column(0).into_owned()),
            _ => Motions::Several(kernel),
        }
    }

    /// The closed position near this one, by steps across `row`. `None` if there is none near.
    pub fn close(&self, near: &Posture, row: &DVector<f64>) -> Option<Posture> {
        let mut at = near.clone();
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (gap, rates) = self.gap(&at);
            let open = gap.norm();
            let mut all = rates.insert_row(6, 0.0);
            all.set_row(6, &row.transpose());
            let step = Svd::new(all).solve(&-gap.insert_row(6, 0.0), RANK);
            let length = step.norm();
            // What a file leaves open does not get less.
            if open <= CLOSED && (length <= STILL || length >= 0.5 * before) {
                return Some(at);
            }
            if !length.is_finite() || length > 1.0 {
                return None;
            }
            before = length;
            at = self.moved(&at, &step);
        }
        (self.gap(&at).0.norm() <= CLOSED).then_some(at)
    }

    /// How far the farthest slider or screw is from home, in sizes.
    pub fn farthest(&self, at: &Posture) -> f64 {
        let far = at.values.iter().zip(&self.freedoms).filter(|(_, f)| f.kind != FreedomKind::Turn);
        far.map(|(value, _)| value.abs()).fold(0.0, f64::max)
    }

    /// The displacements of the joints' coordinates, radians and metres; of a ball its rotation vector.
    pub fn displacements(&self, at: &Posture) -> Vec<f64> {
        let scaled = |(i, value): (usize, &f64)| value * self.unit(i);
        let mut all: Vec<f64> = at.values.iter().enumerate().map(scaled).collect();
        for (ball, turned) in self.balls.iter().zip(&self.unspun(at.clone()).balls) {
            let vector = turned.scaled_axis() * ball.sign;
            all[ball.first..ball.first + 3].copy_from_slice(vector.as_slice());
        }
        all
    }

    /// The rates of the joints' coordinates, for the rates of the freedoms.
    pub fn rates(&self, at: &Posture, rates: &DVector<f64>) -> Vec<f64> {
        let scaled = |(i, rate): (usize, &f64)| rate * self.unit(i);
        let mut all: Vec<f64> = rates.iter().enumerate().map(scaled).collect();
        // The angular velocities of what is beyond each ball, seen from before it.
        let turning = |(ball, turned): (&Ball, &UnitQuaternion<f64>)| {
            let axis = |i: usize| self.freedoms[i].screw.angular * (ball.sign * rates[i]);
            turned * (ball.first..ball.first + 3).map(axis).sum::<Vector3<f64>>()
        };
        let mut omegas: Vec<_> = self.balls.iter().zip(&at.balls).map(turning).collect();
        let unspun = self.unspun(at.clone());
        for (number, ball) in self.balls.iter().enumerate() {
            let Some(next) = ball.rod_to else { continue };
            // A rod that turns the shortest way has no angular velocity along the sum of its directions before and after.
            let rod = self.freedoms[self.rod(number)].screw.angular;
            let now = at.balls[number] * rod;
            let spin = omegas[number].dot(&rod) / (1.0 + rod.dot(&now));
            let turned = unspun.balls[next] * at.balls[next].inverse();
            omegas[number] -= now * spin;
            omegas[next] = turned * omegas[next] + rod * spin;
        }
        for ((ball, turned), omega) in self.balls.iter().zip(&unspun.balls).zip(omegas) {
            let (own, omega) = if ball.sign > 0.0 {
                (*turned, omega)
            } else {
                (turned.inverse(), -(turned.inverse() * omega))
            };
            let vector = RotationVector::new(own.scaled_axis());
            let rates = vector.angular_velocity_to_rates() * omega;
            all[ball.first..ball.first + 3].copy_from_slice(rates.as_slice());
        }
        all
    }

    /// The unit of a freedom, radians or metres.
    pub fn unit(&self, freedom: usize) -> f64 {
        match self.freedoms[freedom].kind {
            FreedomKind::Turn | FreedomKind::Helix => 1.0,
            FreedomKind::Slide => self.length,
        }
    }

    /// How often a position is counted: a ball's three rotations have it twice, a rod between two balls two ways round.
    pub fn multiplicity(&self) -> usize {
        1 << self.balls.len()
    }

    /// The number of the ball that a freedom is one of.
    fn ball_of(&self, freedom: usize) -> Option<usize> {
        self.balls.iter().position(|ball| (ball.first..ball.first + 3).contains(&freedom))
    }

    /// Whether a freedom is one of a ball's.
    pub fn is_ball(&self, freedom: usize) -> bool {
        self.ball_of(freedom).is_some()
    }
}
