//! Writes a drawing as PDF, one page as large as the drawing. Shapes stay shapes, for print at any size; texts are
//! outlines, as in SVG.

use crate::color::{Color, WHITE};
use crate::drawing::{Drawing, Image, Path, Pen, Rect, Shape, Step, Text};
use crate::font::{Face, LONGEST, Stroke, shortened};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::LineJoinStyle;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect as PageBox, Ref, TextStr};
use std::io::{self, Write};

/// The points of a pixel: 72 points are an inch, and 96 pixels.
const POINTS: f32 = 0.75;

/// Writes a drawing as the bytes of a PDF file; see also [`Drawing::to_pdf`].
///
/// # Errors
/// The bytes cannot be compressed.
pub fn write(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let [width, height] = [drawing.size.width, drawing.size.height].map(|side| side as f32);
    let mut page = Page { content: Content::new(), images: Vec::new() };
    // From pixels, with y down, to points, with y up.
    page.content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, POINTS * height]);
    page.fill(WHITE).rect(0.0, 0.0, width, height).fill_nonzero();
    page.shapes(&drawing.shapes);

    let mut next = 0;
    let mut number = || {
        next += 1;
        Ref::new(next)
    };
    let mut pdf = Pdf::new();
    let [catalog, tree, only, stream, info] = std::array::from_fn(|_| number());
    pdf.catalog(catalog).pages(tree);
    pdf.document_info(info).title(TextStr(&shortened(&drawing.title, LONGEST))).finish();
    pdf.pages(tree).kids([only]).count(1);
    let images: Vec<Ref> = page.images.iter().map(|_| number()).collect();
    let mut written = pdf.page(only);
    written.parent(tree).contents(stream);
    written.media_box(PageBox::new(0.0, 0.0, POINTS * width, POINTS * height));
    let mut resources = written.resources();
    let mut names = resources.x_objects();
    for (i, &image) in images.iter().enumerate() {
        names.pair(Name(image_name(i).as_bytes()), image);
    }
    names.finish();
    resources.finish();
    written.finish();
    for (image, at) in page.images.iter().zip(images) {
        embed(&mut pdf, image, at, number())?;
    }
    pdf.stream(stream, &packed(&page.content.finish())?).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

fn image_name(number: usize) -> String {
    format!("Im{number}")
}

fn packed(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// Writes an image, and the mask of its transparent pixels.
fn embed(pdf: &mut Pdf, image: &Image, at: Ref, mask: Ref) -> io::Result<()> {
    let [width, height] = [image.width, image.height].map(|side| side as i32);
    let colors: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.unwrap_or(WHITE)).collect();
    let opaque: Vec<u8> =
        image.pixels.iter().map(|pixel| if pixel.is_some() { u8::MAX } else { 0 }).collect();
    let (colors, opaque) = (packed(&colors)?, packed(&opaque)?);
    let mut object = pdf.image_xobject(at, &colors);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8);
    object.color_space().device_rgb();
    object.s_mask(mask);
    object.finish();
    let mut object = pdf.image_xobject(mask, &opaque);
    object.filter(Filter::FlateDecode);
    object.width(width).height(height).bits_per_component(8);
    object.color_space().device_gray();
    Ok(())
}

/// The content of the page, and the images in it.
struct Page<'a> {
    content: Content,
    images: Vec<&'a Image>,
}

impl<'a> Page<'a> {
    fn shapes(&mut self, shapes: &'a [Shape]) {
        for shape in shapes {
            match shape {
                Shape::Area(path, color) => {
                    self.fill(*color);
                    self.trace(path);
                    self.content.fill_nonzero();
                }
                Shape::Line(path, pen) => self.line(path, pen),
                Shape::Text(text) => self.text(text),
                Shape::Image { place, image } => self.image(*place, image),
                Shape::Group { shapes, .. } => self.shapes(shapes),
            }
        }
    }

    fn fill(&mut self, color: Color) -> &mut Content {
        let [r, g, b] = shares(color);
        self.content.set_fill_rgb(r, g, b)
    }

    fn trace(&mut self, path: &Path) {
        for step in &path.0 {
            match *step {
                Step::Move([x, y]) => self.content.move_to(x as f32, y as f32),
                Step::Line([x, y]) => self.content.line_to(x as f32, y as f32),
                Step::Close => self.content.close_path(),
            };
        }
    }

    fn line(&mut self, path: &Path, pen: &Pen) {
        let [r, g, b] = shares(pen.color);
        self.content.set_stroke_rgb(r, g, b).set_line_width(pen.width as f32);
        self.content.set_line_join(LineJoinStyle::RoundJoin);
        self.content.set_dash_pattern(pen.dashes.iter().map(|&length| length as f32), 0.0);
        self.trace(path);
        self.content.stroke();
    }

    fn text(&mut self, text: &Text) {
        let size = (text.size / Face::UNITS) as f32;
        let [x, y] = text.at.map(|value| value as f32);
        self.content.save_state();
        // Glyphs have y upwards; a text from bottom to top is turned.
        let turned = [0.0, -size, -size, 0.0, x, y];
        self.content.transform(if text.turned { turned } else { [size, 0.0, 0.0, -size, x, y] });
        self.fill(text.color);
        for (glyph, at) in text.face.glyphs(&text.text) {
            self.glyph(&text.face.outline(glyph), at as f32);
        }
        self.content.restore_state();
    }

    fn glyph(&mut self, outline: &[Stroke], at: f32) {
        if outline.is_empty() {
            return;
        }
        let mut from = [0.0; 2];
        for stroke in outline {
            match *stroke {
                Stroke::Move([x, y]) => {
                    self.content.move_to(at + x, y);
                    from = [x, y];
                }
                Stroke::Line([x, y]) => {
                    self.content.line_to(at + x, y);
                    from = [x, y];
                }
                Stroke::Quad(control, to) => {
                    // The cubic curve with the same shape.
                    let toward = |end: [f32; 2]| [0, 1].map(|i| (end[i] + 2.0 * control[i]) / 3.0);
                    let ([a, b], [c, d]) = (toward(from), toward(to));
                    self.content.cubic_to(at + a, b, at + c, d, at + to[0], to[1]);
                    from = to;
                }
                Stroke::Close => {
                    self.content.close_path();
                }
            }
        }
        self.content.fill_nonzero();
    }

    fn image(&mut self, place: Rect, image: &'a Image) {
        let Rect { x, y, width, height } = place;
        let [x, y, width, height] = [x, y, width, height].map(|value| value as f32);
        let name = image_name(self.images.len());
        self.images.push(image);
        self.content.save_state();
        // An image is a square of side one, with its first row on top.
        self.content.transform([width, 0.0, 0.0, -height, x, y + height]);
        self.content.x_object(Name(name.as_bytes()));
        self.content.restore_state();
    }
}

fn shares(color: Color) -> [f32; 3] {
    color.map(|value| f32::from(value) / 255.0)
}
