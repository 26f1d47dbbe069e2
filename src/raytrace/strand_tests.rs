//! Strands in the acceleration structure and in whole renders.

use super::aggregate::{Aggregate, Hit, Primitive};
use super::bvh::TraversalStack;
use super::geometry::{Instance, MeshGeometry};
use super::ray_filter::RayFilter;
use super::simd::{LANES, RibbonRay, SegmentHit, SegmentPacket};
use super::strand_detail::{StrandLevel, StrandLevels, StrandView};
use super::strand_geometry::StrandHit;
use super::{GeometryCache, Method, Purpose, RenderControl, RenderScene, Settings, prepare, prepare_for, render};
use crate::math::Ray;
use crate::scene::*;
use crate::statistics::{SampleMean, TestRng, critical_z};
use crate::test_strands::HairyBall;
use glam::{Affine3A, Quat, Vec3};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Returns a ball with strands, and those alone.
fn hair(ball: &HairyBall) -> Mesh {
    let mut mesh = tessellate(&Shape::Sphere { radius_m: ball.radius_m }).unwrap();
    for strand in ball.grow() {
        mesh.strands.push(strand.into_iter().map(|(position, radius_m)| StrandPoint { position, radius_m }));
    }
    mesh.strands.end_part("hair");
    mesh
}

fn only_strands(mesh: &Mesh) -> Mesh {
    Mesh { strands: mesh.strands.clone(), ..Mesh::default() }
}

fn instance(mesh: Mesh, transform: Affine3A) -> Instance {
    Instance::new(Arc::new(MeshGeometry::new(Arc::new(mesh))), transform, 0, vec![0, 1], None).unwrap()
}

fn strand_hit(hit: &Hit) -> StrandHit {
    let Primitive::Strand(hit) = hit.primitive else { panic!("not a strand: {hit:?}") };
    hit
}

/// Returns a ray towards the hair from outside, or from a random point near it.
fn ray_at(ball: &HairyBall, rng: &mut TestRng) -> Ray {
    let target = rng.direction() * ball.radius_m * rng.range(0.8, 1.4);
    let origin =
        if rng.uniform() < 0.5 { rng.direction() * rng.range(0.3, 3.0) } else { target + rng.direction() * 0.1 };
    let t_max = if rng.uniform() < 0.5 { f32::INFINITY } else { rng.range(0.0, 1.5) };
    Ray { origin, direction: (target - origin).normalize(), t_max }
}

/// Few thick strands, so that rays hit them.
const THICK: HairyBall = HairyBall { strands: 700, segments: 9, strand_radius_m: 1e-3, ..HairyBall::HEAD };

#[test]
fn the_closest_hit_of_strands_is_that_of_brute_force_under_any_transform() {
    let mesh = only_strands(&hair(&THICK));
    let strands = mesh.strands.clone();
    let turned = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.0, 1.3, 0.8),
        Quat::from_rotation_x(0.8),
        Vec3::new(0.1, -0.05, 0.2),
    );
    let mut rng = TestRng::new(41);
    for transform in [Affine3A::IDENTITY, turned] {
        let placed = instance(mesh.clone(), transform);
        let aggregate = Aggregate::new(vec![instance(mesh.clone(), transform)]);
        let mut stack = TraversalStack::default();
        let all: Vec<u32> = strands.segments().collect();
        let pack = |chunk: &[u32]| {
            let ends = |first: u32| [0, 1].map(|end| strands.points()[first as usize + end]);
            SegmentPacket::new(chunk.iter().map(|&first| (first, ends(first))))
        };
        let packets: Vec<SegmentPacket> = all.chunks(LANES).map(pack).collect();
        let mut hits = 0;
        for i in 0..3000 {
            let ray = ray_at(&THICK, &mut rng);
            let local = placed.to_object(&ray);
            let ribbon_ray = RibbonRay::new(local.origin, local.direction);
            let mut truth: Option<SegmentHit> = None;
            for packet in &packets {
                let t_max = truth.map_or(ray.t_max, |hit| hit.t);
                truth = packet.intersect(&ribbon_ray, t_max).or(truth);
            }
            let ours = aggregate.intersect(&ray, RayFilter::default(), &mut stack);
            // Of two segments at one distance either may be returned.
            assert_eq!(ours.map(|hit| hit.t), truth.map(|hit| hit.t), "ray {i}: {ray:?}");
            assert_eq!(aggregate.occluded(&ray, RayFilter::default(), &mut stack), truth.is_some(), "ray {i}: {ray:?}");
            hits += usize::from(truth.is_some());
        }
        assert!(hits > 300, "only {hits} rays hit anything: too few for the test");
    }
}

