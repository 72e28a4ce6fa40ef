//! The functions of one leg: the section that is solved first, and the other one.

use super::displacement::{Tau, displacement_type};
use super::geometry::{chain, free};
use super::{DISPLACEMENTS, Writer, done, geometry, symbol, word};
use crate::library::*;
use crate::trace::*;
use crate::tree::{Pass, Type};
use opm_core::chain::Chain;
use opm_core::chain::cylindrical::CylindricalChain;
use opm_core::chain::planar::{PlanarChain, PlanarJoint};
use opm_core::group::{IntersectionMotion, MotionType};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{LeanForm, LegForm, SectionForm};

/// The form in which a closed form gives a joint's displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// A direction, not normalised.
    Direction,
    /// A number.
    Value,
    /// A number that is the angle of a revolute joint on an axis where revolutions are counted.
    Turns,
}

impl Given {
    /// The type of what a leg's function writes.
    pub fn of_type(self) -> Type {
        match self {
            Self::Direction | Self::Turns => Complex::kind(),
            Self::Value => Type::Real,
        }
    }
}

/// The form in which a joint of a section's chain is given.
pub fn given(section: &SectionForm, joint: usize) -> Given {
    let revolute = |chain: &CylindricalChain, joint: usize| {
        let joint = chain.joints()[joint];
        joint.rotation != 0.0 && joint.advance == 0.0
    };
    match &section.chain {
        Chain::Planar(chain) => match chain.joints()[joint] {
            PlanarJoint::Revolute { .. } => Given::Direction,
            PlanarJoint::Prismatic { .. } => Given::Value,
        },
        Chain::Spherical(_) => Given::Direction,
        Chain::Cylindrical(chain) if revolute(chain, joint) => Given::Turns,
        Chain::Cylindrical(_)
        | Chain::Rigid
        | Chain::Part(_)
        | Chain::Ball(_)
        | Chain::Translational(_)
        | Chain::Spatial(_) => Given::Value,
    }
}

/// The member that has half the angle of a spherical joint.
pub fn ball(leg: usize, section: Section) -> String {
    format!("half_{}_{}", leg + 1, word(section))
}

/// Whether a section may be out of reach.
fn may_miss(section: &SectionForm) -> bool {
    section.locked.is_none() && matches!(section.chain, Chain::Planar(_) | Chain::Spherical(_))
}

/// Whether a section's function takes the sign of a branch.
fn has_sign(section: &SectionForm) -> bool {
    section.locked.is_none()
        && match &section.chain {
            Chain::Planar(PlanarChain::Rpp(_) | PlanarChain::Ppr(_) | PlanarChain::Prp(_)) => false,
            Chain::Planar(_) | Chain::Spherical(_) => true,
            Chain::Rigid
            | Chain::Part(_)
            | Chain::Ball(_)
            | Chain::Cylindrical(_)
            | Chain::Translational(_)
            | Chain::Spatial(_) => false,
        }
}

/// The parameters of a leg's functions.
struct Solved {
    g: Any,
    /// The displacements of the lower and the upper section.
    moved: [Any; 2],
    rise: Real,
    near: Real,
    mode: Bits,
    at: Any,
    missed: Real,
}

impl Solved {
    fn of(&self, section: Section) -> Any {
        self.moved[section as usize]
    }
}

const PARAMETERS: [&str; 8] = ["g", "v", "b", "rise", "near", "mode", "at", "missed"];

