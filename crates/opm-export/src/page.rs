//! The explorer: one HTML file that shows a mechanism and its workspace in any browser, without a network.
//!
//! `web/build.sh` builds the page from `web/src` and `crates/opm-web`. It is kept here, compressed, so that nobody needs
//! the tools of that build. A mechanism file is put into a place of the page that the build leaves empty.

use flate2::read::GzDecoder;
use std::io::{self, Read};

/// The page as it is built.
const PAGE: &[u8] = include_bytes!("../page/explorer.html.gz");

/// The place of the mechanism file in the page, empty.
const EMPTY: &str = r#"<script type="application/json" id="opm-file">null</script>"#;

/// The explorer of a mechanism, as the text of an HTML file. `name` is the name of the mechanism file, and `text` what it
/// holds.
///
/// ```
/// let example = opm_core::mechanism::examples::find("five-bar").ok_or("no such example")?;
/// let page = opm_export::explorer("five-bar.toml", example.text)?;
/// assert!(page.starts_with("<!doctype html>") && page.contains("five-bar"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The page that this library carries is broken.
pub fn explorer(name: &str, text: &str) -> io::Result<String> {
    let mut page = String::new();
    GzDecoder::new(PAGE).read_to_string(&mut page)?;
    // Nothing in the file may look like the end of the script that holds it.
    let file =
        serde_json::json!({ "name": name, "text": text }).to_string().replace('<', "\\u003c");
    let whole = EMPTY.replace("null", &file);
    match page.split_once(EMPTY) {
        Some((before, after)) => Ok([before, &whole, after].concat()),
        None => Err(io::Error::other("the page has no place for a mechanism file")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page is the one of this version, and holds nothing but the file at its place.
    #[test]
    fn the_page_carries_the_file() {
        let text = "name = \"</script><!-- \\u003c 3\"\n";
        let page = explorer("a.toml", text).unwrap();
        assert!(page.contains(concat!("content=\"opm ", env!("CARGO_PKG_VERSION"), "\"")));
        let (_, rest) = page.split_once(r#"id="opm-file">"#).unwrap();
        let (file, _) = rest.split_once("</script>").unwrap();
        let file: serde_json::Value = serde_json::from_str(file).unwrap();
        assert_eq!(file, serde_json::json!({ "name": "a.toml", "text": text }));
    }

    /// A page that fetched something would not work from a file, nor without a network.
    #[test]
    fn the_page_is_small_and_refers_to_nothing() {
        let page = explorer("a.toml", "").unwrap();
        assert!(page.len() <= 3_000_000, "{} bytes", page.len());
        for reference in ["<link rel=\"stylesheet\"", "<script src", "@import", "sourceMappingURL"]
        {
            assert!(!page.contains(reference), "{reference}");
        }
    }
}
