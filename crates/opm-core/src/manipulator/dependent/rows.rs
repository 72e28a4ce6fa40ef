//! Dependent coordinates of a platform that several legs constrain together.
//!
//! A leg that lacks freedoms satisfies equations, *rows*, that are affine in the orientation `R` and linear in the position `P`
//! of the platform's reference point: `c · P + ⟨r, R⟩ + c₀ = 0` with a direction `c` of the base or of the platform. A ball that stays in a plane of the
//! base gives one, so does a point of the base that stays in a plane of the platform, and an axis of each that keep their angle.
//! The rows of a leg are found as the equations that all its configurations have in common. Where a line of the platform meets one
//! of the base, `c` is across directions of both: see [`rail`](super::rail).
//!
//! Of the coordinates, at most one angle `ψ` is dependent. With the others known, `R` is affine in its cosine and sine, and the
//! rows determine the positions that follow only where `F(ψ) = det [c | c · P + ⟨r, R⟩ + c₀] = 0`. That is
//! `A cos ψ + B sin ψ + C` for the mechanisms that are covered, and its sign of slope names the branch. The positions are linear.
//!
//! One leg may also keep a ball that slides on a line at a circle, with one unknown more: see [`rail`](super::rail).
//! Where a file asks for it, the orientation follows from the position instead: see [`place`](super::place).

use super::determining::determining;
use super::form::{RowForm, RowsForm};
use super::place::Place;
use super::rail::{Ball, Rail};
use super::stem::{Rotations, rates};
use super::zeros::Function;
use crate::chain::ReachDeficit;
use crate::decomposition::whole::{configurations, end};
use crate::manipulator::{Manipulator, Mode};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use crate::numeric::svd::Svd;
use crate::task::Task;
use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Point3, Rotation3, SMatrix, Vector3, Vector6,
};
use std::f64::consts::FRAC_PI_2;

/// An equation holds, or an equation follows from others, to within this, relative to its scale.
pub(super) const HOLDS: f64 = 1e-9;
/// What is smaller counts as zero; lengths are over the size.
pub(super) const LEVEL: f64 = 1e-6;
/// The most rows.
const MOST: usize = 6;

/// Why the rows of a mechanism have no closed form here.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NoRows {
    /// A leg's constraint is not affine in the orientation and the position.
    #[error(
        "leg {leg} constrains the platform in another way than by a point in a plane, by two lines that meet, by the angle of two axes, or (one leg of all) by a \
         ball that slides on a line and stays on a circle: of its {lacking} constraints {found} are such"
    )]
    Leg {
        /// The leg's name.
        leg: String,
        /// How many constraints it has.
        lacking: usize,
        /// How many are of a form that is covered.
        found: usize,
    },
    /// The constraints of all legs leave another number of freedoms.
    #[error("the legs' constraints leave {left} freedoms, expected {freedoms}")]
    Rank {
        /// What they leave.
        left: usize,
        /// The platform's freedoms.
        freedoms: usize,
    },
    /// No choice of coordinates has a closed form.
    #[error(
        "with no choice of coordinates an angle follows from one equation `A cos + B sin + C = 0`, and the positions from linear ones"
    )]
    Coordinates,
    /// The coordinates that are wanted as independent ones have no closed form.
    #[error("the coordinates that follow from {} have no closed form", .independent.join(", "))]
    Wanted {
        /// The names of the coordinates that are wanted.
        independent: Vec<String>,
    },
}

/// An equation between orientation and position, lengths over the size.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub leg: usize,
    /// Whether the direction turns with the platform.
    pub carried: bool,
    /// The direction is this one of the base across that which turns with the platform.
    pub across: Option<Vector3<f64>>,
    pub direction: Vector3<f64>,
    pub turn: Matrix3<f64>,
    pub constant: f64,
    /// The wrench by which the leg holds the platform at home.
    pub at_home: Vector6<f64>,
}

