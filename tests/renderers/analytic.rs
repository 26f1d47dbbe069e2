//! Rendered pictures against closed forms of illuminance.

use crate::studio;
use crate::studio::measure::{film, film_with, luminance_per_value, meter_card, picture, square, values};
use crate::studio::{REFLECTANCE, card_at, light, looking_at_card};
use catchlight::photo::Picture;
use catchlight::raytrace::{Method, Settings};
use catchlight::scene::{Aim, Assets, Emitter, Light, Material, Object, Output, Room, Scene, Shape};
use glam::Vec3;
use std::f32::consts::PI;

/// Returns the illuminance of the card that fills the picture, lx, by inverting the exposure equation.
fn illuminance(scene: &Scene, method: Method, spp: u32) -> f32 {
    let settings = Settings { width: 8, height: 8, method, spp, ..Settings::default() };
    let picture = picture(scene, &settings);
    let mean = picture.rgb.iter().map(|p| p[1]).sum::<f32>() / picture.rgb.len() as f32;
    let camera = &scene.camera;
    mean * camera.meter_constant * camera.f_number * camera.f_number / (camera.iso * REFLECTANCE * camera.shutter_s)
}

/// Returns a small card at the origin that faces +Z, and one light in front that faces it.
fn lit_card(emitter: Emitter, distance_m: f32) -> Scene {
    let mut scene = card_at(Vec3::ZERO, 0.02);
    scene.lights.push(light(emitter, Output::Lumens(1000.0), Vec3::Z * distance_m));
    scene
}

#[test]
fn the_illuminance_on_the_axis_of_panels_matches_the_table() {
    // light_and_camera.md, 1000 lm. The error of 64 x 256 samples of a smooth integrand is well under 0.5 %; that of
    // the card's 2 cm is less than 0.1 % at half a metre.
    let small = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let large = Emitter::RectPanel { width_m: 0.9, height_m: 1.2 };
    let round = Emitter::RoundPanel { diameter_m: 1.2 };
    let table = [
        (small, [729.52, 267.05, 130.27, 75.89, 34.62, 12.63]),
        (large, [523.91, 232.79, 121.44, 72.80, 33.96, 12.54]),
        (round, [521.82, 234.05, 121.96, 73.01, 34.01, 12.55]),
    ];
    for (emitter, row) in table {
        for (distance, expected) in [0.5, 1.0, 1.5, 2.0, 3.0, 5.0].into_iter().zip(row) {
            let ours = illuminance(&lit_card(emitter, distance), Method::Direct, 256);
            assert!((ours / expected - 1.0).abs() < 0.005, "{emitter:?} at {distance} m: {ours} for {expected} lx");
        }
    }
}

#[test]
fn point_and_sphere_lights_follow_the_inverse_square_law() {
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.05 }] {
        for distance in [0.5_f32, 1.0, 2.0, 4.0, 8.0] {
            let expected = 1000.0 / (4.0 * PI) / (distance * distance);
            let ours = illuminance(&lit_card(emitter, distance), Method::Direct, 64);
            // The illuminance of a facing card by a sphere is that of a point light at its centre.
            assert!((ours / expected - 1.0).abs() < 0.003, "{emitter:?} at {distance} m: {ours} for {expected} lx");
        }
    }
}

#[test]
fn a_point_light_above_the_floor_follows_inverse_square_and_cosine_law() {
    // 10 000 lm, 3 m up: the five values of light_and_camera.md.
    for (r, expected) in [(0.0, 88.42), (1.0, 75.49), (2.0, 50.93), (3.0, 31.26), (4.0, 19.10)] {
        let mut scene = card_at(Vec3::new(r, 0.0, 0.0), 0.02);
        scene.objects[0].transform.rotation_deg = Vec3::ZERO;
        scene.camera = looking_at_card(Vec3::new(r, 0.0, 0.0), Vec3::Y);
        scene.lights.push(light(Emitter::Point, Output::Lumens(10_000.0), Vec3::Y * 3.0));
        let ours = illuminance(&scene, Method::Direct, 16);
        assert!((ours / expected - 1.0).abs() < 0.002, "{r} m: {ours} for {expected} lx");
    }
}

#[test]
fn spots_have_the_tabulated_intensity_on_their_axis() {
    for (full_deg, candela) in [(15.0, 18603.0), (30.0, 4671.0), (60.0, 1188.0), (90.0, 543.0), (120.0, 318.0)] {
        let emitter = Emitter::Spot { inner_deg: full_deg, outer_deg: full_deg };
        let ours = illuminance(&lit_card(emitter, 2.0), Method::Direct, 16);
        assert!((ours / (candela / 4.0) - 1.0).abs() < 0.003, "{full_deg} degrees: {ours} lx");
    }
}

