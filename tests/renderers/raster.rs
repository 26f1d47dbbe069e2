//! The software rasterizer against the ray tracer's first hits, closed forms and itself.

use crate::people::{coarse_and_hairless, shipped};
use crate::studio;
use catchlight::photo::exposure;
use catchlight::raster::{self, NO_OBJECT, Shading};
use catchlight::raytrace;
use catchlight::scene::{Aim, Assets, Camera, Emitter, Focus, Material, Object, Output, Scene, Shape};
use glam::Vec3;
use std::f32::consts::PI;

fn draw(scene: &Scene, size: (u32, u32), shading: Shading) -> raster::Framebuffer {
    let camera = scene.camera_frame(size.0 as f32 / size.1 as f32);
    raster::draw(scene, &Assets::default(), &camera, size, shading)
}

#[test]
fn visible_objects_agree_with_primary_rays_in_every_studio() {
    for preset in catchlight::io::presets() {
        let loaded = coarse_and_hairless(shipped(preset.file_name));
        let (width, height) = loaded.scene.camera.picture_size(900);
        let camera = loaded.scene.camera_frame(width as f32 / height as f32);
        let ours = raster::draw(&loaded.scene, &loaded.assets, &camera, (width, height), Shading::Lambert).objects;
        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
        let rays = raytrace::primary_objects(&prepared, width, height);
        let different: Vec<usize> = (0..rays.len()).filter(|&i| ours[i] != rays[i]).collect();
        let name = preset.file_name;
        println!("{name}: {} of {} pixels differ", different.len(), rays.len());
        assert!(different.len() * 10_000 <= rays.len(), "{name}: {} of {} pixels differ", different.len(), rays.len());
        for i in different {
            let (x, y) = (i as u32 % width, i as u32 / width);
            let neighbours = (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (y * width + x) as usize));
            let on_edge = neighbours.into_iter().any(|k| rays[k] == ours[i]);
            assert!(on_edge, "{name}: pixel {x}, {y} differs and is on no silhouette");
        }
    }
}

#[test]
fn a_closed_mesh_has_no_cracks() {
    // A sphere of eight thousand triangles: not one background pixel inside its silhouette.
    let mut scene = Scene { camera: front(3.0), ..Scene::default() };
    scene.objects.push(studio::object("Ball", Shape::Sphere { radius_m: 0.5 }, Vec3::ZERO));
    for (step, roll_deg) in [0.0, 13.7, 45.0, 71.3].into_iter().enumerate() {
        scene.objects[0].transform.rotation_deg = Vec3::new(31.0 * step as f32, 7.0, roll_deg);
        let size = (331, 331);
        let objects = draw(&scene, size, Shading::Lambert).objects;
        for row in objects.chunks(size.0 as usize) {
            let inside: Vec<usize> = (0..row.len()).filter(|&x| row[x] == 0).collect();
            let (Some(first), Some(last)) = (inside.first(), inside.last()) else { continue };
            assert_eq!(inside.len(), last - first + 1, "a hole in a row of the sphere, rolled by {roll_deg}");
        }
    }
}

/// A camera on +Z that looks at the origin, with a square sensor.
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
fn the_illuminance_of_a_card_agrees_with_closed_forms() {
    // light_and_camera.md, 1000 lm on the axis: discs and points are exact in this renderer.
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
        let picture = draw(&scene, (3, 3), Shading::BlinnPhong).picture;
        let per_lux = exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s * studio::REFLECTANCE / PI;
        let reading = picture.at(1, 1)[1] / per_lux;
        // The table has four to five digits, and the pixel is a few millimetres off the axis.
        assert!((reading / lux - 1.0).abs() < 2e-3, "{emitter:?} at {distance} m: {reading} lx instead of {lux}");
    }
}

#[test]
fn gouraud_misses_the_highlight_inside_a_large_triangle_and_pixel_shading_shows_it() {
    let mut scene = Scene { camera: front(3.0), ..Scene::default() };
    let glossy = Material { base_color: [0.05; 3], roughness: 0.3, ..Material::default() };
    let mut card =
        Object { material: glossy, ..studio::object("Card", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::ZERO) };
    card.transform.rotation_deg = Vec3::X * 90.0;
    scene.objects.push(card);
    scene.lights.push(studio::light(Emitter::Point, Output::Lumens(5000.0), Vec3::Z * 3.0));
    let centre = |shading| draw(&scene, (65, 65), shading).picture.at(32, 32)[1];
    let [phong, gouraud, lambert] = [Shading::BlinnPhong, Shading::Gouraud, Shading::Lambert].map(centre);
    assert!(phong > 2.0 * lambert, "a highlight at the centre: {phong} over {lambert}");
    assert!(gouraud < 0.3 * phong, "Gouraud has no vertex there: {gouraud} of {phong}");
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads_and_every_size_is_drawn() {
    let loaded = shipped("three_point");
    let camera = loaded.scene.camera_frame(1.5);
    let draw_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| raster::draw(&loaded.scene, &loaded.assets, &camera, (150, 100), Shading::BlinnPhong))
    };
    let one = draw_with(1);
    assert_eq!(one, draw_with(3));
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
fn a_camera_inside_a_mesh_or_with_its_near_plane_through_the_floor_draws_both() {
    let mut scene = Scene { camera: front(0.0001), ..Scene::default() };
    scene.camera.aim = Aim::Point(Vec3::NEG_Z);
    scene.objects.push(studio::object("Shell", Shape::Sphere { radius_m: 1.0 }, Vec3::ZERO));
    let inside = draw(&scene, (40, 40), Shading::Lambert);
    assert!(inside.objects.iter().all(|object| *object == 0), "the shell surrounds the camera");
    scene.objects[0] = studio::object("Floor", Shape::Plane { width_m: 50.0, depth_m: 50.0 }, Vec3::Y * -0.01);
    let floor = draw(&scene, (40, 40), Shading::Lambert).objects;
    assert!(floor[20 * 40 + 40..].iter().all(|object| *object == 0), "the floor is below the horizon");
    assert!(floor[..19 * 40].iter().all(|object| *object == NO_OBJECT));
}

#[test]
fn an_nd_filter_and_near_focus_show_as_in_the_tracer() {
    // A glowing card of 12 mm before a lens of 100 mm: at 1:1 it fills a quarter of the 24 mm sensor, two stops darker.
    let mut scene = studio::card_at(Vec3::ZERO, 0.012);
    scene.objects[0].material.emission_cd_m2 = [100.0; 3];
    scene.camera = Camera { focal_length_mm: 100.0, focus: Focus::Distance(0.2), ..front(0.2) };
    let shown = |scene: &Scene| {
        let picture = draw(scene, (128, 128), Shading::BlinnPhong).picture;
        let value = picture.at(64, 64)[1];
        let covered = picture.rgb.iter().filter(|p| p[1] > 0.5 * value).count();
        (value, (covered as f32).sqrt() / 128.0 * 24e-3 / 0.012)
    };
    let (plain, magnification) = shown(&scene);
    // An edge is exact to half a pixel of 64.
    assert!((magnification - 0.5).abs() < 0.01, "{magnification} without breathing");
    (scene.camera.focus_breathing, scene.camera.nd_stops) = (true, 3.0);
    let (filtered, magnification) = shown(&scene);
    assert!((magnification - 1.0).abs() < 0.01, "{magnification} with breathing");
    assert!(((plain / filtered).log2() - 5.0).abs() < 1e-3, "{plain} and {filtered}");
}