impl Row {
    fn direction_at(&self, r: &Matrix3<f64>) -> Vector3<f64> {
        let c = if self.carried { r * self.direction } else { self.direction };
        self.across.map_or(c, |base| base.cross(&c))
    }

    /// What there is beside the position.
    fn rest(&self, r: &Matrix3<f64>) -> f64 {
        self.turn.dot(r) + self.constant
    }

    pub fn value(&self, r: &Matrix3<f64>, p: &Vector3<f64>) -> f64 {
        self.direction_at(r).dot(p) + self.rest(r)
    }

    /// The equation as its wrench at home has length one.
    pub fn normalized(mut self) -> Self {
        self.at_home = self.wrench(&Matrix3::identity(), &Vector3::zeros());
        let length = self.at_home.norm();
        self.direction /= length;
        self.turn /= length;
        self.constant /= length;
        self.at_home /= length;
        self
    }

    /// Its rate for a twist `(ω; v)` about the reference point: the wrench by which the leg holds the platform.
    fn wrench(&self, r: &Matrix3<f64>, p: &Vector3<f64>) -> Vector6<f64> {
        let c = self.direction_at(r);
        let a = r * self.turn.transpose();
        let mut moment =
            Vector3::new(a[(1, 2)] - a[(2, 1)], a[(2, 0)] - a[(0, 2)], a[(0, 1)] - a[(1, 0)]);
        if self.carried {
            // (d × ω × c) · P = ω · (c × (P × d))
            moment += match self.across {
                None => c.cross(p),
                Some(base) => (r * self.direction).cross(&p.cross(&base)),
            };
        }
        Vector6::new(moment.x, moment.y, moment.z, c.x, c.y, c.z)
    }
}

/// How coordinates follow from the rows.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    rows: Vec<Row>,
    /// The bits of the choices in a [`Mode`].
    pub bits: [Option<u32>; 2],
    /// The dependent positions.
    lengths: Vec<usize>,
    /// The factor of the orientation that follows, and the coordinate that has it; `None` where all angles are known.
    turn: Option<(usize, usize, Function)>,
    /// How all angles follow from the position, where they do.
    place: Option<Place>,
    /// The ball that slides on a line, and the number of its row.
    rail: Option<(usize, Rail)>,
    /// The bits of the choices of the leg of that ball.
    pub rail_bits: [Option<u32>; 2],
    /// The number of rows that determine the angle alone.
    angles: usize,
    rotations: Rotations,
    reference: Point3<f64>,
    size: f64,
}

