//! The functions of one leg: the section that is solved first, and the other one.

use super::Writer;
use super::pose::{displacement_type, intersection, kind, shared, shifted, word};
use opm_core::chain::Chain;
use opm_core::chain::cylindrical::CylindricalChain;
use opm_core::chain::planar::{PlanarChain, PlanarJoint};
use opm_core::group::{IntersectionMotion, MotionType};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::{LeanForm, LegForm, SectionForm};
use std::fmt::Write;

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
    /// The C type of what a leg's function writes.
    pub fn of_type(self) -> &'static str {
        match self {
            Self::Direction | Self::Turns => "NAME_complex",
            Self::Value => "real",
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
pub fn may_miss(section: &SectionForm) -> bool {
    section.locked.is_none() && matches!(section.chain, Chain::Planar(_) | Chain::Spherical(_))
}

/// The parameters of a leg's functions, in their order.
const PARAMETERS: [(&str, &str); 8] = [
    ("g", "const NAME_geometry *g"),
    ("v", "LOWER v"),
    ("b", "UPPER b"),
    ("rise", "real rise"),
    ("near", "real near"),
    ("mode", "unsigned mode"),
    ("at", "NAME_displacements *at"),
    ("missed", "real *missed"),
];

/// A static function: its text, and how it is called.
pub struct Function {
    pub text: String,
    pub call: String,
}

impl Writer<'_> {
    /// The form in which the displacement along the intersection motion of a leg is given; `None` where it has none.
    pub fn tau(&self, leg: &LegForm) -> Option<Given> {
        if !leg.bridged {
            return None;
        }
        let rotation = shared(self.task) == Some(MotionType::Rotation);
        Some(if rotation && !leg.unwinds { Given::Direction } else { Given::Value })
    }

    /// The functions that solve the two sections of a leg, in their order.
    pub fn leg_functions(&self, number: usize) -> [Function; 2] {
        let leg = &self.forms.legs[number];
        let second = match leg.first {
            Section::Lower => Section::Upper,
            Section::Upper => Section::Lower,
        };
        let name = &self.manipulator.mechanism().legs[number].name;
        let mut first = self.section_body(number, leg.first, "");
        self.write_tau(number, &mut first);
        let mut rest = String::new();
        if let (Some(height), true) = (&self.forms.height, leg.bridged)
            && height.slope != 0.0
            && leg.lift.is_some()
        {
            let _ = writeln!(rest, "    rise += g->slope * at->tau_{};", number + 1);
        }
        let section = self.section_body(number, second, &self.tau_shift(number, second));
        rest += &section;
        if let Some(lift) = &leg.lift {
            let field = &self.fields[lift.coordinate];
            let _ = writeln!(rest, "    at->{field} = g->leg{}_lift.rate * rise;", number + 1);
        }
        let name = crate::names::comment(name);
        let bodies = [(leg.first, first, "first"), (second, rest, "second")];
        bodies.map(|(section, body, place)| {
            let comment = format!(
                "/* Leg {}, {name}: its {} section{}. */",
                number + 1,
                word(section),
                self.equation(leg, section)
            );
            self.function(&comment, &format!("leg{}_{place}", number + 1), &body)
        })
    }

    /// What a section's function solves.
    fn equation(&self, leg: &LegForm, section: Section) -> &'static str {
        match (leg.bridged, leg.first == section, section) {
            (true, true, Section::Upper) => ", exp(I tau) U = b",
            (true, false, Section::Lower) => ", L = v exp(I tau)",
            (true, true, Section::Lower) => ", L exp(-I tau) = v",
            (true, false, Section::Upper) => ", U = exp(-I tau) b",
            (false, _, Section::Lower) => ", L = v",
            (false, _, Section::Upper) => ", U = b",
        }
    }

    /// A static function with those of the parameters that its body uses; empty for an empty one. It returns 0, or 1 if the
    /// target is out of reach.
    fn function(&self, comment: &str, name: &str, body: &str) -> Function {
        if body.is_empty() {
            return Function { text: String::new(), call: String::new() };
        }
        let types = [Section::Lower, Section::Upper]
            .map(|section| displacement_type(kind(self.task, section)).unwrap_or("int"));
        let used = PARAMETERS.iter().filter(|(name, _)| uses(body, name));
        let (mut declared, mut passed) = (Vec::new(), Vec::new());
        for (name, declaration) in used {
            passed.push(*name);
            declared.push(declaration.replace("LOWER", types[0]).replace("UPPER", types[1]));
        }
        let declared = declared.join(", ");
        let text = format!(
            "{comment}\nstatic int NAME_{name}({declared})\n{{\n{body}    return 0;\n}}\n\n"
        );
        Function { text, call: format!("NAME_{name}({})", passed.join(", ")) }
    }

    /// The displacement of a section after that of the imaginary joint in the other one, as a statement.
    fn tau_shift(&self, number: usize, section: Section) -> String {
        let leg = &self.forms.legs[number];
        let symbol = if section == Section::Lower { "v" } else { "b" };
        let Some(tau) = self.tau(leg) else { return String::new() };
        if matches!(intersection(self.task, section), IntersectionMotion::None(_)) {
            return String::new();
        }
        let of_leg = format!("at->tau_{}", number + 1);
        let direction = tau == Given::Direction;
        // U = exp(-I τ) b
        let of_leg = match (section, direction) {
            (Section::Lower, _) => of_leg,
            (Section::Upper, true) => format!("NAME_conjugate({of_leg})"),
            (Section::Upper, false) => format!("-{of_leg}"),
        };
        format!("    {symbol} = {};\n", shifted(self.task, section, symbol, &of_leg, direction))
    }

    /// The displacement along the intersection motion from that of the imaginary joint, which is in the section that is
    /// solved first.
    fn write_tau(&self, number: usize, body: &mut String) {
        let leg = &self.forms.legs[number];
        let (Some(tau), Some(joint)) = (self.tau(leg), leg.imaginary_in(leg.first)) else { return };
        let section = leg.section(leg.first);
        let field = format!("at->tau_{}", number + 1);
        let is_turn = given(section, joint) != Given::Value;
        if section.locked.is_some_and(|locked| locked[joint]) {
            let zero = if tau == Given::Direction { "NAME_complex_of(1, 0)" } else { "0" };
            let _ = writeln!(body, "    {field} = {zero};");
            return;
        }
        // L exp(I c) = v with c the imaginary joint: tau = -c.
        let back = leg.first == Section::Lower;
        let _ = match (tau, is_turn, back) {
            (Given::Direction, _, false) => writeln!(body, "    {field} = tau;"),
            (Given::Direction, _, true) => writeln!(body, "    {field} = NAME_conjugate(tau);"),
            (_, true, false) => writeln!(body, "    {field} = NAME_near(NAME_angle(tau), near);"),
            (_, true, true) => writeln!(body, "    {field} = -NAME_near(NAME_angle(tau), -near);"),
            (_, false, false) => writeln!(body, "    {field} = tau;"),
            (_, false, true) => writeln!(body, "    {field} = -tau;"),
        };
    }

    /// The statements that solve a section for `v` or `b`, which `shift` has displaced.
    fn section_body(&self, number: usize, section: Section, shift: &str) -> String {
        let leg = &self.forms.legs[number];
        let form = leg.section(section);
        let Some((of_type, _)) = super::geometry::section(form) else { return String::new() };
        let symbol = if section == Section::Lower { "v" } else { "b" };
        let member = format!("leg{}_{}", number + 1, word(section));
        let mut body = String::new();
        let free: Vec<usize> = (0..form.chain.freedoms())
            .filter(|&i| form.locked.is_none_or(|locked| !locked[i]))
            .collect();
        let (mut outputs, mut after) = (Vec::new(), String::new());
        for &joint in &free {
            let form_of_joint = given(form, joint);
            let target = match form.coordinates[joint] {
                Some(coordinate) => format!("at->{}", self.fields[coordinate]),
                None => {
                    let of_type = if form_of_joint == Given::Turns {
                        "NAME_complex"
                    } else {
                        form_of_joint.of_type()
                    };
                    let zero = if of_type == "real" { "0" } else { "{ 1, 0 }" };
                    let _ = writeln!(body, "    {of_type} tau = {zero};");
                    "tau".to_owned()
                }
            };
            if form_of_joint == Given::Turns {
                let _ = writeln!(body, "    real angle = 0;");
                let _ = writeln!(after, "    {target} = NAME_unit(angle);");
                outputs.push("&angle".to_owned());
            } else {
                outputs.push(format!("&{target}"));
            }
            if form.slider.is_some_and(|(slider, _)| slider == joint) {
                let _ = writeln!(after, "    {target} /= g->leg{}_part.rate;", number + 1);
            }
        }
        if let Chain::Ball(_) = form.chain {
            outputs.push(format!("&at->{}", ball(number, section)));
        }
        let lean =
            leg.lift.as_ref().and_then(|lift| lift.lean).filter(|lean| lean.section == section);
        let chain = match &lean {
            None => format!("&g->{member}"),
            Some(_) => {
                let _ = writeln!(
                    body,
                    "    const NAME_planar lifted = NAME_leaned(&g->leg{}_lift, rise);",
                    number + 1
                );
                let _ = writeln!(body, "    NAME_{of_type} chain = g->{member};");
                "&chain".to_owned()
            }
        };
        body += shift;
        if let Some(lean) = &lean {
            carry(form, lean, &mut body);
            let _ = writeln!(
                body,
                "    {symbol} = NAME_planar_product({symbol}, NAME_planar_inverse(lifted));"
            );
        }
        let sign = match (form.has_sign(), form.bit) {
            (true, Some(bit)) => Some(format!("NAME_sign(mode, {bit})")),
            _ => None,
        };
        let arguments: Vec<String> =
            [chain, symbol.to_owned()].into_iter().chain(sign).chain(outputs).collect();
        let call = format!("NAME_solve_{of_type}({})", arguments.join(", "));
        if may_miss(form) {
            let _ = writeln!(
                body,
                "    *missed = {call};\n    if (*missed > 0) {{\n        return 1;\n    }}"
            );
        } else {
            let _ = writeln!(body, "    {call};");
        }
        body + &after
    }
}

