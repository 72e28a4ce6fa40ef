//! The formats of pictures, by the endings of their names.

use opm_plot::Drawing;
use std::io;
use std::path::Path;

/// What is said of a name with another ending.
pub const EXPECTED: &str = "expected a name that ends in .svg, .png or .pdf";

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    Svg,
    Png,
    Pdf,
}

impl Ending {
    /// The format of a file.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }

    /// The file of a drawing.
    pub fn bytes(self, drawing: &Drawing) -> io::Result<Vec<u8>> {
        match self {
            Self::Svg => drawing.to_svg().map(String::into_bytes).map_err(io::Error::other),
            Self::Png => drawing.to_png().map_err(io::Error::other),
            Self::Pdf => drawing.to_pdf(),
        }
    }
}
