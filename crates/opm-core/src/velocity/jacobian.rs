//! The Jacobians: of the upper section, of the lower one, of the whole, and of the pose.

use super::local::{Local, planar, quarter};
use super::{LegDifferential, SingularLeg, VelocityError};
use crate::chain::Amount;
use crate::manipulator::{Manipulator, Section, Solution};
use crate::task::{Cut, Displacement, Subspace, SubspaceKind, Task};
use nalgebra::{DMatrix, Matrix6xX, Point3, Vector3};

/// The Jacobians at one solved pose; made by [`Manipulator::jacobians`].
///
/// Columns are components of the *section twist* `(upper; lower)`, whatever the coordinates of the
/// pose are, so that the singularities of these are in [`Jacobians::pose`] alone:
///
/// * `upper`: the twist `ḃ b⁻¹` of the upper section, in the frame of [`Task::upper`]: `ω` (x, y, z)
///   in a sphere; `ω` about the normal, `v` along the frame's x and y in a plane; `ω` about the axis,
///   `v` along it on a cylinder; `v` along x and y in a translational plane. Where the intersection
///   motion is a translation, the component along it is left out.
/// * `lower`: the twist `v⁻¹ v̇` of the lower section, in the frame of [`Task::lower`] as it has
///   moved with `v`, of the same form. Where the intersection motion is a rotation, the
///   component along it is left out. In a plane that is the velocity of the reference point.
///
/// Rates are those of the coordinates as they are reported: rad/s and m/s.
#[derive(Clone, Debug)]
pub struct Jacobians {
    /// `J_s` (Eqs. 8-9): rates along the cuts from the upper section's twist. A row for every leg that
    /// is cut in its upper section ([`Jacobians::bridged`]), with the sign of its imaginary joint
    /// where it has one.
    pub upper: DMatrix<f64>,
    /// `J_p` (Eq. 23): rates of the actuated joints in the lower section ([`Jacobians::lower_rows`])
    /// from those along the cuts, in the order of the rows of [`Jacobians::upper`], and the lower
    /// section's twist.
    pub lower: DMatrix<f64>,
    /// Rates of every joint coordinate, in the order of [`Manipulator::coordinates`], from the section
    /// twist. For the actuated ones of the lower section `q̇ = J_p [J_s upper; lower]`.
    pub joints: DMatrix<f64>,
    /// The section twist from the rates of the task coordinates: square. Singular where the
    /// coordinates are (Euler angles at `xi = 0`), whatever the mechanism.
    pub pose: DMatrix<f64>,
    /// The platform's twist `(ω; v)` from the section twist: `v` is the velocity of the platform's
    /// reference point; axes are the base's as they have moved with `v`.
    pub platform: Matrix6xX<f64>,
    /// Legs with joints without rates: the rows of these are zeros that mean nothing.
    pub singular: Vec<SingularLeg>,
    /// Numbers of the legs that are cut in their upper section: the rows of [`Jacobians::upper`].
    pub bridged: Vec<usize>,
    /// Numbers of the joint coordinates that are rows of [`Jacobians::lower`], ascending.
    pub lower_rows: Vec<usize>,
    /// Every leg's number among the bridged ones.
    bridges: Vec<Option<usize>>,
    /// Every joint coordinate's row in [`Jacobians::lower`].
    driven: Vec<Option<usize>>,
    basis: Basis,
    pub(super) legs: Vec<LegDifferential>,
    /// Where the lower section is.
    pub(super) v: Displacement,
    /// Every leg's displacement along the intersection motion.
    pub(super) cuts: Vec<Amount>,
}

/// The directions that the section twist is measured along.
#[derive(Clone, Debug)]
struct Basis {
    upper: Vec<Local>,
    lower: Vec<Local>,
    /// Each as a twist in base coordinates, upper first: angular part, velocity at a point.
    twists: Vec<([Vector3<f64>; 2], Vector3<f64>)>,
    /// The platform's reference point at home in the upper section's frame.
    platform: Vector3<f64>,
}

impl Basis {
    fn new(task: &Task, platform: &Point3<f64>) -> Self {
        let (kept, rest) = (whole(task.upper.kind), whole(task.lower.kind));
        let rotation = task.cut_point.is_some();
        let upper = if rotation { kept } else { beside(task.upper_cut, task.upper.kind) };
        let lower = if rotation { beside(task.lower_cut, task.lower.kind) } else { rest };
        let in_base =
            |subspace: &Subspace, twist: &Local| (subspace.embedded(twist), subspace.origin.coords);
        let twists = (upper.iter().map(|twist| in_base(&task.upper, twist)))
            .chain(lower.iter().map(|twist| in_base(&task.lower, twist)))
            .collect();
        Self { upper, lower, twists, platform: task.upper.point(platform) }
    }
}

