//! `opm help format` and `opm schema`. `tests/python/test_schema.py` compares what they say with what opm
//! reads.

use crate::run::{command, opm};
use serde_json::Value;
use std::io::Read;
use std::process::Stdio;

const PAGE: &str = include_str!("../../src/format.md");

#[test]
fn the_page_is_printed_as_it_is() {
    for args in [&["help", "format"][..], &["format"], &["format", "--help"], &["format", "-h"]] {
        assert_eq!(opm(args).text(), PAGE, "{args:?}");
    }
    assert_eq!(opm(&["format", "--format", "json"]).json()["text"], PAGE);
    assert!(opm(&["help"]).text().contains("  format "));
    assert!(
        opm(&["help", "ik"]).text().contains("Usage: opm ik "),
        "other commands have their help"
    );
}

/// As `opm help format | head`, more text than fits into a pipe.
#[test]
fn nobody_has_to_read_it_to_the_end() {
    for args in [&["help", "format"][..], &["format"], &["schema"], &["schema", "motion"]] {
        let mut child =
            command(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        let mut start = [0; 10];
        child.stdout.take().expect("a pipe").read_exact(&mut start).expect("ten bytes");
        let mut said = String::new();
        child.stderr.take().expect("a pipe").read_to_string(&mut said).expect("UTF-8");
        assert_eq!(
            (child.wait().expect("it ends").code(), said.as_str()),
            (Some(0), ""),
            "{args:?}"
        );
    }
}

#[test]
fn schemas_are_of_draft_7() {
    let parse = |args: &[&str]| serde_json::from_str::<Value>(opm(args).text()).expect("JSON");
    let mechanism = parse(&["schema"]);
    assert_eq!(mechanism, parse(&["schema", "mechanism"]));
    let motion = parse(&["schema", "motion"]);
    for schema in [&mechanism, &motion] {
        assert_eq!(schema["$schema"], "http://json-schema.org/draft-07/schema#");
        assert_eq!(schema["properties"]["format"]["const"], 1);
    }
    assert!(mechanism["properties"]["slider_leg"]["items"]["properties"]["alpha1"].is_object());
    assert!(motion["properties"]["coordinates"]["properties"]["zeta"].is_object());
    opm(&["schema", "table"]).fails(2, &["table", "mechanism", "motion"]);
}
