//! Why a leg has no closed form.

use crate::chain::ChainError;
use crate::chain::whole::NoOrder;
use crate::decomposition::HeightMiss;
use crate::mechanism::leg::Section;

/// Why a leg has no closed form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefusedLeg {
    /// The leg's two sections have more freedoms than the subspaces, so that it can move with the platform held.
    #[error("{}", freedoms(*lower, *upper, *dim_lower, *dim_upper, *bridged))]
    Freedoms {
        /// The number of freedoms in its lower section.
        lower: usize,
        /// The number of freedoms in its upper section.
        upper: usize,
        /// The dimension of the lower subspace.
        dim_lower: usize,
        /// The dimension of the upper subspace; zero where all legs move in one subgroup.
        dim_upper: usize,
        /// Whether the two subspaces share a motion.
        bridged: bool,
    },
    /// Not exactly one joint of a Schoenflies section changes the height.
    #[error("{}", .0.of_leg())]
    Height(#[from] HeightMiss),
    /// It cannot be solved one joint after the other.
    #[error("it cannot be solved one joint after the other: {0}")]
    Whole(#[from] NoOrder),
    /// One of the leg's sections has no closed form.
    #[error("its {section} section ({}) has no closed form: {error}", joints.join(", "))]
    Chain {
        /// The section.
        section: Section,
        /// The names of its joints, base first, and "the imaginary joint" if it belongs to the section.
        joints: Vec<String>,
        /// Why it has no closed form.
        error: ChainError,
    },
}

/// What the numbers of freedoms in a leg are, and how many they may be.
fn freedoms(
    lower: usize,
    upper: usize,
    dim_lower: usize,
    dim_upper: usize,
    bridged: bool,
) -> String {
    let plural = if lower == 1 { "" } else { "s" };
    if dim_upper == 0 {
        return format!(
            "{lower} freedom{plural}, expected {dim_lower} at most, those of its subspace"
        );
    }
    let expected = if bridged {
        format!("at most {dim_lower} and {}, or {} and {dim_upper}", dim_upper - 1, dim_lower - 1)
    } else {
        format!("at most {dim_lower} and {dim_upper}")
    };
    format!(
        "{lower} freedom{plural} in its lower section and {upper} in its upper one, expected {expected}: \
         it can move while the platform is held"
    )
}
