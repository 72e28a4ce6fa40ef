//! The Jacobians of the upper section, of the lower section, of the whole mechanism, and of the task
//! coordinates.

use super::dependent::System;
use super::whole::WholeDifferential;
use super::{LegDifferential, SingularLeg, VelocityError};
use crate::group::{Displacement, JointDisplacement, LocalTwist, MotionType, Subspace};
use crate::manipulator::{Lean, Manipulator, Section, Solution};
use crate::task::{Height, Task};
use nalgebra::{DMatrix, Matrix6xX, Point3, Vector3};

/// The Jacobians at one solved pose. The buffer is made by [`Manipulator::jacobians`] and filled by
/// [`Manipulator::differentiate`].
///
/// Columns are components of the *section twist* `(upper; lower)`. They do not depend on the task
/// coordinates, so that the singularities of these are in [`Jacobians::pose`] alone:
///
/// * `upper`: the twist `ḃ b⁻¹` of the upper section, in the frame of [`Task::upper`]: `ω` (x, y, z)
///   in a sphere; `ω` about the normal, `v` along the frame's x and y in a plane; `ω` about the axis,
///   `v` along it on a cylinder; `v` along x and y in a translational plane. Where the intersection
///   motion is a translation, the component along it is left out.
/// * `lower`: the twist `v⁻¹ v̇` of the lower section, in the frame of [`Task::lower`] as it has
///   moved with `v`, of the same form. Where the intersection motion is a rotation, the
///   component along it is left out. In a plane that is the velocity of the frame's centre.
/// * the rate of the height, if one of the two is a Schoenflies section.
///
/// Rates are those of the coordinates as they are reported: rad/s and m/s.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mode, mut buffer) = (manipulator.home_mode(), manipulator.solution());
/// let mut pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
/// let at = manipulator.inverse(&pose, mode, &mut buffer)?.expect("a pose in reach");
/// let mut jacobians = manipulator.jacobians();
/// assert!(manipulator.differentiate(at, &mut jacobians)?);
/// let rates = jacobians.joints_by_pose(); // a row for each joint, a column for each coordinate
///
/// // The first column is the derivative of all joints by x: compare a central difference.
/// let (x, step) = (pose[0], 1e-5);
/// let mut joints_at = |x: f64| {
///     pose[0] = x;
///     let solution = manipulator.inverse(&pose, mode, &mut buffer).unwrap();
///     solution.expect("a pose in reach").joints().to_vec()
/// };
/// for (i, (after, before)) in joints_at(x + step).iter().zip(joints_at(x - step)).enumerate() {
///     assert!(((after - before) / (2.0 * step) - rates[(i, 0)]).abs() < 1e-6);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Jacobians {
    /// `J_s` (Eqs. 8-9): rates along the intersection motion from the upper section's twist. It has a row for every leg
    /// that is split in its upper section ([`Jacobians::bridged`]), with the sign of the leg's imaginary joint
    /// if it has one. These rates are relative to a lower section that does not move along the intersection
    /// motion. Some task coordinates make it do so (`mu nu` of a tilt, `w phi` of an upper plane). The rate
    /// that is reported, [`JointMotion::imaginary_rates`](super::JointMotion), then includes that motion.
    pub upper: DMatrix<f64>,
    /// `J_p` (Eq. 23): rates of the actuated joints in the lower section ([`Jacobians::lower_rows`]) from
    /// the rates along the intersection motion, in the order of the rows of [`Jacobians::upper`], and the lower section's
    /// twist, at constant height. The joints that carry a height have no row here: they follow the height and, if that
    /// motion is inclined, the rates along it.
    pub lower: DMatrix<f64>,
    /// Rates of every joint coordinate, in the order of [`Manipulator::coordinates`], from the section
    /// twist. For the actuated joints of the lower section `q̇ = J_p [J_s upper; lower]`.
    pub joints: DMatrix<f64>,
    /// The section twist from the rates of all task coordinates, dependent ones too, a square matrix. It is singular where the
    /// coordinates are (Euler angles at `xi = 0`), for every mechanism.
    pub pose: DMatrix<f64>,
    /// The platform's twist `(ω; v)` from the section twist. `v` is the velocity of the platform's reference
    /// point. The axes are those of the base after the displacement `v` of the lower section.
    pub platform: Matrix6xX<f64>,
    /// The rates of the joints that constraining legs lack, from the section twist: they are zero where the
    /// platform moves as these legs let it. It has a row for each dependent coordinate.
    pub locked: DMatrix<f64>,
    /// The rates of all task coordinates from those of the independent ones, where some are dependent.
    by_independent: Option<DMatrix<f64>>,
    /// The determinant of the locked joints' rates by the dependent coordinates, dimensionless; one where there are
    /// none. It is zero where these do not follow from the others.
    pub(super) dependence: f64,
    /// The legs with joints that have no rates. The rows of these joints are zeros without a meaning.
    pub singular: Vec<SingularLeg>,
    /// The numbers of the legs that are split in their upper section: the rows of [`Jacobians::upper`].
    pub bridged: Vec<usize>,
    /// The numbers of the joint coordinates that are rows of [`Jacobians::lower`], ascending.
    pub lower_rows: Vec<usize>,
    /// For each leg, its row in [`Jacobians::upper`].
    bridges: Vec<Option<usize>>,
    /// For each joint coordinate, its row in [`Jacobians::lower`].
    driven: Vec<Option<usize>>,
    /// The components of the section twist.
    basis: Basis,
    /// The differentials of every leg.
    pub(super) legs: Vec<LegDifferential>,
    /// The differentials of legs that are solved whole; empty where legs are split.
    pub(super) whole: Vec<WholeDifferential>,
    /// For each leg, the displaced screw of what its lift does in the plane for a unit of height; zeros where it does
    /// nothing there.
    pub(super) leans: Vec<LocalTwist>,
    /// The displacement of the lower section.
    pub(super) v: Displacement,
    /// Every leg's displacement along the intersection motion.
    pub(super) taus: Vec<JointDisplacement>,
}

