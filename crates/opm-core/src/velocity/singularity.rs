//! Singularities, by section.
//!
//! Each section is a parallel mechanism of its own. The upper one moves the platform against a frame
//! that follows `v`; its inputs are the imaginary joints (and what is actuated in it). The lower
//! one is driven by the actuated joints; its outputs are the imaginary joints and `v`. Whether the
//! whole is singular is decided by both, `q̇ = J_p [J_s ω; Ṗ]`.
//!
//! *Serial*: the screws of a leg's section are dependent, `det S = 0`, and the platform cannot go every
//! way. With the paper's first manipulator, `u · (v × w)` of a leg in the upper section, `V · n(α)` of
//! a slider leg and `sin φ₂₄` of the arm in the lower one.
//!
//! *Parallel*: with all inputs locked the section can still move. What a leg's locked inputs forbid is
//! read from the closure by the screws reciprocal to its passive joints, which leaves
//! `J_x ẋ = J_q q̇` with one row an input, no poles and no inverse (Eqs. 7 and 23); the measure is
//! `det J_x`. With that manipulator, the determinant of the three `v × w`, and the product of the
//! three `V · n(θ)`.
//!
//! All measures are continuous, have no dimension, vanish at the singularity and change sign
//! across it, within one working mode as well as from one to the next. Lengths are over lengths of the
//! mechanism that do not change: a link, or the characteristic length. A sign means nothing by itself,
//! only its change does: signs turn with the directions of the sections' frames.

use super::Jacobians;
use super::closure::{cut_unit, inputs, row_unit, section_rows, twist_unit, volume};
use crate::group::LocalTwist;
use crate::manipulator::{Manipulator, Section};
use crate::numeric::svd::Svd;
use nalgebra::DMatrix;

/// The share of the largest component that a leg needs to count as a cause of a parallel singularity.
const INVOLVED: f64 = 0.1;

/// A section's two measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Product over the legs: zero where one of them is stretched, folded or flat.
    pub serial: f64,
    /// Determinant of `J_x`; the volume of its columns, which has no sign, where there are more inputs
    /// than motions. `None` where there are fewer: locking them all never holds the section.
    pub parallel: Option<f64>,
}

impl Default for Measures {
    fn default() -> Self {
        Self { serial: 1.0, parallel: None }
    }
}

/// The measures of singularity at one pose. The buffer is made by [`Manipulator::singularities`] and
/// filled by [`Manipulator::measure_singularities`].
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mut buffer, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
/// let mut measured = manipulator.singularities();
/// for xi in [0.0, 15_f64.to_radians()] {
///     let pose = manipulator.pose([("xi", xi)])?;
///     let at = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
///     manipulator.differentiate(at.expect("a pose in reach"), &mut jacobians)?;
///     manipulator.measure_singularities(&jacobians, &mut measured);
///     // The Euler angles zeta, xi, psi are singular at xi = 0, where their determinant sin xi
///     // vanishes. The mechanism is not.
///     assert!((measured.coordinates.abs() - xi.sin()).abs() < 1e-12);
///     assert!(measured.whole.serial.abs() > 1e-3);
///     // The serial measure of the whole is the product of the two sections' measures.
///     let product = measured.upper.serial * measured.lower.serial;
///     assert!((measured.whole.serial - product).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Singularities {
    /// Of the upper section.
    pub upper: Measures,
    /// Of the lower section.
    pub lower: Measures,
    /// Of the mechanism: its serial measure is the product of the sections'; its parallel one is the
    /// determinant of both closures together, which is the product where each is square.
    pub whole: Measures,
    /// Every leg's serial measures, lower section first.
    pub legs: Vec<[f64; 2]>,
    /// Determinant of [`Jacobians::pose`]: zero where the *coordinates* of the pose are singular
    /// (`sin xi` of Euler angles, `cos nu` of a tilt), which is nothing to the mechanism.
    pub coordinates: f64,
    /// Closures of both sections with the inputs locked: a row an input, the lower section's first;
    /// columns are the cuts, the lower section's twist, the upper section's.
    closure: DMatrix<f64>,
    layout: Layout,
    work: DMatrix<f64>,
}

/// What locks a section, or does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cause {
    /// Number of the leg.
    pub leg: usize,
    /// Which of its sections.
    pub section: Section,
}