impl Rows {
    /// The independent coordinates, and how the others follow from the constraints of all legs. `motions` are displacements of
    /// the platform, at random, by which the rows that are left over are tested. `wanted` are the independent coordinates, where
    /// these are not for opm to choose.
    ///
    /// # Errors
    /// Where there is no closed form.
    pub fn new(
        task: &Task,
        mechanism: &Mechanism,
        (freedoms, wanted): (usize, Option<&[usize]>),
        motions: &[Isometry3<f64>],
        size: f64,
    ) -> Result<(Vec<usize>, Self), NoRows> {
        let reference = mechanism.platform;
        let (mut all, mut rail) = (Vec::new(), None);
        for (number, leg) in mechanism.legs.iter().enumerate() {
            let lacking = 6_usize.saturating_sub(leg.screws().len());
            if lacking > 0 {
                let mut found = rows(leg, number, &reference, size);
                if let Some(ball) = Ball::new(leg, number, &reference, size)
                    && found.is_empty()
                {
                    found.extend(ball.lines());
                    if found.is_empty() && rail.is_none() {
                        rail = ball.rail();
                        found.extend(rail.as_ref().map(Rail::row));
                    }
                }
                if found.len() != lacking {
                    let (leg, found) = (leg.name.clone(), found.len());
                    return Err(NoRows::Leg { leg, lacking, found });
                }
                all.extend(found);
            }
        }
        // Couples first: they tell the angle by themselves.
        all.sort_by_key(|row| row.direction != Vector3::zeros());
        let kept = independent(all);
        if kept.len() + freedoms != 6 {
            return Err(NoRows::Rank { left: 6 - kept.len(), freedoms });
        }
        let rail = match rail {
            None => None,
            Some(rail) => match kept.iter().position(|row| row.leg == rail.leg) {
                Some(row) => Some((row, rail)),
                // Others demand the same.
                None => {
                    let leg = mechanism.legs[rail.leg].name.clone();
                    return Err(NoRows::Leg { leg, lacking: 1, found: 0 });
                }
            },
        };
        let rotations = Rotations::new(task, reference);
        // What the rows leave free at home.
        let held = DMatrix::from_fn(kept.len(), 6, |i, j| kept[i].at_home[j]);
        let left = Svd::new(held).right.columns(kept.len(), freedoms).into_owned();
        let rates = rates(task, &left, &rotations);
        let suits = |independent: &[usize]| {
            let is_angle = |i: &usize| task.coordinates[*i].quantity == Quantity::Angle;
            let angles = (0..6).filter(|i| is_angle(i) && !independent.contains(i)).count();
            match wanted {
                Some(wanted) => wanted.iter().all(|i| independent.contains(i)),
                None => angles <= 1,
            }
        };
        for independent in determining(&rates, &preferred(task), suits, |_| false) {
            let found = Self::of(task, &independent, (&kept, &rail), rotations, (reference, size));
            if let Some(rows) = found.filter(|rows| rows.holds(task, motions)) {
                return Ok((independent, rows));
            }
        }
        Err(match wanted {
            Some(wanted) => {
                let name = |&i: &usize| task.coordinates[i].name.to_owned();
                NoRows::Wanted { independent: wanted.iter().map(name).collect() }
            }
            None => NoRows::Coordinates,
        })
    }

    fn of(
        task: &Task,
        independent: &[usize],
        (rows, rail): (&[Row], &Option<(usize, Rail)>),
        rotations: Rotations,
        (reference, size): (Point3<f64>, f64),
    ) -> Option<Self> {
        let dependent = (0..6).filter(|i| !independent.contains(i));
        let (lengths, angles): (Vec<usize>, Vec<usize>) =
            dependent.partition(|&i| task.coordinates[i].quantity == Quantity::Length);
        let of_angles = rows.iter().filter(|row| row.direction == Vector3::zeros()).count();
        let mut found = Self {
            rows: rows.to_vec(),
            bits: [None; 2],
            lengths,
            turn: None,
            place: None,
            rail: rail.clone(),
            rail_bits: [None; 2],
            angles: of_angles,
            rotations,
            reference,
            size,
        };
        if let [_, _, _] = angles[..] {
            found.place = Some(Place::new(rows).filter(|_| rail.is_none())?);
            return Some(found);
        }
        if angles.len() > 1 {
            return None;
        }
        let Some(&angle) = angles.first() else {
            return (of_angles == 0).then_some(found);
        };
        // What a ball slides is found with the positions.
        if of_angles > 1 || (rail.is_some() && of_angles == 0) {
            return None;
        }
        // The factor with this angle alone.
        let mut step = [0.0; 6];
        step[angle] = 1.0;
        let by_angle = rotations.angles.factors(task, &step);
        let mut moved = by_angle.iter().enumerate().filter(|(_, by)| **by != 0.0);
        let (factor, _) = moved.next().filter(|_| moved.next().is_none())?;
        let home = task.home();
        let at_home = rotations.angles.factors(task, &home)[factor];
        let plain = Function::harmonic(at_home, 1.0);
        found.turn = Some((factor, angle, plain));
        let values = plain.places().map(|turn| found.left(task, &home, turn));
        let unit = plain.amplitude(values);
        if unit < LEVEL {
            return None;
        }
        found.turn = Some((factor, angle, Function::harmonic(at_home, unit)));
        Some(found)
    }

