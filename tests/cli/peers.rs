//! The studios of the comparison with other renderers.

use super::{catchlight, is_installed, stderr};
use std::path::Path;
use std::process::Command;

#[test]
fn the_studios_of_the_comparison_are_written_and_render() {
    if !is_installed("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/with_catchlight.py");
    // A mesh of 100 triangles a ball in place of 40 000
    let written = Command::new("python3").arg("-B").arg(script).arg(folder).arg("5").output().unwrap();
    assert!(written.status.success(), "{}", stderr(&written));
    let paths = String::from_utf8(written.stdout).unwrap();
    assert_eq!(paths.lines().count(), 4);
    for path in paths.lines() {
        let rendered = catchlight(folder, &["render", path, "--size", "16x12", "--spp", "1", "-o", "picture.exr"]);
        assert!(rendered.status.success(), "{path}: {}", stderr(&rendered));
        let luminances = super::exr_channel(&folder.join("picture.exr"), "G").unwrap();
        let mean = luminances.iter().sum::<f64>() / luminances.len() as f64;
        assert!((0.005..10.0).contains(&mean), "{path}: {mean}");
    }
}