/// The rows and columns of the closure.
#[derive(Clone, Debug)]
struct Layout {
    /// Every leg's column for the rate along its cut, where that is a motion of the sections.
    cuts: Vec<Option<usize>>,
    cut_count: usize,
    lower_basis: Vec<LocalTwist>,
    upper_basis: Vec<LocalTwist>,
    /// Leg and section of every row.
    rows: Vec<Cause>,
    lower_rows: usize,
}

impl Layout {
    fn new(manipulator: &Manipulator) -> Self {
        let task = manipulator.task();
        let legs = &manipulator.legs;
        let mut cut_count = 0;
        let cuts: Vec<_> = legs
            .iter()
            .map(|leg| {
                let moves = match leg.cut {
                    Section::Upper => leg.imaginary.is_some(),
                    // What the lower section passes on to an upper one that something drives.
                    Section::Lower => leg.upper.driven,
                };
                moves.then(|| {
                    cut_count += 1;
                    cut_count - 1
                })
            })
            .collect();
        // Where some leg is fixed to it, the frame between the sections moves along I as well.
        let fixed = legs.iter().any(|leg| leg.cut == Section::Upper && leg.imaginary.is_none());
        let lower_basis =
            if fixed { task.lower.kind.basis() } else { task.lower_intersection.complement() };
        let rows_of = |section: Section| {
            legs.iter().enumerate().flat_map(move |(number, leg)| {
                let count = inputs(leg, section).into_iter().filter(|input| *input).count();
                std::iter::repeat_n(Cause { leg: number, section }, count)
            })
        };
        let lower_rows = rows_of(Section::Lower).count();
        let rows = rows_of(Section::Lower).chain(rows_of(Section::Upper)).collect();
        let upper_basis = task.upper.kind.basis();
        Self { cuts, cut_count, lower_basis, upper_basis, rows, lower_rows }
    }