    /// The orientation of a pose, with one factor replaced.
    fn orientation(&self, task: &Task, pose: &[f64], turn: Option<(usize, f64)>) -> Matrix3<f64> {
        let mut factors = self.rotations.angles.factors(task, pose);
        if let Some((factor, value)) = turn {
            factors[factor] = value;
        }
        let mut all = [0.0; 6];
        all.copy_from_slice(pose);
        let first = self.rotations.angles.first;
        all[first..first + 3].copy_from_slice(&task.angles.of_factors(factors));
        task.displacement(&all).rotation.to_rotation_matrix().into_inner()
    }

    /// What a row is without the dependent positions, and its factors of these.
    fn parts(&self, task: &Task, row: &Row, r: &Matrix3<f64>, pose: &[f64]) -> ([f64; 3], f64) {
        let (c, mut rest) = (row.direction_at(r), row.rest(r));
        let mut by = [0.0; 3];
        for (i, at) in pose.iter().enumerate().take(3) {
            let along = c.dot(&task.lower.axes.column(i));
            match self.lengths.iter().position(|&length| length == i) {
                Some(place) => by[place] = along,
                None => rest += along * (at - task.coordinates[i].home) / self.size,
            }
        }
        (by, rest)
    }

    /// The function of one factor of the orientation that is zero where there are positions that satisfy all rows.
    fn left(&self, task: &Task, pose: &[f64], turn: f64) -> f64 {
        let Some((factor, _, _)) = self.turn else { return 0.0 };
        let r = self.orientation(task, pose, Some((factor, turn)));
        if self.angles == 1 {
            return self.rows[0].rest(&r);
        }
        let mut matrix = SMatrix::<f64, MOST, MOST>::identity();
        for (i, row) in self.rows.iter().enumerate() {
            let (by, rest) = self.parts(task, row, &r, pose);
            let count = self.lengths.len();
            for (j, by) in by[..count].iter().enumerate() {
                matrix[(i, j)] = *by;
            }
            matrix[(i, count)] = rest;
        }
        let used = self.rows.len();
        match used {
            1 => matrix[(0, 0)],
            2 => matrix.fixed_view::<2, 2>(0, 0).determinant(),
            3 => matrix.fixed_view::<3, 3>(0, 0).determinant(),
            _ => matrix.fixed_view::<4, 4>(0, 0).determinant(),
        }
    }

    /// They as plain data.
    pub fn form(&self) -> RowsForm {
        let row = |Row { carried, across, direction, turn, constant, .. }: &Row| RowForm {
            carried: *carried,
            across: *across,
            direction: *direction,
            turn: *turn,
            constant: *constant,
        };
        RowsForm {
            leg: self.leg(),
            rows: self.rows.iter().map(row).collect(),
            couples: self.angles,
            bit: self.bits[0],
            by_place: self.place.is_some(),
            slides: self.rail.is_some(),
            lengths: self.lengths.clone(),
            turn: self
                .turn
                .map(|(factor, angle, function)| (factor, angle, function.home, function.unit)),
            size: self.size,
            first_angle: self.rotations.angles.first,
        }
    }

    /// The number of its two-valued choices.
    pub fn choices(&self) -> usize {
        match self.place {
            Some(_) => 2,
            None => usize::from(self.turn.is_some()) + usize::from(self.rail.is_some()),
        }
    }

    /// The number of the first leg that constrains.
    pub fn leg(&self) -> usize {
        self.rows.first().map_or(0, |row| row.leg)
    }

    /// The leg of the ball that slides on a line.
    pub fn rail_leg(&self) -> Option<usize> {
        self.rail.as_ref().map(|(_, rail)| rail.leg)
    }

