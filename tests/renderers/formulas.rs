//! Tests against common wrong formulas (methods.md): each test computes the wrong value, too, and shows that it lies
//! outside of the tolerance. Triangles, boxes and error bounds are tested beside their code; clipping, depth and
//! perspective-correct textures with the z-buffer.

use crate::studio;
use crate::studio::light;
use crate::studio::measure::{
    illuminance, illuminance_by_paths, illuminance_over, luminance_per_value, meter_card, picture, square, values,
    wide_meter_card,
};
use crate::studio::statistics::SampleMean;
use catchlight::photo::emitter::{cone_falloff, cone_solid_angle_sr};
use catchlight::raytrace::{Method, Settings};
use catchlight::scene::{
    Aim, Camera, Emitter, Light, LightId, Material, Object, Output, Room, Scene, Sensor, Shape, Transform,
};
use glam::Vec3;
use std::f64::consts::PI;

/// Asserts that a value is within a relative tolerance of the reference, and the wrong formula's value is not.
fn assert_distinguishes(ours: f64, reference: f64, wrong: f64, limit: f64, what: &str) {
    assert!((ours - reference).abs() <= limit * reference.abs(), "{what}: {ours} for {reference}");
    assert!((wrong - reference).abs() > 2.0 * limit * reference.abs(), "{what}: {wrong} would pass for {reference}");
}

fn object(name: &str, shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    let transform = Transform { position, rotation_deg, ..Transform::default() };
    Object { material, transform, ..studio::object(name, shape, position) }
}

/// Returns a camera with a square sensor and a tiny field of view.
fn camera(position: Vec3, at: Vec3) -> Camera {
    Camera {
        position,
        aim: Aim::Point(at),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 5000.0,
        ..Camera::default()
    }
}

fn luminance(scene: &Scene, method: Method, spp: u32) -> SampleMean {
    values(&picture(scene, &square(method, 16, spp))).scaled(luminance_per_value(&scene.camera))
}

#[test]
fn light_falls_off_with_the_inverse_square_without_a_radius() {
    for distance in [0.2_f64, 0.5, 3.0, 9.0] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(light(Emitter::Point, Output::Candela(100.0), Vec3::Z * distance as f32));
        let ours = illuminance(&scene, &square(Method::Direct, 4, 4)).mean;
        // The wrong formula with a radius of 10 m: (1 - d4 / r4) clamped, over d2 + 1.
        let wrong = 100.0 * (1.0 - (distance / 10.0).powi(4)).clamp(0.0, 1.0) / (distance * distance + 1.0);
        assert_distinguishes(ours, 100.0 / (distance * distance), wrong, 1e-3, &format!("{distance} m"));
        // The wrong clamp near the light: 1 / max(d, 1)2.
        let clamped = 100.0 / distance.max(1.0).powi(2);
        assert!(distance > 1.0 || (clamped - ours).abs() > 0.5 * ours);
    }
}

#[test]
fn equal_cone_angles_give_a_hard_edge_without_division_by_zero() {
    let (inner, outer) = (40.0_f32, 40.0_f32);
    let wrong = |angle_deg: f32| (angle_deg * 2.0 - outer) / (inner - outer);
    assert!(!wrong(20.0).is_finite() && !wrong(10.0).is_finite());
    for (angle_deg, fraction) in [(0.0_f32, 1.0), (19.9, 1.0), (20.1, 0.0), (90.0, 0.0), (180.0, 0.0)] {
        assert_eq!(cone_falloff(angle_deg.to_radians().cos(), inner, outer), fraction, "{angle_deg} degrees");
    }
    let solid_angle = f64::from(cone_solid_angle_sr(inner, outer));
    assert!((solid_angle - 2.0 * PI * (1.0 - 20_f64.to_radians().cos())).abs() < 1e-6, "{solid_angle}");
}

/// Returns the reflectance of a polished plate under an even surround of 1000 lx, seen under an angle.
fn reflectance(material: Material, angle_deg: f64) -> f64 {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let plate = object("Plate", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, material, Vec3::ZERO, Vec3::ZERO);
    let surround = light(Emitter::Surround, Output::Lux(1000.0), Vec3::Y);
    let camera = camera(Vec3::new(sin as f32, cos as f32, 0.0) * 2.0, Vec3::ZERO);
    let scene = Scene { objects: vec![plate], lights: vec![surround], camera, ..Scene::default() };
    luminance(&scene, Method::Path, 64).mean * PI / 1000.0
}

