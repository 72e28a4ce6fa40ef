//! Singularities, by section.
//!
//! Each section is a parallel mechanism of its own. The upper section moves the platform relative to a
//! frame that follows `v`. Its inputs are the imaginary joints, and its actuated joints if it has any. The
//! lower section is driven by the actuated joints, and its outputs are the imaginary joints and `v`. Both
//! decide whether the whole mechanism is singular, `q̇ = J_p [J_s ω; Ṗ]`.
//!
//! *Serial singularity*: the screws of a leg's section are dependent, `det S = 0`, and the platform cannot
//! move in every direction. In the paper's first manipulator the measures are `u · (v × w)` of a leg in the
//! upper section, and `V · n(α)` of a slider leg and `sin φ₂₄` of the arm in the lower section.
//!
//! *Parallel singularity*: the section can move while all its inputs are locked. The screws reciprocal to
//! the passive joints of a leg give the constraints of its locked inputs. They turn the closure into
//! `J_x ẋ = J_q q̇`, which has one row for each input, no poles and no inverse (Eqs. 7 and 23). The measure is
//! `det J_x`. In the same manipulator it is the determinant of the three `v × w`, and the product of the
//! three `V · n(θ)`.
//!
//! All measures are continuous and dimensionless. They vanish at the singularity and change sign across it,
//! within one working mode as well as from one mode to the next. Lengths are divided by constant lengths of
//! the mechanism: that of a link, or the characteristic length. Only a change of sign has a meaning; the
//! signs themselves depend on the directions of the sections' frames.

use super::Jacobians;
use super::closure::{along_unit, inputs, row_unit, section_rows, twist_unit, volume};
use crate::group::LocalTwist;
use crate::manipulator::{CompiledLeg, Manipulator, Section};
use crate::numeric::svd::Svd;
use nalgebra::DMatrix;
use std::ops::Range;

/// A leg counts as a cause of a parallel singularity if its component is more than this share of the
/// largest.
const INVOLVED: f64 = 0.1;

/// The two measures of singularity of a section, or of the whole mechanism; dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// The serial measure: a product over the legs, which is zero if a leg is stretched, folded or flat.
    pub serial: f64,
    /// The parallel measure: the determinant of `J_x`. If there are more inputs than degrees of freedom, it
    /// is the volume of the columns, which has no sign. It is `None` if there are fewer, because locked
    /// inputs then never hold the section.
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
    /// The measures of the upper section.
    pub upper: Measures,
    /// The measures of the lower section.
    pub lower: Measures,
    /// The measures of the whole mechanism. The serial measure is the product of those of the sections. The
    /// parallel measure is the determinant of both closures together, which is the product of the sections'
    /// determinants if both closures are square.
    pub whole: Measures,
    /// The serial measures of every leg, the lower section's first.
    pub legs: Vec<[f64; 2]>,
    /// The determinant of [`Jacobians::pose`], which is zero where the *task coordinates* are singular
    /// (`sin xi` for Euler angles, `cos pitch` for roll, pitch and yaw, `cos nu` for a tilt), or where dependent ones do not
    /// follow from the others (an arm of a five-bar is stretched). The mechanism is not singular there.
    pub coordinates: f64,
    /// The closure of both sections with the inputs locked. It has a row for each input, those of the lower
    /// section first. The columns are the rates along the intersection motion, then the components of the lower section's
    /// twist, then those of the upper section's.
    closure: DMatrix<f64>,
    /// The rows and columns of the closure.
    layout: Layout,
    /// Working memory for determinants.
    work: DMatrix<f64>,
}

/// A section of a leg that causes a singularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cause {
    /// The number of the leg, counted from zero.
    pub leg: usize,
    /// The section of the leg.
    pub section: Section,
}

