//! Colours that people with any kind of colour vision can tell apart.

use colorous::{CIVIDIS, VIRIDIS};

/// An opaque colour: red, green, blue.
pub type Color = [u8; 3];

/// The colour of text and axes.
pub const INK: Color = [0x22, 0x22, 0x22];
/// The colour of notes and ticks.
pub const FAINT: Color = [0x5a, 0x5a, 0x5a];
/// The colour of grid lines.
pub const GRID: Color = [0xe2, 0xe2, 0xe2];
/// The colour of spans of time that are not valid.
pub const SHADE: Color = [0xf6, 0xdc, 0xd2];
/// The colour of marks of violations.
pub const ALARM: Color = [0xb0, 0x3a, 0x12];
/// The colour of dots and bars.
pub const DOT: Color = [0x00, 0x72, 0xb2];
/// The background.
pub const WHITE: Color = [0xff; 3];

/// The colours of M. Okabe and K. Ito (jfly.uni-koeln.de/color), without the yellow, which does not stand out
/// from white.
const OKABE_ITO: [Color; 7] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0x00, 0x00, 0x00],
];
/// Further lines differ by their dashes: lengths of strokes and gaps, in pixels.
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.5], &[9.0, 3.0, 2.0, 3.0]];

/// The colour and the dashes of line number `i` of a panel. They repeat after 28 lines.
pub fn line(i: usize) -> (Color, &'static [f64]) {
    let dashes = DASHES[i / OKABE_ITO.len() % DASHES.len()];
    (OKABE_ITO[i % OKABE_ITO.len()], dashes)
}

/// A map from numbers to colours, perceptually uniform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// The map for slices and values.
    Viridis,
    /// The map for numbers of poses.
    Cividis,
}

impl Map {
    /// The share of a map that is used: its bright end is lost on white paper.
    const END: f64 = 0.95;

    /// The colour for a share from 0 to 1. Other numbers are clamped.
    pub fn color(self, share: f64) -> Color {
        let gradient = match self {
            Self::Viridis => VIRIDIS,
            Self::Cividis => CIVIDIS,
        };
        let color = gradient.eval_continuous(share.clamp(0.0, 1.0) * Self::END);
        [color.r, color.g, color.b]
    }
}