#[test]
fn the_specular_reflectance_of_plastic_follows_from_its_index_of_refraction() {
    let black = Material { base_color: [0.0; 3], roughness: 0.0, ior: 1.5, ..Material::default() };
    for (angle_deg, wrong_f0) in [(0.0_f64, 0.5), (60.0, 0.5), (80.0, 0.5)] {
        let (s, p) = studio::closed_forms::fresnel(angle_deg.to_radians(), 1.5);
        let wrong = wrong_f0 + (1.0 - wrong_f0) * (1.0 - angle_deg.to_radians().cos()).powi(5);
        assert_distinguishes(
            reflectance(black.clone(), angle_deg),
            0.5 * (s + p),
            wrong,
            0.01,
            &format!("{angle_deg} degrees"),
        );
    }
}

#[test]
fn fresnel_uses_the_angle_to_the_half_vector() {
    // A rough black plate, light from 80 degrees on the left, camera 80 degrees on the right: reflecting microfacets
    // are level. Light from above: microfacets of 40 degrees. With the angle to the normal, F would be equal in both.
    let black = Material { base_color: [0.0; 3], roughness: 0.6, ior: 1.5, ..Material::default() };
    let seen = |light_deg: f64| {
        let plate = object("Plate", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, black.clone(), Vec3::ZERO, Vec3::ZERO);
        let at = |deg: f64| Vec3::new(deg.to_radians().sin() as f32, deg.to_radians().cos() as f32, 0.0) * 50.0;
        let light_source = light(Emitter::Point, Output::Candela(1e6), at(light_deg));
        let scene = Scene {
            objects: vec![plate],
            lights: vec![light_source],
            camera: camera(at(80.0), Vec3::ZERO),
            ..Scene::default()
        };
        luminance(&scene, Method::Direct, 4).mean
    };
    // GGX with Smith masking, with F of the half vector or of the normal (Walter et al. 2007, Heitz 2014).
    let model = |light_deg: f64, half_vector: bool| {
        let alpha2 = 0.36_f64 * 0.36;
        let (l, v) = (light_deg.to_radians(), 80_f64.to_radians());
        let (half, between) = (0.5 * (l + v), 0.5 * (v - l).abs());
        let d = alpha2 / (PI * (half.cos().powi(2) * (alpha2 - 1.0) + 1.0).powi(2));
        let lambda = |a: f64| 0.5 * ((1.0 + alpha2 * a.tan().powi(2)).sqrt() - 1.0);
        let g = 1.0 / (1.0 + lambda(l) + lambda(v));
        let (s, p) = studio::closed_forms::fresnel(if half_vector { between } else { v }, 1.5);
        0.5 * (s + p) * d * g / (4.0 * v.cos()) * 1e6 / 2500.0
    };
    for light_deg in [0.0, -80.0, 40.0] {
        let (reference, wrong) = (model(light_deg, true), model(light_deg, false));
        if light_deg == -80.0 {
            // Both angles are 80 degrees here: both formulas agree.
            assert!((seen(light_deg) / reference - 1.0).abs() < 0.01);
        } else {
            assert_distinguishes(seen(light_deg), reference, wrong, 0.01, &format!("light at {light_deg} degrees"));
        }
    }
}

