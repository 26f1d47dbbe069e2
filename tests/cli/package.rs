//! What a package holds beside the program: completions, man pages, the desktop entry and the type of studios.

use super::{catchlight, stderr};
use std::fs;

#[test]
fn completions_and_man_pages_name_every_command_and_option_that_help_names() {
    let folder = tempfile::tempdir().unwrap();
    let output = catchlight(folder.path(), &["package-files", "package"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let read = |name: &str| fs::read_to_string(folder.path().join("package").join(name)).unwrap();
    let shells = ["completions/catchlight.bash", "completions/_catchlight", "completions/catchlight.fish"];
    for command in ["render", "merge", "preview", "meter", "check", "chart", "presets", "gear"] {
        let help = super::stdout(&catchlight(folder.path(), &[command, "--help"]));
        let page = read(&format!("man/catchlight-{command}.1"));
        assert!(page.contains(".SH SYNOPSIS"), "{page}");
        // Man pages escape the hyphen.
        let page = page.replace("\\-", "-");
        for option in help.split_whitespace().filter(|word| word.starts_with("--") && word.len() > 3) {
            let option = option.trim_end_matches([',', ';', ':', '.', ')', ']']);
            assert!(page.contains(option), "{command} {option}");
        }
        assert!(shells.iter().all(|shell| read(shell).contains(command)), "{command}");
    }
    assert!(read("man/catchlight.1").contains("catchlight"));
    assert!(shells.iter().all(|shell| read(shell).contains("samples")));
    assert!(!read("completions/catchlight.bash").contains("bake"), "a command of developers");
}

#[test]
fn the_desktop_entry_opens_what_the_type_of_studios_describes() {
    let (entry, types) =
        (include_str!("../../packaging/catchlight.desktop"), include_str!("../../packaging/catchlight.xml"));
    let value = |key: &str| entry.lines().find_map(|line| line.strip_prefix(key)).unwrap();
    assert_eq!(value("Exec="), "catchlight %f");
    let studio = value("MimeType=").trim_end_matches(';');
    assert!(types.contains(&format!("<mime-type type=\"{studio}\">")));
    // The magic of the type: a text within the first so many bytes.
    let matches: Vec<(usize, &str)> = types
        .split("<match ")
        .skip(1)
        .map(|found| {
            let attribute = |name: &str| found.split_once(name).unwrap().1.split('"').nth(1).unwrap();
            (attribute("offset=").split_once(':').unwrap().1.parse().unwrap(), attribute("value="))
        })
        .collect();
    assert_eq!(matches.len(), 2);
    for preset in catchlight::io::presets() {
        let written = catchlight::io::write_scene(&preset.scene().unwrap());
        for (end, text) in &matches {
            for file in [preset.text, written.as_str()] {
                assert!(file.find(text).is_some_and(|at| at <= *end), "{} {text}", preset.file_name);
            }
        }
    }
}