#[test]
fn the_illuminance_of_the_sun_does_not_depend_on_its_angular_diameter() {
    for angular_diameter_deg in [0.0, 0.53, 10.0] {
        let mut scene = lit_card(Emitter::Sun { angular_diameter_deg }, 3.0);
        scene.lights[0].power.output = Output::Lux(5000.0);
        let ours = illuminance(&scene, Method::Direct, 64);
        assert!((ours / 5000.0 - 1.0).abs() < 0.003, "{angular_diameter_deg} degrees: {ours} lx");
    }
}

#[test]
fn the_illuminance_of_a_surround_is_its_lux() {
    let mut scene = lit_card(Emitter::Surround, 3.0);
    scene.lights[0].power.output = Output::Lux(2000.0);
    let ours = illuminance(&scene, Method::Path, 64);
    assert!((ours / 2000.0 - 1.0).abs() < 0.003, "{ours} lx");
}

#[test]
fn the_illuminance_in_a_closed_grey_box_is_the_geometric_series() {
    // E = F / (S (1 - r)) for a cube of 4 m with 10 000 lm: the mean over all walls, rendered by six cameras at the
    // centre.
    for (reflectance, expected) in [(0.2_f32, 130.21), (0.5, 208.33), (0.8, 520.83), (0.9, 1041.67)] {
        let ours = box_illuminance(reflectance);
        // Error of 6 x 256 pixels x 64 samples: under 1 %; Russian roulette adds to it at 0.9.
        assert!((ours / expected - 1.0).abs() < 0.015, "r = {reflectance}: {ours} for {expected} lx");
    }
}

