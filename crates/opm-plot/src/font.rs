//! The fonts that come with the crate: outlines and widths, the same on every machine.

use read_fonts::model::Font;
use read_fonts::model::glyph::outline::{DrawMemory, DrawOptions, PathSink};
use read_fonts::types::GlyphId;
use std::borrow::Cow;
use std::sync::LazyLock;

/// The font of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Face {
    /// DejaVu Sans, for all texts but titles.
    Regular,
    /// DejaVu Sans Bold, for titles.
    Bold,
}

/// A piece of a glyph's outline, in units of the font with y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stroke {
    /// Starts a contour at a point.
    Move([f32; 2]),
    /// A straight line to a point.
    Line([f32; 2]),
    /// A quadratic curve: its control point and its end.
    Quad([f32; 2], [f32; 2]),
    /// Closes the contour.
    Close,
}

static REGULAR: LazyLock<Option<Font>> = LazyLock::new(|| Font::new(Face::Regular.bytes(), 0));
static BOLD: LazyLock<Option<Font>> = LazyLock::new(|| Font::new(Face::Bold.bytes(), 0));

/// The height of capitals above the baseline, as a share of the font's size.
pub const CAPITALS: f64 = 0.73;

/// The longest text on one line, in characters.
pub const LONGEST: usize = 1000;
/// The longest label, in characters: of what is drawn beside other things.
const LONGEST_LABEL: usize = 100;
/// The most lines of one paragraph.
pub const MOST_LINES: usize = 12;

/// The space at which lines are not broken.
const NO_BREAK: char = '\u{a0}';

impl Face {
    /// The number of font units in the font's size, the same for both fonts.
    pub const UNITS: f64 = 2048.0;

    /// The font's file.
    pub(crate) fn bytes(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("../fonts/DejaVuSans.ttf"),
            Self::Bold => include_bytes!("../fonts/DejaVuSans-Bold.ttf"),
        }
    }

    /// The width of a glyph, in units of the font.
    pub(crate) fn advance(self, glyph: u16) -> f64 {
        self.font().map_or(0.0, |font| font.glyph_metrics().h_advance(glyph.into()).into())
    }

    fn font(self) -> Option<&'static Font> {
        match self {
            Self::Regular => REGULAR.as_ref(),
            Self::Bold => BOLD.as_ref(),
        }
    }

    /// The number and the width of each character's glyph, in units of the font. A character that the font
    /// lacks has the first glyph, an empty box.
    fn metrics(self) -> impl Fn(char) -> (u16, f64) {
        let tables = self.font().map(|font| (font.charmap(), font.glyph_metrics()));
        move |character| {
            let Some((characters, widths)) = &tables else { return (0, 0.0) };
            let glyph = characters.map_unicode(character).unwrap_or(GlyphId::NOTDEF);
            let number = u16::try_from(glyph.to_u32()).unwrap_or(0);
            (number, widths.h_advance(glyph).into())
        }
    }

    /// The glyphs of a text, each with its distance from the start, in units of the font. A character that
    /// the font lacks becomes an empty box.
    pub fn glyphs(self, text: &str) -> impl Iterator<Item = (u16, f64)> {
        let metrics = self.metrics();
        let mut at = 0.0;
        text.chars().map(move |character| {
            let (glyph, width) = metrics(character);
            let here = at;
            at += width;
            (glyph, here)
        })
    }

    /// The width of a text in this font size, in the same unit.
    pub fn width(self, text: &str, size: f64) -> f64 {
        let metrics = self.metrics();
        text.chars().map(|character| metrics(character).1).sum::<f64>() * size / Self::UNITS
    }

    /// The outline of a glyph; empty for a space.
    pub fn outline(self, glyph: u16) -> Vec<Stroke> {
        self.font().map_or_else(Vec::new, |font| strokes(font, glyph))
    }

    /// The text, or as much of it as fits in `room` together with an ellipsis.
    pub fn fit(self, text: &str, size: f64, room: f64) -> String {
        let metrics = self.metrics();
        let width = |c: char| metrics(c).1 * size / Self::UNITS;
        let mut at = 0.0;
        // Where the text is cut if it goes on: the last place that has room for the ellipsis.
        let mut cut = None;
        for (number, (place, c)) in text.char_indices().enumerate() {
            if at + width('…') <= room {
                cut = Some(place);
            }
            at += width(c);
            // Characters without a width would never fill the room.
            if at > room || number >= LONGEST {
                return cut.map_or_else(String::new, |cut| format!("{}…", &text[..cut]));
            }
        }
        text.to_owned()
    }

    /// The text in lines no wider than `room`, which are broken between words. A no-break space
    /// breaks only where its line would be too wide by itself, and is drawn as a space. A text of more than [`MOST_LINES`]
    /// lines ends in an ellipsis.
    pub fn wrap(self, text: &str, size: f64, room: f64) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let words = text.split([' ', '\n', '\t']).filter(|word| !word.is_empty());
        for word in words {
            if lines.len() > MOST_LINES {
                break;
            }
            let whole = word.replace(NO_BREAK, " ");
            let is_too_wide = self.is_wider(&whole, size, room);
            match lines.last_mut() {
                Some(line)
                    if !is_too_wide
                        && line.len() < LONGEST
                        && self.width(&format!("{line} {whole}"), size) <= room =>
                {
                    line.push(' ');
                    line.push_str(&whole);
                }
                _ if is_too_wide && word.contains(NO_BREAK) => {
                    lines.extend(self.wrap(&whole, size, room));
                }
                _ => lines.push(self.fit(&whole, size, room)),
            }
        }
        if lines.len() > MOST_LINES {
            lines.truncate(MOST_LINES);
            if let Some(last) = lines.last_mut() {
                *last = self.fit(&format!("{last} …"), size, room);
            }
        }
        lines
    }

    /// Whether a text, however long, is wider than this.
    fn is_wider(self, text: &str, size: f64, room: f64) -> bool {
        let metrics = self.metrics();
        let mut at = 0.0;
        text.chars().any(|c| {
            at += metrics(c).1 * size / Self::UNITS;
            at > room
        })
    }
}

