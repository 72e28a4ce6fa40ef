//! Writes a drawing as PDF, one page as large as the drawing. Shapes stay shapes, for print at any size; texts are text, with
//! what is used of the fonts in the file.

use crate::color::{Color, WHITE};
use crate::drawing::{Drawing, Image, Path, Pen, Rect, Shape, Step, Text};
use crate::font::{CAPITALS, Face, LONGEST, shortened};
use crate::subset::subset;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect as PageBox, Ref, Str, TextStr};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// The points of a pixel: 72 points are an inch, and 96 pixels.
const POINTS: f32 = 0.75;

/// Writes a drawing as the bytes of a PDF file; see also [`Drawing::to_pdf`].
///
/// # Errors
/// The bytes cannot be compressed.
pub fn write(drawing: &Drawing) -> io::Result<Vec<u8>> {
    let [width, height] = [drawing.size.width, drawing.size.height].map(|side| side as f32);
    let mut page = Page { content: Content::new(), images: Vec::new(), glyphs: BTreeMap::new() };
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
    let fonts: Vec<Ref> = page.glyphs.keys().map(|_| number()).collect();
    let mut written = pdf.page(only);
    written.parent(tree).contents(stream);
    written.media_box(PageBox::new(0.0, 0.0, POINTS * width, POINTS * height));
    let mut resources = written.resources();
    let mut names = resources.x_objects();
    for (i, &image) in images.iter().enumerate() {
        names.pair(Name(image_name(i).as_bytes()), image);
    }
    names.finish();
    let mut names = resources.fonts();
    for (&face, &font) in page.glyphs.keys().zip(&fonts) {
        names.pair(Name(font_name(face).as_bytes()), font);
    }
    names.finish();
    resources.finish();
    written.finish();
    for (image, at) in page.images.iter().zip(images) {
        embed(&mut pdf, image, at, number())?;
    }
    for ((&face, glyphs), at) in page.glyphs.iter().zip(fonts) {
        embed_font(&mut pdf, (face, glyphs), at, std::array::from_fn(|_| number()))?;
    }
    pdf.stream(stream, &packed(&page.content.finish())?).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

fn image_name(number: usize) -> String {
    format!("Im{number}")
}

fn font_name(face: Face) -> &'static str {
    match face {
        Face::Regular => "F0",
        Face::Bold => "F1",
    }
}

/// Writes what is used of a font: its glyphs by their numbers, and the characters that they stand for (ISO 32000-1, 9.7).
fn embed_font(
    pdf: &mut Pdf,
    (face, glyphs): (Face, &BTreeMap<u16, char>),
    at: Ref,
    [cid, descriptor, file, characters]: [Ref; 4],
) -> io::Result<()> {
    // A subset has six letters before its name.
    let (name, weight) = match face {
        Face::Regular => ("OPMPLT+DejaVuSans", 400),
        Face::Bold => ("OPMPLT+DejaVuSans-Bold", 700),
    };
    let name = Name(name.as_bytes());
    let system = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
    // Of a thousandth of the font's size.
    let thousandths = (1000.0 / Face::UNITS) as f32;
    let mut font = pdf.type0_font(at);
    font.base_font(name).encoding_predefined(Name(b"Identity-H"));
    font.descendant_font(cid).to_unicode(characters);
    font.finish();
    let mut font = pdf.cid_font(cid);
    font.subtype(CidFontType::Type2).base_font(name).system_info(system);
    font.font_descriptor(descriptor)
        .default_width(0.0)
        .cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = font.widths();
    for &glyph in glyphs.keys() {
        widths.consecutive(glyph, [face.advance(glyph) as f32 * thousandths]);
    }
    widths.finish();
    font.finish();
    let mut font = pdf.font_descriptor(descriptor);
    font.name(name).flags(FontFlags::SYMBOLIC).font_file2(file);
    // Those of DejaVu Sans, in its units.
    let [left, below, right, above] = [-2090.0, -948.0, 3673.0, 2524.0].map(|v| v * thousandths);
    font.bbox(PageBox::new(left, below, right, above)).italic_angle(0.0);
    font.ascent(1901.0 * thousandths).descent(-483.0 * thousandths);
    font.cap_height(1000.0 * CAPITALS as f32).stem_v(0.1 * weight as f32 + 40.0);
    font.finish();
    let used = glyphs.keys().copied().collect();
    let bytes = subset(face.bytes(), &used).unwrap_or_else(|| face.bytes().to_vec());
    let mut stream_bytes = packed(&bytes)?;
    let mut stream = pdf.stream(file, &stream_bytes);
    stream.filter(Filter::FlateDecode);
    stream.pair(Name(b"Length1"), bytes.len() as i32);
    stream.finish();
    let mut map = UnicodeCmap::new(Name(b"Custom"), system);
    for (&glyph, &character) in glyphs.iter().filter(|(glyph, _)| **glyph != 0) {
        map.pair(glyph, character);
    }
    stream_bytes = packed(&map.finish())?;
    pdf.stream(characters, &stream_bytes).filter(Filter::FlateDecode);
    Ok(())
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

/// The content of the page, the images in it, and the glyphs with the characters that they stand for.
struct Page<'a> {
    content: Content,
    images: Vec<&'a Image>,
    glyphs: BTreeMap<Face, BTreeMap<u16, char>>,
}

impl<'a> Page<'a> {
    fn shapes(&mut self, mut shapes: &'a [Shape]) {
        while let [shape, rest @ ..] = shapes {
            shapes = rest;
            match (shape, rest) {
                // An area and its outline are one path.
                (Shape::Area(path, color), [Shape::Line(outline, pen), rest @ ..])
                    if path == outline =>
                {
                    self.fill(*color);
                    self.line(path, pen).fill_nonzero_and_stroke();
                    shapes = rest;
                }
                (Shape::Area(path, color), _) => {
                    self.fill(*color);
                    self.trace(path);
                    self.content.fill_nonzero();
                }
                (Shape::Line(path, pen), _) => {
                    self.line(path, pen).stroke();
                }
                (Shape::Text(text), _) => self.text(text),
                (Shape::Image { place, image }, _) => self.image(*place, image),
                (Shape::Group { shapes, .. }, _) => self.shapes(shapes),
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

    /// A path, ready to be drawn with a pen.
    fn line(&mut self, path: &Path, pen: &Pen) -> &mut Content {
        let [r, g, b] = shares(pen.color);
        self.content.set_stroke_rgb(r, g, b).set_line_width(pen.width as f32);
        self.content.set_line_join(LineJoinStyle::RoundJoin);
        self.content.set_dash_pattern(pen.dashes.iter().map(|&length| length as f32), 0.0);
        self.trace(path);
        &mut self.content
    }

    fn text(&mut self, text: &Text) {
        let [x, y] = text.start().map(|value| value as f32);
        let used = self.glyphs.entry(text.face).or_default();
        let mut glyphs = Vec::with_capacity(2 * text.text.len());
        for ((glyph, _), character) in text.face.glyphs(&text.text).zip(text.text.chars()) {
            used.entry(glyph).or_insert(character);
            glyphs.extend(glyph.to_be_bytes());
        }
        // Glyphs have y upwards; a text from bottom to top is turned.
        let turned = [0.0, -1.0, -1.0, 0.0, x, y];
        self.fill(text.color);
        self.content.begin_text();
        self.content.set_font(Name(font_name(text.face).as_bytes()), text.size as f32);
        self.content.set_text_matrix(if text.turned {
            turned
        } else {
            [1.0, 0.0, 0.0, -1.0, x, y]
        });
        self.content.show(Str(&glyphs));
        self.content.end_text();
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
