//! The motion files that are built into this crate and can be used by name.

/// A motion file that is built into this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MotionExample {
    /// The motion's name, which is also the file's name without `.toml`.
    pub name: &'static str,
    /// The example mechanism that the motion was made for.
    pub mechanism: &'static str,
    /// A description of one line.
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

/// The example with this name, if there is one.
pub fn find(name: &str) -> Option<&'static MotionExample> {
    MOTIONS.iter().find(|example| example.name == name)
}