#[test]
fn the_surface_of_a_strand_has_its_tangent_offset_and_position() {
    // A quarter of a circle in the XY plane, of radius 1, in 64 segments: 0.08 mm inside of it.
    let mut mesh = Mesh::default();
    let point = |i: u32| (std::f32::consts::FRAC_PI_2 * i as f32 / 64.0).sin_cos();
    let at = |i| StrandPoint { position: Vec3::new(point(i).0, point(i).1, 0.0), radius_m: 0.002 };
    mesh.strands.push((0..=1).map(|i| StrandPoint { position: Vec3::splat(5.0 + i as f32), radius_m: 0.01 }));
    mesh.strands.end_part("brows");
    mesh.strands.push((0..=64).map(at));
    mesh.strands.end_part("hair");
    let mirrored = Affine3A::from_scale(Vec3::new(2.0, 2.0, -2.0));
    let double = Affine3A::from_scale(Vec3::splat(2.0));
    let mut stack = TraversalStack::default();
    let mut rng = TestRng::new(42);
    for (transform, scale) in [(Affine3A::IDENTITY, 1.0), (double, 2.0), (mirrored, 2.0)] {
        let aggregate = Aggregate::new(vec![instance(mesh.clone(), transform)]);
        for _ in 0..400 {
            let (u, h) = (rng.range(0.02, 0.98), rng.range(-0.9, 0.9));
            let (sin, cos) = (std::f32::consts::FRAC_PI_2 * u).sin_cos();
            let (outwards, tangent) = (Vec3::new(sin, cos, 0.0), Vec3::new(cos, -sin, 0.0));
            // Seen from +Z, N x T = Z x T points outwards: h counts in that direction.
            let origin = (outwards * (1.0 + 0.002 * h) + Vec3::Z) * scale;
            let ray = Ray { origin, direction: Vec3::NEG_Z, t_max: f32::INFINITY };
            let hit = aggregate.intersect(&ray, RayFilter::default(), &mut stack).unwrap();
            assert_eq!(strand_hit(&hit).ray_direction, Vec3::NEG_Z);
            let surface = aggregate.surface(&hit);
            let strand = surface.strand.unwrap();
            // The round ends of two segments overlap by their radius.
            assert!((strand.u - u).abs() < 1.5e-3, "{} for {u}", strand.u);
            assert!((strand.h - h).abs() < 0.05, "{} for {h}", strand.h);
            assert!(
                strand.tangent.dot(tangent) > 0.9999,
                "{} for {tangent}: interpolated between segments",
                strand.tangent
            );
            let aside = (surface.position - origin).truncate().extend(0.0) / scale;
            assert!(
                aside.dot(outwards).abs() < 1e-4 && aside.length() < 0.002,
                "on the ray, within a round end: {aside}"
            );
            assert!((hit.t - scale).abs() < 1e-5 * scale, "at the depth of the axis: {}", hit.t);
            assert_eq!(surface.geometric_normal.round(), Vec3::Z, "faces the ray");
            assert_eq!((surface.material, surface.uv.x), (1, strand.u), "the second part's material");
        }
    }
}

