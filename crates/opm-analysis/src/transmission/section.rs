//! The inputs of a section: their wrenches, and the indices at a pose.

use super::{InputIndices, Local, NoTransmission, View, ZERO};
use crate::screws::Screws;
use nalgebra::DMatrix;
use opm_core::Leg;
use opm_core::group::screw::Screw;
use opm_core::group::subspace::SubspaceClass;
use opm_core::group::{MotionType, SubspaceKind};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::leg::Section;
use opm_core::task::IntersectionAxis;
use std::ops::Range;

/// A joint of a leg's chain in one section.
#[derive(Clone, Copy, Debug)]
struct Member {
    /// The number of its coordinate; `None` for the imaginary joint.
    coordinate: Option<usize>,
    /// Whether it is an input of the section.
    input: bool,
    /// Its twist at the pose.
    twist: Local,
}

/// A leg's chain in one section, from base to platform.
#[derive(Clone, Debug)]
struct Chain {
    leg: usize,
    members: Vec<Member>,
    /// The column of the rate along the intersection motion, of the lower section's unknowns.
    along: Option<usize>,
    /// Where it meets the only other leg with an input, if it constrains the section: the number of that leg, and of the
    /// passive joint there that is next to the platform.
    meets: Option<(usize, usize)>,
}

/// One section as a parallel mechanism.
#[derive(Clone, Debug)]
pub(super) struct Mechanism {
    /// The section.
    pub section: Section,
    kind: SubspaceKind,
    chains: Vec<Chain>,
    /// The twists of the section's output.
    basis: Vec<Local>,
    /// The intersection motion.
    along: Local,
    /// The number of its inputs.
    pub inputs: usize,
    /// The numbers of the legs that constrain it, that with the most constraints first; the others repeat some of these.
    pub constraining: Vec<usize>,
    /// The number of constraints.
    pub lacks: usize,
    /// The wrenches of inputs and constraints on the unknowns, and the inverse beside it.
    system: DMatrix<f64>,
}

impl Mechanism {
    /// The mechanism of a section; `None` if nothing drives it and nothing has to.
    pub fn new(
        manipulator: &Manipulator,
        section: Section,
    ) -> Result<Option<Self>, NoTransmission> {
        let (task, decomposition) = (manipulator.task(), manipulator.decomposition());
        let kind = match section {
            Section::Lower => task.lower.kind,
            Section::Upper => task.upper.kind,
        };
        let name = |leg: usize| manipulator.mechanism().legs[leg].name.clone();
        let bridged = manipulator.jacobians().bridged;
        let mut first = 0;
        let (mut chains, mut columns) = (Vec::new(), 0);
        for (leg, split) in decomposition.legs.iter().enumerate() {
            let lower = first..first + split.lower.len();
            let upper = lower.end..lower.end + split.upper.len();
            first = upper.end;
            let own = match section {
                Section::Lower => lower.clone(),
                Section::Upper => upper.clone(),
            };
            let bridge = task.intersection.as_ref().map(|_| match bridged.contains(&leg) {
                true => Section::Upper,
                false => Section::Lower,
            });
            let actuated = |c: &usize| manipulator.actuated().contains(c);
            let named = manipulator.imaginary().iter().any(|joint| joint.leg == leg);
            let lifts = lifts(manipulator, section, own.clone())?;
            let mut members: Vec<Member> = own
                .filter(|number| !lifts.contains(number))
                .map(|number| Member {
                    coordinate: Some(number),
                    input: actuated(&number),
                    twist: Local::zeros(),
                })
                .collect();
            let driven = members.iter().any(|member| member.input);
            if bridge == Some(Section::Lower) && section == Section::Upper && driven {
                return Err(NoTransmission::Shared { leg: name(leg) });
            }
            let imaginary = |input| Member { coordinate: None, input, twist: Local::zeros() };
            if bridge == Some(section) {
                match section {
                    Section::Lower => members.push(imaginary(false)),
                    Section::Upper => members.insert(0, imaginary(named)),
                }
            }
            // Without an imaginary joint, the lower section carries the upper one along.
            let along = section == Section::Lower && bridge == Some(Section::Upper) && named;
            let along = along.then(|| {
                columns += 1;
                columns - 1
            });
            chains.push(Chain { leg, members, along, meets: None });
        }
        let inputs = chains.iter().flat_map(|c| &c.members).filter(|m| m.input).count();
        let shared = task.intersection.as_ref().map(IntersectionAxis::motion_type);
        // A rate along the intersection motion belongs to the upper section if it is a rotation, or else to the lower one.
        let less = match (section, shared) {
            (Section::Lower, Some(MotionType::Rotation))
            | (Section::Upper, Some(MotionType::Translation)) => 1,
            _ => 0,
        };
        let lack = |leg: &usize| kind.dimension().saturating_sub(chains[*leg].members.len());
        let mut constraining: Vec<usize> = (0..chains.len()).filter(|leg| lack(leg) > 0).collect();
        constraining.sort_by_key(|leg| std::cmp::Reverse(lack(leg)));
        let lacks = constraining.first().map_or(0, lack);
        let freedoms = (kind.dimension() - less + columns).saturating_sub(lacks);
        // Dependent coordinates, and those that only lifts drive, have no inputs of their own.
        if inputs == 0 && (freedoms == 0 || kind == SubspaceKind::Identity) {
            return Ok(None);
        }
        if inputs != freedoms {
            return Err(NoTransmission::Inputs { section, inputs, freedoms });
        }
        for &leg in constraining.iter().filter(|_| kind.dimension() == 3 && lacks == 1) {
            chains[leg].meets = meeting(&chains, leg);
        }
        let basis = vec![Local::zeros(); kind.dimension() - less];
        let rows = inputs + lacks;
        let system = DMatrix::zeros(rows, 2 * rows);
        let along = Local::zeros();
        Ok(Some(Self { section, kind, chains, basis, along, inputs, constraining, lacks, system }))
    }

