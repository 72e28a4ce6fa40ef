//! Structured inputs: half and quarter turns about coordinate axes and diagonals, home, zeros, whole turns, symmetric
//! designs on their side and on their head. Every public conversion and solver, held against something that
//! does not know how it works.

mod algebra;
mod differential;
mod forward;
mod inverse;
mod linkages;
mod locate;
mod motions;
mod places;
