//! Water in a tank, traced: Snell's window, absorption over its depth, and a ball of cells beside a ball.

use crate::studio;
use crate::studio::light;
use crate::studio::measure::{film_with, square};
use catchlight::io;
use catchlight::photo::Picture;
use catchlight::raytrace::{Method, Settings};
use catchlight::scene::{
    Aim, Assets, Camera, Emitter, Material, Object, Output, Scene, Sensor, Shape, Tank, TankLook, Terrain,
};
use catchlight::water::{FULL, Grid, surface_of};
use glam::Vec3;
use std::sync::Arc;

/// Returns a tank of 8 x 8 m with 40 cm of ground under still water, with a camera in a sensor of 24 mm.
fn pool(water_m: f32, look: TankLook, ground: Material, absorption_per_m: f32) -> Scene {
    let tank = Tank {
        cells: [40, 12, 40],
        cell_m: 0.2,
        terrain: Terrain::Flat { height_m: 0.4 },
        water_m,
        look,
        ..Tank::default()
    };
    let water = Material { absorption_per_m: [absorption_per_m; 3], ..Tank::water_material() };
    let pool = Object {
        material: ground,
        part_materials: vec![("water".to_owned(), water)],
        ..studio::object("Pool", Shape::Tank(Box::new(tank)), Vec3::ZERO)
    };
    let camera = Camera { sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 }, ..Camera::default() };
    Scene { objects: vec![pool], camera, ..Scene::default() }
}

fn picture(scene: &Scene, settings: &Settings) -> Picture {
    let mut assets = Assets::default();
    assert_eq!(io::load_assets(scene, None, &mut assets), []);
    film_with(scene, &assets, settings).develop(scene)
}

#[test]
fn a_camera_under_water_sees_the_sky_in_snells_window() {
    for look in [TankLook::Smooth, TankLook::Cubes] {
        let black = Material { base_color: [0.0; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
        let mut scene = pool(2.0, look, black, 0.0);
        let mut sky = light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO);
        (sky.aim, sky.visible_to_camera) = (Aim::Point(Vec3::NEG_Z), true);
        scene.lights.push(sky);
        scene.camera.position = Vec3::new(0.01, 1.6, 0.02);
        scene.camera.aim = Aim::Point(scene.camera.position + Vec3::Y);
        scene.camera.focal_length_mm = 7.0;
        let side = 64;
        let picture = picture(&scene, &square(Method::Path, side, 4));
        let row: Vec<f32> = (0..side).map(|x| picture.rgb[(side / 2 * side + x) as usize][1]).collect();
        let centre = row[side as usize / 2];
        let bright = row.iter().filter(|value| **value > 0.5 * centre).count() as f32;
        // Half the angle of the window is asin(1 / 1.333) = 48.6 degrees; beyond it the black ground is mirrored
        let expected = 2.0 * (1.0_f32 / 1.333).asin().tan() * 7.0 / 24.0 * side as f32;
        assert!((bright - expected).abs() < 1.6, "{look:?}: {bright} of {expected} pixels");
        assert!(row[2] < 0.01 * centre && row[side as usize - 3] < 0.01 * centre, "{look:?}: {row:?}");
    }
}

#[test]
fn water_absorbs_over_exactly_its_depth() {
    // Levels inside of cells: the surface is at the level of the water, not at a face of a cell
    let luminance = |water_m: f32| {
        let glowing = Material { base_color: [0.0; 3], emission_cd_m2: [1000.0; 3], ior: 1.0, ..Material::default() };
        let mut scene = pool(water_m, TankLook::Smooth, glowing, 0.9);
        scene.camera.position = Vec3::new(0.01, 5.0, 0.02);
        scene.camera.aim = Aim::Point(scene.camera.position + Vec3::NEG_Y);
        scene.camera.focal_length_mm = 2000.0;
        picture(&scene, &square(Method::Path, 4, 4)).rgb.iter().map(|rgb| rgb[1]).sum::<f32>()
    };
    let expected = (-0.9_f32 * (1.63 - 0.87)).exp();
    let ratio = luminance(1.63) / luminance(0.87);
    assert!((ratio / expected - 1.0).abs() < 2e-3, "{ratio} for {expected}");
}

#[test]
fn a_ball_of_cells_is_as_bright_as_a_ball() {
    let side = 128;
    let (radius, middle) = (0.45 * side as f32, 0.5 * side as f32);
    let mut grid = Grid::new([side; 3]);
    for (z, x) in (0..side).flat_map(|z| (0..side).map(move |x| (z, x))) {
        for y in 0..side {
            let at = Vec3::new(x as f32, y as f32, z as f32) + 0.5 - middle;
            let share = (radius - at.length() + 0.5).clamp(0.0, 1.0);
            let cell = grid.index([x, y, z]);
            grid.set_ground(cell, (share * f32::from(FULL)) as u16);
        }
    }
    let cell_m = 0.5 / radius;
    let mesh = surface_of(&grid, TankLook::Smooth, Vec3::splat(-middle * cell_m), cell_m);
    let mut assets = Assets::default();
    assets.insert_mesh("ball.obj", Arc::new(mesh));
    let camera = Camera {
        position: Vec3::Z * 3.0,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 60.0,
        ..Camera::default()
    };
    let key = light(Emitter::Point, Output::Lumens(1e6), Vec3::new(-3.0, 2.0, 2.0));
    let mean = |shape: Shape| {
        let ball = studio::object("Ball", shape, Vec3::ZERO);
        let scene =
            Scene { objects: vec![ball], lights: vec![key.clone()], camera: camera.clone(), ..Scene::default() };
        let picture = film_with(&scene, &assets, &square(Method::Direct, 32, 4)).develop(&scene);
        picture.rgb.iter().map(|rgb| rgb[1]).sum::<f32>() / picture.rgb.len() as f32
    };
    let ratio = mean(Shape::MeshFile { path: "ball.obj".to_owned() }) / mean(Shape::Sphere { radius_m: 0.5 });
    // Half a cell of the radius is 0.9 % of it
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}
