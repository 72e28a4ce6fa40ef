//! The displacements `v` and `b` of the two sections from the coordinates of a pose.

use opm_core::group::{
    CylindricalMotion, IntersectionMotion, MotionType, PlanarMotion, SubspaceKind,
};
use opm_core::manipulator::Section;
use opm_core::manipulator::form::ClosedForms;
use opm_core::task::{CoordinateKind, IntersectionAxis, Task};
use std::fmt::Write;

/// The C type of displacements of a kind; `None` for the identity.
pub fn displacement_type(kind: SubspaceKind) -> Option<&'static str> {
    Some(match kind {
        SubspaceKind::Identity => return None,
        SubspaceKind::Planar => "NAME_planar",
        SubspaceKind::Spherical => "NAME_rotation",
        SubspaceKind::Cylindrical => "NAME_cylindrical",
        SubspaceKind::TranslationalPlane => "NAME_complex",
        SubspaceKind::TranslationalSpace => "NAME_vector",
    })
}

/// The kind of a section's subspace.
pub fn kind(task: &Task, section: Section) -> SubspaceKind {
    match section {
        Section::Lower => task.lower.kind,
        Section::Upper => task.upper.kind,
    }
}

/// The intersection motion in the frame of a section.
pub fn intersection(task: &Task, section: Section) -> &IntersectionMotion {
    match section {
        Section::Lower => &task.lower_intersection,
        Section::Upper => &task.upper_intersection,
    }
}

/// What the two subspaces share.
pub fn shared(task: &Task) -> Option<MotionType> {
    task.intersection.as_ref().map(IntersectionAxis::motion_type)
}

/// The name of a section as in names of the code.
pub fn word(section: Section) -> &'static str {
    match section {
        Section::Lower => "lower",
        Section::Upper => "upper",
    }
}

/// Whether the orientation of the pose is written as azimuth, tilt and torsion.
pub fn tilt_torsion(task: &Task) -> bool {
    task.coordinates.iter().any(|c| c.kind() == CoordinateKind::Torsion)
}

/// The numbers of a section's coordinates, without that of a height.
pub fn numbers(task: &Task, forms: &ClosedForms, section: Section) -> Vec<usize> {
    let range = match section {
        Section::Lower => 0..task.lower_count,
        Section::Upper => task.lower_count..task.coordinates.len(),
    };
    range.filter(|&i| forms.height.is_none_or(|height| height.coordinate != i)).collect()
}

/// The Euler angles of three angles of a pose.
pub fn to_euler(task: &Task, [first, second, third]: [String; 3]) -> [String; 3] {
    let third = if tilt_torsion(task) { format!("{third} - {first}") } else { third };
    [first, second, third]
}

/// Three angles of a pose for the Euler angles.
pub fn of_euler(task: &Task, [zeta, xi, psi]: [String; 3]) -> [String; 3] {
    let third = if tilt_torsion(task) { format!("{zeta} + {psi}") } else { psi };
    [zeta, xi, third]
}

