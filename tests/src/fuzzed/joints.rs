//! Lists of joints that often decompose.

use super::bytes::Bytes;
use std::fmt::Write as _;

/// A mechanism of two to four legs. A leg is a chain in one subgroup and a chain in another, as a rule the same two
/// in all legs; some joints are anything.
pub fn joints(bytes: &mut Bytes<'_>) -> String {
    let mut text =
        "format = 1\nname = \"fuzzed\"\nunits = { length = \"m\", angle = \"rad\" }\n[platform]\npoint = [0.1, 0.2, 0.3]\n".to_owned();
    let sections = [bytes.byte() % 5, bytes.byte() % 5];
    let centres = [bytes.vector(), bytes.vector()];
    let normals =
        [[0.0, 0.0, 1.0], bytes.choose(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.6, 0.0, 0.8]])];
    let mut number = 0;
    for leg in 0..2 + bytes.byte() % 3 {
        let _ = writeln!(text, "[[leg]]\nname = \"leg{leg}\"\njoints = [");
        for section in 0..2 {
            for _ in 0..1 + bytes.byte() % 3 {
                number += 1;
                let (kind, axis, point) =
                    joint(bytes, sections[section], normals[section], centres[section]);
                let actuated =
                    if bytes.byte().is_multiple_of(3) { ", actuated = true" } else { "" };
                let limits =
                    if bytes.byte().is_multiple_of(4) { ", limits = [-1.5, 1.0]" } else { "" };
                let pitch = if kind == "helical" { ", pitch = 0.1" } else { "" };
                let point = match kind {
                    "prismatic" => String::new(),
                    _ => format!(", point = {point:?}"),
                };
                let _ = writeln!(
                    text,
                    "  {{ name = \"q{number}\", type = \"{kind}\", axis = {axis:?}{point}{pitch}{actuated}{limits} }},"
                );
            }
        }
        // At least one is actuated.
        number += 1;
        let _ = writeln!(
            text,
            "  {{ name = \"q{number}\", type = \"revolute\", axis = {:?}, point = {:?}, actuated = true }},\n]",
            normals[1], centres[1]
        );
    }
    text
}

/// A joint of a subgroup: planar, spherical, cylindrical, translations of a plane or of space; now and then of no subgroup.
fn joint(
    bytes: &mut Bytes<'_>,
    section: u8,
    normal: [f64; 3],
    centre: [f64; 3],
) -> (&'static str, [f64; 3], [f64; 3]) {
    let across = match normal {
        [0.0, 0.0, _] => [bytes.number(), 1.0, 0.0],
        [x, y, z] => [-z, bytes.number(), x + y * 0.0],
    };
    let any = |bytes: &mut Bytes<'_>| {
        let [x, y, z] = bytes.vector();
        if [x, y, z] == [0.0; 3] { [0.0, 0.0, 1.0] } else { [x, y, z] }
    };
    if bytes.byte() % 32 == 31 {
        let kind = bytes.choose(&["revolute", "prismatic", "helical"]);
        return (kind, any(bytes), bytes.vector());
    }
    match section {
        0 if bytes.byte().is_multiple_of(2) => ("revolute", normal, bytes.vector()),
        0 | 3 => ("prismatic", across, centre),
        1 => ("revolute", any(bytes), centre),
        2 => (bytes.choose(&["revolute", "prismatic", "helical"]), normal, centre),
        _ => ("prismatic", any(bytes), centre),
    }
}
