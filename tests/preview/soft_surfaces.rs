//! Light under soft surfaces against the path tracer.

use super::*;
use catchlight::scene::Subsurface;

/// Where light that spreads under the skin changes the picture by more, the two are compared, stops.
const SPREAD_STOPS: f32 = 0.3;

/// Returns the face of a figure under a hard light from the side, framed so that a pixel is about a millimetre, and the
/// sizes of its picture. Skin is `soft` or hard.
fn face(is_soft: bool) -> (Loaded, (u32, u32)) {
    let mut loaded = hairless(shipped("split"));
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

/// Returns the differences of red light in stops, sorted, at `pixels` where the tracer sees enough of it.
fn red_errors(ours: &Picture, traced: &Picture, pixels: impl Fn(usize) -> bool) -> Vec<f32> {
    let stops = |i: usize| (ours.rgb[i][0].max(1e-4) / traced.rgb[i][0]).log2().abs();
    let compared = (0..ours.rgb.len()).filter(|&i| traced.rgb[i][0] > 0.02 && pixels(i));
    let mut errors: Vec<f32> = compared.map(stops).collect();
    errors.sort_by(f32::total_cmp);
    errors
}

#[test]
fn light_under_the_skin_of_a_face_agrees_with_the_tracer() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let [soft, traced] = preview_and_traced(&mut renderer, true);
    let [hard, _] = preview_and_traced(&mut renderer, false);
    let everywhere = red_errors(&soft, &traced, |_| true);
    let (median, tenth_worst) = (everywhere[everywhere.len() / 2], everywhere[everywhere.len() * 9 / 10]);
    println!("median {median:.3} stops, 90 % within {tenth_worst:.3}");
    assert!(median < 0.15 && tenth_worst < 0.9, "{median} and {tenth_worst} stops");
    // Where spreading matters: at the edges of shadows
    let at_edges = |i: usize| (soft.rgb[i][0].max(1e-4) / hard.rgb[i][0].max(1e-4)).log2().abs() > SPREAD_STOPS;
    let [soft_errors, hard_errors] = [&soft, &hard].map(|picture| red_errors(picture, &traced, at_edges));
    let middle = soft_errors.len() / 2;
    let (soft_median, hard_median) = (soft_errors[middle], hard_errors[middle]);
    println!("{} pixels at edges: soft {soft_median:.3} stops, hard {hard_median:.3}", soft_errors.len());
    assert!(soft_errors.len() > 80 && soft_median < 0.65 * hard_median, "{soft_median} and hard {hard_median} stops");
    // Blue light goes less far: shadow edges are warm
    let redness = |picture: &Picture| {
        let edge = (0..picture.rgb.len()).filter(|&i| at_edges(i)).map(|i| picture.rgb[i]);
        let sum = edge.fold([0.0; 2], |sum, pixel| [sum[0] + pixel[0], sum[1] + pixel[2]]);
        sum[0] / sum[1]
    };
    let [soft, hard, traced] = [&soft, &hard, &traced].map(redness);
    println!("red to blue at the edge: {soft} traced {traced} hard {hard}");
    assert!(soft > 1.15 * hard && traced > 1.15 * hard, "{soft} traced {traced} hard {hard}");
}