/// The function that gives the displacement of a section at a pose; empty for the identity.
pub fn function(task: &Task, forms: &ClosedForms, section: Section) -> String {
    let kind = kind(task, section);
    let Some(of_type) = displacement_type(kind) else { return String::new() };
    let numbers = numbers(task, forms, section);
    let q = |i: usize| format!("q[{0}] - g->home[{0}]", numbers[i]);
    let absolute = || to_euler(task, [0, 1, 2].map(|i| format!("q[{}]", numbers[i])));
    let plane = |rotation: &str, x: &str, y: &str| {
        format!("NAME_planar_of({rotation}, NAME_complex_of({x}, {y}))")
    };
    let (rotates, translates) =
        (shared(task) == Some(MotionType::Rotation), shared(task) == Some(MotionType::Translation));
    let euler = || {
        let euler = format!("NAME_euler({})", absolute().join(", "));
        match forms.home_orientation_inverse {
            Some(_) => format!("NAME_product({euler}, g->home_orientation_inverse)"),
            None => euler,
        }
    };
    let turn = |i: usize| format!("NAME_unit({})", q(i));
    let value = match (kind, section) {
        (SubspaceKind::Identity, _) => String::new(),
        (SubspaceKind::Planar, Section::Lower) if rotates => {
            plane("NAME_complex_of(1, 0)", &q(0), &q(1))
        }
        (SubspaceKind::Planar, Section::Upper) if translates => plane(&turn(1), "0", &q(0)),
        (SubspaceKind::Planar, _) => plane(&turn(2), &q(0), &q(1)),
        (SubspaceKind::Spherical, Section::Lower) if rotates => {
            format!("NAME_tilt({}, {})", q(0), q(1))
        }
        (SubspaceKind::Spherical, _) => euler(),
        (SubspaceKind::Cylindrical, Section::Lower) if rotates => {
            format!("NAME_cylindrical_of(0, {})", q(0))
        }
        (SubspaceKind::Cylindrical, Section::Upper) if translates => {
            format!("NAME_cylindrical_of({}, 0)", q(0))
        }
        (SubspaceKind::Cylindrical, _) => format!("NAME_cylindrical_of({}, {})", q(0), q(1)),
        (SubspaceKind::TranslationalPlane, Section::Upper) if shared(task).is_some() => {
            format!("NAME_complex_of(0, {})", q(0))
        }
        (SubspaceKind::TranslationalPlane, _) => format!("NAME_complex_of({}, {})", q(0), q(1)),
        (SubspaceKind::TranslationalSpace, Section::Upper) if shared(task).is_some() => {
            format!("NAME_vector_of({}, {}, 0)", q(0), q(1))
        }
        (SubspaceKind::TranslationalSpace, _) => {
            format!("NAME_vector_of({}, {}, {})", q(0), q(1), q(2))
        }
    };
    let names: Vec<&str> = numbers.iter().map(|&i| task.coordinates[i].name).collect();
    let symbol = if section == Section::Lower { "v" } else { "b" };
    let geometry = if value.contains("g->") { "const NAME_geometry *g, " } else { "" };
    let mut text = String::new();
    let word = word(section);
    let _ = write!(
        text,
        "/* The displacement {symbol} of the {word} sections, for {}. */\n\
         static {of_type} NAME_{word}_displacement({geometry}const real q[])\n\
         {{\n    return {value};\n}}\n\n",
        names.join(", ")
    );
    text
}

/// The call of that function for the coordinates `q`.
pub fn call(task: &Task, forms: &ClosedForms, section: Section) -> String {
    let geometry = function(task, forms, section).contains("g->");
    let arguments = if geometry { "g, q" } else { "q" };
    format!("NAME_{}_displacement({arguments})", word(section))
}

/// The product of a displacement with `exp(I τ)`: on its right for the lower section, on its left for the upper one.
/// `tau` is a direction if `is_direction`, a number otherwise.
pub fn shifted(
    task: &Task,
    section: Section,
    displacement: &str,
    tau: &str,
    is_direction: bool,
) -> String {
    let (side, word) = match section {
        Section::Lower => ("after", "lower"),
        Section::Upper => ("before", "upper"),
    };
    let turn = || if is_direction { tau.to_owned() } else { format!("NAME_unit({tau})") };
    match intersection(task, section) {
        IntersectionMotion::None(_) => displacement.to_owned(),
        IntersectionMotion::Planar(PlanarMotion::Rotation) => {
            format!("NAME_planar_{side}({displacement}, {})", turn())
        }
        IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
            format!("NAME_planar_{side}_slide({displacement}, g->{word}_along, {tau})")
        }
        IntersectionMotion::Spherical(_) => {
            format!("NAME_spherical_{side}({displacement}, {})", turn())
        }
        IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
            format!("NAME_cylindrical_of({displacement}.angle + {tau}, {displacement}.advance)")
        }
        IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => {
            format!("NAME_cylindrical_of({displacement}.angle, {displacement}.advance + {tau})")
        }
        IntersectionMotion::Translational(_) => {
            format!("NAME_plus({displacement}, NAME_scaled(g->{word}_along, {tau}))")
        }
        IntersectionMotion::Spatial(_) => {
            format!("NAME_add({displacement}, {tau}, NAME_vector_of(0, 0, 1))")
        }
    }
}
