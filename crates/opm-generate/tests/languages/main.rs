//! Generated code of every language, run and compared with `opm-core`.

mod c;
mod comparison;
mod compiled;
mod drawn;
mod dynamics;
mod linuxcnc;
mod matlab;
mod names;
mod program;
mod python;
mod refused;
mod rust;
mod st;
