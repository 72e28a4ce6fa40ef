//! Writes a drawing as PNG, with two pixels for one of a screen each way.

use crate::color::{Color as Rgb, WHITE};
use crate::drawing::{Drawing, Image, Path, Pen, Rect, Shape, Step, Text};
use crate::font::{Face, Stroke as Outline};
use png::{BitDepth, ColorType, Compression, EncodingError, PixelDimensions, Unit};
use tiny_skia::{
    Color, FillRule, FilterQuality, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, Stroke,
    StrokeDash, Transform,
};

/// The number of pixels of a PNG for one of a drawing, each way: for sharp screens and for print.
pub const SCALE: u32 = 2;

/// Why a drawing cannot be written as PNG.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no memory for so many pixels, or there are no pixels.
    #[error("a picture of {width} x {height} pixels")]
    Size {
        /// The number of pixels in a row.
        width: u32,
        /// The number of rows.
        height: u32,
    },
    /// The encoder failed.
    #[error("cannot encode the picture")]
    Encode(#[from] EncodingError),
}

/// Writes a drawing as the bytes of a PNG file; see also [`Drawing::to_png`].
///
/// # Errors
/// [`Error::Size`] if there is no memory for so many pixels.
pub fn write(drawing: &Drawing) -> Result<Vec<u8>, Error> {
    let pixels = |length: f64| (length * f64::from(SCALE)).round() as u32;
    let mut canvas = pixmap(pixels(drawing.size.width), pixels(drawing.size.height))?;
    canvas.fill(color(WHITE));
    shapes(&mut canvas, &drawing.shapes)?;
    encode(&canvas, ColorType::Rgb)
}

/// Writes an image of a drawing as a file of its own.
pub(crate) fn image(image: &Image) -> Result<Vec<u8>, Error> {
    encode(&raster(image)?, ColorType::Rgba)
}

fn pixmap(width: u32, height: u32) -> Result<Pixmap, Error> {
    Pixmap::new(width, height).ok_or(Error::Size { width, height })
}

/// Encodes a picture, with a channel of opacity (RGBA) or without one (RGB).
fn encode(canvas: &Pixmap, kind: ColorType) -> Result<Vec<u8>, Error> {
    /// The number of pixels in a metre: twice the 96 in an inch of a screen.
    const DENSITY: u32 = (96 * SCALE * 10_000).div_ceil(254);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, canvas.width(), canvas.height());
    encoder.set_color(kind);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    let (xppu, yppu) = (DENSITY, DENSITY);
    encoder.set_pixel_dims(Some(PixelDimensions { xppu, yppu, unit: Unit::Meter }));
    let pixels: Vec<u8> = match kind {
        ColorType::Rgba => canvas.data().to_vec(),
        _ => {
            canvas.data().as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
        }
    };
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

fn raster(image: &Image) -> Result<Pixmap, Error> {
    let mut canvas = pixmap(image.width, image.height)?;
    for (pixel, found) in canvas.pixels_mut().iter_mut().zip(&image.pixels) {
        if let Some(found) = found {
            *pixel = color(*found).premultiply().to_color_u8();
        }
    }
    Ok(canvas)
}

fn shapes(canvas: &mut Pixmap, shapes: &[Shape]) -> Result<(), Error> {
    shapes.iter().try_for_each(|shape| self::shape(canvas, shape))
}

fn shape(canvas: &mut Pixmap, shape: &Shape) -> Result<(), Error> {
    match shape {
        Shape::Area(path, color) => fill(canvas, trace(path), *color, scale()),
        Shape::Line(path, pen) => line(canvas, path, pen),
        Shape::Text(found) => text(canvas, found),
        Shape::Image { place, image } => {
            let Rect { x, y, width, height } = *place;
            let stretch = [width / f64::from(image.width), height / f64::from(image.height)];
            let [sx, sy] = stretch.map(|s| s as f32);
            let place = scale().pre_translate(x as f32, y as f32).pre_scale(sx, sy);
            let paint = PixmapPaint { quality: FilterQuality::Nearest, ..PixmapPaint::default() };
            canvas.draw_pixmap(0, 0, raster(image)?.as_ref(), &paint, place, None);
        }
        Shape::Group { shapes, .. } => self::shapes(canvas, shapes)?,
    }
    Ok(())
}

fn scale() -> Transform {
    Transform::from_scale(SCALE as f32, SCALE as f32)
}

fn color([r, g, b]: Rgb) -> Color {
    Color::from_rgba8(r, g, b, u8::MAX)
}

fn paint(rgb: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(color(rgb));
    paint
}

fn fill(canvas: &mut Pixmap, path: Option<tiny_skia::Path>, rgb: Rgb, place: Transform) {
    // An empty path is not drawn.
    if let Some(path) = path {
        canvas.fill_path(&path, &paint(rgb), FillRule::Winding, place, None);
    }
}

fn line(canvas: &mut Pixmap, path: &Path, pen: &Pen) {
    let Some(path) = trace(path) else { return };
    let dashes = pen.dashes.iter().map(|&length| length as f32).collect();
    let stroke = Stroke {
        width: pen.width as f32,
        line_join: LineJoin::Round,
        dash: StrokeDash::new(dashes, 0.0),
        ..Stroke::default()
    };
    canvas.stroke_path(&path, &paint(pen.color), &stroke, scale(), None);
}

fn text(canvas: &mut Pixmap, text: &Text) {
    let mut path = PathBuilder::new();
    for (glyph, at) in text.face.glyphs(&text.text) {
        let at = at as f32;
        for stroke in text.face.outline(glyph) {
            match stroke {
                Outline::Move([x, y]) => path.move_to(at + x, y),
                Outline::Line([x, y]) => path.line_to(at + x, y),
                Outline::Quad([a, b], [x, y]) => path.quad_to(at + a, b, at + x, y),
                Outline::Close => path.close(),
            }
        }
    }
    let [x, y] = text.start().map(|v| v as f32);
    let size = (text.size / Face::UNITS) as f32;
    let place = scale().pre_translate(x, y);
    let place = if text.turned { place.pre_rotate(-90.0) } else { place };
    fill(canvas, path.finish(), text.color, place.pre_scale(size, -size));
}

fn trace(path: &Path) -> Option<tiny_skia::Path> {
    let mut built = PathBuilder::new();
    for step in &path.0 {
        match *step {
            Step::Move([x, y]) => built.move_to(x as f32, y as f32),
            Step::Line([x, y]) => built.line_to(x as f32, y as f32),
            Step::Close => built.close(),
        }
    }
    built.finish()
}
