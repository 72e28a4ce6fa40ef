//! Colours that people with any kind of colour vision tell apart.

use colorous::{CIVIDIS, VIRIDIS};

/// An opaque colour: red, green, blue.
pub type Color = [u8; 3];

/// Text and axes.
pub const INK: Color = [0x22, 0x22, 0x22];
/// What stands back: notes, ticks.
pub const FAINT: Color = [0x5a, 0x5a, 0x5a];
/// Lines of the grid.
pub const GRID: Color = [0xe2, 0xe2, 0xe2];
/// Spans of time that are not valid.
pub const SHADE: Color = [0xf6, 0xdc, 0xd2];
/// Marks of violations.
pub const ALARM: Color = [0xb0, 0x3a, 0x12];
/// Dots of a cloud.
pub const DOT: Color = [0x00, 0x72, 0xb2];
/// The ground.
pub const WHITE: Color = [0xff; 3];

/// The colours of M. Okabe and K. Ito (jfly.uni-koeln.de/color) that stand out from white: all but
/// the yellow.
const OKABE_ITO: [Color; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x00, 0x00],
];
/// Lines beyond the colours differ by their dashes: lengths of strokes and gaps.
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.5], &[9.0, 3.0, 2.0, 3.0]];

/// How line number `i` of a panel looks: its colour and its dashes. They repeat after 28.
pub fn line(i: usize) -> (Color, &'static [f64]) {
    let dashes = DASHES[i / OKABE_ITO.len() % DASHES.len()];
    (OKABE_ITO[i % OKABE_ITO.len()], dashes)
}

/// Maps of a scalar, perceptually uniform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// Slices and values.
    Viridis,
    /// Numbers of poses.
    Cividis,
}

impl Map {
    /// The bright end of a map is lost on white paper: maps are cut there.
    const END: f64 = 0.95;

    /// The colour of a share from 0 to 1; what is outside is clamped.
    pub fn color(self, share: f64) -> Color {
        let gradient = match self {
            Self::Viridis => VIRIDIS,
            Self::Cividis => CIVIDIS,
        };
        let color = gradient.eval_continuous(share.clamp(0.0, 1.0) * Self::END);
        [color.r, color.g, color.b]
    }
}
