//! `catchlight import`: a studio of a model.

use super::{catchlight, stderr};

/// Four faces of a pyramid 30 cm high.
const PYRAMID: &str = "v -0.1 0 -0.1\nv 0.1 0 -0.1\nv 0.1 0 0.1\nv -0.1 0 0.1\nv 0 0.3 0\n\
                       f 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\nf 1 2 3 4\n";

#[test]
fn a_model_becomes_a_studio_that_can_be_rendered_and_moved_to_another_folder() {
    let folder = tempfile::tempdir().unwrap();
    let (models, studios) = (folder.path().join("models"), folder.path().join("studios"));
    [&models, &studios].into_iter().for_each(|place| std::fs::create_dir(place).unwrap());
    std::fs::write(models.join("pyramid.obj"), PYRAMID).unwrap();
    let output = catchlight(folder.path(), &["import", "models/pyramid.obj", "-o", "studios/pyramid.ron"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    std::fs::remove_dir_all(&models).unwrap();

    let output = catchlight(&studios, &["check", "pyramid.ron"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = catchlight(
        &studios,
        &["render", "pyramid.ron", "-o", "pyramid.png", "--spp", "4", "--size", "48x32", "--denoise", "off"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let picture = image::open(studios.join("pyramid.png")).unwrap().to_luma8();
    let mean = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
        let (width, height) = (x.end - x.start, y.end - y.start);
        let sum: u32 =
            y.flat_map(|y| x.clone().map(move |x| (x, y))).map(|(x, y)| u32::from(picture.get_pixel(x, y)[0])).sum();
        sum / (width * height)
    };
    let (model, backdrop) = (mean(20..28, 12..20), mean(0..6, 12..20));
    assert!(model > 30 && model.abs_diff(backdrop) > 5, "the model is {model}, the backdrop {backdrop}");
}

#[test]
fn what_is_no_model_and_what_is_no_studio_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pyramid.obj"), PYRAMID).unwrap();
    std::fs::write(folder.path().join("broken.glb"), b"glTF").unwrap();
    for (model, output, complaint) in [
        ("pyramid.obj", "pyramid.txt", "a studio is a .ron file"),
        ("broken.glb", "broken.ron", "can't import the model"),
        ("none.obj", "none.ron", "can't import the model"),
    ] {
        let run = catchlight(folder.path(), &["import", model, "-o", output]);
        assert_eq!(run.status.code(), Some(1), "{}", stderr(&run));
        assert!(stderr(&run).contains(complaint), "{}", stderr(&run));
        assert!(!folder.path().join(output).exists());
    }
}