#[test]
fn the_half_vector_is_normalised() {
    // An unnormalised half vector weakens the highlight as the angle between light and viewer grows.
    let black = Material { base_color: [0.0; 3], roughness: 0.5, ior: 1.5, ..Material::default() };
    for apart_deg in [0.0_f64, 60.0, 120.0] {
        let half = 0.5 * apart_deg.to_radians();
        let at = |side: f64| Vec3::new((half.sin() * side) as f32, half.cos() as f32, 0.0) * 50.0;
        let plate = object("Plate", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, black.clone(), Vec3::ZERO, Vec3::ZERO);
        let light_source = light(Emitter::Point, Output::Candela(1e6), at(-1.0));
        let scene = Scene {
            objects: vec![plate],
            lights: vec![light_source],
            camera: camera(at(1.0), Vec3::ZERO),
            ..Scene::default()
        };
        let ours = luminance(&scene, Method::Direct, 4).mean;
        let model = |cos_normal_half: f64| {
            let alpha2 = 0.0625_f64;
            let d = alpha2 / (PI * (cos_normal_half.powi(2) * (alpha2 - 1.0) + 1.0).powi(2));
            let lambda = 0.5 * ((1.0 + alpha2 * half.tan().powi(2)).sqrt() - 1.0);
            let (s, p) = studio::closed_forms::fresnel(half, 1.5);
            0.5 * (s + p) * d / (1.0 + 2.0 * lambda) / (4.0 * half.cos()) * 1e6 / 2500.0
        };
        // Level microfacets: the cosine is 1; without normalisation it is the cosine of half the angle between.
        let (reference, wrong) = (model(1.0), model(half.cos()));
        if apart_deg > 0.0 {
            assert_distinguishes(ours, reference, wrong, 0.01, &format!("{apart_deg} degrees apart"));
        } else {
            assert!((ours / reference - 1.0).abs() < 0.01, "{ours} for {reference}");
        }
    }
}

#[test]
fn specular_and_diffuse_lobes_conserve_energy() {
    // A white dielectric reflects all light at every angle. A diffuse lobe of (1 - F) beside a specular lobe of F does
    // so in the mean at best; a diffuse lobe of 1 creates energy.
    let white = Material { base_color: [0.999; 3], roughness: 0.0, ior: 1.5, ..Material::default() };
    for angle_deg in [0.0_f64, 60.0, 80.0] {
        let (s, p) = studio::closed_forms::fresnel(angle_deg.to_radians(), 1.5);
        let fresnel = 0.5 * (s + p);
        // k_d = 1 - k_s without internal diffuse reflection: (1 - F) enters, and 9.2 % is lost inside.
        let darker = fresnel + (1.0 - fresnel) * (1.0 - 0.092);
        let ours = reflectance(white.clone(), angle_deg);
        assert!((ours - 0.999).abs() < 0.006, "{angle_deg} degrees: {ours}");
        assert!((1.0 + fresnel - 0.999) > 0.02, "a diffuse lobe of 1");
        assert!(angle_deg > 70.0 || (darker - 0.999_f64).abs() > 0.03, "a diffuse lobe without internal reflection");
    }
}

#[test]
fn a_camera_inside_a_box_sees_the_box() {
    // A test by sign(tmin) == sign(tmax) misses every box around the camera.
    let room = Room { size_m: Vec3::splat(4.0), ..Room::default() };
    let mut scene =
        Scene { room: Some(room), camera: camera(Vec3::Y * 2.0, Vec3::new(1.0, 2.0, 0.0)), ..Scene::default() };
    // One light on each side of the slab, so that neither side is in shadow.
    for (id, z) in [(0, 1.5), (1, -0.5)] {
        let light_source = light(Emitter::Point, Output::Lumens(1e4), Vec3::new(-1.0, 2.5, z));
        scene.lights.push(Light { id: LightId(id), name: format!("Lamp {id}"), ..light_source });
    }
    assert!(luminance(&scene, Method::Direct, 4).mean > 1.0);
    // Rays along an axis in the plane of a face: 0 * (1/0) in the slab test.
    let slab = object(
        "Slab",
        Shape::Box { size_m: Vec3::new(1.0, 4.0, 1.0) },
        Material::default(),
        Vec3::new(1.4, 2.0, 0.5),
        Vec3::ZERO,
    );
    scene.objects.push(slab);
    for z in [0.0_f32, 1.0, 0.5] {
        scene.camera = camera(Vec3::new(-1.0, 2.0, z), Vec3::new(1.0, 2.0, z));
        let film = picture(&scene, &square(Method::Direct, 9, 4));
        assert!(film.rgb.iter().all(|p| p[1] > 0.0), "a ray along a face at z = {z} sees nothing");
    }
}

