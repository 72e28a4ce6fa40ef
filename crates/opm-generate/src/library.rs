//! The functions and types that generated code is put together from: only those are written that it needs.

mod bodies;
mod complex;
mod conditions;
mod displacements;
mod dynamics;
mod joints;
mod linear;
mod numbers;
mod orientation;
mod others;
mod planar;
mod screws;
mod space;
mod spherical;
mod tolerances;
mod types;

use crate::trace::*;
use crate::tree::{Constant, Function, Struct, Type};
pub use bodies::*;
pub use complex::*;
pub use conditions::*;
pub use displacements::*;
pub use dynamics::*;
pub use joints::*;
pub use linear::*;
pub use numbers::*;
pub use orientation::*;
pub use screws::*;
pub use space::*;
pub use spherical::*;
use std::sync::OnceLock;
use tolerances::constants;
pub use tolerances::*;
pub use types::*;

/// All functions, in an order in which each knows those before it.
pub fn functions() -> &'static [Function] {
    static ALL: OnceLock<Vec<Function>> = OnceLock::new();
    ALL.get_or_init(|| {
        [
            numbers::functions(),
            complex::functions(),
            space::functions(),
            displacements::functions(),
            planar::functions(),
            spherical::functions(),
            others::functions(),
            conditions::functions(),
            joints::functions(),
            bodies::functions(),
            screws::functions(),
            orientation::functions(),
            linear::functions(),
            dynamics::functions(),
        ]
        .concat()
    })
}

/// Those of the functions that others need, directly or not.
pub fn functions_for(others: &[Function]) -> Vec<Function> {
    let mut used: Vec<String> = others.iter().flat_map(Function::calls).collect();
    let mut taken = vec![false; functions().len()];
    while let Some(name) = used.pop() {
        if let Some(place) = functions().iter().position(|function| function.name == name)
            && !taken[place]
        {
            taken[place] = true;
            used.extend(functions()[place].calls());
        }
    }
    functions().iter().zip(taken).filter(|(_, taken)| *taken).map(|(one, _)| one.clone()).collect()
}

/// The structs of a geometry, and others, that types need.
pub fn structs_for(types: impl Iterator<Item = Type>) -> [Vec<Struct>; 2] {
    let others = [displacements::structs(), bodies::structs(), screws::structs()].concat();
    let mut all = [[types::structs(), dynamics::structs()].concat(), others];
    let mut used: Vec<String> = types.filter_map(Type::into_struct).collect();
    let mut needed = Vec::new();
    while let Some(name) = used.pop() {
        if !needed.contains(&name) {
            let found = all.iter().flatten().find(|one| one.name == name);
            let members = found.into_iter().flat_map(|one| &one.members);
            used.extend(members.filter_map(|m| m.kind.clone().into_struct()));
            needed.push(name);
        }
    }
    all.iter_mut().for_each(|list| list.retain(|one| needed.contains(&one.name)));
    all
}

/// The constants that functions need.
pub fn constants_for(functions: &[Function]) -> Vec<Constant> {
    let used: Vec<String> = functions.iter().flat_map(Function::constants).collect();
    constants_named(|name| used.iter().any(|used| used == name))
}

/// The constants whose names are needed.
pub fn constants_named(is_needed: impl Fn(&str) -> bool) -> Vec<Constant> {
    let mut all = constants();
    all.retain(|constant| is_needed(&constant.name));
    all
}