    /// Takes the twists of all joints, and chooses those of the section's output.
    pub fn place(&mut self, screws: &Screws, view: &View<'_>, along: Option<Local>) {
        for member in self.chains.iter_mut().flat_map(|chain| &mut chain.members) {
            member.twist = match member.coordinate {
                Some(number) => view.of(&screws.freedoms[number].screw),
                None => along.unwrap_or_default(),
            };
        }
        self.along = along.unwrap_or_default();
        let units = [Local::x(), Local::y(), Local::z()];
        let units = units.into_iter().take(self.kind.dimension());
        if self.basis.len() == self.kind.dimension() {
            self.basis.iter_mut().zip(units).for_each(|(to, unit)| *to = unit);
            return;
        }
        // All but the intersection motion: what is perpendicular to a translation; for a rotation any others will do.
        let along = self.along.normalize();
        let left_out = along.iamax();
        let others = units.enumerate().filter(|(i, _)| *i != left_out);
        for (to, (_, unit)) in self.basis.iter_mut().zip(others) {
            *to = match self.section {
                Section::Lower => unit,
                Section::Upper => unit - along * along.dot(&unit),
            };
        }
    }

    /// Adds the indices of all inputs; returns the output constraint index, not a number unless there is one constraint.
    pub fn indices(&mut self, found: &mut Vec<InputIndices>) -> f64 {
        let n = self.inputs + self.lacks;
        self.system.fill(0.0);
        let mut row = 0;
        for chain in &self.chains {
            for (place, member) in chain.members.iter().enumerate().filter(|(_, m)| m.input) {
                let wrench = chain.wrench(place, self.kind);
                let of =
                    WrenchRow { wrench, basis: &self.basis, along: (chain.along, &self.along) };
                of.write(&mut self.system, row, wrench.dot(&member.twist));
                row += 1;
            }
        }
        if let Some(chain) = self.constraining.first().map(|&leg| &self.chains[leg]) {
            for wrench in chain.constraints(self.kind).into_iter().take(self.lacks) {
                let of =
                    WrenchRow { wrench, basis: &self.basis, along: (chain.along, &self.along) };
                of.write(&mut self.system, row, wrench.norm());
                row += 1;
            }
        }
        let regular = invert(&mut self.system);
        let mut column = n;
        for chain in &self.chains {
            for (place, member) in chain.members.iter().enumerate().filter(|(_, m)| m.input) {
                let output = if regular { self.output(chain, column) } else { Local::zeros() };
                let last = chain.last(place, self.kind);
                let (wrench, last) = match self.meeting(chain, place) {
                    Some((wrench, joint)) => {
                        (wrench, if has_axis(self.kind, &joint.twist) { Some(joint) } else { last })
                    }
                    None => (chain.wrench(place, self.kind), last),
                };
                let index = |twist: &Local, at: Option<&Member>| {
                    cosine(self.kind, &wrench, twist, at.map(|member| member.twist))
                };
                found.push(InputIndices {
                    leg: chain.leg,
                    section: self.section,
                    coordinate: member.coordinate,
                    input: index(&member.twist, chain.beside(place, self.kind)),
                    output: index(&output, last),
                });
                column += 1;
            }
        }
        if self.lacks != 1 {
            return f64::NAN;
        }
        let each = self.constraining.iter().map(|&leg| {
            let chain = &self.chains[leg];
            let output = if regular { self.output(chain, column) } else { Local::zeros() };
            let joint = chain.members.iter().rfind(|member| has_axis(self.kind, &member.twist));
            let [wrench, ..] = chain.constraints(self.kind);
            cosine(self.kind, &wrench, &output, joint.map(|member| member.twist))
        });
        each.fold(1.0, f64::min)
    }

