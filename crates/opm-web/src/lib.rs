//! What the explorer computes: a page in a browser asks, in JSON, and this crate answers.
//!
//! A [`Session`] holds one mechanism. [`Session::answer`] takes a [`Request`] as JSON, and gives a [`Reply`]: JSON, and
//! bytes for what would be long as text. Compiled to WebAssembly, the crate exports three functions that do this with a
//! text in memory (`exports`); natively it is a library like any other, and is tested as one.
//!
//! **Units.** The page shows the units of the mechanism file, so the numbers of requests and replies are in these units.
//! They become SI in the way in which a mechanism file is read: `12.5` in a file of millimetres is the double that
//! `12.5mm` is on the command line, and the counts of both are equal. Only what is drawn is in metres.
//!
//! ```
//! use opm_web::Session;
//!
//! let example = opm_core::mechanism::examples::find("plano-spherical-5dof").expect("it is shipped");
//! let open = serde_json::json!({ "do": "open", "text": example.text });
//! let mut session = Session::default();
//! let mechanism = session.answer(&open.to_string()).value();
//! assert_eq!(mechanism["coordinates"][3]["name"], "xi");
//!
//! let pose = session.answer(r#"{ "do": "pose", "pose": { "x": 10, "xi": 15 } }"#).value();
//! let s1 = pose["values"][0].as_f64().expect("a number");
//! assert!((s1 - 168.806).abs() < 1e-3); // millimetres
//! ```

mod body;
mod changes;
mod colours;
mod description;
mod explorer;
#[cfg(target_arch = "wasm32")]
mod exports;
mod forward;
mod handles;
mod interference;
mod kinds;
mod motion;
mod pose;
mod problem;
mod request;
mod scene;
mod session;
mod surface;
mod units;
mod workspace;

pub use problem::{Problem, ProblemKind, Problems};
pub use request::{AxisRequest, Others, Request};
pub use session::{Reply, Session};