/// The unit twists that are the components of the section twist.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    /// The components of the upper section, in its frame.
    pub upper: [LocalTwist; 3],
    /// The components of the lower section, in its frame.
    pub lower: [LocalTwist; 3],
    /// The numbers of upper and of lower components; the rest are zeros.
    pub counts: [usize; 2],
    /// The same twists in base coordinates, upper ones first, and a height's at last.
    pub in_base: Vec<BaseTwist>,
    /// The home position of the platform's reference point, in the upper section's frame.
    pub platform: Vector3<f64>,
}

/// A twist in base directions.
#[derive(Clone, Debug)]
pub(super) struct BaseTwist {
    /// The angular velocity.
    pub angular: Vector3<f64>,
    /// The velocity of the point at `origin`.
    pub linear: Vector3<f64>,
    /// A point, in base coordinates, metres.
    pub origin: Vector3<f64>,
}

impl Basis {
    pub fn new(task: &Task, platform: &Point3<f64>) -> Self {
        let (kept, rest) = (task.upper.kind.basis(), task.lower.kind.basis());
        let rotation = task.shared() == Some(MotionType::Rotation);
        let upper = if rotation { kept } else { task.upper_intersection.complement() };
        let lower = if rotation { task.lower_intersection.complement() } else { rest };
        let embedded = |subspace: &Subspace, twist: &LocalTwist| {
            let [angular, linear] = subspace.embedded(twist);
            BaseTwist { angular, linear, origin: subspace.origin.coords }
        };
        let rise = task.height.iter().map(|height| BaseTwist {
            angular: Vector3::zeros(),
            linear: height.up,
            origin: Vector3::zeros(),
        });
        let in_base = (upper.iter().map(|twist| embedded(&task.upper, twist)))
            .chain(lower.iter().map(|twist| embedded(&task.lower, twist)))
            .chain(rise)
            .collect();
        let padded = |twists: &[LocalTwist]| {
            std::array::from_fn(|i| twists.get(i).copied().unwrap_or_else(LocalTwist::zeros))
        };
        Self {
            counts: [upper.len(), lower.len()],
            upper: padded(&upper),
            lower: padded(&lower),
            in_base,
            platform: task.upper.point(platform),
        }
    }
}

