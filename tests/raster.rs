//! The z-buffer on the processor: against the tracer's first hits, closed forms and itself.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on says so by panicking")]

mod studio;

use catchlight::photo::exposure;
use catchlight::raster::{self, NO_OBJECT, Shading};
use catchlight::raytrace;
use catchlight::scene::{Aim, Assets, Camera, Emitter, Material, Object, Output, Scene, Shape};
use glam::Vec3;
use std::f32::consts::PI;

fn drawn(scene: &Scene, size: (u32, u32), shading: Shading) -> raster::Framebuffer {
    let camera = scene.camera_frame(size.0 as f32 / size.1 as f32);
    raster::draw(scene, &Assets::default(), &camera, size, shading)
}

#[test]
fn every_studio_is_outlined_as_rays_find_it() {
    for preset in catchlight::io::presets() {
        let loaded = preset.load().unwrap();
        let (width, height) = loaded.scene.camera.picture_size(900);
        let camera = loaded.scene.camera_frame(width as f32 / height as f32);
        let ours = raster::draw(&loaded.scene, &loaded.assets, &camera, (width, height), Shading::Lambert).objects;
        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
        let rays = raytrace::primary_objects(&prepared, width, height);
        let differ: Vec<usize> = (0..rays.len()).filter(|&i| ours[i] != rays[i]).collect();
        let name = preset.file_name;
        println!("{name}: {} of {} pixels differ", differ.len(), rays.len());
        assert!(differ.len() * 10_000 <= rays.len(), "{name}: {} of {} pixels differ", differ.len(), rays.len());
        for i in differ {
            let (x, y) = (i as u32 % width, i as u32 / width);
            let around = (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (y * width + x) as usize));
            let on_edge = around.into_iter().any(|k| rays[k] == ours[i]);
            assert!(on_edge, "{name}: pixel {x}, {y} differs and is on no edge");
        }
    }
}

#[test]
fn a_closed_figure_shows_no_crack() {
    // A ball of eight thousand triangles before a wall that fills the picture: not one pixel of wall inside the ball.
    let mut scene = Scene { camera: front(3.0), ..Scene::default() };
    scene.objects.push(studio::object("Ball", Shape::Sphere { radius_m: 0.5 }, Vec3::ZERO));
    for (step, roll_deg) in [0.0, 13.7, 45.0, 71.3].into_iter().enumerate() {
        scene.objects[0].transform.rotation_deg = Vec3::new(31.0 * step as f32, 7.0, roll_deg);
        let size = (331, 331);
        let objects = drawn(&scene, size, Shading::Lambert).objects;
        for row in objects.chunks(size.0 as usize) {
            let inside: Vec<usize> = (0..row.len()).filter(|&x| row[x] == 0).collect();
            let (Some(first), Some(last)) = (inside.first(), inside.last()) else { continue };
            assert_eq!(inside.len(), last - first + 1, "a hole in a row of the ball, rolled by {roll_deg}");
        }
    }
}

/// A camera on +Z that looks at the origin, square.
fn front(distance: f32) -> Camera {
    Camera {
        position: Vec3::Z * distance,
        aim: Aim::Point(Vec3::ZERO),
        sensor: catchlight::scene::Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 50.0,
        ..Camera::default()
    }
}

#[test]
fn a_card_shows_the_light_that_formulas_give() {
    // Distances of the table of panels, 1000 lm on the axis; a round panel is exact here, a point light anyway.
    let round = Emitter::RoundPanel { diameter_m: 1.2 };
    let cases = [
        (round, 0.5, 521.82),
        (round, 1.0, 234.05),
        (round, 3.0, 34.01),
        (Emitter::Point, 1.0, 1000.0 / (4.0 * PI)),
        (Emitter::Spot { inner_deg: 60.0, outer_deg: 60.0 }, 1.0, 1188.0),
    ];
    for (emitter, distance, lux) in cases {
        let mut scene = studio::card_at(Vec3::ZERO, 2.0);
        scene.lights.push(studio::light(emitter, Output::Lumens(1000.0), Vec3::Z * distance));
        let picture = drawn(&scene, (3, 3), Shading::BlinnPhong).picture;
        let camera = &scene.camera;
        let per_lux = exposure::pixel_per_cd_s_m2(camera) * camera.shutter_s * studio::REFLECTANCE / PI;
        let seen = picture.at(1, 1)[1] / per_lux;
        // The table has four to five digits, and the pixel is a few millimetres beside the axis.
        assert!((seen / lux - 1.0).abs() < 2e-3, "{emitter:?} at {distance} m: {seen} lx instead of {lux}");
    }
}

#[test]
fn gouraud_misses_the_highlight_inside_a_large_triangle_and_shading_a_pixel_does_not() {
    let mut scene = Scene { camera: front(3.0), ..Scene::default() };
    let gloss = Material { base_color: [0.05; 3], roughness: 0.3, ..Material::default() };
    let mut card =
        Object { material: gloss, ..studio::object("Card", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::ZERO) };
    card.transform.rotation_deg = Vec3::X * 90.0;
    scene.objects.push(card);
    scene.lights.push(studio::light(Emitter::Point, Output::Lumens(5000.0), Vec3::Z * 3.0));
    let middle = |shading| drawn(&scene, (65, 65), shading).picture.at(32, 32)[1];
    let [phong, gouraud, lambert] = [Shading::BlinnPhong, Shading::Gouraud, Shading::Lambert].map(middle);
    assert!(phong > 2.0 * lambert, "the highlight stands in the middle: {phong} over {lambert}");
    assert!(gouraud < 0.3 * phong, "Gouraud has no vertex there: {gouraud} of {phong}");
}

#[test]
fn any_number_of_threads_and_any_size_give_the_same_or_a_picture() {
    let loaded = catchlight::io::find_preset("three_point").unwrap().load().unwrap();
    let camera = loaded.scene.camera_frame(1.5);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| raster::draw(&loaded.scene, &loaded.assets, &camera, (150, 100), Shading::BlinnPhong))
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert!(one.objects.iter().any(|object| *object != NO_OBJECT));
    for size in [(0, 0), (1, 1), (1, 333), (333, 1), (65, 129)] {
        for shading in [Shading::Lambert, Shading::BlinnPhong, Shading::Gouraud, Shading::Flat] {
            let drawing = raster::draw(&loaded.scene, &loaded.assets, &camera, size, shading);
            assert_eq!((drawing.picture.width, drawing.picture.height), (size.0.max(1), size.1.max(1)));
            assert!(drawing.picture.rgb.iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
        }
    }
}

#[test]
fn a_camera_inside_a_mesh_or_with_the_floor_through_its_near_plane_sees_on() {
    let mut scene = Scene { camera: front(0.0001), ..Scene::default() };
    scene.camera.aim = Aim::Point(Vec3::NEG_Z);
    scene.objects.push(studio::object("Shell", Shape::Sphere { radius_m: 1.0 }, Vec3::ZERO));
    let inside = drawn(&scene, (40, 40), Shading::Lambert);
    assert!(inside.objects.iter().all(|object| *object == 0), "the shell is all around");
    scene.objects[0] = studio::object("Floor", Shape::Plane { width_m: 50.0, depth_m: 50.0 }, Vec3::Y * -0.01);
    let floor = drawn(&scene, (40, 40), Shading::Lambert).objects;
    assert!(floor[20 * 40 + 40..].iter().all(|object| *object == 0), "below the horizon lies the floor");
    assert!(floor[..19 * 40].iter().all(|object| *object == NO_OBJECT));
}
