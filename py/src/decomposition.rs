//! The decomposition of a mechanism into two sections.

use crate::html::{self, digits};
use crate::pickle::pickled;
use opm_core::decomposition::Freedom;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator as core;
use opm_core::mechanism::leg::Leg;
use pyo3::prelude::*;

/// How the legs of a mechanism are split in two: the result of ``opm decompose``.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Decomposition {
    /// Name of the mechanism.
    name: String,
    /// Rank of all joint screws, lambda.
    rank: usize,
    /// Mobility of the mechanism, N.
    mobility: usize,
    /// Motions of the upper section with its imaginary joints, J; the number of these joints may be another.
    imaginary_joints: usize,
    /// Motions of the lower section with the imaginary joints held, M = N - J.
    first_section_motions: usize,
    /// Subspace of the lower section: ``"planar"``, for instance.
    lower: String,
    /// Subspace of the upper section; None where all legs move in one subspace.
    upper: Option<String>,
    /// The motion that both sections have in common; None where that is the identity alone.
    intersection: Option<Intersection>,
    /// The set in which the platform moves: ``"pair"`` of subgroups, one ``"subgroup"``, ``"free"``, as a leg that is its
    /// ``"stem"``, ``"constrained"`` by several legs, or ``"symmetric"``, the mirror image of the base.
    platform: String,
    /// What the platform does, in words: ``"translations of space"``.
    motion: String,
    /// One entry for each leg, in the order of the mechanism file.
    legs: Vec<LegSplit>,
}

/// The motion that both sections have in common, in base coordinates at home.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Intersection {
    /// ``"rotation"``, ``"translation"`` or ``"helical"``.
    kind: String,
    /// Unit vector of its positive direction, base coordinates.
    axis: Option<(f64, f64, f64)>,
    /// A point of the axis, metres; None for a translation.
    point: Option<(f64, f64, f64)>,
    /// Advance of a helical motion, metres per radian.
    pitch: Option<f64>,
}

/// How one leg is split between the two sections.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct LegSplit {
    /// Name of the leg.
    name: String,
    /// Joints in the lower section, base first.
    lower: Vec<String>,
    /// Joints in the upper section, base first.
    upper: Vec<String>,
    /// The imaginary joint at the split.
    imaginary: Option<String>,
    /// How the leg is solved: by its ``"sections"``, or ``"whole"``; then all its joints are in ``lower``.
    solved: String,
}

pickled!(Decomposition {
    name,
    rank,
    mobility,
    imaginary_joints,
    first_section_motions,
    lower,
    upper,
    intersection,
    platform,
    motion,
    legs,
});
pickled!(Intersection { kind, axis, point, pitch });
pickled!(LegSplit { name, lower, upper, imaginary, solved });

impl Decomposition {
    pub fn of(manipulator: &core::Manipulator) -> Self {
        let (found, mechanism) = (manipulator.decomposition(), manipulator.mechanism());
        let names = |leg: &Leg, freedoms: &[Freedom]| {
            let names = freedoms.iter().map(|freedom| leg.joints[freedom.joint].name.clone());
            let mut names: Vec<_> = names.collect();
            names.dedup();
            names
        };
        let splits = mechanism.legs.iter().zip(&found.legs).map(|(leg, split)| LegSplit {
            name: leg.name.clone(),
            lower: names(leg, &split.lower),
            upper: names(leg, &split.upper),
            imaginary: split.imaginary.then(|| leg.imaginary_name()),
            solved: if split.whole.is_some() { "whole" } else { "sections" }.to_owned(),
        });
        Self {
            name: mechanism.name.clone(),
            rank: found.lambda,
            mobility: found.mobility,
            imaginary_joints: found.imaginary_joints,
            first_section_motions: found.first_section_motions,
            lower: found.lower.name().to_owned(),
            upper: (found.upper != SubspaceClass::Identity).then(|| found.upper.name().to_owned()),
            intersection: Intersection::of(&found.intersection),
            platform: found.platform().name().to_owned(),
            motion: found.motion(),
            legs: splits.collect(),
        }
    }
}

impl Intersection {
    fn of(class: &SubspaceClass) -> Option<Self> {
        let (axis, point, pitch) = match class {
            SubspaceClass::Identity => return None,
            SubspaceClass::Rotation { axis, point } => (Some(axis), Some(point), None),
            SubspaceClass::Helical { axis, point, pitch } => {
                (Some(axis), Some(point), Some(*pitch))
            }
            SubspaceClass::Translation { axis } => (Some(axis), None, None),
            _ => (None, None, None),
        };
        Some(Self {
            kind: class.name().to_owned(),
            axis: axis.map(|a| (a.x, a.y, a.z)),
            point: point.map(|p| (p.x, p.y, p.z)),
            pitch,
        })
    }
}

#[pymethods]
impl Decomposition {
    fn __repr__(&self) -> String {
        let whole = self.legs.iter().any(|leg| leg.solved == "whole");
        let sections = match &self.upper {
            _ if whole => format!("{}, every leg by itself", self.motion),
            Some(upper) => format!("{} + {upper}", self.lower),
            None => self.lower.clone(),
        };
        let shared = match &self.intersection {
            Some(shared) => {
                let count = self.legs.iter().filter(|leg| leg.imaginary.is_some()).count();
                let joints = if count == 1 { "joint" } else { "joints" };
                format!(", {} in common, {count} imaginary {joints}", shared.kind)
            }
            None => String::new(),
        };
        format!("<Decomposition of {}: {sections}{shared}>", self.name)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "decomposition")
    }
}

#[pymethods]
impl Intersection {
    fn __repr__(&self) -> String {
        let Self { kind, axis, point, .. } = self;
        let text = |v: &Option<(f64, f64, f64)>| match v {
            Some((x, y, z)) => format!("({}, {}, {})", digits(*x), digits(*y), digits(*z)),
            None => "None".to_owned(),
        };
        let pitch = self.pitch.map_or_else(|| "None".to_owned(), digits);
        format!("Intersection({kind:?}, axis={}, point={}, pitch={pitch})", text(axis), text(point))
    }
}

#[pymethods]
impl LegSplit {
    fn __repr__(&self) -> String {
        let Self { name, lower, upper, imaginary, .. } = self;
        let imaginary = imaginary.as_deref().map_or_else(String::new, |i| format!(", {i}"));
        let lower = lower.join(" ");
        if self.solved == "whole" {
            return format!("<LegSplit {name}: {lower}, solved whole>");
        }
        format!("<LegSplit {name}: {lower} | {}{imaginary}>", upper.join(" "))
    }
}
