//! Descriptions of parallel manipulators, and the files that hold them.
//!
//! This is what [`opm-core`](https://docs.rs/opm-core) compiles into kinematics. That crate re-exports these modules,
//! and its docs have the conventions: SI units, radians, twists `(ω; v)` in base coordinates.
//!
//! | module | what it holds |
//! |---|---|
//! | [`mechanism`] | legs, joints, files, parametric families |
//! | [`table`] | lines, columns and units of CSV |
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `files` | reading mechanism files |
//! | `schema` | the JSON schema of these files |
//! | `serde` | `Serialize` for mechanisms |

// Layers: mechanism, table. Each uses only those before it (tests/tests/layers.rs).
pub mod mechanism;
pub mod table;

pub(crate) use opm_geometry::{chain, group, numeric, text};
