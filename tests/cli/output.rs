//! Output that nobody takes: closed pipes and full devices behind stdout and stderr.
#![cfg(unix)]

use super::{Command, Path, Stdio, catchlight, stderr};
use std::fs::File;
use std::os::fd::OwnedFd;
use std::process::ExitStatus;

/// Returns the writing end of a pipe that nobody reads.
fn closed_pipe() -> OwnedFd {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer.into()
}

/// Runs the program with these files as stdout and stderr.
fn run(folder: &Path, arguments: &[&str], out: impl Into<Stdio>, errors: impl Into<Stdio>) -> ExitStatus {
    let mut command = Command::new(env!("CARGO_BIN_EXE_catchlight"));
    // Every log line is a write to the closed pipe, too.
    command.current_dir(folder).env("RUST_LOG", "trace").args(arguments);
    command.stdout(out).stderr(errors).status().unwrap()
}

#[test]
fn a_render_goes_on_when_the_program_that_reads_its_messages_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "split", "-o", "x.png", "--size", "16x24", "--spp", "2", "--explain"];
    let status = run(folder.path(), &render, closed_pipe(), closed_pipe());
    assert_eq!(status.code(), Some(0), "{status}");
    assert_eq!(image::open(folder.path().join("x.png")).unwrap().to_rgb8().dimensions(), (16, 24));
    // The error of a wrong command has no reader, either.
    assert_eq!(run(folder.path(), &["check", "nowhere.ron"], closed_pipe(), closed_pipe()).code(), Some(1));
}

#[test]
fn printing_ends_quietly_when_the_reader_of_stdout_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [&["presets"][..], &["--help"], &["meter", "split", "--at", "0,1.6,0", "--spp", "4", "--json"]] {
        let messages = File::create(folder.path().join("messages")).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_catchlight"));
        let status = command.args(arguments).stdout(closed_pipe()).stderr(messages).status().unwrap();
        assert_eq!(status.code(), Some(0), "{arguments:?}: {status}");
        assert_eq!(std::fs::read_to_string(folder.path().join("messages")).unwrap(), "", "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_a_full_disk_does_not_take_exits_with_code_2() {
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "split", "-o", "x.png", "--size", "8x12", "--spp", "1", "--json"];
    for arguments in [&["presets"][..], &["--help"], &["check", "split"], &render] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_catchlight"));
        let output = command.current_dir(folder.path()).args(arguments).stdout(full).stderr(Stdio::piped()).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        assert_eq!(stderr(&output).lines().last(), Some("catchlight: can't write the output: the disk is full"));
    }
    assert!(folder.path().join("x.png").exists(), "the picture is not the output that failed");
    assert_eq!(catchlight(folder.path(), &["presets"]).status.code(), Some(0));
}
