//! Environment maps in the preview: the mean of their light, and their directions in reflections.

use super::*;
use catchlight::scene::EnvironmentMap;

/// Returns a ball of a material in the light of a map of 32 x 16 pixels.
fn ball(material: Material, pixel: impl Fn(u32) -> [f32; 3]) -> (Scene, Assets) {
    let pixels = (0..512).map(|index| pixel(index % 32)).collect();
    let mut assets = Assets::default();
    assets.insert_environment("sky.hdr", Arc::new(EnvironmentMap::new(32, 16, pixels).unwrap()));
    let light = Light { id: LightId(1), ..Light::new(Emitter::Surround, Output::Lux(2000.0)) };
    let light = Light { environment_map: Some("sky.hdr".to_owned()), ..light };
    let ball = Object { material, ..Object::new("Ball", Shape::Sphere { radius_m: 0.6 }) };
    let camera = Camera { position: Vec3::Z * 3.0, aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
    (Scene { camera, objects: vec![ball], lights: vec![light], ..Scene::default() }, assets)
}

fn picture(renderer: &mut PreviewRenderer, scene: &Scene, assets: &Assets) -> Picture {
    renderer.linear_picture(&PreviewInput::camera_view(scene, assets, (32, 24))).unwrap()
}

#[test]
fn an_even_map_is_drawn_as_the_surround_that_it_is_and_mirrors_show_its_sides() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let (mut scene, assets) = ball(Material { roughness: 0.5, ..Material::default() }, |_| [2.0; 3]);
    let mapped = picture(&mut renderer, &scene, &assets);
    scene.lights[0].environment_map = None;
    let even = picture(&mut renderer, &scene, &assets);
    let difference = mapped.rgb.iter().flatten().zip(even.rgb.iter().flatten()).map(|(a, b)| (a - b).abs());
    let largest = difference.fold(0.0, f32::max);
    assert!(largest < 0.01 && even.rgb[12 * 32 + 16][1] > 0.02, "{largest}");
    // Red from the right, blue from the left: a mirror ball shows it so
    let chrome = Material { metallic: 1.0, roughness: 0.05, base_color: [0.9; 3], ..Material::default() };
    let (scene, assets) = ball(chrome, |x| if x >= 16 { [1.0, 0.1, 0.1] } else { [0.1, 0.1, 1.0] });
    let mirrored = picture(&mut renderer, &scene, &assets);
    // Where the normals are 45 degrees aside
    let (left, right) = (mirrored.rgb[12 * 32 + 4], mirrored.rgb[12 * 32 + 27]);
    assert!(right[0] > 1.2 * right[2] && left[2] > 1.2 * left[0], "left {left:?}, right {right:?}");
}
