//! Fonts with the glyphs of a drawing alone, for PDF. Glyphs keep their numbers: those that are left out are empty.
//!
//! The tables are those of TrueType, <https://learn.microsoft.com/typography/opentype/spec/otff>. The fonts that come with the
//! crate have no instructions, and so no tables of these.

use std::collections::BTreeSet;

/// The tables that a font in a PDF needs (ISO 32000-1, 9.9).
const TABLES: [&[u8; 4]; 6] = [b"glyf", b"head", b"hhea", b"hmtx", b"loca", b"maxp"];

/// A font with these glyphs, those that they consist of, and the box for characters that the font lacks. `None` if it is no
/// TrueType font.
pub fn subset(font: &[u8], glyphs: &BTreeSet<u16>) -> Option<Vec<u8>> {
    let table = |name: &[u8; 4]| {
        let records = font.get(12..12 + 16 * usize::from(u16_at(font, 4)?))?;
        let record = records.chunks_exact(16).find(|record| record.starts_with(name))?;
        let [at, length] = [8, 12].map(|at| u32_at(record, at).map(|value| value as usize));
        font.get(at?..at?.checked_add(length?)?)
    };
    let (all, places) = (table(b"glyf")?, table(b"loca")?);
    let long = u16_at(table(b"head")?, 50)? == 1;
    let place = |glyph: usize| match long {
        true => u32_at(places, 4 * glyph).map(|at| at as usize),
        false => u16_at(places, 2 * glyph).map(|at| 2 * usize::from(at)),
    };
    let outline = |glyph: u16| all.get(place(glyph.into())?..place(usize::from(glyph) + 1)?);

    let mut open: Vec<u16> = glyphs.iter().copied().chain([0]).collect();
    let mut kept = BTreeSet::new();
    while let Some(glyph) = open.pop() {
        if kept.insert(glyph) {
            open.extend(parts(outline(glyph)?)?);
        }
    }
    let (mut outlines, mut starts) = (Vec::new(), Vec::new());
    let count = u16_at(table(b"maxp")?, 4)?;
    for glyph in 0..count {
        starts.extend((outlines.len() as u32).to_be_bytes());
        if kept.contains(&glyph) {
            outlines.extend_from_slice(outline(glyph)?);
            outlines.resize(outlines.len().next_multiple_of(4), 0);
        }
    }
    starts.extend((outlines.len() as u32).to_be_bytes());
    // Places are 32-bit numbers now.
    let mut head = table(b"head")?.to_vec();
    head[50..52].copy_from_slice(&1_u16.to_be_bytes());

    let count = TABLES.len() as u16;
    let mut header = vec![0, 1, 0, 0];
    // The largest power of two that is not more than the number of tables is four.
    for number in [count, 16 * 4, 2, 16 * count - 16 * 4] {
        header.extend(number.to_be_bytes());
    }
    let mut body = Vec::new();
    let first = 12 + 16 * TABLES.len();
    for name in TABLES {
        let content = match name {
            b"glyf" => &outlines,
            b"loca" => &starts,
            b"head" => &head,
            _ => table(name)?,
        };
        let start = body.len();
        body.extend_from_slice(content);
        body.resize(body.len().next_multiple_of(4), 0);
        let words = body[start..].chunks_exact(4).filter_map(|word| u32_at(word, 0));
        header.extend_from_slice(name);
        for number in
            [words.fold(0, u32::wrapping_add), (first + start) as u32, content.len() as u32]
        {
            header.extend(number.to_be_bytes());
        }
    }
    header.extend(body);
    Some(header)
}

/// The glyphs that a composite glyph consists of; none of any other.
fn parts(outline: &[u8]) -> Option<Vec<u16>> {
    /// Bits of a part's flags: its places are words; a scale, two scales, or a matrix follows; so does another part.
    const WORDS: u16 = 1;
    const SCALE: u16 = 1 << 3;
    const MORE: u16 = 1 << 5;
    const SCALES: u16 = 1 << 6;
    const MATRIX: u16 = 1 << 7;
    let mut found = Vec::new();
    // The number of contours, negative where there are parts.
    if outline.is_empty() || u16_at(outline, 0)? < 1 << 15 {
        return Some(found);
    }
    let mut at = 10;
    loop {
        let flags = u16_at(outline, at)?;
        found.push(u16_at(outline, at + 2)?);
        let has = |bit: u16| flags & bit != 0;
        at += if has(WORDS) { 8 } else { 6 };
        at += [(SCALE, 2), (SCALES, 4), (MATRIX, 8)]
            .iter()
            .map(|&(bit, size)| if has(bit) { size } else { 0 })
            .sum::<usize>();
        if !has(MORE) {
            return Some(found);
        }
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::font::{Face, strokes};
    use read_fonts::model::Font;

    /// An independent reader finds the outlines and the widths of the whole font in the subset, and no other outline.
    #[test]
    fn a_subset_has_the_glyphs_of_its_text_alone() {
        for face in [Face::Regular, Face::Bold] {
            let [text, other] = ["y (mm) θ₁ −1·10³ é", "Q"]
                .map(|text| face.glyphs(text).map(|(glyph, _)| glyph).collect::<BTreeSet<u16>>());
            let bytes = subset(face.bytes(), &text).expect("a font");
            assert!(bytes.len() < face.bytes().len() / 4, "{}", bytes.len());
            let font = Font::new(bytes, 0).expect("a font");
            for &glyph in &text {
                assert_eq!(strokes(&font, glyph), face.outline(glyph), "{glyph}");
                let width = f64::from(font.glyph_metrics().h_advance(u32::from(glyph).into()));
                assert_eq!(width, face.advance(glyph));
            }
            assert!(other.iter().all(|&glyph| strokes(&font, glyph).is_empty()));
            assert!(subset(&face.bytes()[..100], &text).is_none());
        }
    }
}