/// The outline of a glyph of a font.
pub(crate) fn strokes(font: &Font, glyph: u16) -> Vec<Stroke> {
    let mut outline = Outline(Vec::new());
    if let Some(shape) = font.outline_glyphs().get(glyph.into()) {
        // What is drawn before a contour that is damaged is kept; the fonts here are whole.
        let _ = shape.draw(&DrawOptions::new(), DrawMemory::Scratch, &mut outline);
    }
    outline.0
}

/// A text with at most so many characters; what is cut off is an ellipsis.
pub fn shortened(text: &str, longest: usize) -> Cow<'_, str> {
    match text.char_indices().nth(longest) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// A name as a label.
pub fn label(name: &str) -> Cow<'_, str> {
    shortened(name, LONGEST_LABEL)
}

struct Outline(Vec<Stroke>);

impl PathSink for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.push(Stroke::Move([x, y]));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.push(Stroke::Line([x, y]));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.push(Stroke::Quad([x1, y1], [x, y]));
    }

    /// TrueType outlines, which both fonts have, are quadratic.
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.push(Stroke::Quad([(x1 + x2) / 2.0, (y1 + y2) / 2.0], [x, y]));
    }

    fn close(&mut self) {
        self.0.push(Stroke::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_fonts_have_the_signs_that_figures_use() {
        for face in [Face::Regular, Face::Bold] {
            let font = face.font().expect("the font is whole");
            assert_eq!(f64::from(font.units_per_em()), Face::UNITS);
            for c in "AZaz09−°²³⁻⁴·×…ζξψθφμ≤±→".chars() {
                let glyph =
                    font.charmap().map_unicode(c).unwrap_or_else(|| panic!("{face:?} lacks {c}"));
                let number = u16::try_from(glyph.to_u32()).expect("few glyphs");
                assert!(!face.outline(number).is_empty(), "{c}");
            }
        }
    }

    /// Widths of DejaVu Sans as its metrics state them: 1303 units for a digit, 651 for a space.
    #[test]
    fn a_text_is_as_wide_as_its_glyphs() {
        let width = Face::Regular.width("10 2", 20.48);
        assert!((width - 0.01 * (3.0 * 1303.0 + 651.0)).abs() < 1e-9, "{width}");
        let ends: Vec<f64> = Face::Regular.glyphs("10 2").map(|(_, at)| at).collect();
        assert_eq!(ends, [0.0, 1303.0, 2606.0, 3257.0]);
    }

    /// A name of a million characters was cut one by one, each time with a measurement of the rest.
    #[test]
    fn long_texts_are_cut_in_time() {
        let start = std::time::Instant::now();
        let face = Face::Regular;
        for letter in ["n", "n ", "\u{a0}n", "\u{200b}"] {
            let long = letter.repeat(1_000_000);
            let lines = face.wrap(&long, 12.0, 300.0);
            assert!((1..=MOST_LINES).contains(&lines.len()), "{letter:?}: {}", lines.len());
            assert!(lines.iter().all(|line| line.chars().count() <= LONGEST + 1));
            assert!(lines.iter().all(|line| face.width(line, 12.0) <= 300.0));
            assert!(lines.last().is_some_and(|line| line.ends_with('…')), "{letter:?}");
        }
        assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    }

    #[test]
    fn what_does_not_fit_is_cut_or_wrapped() {
        let face = Face::Regular;
        assert_eq!(face.fit("theta11", 12.0, 100.0), "theta11");
        let cut = face.fit("theta11", 12.0, 30.0);
        assert!(cut.ends_with('…') && face.width(&cut, 12.0) <= 30.0, "{cut}");
        let lines = face.wrap("a few words to fill two lines", 12.0, 100.0);
        assert!(lines.len() > 1 && lines.iter().all(|line| face.width(line, 12.0) <= 100.0));
        assert_eq!(lines.join(" "), "a few words to fill two lines");
    }
}
