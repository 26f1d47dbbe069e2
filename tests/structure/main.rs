//! The structure of `src/`: the direction of imports that lib.rs states, and import circles between files.
//!
//! `sources` parses the files and finds the edges between them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]

mod dependencies;
mod readme;
mod sources;

use sources::{Names, edges, rust_files, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Rooms from the lowest layer to the highest. A room imports from lower layers only, and not from its own.
const LAYERS: [&[&str]; 10] = [
    &["math", "color"],
    &["scene"],
    &["photo"],
    &["gear", "denoise", "figures", "water", "raytrace", "raster", "preview"],
    &["io"],
    &["jobs", "truth"],
    &["setup"],
    &["sheet"],
    &["editor", "cli"],
    &["main"],
];

/// The one import between rooms of one layer: the command line opens the window.
const WITHIN_LAYER: [(&str, &str); 1] = [("cli", "editor")];

/// Rooms that may use a crate which draws on the GPU or in a window.
const GUI_CRATES: [(&[&str], &[&str]); 2] = [
    (&["wgpu", "bytemuck"], &["preview", "editor"]),
    (&["egui", "eframe", "winit", "rfd", "wayland_sys", "x11_dl", "x11rb", "xkbcommon_dl"], &["editor"]),
];

/// Import circles that remain inside a room, each explained in the head of its `mod.rs`; the first file of each.
const KNOWN_CIRCLES: [&str; 0] = [];

/// Returns all files that can be reached from one by imports.
fn reachable<'a>(edges: &'a BTreeMap<Names, BTreeSet<Names>>, from: &'a Names) -> BTreeSet<&'a Names> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(module) = open.pop() {
        open.extend(edges[module].iter().filter(|target| seen.insert(*target)));
    }
    seen
}

fn layer(room: &str) -> usize {
    let position = LAYERS.iter().position(|rooms| rooms.contains(&room));
    position.unwrap_or_else(|| panic!("src/{room} has no layer: add it here and to the drawing in lib.rs"))
}

fn room(module: &[String]) -> &str {
    module.first().map_or("lib", String::as_str)
}

#[test]
fn rooms_import_only_from_lower_layers() {
    let files = sources();
    let mut wrong = Vec::new();
    for (module, targets) in edges(&files).iter().filter(|(module, _)| !module.is_empty()) {
        for target in targets {
            let (from, to) = (room(module), room(target));
            let allowed = from == to || layer(to) < layer(from) || WITHIN_LAYER.contains(&(from, to));
            if !allowed {
                wrong.push(format!("{} imports {}", module.join("::"), target.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "against the direction of imports:\n{}", wrong.join("\n"));
}

#[test]
fn only_editor_and_preview_use_the_gpu_and_only_the_editor_uses_egui() {
    for file in sources().values() {
        for (crates, rooms) in GUI_CRATES {
            for name in crates {
                let module = file.module.join("::");
                assert!(!file.crates.contains(*name) || rooms.contains(&room(&file.module)), "{module} uses {name}");
            }
        }
    }
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let files = sources();
    assert!(files.len() > 200, "only {} files found", files.len());
    let edges = edges(&files);
    let reach: BTreeMap<&Names, BTreeSet<&Names>> = edges.keys().map(|m| (m, reachable(&edges, m))).collect();
    let mut circles = BTreeSet::new();
    for (module, reached) in reach.iter().filter(|(module, reached)| reached.contains(*module)) {
        let circle: BTreeSet<String> =
            reached.iter().filter(|other| reach[**other].contains(*module)).map(|other| other.join("::")).collect();
        circles.insert(circle);
    }
    let unknown = circles.iter().filter(|circle| !circle.first().is_some_and(|m| KNOWN_CIRCLES.contains(&m.as_str())));
    let unknown: Vec<String> = unknown.map(|circle| circle.iter().cloned().collect::<Vec<_>>().join(", ")).collect();
    assert!(unknown.is_empty(), "import circles:\n{}", unknown.join("\n"));
}

#[test]
fn the_gui_feature_is_named_in_three_places_at_most() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    rust_files(&root, &mut paths);
    let count: usize =
        paths.iter().map(|path| fs::read_to_string(path).unwrap().matches("feature = \"gui\"").count()).sum();
    assert!((1..=3).contains(&count), "{count} cfg sites");
}
