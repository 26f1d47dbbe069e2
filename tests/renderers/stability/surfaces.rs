//! Meshes and materials at their limits: degenerate triangles, mirrors, nested glass, coplanar surfaces.

use super::{assert_robust, assert_robust_at, base_scene, glass, grey, mean, metal, object_with_id};
use crate::studio::measure::{film_with, picture, square};
use crate::studio::{self, light};
use catchlight::raytrace::{self, Method, Settings};
use catchlight::scene::{Aim, Assets, Camera, Emitter, Light, Material, Mesh, Output, Room, Scene, Shape, Transform};
use glam::{Vec2, Vec3};
use std::sync::Arc;

#[test]
fn a_closed_body_leaks_no_light_near_and_far_from_the_origin() {
    // A light inside a closed body: the outside is black at the origin, at 1 km and at 100 km.
    for far in [0.0_f32, 1e3, 1e5] {
        let at = Vec3::new(far, far, -far);
        for shape in [
            Shape::Sphere { radius_m: 0.5 },
            Shape::Box { size_m: Vec3::ONE },
            Shape::Cylinder { radius_m: 0.4, height_m: 1.0 },
        ] {
            let mut body = object_with_id(0, "Body", shape.clone(), at);
            body.transform.rotation_deg = Vec3::new(10.0, 20.0, 30.0);
            body.material = grey(0.8);
            let lamp = Light { aim: Aim::Point(at + Vec3::Z), ..light(Emitter::Point, Output::Lumens(1e6), at) };
            let camera = Camera {
                position: at + Vec3::Z * 3.0,
                aim: Aim::Point(at),
                focal_length_mm: 50.0,
                ..Camera::default()
            };
            let scene = Scene { objects: vec![body], lights: vec![lamp], camera, ..Scene::default() };
            let picture = picture(&scene, &square(Method::Path, 48, 16));
            assert_eq!(mean(&picture), 0.0, "{shape:?} at {at} leaks");
        }
    }
}

#[test]
fn roughness_from_zero_to_one_is_robust() {
    for roughness in [0.0, 1e-4, 0.0316, 0.032, 0.1, 1.0] {
        for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.0, 1.0)] {
            let mut scene = base_scene();
            scene.objects[1].material = Material { metallic, transmission, ..metal(roughness) };
            assert_robust(&scene, &Assets::default());
        }
    }
    // Roughness 1e-4 is below the limit of a delta lobe.
    let mirror = |roughness| {
        let mut scene = base_scene();
        scene.objects[1].material = metal(roughness);
        picture(&scene, &square(Method::Path, 16, 8))
    };
    assert_eq!(mirror(0.0), mirror(1e-4));
}

fn model(mesh: Mesh, edit: impl Fn(&mut Scene)) -> (Scene, Assets) {
    let mut scene = base_scene();
    scene.objects[1].shape = Shape::MeshFile { path: "model.obj".into() };
    scene.objects[1].transform = Transform::default();
    edit(&mut scene);
    let mut assets = Assets::default();
    assets.insert_mesh("model.obj", Arc::new(mesh));
    (scene, assets)
}

#[test]
fn degenerate_triangles_and_normals_are_robust() {
    let corners = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::X * 2.0,
        Vec3::ZERO,
        Vec3::new(1e-20, 0.0, 0.0),
        Vec3::new(0.5, 0.5, 1e-30),
    ];
    let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 0, 0], [0, 4, 1], [5, 4, 0], [1, 1, 2], [0, 1, 6], [2, 1, 6]];
    let bare = Mesh { positions: corners.clone(), triangles: triangles.clone(), ..Mesh::default() };
    let zero_normals = Mesh { normals: vec![Vec3::ZERO; 7], uvs: vec![Vec2::NAN; 7], ..bare.clone() };
    let nothing = Mesh { positions: corners, triangles: vec![[0, 1, 3], [4, 4, 4]], ..Mesh::default() };
    for mesh in [bare, zero_normals, nothing, Mesh::default()] {
        let (scene, assets) = model(mesh.with_single_part("surface"), |_| {});
        assert_robust(&scene, &assets);
    }
}

