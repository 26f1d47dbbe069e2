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

#[test]
fn the_sun_of_a_map_casts_its_shadow_and_the_floor_is_as_bright_as_the_tracer_says_in_and_beside_it() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    // A sky with a sun of one pixel, 45 degrees up and to the right, which gives most of the light
    let mut pixels = vec![[1.0, 1.0, 1.2]; 512 * 256];
    pixels[64 * 512 + 384] = [40_000.0, 36_000.0, 30_000.0];
    let mut assets = Assets::default();
    assets.insert_environment("sky.hdr", Arc::new(EnvironmentMap::new(512, 256, pixels).unwrap()));
    let light = Light { id: LightId(1), ..Light::new(Emitter::Surround, Output::Lux(40_000.0)) };
    let light = Light { environment_map: Some("sky.hdr".to_owned()), ..light };
    let matte = |level: f32| Material { base_color: [level; 3], roughness: 1.0, ior: 1.0, ..Material::default() };
    let thing = |id: u32, size_m: Vec3, at: Vec3, level: f32| Object {
        id: ObjectId(id),
        transform: Transform::at(at),
        material: matte(level),
        ..Object::new(format!("Box {id}"), Shape::Box { size_m })
    };
    // A small black slab high over the floor hides little of the sky, and its shadow lies 3 m to the left
    let objects = vec![
        thing(1, Vec3::new(40.0, 0.1, 40.0), Vec3::NEG_Y * 0.05, 0.5),
        thing(2, Vec3::new(1.0, 0.02, 1.0), Vec3::Y * 3.0, 0.0),
    ];
    let camera =
        Camera { position: Vec3::new(-2.0, 2.5, 4.0), aim: Aim::Point(Vec3::new(-2.0, 0.0, 0.0)), ..Camera::default() };
    let camera = Camera { focal_length_mm: 35.0, shutter_s: 1.0 / 500.0, ..camera };
    let scene = Scene { camera, objects, lights: vec![light], ..Scene::default() };
    let (width, height) = (48, 32);
    let drawn = renderer.linear_picture(&PreviewInput::camera_view(&scene, &assets, (width, height))).unwrap();
    let prepared = raytrace::prepare(&scene, &assets).unwrap();
    let settings = raytrace::Settings { width, height, spp: 64, ..Default::default() };
    let film = raytrace::render(&prepared, &settings, &raytrace::RenderControl::new(), &mut |_| {
        std::ops::ControlFlow::Continue(())
    });
    let traced = film.develop(&scene);
    let mean = |picture: &Picture, column: u32| {
        let block = (14..17).flat_map(|row| (column..column + 3).map(move |at| (row * width + at) as usize));
        block.map(|index| picture.rgb[index][1]).sum::<f32>() / 9.0
    };
    // The middle of the shadow, and the same row on the other side of the picture
    let stops = [12, 40].map(|column| (mean(&drawn, column) / mean(&traced, column)).log2());
    let contrast = (mean(&traced, 40) / mean(&traced, 12)).log2();
    println!("{stops:?} stops, contrast {contrast}");
    assert!(contrast > 0.8 && stops.iter().all(|stops| stops.abs() < 0.15), "{stops:?} of {contrast}");
}