/// All directions of a subspace.
pub(super) fn whole(kind: SubspaceKind) -> Vec<Local> {
    match kind {
        SubspaceKind::Planar | SubspaceKind::Spherical => vec![Local::x(), Local::y(), Local::z()],
        SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => {
            vec![Local::x(), Local::y()]
        }
    }
}

/// All but the intersection motion.
pub(super) fn beside(cut: Cut, kind: SubspaceKind) -> Vec<Local> {
    match (cut, kind) {
        (Cut::Turn, SubspaceKind::Spherical) => vec![Local::x(), Local::y()],
        (Cut::Turn, SubspaceKind::Planar) => vec![Local::y(), Local::z()],
        (Cut::Turn, _) => vec![Local::y()],
        (Cut::Advance, _) => vec![Local::x()],
        (Cut::Slide(along), SubspaceKind::Planar) => {
            vec![Local::x(), planar(0.0, quarter(along))]
        }
        (Cut::Slide(along), _) => {
            let across = quarter(along);
            vec![Local::new(across.re, across.im, 0.0)]
        }
    }
}

impl Jacobians {
    /// The components of the section twist, in the order of the columns: what each does to the upper
    /// section and to the lower one, twists in the sections' frames.
    pub(crate) fn directions(&self) -> Vec<[Local; 2]> {
        let zero = Local::zeros();
        let upper = self.basis.upper.iter().map(|twist| [*twist, zero]);
        upper.chain(self.basis.lower.iter().map(|twist| [zero, *twist])).collect()
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::differentiate`]. Its matrices are zeros before that.
    pub fn jacobians(&self) -> Jacobians {
        let task = self.task();
        let basis = Basis::new(task, &self.mechanism().platform);
        let mut bridged = Vec::new();
        let mut bridges = vec![None; self.legs.len()];
        let mut lower_rows = Vec::new();
        for (number, leg) in self.legs.iter().enumerate() {
            if leg.cut == Section::Upper {
                bridges[number] = Some(bridged.len());
                bridged.push(number);
            }
            let slots = leg.lower.slots.iter().flatten();
            lower_rows.extend(slots.filter(|s| s.drive.is_some()).map(|s| s.coordinate));
        }
        lower_rows.sort_unstable();
        let joints = self.coordinates().len();
        let mut driven = vec![None; joints];
        for (row, &coordinate) in lower_rows.iter().enumerate() {
            driven[coordinate] = Some(row);
        }
        let (n_upper, n_lower) = (basis.upper.len(), basis.lower.len());
        let n = n_upper + n_lower;
        let home = self.solution();
        Jacobians {
            upper: DMatrix::zeros(bridged.len(), n_upper),
            lower: DMatrix::zeros(lower_rows.len(), bridged.len() + n_lower),
            joints: DMatrix::zeros(joints, n),
            pose: DMatrix::zeros(n, n),
            platform: Matrix6xX::zeros(n),
            singular: Vec::with_capacity(self.legs.len()),
            bridged,
            lower_rows,
            bridges,
            driven,
            basis,
            legs: (0..self.legs.len()).map(|number| self.leg_differential(&home, number)).collect(),
            v: home.place.v,
            cuts: home.legs.iter().map(|leg| leg.tau).collect(),
        }
    }

    /// The Jacobians at a solved pose; `false` where a joint has no rates: `out.singular` says in which
    /// legs; the others have theirs. Nothing is allocated.
    ///
    /// # Errors
    /// A solution that is out of reach.
    pub fn differentiate(&self, at: &Solution, out: &mut Jacobians) -> Result<bool, VelocityError> {
        if !at.unreachable.is_empty() {
            return Err(VelocityError::OutOfReach);
        }
        out.singular.clear();
        out.v = at.place.v;
        let task = self.task();
        let along = at.place.v.carried(&task.lower_cut.twist(task.lower.kind));
        let mut lower = [Local::zeros(); 3];
        for (carried, twist) in lower.iter_mut().zip(&out.basis.lower) {
            *carried = at.place.v.carried(twist);
        }
        let lower = &lower[..out.basis.lower.len()];
        for number in 0..self.legs.len() {
            let differential = self.leg_differential(at, number);
            out.legs[number] = differential;
            out.cuts[number] = at.legs[number].tau;
            if self.note_singular(number, &differential, &mut out.singular) {
                self.leg_rows(at, number, lower, &along, out);
            } else {
                self.clear_rows(number, out);
            }
        }
        self.pose_columns(at, out);
        self.platform_columns(at, out);
        Ok(out.singular.is_empty())
    }

    fn clear_rows(&self, number: usize, out: &mut Jacobians) {
        if let Some(bridge) = out.bridges[number] {
            out.upper.row_mut(bridge).fill(0.0);
        }
        let leg = &self.legs[number];
        for slot in leg.lower.slots.iter().chain(&leg.upper.slots).flatten() {
            out.joints.row_mut(slot.coordinate).fill(0.0);
            if let Some(row) = out.driven[slot.coordinate] {
                out.lower.row_mut(row).fill(0.0);
            }
        }
    }

    /// A leg's rows: `along` and `lower` are the cut and the lower basis as they have moved with `v`.
    #[inline]
    fn leg_rows(
        &self,
        at: &Solution,
        number: usize,
        lower: &[Local],
        along: &Local,
        out: &mut Jacobians,
    ) {
        let task = self.task();
        let leg = &self.legs[number];
        let LegDifferential { lower: low, upper: up } = out.legs[number];
        let sign = leg.imaginary.map_or(1.0, |i| self.imaginary()[i].sign);
        let n_upper = out.basis.upper.len();
        // Rates along the cut from each component of the section twist, and what else follows from
        // it in the section that is solved second.
        let mut cut = [0.0; 6];
        let (mut upper, mut carried) = ([Local::zeros(); 3], *along);
        match leg.cut {
            Section::Upper => {
                upper[..n_upper].copy_from_slice(&out.basis.upper);
                let bridge = out.bridges[number].unwrap_or_default();
                for (i, twist) in upper[..n_upper].iter().enumerate() {
                    cut[i] = up.rate(0, twist);
                    out.upper[(bridge, i)] = sign * cut[i];
                }
            }
            Section::Lower => {
                let last = leg.lower.chain.freedoms() - 1;
                for (i, twist) in lower.iter().enumerate() {
                    cut[n_upper + i] = low.rate(last, twist);
                }
                let kind = task.upper.kind;
                let amount = at.legs[number].tau.inverse();
                for (carried, twist) in upper.iter_mut().zip(&out.basis.upper) {
                    *carried = task.upper_cut.carried(kind, amount, twist);
                }
                carried = task.upper_cut.twist(kind);
            }
        }
        let sections = [(&leg.upper, &up, Section::Upper), (&leg.lower, &low, Section::Lower)];
        for (compiled, differential, section) in sections {
            for (slot, joint) in compiled.slots.iter().zip(0..) {
                let Some(slot) = slot else { continue };
                let row = slot.coordinate;
                let own = |i: usize| match section {
                    Section::Upper if i < n_upper => differential.rate(joint, &upper[i]),
                    Section::Lower if i >= n_upper => differential.rate(joint, &lower[i - n_upper]),
                    _ => 0.0,
                };
                let by_cut =
                    if section == leg.cut { 0.0 } else { differential.rate(joint, &carried) };
                for (i, cut) in cut[..n_upper + lower.len()].iter().enumerate() {
                    out.joints[(row, i)] = own(i) + by_cut * cut;
                }
                let Some(row) = out.driven[row].filter(|_| section == Section::Lower) else {
                    continue;
                };
                let bridges = out.bridged.len();
                if let Some(bridge) = out.bridges[number] {
                    out.lower[(row, bridge)] = sign * by_cut;
                }
                for i in 0..lower.len() {
                    out.lower[(row, bridges + i)] = own(n_upper + i);
                }
            }
        }
    }

    /// The section twist for a unit rate of each task coordinate.
    fn pose_columns(&self, at: &Solution, out: &mut Jacobians) {
        let task = self.task();
        let pose = &at.place.pose;
        let v = &at.place.v;
        let n_upper = out.basis.upper.len();
        let rotation = task.cut_point.is_some();
        let lower_along = task.lower_cut.twist(task.lower.kind);
        let upper_along = task.upper_cut.twist(task.upper.kind);
        let (of_v, of_b) = (task.lower_screws(pose), task.upper_screws(pose));
        for column in 0..pose.len() {
            let (mut lower, mut upper) = (Local::zeros(), Local::zeros());
            if column < task.lower_count {
                lower = v.carried_back(&of_v.moved[column]);
            } else {
                upper = of_b.moved[column - task.lower_count];
            }
            // What is along the intersection motion may be given to either section: it goes to the one
            // that has a component for it.
            if rotation {
                upper += upper_along * lower.dot(&lower_along);
            } else {
                lower += lower_along * upper.dot(&upper_along);
            }
            for (i, twist) in out.basis.upper.iter().enumerate() {
                out.pose[(i, column)] = upper.dot(twist);
            }
            for (i, twist) in out.basis.lower.iter().enumerate() {
                out.pose[(n_upper + i, column)] = lower.dot(twist);
            }
        }
    }

    /// The platform's twist for each component of the section twist.
    fn platform_columns(&self, at: &Solution, out: &mut Jacobians) {
        // In a frame that moves with v, the platform's point is b's image of it.
        let upper = &self.task().upper;
        let point = upper.restored(&at.place.b.moved(&out.basis.platform)).coords;
        for (i, ([angular, linear], origin)) in out.basis.twists.iter().enumerate() {
            let velocity = linear + angular.cross(&(point - origin));
            let mut column = out.platform.column_mut(i);
            column.fixed_rows_mut::<3>(0).copy_from(angular);
            column.fixed_rows_mut::<3>(3).copy_from(&velocity);
        }
    }
}