    /// The legs that constrain.
    pub fn legs(&self) -> impl Iterator<Item = usize> + '_ {
        self.rows.iter().map(|row| row.leg)
    }

    /// The wrenches by which legs hold the platform at a displacement, about its reference point, with lengths over the size, each
    /// with the number of its leg. There is none for a ball that slides: where it is, joints tell.
    pub fn wrenches(
        &self,
        g: &Isometry3<f64>,
    ) -> impl Iterator<Item = (usize, Option<Vector6<f64>>)> + '_ {
        let (r, p) = (g.rotation.to_rotation_matrix().into_inner(), self.position(g));
        let slides = |i: usize| self.rail.as_ref().is_some_and(|(row, _)| *row == i);
        let rows = self.rows.iter().enumerate();
        rows.map(move |(i, row)| (row.leg, (!slides(i)).then(|| row.wrench(&r, &p))))
    }

    fn position(&self, g: &Isometry3<f64>) -> Vector3<f64> {
        (g * self.reference - self.reference) / self.size
    }

    /// Whether displacements of the platform satisfy the rows, and the dependent coordinates are found again from the others.
    fn holds(&self, task: &Task, motions: &[Isometry3<f64>]) -> bool {
        motions.iter().all(|g| {
            let (r, p) = (g.rotation.to_rotation_matrix().into_inner(), self.position(g));
            let ([v, b], rise) = task.factors(g);
            let all = task.pose(&v, &b, rise);
            // With a closed form that is harmonic in the angle.
            let harmonic = self.turn.is_none_or(|(_, _, function)| {
                let [one, two, three] = function.places().map(|at| self.left(task, &all, at));
                let (middle, cos, sin) =
                    (0.5 * (one + three), 0.5 * (one - three), two - 0.5 * (one + three));
                (0..5).all(|i| {
                    let t = 0.4 + f64::from(i);
                    let expected = middle + cos * t.cos() + sin * t.sin();
                    (self.left(task, &all, function.home + t) - expected).abs()
                        <= LEVEL * function.unit
                })
            });
            let found = |signs: [f64; 2]| {
                let mut pose = all.clone();
                self.lengths.iter().for_each(|&i| pose[i] = task.coordinates[i].home);
                self.complete_with(task, signs, &mut pose).is_ok()
                    && task.coordinates.iter().zip(pose.iter().zip(&all)).all(|(c, (a, b))| {
                        let unit = if c.quantity == Quantity::Length { self.size } else { 1.0 };
                        (a - b).abs() < LEVEL * unit
                    })
            };
            harmonic
                && self.rows.iter().enumerate().all(|(i, row)| {
                    let rail = self.rail.as_ref().filter(|(of, _)| *of == i);
                    let miss = rail.map_or_else(
                        || row.value(&r, &p).abs(),
                        |(_, rail)| rail.miss(row, &r, &p),
                    );
                    miss <= HOLDS
                })
                && [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].into_iter().any(found)
        })
    }

    /// Writes the dependent coordinates of a pose in a mode. Angles are those nearest to what `pose` holds.
    ///
    /// # Errors
    /// By how much no angle satisfies the rows.
    pub fn complete(
        &self,
        manipulator: &Manipulator,
        mode: Mode,
        pose: &mut [f64],
    ) -> Result<(), ReachDeficit> {
        let minus = |bit: Option<u32>| bit.is_some_and(|bit| mode.0 >> bit & 1 == 1);
        let signs = self.bits.map(|bit| if minus(bit) { -1.0 } else { 1.0 });
        let slid = self.complete_with(manipulator.task(), signs, pose)?;
        match &self.rail {
            Some((_, rail)) => self.check_slid(manipulator, mode, pose, (rail, slid)),
            None => Ok(()),
        }
    }

    /// Checks that the leg of the ball slides in a mode as its constraint has it. Where the leg is out of reach, its own
    /// solution tells so.
    fn check_slid(
        &self,
        manipulator: &Manipulator,
        mode: Mode,
        pose: &[f64],
        (rail, wanted): (&Rail, f64),
    ) -> Result<(), ReachDeficit> {
        let task = manipulator.task();
        let mut all = [0.0; 6];
        all.copy_from_slice(pose);
        let g = task.displacement(&all);
        let Some(slid) = manipulator.slid(rail.leg, rail.freedom(), &g, mode) else {
            return Ok(());
        };
        let (r, p) = (g.rotation.to_rotation_matrix().into_inner(), self.position(&g));
        let sliding = rail.sliding(&r, &p, &Vector3::zeros());
        match rail.agrees(sliding, [slid / self.size, wanted]) {
            true => Ok(()),
            false => Err(ReachDeficit::length((slid - wanted * self.size).abs())),
        }
    }

    /// The same with the signs of the slopes. Returns what the ball of a rail has slid, over the size.
    fn complete_with(
        &self,
        task: &Task,
        signs: [f64; 2],
        pose: &mut [f64],
    ) -> Result<f64, ReachDeficit> {
        if let Some(place) = &self.place {
            let mut p = Vector3::zeros();
            for (i, (at, c)) in pose.iter().zip(&task.coordinates).enumerate().take(3) {
                p += task.lower.axes.column(i) * ((at - c.home) / self.size);
            }
            let r = place.orientation(&self.rows, &p, signs)?;
            self.rotations.write_angles(task, Rotation3::from_matrix_unchecked(r).into(), pose);
            return Ok(0.0);
        }
        if let Some((factor, angle, function)) = self.turn {
            let values = function.places().map(|at| self.left(task, pose, at));
            let mut factors = self.rotations.angles.factors(task, pose);
            factors[factor] = function
                .zero(values, signs[0], factors[factor])
                .map_err(|value| ReachDeficit::angle((value / function.unit).abs()))?;
            let found = task.angles.of_factors(factors)[angle - self.rotations.angles.first];
            pose[angle] = found;
        }
        let r = self.orientation(task, pose, None);
        let mut matrix = SMatrix::<f64, MOST, 3>::zeros();
        // Without what a ball slides, and what that adds.
        let mut right = SMatrix::<f64, MOST, 2>::zeros();
        for (i, row) in self.rows.iter().enumerate().skip(self.angles) {
            let (by, rest) = self.parts(task, row, &r, pose);
            (0..3).for_each(|j| matrix[(i, j)] = by[j]);
            right[(i, 0)] = -rest;
        }
        if let Some((row, rail)) = &self.rail {
            right[(*row, 1)] = -rail.by_slider(&r);
        }
        // Columns of positions that are known are unit vectors of rows that are not used.
        for j in self.lengths.len()..3 {
            matrix[(MOST - 1 - (2 - j), j)] = 1.0;
        }
        let qr = matrix.qr();
        let square = qr.r();
        let mut rotated = right;
        qr.q_tr_mul(&mut rotated);
        if square.diagonal().iter().any(|pivot| pivot.abs() < LEVEL) {
            return Err(ReachDeficit::angle(FRAC_PI_2));
        }
        let head = rotated.fixed_rows::<3>(0).into_owned();
        let Some(found) = square.solve_upper_triangular(&head) else {
            return Err(ReachDeficit::angle(FRAC_PI_2));
        };
        let mut slid = 0.0;
        if let Some((_, rail)) = &self.rail {
            let [mut p, mut by] = [Vector3::zeros(); 2];
            for (i, (at, c)) in pose.iter().zip(&task.coordinates).enumerate().take(3) {
                let axis = task.lower.axes.column(i);
                match self.lengths.iter().position(|&length| length == i) {
                    Some(place) => {
                        p += axis * found[(place, 0)];
                        by += axis * found[(place, 1)];
                    }
                    None => p += axis * ((at - c.home) / self.size),
                }
            }
            let sign = signs[usize::from(self.turn.is_some())];
            slid = rail
                .slide(rail.sliding(&r, &p, &by), sign)
                .map_err(|missed| ReachDeficit::length(missed.excess * self.size))?;
        }
        for (place, &i) in self.lengths.iter().enumerate() {
            let moved = found[(place, 0)] + slid * found[(place, 1)];
            pose[i] = task.coordinates[i].home + moved * self.size;
        }
        Ok(slid)
    }
}

