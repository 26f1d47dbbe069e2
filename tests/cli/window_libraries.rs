//! Libraries that the window opens at run time: missing ones are named, and the list of them is complete.
#![cfg(all(target_os = "linux", feature = "gui"))]

use super::{Command, Path, Stdio, stderr};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::process::Child;

/// Libraries of window systems that are opened with X11, and their Debian packages.
const X11: [(&str, &str); 7] = [
    ("libX11.so.6", "libx11-6"),
    ("libX11-xcb.so.1", "libx11-xcb1"),
    ("libxcb.so.1", "libxcb1"),
    ("libXcursor.so.1", "libxcursor1"),
    ("libXi.so.6", "libxi6"),
    ("libxkbcommon.so.0", "libxkbcommon0"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
];
const WAYLAND: [(&str, &str); 2] =
    [("libwayland-client.so.0", "libwayland-client0"), ("libxkbcommon.so.0", "libxkbcommon0")];

/// Those of them that a test can hide: `LD_LIBRARY_PATH` does not hide libraries that are opened by their whole path, as
/// those of X11 are where the machine that built the program has their development files.
const HIDDEN: [&str; 4] = ["libxcb.so.1", "libxkbcommon.so.0", "libxkbcommon-x11.so.0", "libwayland-client.so.0"];

/// Libraries that draw, of which one is enough, and a debugger's that wgpu looks for.
const DRIVERS: [&str; 8] = [
    "librenderdoc.so",
    "libvulkan.so.1",
    "libvulkan.so",
    "libEGL.so.1",
    "libEGL.so",
    "libGL.so.1",
    "libGL.so",
    "libwayland-egl.so.1",
];

/// Returns the program, with its own folders for settings and state.
fn window(folder: &Path) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_catchlight"));
    program.current_dir(folder).env("HOME", folder).env("XDG_STATE_HOME", folder).env("XDG_CONFIG_HOME", folder);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        program.env_remove(name);
    }
    program
}

#[test]
fn a_missing_library_of_the_window_system_is_named_with_its_debian_package() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [("DISPLAY", ":77", X11.as_slice()), ("WAYLAND_DISPLAY", "wayland-77", WAYLAND.as_slice())];
    for (variable, display, libraries) in cases {
        for (file, package) in libraries.iter().filter(|(file, _)| HIDDEN.contains(file)) {
            // A file of this name that is no library hides the real one, which may have a second name.
            let hiding = folder.path().join(format!("{variable}_{package}"));
            std::fs::create_dir(&hiding).unwrap();
            let (second_name, _) = file.rsplit_once('.').unwrap();
            for name in [*file, second_name] {
                std::fs::write(hiding.join(name), "no library").unwrap();
            }
            let mut program = window(folder.path());
            let output = program.env(variable, display).env("LD_LIBRARY_PATH", &hiding).output().unwrap();
            let message = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{file}: {message}");
            assert!(message.contains(file) && message.contains(package), "{file}: {message}");
            assert!(message.contains("apt-get install") && message.contains("catchlight render"), "{message}");
            assert!(!message.contains("panicked"), "{message}");
        }
    }
}

/// A display server without a screen, which ends with it.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts one. None if the machine has none; the test fails if it must have one.
    #[expect(clippy::print_stderr, reason = "a skipped test says so")]
    fn start() -> Option<Self> {
        let mut xvfb = Command::new("Xvfb");
        xvfb.args(["-displayfd", "1", "-screen", "0", "1024x768x24", "-nolisten", "tcp"]);
        let Ok(mut server) = xvfb.stdout(Stdio::piped()).stderr(Stdio::null()).spawn() else {
            assert!(std::env::var_os("CATCHLIGHT_REQUIRE_GPU").is_none(), "there is no Xvfb");
            eprintln!("\n!!! SKIPPED, no Xvfb\n");
            return None;
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Display { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Returns the libraries that the program itself has opened at run time, as the dynamic linker logs them (ld.so(8)).
fn opened_libraries(log: &Path) -> BTreeSet<String> {
    let log = std::fs::read_to_string(log).unwrap();
    let opened = log.lines().filter_map(|line| line.split_once("dynamically loaded by "));
    let by_program = opened.filter(|(_, by)| by.starts_with(env!("CARGO_BIN_EXE_catchlight")));
    let file = |line: &str| Some(line.split_once("file=")?.1.split(' ').next()?.to_owned());
    by_program.filter_map(|(line, _)| file(line)).collect()
}

#[test]
fn the_libraries_that_a_window_opens_are_those_that_are_checked_before() {
    let Some(display) = Display::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut program = window(folder.path());
    program.env("DISPLAY", &display.name).env("RUST_LOG", "catchlight=debug");
    program.env("LD_DEBUG", "files").env("LD_DEBUG_OUTPUT", folder.path().join("linker"));
    let mut window = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut log = BufReader::new(window.stderr.take().unwrap()).lines().map(Result::unwrap);
    let messages: Vec<String> = log.by_ref().take_while(|line| !line.contains("first frame after")).collect();
    let is_open = window.try_wait().unwrap().is_none();
    window.kill().unwrap();
    window.wait().unwrap();
    assert!(is_open, "the window has ended: {messages:?}");
    let opened = opened_libraries(&folder.path().join(format!("linker.{}", window.id())));
    // What a library before it has opened is not opened anew.
    for (file, _) in X11.iter().filter(|(file, _)| *file != "libxcb.so.1") {
        assert!(opened.contains(*file), "{file} is checked and not used: {opened:?}");
    }
    let known: BTreeSet<&str> = X11.map(|(file, _)| file).into_iter().chain(DRIVERS).collect();
    let unknown: Vec<&String> = opened.iter().filter(|file| !known.contains(file.as_str())).collect();
    assert!(unknown.is_empty(), "not checked before the window opens: {unknown:?}");
    assert!(opened.iter().any(|file| DRIVERS.contains(&file.as_str())), "{opened:?}");
}

#[test]
fn readme_names_the_packages_that_a_window_needs() {
    let readme = include_str!("../../README.md");
    let line = readme.lines().find(|line| line.contains("apt-get install")).unwrap();
    for (_, package) in X11.iter().chain(&WAYLAND) {
        assert!(line.split([' ', '`']).any(|word| word == *package), "{package} is not in {line:?}");
    }
}
