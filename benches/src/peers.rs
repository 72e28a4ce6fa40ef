//! Comparison with programs in Python. Such a program answers a line with a line, so that all
//! contenders alternate.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A script that counts on request; it ends when this is dropped.
#[derive(Debug)]
pub struct Peers {
    child: Child,
    pipes: Option<RefCell<(ChildStdin, BufReader<ChildStdout>)>>,
}

impl Peers {
    /// Starts a script, given by its path in this package, in the Python that `PEERS_PYTHON` names;
    /// `None` if the variable is not set.
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

    /// The number that the script counts for this request.
    ///
    /// # Panics
    /// If the script does not answer with a number; it has then written why.
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
        // The script ends when its input ends.
        self.pipes = None;
        let _ = self.child.wait();
    }
}
