//! Bounds of the worst pose error over a box of poses.
//!
//! At each pose of a box the closure of the legs is a linear system. Its entries follow from the screws of the joints, which
//! affine arithmetic encloses: each is a linear function of the place in the box, up to a known error. The plays `p` are the
//! smallest with which the legs close, `min |p|²` with `A u + B p + E = 0` and `Dᵀ p = 0`, where `u` are the platform's twist
//! and the passive joints' rates, and the columns of `D` what actuated joints do not do. With multipliers `λ` and `μ`, and `p =
//! -Bᵀ λ - D μ`,
//!
//! ```text
//! A u - B Bᵀ λ - B D μ = -E        Aᵀ λ = 0        Dᵀ Bᵀ λ + Dᵀ D μ = 0
//! ```
//!
//! is a square system `M x = b`. With an approximate inverse `R` of its middle, the linear function that solves it to first
//! order leaves a residual `ρ`, and the solution is within `|R ρ| / (1 - |1 - R M|)` of it in a norm with positive weights (S.
//! Rump, "Verification methods", *Acta Numerica* 19, 2010, section 10). So the error of the bound is quadratic in the size of
//! the box. The worst case of a linear function is convex, and largest in a corner.

use crate::response::Model;
use crate::source::{ErrorModel, Origin};
use crate::zonotope::farthest;
use nalgebra::{DMatrix, DVector, Matrix3, Point3, Vector3};
use opm_core::Quantity;
use opm_core::enclosure::{Affine, CarriedPoint, Side};
use opm_core::group::screw::Screw;
use opm_core::manipulator::Mode;
use opm_core::mechanism::joint::{Joint, JointKind};

/// The lever, in characteristic lengths, by which directions are told from points: so long that the error of the place hardly
/// counts.
const LEVER: f64 = 1e3;

/// The rounding of a product of matrices, as a share of the product of absolute values, above that of some hundred operations.
const ROUNDING: f64 = 1e-13;

/// Above this contraction bounds are far too wide to be of use.
const MOST_CONTRACTION: f64 = 0.9;

/// Steps towards the best weights of a norm: any weights give a bound.
const POWERS: usize = 10;

/// No weight is smaller, as a share of the largest.
const LEAST_WEIGHT: f64 = 1e-3;

/// What the search for the longest sum may be short by, as a share.
const LONGEST: f64 = 1e-9;

/// Coordinates of a box that may have a width.
pub const MOST_WIDE: usize = 6;

/// Why errors have no bounds over boxes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unbounded {
    /// The joints of this mechanism are not enclosed over boxes.
    #[error(
        "bounds over boxes need sections whose closed forms are enclosed: not inclined joints, nor coordinates that depend on each other"
    )]
    Mechanism,
    /// The error is known at single poses alone.
    #[error("{0} has no bounds over boxes: give tolerances of axes and actuators alone")]
    Error(String),
}

/// Bounds of what errors of given sizes do at the poses of a box that are in reach.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxBudget {
    /// The platform's reference point is not displaced by more, metres.
    pub length: f64,
    /// The platform is not rotated by more, radians.
    pub angle: f64,
    /// The corner of the box in which the displacement of the linear function is the worst, and that for the rotation.
    pub corners: [Vec<f64>; 2],
    /// For each side how much the errors change along it, in units of the characteristic length and radians: what to bisect.
    pub change: Vec<f64>,
}

