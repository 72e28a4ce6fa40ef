//! The motions that come with this crate, so that they can be used by name anywhere.

/// A motion file inside this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionExample {
    /// Its name: the motion's name, and the file's without `.toml`.
    pub name: &'static str,
    /// The example mechanism that it was made for.
    pub mechanism: &'static str,
    /// What it is, on one line.
    pub description: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

/// Every example, in the order of the mechanisms.
pub const MOTIONS: &[MotionExample] = &[
    MotionExample {
        name: "plano-spherical-sinusoids",
        mechanism: "plano-spherical-5dof",
        description: "sinusoids of five frequencies and phases, in the way of Selvi, Figs. 7-10",
        text: include_str!("../../motions/plano-spherical-sinusoids.toml"),
    },
    MotionExample {
        name: "translational-helical-sinusoids",
        mechanism: "translational-helical-3dof",
        description: "sinusoids of three frequencies and phases, in the way of Selvi, Figs. 14-16",
        text: include_str!("../../motions/translational-helical-sinusoids.toml"),
    },
];

/// The example of this name.
pub fn find(name: &str) -> Option<&'static MotionExample> {
    MOTIONS.iter().find(|example| example.name == name)
}