impl Writer<'_> {
    /// The form in which the displacement along the intersection motion of a leg is given; `None` where it has none.
    pub fn tau(&self, leg: &LegForm) -> Option<Given> {
        if !leg.bridged {
            return None;
        }
        let rotation = self.shared() == Some(MotionType::Rotation);
        Some(if rotation && !leg.unwinds { Given::Direction } else { Given::Value })
    }

    /// That displacement of a leg, from the member of the displacements.
    pub fn tau_at(&self, at: Any, leg: usize) -> Option<Tau> {
        let field = format!("tau_{}", leg + 1);
        Some(match self.tau(&self.forms.legs[leg])? {
            Given::Direction | Given::Turns => Tau::Direction(at.member(&field)),
            Given::Value => Tau::Value(at.member(&field)),
        })
    }

    /// The functions that solve the two sections of a leg, in their order.
    pub fn leg(&self, number: usize) {
        let leg = &self.forms.legs[number];
        if let Some(form) = &leg.whole {
            self.whole_leg(number, form);
            return;
        }
        let name = crate::names::comment(&self.manipulator.mechanism().legs[number].name);
        for (place, section) in [("first", leg.first), ("second", other(leg.first))] {
            let comment = format!(
                "Leg {}, {name}: its {} section{}.",
                number + 1,
                word(section),
                equation(leg, section)
            );
            let function = Traced::new(&format!("leg{}_{place}", number + 1), &comment);
            let function = function.body(|p| {
                let kind = |of| displacement_type(self.kind(of)).unwrap_or(Type::Int);
                let solved = Solved {
                    g: geometry(p),
                    moved: [Section::Lower, Section::Upper]
                        .map(|of| p.of_kind(symbol(of), kind(of), Pass::Value)),
                    rise: p.add::<Real>("rise"),
                    near: p.add::<Real>("near"),
                    mode: p.add::<Bits>("mode"),
                    at: p.of_kind("at", Type::Struct(DISPLACEMENTS.to_owned()), Pass::Write),
                    missed: p.add::<Out<Real>>("missed"),
                };
                match section == leg.first {
                    true => self.first(number, &solved),
                    false => self.second(number, section, &solved),
                }
                done()
            });
            // One that only succeeds is none.
            if function.body.len() > 1 {
                self.add(function.without_unused(&PARAMETERS));
            }
        }
    }

    /// The names of the functions of a leg, with whether each is that of the first section.
    pub fn leg_functions(&self, leg: usize) -> Vec<(String, bool)> {
        let names = [("first", true), ("second", false), ("whole", true)];
        let named = names.map(|(place, first)| (format!("leg{}_{place}", leg + 1), first));
        named.into_iter().filter(|(name, _)| self.find(name, |_| ()).is_some()).collect()
    }

    fn first(&self, number: usize, solved: &Solved) {
        let section = self.forms.legs[number].first;
        let tau = self.solve(number, section, solved);
        self.write_tau(number, tau, solved);
    }

    fn second(&self, number: usize, section: Section, solved: &Solved) {
        let leg = &self.forms.legs[number];
        let Solved { g, rise, at, .. } = *solved;
        if let (Some(height), true) = (&self.forms.height, leg.bridged)
            && height.slope != 0.0
            && leg.lift.is_some()
        {
            let along: Real = at.member(&format!("tau_{}", number + 1));
            rise.increase(g.member::<Real>("slope") * along);
        }
        self.solve(number, section, solved);
        if let Some(lift) = &leg.lift {
            let kind = if lift.lean.is_some() { LeaningLift::kind() } else { Lift::kind() };
            let rate: Real = g.part(&format!("leg{}_lift", number + 1), kind).member("rate");
            at.member::<Real>(&self.fields[lift.coordinate]).set(rate * rise);
        }
    }

    /// The displacement of a section after that of the imaginary joint in the other one.
    fn shift_by_tau(&self, number: usize, section: Section, solved: &Solved) {
        if matches!(self.intersection(section), IntersectionMotion::None(_)) {
            return;
        }
        if let Some(tau) = self.tau_at(solved.at, number) {
            let moved = solved.of(section);
            moved.set(self.shifted(section, solved.g, moved, tau.of(section)));
        }
    }

    /// The displacement along the intersection motion from that of the imaginary joint, which is in the section that is
    /// solved first.
    fn write_tau(&self, number: usize, found: Option<Any>, solved: &Solved) {
        let leg = &self.forms.legs[number];
        let (Some(tau), Some(joint)) = (self.tau(leg), leg.imaginary_in(leg.first)) else { return };
        let section = leg.section(leg.first);
        let field = format!("tau_{}", number + 1);
        let (direction, value): (Complex, Real) =
            (solved.at.member(&field), solved.at.member(&field));
        let is_turn = given(section, joint) != Given::Value;
        let Some(found) = found else {
            // It is locked.
            match tau {
                Given::Direction => direction.set(complex_of(1.0, 0.0)),
                _ => value.set(0.0),
            }
            return;
        };
        // L exp(I c) = v with c the imaginary joint: tau = -c.
        let back = leg.first == Section::Lower;
        match (tau, is_turn, back) {
            (Given::Direction, _, false) => direction.set(found.is::<Complex>()),
            (Given::Direction, _, true) => direction.set(conjugate(found.is::<Complex>())),
            (_, true, false) => value.set(near(angle(found.is::<Complex>()), solved.near)),
            (_, true, true) => value.set(-near(angle(found.is::<Complex>()), -solved.near)),
            (_, false, false) => value.set(found.is::<Real>()),
            (_, false, true) => value.set(-found.is::<Real>()),
        }
    }

    /// Solves a section for `v` or `b`. It gives what the imaginary joint does, where the section has it.
    fn solve(&self, number: usize, section: Section, solved: &Solved) -> Option<Any> {
        let leg = &self.forms.legs[number];
        let form = leg.section(section);
        let (of_type, _) = chain(form)?;
        let Solved { g, rise, mode, at, missed, .. } = *solved;
        let (mut outputs, mut tau) = (Vec::new(), None);
        let (mut turns, mut parts) = (Vec::new(), Vec::new());
        for joint in free(form) {
            let form_of_joint = given(form, joint);
            let target = match form.coordinates[joint] {
                Some(coordinate) => at.part(&self.fields[coordinate], form_of_joint.of_type()),
                None => {
                    let declared = match form_of_joint {
                        Given::Value => Any::from(named("tau", 0.0)),
                        _ => Any::from(named("tau", Complex::made(1.0, 0.0))),
                    };
                    *tau.insert(declared)
                }
            };
            if form_of_joint == Given::Turns {
                let angle = named("angle", 0.0);
                turns.push((target.is::<Complex>(), angle));
                outputs.push(Any::from(angle));
            } else {
                outputs.push(target);
            }
            if form.slider.is_some_and(|(slider, _)| slider == joint) {
                parts.push(target.is::<Real>());
            }
        }
        if let Chain::Ball(_) = form.chain {
            outputs.push(at.member::<Complex>(&ball(number, section)).into());
        }
        let of_type = Type::Struct(of_type);
        let own = g.part(&format!("leg{}_{}", number + 1, word(section)), of_type.clone());
        let lean = leg.lift.as_ref().and_then(|lift| lift.lean);
        let lean = lean.filter(|lean| lean.section == section).map(|lean| {
            let lift = g.member::<LeaningLift>(&format!("leg{}_lift", number + 1));
            let lifted = named("lifted", leaned(lift, rise));
            (lean, lifted, Any::variable("chain", &of_type, Some(own.expr())))
        });
        if section != leg.first {
            self.shift_by_tau(number, section, solved);
        }
        let moved = solved.of(section);
        let mut chain = own;
        if let Some((lean, lifted, changed)) = lean {
            carry(form, &lean, changed, lifted);
            chain = changed;
            let moved = moved.is::<Planar>();
            moved.set(planar_product(moved, planar_inverse(lifted)));
        }
        let sign = match (has_sign(form), form.bit) {
            (true, Some(bit)) => Some(Any::from(sign(mode, bit))),
            _ => None,
        };
        let arguments: Vec<Any> = [chain, moved].into_iter().chain(sign).chain(outputs).collect();
        let Type::Struct(name) = of_type else { return tau };
        let call = self.call(&format!("solve_{name}"), &arguments);
        if may_miss(form) {
            missed.set(call.is::<Real>());
            when(missed.gt(0.0), || give(1));
        }
        for (target, angle) in turns {
            target.set(unit(angle));
        }
        for part in parts {
            part.divide(g.member::<Part>(&format!("leg{}_part", number + 1)).rate);
        }
        tau
    }
}