impl Model<'_> {
    /// Whether errors of these sizes have bounds over boxes.
    ///
    /// # Errors
    /// Why not.
    pub fn check_boxes(&self, sizes: &[f64]) -> Result<(), Unbounded> {
        if !self.manipulator().encloses_places() {
            return Err(Unbounded::Mechanism);
        }
        let mut given = self.sources().iter().zip(sizes).filter(|(_, size)| **size != 0.0);
        let known = |origin: &Origin| matches!(origin, Origin::Actuator(_) | Origin::Axis { .. });
        match given.find(|(source, _)| !known(&source.origin)) {
            Some((source, _)) => Err(Unbounded::Error(source.name.clone())),
            None => Ok(()),
        }
    }

    /// Bounds of what errors of these sizes do in a working mode over a box, which has the lowest and the highest value of each
    /// task coordinate. They hold at each of its poses that is in reach and not singular. `None` where nothing is known: a
    /// smaller box may have bounds.
    ///
    /// # Panics
    /// If there is not one size for each source, or one pair for each coordinate, or if [`Model::check_boxes`] refuses.
    pub fn over_box(&self, mode: Mode, ends: &[[f64; 2]], sizes: &[f64]) -> Option<BoxBudget> {
        assert_eq!(self.sources().len(), sizes.len(), "one size for each source");
        assert!(self.check_boxes(sizes).is_ok(), "errors with bounds over boxes");
        let side = |[low, high]: &[f64; 2]| Side {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
            half_turn: None,
        };
        let sides: Vec<Side> = ends.iter().map(side).collect();
        match sides.iter().filter(|side| side.half > 0.0).count() {
            // One alone is seldom: it does not get a function of its own, which would take time to compile.
            0..=2 => self.over::<2>(mode, &sides, sizes),
            3 => self.over::<3>(mode, &sides, sizes),
            _ => self.over::<MOST_WIDE>(mode, &sides, sizes),
        }
    }

    fn over<const N: usize>(&self, mode: Mode, sides: &[Side], sizes: &[f64]) -> Option<BoxBudget> {
        let legs = Legs::<N>::new(self, mode, sides)?;
        let given: Vec<usize> = (0..sizes.len()).filter(|&k| sizes[k] != 0.0).collect();
        let system = legs.system(self, &given)?;
        let solved = system.solve()?;
        let wide: Vec<usize> = (0..sides.len()).filter(|&i| sides[i].half > 0.0).collect();
        let scaled = |x: &DMatrix<f64>, row: usize, scale: f64| -> Vec<Vector3<f64>> {
            let column = |(column, &source): (usize, &usize)| {
                x.fixed_view::<3, 1>(row, column) * (sizes[source] * scale)
            };
            given.iter().enumerate().map(column).collect()
        };
        // The worst of a linear function of the place in a box is in a corner.
        let worst = |row: usize, scale: f64| {
            let parts: Vec<Vec<Vector3<f64>>> =
                solved.parts.iter().map(|x| scaled(x, row, scale)).collect();
            let off: f64 = scaled(&solved.off, row, scale).iter().map(Vector3::norm).sum();
            let mut most = (0.0, 0);
            for corner in 0..1_usize << wide.len() {
                let mut sums = parts[0].clone();
                for (k, part) in parts[1..].iter().enumerate().take(wide.len()) {
                    let sign = if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                    sums.iter_mut().zip(part).for_each(|(sum, by)| *sum += by * sign);
                }
                let reached = farthest(&sums).norm();
                if reached > most.0 {
                    most = (reached, corner);
                }
            }
            let mut place: Vec<f64> = sides.iter().map(|side| side.middle).collect();
            for (k, &i) in wide.iter().enumerate() {
                place[i] += if most.1 >> k & 1 == 1 { sides[i].half } else { -sides[i].half };
            }
            (most.0 * (1.0 + LONGEST) + off, place)
        };
        let change = |k: usize| -> f64 {
            let sum = |row| scaled(&solved.parts[k + 1], row, 1.0).iter().map(Vector3::norm).sum();
            let [angle, length]: [f64; 2] = [sum(0), sum(3)];
            angle + length
        };
        let mut changes = vec![0.0; sides.len()];
        for (k, &i) in wide.iter().enumerate() {
            changes[i] = change(k);
        }
        let (angle, of_angle) = worst(0, 1.0);
        let (length, of_length) = worst(3, self.length());
        let finite = angle.is_finite() && length.is_finite();
        let corners = [of_length, of_angle];
        finite.then_some(BoxBudget { length, angle, corners, change: changes })
    }
}

type Vector<const N: usize> = [Affine<N>; 3];

/// A twist at the platform's reference point: the rotation, and the displacement over the characteristic length.
type Twist<const N: usize> = [Affine<N>; 6];

/// A frame that some joint coordinates of a leg move.
struct Frame<const N: usize> {
    /// The images of the base's axes, as columns.
    axes: [Vector<N>; 3],
    /// The image of a point.
    at: Vector<N>,
    /// The point at home.
    home: Point3<f64>,
}

