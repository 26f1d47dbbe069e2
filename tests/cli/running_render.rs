//! A render in progress.
#![cfg(unix)]

use super::{Command, Path, Stdio};
use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStderr};

/// Options of a render that would take minutes.
pub const LONG: [&str; 2] = ["--spp", "100000"];

/// A render whose every pixel has a sample.
pub struct RunningRender {
    child: Child,
    log: Lines<BufReader<ChildStderr>>,
}

/// Returns the program without arguments.
pub fn catchlight() -> Command {
    Command::new(env!("CARGO_BIN_EXE_catchlight"))
}

impl RunningRender {
    /// Starts `program` with the arguments of a render, and waits for its first picture.
    pub fn start(mut program: Command, folder: &Path, output: &str, options: &[&str]) -> Self {
        program.current_dir(folder).env("RUST_LOG", "catchlight=debug");
        program.args(["render", "split", "-o", output, "--size", "64x96", "--json"]).args(options);
        let mut child = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut log = BufReader::new(child.stderr.take().unwrap()).lines();
        assert!(log.any(|line| line.unwrap().contains("every pixel has a sample")));
        RunningRender { child, log }
    }

    /// Sends a signal, by its option of `kill`.
    pub fn send(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// Waits for the end. Returns the exit code, none for a program that a signal has ended, and the last message.
    pub fn end(mut self) -> (Option<i32>, String) {
        let last = self.log.by_ref().map(Result::unwrap).last();
        (self.child.wait().unwrap().code(), last.unwrap_or_default())
    }
}