#[test]
fn rays_that_leave_a_fibre_do_not_hit_it_again() {
    // Straight, thin and far from the origin, where coordinates are large.
    let mut mesh = Mesh::default();
    let radius_m = 30e-6;
    mesh.strands.push([0.0, 0.1].map(|x| StrandPoint { position: Vec3::new(x, 1.7, 0.2), radius_m }));
    mesh.strands.end_part("hair");
    let mut rng = TestRng::new(43);
    let mut stack = TraversalStack::default();
    for far in [0.0, 4.0] {
        let transform = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.6), Vec3::splat(-far));
        let aggregate = Aggregate::new(vec![instance(mesh.clone(), transform)]);
        let mut left = 0;
        for _ in 0..60_000 {
            let axis = transform.transform_point3(Vec3::new(rng.range(0.01, 0.09), 1.7, 0.2));
            let direction = rng.direction();
            let origin = axis - direction * rng.range(0.001, 3.0);
            let ray = Ray { origin: origin + rng.direction() * radius_m, direction, t_max: f32::INFINITY };
            let Some(hit) = aggregate.intersect(&ray, RayFilter::default(), &mut stack) else { continue };
            let surface = aggregate.surface(&hit);
            let away = rng.direction();
            let again = Ray { origin: surface.spawn_origin(away), direction: away, t_max: f32::INFINITY };
            assert!(
                !aggregate.occluded(&again, RayFilter::default(), &mut stack),
                "left the fibre and hit it: {ray:?} {again:?}"
            );
            left += 1;
        }
        assert!(left > 20_000, "{left} hits");
    }
}

#[test]
fn a_strand_is_as_wide_as_its_radius_says() {
    // The part of rays through a square that hit a tapered strand, against its area.
    let mut mesh = Mesh::default();
    let ends = [(0.0, 0.02), (1.0, 0.01)].map(|(x, radius_m)| StrandPoint { position: Vec3::X * x, radius_m });
    mesh.strands.push(ends);
    mesh.strands.end_part("hair");
    let aggregate = Aggregate::new(vec![instance(mesh, Affine3A::IDENTITY)]);
    let mut stack = TraversalStack::default();
    let mut rng = TestRng::new(44);
    let hits = SampleMean::of((0..100_000).map(|_| {
        let origin = Vec3::new(rng.range(-0.5, 1.5), rng.range(-0.05, 0.05), 3.0);
        let ray = Ray { origin, direction: Vec3::NEG_Z, t_max: f32::INFINITY };
        f64::from(u8::from(aggregate.intersect(&ray, RayFilter::default(), &mut stack).is_some()))
    }));
    // A trapezium and two half discs, of an area of 0.2.
    let area = 0.03 + 0.5 * std::f64::consts::PI * (0.02_f64.powi(2) + 0.01_f64.powi(2));
    assert!((hits.mean - area / 0.2).abs() < critical_z(1) * hits.standard_error, "{hits:?} for {}", area / 0.2);
}

/// Returns a scene of hair alone under an even white surround.
fn furnace(fibre: Fibre) -> (Scene, Assets) {
    let ball = HairyBall { strands: 1500, segments: 6, strand_radius_m: 1e-3, ..HairyBall::HEAD };
    let mut assets = Assets::default();
    assets.insert_mesh("hair.obj", Arc::new(only_strands(&hair(&ball))));
    let object = Object {
        id: ObjectId(1),
        material: Material { fibre: Some(fibre), ..Material::default() },
        ..Object::new("Hair", Shape::MeshFile { path: "hair.obj".into() })
    };
    let surround = Light { visible_to_camera: true, ..Light::new(Emitter::Surround, Output::Lux(1000.0)) };
    let camera = Camera {
        position: Vec3::new(0.0, 0.0, 0.9),
        aim: Aim::Point(Vec3::ZERO),
        focal_length_mm: 85.0,
        ..Camera::default()
    };
    (Scene { camera, objects: vec![object], lights: vec![surround], ..Scene::default() }, assets)
}

/// Returns the picture's mean, and that of the brightest and darkest pixels.
fn rendered(scene: &Scene, assets: &Assets, method: Method) -> (f32, f32, f32) {
    let prepared = prepare(scene, assets).unwrap();
    let settings = Settings { width: 24, height: 16, spp: 64, method, ..Settings::default() };
    let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
    let picture = film.develop(scene);
    let values: Vec<f32> = picture.rgb.iter().map(|rgb| rgb[1]).collect();
    let (low, high) = values.iter().fold((f32::INFINITY, 0.0_f32), |(low, high), v| (low.min(*v), high.max(*v)));
    (values.iter().sum::<f32>() / values.len() as f32, low, high)
}