/// The rows and columns of the closure.
#[derive(Clone, Debug)]
struct Layout {
    /// For each leg, the column of the rate along the intersection motion; `None` if the sections do not move along it.
    along: Vec<Option<usize>>,
    /// The number of those columns.
    along_count: usize,
    /// The components of the lower section's twist, in its frame.
    lower_basis: Vec<LocalTwist>,
    /// The components of the upper section's twist, in its frame.
    upper_basis: Vec<LocalTwist>,
    /// The section that has a height. Its rate is the last column of the section, and each actuated lift has a row after
    /// the section's others.
    height: Option<Section>,
    /// The leg and the section of every row.
    rows: Vec<Cause>,
    /// The number of rows of the lower section, which come first.
    lower_rows: usize,
    /// Where legs are solved whole, the number of all columns: one for each component of the section twist.
    whole: Option<usize>,
}

impl Layout {
    fn new(manipulator: &Manipulator) -> Self {
        let task = manipulator.task();
        let legs = &manipulator.legs;
        if manipulator.is_whole() {
            return Self::of_whole(manipulator);
        }
        let mut along_count = 0;
        let along: Vec<_> = legs
            .iter()
            .map(|leg| {
                let moves = match leg.split_section {
                    Section::Upper => leg.imaginary.is_some(),
                    // The lower section passes that motion on to an upper section that has an actuated joint, or to an
                    // actuated joint that carries a height.
                    Section::Lower => leg.passes_on(),
                };
                moves.then(|| {
                    along_count += 1;
                    along_count - 1
                })
            })
            .collect();
        // If a leg is fixed to the frame between the sections, this frame moves along I as well.
        let fixed =
            legs.iter().any(|leg| leg.split_section == Section::Upper && leg.imaginary.is_none());
        let lower_basis =
            if fixed { task.lower.kind.basis() } else { task.lower_intersection.complement() };
        let height = task.height.as_ref().map(|height| height.section);
        let rows_of = |section: Section| {
            let of_height = height == Some(section);
            let driven = move |leg: &CompiledLeg| of_height && leg.drives_height();
            let lifts = legs.iter().enumerate().filter(move |(_, leg)| driven(leg));
            legs.iter()
                .enumerate()
                .flat_map(move |(number, leg)| {
                    let count = inputs(leg, section).into_iter().filter(|input| *input).count();
                    std::iter::repeat_n(Cause { leg: number, section }, count)
                })
                .chain(lifts.map(move |(leg, _)| Cause { leg, section }))
        };
        let lower_rows = rows_of(Section::Lower).count();
        let rows = rows_of(Section::Lower).chain(rows_of(Section::Upper)).collect();
        let upper_basis = task.upper.kind.basis();
        let whole = None;
        Self { along, along_count, lower_basis, upper_basis, height, rows, lower_rows, whole }
    }

    /// The layout for legs that are solved whole: what sections have counts as the lower one's.
    fn of_whole(manipulator: &Manipulator) -> Self {
        let mut rows = Vec::new();
        for leg in 0..manipulator.legs.len() {
            let own = manipulator.coordinates_of(leg);
            let driven = manipulator.actuated().iter().filter(|number| own.contains(number));
            rows.extend(driven.map(|_| Cause { leg, section: Section::Lower }));
        }
        let mut held: Vec<usize> = manipulator.constraining_legs().map(|(leg, _)| leg).collect();
        if let Some(&last) = held.last() {
            // A stem holds with several wrenches.
            held.resize(manipulator.dependent_coordinates().len(), last);
        }
        rows.extend(held.into_iter().map(|leg| Cause { leg, section: Section::Lower }));
        Self {
            along: vec![None; manipulator.legs.len()],
            along_count: 0,
            lower_basis: Vec::new(),
            upper_basis: Vec::new(),
            height: None,
            lower_rows: rows.len(),
            rows,
            whole: Some(manipulator.task().coordinates.len()),
        }
    }

    /// The number of columns of the lower section: those of the intersection motion, and the section's own twist.
    fn lower_columns(&self) -> usize {
        if let Some(columns) = self.whole {
            return columns;
        }
        self.along_count + self.lower_basis.len() + usize::from(self.height == Some(Section::Lower))
    }