    /// The wrench of an input on the joint where its leg meets the other one, and that joint. It differs from the one that
    /// [`Chain::wrench`] gives by a wrench that the leg's own joints bear, so that both do the same work.
    fn meeting(&self, chain: &Chain, place: usize) -> Option<(Local, &Member)> {
        let (leg, joint) = chain.meets?;
        let joint = &self.chains[leg].members[joint];
        let own = chain.members.iter().enumerate().find(|(i, _)| *i != place)?.1;
        Some((own.twist.cross(&joint.twist), joint))
    }

    /// The twist of the last link of a leg for a unit rate of one input, whose solution is a column of the system.
    fn output(&self, chain: &Chain, column: usize) -> Local {
        let parts = self.basis.iter().enumerate();
        let mut twist: Local = parts.map(|(row, twist)| twist * self.system[(row, column)]).sum();
        if let Some(along) = chain.along {
            twist += self.along * self.system[(self.basis.len() + along, column)];
        }
        if self.section == Section::Upper {
            return twist;
        }
        // An imaginary joint behind the last link has a rate of its own.
        let imaginary = chain.members.iter().position(|member| member.coordinate.is_none());
        if let Some(place) = imaginary {
            let wrench = chain.wrench(place, self.kind);
            let own = chain.members[place].twist;
            twist -= own * (wrench.dot(&twist) / wrench.dot(&own));
        }
        twist
    }
}

/// Where a leg that has an input meets the only other leg that has one; `None` if it has two, or none other has any.
fn meeting(chains: &[Chain], leg: usize) -> Option<(usize, usize)> {
    let inputs = |chain: &Chain| chain.members.iter().filter(|member| member.input).count();
    let mut others = (0..chains.len()).filter(|&other| other != leg && inputs(&chains[other]) > 0);
    let (Some(other), None) = (others.next(), others.next()) else { return None };
    let passive = chains[other].members.iter().rposition(|member| !member.input)?;
    (inputs(&chains[leg]) == 1).then_some((other, passive))
}