/// The legs over a box.
struct Legs<const N: usize> {
    legs: Vec<LegOver<N>>,
    /// The platform's reference point.
    reference: Vector<N>,
    length: f64,
}

struct LegOver<const N: usize> {
    /// What carries each axis; then the platform.
    carried: Vec<Frame<N>>,
    /// The image of each joint's point.
    points: Vec<Vector<N>>,
    /// The screws of all coordinates, with radians or characteristic lengths as units.
    screws: Vec<Twist<N>>,
}

impl<const N: usize> Legs<N> {
    fn new(model: &Model<'_>, mode: Mode, sides: &[Side]) -> Option<Self> {
        let (manipulator, length) = (model.manipulator(), model.length());
        let mechanism = manipulator.mechanism();
        let lever = LEVER * length;
        let mut asked = Vec::new();
        for (number, leg) in mechanism.legs.iter().enumerate() {
            let mut ask = |coordinates: usize, home: Point3<f64>| {
                asked.push(CarriedPoint { leg: number, coordinates, home });
                for axis in Matrix3::<f64>::identity().column_iter() {
                    let home = home + axis * lever;
                    asked.push(CarriedPoint { leg: number, coordinates, home });
                }
            };
            let mut before = 0;
            for joint in &leg.joints {
                ask(before, joint.point);
                if matches!(joint.kind, JointKind::Universal { .. }) {
                    ask(before + 1, joint.point);
                }
                before += joint.freedoms();
            }
            ask(before, mechanism.platform);
        }
        let found: Option<Vec<Vector<N>>> =
            manipulator.carried_over(mode, sides, &asked).into_iter().collect();
        let mut frames = found?
            .chunks(4)
            .zip(asked.chunks(4))
            .map(|(found, asked)| Frame {
                axes: [1, 2, 3]
                    .map(|i| [0, 1, 2].map(|c| (found[i][c] - found[0][c]) * lever.recip())),
                at: found[0],
                home: asked[0].home,
            })
            .collect::<Vec<_>>()
            .into_iter();
        let mut legs = Vec::new();
        let mut carried = Vec::new();
        for leg in &mechanism.legs {
            let axes =
                |joint: &Joint| 1 + usize::from(matches!(joint.kind, JointKind::Universal { .. }));
            let count = leg.joints.iter().map(axes).sum::<usize>() + 1;
            carried.push(frames.by_ref().take(count).collect::<Vec<_>>());
        }
        let reference = carried.first()?.last()?.at;
        for (leg, carried) in mechanism.legs.iter().zip(carried) {
            let mut of = LegOver { carried, points: Vec::new(), screws: Vec::new() };
            let mut axis = 0;
            for joint in &leg.joints {
                let point = of.carried[axis].at;
                for (k, screw) in joint.screws().into_iter().enumerate() {
                    let second =
                        usize::from(matches!(joint.kind, JointKind::Universal { .. }) && k == 1);
                    let unit = match joint.coordinates[k].quantity {
                        Quantity::Angle => 1.0,
                        Quantity::Length => length,
                    };
                    let frame = &of.carried[axis + second];
                    let twist = match joint.kind {
                        // Its rates span all rotations about its centre.
                        JointKind::Spherical => {
                            let axis =
                                [0, 1, 2].map(|i| Affine::constant(f64::from(u8::from(i == k))));
                            at_reference(
                                axis,
                                [Affine::constant(0.0); 3],
                                &point,
                                &reference,
                                length,
                            )
                        }
                        _ => frame.moved(&screw, &reference, length),
                    };
                    of.screws.push(twist.map(|x| x * unit));
                }
                of.points.push(point);
                axis += 1 + usize::from(matches!(joint.kind, JointKind::Universal { .. }));
            }
            legs.push(of);
        }
        Some(Self { legs, reference, length })
    }

