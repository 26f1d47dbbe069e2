//! Saving: loads back the same scene, and never destroys the older file.

use super::SMALL;
use catchlight::io::{SaveError, load_scene, parse_scene, presets, save_scene};

#[test]
fn saving_and_loading_gives_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("studio.ron");
    for preset in presets() {
        let (scene, _) = parse_scene(preset.text).unwrap();
        save_scene(&scene, &path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), preset.text);
        assert_eq!(load_scene(&path).unwrap().scene, scene);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside the file");
}

#[test]
fn a_scene_with_errors_is_not_saved_and_the_older_file_is_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("studio.ron");
    let (mut scene, _) = parse_scene(SMALL).unwrap();
    save_scene(&scene, &path).unwrap();
    let before = std::fs::read(&path).unwrap();
    scene.camera.iso = f32::NAN;
    let error = save_scene(&scene, &path).unwrap_err();
    assert!(matches!(error, SaveError::Invalid(_)) && error.to_string().contains("camera.iso"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

#[test]
fn saving_into_a_missing_folder_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, _) = parse_scene(SMALL).unwrap();
    let error = save_scene(&scene, &folder.path().join("none/studio.ron")).unwrap_err();
    assert!(matches!(error, SaveError::NoFolder(_)), "{error}");
}
