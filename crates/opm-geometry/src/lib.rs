//! Subgroups of SE(3), and closed forms of the serial chains in them.
//!
//! This is the geometry that [`opm-core`](https://docs.rs/opm-core) is built on. That crate re-exports these
//! modules, and its docs have the conventions: SI units, radians, twists `(ω; v)` in base coordinates.
//!
//! | module | what it holds |
//! |---|---|
//! | [`chain`] | closed forms of serial chains in one subspace |
//! | [`group`] | subgroups of SE(3), their displacements, screws |
//! | [`numbers`] | what closed forms are written over: numbers of one pose, of a box of poses, of source code
//! | [`numeric`] | angles, rotations, quantities, small numerical methods |
//! | [`text`] | names and messages of others: visible, shortened |

// Layers: text, numeric, numbers, group, chain, boxes. Each uses only those before it (tests/tests/layers.rs).
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod boxes;
pub mod chain;
pub mod group;
pub mod numbers;
pub mod numeric;
pub mod text;
