//! README's table of faults names tests that exist.

use super::sources::rust_files;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

#[test]
fn the_tests_that_the_table_of_faults_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let table = readme.split("## When something goes wrong").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with('|')).skip(2).collect();
    assert!(rows.len() > 10, "{rows:?}");
    let mut paths = Vec::new();
    rust_files(&root.join("tests"), &mut paths);
    rust_files(&root.join("src"), &mut paths);
    let text: String = paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let tests: BTreeSet<&str> =
        text.split("#[test]").skip(1).filter_map(|test| test.split("fn ").nth(1)?.split("()").next()).collect();
    for row in rows {
        let named: Vec<&str> = row.rsplit(" | ").next().unwrap().split('`').skip(1).step_by(2).collect();
        assert!(!named.is_empty(), "no test: {row}");
        named.into_iter().for_each(|name| assert!(tests.contains(name), "there is no test {name}"));
    }
}
