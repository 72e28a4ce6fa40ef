//! The closures of the loops, in the YAML that example-parallel-robots of Gepetto reads beside a URDF.
//!
//! `closed_loop` has pairs of frames that coincide, `type` says for each pair in how many directions, and `name_mot` names
//! the motors (`completeRobotLoader` in its `loader_tools.py`). The loader also wants `joint_name` and `joint_type`, which
//! replace joints of a URDF by others: here there are none.

/// The file; `ends` are the links in the platform's place, one for each leg.
pub fn closures(ends: &[String], motors: &[String]) -> String {
    let (platform, others) =
        ends.split_first().map_or(("", ends), |(first, rest)| (&**first, rest));
    let pairs = others.iter().map(|end| format!("[{}, {}]", quoted(platform), quoted(end)));
    let motors = motors.iter().map(|name| quoted(name));
    let types = others.iter().map(|_| quoted("6d"));
    format!(
        "closed_loop: {}\ntype: {}\nname_mot: {}\njoint_name: []\njoint_type: []\n",
        list(pairs),
        list(types),
        list(motors)
    )
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// A text in single quotes, in which YAML doubles a quote and knows no other escapes.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}
