//! The files of `src/` and the edges between them, parsed with `syn`.
//!
//! An edge leads from a file to the file that defines a name it imports, by `use` or by an inline `crate::` or `super::`
//! path. Re-exports are followed to the defining file, test modules are left out, and a `mod.rs` that re-exports its
//! children does not count as an importer of them.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree, Visibility};

/// A path of names, such as `["raytrace", "film", "Film"]`.
pub type Names = Vec<String>;

/// A file of the crate: its module path and the names it imports.
pub struct SourceFile {
    pub module: Names,
    is_facade: bool,
    /// Imported absolute paths within the crate; true for `pub use`.
    imports: Vec<(bool, Names)>,
    /// First segments of imported paths of other crates.
    pub crates: BTreeSet<String>,
    /// Names that the file re-exports, with the path of their definition.
    exports: HashMap<String, Names>,
}

/// Collects imports of one file.
struct Collector<'a> {
    file: &'a mut SourceFile,
    children: &'a BTreeSet<String>,
}

/// Returns the crate that a path leads into; eframe re-exports wgpu.
fn crate_of(path: &[String]) -> Option<String> {
    match path {
        [eframe, wgpu, ..] if eframe == "eframe" && wgpu == "wgpu" => Some(wgpu.clone()),
        _ => path.first().cloned(),
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Ident>().is_ok_and(|ident| ident == "test")
    })
}

/// Returns the leaves of a use tree as paths, each with the name under which it is imported.
fn leaves(tree: &UseTree, prefix: &mut Names, found: &mut Vec<(Names, String)>) {
    match tree {
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            leaves(&path.tree, prefix, found);
            prefix.pop();
        }
        UseTree::Group(group) => group.items.iter().for_each(|item| leaves(item, prefix, found)),
        UseTree::Name(name) if name.ident == "self" => {
            found.push((prefix.clone(), prefix.last().cloned().unwrap_or_default()));
        }
        UseTree::Name(name) => {
            found.push(([prefix.as_slice(), &[name.ident.to_string()]].concat(), name.ident.to_string()));
        }
        UseTree::Rename(rename) => {
            found.push(([prefix.as_slice(), &[rename.ident.to_string()]].concat(), rename.rename.to_string()));
        }
        UseTree::Glob(_) => found.push((prefix.clone(), "*".to_owned())),
    }
}

impl Collector<'_> {
    /// Returns the path from the crate's root; none for a path into another crate.
    fn absolute(&self, path: &[String]) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        let here = &self.file.module;
        match first.as_str() {
            "crate" | "catchlight" => Some(rest.to_vec()),
            "self" => Some([here.as_slice(), rest].concat()),
            "super" => {
                let ups = path.iter().take_while(|name| *name == "super").count();
                Some([&here[..here.len().checked_sub(ups)?], &path[ups..]].concat())
            }
            child if self.children.contains(child) => Some([here.as_slice(), path].concat()),
            _ => None,
        }
    }

    fn import(&mut self, is_public: bool, path: &[String], name: &str) {
        match self.absolute(path) {
            Some(absolute) => {
                if is_public {
                    self.file.exports.insert(name.to_owned(), absolute.clone());
                }
                self.file.imports.push((is_public, absolute));
            }
            None => self.file.crates.extend(crate_of(path)),
        }
    }
}

impl<'ast> Visit<'ast> for Collector<'_> {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if is_test(&item.attrs) {
            return;
        }
        let mut found = Vec::new();
        leaves(&item.tree, &mut Names::new(), &mut found);
        for (path, name) in found {
            self.import(!matches!(item.vis, Visibility::Inherited), &path, &name);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Names = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1 {
            if matches!(names[0].as_str(), "crate" | "super" | "catchlight") {
                self.import(false, &names, "");
            } else if names[0].chars().next().is_some_and(char::is_lowercase) {
                self.file.crates.extend(crate_of(&names));
            }
        }
        visit::visit_path(self, path);
    }
}

pub fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Parses `src/`. Files of tests alone (`tests.rs`) are left out.
pub fn sources() -> BTreeMap<Names, SourceFile> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    rust_files(&root, &mut paths);
    paths.retain(|path| !path.ends_with("tests.rs"));
    let module_of = |path: &Path| -> Names {
        let relative = path.strip_prefix(&root).unwrap().with_extension("");
        let mut names: Names = relative.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if matches!(names.last().map(String::as_str), Some("mod" | "lib")) {
            names.pop();
        }
        names
    };
    let modules: BTreeSet<Names> = paths.iter().map(|path| module_of(path)).collect();
    let parse = |path: &PathBuf| {
        let module = module_of(path);
        let children = modules.iter().filter(|m| m.len() == module.len() + 1 && m.starts_with(&module));
        let children = children.filter_map(|m| m.last().cloned()).collect();
        let mut file = SourceFile {
            module: module.clone(),
            is_facade: path.ends_with("mod.rs") || path.ends_with("lib.rs"),
            imports: Vec::new(),
            crates: BTreeSet::new(),
            exports: HashMap::new(),
        };
        let text = fs::read_to_string(path).unwrap();
        let syntax = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Collector { file: &mut file, children: &children }.visit_file(&syntax);
        (module, file)
    };
    paths.iter().map(parse).collect()
}

/// Returns the module of the file that defines a path, following re-exports.
fn defining_file(files: &BTreeMap<Names, SourceFile>, path: &[String], depth: u32) -> Option<Names> {
    for end in (1..=path.len()).rev() {
        let Some(file) = files.get(&path[..end]) else { continue };
        if let Some(target) = path.get(end).and_then(|name| file.exports.get(name)).filter(|_| depth < 6) {
            return defining_file(files, &[target.as_slice(), &path[end + 1..]].concat(), depth + 1);
        }
        return Some(file.module.clone());
    }
    None
}

/// Returns the files that each file imports from.
pub fn edges(files: &BTreeMap<Names, SourceFile>) -> BTreeMap<Names, BTreeSet<Names>> {
    let targets = |file: &SourceFile| -> BTreeSet<Names> {
        let counted = file.imports.iter().filter(|(is_public, _)| !(*is_public && file.is_facade));
        let found = counted.filter_map(|(_, path)| defining_file(files, path, 0));
        found.filter(|target| *target != file.module && !target.is_empty()).collect()
    };
    files.iter().map(|(module, file)| (module.clone(), targets(file))).collect()
}
