//! Lacquer and translucent sheets against the path tracer.

use super::*;
use catchlight::scene::Clearcoat;

/// A large sheet of a material that faces the camera, with a panel before it and one behind it.
fn sheet(material: Material, front: bool) -> Scene {
    let mut sheet = Object { material, ..Object::new("Sheet", Shape::Plane { width_m: 2.0, depth_m: 2.0 }) };
    sheet.transform = Transform { rotation_deg: Vec3::X * 90.0, ..Transform::at(Vec3::Y) };
    let side = if front { 1.0 } else { -1.0 };
    let panel = Light {
        id: LightId(2),
        position: Vec3::new(0.3, 1.6, 1.2 * side),
        aim: Aim::Point(Vec3::Y),
        ..Light::new(Emitter::RectPanel { width_m: 0.5, height_m: 0.5 }, Output::Lumens(4000.0))
    };
    let camera = Camera { position: Vec3::new(0.0, 1.0, 3.0), aim: Aim::Point(Vec3::Y), ..Camera::default() };
    Scene { camera, objects: vec![sheet], lights: vec![panel], ..Scene::default() }
}

/// Returns the mean of our picture over that of the tracer, and the 90th percentile of their differences in stops.
fn compare(renderer: &mut PreviewRenderer, scene: &Scene) -> (f32, f32) {
    let (assets, size) = (Assets::default(), (32, 24));
    let input = PreviewInput { options: Options::direct_only(), ..PreviewInput::camera_view(scene, &assets, size) };
    let ours = renderer.linear_picture(&input).unwrap();
    let prepared = raytrace::prepare(scene, &assets).unwrap();
    let settings = raytrace::Settings {
        width: size.0,
        height: size.1,
        spp: 32,
        method: raytrace::Method::Direct,
        ..raytrace::Settings::default()
    };
    let control = raytrace::RenderControl::new();
    let traced = raytrace::render(&prepared, &settings, &control, &mut |_| std::ops::ControlFlow::Continue(()));
    let traced = traced.develop(scene);
    let mean = |picture: &Picture| picture.rgb.iter().map(|pixel| pixel[1]).sum::<f32>();
    let lit = (0..ours.rgb.len()).filter(|&i| traced.rgb[i][1] > 0.01);
    let mut errors: Vec<f32> = lit.map(|i| (ours.rgb[i][1].max(1e-4) / traced.rgb[i][1]).log2().abs()).collect();
    errors.sort_by(f32::total_cmp);
    assert!(errors.len() > 200, "{} pixels are lit", errors.len());
    (mean(&ours) / mean(&traced), errors[errors.len() * 9 / 10])
}

#[test]
fn lacquer_and_light_through_sheets_agree_with_the_tracer() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let paint = Material { base_color: [0.5; 3], roughness: 0.9, ..Material::default() };
    let lacquer = Some(Clearcoat { amount: 1.0, roughness: 0.3 });
    let scrim = Material { base_color: [0.9; 3], translucency: 0.5, ior: 1.0, roughness: 1.0, ..Material::default() };
    for (name, material, front) in [
        ("lacquer", Material { clearcoat: lacquer, ..paint }, true),
        ("scrim from the front", scrim.clone(), true),
        ("scrim from behind", scrim, false),
    ] {
        let (mean, worst) = compare(&mut renderer, &sheet(material, front));
        println!("{name}: mean {mean:.3}, 90 % of pixels within {worst:.3} stops");
        assert!((mean - 1.0).abs() < 0.06 && worst < 0.2, "{name}: mean {mean}, {worst} stops");
    }
}
