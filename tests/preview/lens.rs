//! The lens of the camera: ND filter and focus breathing.

use super::*;
use catchlight::scene::{Focus, Sensor};

#[test]
fn an_nd_filter_and_near_focus_show_as_in_the_tracer() {
    let Some(mut renderer) = shared_renderer() else { return };
    // A glowing card of 12 mm before a lens of 100 mm: at 1:1 it fills a quarter of the 24 mm sensor, two stops darker.
    let glow = Material { base_color: [0.0; 3], ior: 1.0, emission_cd_m2: [100.0; 3], ..Material::default() };
    let card = object(0, Shape::Box { size_m: Vec3::splat(0.012) }, Vec3::Z * -0.006, glow);
    let camera = Camera {
        position: Vec3::Z * 0.2,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 100.0,
        focus: Focus::Distance(0.2),
        ..Camera::default()
    };
    let mut scene = Scene { camera, objects: vec![card], ..Scene::default() };
    let mut shown = |scene: &Scene| {
        let picture = renderer.linear_picture(&direct(scene, (128, 128))).unwrap();
        let value = picture.at(64, 64)[1];
        let covered: f32 = picture.rgb.iter().map(|p| p[1] / value).sum();
        (value, covered.sqrt() / 128.0 * 24e-3 / 0.012)
    };
    let (plain, magnification) = shown(&scene);
    // An edge is exact to half a pixel of 64.
    assert!((magnification - 0.5).abs() < 0.01, "{magnification} without breathing");
    (scene.camera.focus_breathing, scene.camera.nd_stops) = (true, 3.0);
    let (filtered, magnification) = shown(&scene);
    assert!((magnification - 1.0).abs() < 0.01, "{magnification} with breathing");
    // Pictures of the preview are half floats: eleven bits.
    assert!(((plain / filtered).log2() - 5.0).abs() < 2e-3, "{plain} and {filtered}");
}