/// The joints whose rates are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rows {
    All,
    /// Those of actuated and of locked joints. Other rows have no meaning, nor have the differentials of the legs.
    Driven,
}

/// Twists of the lower section after its displacement `v`.
struct Moved {
    /// The unit twist of the intersection motion.
    along: LocalTwist,
    /// The lower components of the section twist.
    lower: [LocalTwist; 3],
}

impl Jacobians {
    /// Rates of every joint coordinate, in the order of [`Manipulator::coordinates`], for unit rates of
    /// the task coordinates: a row for each joint, a column for each task coordinate. They are NaN where dependent
    /// coordinates do not follow from the others ([`Singularities::coordinates`](super::Singularities::coordinates)
    /// is zero). The product is allocated.
    pub fn joints_by_pose(&self) -> DMatrix<f64> {
        let by_all = &self.joints * &self.pose;
        match &self.by_independent {
            Some(rates) => by_all * rates,
            None => by_all,
        }
    }

    /// The components of the section twist, in the order of the columns: for each, the twists of the upper
    /// and of the lower section, in the sections' frames. A height, which has the last column, is not among them.
    pub(crate) fn directions(&self) -> impl Iterator<Item = [LocalTwist; 2]> + '_ {
        let zero = LocalTwist::zeros();
        let [n_upper, n_lower] = self.basis.counts;
        let upper = self.basis.upper[..n_upper].iter().map(move |twist| [*twist, zero]);
        upper.chain(self.basis.lower[..n_lower].iter().map(move |twist| [zero, *twist]))
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::differentiate`]. Its matrices are zeros until then.
    pub fn jacobians(&self) -> Jacobians {
        let task = self.task();
        let basis = Basis::new(task, &self.mechanism().platform);
        let mut bridged = Vec::new();
        let mut bridges = vec![None; self.legs.len()];
        let mut lower_rows = Vec::new();
        for (number, leg) in self.legs.iter().enumerate() {
            if leg.bridge() == Some(Section::Upper) {
                bridges[number] = Some(bridged.len());
                bridged.push(number);
            }
            // A leg that is solved whole has no lower section.
            let coordinates =
                leg.lower.coordinates.iter().filter(|_| leg.whole.is_none()).flatten();
            lower_rows.extend(coordinates.filter(|c| c.actuated.is_some()).map(|c| c.number));
        }
        lower_rows.sort_unstable();
        let joints = self.coordinates().len();
        let mut driven = vec![None; joints];
        for (row, &coordinate) in lower_rows.iter().enumerate() {
            driven[coordinate] = Some(row);
        }
        let (n_upper, n_lower, n) = (basis.counts[0], basis.counts[1], basis.in_base.len());
        let home = self.solution();
        Jacobians {
            upper: DMatrix::zeros(bridged.len(), n_upper),
            lower: DMatrix::zeros(lower_rows.len(), bridged.len() + n_lower),
            joints: DMatrix::zeros(joints, n),
            pose: DMatrix::zeros(n, n),
            platform: Matrix6xX::zeros(n),
            locked: DMatrix::zeros(self.dependent_coordinates().len(), n),
            by_independent: self
                .dependent
                .as_ref()
                .map(|dependent| DMatrix::zeros(n, dependent.independent.len())),
            dependence: 1.0,
            singular: Vec::with_capacity(self.legs.len()),
            bridged,
            lower_rows,
            bridges,
            driven,
            basis,
            legs: (0..self.legs.len()).map(|number| self.leg_differential(&home, number)).collect(),
            leans: vec![LocalTwist::zeros(); self.legs.len()],
            whole: match self.is_whole() {
                true => vec![WholeDifferential::unknown(); self.legs.len()],
                false => Vec::new(),
            },
            v: home.solved.v,
            taus: home.legs.iter().map(|leg| leg.tau).collect(),
        }
    }

    /// Computes the Jacobians at a solved pose. Returns `false` if some joints have no rates: `out.singular`
    /// lists the legs. The rows of all other joints are valid in any case. Nothing is allocated.
    ///
    /// # Errors
    /// If the solution is out of reach.
    pub fn differentiate(&self, at: &Solution, out: &mut Jacobians) -> Result<bool, VelocityError> {
        if !at.unreachable.is_empty() {
            return Err(VelocityError::OutOfReach);
        }
        let regular = self.differentiate_joints(at, Rows::All, out);
        self.pose_columns(at, out);
        self.platform_columns(at, out);
        self.independent_columns(out);
        Ok(regular)
    }

    /// The platform's twist `(ω; v)` for unit rates of the task coordinates at the pose of `jacobians`: a column for each.
    /// `ω` is the angular velocity and `v` the velocity of the platform's reference point, both in base directions, rad/s
    /// and m/s. They are NaN where dependent coordinates do not follow from the others. The product is allocated.
    pub fn twist_by_pose(&self, jacobians: &Jacobians) -> Matrix6xX<f64> {
        let mut by_all = &jacobians.platform * &jacobians.pose;
        let lower = self.task().lower.isometry(&jacobians.v).rotation;
        for mut column in by_all.column_iter_mut() {
            for first in [0, 3] {
                let turned = lower * column.fixed_rows::<3>(first).into_owned();
                column.fixed_rows_mut::<3>(first).copy_from(&turned);
            }
        }
        match &jacobians.by_independent {
            Some(rates) => by_all * rates,
            None => by_all,
        }
    }

    /// Computes the rates of the joints alone, at a pose that is in reach. [`Jacobians::pose`] and
    /// [`Jacobians::platform`] are not computed. Returns `false` if some joints have no rates.
    #[inline(always)]
    pub(crate) fn differentiate_joints(
        &self,
        at: &Solution,
        rows: Rows,
        out: &mut Jacobians,
    ) -> bool {
        out.singular.clear();
        out.v = at.solved.v;
        if self.is_whole() {
            self.platform_columns(at, out);
            let regular = self.whole_rows(at, rows, out);
            self.held_rows(at, out);
            return regular;
        }
        let task = self.task();
        let along = at.solved.v.adjoint(&task.lower_intersection.unit_twist());
        let lower = out.basis.lower.map(|twist| at.solved.v.adjoint(&twist));
        let moved = Moved { along, lower };
        for number in 0..self.legs.len() {
            let differential = self.differential_for(rows, at, number);
            let leg = &self.legs[number];
            if let Some(lean) = &leg.lean {
                let displacements = at.legs[number].section(lean.section);
                out.leans[number] = lean.moved_screw(leg, displacements);
            }
            let tau_rates = if self.note_singular(number, &differential, &mut out.singular) {
                self.leg_rows(number, rows, (&differential, at.legs[number].tau), &moved, out)
            } else {
                self.clear_rows(number, out);
                [0.0; 6]
            };
            if rows == Rows::All || leg.lean.is_some() {
                out.legs[number] = differential;
            }
            out.taus[number] = at.legs[number].tau;
            if let Some(lift) = &leg.lift {
                // The height has the last column. It does not move the imaginary joint.
                let height = out.basis.in_base.len() - 1;
                let row = lift.coordinate.number;
                for (column, rate) in tau_rates[..height].iter().enumerate() {
                    out.joints[(row, column)] = lift.displacement(lift.slope * rate);
                }
                out.joints[(row, height)] = lift.displacement(1.0);
            }
            if let Some(lean) = &leg.lean {
                self.lean_column(number, lean, &moved, out);
            }
        }
        out.singular.is_empty()
    }

    /// Computes the rates of a leg's joints for a unit rate of the height, where its lift leans: the other joints of the
    /// section take back what the lift does in the plane.
    #[cold]
    fn lean_column(&self, number: usize, lean: &Lean, moved: &Moved, out: &mut Jacobians) {
        let (leg, column) = (&self.legs[number], out.basis.in_base.len() - 1);
        let LegDifferential { lower, upper } = out.legs[number];
        let none = LocalTwist::zeros();
        let own = -out.leans[number];
        let [own_lower, own_upper] = match lean.section {
            Section::Lower => [own, none],
            Section::Upper => [none, own],
        };
        let [lower, upper] = match leg.split_section {
            Section::Upper => {
                let rates = upper.rates(&own_upper);
                let tau = leg.imaginary_joint().map_or(0.0, |joint| rates[joint]);
                [lower.rates(&(own_lower + moved.along * tau)), rates]
            }
            Section::Lower => {
                let rates = lower.rates(&own_lower);
                let along = self.task().upper_intersection.unit_twist();
                let step = leg.imaginary_joint().map_or(0.0, |joint| rates[joint]);
                [rates, upper.rates(&(own_upper + along * step))]
            }
        };
        for (section, rates) in [(&leg.lower, &lower), (&leg.upper, &upper)] {
            for (coordinate, rate) in section.coordinates.iter().zip(rates) {
                let Some(coordinate) = coordinate else { continue };
                out.joints[(coordinate.number, column)] = *rate;
            }
        }
        let locked = self.dependent.iter().flat_map(|dependent| dependent.locked(&self.legs));
        for (row, (_, section, joint)) in locked.enumerate().filter(|(_, (leg, ..))| *leg == number)
        {
            let rates = if section == Section::Lower { &lower } else { &upper };
            out.locked[(row, column)] = rates[joint];
        }
    }

    /// Fills the rows of a leg with zeros.
    fn clear_rows(&self, number: usize, out: &mut Jacobians) {
        if let Some(bridge) = out.bridges[number] {
            out.upper.row_mut(bridge).fill(0.0);
        }
        let leg = &self.legs[number];
        for coordinate in leg.lower.coordinates.iter().chain(&leg.upper.coordinates).flatten() {
            out.joints.row_mut(coordinate.number).fill(0.0);
            if let Some(row) = out.driven[coordinate.number] {
                out.lower.row_mut(row).fill(0.0);
            }
        }
    }

    /// Computes the rows of a leg, and returns the rates along the intersection motion for each component of the section
    /// twist.
    #[inline(always)]
    fn leg_rows(
        &self,
        number: usize,
        wanted: Rows,
        (LegDifferential { lower, upper }, tau): (&LegDifferential, JointDisplacement),
        moved: &Moved,
        out: &mut Jacobians,
    ) -> [f64; 6] {
        let task = self.task();
        let leg = &self.legs[number];
        let sign = leg.imaginary.map_or(1.0, |i| self.imaginary()[i].sign);
        let [n_upper, n_lower] = out.basis.counts;
        // Rates of the imaginary joint in its chain for each component of the section twist. In the section that is solved
        // second, they add to the twist: `carried` is the twist of a unit rate. `τ` grows in the sense `forward`.
        let mut along = [0.0; 6];
        let (upper_twists, mut carried, forward) = match leg.split_section {
            Section::Upper => {
                if let Some(bridge) = out.bridges[number] {
                    for (i, twist) in out.basis.upper[..n_upper].iter().enumerate() {
                        along[i] = upper.rate(0, twist);
                        out.upper[(bridge, i)] = sign * along[i];
                    }
                }
                (out.basis.upper, moved.along, 1.0)
            }
            Section::Lower => {
                let last = leg.lower.chain.freedoms() - 1;
                for (i, twist) in moved.lower.iter().enumerate() {
                    along[n_upper + i] = lower.rate(last, twist);
                }
                let inverse = tau.inverse();
                let carried = |twist: LocalTwist| task.upper_intersection.adjoint(inverse, &twist);
                (out.basis.upper.map(carried), task.upper_intersection.unit_twist(), -1.0)
            }
        };
        if leg.lean.is_some() {
            // A lift that leans takes a part back, where the imaginary joint has a part in the height.
            carried -= out.leans[number] * (forward * task.slope());
        }
        let (n, bridges, joints) = (n_upper + n_lower, out.bridged.len(), out.joints.nrows());
        if let Some(dependent) = &self.dependent {
            for (row, (_, section, joint)) in
                dependent.locked(&self.legs).enumerate().filter(|(_, (leg, ..))| *leg == number)
            {
                let (own, start, differential) = match section {
                    Section::Upper => (&upper_twists, 0, upper),
                    Section::Lower => (&moved.lower, n_upper, lower),
                };
                let other = section != leg.split_section;
                let by_along = if other { differential.rate(joint, &carried) } else { 0.0 };
                let mut rates = along.map(|rate| by_along * rate);
                for (i, twist) in own.iter().enumerate() {
                    rates[start + i] += differential.rate(joint, twist);
                }
                (0..n).for_each(|i| out.locked[(row, i)] = rates[i]);
            }
        }
        let rows = out.lower.nrows();
        for (section, compiled, differential) in
            [(Section::Upper, &leg.upper, upper), (Section::Lower, &leg.lower, lower)]
        {
            let (own, start) = match section {
                Section::Upper => (&upper_twists, 0),
                Section::Lower => (&moved.lower, n_upper),
            };
            for (coordinate, joint) in compiled.coordinates.iter().zip(0..) {
                let Some(coordinate) = coordinate else { continue };
                if wanted == Rows::Driven && coordinate.actuated.is_none() {
                    continue;
                }
                let row = coordinate.number;
                let by_along = if section == leg.split_section {
                    0.0
                } else {
                    differential.rate(joint, &carried)
                };
                let mut rates = along.map(|rate| by_along * rate);
                for (i, twist) in own.iter().enumerate() {
                    rates[start + i] += differential.rate(joint, twist);
                }
                // The matrices are stored by columns.
                let entries = out.joints.as_mut_slice();
                for (i, rate) in rates[..n].iter().enumerate() {
                    entries[i * joints + row] = *rate;
                }
                let Some(row) = out.driven[row].filter(|_| section == Section::Lower) else {
                    continue;
                };
                if let Some(bridge) = out.bridges[number] {
                    out.lower[(row, bridge)] = sign * by_along;
                }
                let entries = &mut out.lower.as_mut_slice()[bridges * rows..];
                for i in 0..n - n_upper {
                    // For a leg that is split in its upper section, the rate along the intersection motion has a column of its
                    // own, and does not depend on the lower section's twist.
                    entries[i * rows + row] = rates[n_upper + i];
                }
            }
        }
        along.map(|rate| forward * rate)
    }

    /// Computes the rates of the dependent coordinates for a unit rate of each independent one, NaN where they are
    /// not determined.
    fn independent_columns(&self, out: &mut Jacobians) {
        let (Some(dependent), Some(columns)) = (&self.dependent, &mut out.by_independent) else {
            return;
        };
        columns.fill(0.0);
        let count = dependent.coordinates.len();
        // The rates of the locked joints by a coordinate.
        let rates = |coordinate: usize| -> [f64; 6] {
            let column = out.pose.column(coordinate);
            std::array::from_fn(|row| {
                let terms = column.iter().enumerate().map(|(i, by)| out.locked[(row, i)] * by);
                if row < count { terms.sum() } else { 0.0 }
            })
        };
        let mut matrix = [[0.0; 6]; 6];
        for (column, &coordinate) in dependent.coordinates.iter().enumerate() {
            let rates = rates(coordinate);
            (0..count).for_each(|row| matrix[row][column] = rates[row]);
        }
        let system = System::new(&matrix, self.dependent_units(), count);
        out.dependence = system.determinant();
        for (column, &coordinate) in dependent.independent.iter().enumerate() {
            columns[(coordinate, column)] = 1.0;
            let right = rates(coordinate).map(|rate| -rate);
            let Some(found) = system.solve(right) else {
                columns.fill(f64::NAN);
                return;
            };
            for (&coordinate, rate) in dependent.coordinates.iter().zip(found) {
                columns[(coordinate, column)] = rate;
            }
        }
    }

    /// Computes the section twist for a unit rate of each task coordinate.
    fn pose_columns(&self, at: &Solution, out: &mut Jacobians) {
        let task = self.task();
        let pose = &at.solved.pose;
        let v = &at.solved.v;
        let n_upper = out.basis.counts[0];
        let n = pose.len();
        let rotation = task.shared() == Some(MotionType::Rotation);
        let lower_along = task.lower_intersection.unit_twist();
        let upper_along = task.upper_intersection.unit_twist();
        let upper_reciprocal = match rotation {
            true => LocalTwist::zeros(),
            false => task.upper_intersection.reciprocal(),
        };
        let (v_screws, b_screws) = (task.lower_screws(pose), task.upper_screws(pose));
        if let Some(height) = &task.height {
            out.pose.fill(0.0);
            out.pose[(n - 1, height.coordinate)] = 1.0;
        }
        let of = |section: Section| {
            task.in_plane(section, task.range(section))
                .enumerate()
                .map(move |(i, n)| (section, i, n))
        };
        for (section, component, column) in of(Section::Lower).chain(of(Section::Upper)) {
            let (mut lower, mut upper) = (LocalTwist::zeros(), LocalTwist::zeros());
            let mut along = 0.0;
            let rates = task.screw_rates(section, LocalTwist::ith(component, 1.0));
            match section {
                Section::Lower => lower = v.adjoint_of_inverse(&v_screws.twist(&rates)),
                Section::Upper => upper = b_screws.twist(&rates),
            }
            // A rate along the intersection motion may belong to either section. It is moved to the section
            // that has a component for it.
            if rotation {
                upper += upper_along * lower.dot(&lower_along);
            } else {
                along = upper.dot(&upper_reciprocal);
                lower += lower_along * along;
            }
            let entries = &mut out.pose.as_mut_slice()[column * n..(column + 1) * n];
            for (entry, twist) in entries.iter_mut().zip(&out.basis.upper[..n_upper]) {
                *entry = upper.dot(twist);
            }
            for (entry, twist) in entries[n_upper..].iter_mut().zip(&out.basis.lower) {
                *entry = lower.dot(twist);
            }
            // The upper section has the part of an inclined motion in the plane: the height gets the rest.
            if let Some(height) = &task.height {
                out.pose[(n - 1, column)] = height.slope * along;
            }
        }
    }

    /// Computes the platform's twist for each component of the section twist.
    fn platform_columns(&self, at: &Solution, out: &mut Jacobians) {
        // In a frame that moves with v, the reference point is displaced by b.
        let task = self.task();
        let mut point = task.upper.restored(&at.solved.b.act(&out.basis.platform)).coords;
        // The height of a lower section moves that frame.
        if let Some(Height { section: Section::Upper, up, .. }) = &task.height {
            point += up * task.rise(&at.solved.pose);
        }
        for (i, BaseTwist { angular, linear, origin }) in out.basis.in_base.iter().enumerate() {
            let velocity = linear + angular.cross(&(point - origin));
            let column = &mut out.platform.as_mut_slice()[6 * i..6 * i + 6];
            column[..3].copy_from_slice(angular.as_slice());
            column[3..].copy_from_slice(velocity.as_slice());
        }
    }
}
