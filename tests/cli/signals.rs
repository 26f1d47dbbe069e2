//! Signals during a render: Ctrl+C, a scheduler's SIGTERM, a closed terminal's SIGHUP.
#![cfg(unix)]

use super::Command;
use super::running_render::{LONG, RunningRender, catchlight};

/// Sends signals to a long render, which has to keep its picture.
fn interrupt(program: impl Fn() -> Command, cases: &[&[&str]]) {
    for signals in cases {
        let folder = tempfile::tempdir().unwrap();
        let render = RunningRender::start(program(), folder.path(), "x.png", &LONG);
        signals.iter().for_each(|signal| render.send(signal));
        assert_eq!(render.end().0, Some(130), "{signals:?}");
        assert_eq!(image::open(folder.path().join("x.png")).unwrap().to_rgb8().dimensions(), (64, 96), "{signals:?}");
    }
}

#[test]
fn ctrl_c_and_a_scheduler_end_a_render_that_keeps_its_picture() {
    interrupt(catchlight, &[&["-INT"], &["-TERM"]]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_terminal_ends_a_render_that_keeps_its_picture() {
    // The tests themselves may run under `nohup`.
    let program = || {
        let mut env = Command::new("env");
        env.args(["--default-signal=HUP", env!("CARGO_BIN_EXE_catchlight")]);
        env
    };
    // A terminal that closes may send several.
    interrupt(program, &[&["-HUP"], &["-HUP", "-HUP", "-TERM"]]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_render_under_nohup_outlives_its_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_catchlight")]);
    let render = RunningRender::start(shell, folder.path(), "x.png", &["--time", "0.5"]);
    render.send("-HUP");
    assert_eq!(render.end().0, Some(0));
}
