//! What the platform does, and how legs are solved that are not split.

use super::Way;
use crate::text::Table;
use opm_core::decomposition::{LegSplit, PlatformSet};
use opm_core::group::subspace::SubspaceClass;
use opm_core::mechanism::joint::JointKind;
use opm_core::mechanism::leg::Leg;
use serde_json::{Value, json};

impl Way<'_> {
    /// The set in which the platform moves.
    pub(super) fn platform(&self) -> Value {
        let d = self.decomposition;
        let kind = d.platform();
        let subspace = match kind {
            PlatformSet::Pair => None,
            PlatformSet::Subgroup => Some(d.lower.name()),
            PlatformSet::Free => Some(SubspaceClass::Full.name()),
            PlatformSet::Stem(_) | PlatformSet::Constrained | PlatformSet::Symmetric => None,
        };
        let stem = match kind {
            PlatformSet::Stem(leg) => Some(self.legs[leg].name),
            PlatformSet::Pair
            | PlatformSet::Subgroup
            | PlatformSet::Free
            | PlatformSet::Constrained
            | PlatformSet::Symmetric => None,
        };
        let motion = self.motion();
        json!({ "kind": kind.name(), "subspace": subspace, "stem": stem, "motion": motion })
    }

    /// How legs are solved that are not split.
    pub(super) fn whole(&self) -> String {
        let mut legs = Table::new(["leg", "joints", "solved in this order"]);
        for leg in &self.legs {
            let step = |step: &Value| {
                let sign = if step["choice"] == true { "±" } else { "" };
                Some(format!("{}{sign}", step["joint"].as_str()?))
            };
            let steps: Vec<String> = leg.kernels.iter().filter_map(step).collect();
            legs.row([leg.name, &leg.lower.join(" "), &steps.join(" ")]);
        }
        format!("platform        {}\n\n{legs}", self.motion())
    }

    /// What the platform does, in words.
    fn motion(&self) -> String {
        let motion = self.decomposition.motion();
        match self.decomposition.platform() {
            PlatformSet::Stem(leg) => format!("{motion}: {}", self.legs[leg].name),
            PlatformSet::Pair
            | PlatformSet::Subgroup
            | PlatformSet::Free
            | PlatformSet::Constrained
            | PlatformSet::Symmetric => motion,
        }
    }

    /// What is told of legs that are solved whole.
    pub(super) fn solved_whole(&self) -> String {
        let could = match self.decomposition.platform() {
            PlatformSet::Free => "each leg lets the platform do everything",
            PlatformSet::Constrained | PlatformSet::Symmetric => {
                "some legs let the platform do less than it could"
            }
            PlatformSet::Pair | PlatformSet::Subgroup | PlatformSet::Stem(_) => {
                "each leg lets the platform do that, or more"
            }
        };
        format!(
            "Every leg is solved by itself, one joint after the other: {could}. There is no imaginary joint."
        )
    }
}

/// The steps by which a whole leg is solved.
pub(super) fn kernels(leg: &Leg, split: &LegSplit) -> Vec<Value> {
    let Some(whole) = &split.whole else { return Vec::new() };
    // Universal and cylindrical joints are two of the joints of a whole leg, and the two hinges of a parallelogram are one.
    let names: Vec<&str> = (leg.joints.iter().filter(|joint| !joint.turns_back))
        .flat_map(|joint| match joint.kind {
            JointKind::Spherical => vec![&*joint.name],
            JointKind::Revolute
            | JointKind::Prismatic
            | JointKind::Helical { .. }
            | JointKind::Cylindrical
            | JointKind::Universal { .. } => {
                joint.coordinates.iter().map(|c| &*c.name).collect::<Vec<_>>()
            }
        })
        .collect();
    whole
        .steps()
        .map(|step| {
            json!({
                "joint": names.get(step.joint),
                "root": step.root,
                "invariant": step.invariant,
                "choice": whole.choosing_joints().contains(&step.joint),
            })
        })
        .collect()
}