#[test]
fn white_hair_disappears_in_an_even_surround() {
    let (scene, assets) = furnace(Fibre::of_melanin(0.0, 0.0));
    let prepared = prepare(&scene, &assets).unwrap();
    assert!(prepared.plan().max_depth > 1000 && prepared.plan().to_string().contains("strands of hair"));
    let (mean, low, high) = rendered(&scene, &assets, Method::Path);
    let (bare, ..) = rendered(&Scene { objects: Vec::new(), ..scene.clone() }, &assets, Method::Path);
    // Energy in all of 384 pixels to 0.5 % and in each to its noise; light has up to a hundred bounces.
    assert!((mean / bare - 1.0).abs() < 0.005, "{mean} for {bare}");
    assert!(low > 0.85 * bare && high < 1.15 * bare, "{low} to {high} for {bare}");
    let (black, assets) = furnace(Fibre::of_melanin(1.0, 0.0));
    let (dark, ..) = rendered(&black, &assets, Method::Path);
    assert!(dark < 0.8 * bare, "black hair is darker: {dark} for {bare}");
}

#[test]
fn thinned_hair_is_as_bright_as_all_of_it() {
    // Too far away for single strands: one of eight is kept, for the camera and for light.
    let ball = HairyBall { strands: 40_000, segments: 6, ..HairyBall::HEAD };
    let (mut scene, mut assets) = furnace(Fibre::of_melanin(0.3, 0.1));
    assets.insert_mesh("hair.obj", Arc::new(only_strands(&hair(&ball))));
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.6 };
    let key = Light {
        position: Vec3::new(0.8, 0.6, 0.8),
        aim: Aim::Point(Vec3::ZERO),
        ..Light::new(panel, Output::Lumens(3000.0))
    };
    scene.lights = vec![key];
    // Its noise is about a per cent
    let settings = Settings { width: 24, height: 16, spp: 1024, ..Settings::default() };
    let purpose = Purpose { picture: Some((settings.width, settings.height)), ..Purpose::default() };
    let all = prepare(&scene, &assets).unwrap();
    let thinned = prepare_for(&scene, &assets, purpose, &GeometryCache::default()).unwrap();
    let levels = |scene: &RenderScene| scene.aggregate.instances()[0].strands().unwrap().levels();
    assert_eq!(levels(&all), StrandLevels::default());
    assert_eq!(levels(&thinned), StrandLevels { seen: StrandLevel::COARSEST, lighting: StrandLevel::COARSEST });
    assert!(thinned.plan().to_string().contains("one of 8 strands, 8 times as wide"), "{}", thinned.plan());
    let mean = |prepared: &RenderScene| {
        let film = render(prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let rgb = film.develop(&scene).rgb;
        rgb.iter().map(|rgb| rgb[1]).sum::<f32>() / rgb.len() as f32
    };
    let (ours, truth) = (mean(&thinned), mean(&all));
    // 5000 strands instead of 40 000: which of them are kept makes a per cent
    assert!((ours / truth - 1.0).abs() < 0.015, "{ours} for {truth}");
    // A camera that comes near sees all strands again
    let mut near = thinned;
    near.thin_strands(&StrandView { position: Vec3::Z * 0.11, pixel_m: 1e-4 });
    assert_eq!(levels(&near).seen, StrandLevel::ALL);
}

#[test]
fn every_method_renders_hair() {
    let (mut scene, assets) = furnace(Fibre::default());
    scene.lights =
        vec![Light { position: Vec3::new(0.5, 1.0, -0.6), ..Light::new(Emitter::Point, Output::Candela(100.0)) }];
    let [path, direct, whitted] =
        [Method::Path, Method::Direct, Method::Whitted].map(|method| rendered(&scene, &assets, method).0);
    assert!(direct > 0.0 && path > direct, "{path} {direct}");
    // One scattering event, and delta lights: both compute the same.
    assert!((whitted / direct - 1.0).abs() < 0.01, "{whitted} for {direct}");
}
