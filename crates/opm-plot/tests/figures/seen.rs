//! Reads an SVG back.

use opm_plot::font::Face;
use opm_plot::{Drawing, svg};
use roxmltree::{Document, Node};

/// Coordinates are written to a hundredth of a pixel.
pub const ROUNDING: f64 = 0.011;

/// The SVG of a drawing.
pub fn text(drawing: &Drawing) -> String {
    svg::write(drawing).expect("an SVG")
}

/// Elements of a class, or all texts, in the order of the file.
pub fn class<'a>(node: Node<'a, 'a>, class: &str) -> Vec<Node<'a, 'a>> {
    let is = |n: &Node<'a, 'a>| match class {
        "text" => n.has_tag_name("text"),
        _ => n.attribute("class") == Some(class),
    };
    node.descendants().filter(is).collect()
}

/// What an element is called, or what a text says.
pub fn label<'a>(node: Node<'a, 'a>) -> &'a str {
    let text = node.has_tag_name("text").then(|| node.text()).flatten();
    text.or_else(|| node.attribute("aria-label")).unwrap_or("")
}

/// The element of a class that is called so.
#[track_caller]
pub fn named<'a>(node: Node<'a, 'a>, of: &str, name: &str) -> Node<'a, 'a> {
    let found = class(node, of);
    let names: Vec<&str> = found.iter().map(|n| label(*n)).collect();
    *found.iter().find(|n| label(**n) == name).unwrap_or_else(|| panic!("{name:?} in {names:?}"))
}

/// The pieces of a path.
pub fn pieces(path: Node<'_, '_>) -> Vec<Vec<[f64; 2]>> {
    let d = path.attribute("d").expect("a path");
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![];
    for step in d.split_inclusive(['M', 'L', 'Z']).map(str::trim).collect::<String>().split(['Z']) {
        for piece in step.split('M').filter(|piece| !piece.is_empty()) {
            pieces.push(piece.split('L').map(point).collect());
        }
    }
    pieces
}

fn point(text: &str) -> [f64; 2] {
    let mut numbers = text.split_whitespace().map(|n| n.parse().expect("a number"));
    [0; 2].map(|_| numbers.next().expect("two numbers"))
}

/// Paths of an element.
pub fn paths<'a>(node: Node<'a, 'a>) -> Vec<Node<'a, 'a>> {
    node.descendants().filter(|n| n.has_tag_name("path")).collect()
}

/// A number on a label.
pub fn number(label: &str) -> f64 {
    label.replace('−', "-").parse().unwrap_or_else(|_| panic!("{label:?} is no number"))
}

/// The value that a panel's vertical axis says is at a height, by its outermost numbers and ticks.
pub fn up<'a>(panel: Node<'a, 'a>) -> impl Fn(f64) -> f64 {
    scale(panel, "y-axis", 1)
}

/// The same of its horizontal axis.
pub fn across<'a>(panel: Node<'a, 'a>) -> impl Fn(f64) -> f64 {
    scale(panel, "x-axis", 0)
}

fn scale<'a>(panel: Node<'a, 'a>, axis: &str, along: usize) -> impl Fn(f64) -> f64 {
    let axis = *class(panel, axis).first().expect("an axis");
    // The last text is the axis's name.
    let labels: Vec<f64> = class(axis, "text")
        .iter()
        .map(|n| label(*n))
        .filter(|text| *text != label(axis))
        .map(number)
        .collect();
    // Ticks are four pixels long, in a path of their own.
    let short = |piece: &Vec<[f64; 2]>| {
        let [a, b] = [piece[0], piece[1]];
        piece.len() == 2
            && (a[1 - along] - b[1 - along]).abs() < 4.1
            && (a[along] - b[along]).abs() < ROUNDING
    };
    let ticks: Vec<f64> = paths(panel)
        .into_iter()
        .flat_map(pieces)
        .filter(|piece| piece.len() == 2)
        .filter(short)
        .map(|piece| piece[0][along])
        .collect();
    assert!(labels.len() >= 2 && labels.len() == ticks.len(), "{labels:?} {ticks:?}");
    let (first, last) = (0, labels.len() - 1);
    let slope = (labels[last] - labels[first]) / (ticks[last] - ticks[first]);
    move |place| labels[first] + slope * (place - ticks[first])
}

/// Left, upper, right and lower edge of every text.
fn boxes<'a>(document: &'a Document<'a>) -> Vec<(&'a str, [f64; 4])> {
    let texts = class(document.root(), "text");
    let place = |node: &Node<'a, 'a>| {
        let number = |name| node.attribute(name).and_then(|n| n.parse::<f64>().ok());
        let (at, size) = (["x", "y"].map(number), number("font-size").expect("a size"));
        let mut at = at.map(|n| n.expect("a place"));
        let bold = node.attribute("font-weight") == Some("bold");
        let face = if bold { Face::Bold } else { Face::Regular };
        let turned = node.attribute("transform").is_some_and(|t| t.contains("rotate(-90"));
        // Of letters with descenders, without accents.
        let (width, above, below) = (face.width(label(*node), size), 0.76 * size, 0.24 * size);
        let share = match node.attribute("text-anchor") {
            None => 0.0,
            Some("middle") => 0.5,
            _ => 1.0,
        };
        at[usize::from(turned)] += share * if turned { width } else { -width };
        let edges = if turned {
            [at[0] - above, at[1] - width, at[0] + below, at[1]]
        } else {
            [at[0], at[1] - above, at[0] + width, at[1] + below]
        };
        (label(*node), edges)
    };
    texts.iter().map(place).collect()
}

/// Every text is inside the picture, and no two touch.
#[track_caller]
pub fn assert_legible(svg: &str) {
    let document = Document::parse(svg).expect("XML");
    let root = document.root_element();
    let side = |name| root.attribute(name).and_then(|n| n.parse::<f64>().ok()).expect("a size");
    let (width, height) = (side("width"), side("height"));
    let boxes = boxes(&document);
    assert!(boxes.len() > 3);
    for (number, (text, [left, top, right, bottom])) in boxes.iter().enumerate() {
        let inside = *left >= 0.0 && *top >= 0.0 && *right <= width && *bottom <= height;
        assert!(inside, "{text:?} at {left} {top} {right} {bottom} in {width} x {height}");
        for (other, [l, t, r, b]) in &boxes[..number] {
            let apart = right <= l || r <= left || bottom <= t || b <= top;
            assert!(apart, "{text:?} at {left} {top} touches {other:?} at {l} {t}");
        }
    }
}
