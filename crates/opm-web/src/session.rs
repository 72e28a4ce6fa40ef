//! The state of a page: one mechanism, and answers about it.

use crate::explorer::Explorer;
use crate::problem::Problems;
use crate::request::Request;
use crate::{body, colours, description, forward, kinds, motion, pose, workspace};
use opm_core::mechanism::examples::EXAMPLES;
use opm_workspace::Axis;
use serde::Serialize;

/// The answer to a request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reply {
    /// JSON: what was asked for, or an object with `problems` alone.
    pub text: String,
    /// What would be long as text; the request says what it is.
    pub bytes: Vec<u8>,
}

impl Reply {
    /// An answer in JSON.
    pub(crate) fn new(value: &impl Serialize) -> Self {
        Self::with_bytes(value, Vec::new())
    }

    /// An answer in JSON with bytes.
    pub(crate) fn with_bytes(value: &impl Serialize, bytes: Vec<u8>) -> Self {
        match serde_json::to_string(value) {
            Ok(text) => Self { text, bytes },
            // All that is serialised here has strings as keys.
            Err(error) => {
                Self { text: format!("{{\"problems\":[{{\"message\":\"{error}\"}}]}}"), bytes }
            }
        }
    }

    /// The JSON, read; `null` if it is none.
    pub fn value(&self) -> serde_json::Value {
        serde_json::from_str(&self.text).unwrap_or_default()
    }
}

/// One mechanism that a page explores.
#[derive(Debug, Default)]
pub struct Session {
    explorer: Option<Explorer>,
    /// The grid that was fitted last, for the mechanism as it was then.
    fitted: Vec<Axis>,
    /// The grids that were fitted to kinds of workspace since then.
    kinds: kinds::Grids,
}

impl Session {
    /// Answers a request, which is JSON. A request that fails changes nothing.
    pub fn answer(&mut self, request: &str) -> Reply {
        let answered = match serde_json::from_str(request) {
            Ok(request) => self.serve(request),
            Err(error) => Err(Problems::one(format!("not a request: {error}"))),
        };
        answered.unwrap_or_else(|problems| Reply::new(&problems))
    }

    fn serve(&mut self, request: Request) -> Result<Reply, Problems> {
        match request {
            Request::Examples {} => Ok(examples()),
            Request::Open { name, text, changes } => {
                let explorer = self.explorer.insert(Explorer::open(&name, &text, &changes)?);
                self.fitted.clear();
                self.kinds.clear();
                Ok(description::describe(explorer))
            }
            Request::Change { changes } => {
                let changed = self.explorer()?.changed(&changes)?;
                Ok(description::describe(self.explorer.insert(changed)))
            }
            Request::File {} => Ok(Reply::new(&self.explorer()?.file().text())),
            Request::Pose { pose, mode, clearance } => {
                pose::solve(self.explorer()?, &pose, mode.as_deref(), clearance)
            }
            Request::Forward { joints, pose } => {
                forward::assemble(self.explorer()?, &joints, &pose)
            }
            Request::Fit { mode } => {
                let (reply, fitted) = workspace::fit(self.explorer()?, mode.as_deref())?;
                self.fitted = fitted;
                self.kinds.clear();
                Ok(reply)
            }
            Request::Whole { mode } => {
                workspace::whole(self.explorer()?, &self.fitted, mode.as_deref())
            }
            Request::Slice { x, y, pose, mode } => {
                workspace::slice(self.explorer()?, [&x, &y], &pose, mode.as_deref())
            }
            Request::Colours { x, y, pose, mode, by } => {
                colours::colours(self.explorer()?, [&x, &y], &pose, mode.as_deref(), &by)
            }
            Request::Body { axes, others, pose, mode } => {
                let (explorer, mode) = (self.explorer()?, mode.as_deref());
                body::body(explorer, &self.fitted, &axes, others, &pose, mode)
            }
            Request::Kinds {} => Ok(kinds::kinds(self.explorer()?)),
            Request::Kind { kind, pose, mode, turn } => {
                let explorer = self.explorer.as_ref().ok_or_else(nothing_open)?;
                kinds::count(explorer, &mut self.kinds, &kind, &pose, mode.as_deref(), turn)
            }
            Request::Motions {} => Ok(motion::shipped()),
            Request::Motion { name, text, mode } => {
                motion::follow(self.explorer()?, &name, &text, mode.as_deref())
            }
        }
    }

    fn explorer(&self) -> Result<&Explorer, Problems> {
        self.explorer.as_ref().ok_or_else(nothing_open)
    }
}

fn nothing_open() -> Problems {
    Problems::one("no mechanism is open")
}

/// The mechanisms that opm ships.
fn examples() -> Reply {
    #[derive(Serialize)]
    struct Example {
        name: &'static str,
        description: &'static str,
        text: &'static str,
    }
    let list =
        EXAMPLES.iter().map(|e| Example { name: e.name, description: e.description, text: e.text });
    Reply::new(&list.collect::<Vec<_>>())
}
