//! Pictures of the requested size.

use super::options::PictureSize;
use crate::args::PlotArgs;
use crate::failure::Failure;
use opm_plot::{Drawing, Size, TooSmall};

/// Makes a picture of the requested size from a figure.
pub fn drawn(
    args: &PlotArgs,
    draw: impl FnOnce(Option<Size>) -> Result<Drawing, TooSmall>,
) -> Result<Drawing, Failure> {
    draw(args.size.map(|size| size.0)).map_err(|error| match args.size {
        Some(PictureSize(Size { width, height })) => {
            Failure::flag("--size", format!("{width}x{height}: {error}"))
        }
        None => Failure::work(format!("{error}; choose fewer with --panels or --values")),
    })
}