/// Displaces the joints behind a lift by what it does in the plane.
fn carry(form: &SectionForm, lean: &LeanForm, body: &mut String) {
    let Chain::Planar(chain) = &form.chain else { return };
    for (number, joint) in chain.joints().iter().enumerate().skip(lean.before) {
        let place = number + 1;
        let _ = match joint {
            PlanarJoint::Revolute { .. } => {
                writeln!(body, "    chain.p{place} = NAME_carried_pivot(lifted, chain.p{place});")
            }
            PlanarJoint::Prismatic { .. } => {
                writeln!(body, "    chain.d{place} = NAME_times(lifted.rotation, chain.d{place});")
            }
        };
    }
}

/// Whether a text has an identifier.
pub fn uses(text: &str, identifier: &str) -> bool {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.match_indices(identifier).any(|(at, found)| {
        let before = text[..at].chars().next_back();
        let after = text[at + found.len()..].chars().next();
        // A member of a struct is another thing.
        !before.is_some_and(|c| part(c) || c == '.' || c == '>') && !after.is_some_and(part)
    })
}

/// What the generated functions take a sign for.
trait HasSign {
    fn has_sign(&self) -> bool;
}

impl HasSign for SectionForm {
    fn has_sign(&self) -> bool {
        self.locked.is_none()
            && match &self.chain {
                Chain::Planar(PlanarChain::Rpp(_) | PlanarChain::Ppr(_) | PlanarChain::Prp(_)) => {
                    false
                }
                Chain::Planar(_) | Chain::Spherical(_) => true,
                Chain::Rigid
                | Chain::Ball(_)
                | Chain::Cylindrical(_)
                | Chain::Translational(_)
                | Chain::Spatial(_) => false,
            }
    }
}