#[test]
fn shadow_rays_do_not_depend_on_a_fixed_epsilon() {
    // A cover over a card with a small gap: with an epsilon of 1e-3 m, a shadow ray from a card 0.5 mm below starts
    // beyond the cover, and light leaks through.
    for gap in [1.0_f32, 1e-2, 5e-4, 2e-5] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        let cover = Shape::Plane { width_m: 3.0, depth_m: 3.0 };
        scene.objects.push(object("Cover", cover, Material::default(), Vec3::Z * gap, Vec3::X * 90.0));
        // The camera is in the gap and sees the card alone.
        scene.camera.position = Vec3::new(0.02, 0.0, gap * 0.5);
        scene.camera.focal_length_mm = 24.0;
        scene.lights.push(light(Emitter::Point, Output::Lumens(1e6), Vec3::Z * 2.0));
        let covered = illuminance(&scene, &square(Method::Direct, 8, 16)).mean;
        let fixed_epsilon = 1e-3;
        assert!(gap > fixed_epsilon || covered == 0.0, "{covered} lx leak through a cover {gap} m above");
        assert_eq!(covered, 0.0, "{covered} lx leak through a cover {gap} m above");
    }
}

#[test]
fn the_near_field_of_a_softbox_differs_from_a_clamped_point_light() {
    // 90 x 120 cm at half a metre: 523.91 lx of 1000 lm. As a point 1273, as a point with 1/max(d, 1)2 318.
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    let softbox = Emitter::RectPanel { width_m: 0.9, height_m: 1.2 };
    scene.lights.push(light(softbox, Output::Lumens(1000.0), Vec3::Z * 0.5));
    let ours = illuminance(&scene, &square(Method::Direct, 16, 64)).mean;
    let axial = 1000.0 / PI;
    for wrong in [axial / 0.25, axial, axial / (0.25 + 1.0)] {
        assert_distinguishes(ours, 523.91, wrong, 2e-3, "half a metre before a softbox");
    }
}