impl Chain {
    /// The wrench that is reciprocal to all joints but one, and perpendicular to those that are reciprocal to all.
    fn wrench(&self, place: usize, kind: SubspaceKind) -> Local {
        let own = self.members[place].twist;
        let mut others =
            self.members.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, m)| m.twist);
        match (kind.dimension(), others.next(), others.next()) {
            (3, Some(a), Some(b)) => a.cross(&b),
            (2, Some(a), _) => Local::new(-a.y, a.x, 0.0),
            (_, Some(other), None) => {
                let at = Reference::on(kind, [&other, &own]);
                let [own, other] = [own, other].map(|twist| at.twist(&twist));
                at.wrench_back(&other.cross(&own.cross(&other)))
            }
            (_, None, _) => {
                let at = Reference::on(kind, [&own, &own]);
                at.wrench_back(&at.twist(&own))
            }
            (_, Some(_), Some(_)) => Local::zeros(),
        }
    }

    /// The wrenches that are reciprocal to all joints; of three, the first `d − m` count.
    fn constraints(&self, kind: SubspaceKind) -> [Local; 3] {
        let units = [Local::x(), Local::y(), Local::z()];
        let twists = || self.members.iter().map(|member| member.twist);
        let (mut all, mut rest) = (twists(), [Local::zeros(); 3]);
        match (kind.dimension(), all.next(), all.next()) {
            (2, Some(a), _) => rest[0] = Local::new(-a.y, a.x, 0.0),
            (_, Some(a), Some(b)) => rest[0] = a.cross(&b),
            (_, Some(a), None) => {
                let unit = units[a.iamin()];
                rest[0] = a.cross(&unit);
                rest[1] = a.cross(&rest[0]);
            }
            (_, None, _) => rest = units,
        }
        rest
    }

    /// The joint on the wrench's axis that is next to an input, on the platform's side if two are.
    fn beside(&self, place: usize, kind: SubspaceKind) -> Option<&Member> {
        let behind = self.members[place + 1..].iter().enumerate();
        let before = self.members[..place].iter().rev().enumerate();
        let near = behind.chain(before).filter(|(_, member)| has_axis(kind, &member.twist));
        near.min_by_key(|(apart, _)| *apart).map(|(_, member)| member)
    }

    /// The joint on the wrench's axis that is next to the platform.
    fn last(&self, place: usize, kind: SubspaceKind) -> Option<&Member> {
        let others = self.members.iter().enumerate().filter(|(i, _)| *i != place);
        others.map(|(_, member)| member).rfind(|member| has_axis(kind, &member.twist))
    }
}

/// A point of a plane that moments are taken about. Other subspaces need none.
struct Reference {
    x: f64,
    y: f64,
}

impl Reference {
    /// The point of the first of two joints that has an axis; the origin without one.
    fn on(kind: SubspaceKind, joints: [&Local; 2]) -> Self {
        let planar = |joint: &&&Local| kind == SubspaceKind::Planar && has_axis(kind, joint);
        let joint = joints.iter().find(planar);
        let (x, y) = joint.map_or((0.0, 0.0), |joint| (-joint.z / joint.x, joint.y / joint.x));
        Self { x, y }
    }

    /// A twist with the velocity of this point.
    fn twist(&self, t: &Local) -> Local {
        Local::new(t.x, t.y - t.x * self.y, t.z + t.x * self.x)
    }

    /// A wrench with its moment about the origin, from the one with that about this point.
    fn wrench_back(&self, w: &Local) -> Local {
        Local::new(w.x + self.x * w.z - self.y * w.y, w.y, w.z)
    }
}

/// What a wrench does to the unknowns.
struct WrenchRow<'a> {
    wrench: Local,
    basis: &'a [Local],
    /// The column of the rate along the intersection motion, and that motion.
    along: (Option<usize>, &'a Local),
}

impl WrenchRow<'_> {
    /// Writes the row of a system, with its power on the right.
    fn write(&self, system: &mut DMatrix<f64>, row: usize, power: f64) {
        let scale = self.wrench.norm();
        let scale = if scale > ZERO { scale.recip() } else { 0.0 };
        for (column, twist) in self.basis.iter().enumerate() {
            system[(row, column)] = self.wrench.dot(twist) * scale;
        }
        if let (Some(column), along) = self.along {
            system[(row, self.basis.len() + column)] = self.wrench.dot(along) * scale;
        }
        let unknowns = system.nrows();
        system[(row, unknowns + row)] = power * scale;
    }
}

