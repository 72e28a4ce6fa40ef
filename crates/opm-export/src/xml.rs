//! Elements of XML and their text. A model has only elements, attributes and comments, which are simpler to write than
//! to hand to a library.

use std::fmt::Write;

/// Spaces of indentation for each level.
const INDENT: usize = 2;

/// An element with its attributes and children, in the order in which they are added.
#[derive(Clone, Debug)]
pub struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Node>,
}

#[derive(Clone, Debug)]
enum Node {
    Element(Element),
    Comment(String),
}

impl Element {
    pub fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), children: Vec::new() }
    }

    /// The same element with another attribute.
    #[must_use]
    pub fn with(mut self, attribute: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((attribute, value.into()));
        self
    }

    /// The same element with an attribute that is a list of numbers.
    #[must_use]
    pub fn numbers(self, attribute: &'static str, values: &[f64]) -> Self {
        let values: Vec<String> = values.iter().map(|&value| number(value)).collect();
        self.with(attribute, values.join(" "))
    }

    /// The same element with another child.
    #[must_use]
    pub fn child(mut self, child: Self) -> Self {
        self.push(child);
        self
    }

    /// The same element with more children.
    #[must_use]
    pub fn children(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        children.into_iter().for_each(|child| self.push(child));
        self
    }

    pub fn push(&mut self, child: Self) {
        self.children.push(Node::Element(child));
    }

    pub fn comment(&mut self, text: impl Into<String>) {
        self.children.push(Node::Comment(text.into()));
    }

    /// The element as a document.
    pub fn document(&self) -> String {
        let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        self.write(&mut out, 0);
        out
    }

    fn write(&self, out: &mut String, indent: usize) {
        let name = self.name;
        let _ = write!(out, "{:indent$}<{name}", "");
        for (attribute, value) in &self.attributes {
            let _ = write!(out, " {attribute}=\"{}\"", escaped(value));
        }
        if self.children.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push_str(">\n");
        for child in &self.children {
            match child {
                Node::Element(element) => element.write(out, indent + INDENT),
                Node::Comment(text) => {
                    // Two hyphens would end a comment.
                    let mut text = text.clone();
                    while text.contains("--") {
                        text = text.replace("--", "- -");
                    }
                    let _ = writeln!(out, "{:1$}<!-- {text} -->", "", indent + INDENT);
                }
            }
        }
        let _ = writeln!(out, "{:indent$}</{name}>", "");
    }
}

/// The shortest text that reads as the same number.
pub fn number(value: f64) -> String {
    // Zero without its sign.
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // A reader would take these for spaces.
            '\n' | '\r' | '\t' => {
                let _ = write!(out, "&#{};", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::Document;

    /// Another reader finds what was written, whatever characters it has.
    #[test]
    fn texts_survive() {
        let name = "a<b> & \"c\"\n\u{e9}--'d'";
        let mut root = Element::new("root").with("name", name).child(Element::new("empty"));
        root.comment("one -- two --- three");
        let text = root.document();
        let document = Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("name"), Some(name));
        assert_eq!(
            document.root_element().children().filter(roxmltree::Node::is_element).count(),
            1
        );
    }

    #[test]
    fn numbers_have_all_their_digits() {
        for value in [0.1 + 0.2, 1e-300, -1.0 / 3.0, 1e22, f64::MIN_POSITIVE, 25.0] {
            assert_eq!(number(value).parse(), Ok(value));
        }
        assert_eq!(
            ["0", "0", "-2", "1e-7"],
            [0.0, -0.0, -2.0, 1e-7].map(number).each_ref().map(|s| &**s)
        );
    }
}