/// Returns the mean illuminance of the walls of a 4 m cube with 10 000 lm in it. Six views of 90 degrees show each wall
/// as a square whose pixels are equal areas; each of eight seeds is an independent mean over all walls.
fn cube_illuminance(reflectance: f32, method: Method, max_depth: Option<u32>) -> SampleMean {
    let paint = Material { base_color: [reflectance; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    let room = Room { size_m: Vec3::splat(4.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
    let light_source = light(Emitter::Point, Output::Lumens(10_000.0), Vec3::new(0.3, 2.2, 0.1));
    let mut scene = Scene { room: Some(room), lights: vec![light_source], ..Scene::default() };
    let centre = Vec3::Y * 2.0;
    SampleMean::of((0..8).map(|seed| {
        let views = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|direction| {
            scene.camera = Camera { focal_length_mm: 12.0, ..camera(centre, centre + direction) };
            values(&picture(&scene, &Settings { seed, max_depth, ..square(method, 8, 16) })).mean
        });
        views.iter().sum::<f64>() / 6.0 * luminance_per_value(&scene.camera) * PI / f64::from(reflectance)
    }))
}

/// Returns true within five standard errors of eight means: false alarms are 1 in 600, with seven degrees of freedom.
fn is_within_error(ours: SampleMean, reference: f64) -> bool {
    (ours.mean - reference).abs() < 5.0 * ours.standard_error
}

#[test]
fn the_path_depth_suffices_for_white_rooms() {
    // light_and_camera.md: F / (S (1 - r)). A room of albedo 0.95 has 20 times the direct light: 34 % of it within
    // depth 8, 96 % within depth 64.
    for reflectance in [0.2, 0.5, 0.8, 0.9, 0.95] {
        let reference = 10_000.0 / 96.0 / (1.0 - f64::from(reflectance));
        let ours = cube_illuminance(reflectance, Method::Path, None);
        assert!(
            ours.standard_error < 0.007 * reference && is_within_error(ours, reference),
            "r = {reflectance}: {ours:?} for {reference}"
        );
        if reflectance == 0.95 {
            for depth in [8, 64] {
                let fraction = 1.0 - 0.95_f64.powi(depth);
                let cut = cube_illuminance(reflectance, Method::Path, Some(depth as u32));
                assert!(
                    is_within_error(cut, fraction * reference),
                    "{depth} bounces: {cut:?} for {}",
                    fraction * reference
                );
                assert!(!is_within_error(ours, fraction * reference), "{depth} bounces would pass");
            }
        }
    }
}

#[test]
fn the_direct_method_omits_indirect_light_alone() {
    // README, "where each method fails": in a closed room `direct` shows 1 - r of the light.
    for reflectance in [0.5_f32, 0.8] {
        let whole = 10_000.0 / 96.0 / (1.0 - f64::from(reflectance));
        let ours = cube_illuminance(reflectance, Method::Direct, None);
        assert!(is_within_error(ours, whole * f64::from(1.0 - reflectance)), "r = {reflectance}: {ours:?}");
    }
}

#[test]
fn photons_focus_a_point_light_through_a_glass_ball() {
    // README, "where each method fails": without photons, shadow rays of a point light go straight through curved
    // glass. A real caustic at the focus of a ball is many times brighter than the direct light; this approximation
    // transmits what two faces do, 4 % less each. With photons, a ball lens has f = n R / (2 (n - 1)) = 15 cm from its
    // centre, so the light at 2.6 m is in focus 15.92 cm behind it. At 40 cm the beam is 0.4 / 0.1592 - 1 = 1.513 times
    // as wide as at the ball. The card is 1 cm beside the axis, where light from all around meets after reflections
    // inside of the ball: a bright point.
    let mut scene = wide_meter_card(Vec3::X * 0.01, Vec3::Z);
    scene.lights.push(light(Emitter::Point, Output::Lumens(1e4), Vec3::Z * 3.0));
    let open = illuminance(&scene, &square(Method::Path, 4, 16)).mean;
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.5, ..Material::default() };
    scene.objects.push(object("Ball", Shape::Sphere { radius_m: 0.1 }, glass, Vec3::Z * 0.4, Vec3::ZERO));
    let ours = illuminance_by_paths(&scene, &square(Method::Path, 4, 64)).mean / open;
    let pane = studio::closed_forms::pane(0.0, 1.5);
    assert!((ours - pane).abs() < 0.01, "{ours} of the direct light for {pane}");
    scene.objects[0].shape = Shape::Plane { width_m: 0.3, depth_m: 0.3 };
    let SampleMean { mean, standard_error: error } = illuminance_over(20, &scene, &square(Method::Path, 4, 64));
    let lens = (3.0 / 2.6 / 1.513_f64).powi(2) * 0.96_f64.powi(2);
    let ours = mean / open;
    assert!((ours / lens - 1.0).abs() < 0.04 && error / mean < 0.01, "{ours} of the direct light for {lens}, {error}");
}

#[test]
fn whitted_treats_a_softbox_as_a_point_with_hard_shadows() {
    // README, "where each method fails": 60 x 90 cm at half a metre are 729.52 lx; a point at the centre gives 1273.24,
    // 0.8 stops more. With half of the softbox occluded, it gives all or nothing.
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    scene.lights.push(light(softbox, Output::Lumens(1000.0), Vec3::Z * 0.5));
    let whitted = |scene: &Scene| illuminance(scene, &square(Method::Whitted, 4, 4)).mean;
    let unoccluded = whitted(&scene);
    assert!((unoccluded / 1273.24 - 1.0).abs() < 0.01, "{unoccluded} lx");
    assert!(((unoccluded / 729.52).log2() - 0.80).abs() < 0.02);
    for (edge, fraction) in [(-0.01_f32, 1.0), (0.01, 0.0)] {
        // A blade halfway, its edge one centimetre beside the axis.
        let mut half = scene.clone();
        let blade = Shape::Plane { width_m: 2.0, depth_m: 2.0 };
        let at = Vec3::new(edge - 1.0, 0.0, 0.25);
        half.objects.push(object("Blade", blade, Material::default(), at, Vec3::X * 90.0));
        assert!((whitted(&half) / unoccluded - fraction).abs() < 0.01, "blade to {edge}: {}", whitted(&half));
        // The exact fraction is about a half.
        let soft = illuminance(&half, &square(Method::Direct, 8, 64)).mean / 729.52;
        assert!((soft - 0.5).abs() < 0.1, "blade to {edge}: {soft}");
    }
}
