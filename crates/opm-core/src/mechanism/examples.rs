//! The mechanism files that are built into this crate and can be used by name.

/// A mechanism file that is built into this crate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The mechanism's name, which is also the file's name without `.toml`.
    pub name: &'static str,
    /// A description on one line.
    pub description: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

/// Every example: first the paper's mechanisms, families before joint lists, then other linkages, then
/// those designed for this project, then those of one subspace from the literature, and those with legs that are solved whole.
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
    Example {
        name: "bennett-plano-spherical-6r",
        description: "Bennett's plano-spherical 6R: one loop, one freedom (Bennett 1905)",
        text: include_str!("../../mechanisms/bennett-plano-spherical-6r.toml"),
    },
    Example {
        name: "sarrus",
        description: "Sarrus' linkage, two planes: one loop, one translation (Sarrus 1853)",
        text: include_str!("../../mechanisms/sarrus.toml"),
    },
    Example {
        name: "planar-planar-5dof",
        description: "3-PRR(RR) + RR(RRR), two planes: three translations, two rotations",
        text: include_str!("../../mechanisms/planar-planar-5dof.toml"),
    },
    Example {
        name: "planar-planar-5dof-joints",
        description: "the same as planar-planar-5dof, as a list of joints",
        text: include_str!("../../mechanisms/planar-planar-5dof-joints.toml"),
    },
    Example {
        name: "double-spherical-5dof",
        description: "3-RRR(RR) + RR(S), two centres: five rotations",
        text: include_str!("../../mechanisms/double-spherical-5dof.toml"),
    },
    Example {
        name: "plano-cylindrical-4dof",
        description: "3-RRR(R) + RRR(H), axis in the plane: two translations, two rotations",
        text: include_str!("../../mechanisms/plano-cylindrical-4dof.toml"),
    },
    Example {
        name: "schoenflies-4dof",
        description: "2-RRR(H|P), axis perpendicular to the plane: three translations, one rotation",
        text: include_str!("../../mechanisms/schoenflies-4dof.toml"),
    },
    Example {
        name: "schoenflies-lift-4dof",
        description: "RRR(P) + RR(C), a motor in the upper section: three translations, one rotation",
        text: include_str!("../../mechanisms/schoenflies-lift-4dof.toml"),
    },
    Example {
        name: "translational-planar-4dof",
        description: "4-PP(RR): three translations, one rotation",
        text: include_str!("../../mechanisms/translational-planar-4dof.toml"),
    },
    Example {
        name: "planar-3rrr",
        description: "planar 3-RRR, one subspace: two translations, one rotation",
        text: include_str!("../../mechanisms/planar-3rrr.toml"),
    },
    Example {
        name: "planar-3rpr",
        description: "planar 3-RPR of Innocenti and Merlet, one subspace: six assemblies",
        text: include_str!("../../mechanisms/planar-3rpr.toml"),
    },
    Example {
        name: "agile-eye",
        description: "spherical 3-RRR with orthogonal axes (Gosselin and Hamel): three rotations",
        text: include_str!("../../mechanisms/agile-eye.toml"),
    },
    Example {
        name: "orbita",
        description: "spherical 3-RRR with coaxial motors (Pollen Robotics): three rotations",
        text: include_str!("../../mechanisms/orbita.toml"),
    },
    Example {
        name: "five-bar",
        description: "planar five-bar (dual-arm SCARA), one subspace: two translations, an angle that follows",
        text: include_str!("../../mechanisms/five-bar.toml"),
    },
    Example {
        name: "schoenflies-column-4dof",
        description: "three arms, one on a column, in one subspace: three translations, one rotation",
        text: include_str!("../../mechanisms/schoenflies-column-4dof.toml"),
    },
    Example {
        name: "cartesian-wrist-6dof",
        description: "three cartesian arms below an Agile Eye: three translations, three rotations",
        text: include_str!("../../mechanisms/cartesian-wrist-6dof.toml"),
    },
    Example {
        name: "delta",
        description: "Delta, 3-RUU (Clavel), as ABB's FlexPicker: three translations",
        text: include_str!("../../mechanisms/delta.toml"),
    },
    Example {
        name: "linear-delta",
        description: "linear Delta, 3-PUU with upright rails: three translations",
        text: include_str!("../../mechanisms/linear-delta.toml"),
    },
    Example {
        name: "orthoglide",
        description: "Orthoglide, 3-PUU with orthogonal rails (Wenger and Chablat): three translations",
        text: include_str!("../../mechanisms/orthoglide.toml"),
    },
    Example {
        name: "tripteron",
        description: "Tripteron, 3-PRRR (Gosselin and Kong), orthogonal: three translations",
        text: include_str!("../../mechanisms/tripteron.toml"),
    },
    Example {
        name: "3-upu",
        description: "3-UPU (Tsai): three translations",
        text: include_str!("../../mechanisms/3-upu.toml"),
    },
    Example {
        name: "quadrupteron",
        description: "Quadrupteron, 3-PRRU + PRRR (Gosselin): three translations, one rotation",
        text: include_str!("../../mechanisms/quadrupteron.toml"),
    },
    Example {
        name: "stewart",
        description: "Gough-Stewart platform, 6-UPS: six freedoms",
        text: include_str!("../../mechanisms/stewart.toml"),
    },
    Example {
        name: "hexa",
        description: "Hexa, 6-RUS (Pierrot): six freedoms",
        text: include_str!("../../mechanisms/hexa.toml"),
    },
    Example {
        name: "tricept",
        description: "Tricept, 3-UPS + UP (Neumann): a position, and angles that follow",
        text: include_str!("../../mechanisms/tricept.toml"),
    },
    Example {
        name: "ankle",
        description: "a humanoid's ankle, 2-RSS + U: two rotations",
        text: include_str!("../../mechanisms/ankle.toml"),
    },
];

