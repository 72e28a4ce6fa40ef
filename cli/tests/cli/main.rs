//! Tests of the program as a user runs it: output, files and exit status.

mod analyze;
mod aspects;
mod bad_input;
mod batch;
mod calibrate;
mod check;
mod convert;
mod decompose;
mod design;
mod efforts;
mod explore;
mod export;
mod fk;
mod format;
mod generate;
mod ik;
mod inspect;
mod interference;
mod kind;
mod linkage;
mod measure;
mod misses;
mod new;
mod plot;
mod run;
mod shard;
mod small;
mod tables;
mod trajectory;
mod velocity;
mod workspace;

/// The paper's first manipulator, as it is shipped.
const PLANO: &str = "plano-spherical-5dof";
/// The paper's second manipulator, as it is shipped.
const HELICAL: &str = "translational-helical-3dof";
