//! Headings that options of a long help stand under. Those without one matter first.

/// How many options a command has at most, if its short help lists all of them.
pub const FEW: usize = 10;

pub const MECHANISM: &str = "The mechanism";
pub const LOAD: &str = "Loads, weights and stiffness";
pub const COUNTS: &str = "Which poses count";
pub const ALSO: &str = "What is also found";
pub const COMPARE: &str = "Tables of several results";
pub const WRITTEN: &str = "What is written";
pub const TIMING: &str = "The fastest timing";
pub const TABLE: &str = "How tables are read";
pub const WORK: &str = "Parts of the work, and threads";
pub const FIT: &str = "How parameters are fitted";
pub const PLAN: &str = "What a plan is chosen from";
pub const BOX: &str = "Bounds over a box";
pub const ERRORS: &str = "How errors are taken";
pub const SAMPLES: &str = "Random errors";
pub const SEARCH: &str = "The search";
