//! Names that are unique in a model.

use std::collections::BTreeSet;

/// A name that is not taken yet, as it is wanted or with underscores behind; it is then taken.
pub fn unique(taken: &mut BTreeSet<String>, wanted: String) -> String {
    let mut name = wanted;
    while !taken.insert(name.clone()) {
        name.push('_');
    }
    name
}
