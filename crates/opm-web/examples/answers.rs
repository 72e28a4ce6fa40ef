//! Answers the requests of a page: one JSON object per line in, one out. Tests compare the page with it.

use opm_web::Session;
use std::io::{self, BufRead, Write};

fn main() -> io::Result<()> {
    let mut session = Session::default();
    let mut out = io::stdout().lock();
    for line in io::stdin().lock().lines() {
        writeln!(out, "{}", session.answer(&line?).text)?;
    }
    Ok(())
}
