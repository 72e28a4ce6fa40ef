//! Manipulators from pickles, by the texts of their files: a worker gets the same one with every task.

use crate::manipulator::Manipulator;
use std::collections::VecDeque;
use std::sync::Mutex;

/// How many files are kept: few, as each is a decomposed mechanism.
const MOST: usize = 32;

/// Those of the files that were restored last, the latest at the end.
static KEPT: Mutex<VecDeque<Manipulator>> = Mutex::new(VecDeque::new());

/// The manipulator of this file.
pub fn find(text: &str) -> Option<Manipulator> {
    let mut kept = KEPT.lock().ok()?;
    let place = kept.iter().position(|known| known.text() == text)?;
    let found = kept.remove(place)?;
    let copy = found.labelled(String::new());
    kept.push_back(found);
    Some(copy)
}

/// Keeps it, and forgets the oldest if there are many.
pub fn keep(made: &Manipulator) {
    let Ok(mut kept) = KEPT.lock() else { return };
    kept.push_back(made.labelled(String::new()));
    if kept.len() > MOST {
        kept.pop_front();
    }
}