fn box_illuminance(reflectance: f32) -> f32 {
    let paint = Material { base_color: [reflectance; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    let room = Room { size_m: Vec3::splat(4.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
    let mut scene = Scene { room: Some(room), ..Scene::default() };
    // Off centre, so that the camera is not at the light; the mean does not depend on the position.
    scene.lights.push(light(Emitter::Point, Output::Lumens(10_000.0), Vec3::new(0.3, 2.2, 0.1)));
    let centre = Vec3::new(0.0, 2.0, 0.0);
    let (mut sum, mut weights) = (0.0, 0.0);
    for direction in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        // A square sensor of 24 mm at 12 mm focal length covers 90 degrees: one wall fills the picture, and pixels are
        // equal areas of the wall.
        scene.camera = looking_at_card(centre + direction, direction);
        scene.camera.position = centre;
        scene.camera.aim = Aim::Point(centre + direction);
        scene.camera.focal_length_mm = 12.0;
        let settings = Settings { width: 16, height: 16, spp: 64, ..Settings::default() };
        let picture = picture(&scene, &settings);
        sum += picture.rgb.iter().map(|p| p[1]).sum::<f32>();
        weights += picture.rgb.len() as f32;
    }
    let camera = &scene.camera;
    let scale = camera.meter_constant * camera.f_number * camera.f_number / (camera.iso * camera.shutter_s);
    sum / weights * scale / reflectance
}

#[test]
fn a_white_sphere_is_invisible_in_a_white_furnace() {
    // White, rough or smooth, metal or glass, in a uniform surround: every pixel has the same value.
    for (metallic, roughness, transmission) in [
        (0.0, 1.0, 0.0),
        (0.0, 0.2, 0.0),
        (1.0, 0.0, 0.0),
        (1.0, 0.35, 0.0),
        (1.0, 0.5, 0.0),
        (1.0, 1.0, 0.0),
        (0.0, 0.0, 1.0),
    ] {
        let white = Material { base_color: [0.999; 3], metallic, roughness, transmission, ..Material::default() };
        let mut scene = studio::ball_in_even_light(white);
        scene.camera.f_number = 4.0;
        let settings = Settings { width: 16, height: 16, spp: 256, max_depth: Some(64), ..Settings::default() };
        let picture = picture(&scene, &settings);
        // The corner shows the surround.
        let surround = picture.at(0, 0)[1];
        let mut mean = Vec3::ZERO;
        for pixel in &picture.rgb {
            // The standard deviation of rough metal is about 0.3 a sample, 0.02 after 256; the worst of 256 pixels is
            // at 3 sigma.
            let relative = Vec3::from(*pixel) / surround;
            assert!(
                (relative - Vec3::ONE).abs().max_element() < 0.06,
                "metallic {metallic}, roughness {roughness}, transmission {transmission}: {relative}"
            );
            mean += relative / picture.rgb.len() as f32;
        }
        // The error of the mean of 65536 samples is 0.1 %, and the base colour is 0.1 % under white.
        assert!(
            (mean - Vec3::ONE).abs().max_element() < 0.004,
            "metallic {metallic}, roughness {roughness}, transmission {transmission}: {mean}"
        );
    }
}

#[test]
fn a_white_metal_plane_gives_back_all_light_where_a_coarse_albedo_table_was_off_by_a_percent() {
    // Roughness and angle of the view: 1.0139, 1.0129, 0.983 and 0.983 with a table of 16 x 16 facets an angle.
    let named = [(0.45, 0.0), (0.5, 60.0), (0.35, 0.0), (0.4, 0.0)];
    let others = [(0.05, 70.0), (0.2, 45.0), (0.3, 30.0), (0.6, 75.0), (0.8, 0.0), (1.0, 60.0)];
    let tests = named.len() + others.len();
    for (roughness, angle_deg) in named.into_iter().chain(others) {
        let (sin, cos) = f32::to_radians(angle_deg).sin_cos();
        let mut scene = meter_card(Vec3::ZERO, Vec3::Y);
        scene.objects[0].material =
            Material { base_color: [0.999; 3], metallic: 1.0, roughness, ..Material::default() };
        scene.camera.position = Vec3::new(0.08 * sin, 0.08 * cos, 0.0);
        let surround = light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO);
        scene.lights.push(surround);
        let reading = values(&picture(&scene, &square(Method::Path, 32, 64)));
        let white = luminance_per_value(&scene.camera) / (1000.0 / std::f64::consts::PI);
        let albedo = reading.scaled(white);
        assert!(albedo.standard_error < 2e-3, "{albedo:?}");
        // The whitest base colour is 0.999; light between facets meets it twice.
        assert!(albedo.agrees_with(0.999, 6e-4, tests), "roughness {roughness} under {angle_deg} degrees: {albedo:?}");
    }
}

#[test]
fn one_stop_less_power_halves_the_illuminance() {
    let scene = lit_card(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, 1.0);
    let mut darker = scene.clone();
    darker.lights[0].power.dial_stops = -1.0;
    let ratio = illuminance(&scene, Method::Direct, 64) / illuminance(&darker, Method::Direct, 64);
    assert!((ratio.log2() - 1.0).abs() < 1e-6, "{ratio}");
}

#[test]
fn the_shutter_time_changes_continuous_light_and_not_flash() {
    let mut scene = lit_card(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, 1.0);
    scene.lights[0].power.output = Output::FlashWs { energy_ws: 100.0, efficacy_lm_s_per_ws: 40.0 };
    let settings = Settings { width: 16, height: 16, spp: 4, ..Settings::default() };
    let fast = picture(&scene, &settings);
    scene.camera.shutter_s *= 2.0;
    assert_eq!(fast, picture(&scene, &settings));
    scene.lights[0].power.output = Output::Lumens(1000.0);
    let continuous = picture(&scene, &settings);
    scene.camera.shutter_s *= 2.0;
    let doubled = picture(&scene, &settings);
    for (a, b) in continuous.rgb.iter().zip(&doubled.rgb) {
        assert!((b[1] / a[1] - 2.0).abs() < 1e-5);
    }
}

#[test]
fn relighting_a_film_equals_rendering_again() {
    let mut scene = lit_card(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, 1.0);
    let fill = Light { name: "Fill".into(), id: catchlight::scene::LightId(1), ..scene.lights[0].clone() };
    scene.lights.push(Light { position: Vec3::new(1.0, 0.5, 1.0), ..fill });
    let settings = Settings { width: 8, height: 8, spp: 64, ..Settings::default() };
    let film = film(&scene, &settings);
    let combined = film.develop(&scene);
    let layers = film.develop_layers(&scene);
    for (i, pixel) in combined.rgb.iter().enumerate() {
        let sum: Vec3 = layers.iter().map(|(_, p)| Vec3::from(p.rgb[i])).sum();
        assert!((sum - Vec3::from(*pixel)).length() < 1e-5 * sum.length());
    }
    scene.lights[0].power.dial_stops = -2.0;
    scene.lights[1].on = false;
    scene.lights[0].color.source = catchlight::scene::ColorSource::Kelvin(3200.0);
    let relit = film.develop(&scene);
    let rendered = picture(&scene, &settings);
    let mean = |p: &Picture| p.rgb.iter().map(|c| Vec3::from(*c)).sum::<Vec3>() / p.rgb.len() as f32;
    // Light sampling differs, and so does the noise; 4096 samples of a smooth integrand agree within 0.5 %.
    assert!((mean(&relit) / mean(&rendered) - Vec3::ONE).abs().max_element() < 0.005);
}

#[test]
fn hidden_objects_cast_no_shadow_and_visible_ones_do() {
    let mut scene = lit_card(Emitter::Point, 2.0);
    let shape = Shape::Box { size_m: Vec3::new(0.5, 0.5, 0.02) };
    let mut screen: Object = studio::object("Screen", shape, Vec3::Z * 1.5);
    screen.visible = false;
    scene.objects.push(screen);
    assert!(illuminance(&scene, Method::Direct, 4) > 10.0);
    scene.objects[1].visible = true;
    assert_eq!(illuminance(&scene, Method::Direct, 4), 0.0);
}

#[test]
fn a_texture_is_upright_on_a_card() {
    use catchlight::scene::{Texture, TextureRef};
    // A card that faces +Z, with a texture of four quarters: red and green above blue and white.
    let mut scene = card_at(Vec3::ZERO, 0.02);
    scene.objects[0].material.base_color = [0.9; 3];
    scene.objects[0].material.textures.base_color = Some(TextureRef::file("quarters.png"));
    scene.camera.position = Vec3::Z * 0.25;
    scene.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::new(0.0, 0.3, 1.0)));
    let rgb = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
    let mut assets = Assets::default();
    assets.insert_texture(TextureRef::file("quarters.png"), std::sync::Arc::new(Texture::opaque(2, 2, rgb)));
    let settings = Settings { width: 8, height: 8, method: Method::Direct, spp: 4, ..Settings::default() };
    let picture = film_with(&scene, &assets, &settings).develop(&scene);
    let strongest = |x, y| {
        let p = picture.at(x, y);
        (0..3).filter(|&c| p[c] > 0.5 * p[0].max(p[1]).max(p[2])).collect::<Vec<_>>()
    };
    // The plane is rotated about X to face the camera: the top of the texture, its -Z edge, is up.
    assert_eq!(strongest(2, 2), [0]);
    assert_eq!(strongest(5, 2), [1]);
    assert_eq!(strongest(2, 5), [2]);
    assert_eq!(strongest(5, 5), [0, 1, 2]);
}

