//! The mechanism files that come with this crate, so that they can be used by name anywhere.

/// A mechanism file inside this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// Its name: the mechanism's name, and the file's without `.toml`.
    pub name: &'static str,
    /// What it is, on one line.
    pub description: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

/// Every example, families first.
pub const EXAMPLES: &[Example] = &[
    Example {
        name: "plano-spherical-5dof",
        description: "3-PRR(RR) + RRS: two translations, three rotations (Selvi, section 3.1)",
        text: include_str!("../../mechanisms/plano-spherical-5dof.toml"),
    },
    Example {
        name: "translational-helical-3dof",
        description: "2-PPR + PPH: two translations, one rotation (Selvi, section 3.2)",
        text: include_str!("../../mechanisms/translational-helical-3dof.toml"),
    },
    Example {
        name: "plano-spherical-5dof-joints",
        description: "the same as plano-spherical-5dof, as a list of joints",
        text: include_str!("../../mechanisms/plano-spherical-5dof-joints.toml"),
    },
    Example {
        name: "translational-helical-3dof-joints",
        description: "the same as translational-helical-3dof, as a list of joints",
        text: include_str!("../../mechanisms/translational-helical-3dof-joints.toml"),
    },
    Example {
        name: "bennett-double-spherical-6r",
        description: "Bennett's double spherical 6R: one loop, one freedom (Selvi, Fig. 1)",
        text: include_str!("../../mechanisms/bennett-double-spherical-6r.toml"),
    },
];

/// The example of this name.
pub fn find(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().find(|example| example.name == name)
}

#[cfg(test)]
mod tests;