/// The coordinates in the order in which they are taken as independent: the height, the tilts, then the others.
fn preferred(task: &Task) -> Vec<usize> {
    let first = task.lower_count;
    vec![2, first, first + 1, 0, 1, first + 2]
}

/// Those rows that do not follow from the ones before them: their wrenches at home are independent.
fn independent(mut rows: Vec<Row>) -> Vec<Row> {
    let mut basis: Vec<Vector6<f64>> = Vec::new();
    rows.retain(|row| {
        let mut rest = row.at_home;
        // Twice, so that rounding is not left.
        for _ in 0..2 {
            rest = basis.iter().fold(rest, |rest, unit| rest - unit * unit.dot(&rest));
        }
        let new = rest.norm() > LEVEL;
        if new {
            basis.push(rest.normalize());
        }
        new
    });
    rows
}

/// The rows of a leg: the equations of a form that is covered that all its configurations have in common.
fn rows(leg: &Leg, number: usize, reference: &Point3<f64>, size: f64) -> Vec<Row> {
    let ends: Vec<(Matrix3<f64>, Vector3<f64>)> = (0..4)
        .flat_map(|turn| configurations(leg, size * (1.0 + 0.2 * f64::from(turn))))
        .enumerate()
        .map(|(sample, values)| {
            // Each time other proportions.
            let spread = |(i, value): (usize, &f64)| {
                value * (1.0 + 0.37 * ((7 * sample + 3 * i) % 5) as f64)
            };
            let values: Vec<f64> = values.iter().enumerate().map(spread).collect();
            let g = end(leg, &values);
            let p = (g * reference - reference) / size;
            (g.rotation.to_rotation_matrix().into_inner(), p)
        })
        .collect();
    // A column for each coefficient: of the position, as the base or as the platform sees it, of the orientation, and the constant.
    let fitted = |carried: Option<bool>| {
        let sample = |(r, p): &(Matrix3<f64>, Vector3<f64>)| -> Vec<f64> {
            let place = carried.map(|carried| if carried { r.transpose() * p } else { *p });
            let place = place.iter().flat_map(|v| v.iter().copied()).collect::<Vec<_>>();
            place.into_iter().chain(r.iter().copied()).chain([1.0]).collect()
        };
        let all: Vec<Vec<f64>> = ends.iter().map(sample).collect();
        let width = all[0].len();
        let svd = Svd::new(DMatrix::from_fn(all.len(), width, |i, j| all[i][j]));
        let largest = svd.values.first().copied().unwrap_or(1.0);
        let none = (0..width).filter(|&j| svd.values.get(j).is_none_or(|v| *v <= HOLDS * largest));
        none.map(|j| svd.right.column(j).into_owned()).collect::<Vec<DVector<f64>>>()
    };
    let row = |vector: &DVector<f64>, carried: bool| {
        let place = vector.len() - 10;
        let direction = match place {
            0 => Vector3::zeros(),
            _ => Vector3::new(vector[0], vector[1], vector[2]),
        };
        let (turn, constant) = (&vector.as_slice()[place..place + 9], vector[place + 9]);
        let turn = Matrix3::from_column_slice(turn);
        Row {
            leg: number,
            carried,
            across: None,
            direction,
            turn,
            constant,
            at_home: Vector6::zeros(),
        }
        .normalized()
    };
    let mut found: Vec<Row> = fitted(None).iter().map(|vector| row(vector, false)).collect();
    for carried in [false, true] {
        let null = fitted(Some(carried));
        if null.is_empty() {
            continue;
        }
        // Combinations with independent directions; those without one are known already.
        let directions = DMatrix::from_fn(3, null.len(), |i, j| null[j][i]);
        let svd = Svd::new(directions);
        for (j, value) in svd.values.iter().enumerate() {
            if *value > LEVEL {
                let weights = svd.right.column(j);
                let vector = null
                    .iter()
                    .zip(weights.iter())
                    .fold(DVector::zeros(null[0].len()), |sum, (one, by)| sum + one * *by);
                found.push(row(&vector, carried));
            }
        }
    }
    // A point that stays where it is gives rows of either kind.
    independent(found)
}
