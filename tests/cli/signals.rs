//! Signals during a render: Ctrl+C, a scheduler's SIGTERM, a closed terminal's SIGHUP.
#![cfg(unix)]

use super::Command;
use super::running_render::{LONG, RunningRender, catchlight};

#[test]
fn ctrl_c_a_scheduler_and_a_closed_terminal_end_a_render_that_keeps_its_picture() {
    for signals in [&["-INT"][..], &["-TERM"], &["-HUP"], &["-HUP", "-HUP", "-TERM"]] {
        let folder = tempfile::tempdir().unwrap();
        let render = RunningRender::start(catchlight(), folder.path(), "x.png", &LONG);
        signals.iter().for_each(|signal| render.send(signal));
        assert_eq!(render.end().0, Some(130), "{signals:?}");
        assert_eq!(image::open(folder.path().join("x.png")).unwrap().to_rgb8().dimensions(), (64, 96), "{signals:?}");
    }
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
