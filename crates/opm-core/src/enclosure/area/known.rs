//! Which of the boundaries matter in the rectangle, and on which sides of them a point is in reach.

use super::{Reach, Set, Side};
use crate::enclosure::boundary::Truth;

/// Whether a leg reaches a point on known sides of all boundaries. Regions that are not sure are left out, if `sure`.
pub fn reaches(leg: &[Reach], sides: &[Truth], sure: bool) -> Truth {
    let mut found = Truth::No;
    for reach in leg.iter().filter(|reach| reach.sure || !sure) {
        found = found.max(in_reach(reach, sides));
    }
    found
}

/// Calls `matters` with the boundaries of unknown side on which it depends whether a leg reaches a point.
pub fn undecided(leg: &[Reach], sides: &[Truth], sure: bool, mut matters: impl FnMut(usize)) {
    if reaches(leg, sides, sure) != Truth::Maybe {
        return;
    }
    for reach in leg.iter().filter(|reach| reach.sure || !sure) {
        if in_reach(reach, sides) != Truth::Maybe {
            continue;
        }
        for set in [Some(&reach.whole), reach.hole.as_ref()].into_iter().flatten() {
            if in_set(set, sides) != Truth::Maybe {
                continue;
            }
            let all = Some(&set.all).filter(|_| in_all(set, sides) == Truth::Maybe);
            for side in all.into_iter().flatten().chain(&set.or) {
                if on(side, sides) == Truth::Maybe {
                    matters(side.boundary);
                }
            }
        }
    }
}

fn in_reach(reach: &Reach, sides: &[Truth]) -> Truth {
    let whole = in_set(&reach.whole, sides);
    match &reach.hole {
        Some(hole) if whole != Truth::No => whole.min(in_set(hole, sides).not()),
        _ => whole,
    }
}

fn in_set(set: &Set, sides: &[Truth]) -> Truth {
    let all = in_all(set, sides);
    set.or.as_ref().map_or(all, |side| all.max(on(side, sides)))
}

fn in_all(set: &Set, sides: &[Truth]) -> Truth {
    let mut all = Truth::Yes;
    for side in &set.all {
        all = all.min(on(side, sides));
    }
    all
}

fn on(side: &Side, sides: &[Truth]) -> Truth {
    let inner = sides[side.boundary];
    if side.inner { inner } else { inner.not() }
}
