//! Writes a drawing as SVG. Texts are text, which can be searched and edited: a viewer without the font in which they were laid
//! out takes one that is like it.

use crate::color::Color;
use crate::drawing::{Anchor, Drawing, Image, Path, Pen, Rect, Shape, Step, Text};
use crate::font::{Face, LONGEST, shortened};
use crate::png;
use std::fmt::Write;

/// The font in which texts are laid out, one of nearly its widths, and what every viewer has.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Writes a drawing as the text of an SVG file; see also [`Drawing::to_svg`].
///
/// # Errors
/// An image in the drawing cannot be encoded.
pub fn write(drawing: &Drawing) -> Result<String, png::Error> {
    let [width, height] = [drawing.size.width, drawing.size.height].map(number);
    let mut out = String::new();
    let title = escape(&drawing.title);
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{title}\" font-family=\"{FAMILY}\" stroke-linejoin=\"round\">\n<title>{title}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    shapes(&mut out, &drawing.shapes)?;
    out.push_str("</svg>\n");
    Ok(out)
}

fn shapes(out: &mut String, mut shapes: &[Shape]) -> Result<(), png::Error> {
    while let [shape, rest @ ..] = shapes {
        shapes = rest;
        match (shape, rest) {
            // An area and its outline are one element.
            (Shape::Area(path, color), [Shape::Line(outline, pen), rest @ ..])
                if path == outline =>
            {
                line(out, path, pen, &hex(*color));
                shapes = rest;
            }
            (Shape::Area(path, color), _) => {
                let _ = writeln!(out, "<path d=\"{}\" fill=\"{}\"/>", steps(path), hex(*color));
            }
            (Shape::Line(path, pen), _) => line(out, path, pen, "none"),
            (Shape::Text(one), _) => text(out, one),
            (Shape::Image { place, image }, _) => picture(out, *place, image)?,
            (Shape::Group { kind, label, shapes: inner }, _) => {
                let label = escape(label);
                let _ = writeln!(out, "<g class=\"{kind}\" aria-label=\"{label}\">");
                self::shapes(out, inner)?;
                out.push_str("</g>\n");
            }
        }
    }
    Ok(())
}

fn text(out: &mut String, text: &Text) {
    let [x, y] = text.at.map(number);
    let _ = write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", number(text.size));
    if text.face == Face::Bold {
        out.push_str(" font-weight=\"bold\"");
    }
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => out.push_str(" text-anchor=\"middle\""),
        Anchor::End => out.push_str(" text-anchor=\"end\""),
    }
    if text.turned {
        let _ = write!(out, " transform=\"rotate(-90 {x} {y})\"");
    }
    let _ = writeln!(out, " fill=\"{}\">{}</text>", hex(text.color), escape(&text.text));
}

fn line(out: &mut String, path: &Path, pen: &Pen, fill: &str) {
    let _ = write!(
        out,
        "<path d=\"{}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"",
        steps(path),
        hex(pen.color),
        number(pen.width)
    );
    if !pen.dashes.is_empty() {
        let dashes: Vec<String> = pen.dashes.iter().copied().map(number).collect();
        let _ = write!(out, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    out.push_str("/>\n");
}

fn picture(out: &mut String, place: Rect, image: &Image) -> Result<(), png::Error> {
    let Rect { x, y, width, height } = place;
    let [x, y, width, height] = [x, y, width, height].map(number);
    let _ = writeln!(
        out,
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
         preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
         xlink:href=\"data:image/png;base64,{}\"/>",
        base64(&png::image(image)?)
    );
    Ok(())
}

fn steps(path: &Path) -> String {
    let mut out = String::new();
    for step in &path.0 {
        let _ = match step {
            Step::Move([x, y]) => write!(out, "M{} {}", number(*x), number(*y)),
            Step::Line([x, y]) => write!(out, "L{} {}", number(*x), number(*y)),
            Step::Close => write!(out, "Z"),
        };
    }
    out
}

/// A number, rounded to a hundredth of a pixel, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A text for elements and attributes. Control characters, which XML does not allow, become spaces.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in shortened(text, LONGEST).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Base 64, as in RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for part in bytes.chunks(3) {
        let byte = |i: usize| u32::from(part.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i)) as usize & 63];
            out.push(if i <= part.len() { digit.into() } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_rfc() {
        let vectors = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (length, expected) in vectors.into_iter().enumerate() {
            assert_eq!(base64(&b"foobar"[..length]), expected);
        }
    }

    #[test]
    fn numbers_and_names_are_safe_to_write() {
        assert_eq!(
            [12.0, -0.001, 1.005, -3.5, 0.126].map(number),
            ["12", "0", "1", "-3.5", "0.13"]
        );
        assert_eq!(escape("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot; ");
    }
}
