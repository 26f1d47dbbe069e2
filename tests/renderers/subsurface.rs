//! Rendered pictures of soft materials: energy, scale, and light behind the terminator.

use crate::studio::measure::{picture, square, values};
use crate::studio::{ball_in_even_light, light, looking_at_card, object};
use catchlight::photo::Picture;
use catchlight::raytrace::{Method, Settings};
use catchlight::scene::{Aim, Camera, Emitter, Material, Output, Scene, Sensor, Shape, Subsurface};
use glam::Vec3;

/// Returns a material without a coat.
fn soft(base_color: [f32; 3], mean_free_path_mm: [f32; 3]) -> Material {
    let subsurface = Some(Subsurface { mean_free_path_mm });
    Material { base_color, ior: 1.0, roughness: 0.5, subsurface, ..Material::default() }
}

#[test]
fn a_white_soft_ball_vanishes_in_a_white_furnace() {
    // With a coat and without, large and small against the mean free path. 0.999 is the largest base colour.
    for (ior, mean_free_path_mm) in [(1.0, 50.0), (1.4, 5.0), (1.4, 500.0)] {
        let scene = ball_in_even_light(Material { ior, ..soft([0.999; 3], [mean_free_path_mm; 3]) });
        let picture = picture(&scene, &square(Method::Path, 16, 64));
        let mean = values(&picture);
        let surround = f64::from(picture.rgb[0][1]);
        assert!(mean.agrees_with(surround, 0.002, 3), "{mean:?} for {surround}");
        assert!(mean.standard_error < 0.002 * surround);
    }
}

/// Returns the picture of a thick block in even light.
fn thick_block(material: Material, method: Method) -> Picture {
    let mut block = object("Block", Shape::Box { size_m: Vec3::new(1.0, 1.0, 1.0) }, Vec3::new(0.0, -0.5, 0.0));
    block.material = material;
    let surround = light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO);
    let camera = looking_at_card(Vec3::ZERO, Vec3::Y);
    picture(
        &Scene { objects: vec![block], lights: vec![surround], camera, ..Scene::default() },
        &square(method, 16, 128),
    )
}

#[test]
fn a_thick_soft_block_has_the_reflectance_of_a_hard_one_of_its_colour() {
    for base_color in [[0.2, 0.5, 0.8], [0.95, 0.35, 0.65], [0.15, 0.08, 0.05]] {
        for ior in [1.0, 1.4] {
            for method in [Method::Direct, Method::Path] {
                let soft = Material { ior, ..soft(base_color, [1.3, 0.9, 0.6]) };
                let hard = thick_block(Material { subsurface: None, ..soft.clone() }, method);
                let soft = thick_block(soft, method);
                for channel in 0..3 {
                    let mean = |picture: &Picture| {
                        picture.rgb.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>()
                            / picture.rgb.len() as f64
                    };
                    let ratio = mean(&soft) / mean(&hard);
                    // 128 x 256 walks: a standard error of 0.3 % where channels have different paths.
                    assert!((ratio - 1.0).abs() < 0.01, "{ratio} for {base_color:?}[{channel}], {method:?}, ior {ior}");
                }
            }
        }
    }
}

/// Returns a picture of a ball of soft material lit from the right, that it fills from top to bottom.
fn ball_lit_from_the_side(radius_m: f32, mean_free_path_mm: [f32; 3]) -> Picture {
    let mut ball = object("Ball", Shape::Sphere { radius_m }, Vec3::ZERO);
    ball.material = soft([0.62, 0.43, 0.34], mean_free_path_mm);
    let mut sun = light(Emitter::Sun { angular_diameter_deg: 0.0 }, Output::Lux(10_000.0), Vec3::X);
    sun.aim = Aim::Point(Vec3::ZERO);
    let camera = Camera {
        position: Vec3::Z * (40.0 * radius_m),
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 480.0,
        ..Camera::default()
    };
    let settings = Settings { width: 20, height: 20, spp: 64, ..Settings::default() };
    picture(&Scene { objects: vec![ball], lights: vec![sun], camera, ..Scene::default() }, &settings)
}

/// Returns the mean of a channel over the middle rows of a column.
fn column(picture: &Picture, x: usize, channel: usize) -> f32 {
    (7..13).map(|y| picture.rgb[y * 20 + x][channel]).sum::<f32>() / 6.0
}

#[test]
fn the_mean_free_path_scales_with_the_object() {
    let small = ball_lit_from_the_side(0.005, [1.3, 1.0, 0.8]);
    let large = ball_lit_from_the_side(0.5, [130.0, 100.0, 80.0]);
    for x in 2..18 {
        for channel in 0..3 {
            let (a, b) = (column(&small, x, channel), column(&large, x, channel));
            assert!((a - b).abs() < 0.02 * column(&small, 15, channel), "column {x}: {a} and {b}");
        }
    }
}

#[test]
fn light_comes_round_the_terminator_of_a_small_ball_and_is_red_there() {
    let small = ball_lit_from_the_side(0.005, [1.3, 1.0, 0.8]);
    let large = ball_lit_from_the_side(0.5, [1.3, 1.0, 0.8]);
    // Columns 9 and 10 touch the terminator; column 7 lies 14 degrees behind it.
    let part = |picture, x, channel| column(picture, x, channel) / column(picture, 15, channel);
    assert!(part(&small, 7, 0) > 0.1, "{}", part(&small, 7, 0));
    assert!(part(&small, 7, 0) > 1.5 * part(&small, 7, 2), "red goes further than blue");
    assert!(part(&small, 7, 0) > part(&small, 4, 0) && part(&small, 4, 0) > 0.02, "it falls with the distance");
    assert!(part(&large, 7, 0) < 0.002, "{}: no light goes 12 cm", part(&large, 7, 0));
    // The light that enters leaves, less what is absorbed: a ball of 4 free paths absorbs less than a thick one.
    let sum = |picture: &Picture, channel: usize| picture.rgb.iter().map(|pixel| pixel[channel]).sum::<f32>();
    assert!(sum(&small, 2) > 0.5 * sum(&large, 2));
}
