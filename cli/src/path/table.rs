//! `opm path --vary`: whether two poses are joined for each value of a number of the mechanism file.

use super::Query;
use crate::args::{Output, PathArgs};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::GridAxis;
use crate::progress::interruptible;
use crate::runs::{self, Cell};
use crate::workspace::{Work, threads};
use serde_json::Value;
use std::sync::Arc;

pub fn run(
    args: &PathArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    if let Ok(manipulator) = loaded.compile() {
        Query::new(args, loaded, Arc::new(manipulator))?.note(output);
    }
    let silent = output.silent();
    let work = Work { output: &silent, pool: &pool, progress: &progress };
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let query = Query::new(args, changed, Arc::new(changed.compile()?))?;
        let answer = query.search(&work)?;
        let number = |name: &str, number: Option<u64>| match number {
            Some(number) => Cell::count(name, number),
            None => Cell::new(name, Value::Null, "-"),
        };
        let [from, to] = answer.labels.map(|label| label.map(u64::from));
        let path = answer.found.as_ref().ok();
        let reason = answer.found.as_ref().err().map(ToString::to_string);
        Ok(vec![
            Cell::answer("joined", path.is_some()),
            Cell::count("aspects", answer.aspects.list().len() as u64),
            number("from", from),
            number("to", to),
            number("poses", path.map(|path| path.poses.len() as u64)),
            Cell::number("clearance", path.map_or(f64::NAN, |path| path.clearance)),
            // The whole reason also has advice.
            Cell::new("reason", reason.clone(), reason.as_deref().map_or("-", first_clause)),
        ])
    })
}

fn first_clause(reason: &str) -> &str {
    reason.split([':', ';']).next().unwrap_or(reason)
}