    /// The number of all columns.
    fn columns(&self) -> usize {
        let height = usize::from(self.height == Some(Section::Upper));
        self.lower_columns() + self.upper_basis.len() + height
    }

    /// The place of the height's column, and the rows of the actuated lifts in it.
    fn height_block(&self, lifts: usize) -> Option<(usize, Range<usize>)> {
        let (rows, columns) = match self.height? {
            Section::Lower => (self.lower_rows, self.lower_columns()),
            Section::Upper => (self.rows.len(), self.columns()),
        };
        Some((columns - 1, rows - lifts..rows))
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::measure_singularities`].
    pub fn singularities(&self) -> Singularities {
        let layout = Layout::new(self);
        let columns = layout.columns();
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

    /// Computes the measures of singularity at the pose of `jacobians`. Nothing is allocated.
    pub fn measure_singularities(&self, jacobians: &Jacobians, out: &mut Singularities) {
        let (mut lower, mut upper) = (1.0, 1.0);
        for (number, (measures, leg)) in out.legs.iter_mut().zip(&jacobians.legs).enumerate() {
            *measures = match jacobians.whole.get(number) {
                Some(whole) => [whole.measure, 1.0],
                None => [leg.lower.measure, leg.upper.measure],
            };
            lower *= measures[0];
            upper *= measures[1];
        }
        self.fill_closure(jacobians, out);
        let Singularities { closure, layout, work, .. } = &mut *out;
        let (rows, columns) = closure.shape();
        let (middle, lower_columns) = (layout.lower_rows, layout.lower_columns());
        let lower_parallel = volume(closure, [0, middle], [0, lower_columns], work);
        let upper_parallel = volume(closure, [middle, rows], [lower_columns, columns], work);
        let whole_parallel = volume(closure, [0, rows], [0, columns], work);
        // Legs that are solved whole have no sections.
        let of_section = |parallel: Option<f64>| parallel.filter(|_| layout.whole.is_none());
        let (lower_parallel, upper_parallel) =
            (of_section(lower_parallel), of_section(upper_parallel));
        let n = jacobians.pose.nrows();
        let coordinates = volume(&jacobians.pose, [0, n], [0, n], work);
        out.lower = Measures { serial: lower, parallel: lower_parallel };
        out.upper = Measures { serial: upper, parallel: upper_parallel };
        out.whole = Measures { serial: lower * upper, parallel: whole_parallel };
        out.coordinates = coordinates.unwrap_or(0.0) * jacobians.dependence;
    }

    /// The leg whose section has the smallest serial measure: the cause of a serial singularity, or the leg
    /// that is nearest to one.
    pub fn serial_cause(&self, measured: &Singularities, section: Section) -> Option<Cause> {
        let of = |measures: &[f64; 2]| match section {
            Section::Lower => measures[0].abs(),
            Section::Upper => measures[1].abs(),
        };
        let legs = measured.legs.iter().enumerate();
        let (leg, _) = legs.min_by(|(_, a), (_, b)| of(a).total_cmp(&of(b)))?;
        Some(Cause { leg, section })
    }

    /// The legs that cause a parallel singularity of a section, or that are nearest to one. If only imaginary
    /// joints can move while the inputs are locked, these are the legs of those joints. Otherwise they are
    /// the legs whose inputs constrain the same motion. The list is empty if the section has no parallel
    /// measure.
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
        let is_along = |column: &usize| section == Section::Lower && *column < layout.along_count;
        let mut causes: Vec<Cause> = if moving.iter().all(is_along) {
            let of = |column: &usize| layout.along.iter().position(|along| *along == Some(*column));
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

    /// Computes the closure.
    fn fill_closure(&self, jacobians: &Jacobians, out: &mut Singularities) {
        let Jacobians { legs, v, taus, leans, .. } = jacobians;
        let Singularities { closure, layout, .. } = out;
        closure.fill(0.0);
        if layout.whole.is_some() {
            return self.fill_whole_closure(jacobians, closure);
        }
        let task = self.task();
        let length = self.characteristic_length();
        let split = layout.lower_columns();
        let along = v.adjoint(&task.lower_intersection.unit_twist());
        let upper_along = task.upper_intersection.unit_twist();
        let lifts = self.legs.iter().filter(|leg| leg.drives_height()).count();
        // The rate of the imaginary joint that the columns `along` are for, by that of τ.
        let forward =
            |leg: &CompiledLeg| if leg.split_section == Section::Upper { 1.0 } else { -1.0 };
        let slope = task.slope();
        if let Some((column, rows)) = layout.height_block(lifts) {
            let driven = self.legs.iter().enumerate().filter(|(_, leg)| leg.drives_height());
            for (row, (number, leg)) in rows.zip(driven) {
                closure[(row, column)] = 1.0;
                if let Some(column) = layout.along[number].filter(|_| slope != 0.0) {
                    let unit = along_unit(leg, task.lower_intersection, length) / length;
                    closure[(row, column)] = forward(leg) * slope * unit;
                }
            }
        }
        let height = |section: Section| {
            let block = layout.height_block(lifts).filter(|_| layout.height == Some(section));
            block.map(|(column, _)| column)
        };
        let [height_below, height_above] = [Section::Lower, Section::Upper].map(height);
        let mut row = 0;
        for (number, (leg, differential)) in self.legs.iter().zip(legs).enumerate() {
            let kind = task.lower.kind;
            let (rows, count) = section_rows(leg, Section::Lower, &differential.lower, length);
            let unit = along_unit(leg, task.lower_intersection, length) / row_unit(kind, length);
            for w in &rows[..count] {
                if let Some(column) = layout.along[number] {
                    closure[(row, column)] = match leg.split_section {
                        Section::Upper => unit * w.dot(&along),
                        Section::Lower => {
                            let last = leg.lower.chain.freedoms() - 1;
                            -unit * w.dot(&differential.lower.screws.moved[last])
                        }
                    };
                    if height_below.is_some() {
                        closure[(row, column)] -=
                            forward(leg) * slope * unit * w.dot(&leans[number]);
                    }
                }
                for (i, twist) in layout.lower_basis.iter().enumerate() {
                    closure[(row, layout.along_count + i)] =
                        w.dot(&v.adjoint(twist)) * twist_unit(kind, twist, length);
                }
                if let Some(column) = height_below {
                    closure[(row, column)] = -w.dot(&leans[number]);
                }
                row += 1;
            }
        }
        row = layout.lower_rows;
        for (number, (leg, differential)) in self.legs.iter().zip(legs).enumerate() {
            let (rows, count) = section_rows(leg, Section::Upper, &differential.upper, length);
            let kind = task.upper.kind;
            let unit = along_unit(leg, task.lower_intersection, length) / row_unit(kind, length);
            for w in &rows[..count] {
                if let Some(column) = layout.along[number] {
                    closure[(row, column)] = match leg.split_section {
                        Section::Upper => -unit * w.dot(&upper_along),
                        Section::Lower => unit * w.dot(&upper_along),
                    };
                    if height_above.is_some() {
                        closure[(row, column)] -=
                            forward(leg) * slope * unit * w.dot(&leans[number]);
                    }
                }
                for (i, twist) in layout.upper_basis.iter().enumerate() {
                    let carried = match leg.split_section {
                        Section::Upper => *twist,
                        Section::Lower => {
                            let inverse = taus[number].inverse();
                            task.upper_intersection.adjoint(inverse, twist)
                        }
                    };
                    closure[(row, split + i)] = w.dot(&carried) * twist_unit(kind, twist, length);
                }
                if let Some(column) = height_above {
                    closure[(row, column)] = -w.dot(&leans[number]);
                }
                row += 1;
            }
        }
    }
}
