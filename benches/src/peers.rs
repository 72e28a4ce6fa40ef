//! What is compared with in Python: a program that answers a line with a line, so that all take turns.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A script that counts when asked; it ends when this is dropped.
#[derive(Debug)]
pub struct Peers {
    child: Child,
    pipes: Option<RefCell<(ChildStdin, BufReader<ChildStdout>)>>,
}

impl Peers {
    /// Starts a script, a path in this package, in the Python that `PEERS_PYTHON` names; `None` where it
    /// names none.
    ///
    /// # Panics
    /// If that Python does not start.
    pub fn start(script: &str) -> Option<Self> {
        let python = std::env::var_os("PEERS_PYTHON")?;
        let mut child = Command::new(python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(script))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the Python that PEERS_PYTHON names");
        let pipes = child.stdin.take().zip(child.stdout.take());
        let pipes = pipes.map(|(to, from)| RefCell::new((to, BufReader::new(from))));
        Some(Self { child, pipes })
    }

    /// What the script counts when it is asked this.
    ///
    /// # Panics
    /// If it does not answer with a number: it has written why.
    pub fn ask(&self, question: &str) -> u64 {
        let mut pipes = self.pipes.as_ref().expect("a script that runs").borrow_mut();
        let mut answer = String::new();
        writeln!(pipes.0, "{question}").expect("a script that listens");
        pipes.1.read_line(&mut answer).expect("a script that answers");
        answer.trim().parse().unwrap_or_else(|_| panic!("{question}: no number, but {answer:?}"))
    }
}

impl Drop for Peers {
    fn drop(&mut self) {
        // The end of what it reads is its end.
        self.pipes = None;
        let _ = self.child.wait();
    }
}