#[test]
fn normals_opposite_to_the_winding_light_the_visible_side() {
    let quad = |normal: Vec3| Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        normals: vec![normal; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let view = |normal| {
        let (scene, assets) = model(quad(normal).with_single_part("surface"), |_| {});
        film_with(&scene, &assets, &square(Method::Direct, 16, 4)).develop(&scene)
    };
    // Reversed normals give the same picture; normals nearly in the plane keep the visible side lit.
    assert_eq!(view(Vec3::Z), view(Vec3::NEG_Z));
    assert!(mean(&view(Vec3::new(1.0, 0.0, -0.05).normalize())) > 0.0);
}

#[test]
fn paths_between_parallel_mirrors_end() {
    let mut scene = base_scene();
    let mirror = |id, z: f32, rotation_deg: f32| {
        let mut mirror = object_with_id(
            id,
            if id == 2 { "Front" } else { "Back" },
            Shape::Plane { width_m: 4.0, depth_m: 4.0 },
            Vec3::Z * z,
        );
        mirror.transform.rotation_deg = Vec3::X * rotation_deg;
        mirror.material = Material { base_color: [0.999; 3], ..metal(0.0) };
        mirror
    };
    scene.objects.extend([mirror(2, -2.0, 90.0), mirror(3, 4.0, -90.0)]);
    assert!(mean(&assert_robust(&scene, &Assets::default())) > 0.0);
}

#[test]
fn paths_through_nested_glass_end() {
    let mut scene = base_scene();
    scene.objects.truncate(1);
    for i in 0..20 {
        let mut shell = object_with_id(
            10 + i,
            &format!("Shell {i}"),
            Shape::Sphere { radius_m: 0.8 - 0.03 * i as f32 },
            Vec3::Y * 0.9,
        );
        shell.material = Material { ior: 1.0 + 0.1 * i as f32, absorption_per_m: [0.1; 3], ..glass() };
        scene.objects.push(shell);
    }
    // Each path of each method has hundreds of branches
    assert!(mean(&assert_robust_at((24, 16), &scene, &Assets::default())) > 0.0);
}

#[test]
fn mirrors_with_interpolated_normals_are_not_dark_at_the_rim() {
    // A coarse sphere, whose interpolated normals reflect rays below the surface at its rim. In a uniform surround, a
    // mirror has the value of the surround there, too.
    let mut coarse = Mesh::default();
    let (around, rows) = (10_u32, 6_u32);
    for row in 0..=rows {
        for column in 0..=around {
            let (latitude, azimuth) = (
                row as f32 / rows as f32 * std::f32::consts::PI,
                column as f32 / around as f32 * std::f32::consts::TAU,
            );
            let n = Vec3::new(latitude.sin() * azimuth.sin(), -latitude.cos(), latitude.sin() * azimuth.cos());
            coarse.positions.push(n * 0.5);
            coarse.normals.push(n);
        }
    }
    for row in 0..rows {
        for column in 0..around {
            let a = row * (around + 1) + column;
            coarse.triangles.extend([[a, a + 1, a + around + 2], [a, a + around + 2, a + around + 1]]);
        }
    }
    let mut scene = studio::ball_in_even_light(Material { base_color: [0.999; 3], ..metal(0.0) });
    scene.objects[0].shape = Shape::MeshFile { path: "ball.obj".into() };
    let mut assets = Assets::default();
    assets.insert_mesh("ball.obj", Arc::new(coarse.with_single_part("surface")));
    let ours =
        film_with(&scene, &assets, &Settings { max_depth: Some(64), ..square(Method::Path, 48, 16) }).develop(&scene);
    let surround = ours.at(0, 0)[1];
    let darkest = ours.rgb.iter().map(|p| p[1] / surround).fold(f32::INFINITY, f32::min);
    assert!(darkest > 0.99, "a pixel has {darkest} of the surround");
}

#[test]
fn paper_on_the_floor_plane_hides_the_floor_without_z_fighting() {
    // Floor and paper are both at y = 0. From every side, near and far, only the paper is visible, uniformly lit.
    let paper = Shape::Sweep { width_m: 2.7, height_m: 2.0, depth_m: 3.0, radius_m: 0.5 };
    let mut sweep = object_with_id(1, "Paper", paper, Vec3::new(0.0, 0.0, -1.5));
    sweep.material = grey(0.8);
    let mut scene = Scene { room: Some(Room::default()), objects: vec![sweep], ..Scene::default() };
    scene.lights.push(light(Emitter::Point, Output::Lumens(8000.0), Vec3::new(0.0, 2.4, 0.4)));
    for position in [Vec3::new(1.9, 0.4, 0.9), Vec3::new(-1.7, 2.0, 1.8), Vec3::new(0.3, 0.2, 2.2)] {
        scene.camera = Camera { position, aim: Aim::Point(Vec3::Z * 0.4), focal_length_mm: 300.0, ..Camera::default() };
        let prepared = raytrace::prepare(&scene, &Assets::default()).unwrap();
        assert!(raytrace::primary_objects(&prepared, 60, 40).iter().all(|object| *object == 0), "from {position}");
        let picture =
            picture(&scene, &Settings { width: 60, height: 40, spp: 4, method: Method::Direct, ..Settings::default() });
        let (low, high) =
            picture.rgb.iter().fold((f32::MAX, 0.0_f32), |(low, high), p| (low.min(p[1]), high.max(p[1])));
        // Distance and cosine vary by less than this over the patch; a shadow of the floor would be black.
        assert!(low > 0.3 * high, "{low} to {high} from {position}");
    }
}
