//! Files that a picture can't be written to: refused before the render, or replaced by another one after it.
#![cfg(unix)]

use super::running_render::{LONG, RunningRender, catchlight};
use super::{Command, Path, stderr};
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};

fn is_picture(path: &Path) -> bool {
    image::ImageReader::open(path).unwrap().with_guessed_format().unwrap().decode().is_ok()
}

/// Runs a render of a few pixels.
fn render(folder: &Path, output: &str) -> std::process::Output {
    super::catchlight(folder, &["render", "split", "-o", output, "--size", "32x48", "--spp", "1"])
}

#[test]
fn a_file_that_cannot_be_written_is_refused_before_the_first_ray() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("folder.png")).unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    std::fs::write(folder.path().join("old.png"), "an older picture").unwrap();
    std::fs::set_permissions(folder.path().join("old.png"), PermissionsExt::from_mode(0o444)).unwrap();
    let long = format!("{}.png", "n".repeat(300));
    for (output, code, reason) in [
        ("folder.png", 1, "this is a folder"),
        (&long, 1, "the name is too long"),
        ("missing/x.png", 1, "there is no such folder: missing"),
        ("file/x.png", 1, "there is no such folder: file"),
        ("old.png", 2, "the older file is read-only"),
    ] {
        // The whole render would take minutes.
        let output = super::catchlight(folder.path(), &[&["render", "split", "-o", output], &LONG[..]].concat());
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert!(stderr(&output).contains(reason), "{}", stderr(&output));
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("old.png")).unwrap(), "an older picture");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "no temporary file is left");
}

#[test]
fn a_picture_whose_folder_disappears_during_the_render_is_kept_in_the_state_folder() {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("disk");
    std::fs::create_dir(&target).unwrap();
    let mut program = catchlight();
    program.env("XDG_STATE_HOME", folder.path().join("state"));
    let render = RunningRender::start(program, folder.path(), "disk/x.png", &LONG);
    std::fs::remove_dir(&target).unwrap();
    render.send("-INT");
    let (code, message) = render.end();
    assert_eq!(code, Some(2), "{message}");
    let kept = folder.path().join("state/catchlight/x (kept 1).png");
    assert!(message.ends_with(&format!("the picture is kept as {}", kept.display())), "{message}");
    assert!(is_picture(&kept));
}

#[test]
fn a_picture_whose_file_becomes_a_folder_during_the_render_is_kept_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let render = RunningRender::start(catchlight(), folder.path(), "x.png", &LONG);
    std::fs::create_dir(folder.path().join("x.png")).unwrap();
    render.send("-INT");
    let (code, message) = render.end();
    assert_eq!(code, Some(2), "{message}");
    assert!(
        message.ends_with("this is a folder, or no file name: x.png; the picture is kept as ./x (kept 1).png"),
        "{message}"
    );
    assert!(is_picture(&folder.path().join("x (kept 1).png")));
}

#[cfg(target_os = "linux")]
#[test]
fn a_link_to_a_full_device_stays_a_link_and_the_picture_is_kept_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("x.png");
    symlink("/dev/full", &link).unwrap();
    let output = render(folder.path(), "x.png");
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let message = "catchlight: can't write: the disk is full: x.png; the picture is kept as ./x (kept 1).png";
    assert_eq!(stderr(&output).lines().last(), Some(message));
    assert!(link.is_symlink() && is_picture(&folder.path().join("x (kept 1).png")));
}

#[test]
fn a_pipe_takes_the_picture_and_stays_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("x.png");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read(pipe).unwrap()
    });
    let output = render(folder.path(), "x.png");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(image::load_from_memory(&reader.join().unwrap()).is_ok());
    assert!(std::fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
}

#[cfg(target_os = "linux")]
#[test]
fn a_picture_that_no_folder_takes_exits_with_code_2_and_leaves_no_torn_file() {
    let folder = tempfile::tempdir().unwrap();
    // A limit of a kilobyte for every file stops writes half-way, as a full disk does.
    let limited = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    let mut shell = Command::new("sh");
    shell.args(["-c", limited, env!("CARGO_BIN_EXE_catchlight"), "render", "split", "-o", "x.png", "--size", "64x96"]);
    shell.args(["--spp", "1"]).current_dir(folder.path()).env("TMPDIR", folder.path());
    let output = shell.env("XDG_STATE_HOME", folder.path().join("state")).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("no other folder takes the picture"), "{}", stderr(&output));
    let state = folder.path().join("state");
    assert!(std::fs::read_dir(folder.path()).unwrap().all(|entry| entry.unwrap().path() == state));
    assert_eq!(std::fs::read_dir(state.join("catchlight")).unwrap().count(), 0);
}