/// The section that is not this one.
pub fn other(section: Section) -> Section {
    match section {
        Section::Lower => Section::Upper,
        Section::Upper => Section::Lower,
    }
}

/// What a section's function solves.
fn equation(leg: &LegForm, section: Section) -> &'static str {
    match (leg.bridged, leg.first == section, section) {
        (true, true, Section::Upper) => ", exp(I tau) U = b",
        (true, false, Section::Lower) => ", L = v exp(I tau)",
        (true, true, Section::Lower) => ", L exp(-I tau) = v",
        (true, false, Section::Upper) => ", U = exp(-I tau) b",
        (false, _, Section::Lower) => ", L = v",
        (false, _, Section::Upper) => ", U = b",
    }
}

/// Displaces the joints behind a lift by what it does in the plane.
fn carry(form: &SectionForm, lean: &LeanForm, chain: Any, lifted: Planar) {
    let Chain::Planar(joints) = &form.chain else { return };
    for (place, joint) in (1..).zip(joints.joints()).skip(lean.before) {
        match joint {
            PlanarJoint::Revolute { .. } => {
                let pivot: Pivot = chain.member(&format!("p{place}"));
                pivot.set(carried_pivot(lifted, pivot));
            }
            PlanarJoint::Prismatic { .. } => {
                let slide: Complex = chain.member(&format!("d{place}"));
                slide.set(lifted.rotation * slide);
            }
        }
    }
}