    /// The square system of the closure, with a column for each of these sources.
    fn system(&self, model: &Model<'_>, given: &[usize]) -> Option<System<N>> {
        let manipulator = model.manipulator();
        let count = manipulator.coordinates().len();
        let actuated = manipulator.actuated();
        let passive: Vec<usize> = (0..count).filter(|number| !actuated.contains(number)).collect();
        let (rows, moving) = (6 * self.legs.len(), 6 + passive.len());
        let size = rows + moving + actuated.len();
        let mut system = System::new(size, given.len());
        let owner: Vec<usize> = (0..self.legs.len())
            .flat_map(|leg| std::iter::repeat_n(leg, self.legs[leg].screws.len()))
            .collect();
        let screws: Vec<&Twist<N>> = self.legs.iter().flat_map(|leg| &leg.screws).collect();
        // Columns: the twist and the rates, then λ, then μ. Rows: the legs, then Aᵀ, then Dᵀ.
        let (lambda, mu) = (moving, moving + rows);
        let (transposed, last) = (rows, rows + moving);
        for leg in 0..self.legs.len() {
            for i in 0..6 {
                let minus = Affine::constant(-1.0);
                system.set(6 * leg + i, i, minus);
                system.set(transposed + i, lambda + 6 * leg + i, minus);
            }
            let gram = self.gram(leg);
            for (i, row) in gram.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    system.set(6 * leg + i, lambda + 6 * leg + j, -*entry);
                }
            }
        }
        for (column, &number) in passive.iter().enumerate() {
            for (i, &entry) in screws[number].iter().enumerate() {
                let row = 6 * owner[number] + i;
                system.set(row, 6 + column, entry);
                system.set(transposed + 6 + column, lambda + row, entry);
            }
        }
        let points: Vec<&Vector<N>> = self.points_of_coordinates(manipulator.mechanism());
        for (column, &number) in actuated.iter().enumerate() {
            for (i, &entry) in screws[number].iter().enumerate() {
                let row = 6 * owner[number] + i;
                system.set(row, mu + column, -entry);
                system.set(last + column, lambda + row, entry);
            }
            for (other, &with) in actuated.iter().enumerate() {
                // Those of one joint are at one point.
                if std::ptr::eq(points[number], points[with]) {
                    let [one, two] =
                        [number, with].map(|n| self.at_joint(screws[n], points[number]));
                    let pairs: [[&Affine<N>; 2]; 6] = std::array::from_fn(|i| [&one[i], &two[i]]);
                    system.set(last + column, mu + other, Affine::products(pairs));
                }
            }
        }
        for (column, &source) in given.iter().enumerate() {
            for (leg, twist) in self.errors(model, source, &screws, &owner)? {
                for (i, entry) in twist.iter().enumerate() {
                    system.set_right(6 * leg + i, column, -*entry);
                }
            }
        }
        Some(system)
    }

    /// For each coordinate the point of its joint.
    fn points_of_coordinates(&self, mechanism: &opm_core::mechanism::Mechanism) -> Vec<&Vector<N>> {
        let each = mechanism.legs.iter().zip(&self.legs);
        let of_leg = each.flat_map(|(leg, over)| leg.joints.iter().zip(&over.points));
        of_leg.flat_map(|(joint, point)| std::iter::repeat_n(point, joint.freedoms())).collect()
    }

    /// A twist at the reference point, moved to a joint's point.
    fn at_joint(&self, twist: &Twist<N>, point: &Vector<N>) -> Twist<N> {
        let [a, b, c, x, y, z] = *twist;
        let arm = self.arm(point);
        let back = cross(&[a, b, c], &arm);
        [a, b, c, x - back[0], y - back[1], z - back[2]]
    }

    /// From a point to the platform's reference point, over the characteristic length.
    fn arm(&self, point: &Vector<N>) -> Vector<N> {
        [0, 1, 2].map(|i| (self.reference[i] - point[i]) * self.length.recip())
    }

    /// `B Bᵀ` of a leg: with the arm `ρ` from a joint to the reference point, each joint has `B = (1, 0; -[ρ], 1)`.
    fn gram(&self, leg: usize) -> [[Affine<N>; 6]; 6] {
        let mut gram = [[Affine::constant(0.0); 6]; 6];
        for point in &self.legs[leg].points {
            let rho = self.arm(point);
            let square =
                Affine::products([[&rho[0], &rho[0]], [&rho[1], &rho[1]], [&rho[2], &rho[2]]]);
            for i in 0..3 {
                gram[i][i] = gram[i][i] + 1.0;
                for j in 0..3 {
                    if i == j {
                        gram[3 + i][3 + i] = gram[3 + i][3 + i] + 1.0 + square;
                    } else {
                        // -[ρ] below, and its transpose above.
                        let k = 3 - i - j;
                        let minus = if (j + 3 - i) % 3 == 1 { rho[k] } else { -rho[k] };
                        gram[3 + i][j] = gram[3 + i][j] + minus;
                        gram[j][3 + i] = gram[j][3 + i] + minus;
                    }
                    gram[3 + i][3 + j] = gram[3 + i][3 + j] - rho[i] * rho[j];
                }
            }
        }
        gram
    }

    /// The twists of a unit of an error through the legs that it is in.
    fn errors(
        &self,
        model: &Model<'_>,
        source: usize,
        screws: &[&Twist<N>],
        owner: &[usize],
    ) -> Option<Vec<(usize, Twist<N>)>> {
        match &model.sources()[source].origin {
            Origin::Actuator(number) => {
                let unit = match model.manipulator().coordinates()[*number].quantity {
                    Quantity::Angle => 1.0,
                    Quantity::Length => self.length.recip(),
                };
                Some(vec![(owner[*number], screws[*number].map(|x| x * unit))])
            }
            Origin::Axis { leg, first, end, twist } => {
                let moved = |axis: usize| {
                    self.legs[*leg].carried[axis].moved(twist, &self.reference, self.length)
                };
                let first = moved(*first);
                let twist = match model.error_model() {
                    ErrorModel::Links => first,
                    ErrorModel::Axes => {
                        let end = moved(*end);
                        std::array::from_fn(|i| first[i] - end[i])
                    }
                };
                Some(vec![(*leg, twist)])
            }
            Origin::Pitch { .. } | Origin::Parameter { .. } => None,
        }
    }
}