/// Whether a joint turns about an axis that wrenches pass through.
fn has_axis(kind: SubspaceKind, twist: &Local) -> bool {
    match kind {
        SubspaceKind::Planar => twist.x.abs() > ZERO,
        SubspaceKind::Spherical => true,
        SubspaceKind::Identity
        | SubspaceKind::Cylindrical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => false,
    }
}

/// The power of a wrench on a twist, over the most that a wrench of its strength through the same joint has.
fn cosine(kind: SubspaceKind, wrench: &Local, twist: &Local, joint: Option<Local>) -> f64 {
    let power = wrench.dot(twist).abs();
    let most = match (kind, joint) {
        // The velocity of the point on the joint's axis.
        (SubspaceKind::Planar, Some(joint)) if wrench.yz().norm() > ZERO * wrench.norm() => {
            let (x, y) = (-joint.z / joint.x, joint.y / joint.x);
            wrench.yz().norm() * (twist.y - twist.x * y).hypot(twist.z + twist.x * x)
        }
        // A couple.
        (SubspaceKind::Planar, _) => wrench.x.abs() * twist.x.abs(),
        (SubspaceKind::Spherical, Some(joint)) => {
            wrench.norm() * twist.cross(&joint).norm() / joint.norm()
        }
        // Coaxial screws have no angle between them, nor a distance.
        (SubspaceKind::Cylindrical, _) => power,
        _ => wrench.norm() * twist.norm(),
    };
    let index = if most > 0.0 { (power / most).min(1.0) } else { 0.0 };
    if power > ZERO * wrench.norm() * twist.norm() { index } else { 0.0 }
}

/// The joints of a section that change its height, in a Schoenflies section.
fn lifts(
    manipulator: &Manipulator,
    section: Section,
    own: Range<usize>,
) -> Result<Vec<usize>, NoTransmission> {
    /// A part of a joint's motion along the normal that is rounding.
    const LEVEL: f64 = 1e-7;
    let (task, decomposition) = (manipulator.task(), manipulator.decomposition());
    let (class, subspace) = match section {
        Section::Lower => (&decomposition.lower, &task.lower),
        Section::Upper => (&decomposition.upper, &task.upper),
    };
    if !matches!(class, SubspaceClass::Schoenflies { .. }) {
        return Ok(Vec::new());
    }
    let up = subspace.axes.column(2);
    if let Some(axis) = &task.intersection
        && axis.point.is_none()
        && axis.direction.dot(&up).abs() > LEVEL
    {
        return Err(NoTransmission::Inclined { section });
    }
    let screws = manipulator.mechanism().legs.iter().flat_map(Leg::screws);
    let rises = |screw: &Screw| screw.linear.dot(&up).abs() > LEVEL;
    let all = screws.enumerate().filter(|(number, screw)| own.contains(number) && rises(screw));
    Ok(all.map(|(number, _)| number).collect())
}

/// Replaces `[A | D]` by `[· | A⁻¹ D]`, by elimination with row pivoting. Returns `false` if `A` is singular.
fn invert(system: &mut DMatrix<f64>) -> bool {
    let n = system.nrows();
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| system[(i, k)].abs().total_cmp(&system[(j, k)].abs()));
        let pivot = largest.unwrap_or(k);
        if system[(pivot, k)].abs() <= ZERO {
            return false;
        }
        system.swap_rows(k, pivot);
        let factor = system[(k, k)].recip();
        for column in k..2 * n {
            system[(k, column)] *= factor;
        }
        for row in (0..n).filter(|&row| row != k) {
            let factor = system[(row, k)];
            for column in k..2 * n {
                system[(row, column)] -= factor * system[(k, column)];
            }
        }
    }
    true
}
