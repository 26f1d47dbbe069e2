//! Every dependency of `Cargo.toml` is used.

use super::sources::{rust_files, sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Returns the crates named in a section of `Cargo.toml`, as identifiers.
fn dependencies(manifest: &str, section: &str) -> Vec<String> {
    let body = manifest.split(&format!("\n[{section}]\n")).nth(1).unwrap();
    let lines = body.lines().take_while(|line| !line.starts_with('['));
    lines.filter_map(|line| line.split_once(" = ")).map(|(name, _)| name.replace('-', "_")).collect()
}

#[test]
fn every_dependency_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let used: BTreeSet<String> = sources().into_values().flat_map(|file| file.crates).collect();
    for name in dependencies(&manifest, "dependencies") {
        // wgpu comes with eframe.
        assert!(used.contains(&name) || (name == "eframe" && used.contains("wgpu")), "src/ does not use {name}");
    }
    let mut paths = Vec::new();
    rust_files(&root.join("tests"), &mut paths);
    rust_files(&root.join("src"), &mut paths);
    let texts: Vec<String> = paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    for name in dependencies(&manifest, "dev-dependencies") {
        assert!(texts.iter().any(|text| text.contains(&format!("{name}::"))), "no test uses {name}");
    }
}