impl<const N: usize> Frame<N> {
    /// A twist at home, moved with the frame, at the reference point.
    fn moved(&self, twist: &Screw, reference: &Vector<N>, length: f64) -> Twist<N> {
        let rotated = |v: &Vector3<f64>| -> Vector<N> {
            [0, 1, 2].map(|i| self.axes[0][i] * v.x + self.axes[1][i] * v.y + self.axes[2][i] * v.z)
        };
        let at_home = twist.linear + twist.angular.cross(&self.home.coords);
        at_reference(rotated(&twist.angular), rotated(&at_home), &self.at, reference, length)
    }
}

/// A rotation with the velocity of a point, at the reference point.
fn at_reference<const N: usize>(
    angular: Vector<N>,
    velocity: Vector<N>,
    point: &Vector<N>,
    reference: &Vector<N>,
    length: f64,
) -> Twist<N> {
    let arm: Vector<N> = [0, 1, 2].map(|i| reference[i] - point[i]);
    let turned = cross(&angular, &arm);
    let linear = [0, 1, 2].map(|i| (velocity[i] + turned[i]) * length.recip());
    [angular[0], angular[1], angular[2], linear[0], linear[1], linear[2]]
}

fn cross<const N: usize>(a: &Vector<N>, b: &Vector<N>) -> Vector<N> {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        Affine::products([[&a[j], &b[k]], [&-a[k], &b[j]]])
    })
}

/// A linear system over a box: matrices of the middle, of the change along each side, and of the errors.
struct System<const N: usize> {
    matrices: Vec<DMatrix<f64>>,
    error: DMatrix<f64>,
    rights: Vec<DMatrix<f64>>,
    right_error: DMatrix<f64>,
}

/// The solution: a linear function, and how far from it it may be.
struct Solved {
    parts: Vec<DMatrix<f64>>,
    off: DMatrix<f64>,
}

impl<const N: usize> System<N> {
    fn new(size: usize, columns: usize) -> Self {
        Self {
            matrices: vec![DMatrix::zeros(size, size); N + 1],
            error: DMatrix::zeros(size, size),
            rights: vec![DMatrix::zeros(size, columns); N + 1],
            right_error: DMatrix::zeros(size, columns),
        }
    }

