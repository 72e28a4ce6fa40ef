//! Which columns of somebody else's table are read.

use super::heading;
use opm_core::table::ColumnNames;

/// How a table of times and poses is read.
#[derive(Debug, Default, clap::Args)]
pub struct MotionTableArgs {
    /// The columns of a CSV file that are read, by the names that they have there: t=stamp,x=pos_x,y; others are passed over
    #[arg(help_heading = heading::TABLE, long, value_name = "NAME=HEADING,...")]
    pub columns: Option<ColumnNames>,
    /// Count the times of a CSV file from that of its first row, such as seconds since 1970
    #[arg(help_heading = heading::TABLE, long)]
    pub relative_time: bool,
}

impl MotionTableArgs {
    /// The first flag that was given.
    pub fn given(&self) -> Option<&'static str> {
        match (&self.columns, self.relative_time) {
            (Some(_), _) => Some("--columns"),
            (None, true) => Some("--relative-time"),
            (None, false) => None,
        }
    }
}