/// Further architectures, which `opm new` writes with dimensions of one's own.
pub const TEMPLATES: &[Example] = &[
    Example {
        name: "planar-3rpr-symmetric",
        description: "planar 3-RPR, all legs alike: two translations, one rotation",
        text: include_str!("../../templates/planar-3rpr-symmetric.toml"),
    },
    Example {
        name: "spherical-3rrr",
        description: "spherical 3-RRR by its arcs (Gosselin and Angeles): three rotations",
        text: include_str!("../../templates/spherical-3rrr.toml"),
    },
    Example {
        name: "hexapod",
        description: "Gough-Stewart platform 6-6, 6-UPS: six freedoms",
        text: include_str!("../../templates/hexapod.toml"),
    },
    Example {
        name: "hexapod-6-3",
        description: "Gough-Stewart platform 6-3, 6-UPS: six freedoms",
        text: include_str!("../../templates/hexapod-6-3.toml"),
    },
    Example {
        name: "3-rps",
        description: "3-RPS (Hunt): a height, two tilts, and a drift that follows",
        text: include_str!("../../templates/3-rps.toml"),
    },
    Example {
        name: "3-prs",
        description: "3-PRS with upright rails (Carretero): a height, two tilts, and a drift that follows",
        text: include_str!("../../templates/3-prs.toml"),
    },
    Example {
        name: "exechon",
        description: "Exechon, 2-UPR + SPR (Neumann): a height, two tilts, and a drift that follows",
        text: include_str!("../../templates/exechon.toml"),
    },
];

/// Those whose legs are split into two sections, or move in one subspace.
pub const SPLIT: &[Example] = EXAMPLES.split_at(EXAMPLES.len() - WHOLE).0;

/// The number of those whose legs are solved whole, which come last.
const WHOLE: usize = 10;

/// The example or the template with this name, if there is one.
pub fn find(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().chain(TEMPLATES).find(|example| example.name == name)
}

#[cfg(test)]
mod tests;