    fn set(&mut self, row: usize, column: usize, entry: Affine<N>) {
        self.matrices[0][(row, column)] = entry.centre;
        for (k, slope) in entry.slope.iter().enumerate() {
            self.matrices[k + 1][(row, column)] = *slope;
        }
        self.error[(row, column)] = entry.total_error();
    }

    fn set_right(&mut self, row: usize, column: usize, entry: Affine<N>) {
        self.rights[0][(row, column)] = entry.centre;
        for (k, slope) in entry.slope.iter().enumerate() {
            self.rights[k + 1][(row, column)] = *slope;
        }
        self.right_error[(row, column)] = entry.total_error();
    }

    /// Encloses the solution; `None` if the matrix may be singular in the box.
    fn solve(&self) -> Option<Solved> {
        let size = self.error.nrows();
        let inverse = self.matrices[0].clone().try_inverse()?;
        let absolute = inverse.abs();
        // Sides without a width have no part.
        let sides: Vec<usize> = (1..self.matrices.len())
            .filter(|&k| self.matrices[k].amax() > 0.0 || self.rights[k].amax() > 0.0)
            .collect();
        let by_side: Vec<DMatrix<f64>> =
            sides.iter().map(|&k| &inverse * &self.matrices[k]).collect();
        // |1 - R M| over the box, with the rounding of the products.
        let middle = self.matrices[0].abs();
        let mut uncertain = (DMatrix::identity(size, size) - &inverse * &self.matrices[0]).abs();
        uncertain += &absolute * (&self.error + &middle * ROUNDING);
        for (by, &k) in by_side.iter().zip(&sides) {
            uncertain += by.abs() + &absolute * (self.matrices[k].abs() * ROUNDING);
        }
        let weights = balanced(&uncertain);
        let sums = &uncertain * &weights;
        let contraction = sums.component_div(&weights).max();
        // A maximum leaves out what is not a number.
        if contraction >= MOST_CONTRACTION || sums.iter().any(|sum| sum.is_nan()) {
            return None;
        }
        let first = &inverse * &self.rights[0];
        let mut parts = vec![DMatrix::zeros(size, first.ncols()); self.matrices.len()];
        for (by, &k) in by_side.iter().zip(&sides) {
            parts[k] = &inverse * &self.rights[k] - by * &first;
        }
        let mut largest = first.abs();
        sides.iter().for_each(|&k| largest += parts[k].abs());
        // The residual of the linear function, multiplied by the inverse.
        let all = sides.iter().fold(middle, |all, &k| all + self.matrices[k].abs());
        let rights = self.rights.iter().map(DMatrix::abs);
        let rights = rights.fold(self.right_error.clone() * 0.0, |all, right| all + right);
        let mut off = (&inverse * (&self.rights[0] - &self.matrices[0] * &first)).abs();
        off += &absolute * (&self.right_error + &self.error * &largest);
        off += &absolute * ((all * &largest + rights) * (4.0 * ROUNDING));
        for (by, &k) in by_side.iter().zip(&sides) {
            let left = &self.rights[k] - &self.matrices[k] * &first - &self.matrices[0] * &parts[k];
            off += (&inverse * left).abs();
            for &l in &sides {
                off += (by * &parts[l]).abs();
            }
        }
        // |x - x̂| is at most |R ρ| and what |1 - R M| makes of the largest weighted difference in its column.
        for mut column in off.column_iter_mut() {
            let most = column.component_div(&weights).max() / (1.0 - contraction);
            column.axpy(most, &sums, 1.0);
        }
        parts[0] = first;
        Some(Solved { parts, off })
    }
}

/// Positive weights in whose maximum norm a matrix without negative entries is about as small as in any: near the vector of its
/// largest eigenvalue (O. Perron, 1907). Forces, rotations and displacements are no measure of each other.
fn balanced(matrix: &DMatrix<f64>) -> DVector<f64> {
    let mut weights = DVector::repeat(matrix.nrows(), 1.0);
    for _ in 0..POWERS {
        let next = matrix * &weights;
        let largest = next.amax();
        if !(largest > 0.0 && largest.is_finite()) {
            break;
        }
        weights = next.map(|weight| weight / largest + LEAST_WEIGHT);
    }
    weights
}
