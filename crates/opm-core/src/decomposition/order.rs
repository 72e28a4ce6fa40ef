//! Which decompositions are listed: those into two groups with a motion in common, else that into one group, else those
//! into two groups that share the identity alone. Three translations are read before some others:
//!
//! * A mechanism whose legs have three sliders each moves in one group. Two planes of translations would do as well, and
//!   their coordinates are oblique.
//! * Three translations and a cylinder make a Schoenflies group. It is preferred alone, where it has closed forms.
//! * Three translations and a sphere share nothing. With an axis of the sphere, the translations make a Schoenflies group
//!   that shares this rotation with the sphere: then there is a height to carry, and an imaginary joint.

use super::mobility::Mobility;
use super::{Decomposition, Freedom, one_subspace, search};
use crate::group::subspace::SubspaceClass;
use crate::mechanism::Mechanism;

/// The decompositions that are listed; none where the mechanism has none.
pub(super) fn listed(mechanism: &Mechanism, report: &Mobility) -> Vec<Decomposition> {
    let alone = || one_subspace(mechanism, report);
    if let Some(alone) = alone().filter(|alone| translates(&alone.lower))
        && mechanism.legs.iter().all(|leg| Freedom::of_leg(leg).len() == report.lambda)
    {
        return vec![alone];
    }
    let sharing = search(mechanism, report, 1).0;
    let apart = || search(mechanism, report, 0).0;
    if sharing.iter().all(|pair| has(pair, translates))
        && let Some(alone) = alone()
    {
        return vec![alone];
    }
    if sharing.is_empty() {
        return apart();
    }
    if sharing
        .iter()
        .all(|pair| has(pair, |class| matches!(class, SubspaceClass::Schoenflies { .. })))
    {
        let apart = apart();
        if apart.iter().any(|pair| has(pair, translates)) {
            return apart;
        }
    }
    sharing
}

fn translates(class: &SubspaceClass) -> bool {
    matches!(class, SubspaceClass::TranslationalSpace)
}

/// Whether one of the two sections moves in such a group.
fn has(pair: &Decomposition, group: fn(&SubspaceClass) -> bool) -> bool {
    group(&pair.lower) || group(&pair.upper)
}