#[test]
fn many_lights_sum_to_one_and_no_light_is_black() {
    // One light has its own layer; twenty share layers by role, and one is sampled at each hit.
    let alone = lit_card(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, 1.0);
    let mut many = alone.clone();
    many.lights.clear();
    for i in 0..20 {
        let mut light = alone.lights[0].clone();
        light.id = catchlight::scene::LightId(i);
        light.name = format!("Light {i}");
        light.role = catchlight::scene::Role::ALL[i as usize % 6];
        light.power.output = Output::Lumens(1000.0 / 20.0);
        many.lights.push(light);
    }
    for method in [Method::Direct, Method::Path] {
        let ratio = illuminance(&many, method, 4096) / illuminance(&alone, method, 4096);
        // 262144 samples with a standard deviation of a quarter: 0.05 % standard error.
        assert!((ratio - 1.0).abs() < 0.0015, "{method:?}: {ratio}");
    }
    for scene in [Scene { lights: Vec::new(), ..alone.clone() }, {
        let mut off = alone.clone();
        off.lights[0].on = false;
        off
    }] {
        assert_eq!(illuminance(&scene, Method::Path, 4), 0.0);
    }
}

#[test]
fn an_emissive_wall_lights_a_card_like_a_panel_of_its_luminance() {
    // A wall of 4 x 4 m at 1 m with 100 cd/m2, by Lambert's formula for a rectangle on its axis.
    let mut scene = card_at(Vec3::ZERO, 0.02);
    let mut wall = studio::object("Wall", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::Z);
    wall.transform.rotation_deg = Vec3::X * -90.0;
    wall.material.emission_cd_m2 = [100.0; 3];
    wall.material.base_color = [0.0; 3];
    scene.objects.push(wall);
    // E = 4 L / 2 x 2 a / sqrt(1 + a2) atan(a / sqrt(1 + a2)) for half sides of a = 2 times the distance.
    let a = 2.0_f32;
    let side = a / (1.0 + a * a).sqrt();
    let expected = 4.0 * 100.0 * side * side.atan();
    for method in [Method::Direct, Method::Path] {
        let ours = illuminance(&scene, method, 1024);
        // BSDF sampling only: 65536 samples have a standard error of 0.4 %.
        assert!((ours / expected - 1.0).abs() < 0.015, "{method:?}: {ours} for {expected} lx");
    }
}