    /// Columns of the lower section: all but the upper one's twist.
    fn lower_columns(&self) -> usize {
        self.cut_count + self.lower_basis.len()
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::measure_singularities`].
    pub fn singularities(&self) -> Singularities {
        let layout = Layout::new(self);
        let columns = layout.lower_columns() + layout.upper_basis.len();
        let size = layout.rows.len().max(columns).max(self.task_coordinates().len());
        Singularities {
            upper: Measures::default(),
            lower: Measures::default(),
            whole: Measures::default(),
            legs: vec![[1.0; 2]; self.legs.len()],
            coordinates: 1.0,
            closure: DMatrix::zeros(layout.rows.len(), columns),
            layout,
            work: DMatrix::zeros(size, size),
        }
    }

    /// The measures of singularity at the pose of `jacobians`. Nothing is allocated.
    pub fn measure_singularities(&self, jacobians: &Jacobians, out: &mut Singularities) {
        let (mut lower, mut upper) = (1.0, 1.0);
        for (measures, leg) in out.legs.iter_mut().zip(&jacobians.legs) {
            *measures = [leg.lower.measure, leg.upper.measure];
            lower *= measures[0];
            upper *= measures[1];
        }
        self.close(jacobians, out);
        let Singularities { closure, layout, work, .. } = &mut *out;
        let (rows, columns) = closure.shape();
        let (middle, lower_columns) = (layout.lower_rows, layout.lower_columns());
        let lower_parallel = volume(closure, [0, middle], [0, lower_columns], work);
        let upper_parallel = volume(closure, [middle, rows], [lower_columns, columns], work);
        let whole_parallel = volume(closure, [0, rows], [0, columns], work);
        let n = jacobians.pose.nrows();
        let coordinates = volume(&jacobians.pose, [0, n], [0, n], work);
        out.lower = Measures { serial: lower, parallel: lower_parallel };
        out.upper = Measures { serial: upper, parallel: upper_parallel };
        out.whole = Measures { serial: lower * upper, parallel: whole_parallel };
        out.coordinates = coordinates.unwrap_or(0.0);
    }

    /// The leg and section whose serial measure is the smallest: what causes a serial singularity where
    /// there is one, what comes nearest to it elsewhere.
    pub fn serial_cause(&self, measured: &Singularities, section: Section) -> Option<Cause> {
        let of = |measures: &[f64; 2]| match section {
            Section::Lower => measures[0].abs(),
            Section::Upper => measures[1].abs(),
        };
        let legs = measured.legs.iter().enumerate();
        let (leg, _) = legs.min_by(|(_, a), (_, b)| of(a).total_cmp(&of(b)))?;
        Some(Cause { leg, section })
    }

    /// The legs that cause a parallel singularity of a section, or come nearest to one: those whose
    /// imaginary joints move by themselves with the inputs locked; where the platform moves with
    /// them, those whose inputs hold the same motion. None where it has no measure.
    pub fn parallel_causes(&self, measured: &Singularities, section: Section) -> Vec<Cause> {
        let Singularities { closure, layout, .. } = measured;
        let (rows, columns) = closure.shape();
        let (middle, split) = (layout.lower_rows, layout.lower_columns());
        let (start, block) = match section {
            Section::Lower => (0, closure.view((0, 0), (middle, split))),
            Section::Upper => {
                (middle, closure.view((middle, split), (rows - middle, columns - split)))
            }
        };
        if block.nrows() < block.ncols() || block.ncols() == 0 {
            return vec![];
        }
        let weakest = |matrix: DMatrix<f64>| {
            let svd = Svd::new(matrix);
            svd.right.column(svd.right.ncols() - 1).into_owned()
        };
        let involved = |weights: &[f64]| {
            let largest = weights.iter().fold(0.0_f64, |l, w| l.max(w.abs()));
            let share = INVOLVED * largest;
            let numbers = weights.iter().enumerate().filter(move |(_, w)| w.abs() > share);
            numbers.map(|(number, _)| number).collect::<Vec<_>>()
        };
        let moving = involved(weakest(block.into_owned()).as_slice());
        let by_itself = |column: &usize| section == Section::Lower && *column < layout.cut_count;
        let mut causes: Vec<Cause> = if moving.iter().all(by_itself) {
            let of = |column: &usize| layout.cuts.iter().position(|cut| *cut == Some(*column));
            moving.iter().filter_map(of).map(|leg| Cause { leg, section }).collect()
        } else if block.nrows() == block.ncols() {
            let dependent = involved(weakest(block.transpose()).as_slice());
            dependent.iter().map(|row| layout.rows[start + row]).collect()
        } else {
            layout.rows[start..start + block.nrows()].to_vec()
        };
        causes.dedup();
        causes
    }

    /// Fills the closure.
    fn close(&self, Jacobians { legs, v, cuts, .. }: &Jacobians, out: &mut Singularities) {
        let Singularities { closure, layout, .. } = out;
        closure.fill(0.0);
        let task = self.task();
        let length = self.characteristic_length();
        let split = layout.lower_columns();
        let along = v.adjoint(&task.lower_intersection.unit_twist());
        let upper_along = task.upper_intersection.unit_twist();
        let mut row = 0;
        for (number, (leg, differential)) in self.legs.iter().zip(legs).enumerate() {
            let kind = task.lower.kind;
            let (rows, count) = section_rows(leg, Section::Lower, &differential.lower, length);
            let cut = cut_unit(leg, task.lower_intersection, length) / row_unit(kind, length);
            for w in &rows[..count] {
                if let Some(column) = layout.cuts[number] {
                    closure[(row, column)] = match leg.cut {
                        Section::Upper => cut * w.dot(&along),
                        Section::Lower => {
                            let last = leg.lower.chain.freedoms() - 1;
                            -cut * w.dot(&differential.lower.screws.moved[last])
                        }
                    };
                }
                for (i, twist) in layout.lower_basis.iter().enumerate() {
                    closure[(row, layout.cut_count + i)] =
                        w.dot(&v.adjoint(twist)) * twist_unit(kind, twist, length);
                }
                row += 1;
            }
        }
        for (number, (leg, differential)) in self.legs.iter().zip(legs).enumerate() {
            let (rows, count) = section_rows(leg, Section::Upper, &differential.upper, length);
            let kind = task.upper.kind;
            let cut = cut_unit(leg, task.lower_intersection, length) / row_unit(kind, length);
            for w in &rows[..count] {
                if let Some(column) = layout.cuts[number] {
                    closure[(row, column)] = match leg.cut {
                        Section::Upper => -cut * w.dot(&upper_along),
                        Section::Lower => cut * w.dot(&upper_along),
                    };
                }
                for (i, twist) in layout.upper_basis.iter().enumerate() {
                    let carried = match leg.cut {
                        Section::Upper => *twist,
                        Section::Lower => {
                            let amount = cuts[number].inverse();
                            task.upper_intersection.adjoint(amount, twist)
                        }
                    };
                    closure[(row, split + i)] = w.dot(&carried) * twist_unit(kind, twist, length);
                }
                row += 1;
            }
        }
    }
}
