//! Light under soft surfaces against the path tracer.

use super::*;
use catchlight::scene::Subsurface;

/// Returns the face of a figure under a hard light from the side, framed so that a pixel is about a millimetre, and the
/// sizes of its picture. Skin is `soft` or hard.
fn face(is_soft: bool) -> (catchlight::io::Loaded, (u32, u32)) {
    let mut loaded = catchlight::io::find_preset("split").unwrap().load().unwrap();
    let man = &mut loaded.scene.objects[0];
    man.material.subsurface = is_soft.then_some(Subsurface { mean_free_path_mm: [2.6, 2.0, 1.6] });
    man.material.roughness = 0.7;
    loaded.scene.camera.focal_length_mm = 400.0;
    loaded.scene.lights[0].emitter = Emitter::RectPanel { width_m: 0.1, height_m: 0.1 };
    (loaded, (80, 120))
}

fn preview_and_traced(renderer: &mut PreviewRenderer, is_soft: bool) -> [Picture; 2] {
    let (loaded, (width, height)) = face(is_soft);
    let input = PreviewInput {
        options: Options::direct_only(),
        ..PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height))
    };
    let ours = renderer.linear_picture(&input).unwrap();
    let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
    let settings = raytrace::Settings {
        width,
        height,
        spp: 64,
        method: raytrace::Method::Direct,
        ..raytrace::Settings::default()
    };
    let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    [ours, film.develop(&loaded.scene)]
}

/// Returns median and 90th percentile of the differences of red light in stops, where the tracer sees enough of it.
fn red_errors(ours: &Picture, traced: &Picture) -> (f32, f32) {
    let pairs = ours.rgb.iter().zip(&traced.rgb).filter(|(_, traced)| traced[0] > 0.02);
    let mut errors: Vec<f32> = pairs.map(|(ours, traced)| (ours[0].max(1e-4) / traced[0]).log2().abs()).collect();
    errors.sort_by(f32::total_cmp);
    (errors[errors.len() / 2], errors[errors.len() * 9 / 10])
}

#[test]
fn light_under_the_skin_of_a_face_agrees_with_the_tracer() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let [soft, traced] = preview_and_traced(&mut renderer, true);
    let [hard, _] = preview_and_traced(&mut renderer, false);
    let (median, tenth_worst) = red_errors(&soft, &traced);
    let (hard_median, hard_tenth_worst) = red_errors(&hard, &traced);
    println!("soft: median {median:.3} stops, 90 % within {tenth_worst:.3}");
    println!("hard: median {hard_median:.3} stops, 90 % within {hard_tenth_worst:.3}");
    // The worst pixels are dark: light through thin parts, which no pixel beside them shows, is missing.
    assert!(median < 0.15 && tenth_worst < 0.9, "{median} and {tenth_worst} stops");
    assert!(tenth_worst < 0.4 * hard_tenth_worst, "a hard surface is as near: {hard_tenth_worst}");
    // Blue light goes less far: shadow edges are warm.
    let redness = |picture: &Picture| {
        let edge = picture.rgb.iter().filter(|pixel| (0.02..0.1).contains(&pixel[0]));
        let sum = edge.fold([0.0; 2], |sum, pixel| [sum[0] + pixel[0], sum[1] + pixel[2]]);
        sum[0] / sum[1]
    };
    println!("red to blue at the edge: {} traced {} hard {}", redness(&soft), redness(&traced), redness(&hard));
    assert!(redness(&soft) > 1.2 * redness(&hard));
}
