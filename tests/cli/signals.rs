//! Signals during a render: Ctrl+C, a scheduler's SIGTERM, a closed terminal's SIGHUP.
#![cfg(unix)]

use super::{Command, Path, Stdio};
use std::io::{BufRead, BufReader, Lines};
use std::process::{Child, ChildStderr};

/// A render whose every pixel has a sample.
struct RunningRender {
    child: Child,
    log: Lines<BufReader<ChildStderr>>,
}

impl RunningRender {
    /// Starts `program` with the arguments of a render, and waits for its first picture.
    fn start(mut program: Command, folder: &Path, options: &[&str]) -> Self {
        program.current_dir(folder).env("RUST_LOG", "catchlight=debug");
        program.args(["render", "split", "-o", "x.png", "--size", "64x96", "--json"]).args(options);
        let mut child = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut log = BufReader::new(child.stderr.take().unwrap()).lines();
        assert!(log.any(|line| line.unwrap().contains("every pixel has a sample")));
        RunningRender { child, log }
    }

    fn send(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// Waits for the end; returns the exit code, none for a program that a signal has ended.
    fn exit_code(mut self) -> Option<i32> {
        self.log.by_ref().for_each(drop);
        self.child.wait().unwrap().code()
    }
}

fn catchlight() -> Command {
    Command::new(env!("CARGO_BIN_EXE_catchlight"))
}

/// Options of a render that would take minutes.
const LONG: [&str; 2] = ["--spp", "100000"];

#[test]
fn ctrl_c_a_scheduler_and_a_closed_terminal_end_a_render_that_keeps_its_picture() {
    for signals in [&["-INT"][..], &["-TERM"], &["-HUP"], &["-HUP", "-HUP", "-TERM"]] {
        let folder = tempfile::tempdir().unwrap();
        let render = RunningRender::start(catchlight(), folder.path(), &LONG);
        signals.iter().for_each(|signal| render.send(signal));
        assert_eq!(render.exit_code(), Some(130), "{signals:?}");
        assert_eq!(image::open(folder.path().join("x.png")).unwrap().to_rgb8().dimensions(), (64, 96), "{signals:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_render_under_nohup_outlives_its_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_catchlight")]);
    let render = RunningRender::start(shell, folder.path(), &["--time", "0.5"]);
    render.send("-HUP");
    assert_eq!(render.exit_code(), Some(0));
}
