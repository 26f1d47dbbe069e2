//! Glass, mirrors and water against closed forms, measured in rendered pictures. Tolerances are standard errors of the
//! pixels, as in `analytic_light`.

use crate::studio;
use crate::studio::closed_forms::{fresnel, pane};
use crate::studio::light;
use crate::studio::measure::{
    BIAS, illuminance, illuminance_by_paths, illuminance_over, luminance_per_value, meter_card, picture, square,
    values, wide_meter_card,
};
use crate::studio::statistics::SampleMean;
use catchlight::photo::Picture;
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, Method, RenderControl};
use catchlight::scene::{Aim, Assets, Camera, Emitter, Material, Object, Output, Scene, Sensor, Shape, Transform};
use glam::Vec3;
use std::f64::consts::PI;

const LUMINANCE: f32 = 1000.0;

/// A card large enough for photons.
const WIDE_CARD: Shape = Shape::Plane { width_m: 0.3, depth_m: 0.3 };

fn glass(ior: f32) -> Material {
    Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior, ..Material::default() }
}

fn thing(name: &str, shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    let transform = Transform { position, rotation_deg, ..Transform::default() };
    Object { material, transform, ..studio::object(name, shape, position) }
}

/// A black wall that emits 1000 cd/m2, at normal incidence at `distance` before a camera with a tiny angle of view.
/// Half a metre wide: reflections in a tilted pane miss it.
fn glowing_wall(distance: f32) -> Scene {
    let black = Material { base_color: [0.0; 3], emission_cd_m2: [LUMINANCE; 3], ior: 1.0, ..Material::default() };
    let wall = thing("Wall", Shape::Plane { width_m: 0.5, depth_m: 0.5 }, black, Vec3::ZERO, Vec3::X * 90.0);
    let camera = Camera {
        position: Vec3::Z * distance,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 5000.0,
        ..Camera::default()
    };
    Scene { objects: vec![wall], camera, ..Scene::default() }
}

/// Luminance of the picture relative to the wall.
fn relative_luminance(scene: &Scene, side: u32, spp: u32) -> SampleMean {
    values(&picture(scene, &square(Method::Path, side, spp)))
        .scaled(luminance_per_value(&scene.camera) / f64::from(LUMINANCE))
}

#[test]
fn pane_transmittance_by_angle_is_the_mean_of_both_polarisations_with_all_inner_reflections() {
    // The four values of light_and_camera.md (n = 1.52: 0.918, 0.916, 0.844, 0.456), more angles and other glass.
    let table =
        [(0.0, 1.52, Some(0.918)), (30.0, 1.52, Some(0.916)), (60.0, 1.52, Some(0.844)), (80.0, 1.52, Some(0.456))];
    let more = [(45.0, 1.52, None), (70.0, 1.52, None), (60.0, 1.33, None), (50.0, 2.4, None), (75.0, 1.9, None)];
    for (deg, n, printed) in table.into_iter().chain(more) {
        let truth = pane(f64::to_radians(deg), f64::from(n));
        assert!(printed.is_none_or(|p: f64| (p - truth).abs() < 6e-4), "{deg}: {truth}");
        for sheet in [false, true] {
            let mut scene = glowing_wall(3.0);
            let (shape, turn) = if sheet {
                (Shape::Plane { width_m: 3.0, depth_m: 3.0 }, 90.0 + deg as f32)
            } else {
                (Shape::Box { size_m: Vec3::new(3.0, 3.0, 0.004) }, deg as f32)
            };
            scene.objects.push(thing("Pane", shape, glass(n), Vec3::Z * 1.5, Vec3::X * turn));
            let reading = relative_luminance(&scene, 32, 64);
            assert!(
                reading.agrees_with(truth, BIAS, 18),
                "{deg} degrees, n {n}, sheet {sheet}: {reading:?} for {truth}"
            );
            // Single interfaces that ignored polarisation would exceed the tolerance from 60 degrees on.
            let (s, p) = fresnel(f64::to_radians(deg), f64::from(n));
            let mean = 0.5 * (s + p);
            let forgetful = (1.0 - mean) / (1.0 + mean);
            assert!(
                deg < 59.0 || n < 1.4 || !reading.agrees_with(forgetful, BIAS, 18),
                "{deg}: {reading:?} says little"
            );
        }
    }
}

#[test]
fn a_point_light_through_a_pane_has_the_transmittance_of_the_pane() {
    for (deg, sheet) in [(0.0_f32, false), (50.0, false), (0.0, true), (70.0, true)] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::Z * 2.0));
        let open = illuminance(&scene, &square(Method::Direct, 8, 16)).mean;
        let (shape, turn) = if sheet {
            (Shape::Plane { width_m: 3.0, depth_m: 3.0 }, 90.0 + deg)
        } else {
            (Shape::Box { size_m: Vec3::new(3.0, 3.0, 0.004) }, deg)
        };
        scene.objects.push(thing("Pane", shape, glass(1.52), Vec3::Z, Vec3::X * turn));
        for method in [Method::Direct, Method::Path] {
            let reading = illuminance(&scene, &square(method, 8, 64));
            let truth = open * pane(f64::from(deg).to_radians(), 1.52);
            // The pane shifts the light's image by t (1 - 1/n) = 1.4 mm of 2 m: 0.14 %, which is ignored. The card
            // of 18 % and the pane light each other by far less.
            assert!(
                reading.agrees_with(truth, 2e-3, 8),
                "{deg} degrees, sheet {sheet}, {method:?}: {reading:?} for {truth} lx"
            );
        }
    }
}

#[test]
fn a_mirrored_light_has_the_illuminance_of_its_image() {
    // A card that faces up, a lamp 1 m above it and a mirror 1 m beside it, whose image of the lamp is 2 m away.
    let mirror = Material { metallic: 1.0, roughness: 0.0, base_color: [0.999; 3], ..Material::default() };
    let plane = Shape::Plane { width_m: 0.4, depth_m: 0.4 };
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.01 }, Emitter::Sun { angular_diameter_deg: 0.5 }] {
        let mut scene = wide_meter_card(Vec3::ZERO, Vec3::Y);
        scene.objects[0].shape = WIDE_CARD;
        scene.lights.push(light(emitter, Output::Lumens(1000.0), Vec3::Y));
        if let Emitter::Sun { .. } = emitter {
            scene.lights[0].power.output = Output::Lux(1000.0);
            scene.lights[0].aim = Aim::Angles { yaw_deg: -90.0, pitch_deg: -30.0 };
        }
        let settings = square(Method::Direct, 8, 64);
        let open = illuminance(&scene, &settings).mean;
        scene.objects.push(thing("Mirror", plane.clone(), mirror.clone(), Vec3::new(1.0, 0.5, 0.0), Vec3::Z * 90.0));
        let reading = illuminance_over(8, &scene, &settings);
        // The image is at (2, 1, 0): inverse square and cosine. The image of a sun is as bright as the sun.
        let image = if let Emitter::Sun { .. } = emitter { 1.0 } else { 5.0_f64.powf(-1.5) };
        assert!(
            reading.agrees_with(open * (1.0 + 0.999 * image), 1e-3, 3),
            "{emitter:?}: {reading:?} for {open} and {image} of it"
        );
        assert!(reading.standard_error < 0.05 * image * open, "{emitter:?}: {reading:?} says little");
    }
}

#[test]
fn a_softbox_behind_a_thin_pane_has_the_transmittance_of_the_pane_in_every_method() {
    for emitter in [Emitter::RectPanel { width_m: 0.3, height_m: 0.3 }, Emitter::Sphere { radius_m: 0.02 }] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(light(emitter, Output::Lumens(1000.0), Vec3::Z * 3.0));
        let open = illuminance(&scene, &square(Method::Direct, 16, 64)).mean;
        let pane_object =
            thing("Pane", Shape::Plane { width_m: 8.0, depth_m: 8.0 }, glass(1.52), Vec3::Z, Vec3::X * 90.0);
        scene.objects.push(pane_object);
        for method in [Method::Direct, Method::Path] {
            let reading = illuminance(&scene, &square(method, 16, 64));
            let truth = open * pane(0.0, 1.52);
            // Rays cross the pane at up to 4 degrees, where the transmittance is the same to 0.01 %.
            assert!(reading.agrees_with(truth, 1e-3, 4), "{emitter:?}, {method:?}: {reading:?} for {truth} lx");
        }
    }
}

#[test]
fn a_softbox_behind_thick_glass_is_found_by_refracted_rays() {
    // Refracted rays find an area light through a body of glass; light sampling must not count it again.
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    let panel = Emitter::RectPanel { width_m: 2.0, height_m: 2.0 };
    scene.lights.push(light(panel, Output::Lumens(1000.0), Vec3::Z * 1.5));
    let open = illuminance(&scene, &square(Method::Path, 16, 64)).mean;
    let shape = Shape::Box { size_m: Vec3::new(6.0, 6.0, 0.004) };
    scene.objects.push(thing("Pane", shape, glass(1.52), Vec3::Z * 0.7, Vec3::ZERO));
    let reading = illuminance(&scene, &square(Method::Path, 64, 64));
    // Within 43 degrees the pane passes between 0.918 and 0.906.
    assert!(reading.mean / open > 0.9 && reading.mean / open < 0.925, "{reading:?} of {open} lx");
    assert!(reading.standard_error / open < 0.005, "{reading:?} says little");
}

#[test]
fn nested_water_and_glass_reflect_at_each_interface_by_both_indices() {
    // A slab of 10 cm with another of 4 cm in it, at normal incidence. R of each face by the indices on both sides; the
    // transmittance is the sum over all inner reflections between four faces.
    let cases = [
        (1.5_f32, 1.5_f32, 0.0_f32, 0.0_f32),
        (1.5, 1.33, 0.0, 0.0),
        (1.5, 1.0, 0.0, 0.0),
        (1.33, 2.0, 5.0, 0.0),
        (1.5, 1.5, 5.0, 20.0),
    ];
    for (outer, inner, outer_per_m, inner_per_m) in cases {
        let mut scene = glowing_wall(3.0);
        let body = |ior, per_m: f32| Material { absorption_per_m: [per_m; 3], ..glass(ior) };
        for (name, material, size) in
            [("Outer", body(outer, outer_per_m), 0.1_f32), ("Inner", body(inner, inner_per_m), 0.04)]
        {
            let shape = Shape::Box { size_m: Vec3::new(2.0 + size, 2.0 + size, size) };
            scene.objects.push(thing(name, shape, material, Vec3::Z * 1.5, Vec3::ZERO));
        }
        // Equal materials share one entry of the tracer's table; the medium stack must tell both bodies apart.
        let r = |a: f32, b: f32| ((f64::from(a) - f64::from(b)) / (f64::from(a) + f64::from(b))).powi(2);
        let faces = [r(1.0, outer), r(outer, inner), r(inner, outer), r(outer, 1.0)];
        let gaps = [0.03 * outer_per_m, 0.04 * inner_per_m, 0.03 * outer_per_m].map(|a| f64::from(-a).exp());
        let truth = stack_transmittance(&faces, &gaps);
        let reading = relative_luminance(&scene, 32, 64);
        assert!(reading.agrees_with(truth, 1e-3, cases.len()), "{outer} with {inner} in it: {reading:?} for {truth}");
    }
}

/// Transmittance of parallel faces with these reflectances and transmittances of the gaps between them: adding one face
/// after the other (Stokes 1862).
fn stack_transmittance(faces: &[f64], gaps: &[f64]) -> f64 {
    let (mut through, mut back) = (1.0 - faces[0], faces[0]);
    for (face, gap) in faces[1..].iter().zip(gaps) {
        let echo = 1.0 - back * gap * gap * face;
        let next = through * gap * (1.0 - face) / echo;
        // Reflectance of the faces so far, from behind.
        back = face + (1.0 - face) * (1.0 - face) * gap * gap * back / echo;
        through = next;
    }
    through
}

#[test]
fn a_card_in_coloured_water_is_absorbed_along_half_of_the_tank() {
    // An emissive card in the middle of a tank: its light crosses half of the water and one face.
    let mut scene = glowing_wall(3.0);
    let water = Material { absorption_per_m: [4.0; 3], ..glass(1.33) };
    let shape = Shape::Box { size_m: Vec3::new(10.0, 10.0, 1.0) };
    scene.objects.push(thing("Water", shape, water, Vec3::ZERO, Vec3::ZERO));
    // Radiance that leaves water is divided by n2.
    let truth = (1.0 - (0.33 / 2.33_f64).powi(2)) * (-0.5 * 4.0_f64).exp() / 1.33_f64.powi(2);
    let reading = relative_luminance(&scene, 32, 64);
    assert!(reading.agrees_with(truth, 1e-3, 1), "{reading:?} for {truth}");
}

#[test]
fn a_camera_in_water_sees_at_most_the_radiance_of_the_surround() {
    // The camera has air around it: a uniform surround of 1 appears as 1 at most, inside a ball or a tank.
    for shape in [Shape::Sphere { radius_m: 1.0 }, Shape::Box { size_m: Vec3::splat(2.0) }] {
        let mut scene = studio::ball_in_even_light(glass(1.33));
        let open = values(&picture(&Scene { objects: Vec::new(), ..scene.clone() }, &square(Method::Path, 8, 4))).mean;
        scene.objects[0].shape = shape.clone();
        scene.camera.position = Vec3::new(0.1, 0.05, 0.2);
        scene.camera.aim = Aim::Point(Vec3::NEG_Z);
        scene.camera.focal_length_mm = 24.0;
        let reading = values(&picture(&scene, &square(Method::Path, 32, 64)));
        let ratio = SampleMean { mean: reading.mean / open, standard_error: reading.standard_error / open };
        assert!(ratio.agrees_with(1.0, 5e-3, 2), "{shape:?}: {ratio:?}");
    }
}

#[test]
fn a_slab_shifts_the_image_behind_it_by_snells_law() {
    // d = t sin(i) (1 - cos(i) / (n cos(r))) for a slab of thickness t under the angle i. The wall's edge is in the
    // middle of the picture, whose lit part moves with the edge.
    for (deg, n) in [(30.0_f64, 1.5_f64), (60.0, 1.52), (45.0, 1.33)] {
        let mut scene = glowing_wall(3.0);
        scene.objects[0].transform.position.x = 0.25;
        scene.camera.focal_length_mm = 1000.0;
        let width_m = 3.0 * 24.0 / 1000.0;
        let before = relative_luminance(&scene, 64, 16).mean;
        let thickness = 0.02;
        let shape = Shape::Box { size_m: Vec3::new(4.0, 4.0, thickness as f32) };
        // Rotated about Y; its far ends are outside of the picture.
        scene.objects.push(thing("Slab", shape, glass(n as f32), Vec3::Z * 1.5, Vec3::Y * deg as f32));
        let i = deg.to_radians();
        let after = relative_luminance(&scene, 64, 128).mean / pane(i, n);
        let r = (i.sin() / n).asin();
        let shift = thickness * i.sin() * (1.0 - i.cos() / (n * r.cos()));
        // Every pair of inner reflections repeats the edge, shifted back by 2 t tan(r) cos(i), with R2 of the light.
        let (s, p) = fresnel(i, n);
        let again = |face: f64| (1.0 - face) / (1.0 + face) * face * face / (1.0 - face * face);
        let ghosts = 0.5 * (again(s) + again(p)) / pane(i, n) * 2.0 * thickness * r.tan() * i.cos();
        let ours = ((after - before) * width_m).abs();
        // The edge is 0.2 degrees off the axis, which changes the angle of incidence: up to 1.5 %; sampling 0.5 %.
        let truth = shift - ghosts;
        assert!((ours / truth - 1.0).abs() < 0.03, "{deg} degrees: shifted by {ours} for {truth} m");
    }
}

#[test]
fn a_mirrored_softbox_is_at_the_angle_of_reflection_with_its_luminance() {
    // A mirror of reflectance 0.9 at 45 degrees; the panel is on the reflected axis and fills the view.
    let metal = Material { base_color: [0.9; 3], metallic: 1.0, roughness: 0.0, ..Material::default() };
    let mut scene = glowing_wall(3.0);
    scene.objects.clear();
    scene.objects.push(thing("Mirror", Shape::Plane { width_m: 1.0, depth_m: 1.0 }, metal, Vec3::ZERO, Vec3::X * 45.0));
    let (width_m, height_m) = (0.2, 0.2);
    let area = width_m * height_m;
    let panel =
        light(Emitter::RectPanel { width_m, height_m }, Output::Lumens(LUMINANCE * area * PI as f32), Vec3::Y * 2.0);
    scene.lights.push(panel);
    let reading = relative_luminance(&scene, 8, 16);
    let schlick = 0.9 + 0.1 * (1.0 - 45_f64.to_radians().cos()).powi(5);
    assert!(reading.agrees_with(schlick, 1e-4, 1), "{reading:?} for {schlick}");
    // The view is 24 mm wide on the panel: moved aside by 30 cm, the panel is outside of it.
    scene.lights[0].position.z = 0.3;
    scene.lights[0].aim = Aim::Point(Vec3::Z * 0.3);
    assert_eq!(relative_luminance(&scene, 8, 16).mean, 0.0);
}

#[test]
fn the_back_of_a_softbox_is_invisible_in_a_mirror() {
    let metal = Material { base_color: [0.9; 3], metallic: 1.0, roughness: 0.0, ..Material::default() };
    let mut scene = glowing_wall(3.0);
    scene.objects.clear();
    scene.objects.push(thing("Mirror", Shape::Plane { width_m: 1.0, depth_m: 1.0 }, metal, Vec3::ZERO, Vec3::X * 45.0));
    let mut panel = light(Emitter::RectPanel { width_m: 0.2, height_m: 0.2 }, Output::Lumens(100.0), Vec3::Y * 2.0);
    panel.aim = Aim::Point(Vec3::Y * 3.0);
    scene.lights.push(panel);
    assert_eq!(relative_luminance(&scene, 8, 4).mean, 0.0);
}

/// Returns the mean of each channel.
fn channels(picture: &Picture) -> [SampleMean; 3] {
    [0, 1, 2].map(|channel| SampleMean::of(picture.rgb.iter().map(|pixel| f64::from(pixel[channel]))))
}

#[test]
fn tinted_glass_gives_light_and_view_its_base_color_once_a_pane_and_once_a_body_in_every_method() {
    // The base color of clear glass was ignored: 0.5 and 0.99 rendered alike.
    let tint = [0.9, 0.5, 0.2];
    let tinted = Material { base_color: tint, ..glass(1.52) };
    for sheet in [true, false] {
        let (shape, turn) = if sheet {
            (Shape::Plane { width_m: 3.0, depth_m: 3.0 }, Vec3::X * 90.0)
        } else {
            (Shape::Box { size_m: Vec3::new(3.0, 3.0, 0.004) }, Vec3::ZERO)
        };
        let behind = |scene: &Scene, material: &Material, z: f32| {
            let mut scene = scene.clone();
            scene.objects.push(thing("Pane", shape.clone(), material.clone(), Vec3::Z * z, turn));
            scene
        };

        // The light of a point, on a card behind the glass, by each method
        let mut lit = meter_card(Vec3::ZERO, Vec3::Z);
        lit.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::Z * 2.0));
        let [clear, coloured] = [&glass(1.52), &tinted].map(|material| behind(&lit, material, 1.0));
        for method in [Method::Whitted, Method::Direct, Method::Path] {
            let settings = square(method, 8, 64);
            let [clear, coloured] = [&clear, &coloured].map(|scene| channels(&picture(scene, &settings)));
            for ((clear, coloured), tint) in clear.into_iter().zip(coloured).zip(tint) {
                let ratio = coloured.mean / clear.mean;
                // Both pictures have the same samples. The card and the pane light each other by less than 0.1 %.
                assert!((ratio / f64::from(tint) - 1.0).abs() < 2e-3, "sheet {sheet}, {method:?}: {ratio} for {tint}");
            }
        }
        let by_paths = [&clear, &coloured].map(|scene| illuminance_by_paths(scene, &square(Method::Path, 8, 64)).mean);
        assert!((by_paths[1] / by_paths[0] / 0.5 - 1.0).abs() < 2e-3, "sheet {sheet}, paths: green {by_paths:?}");
        let lux = [&clear, &coloured].map(|scene| {
            let meter = LightMeter::new(scene, &Assets::default(), Vec3::ZERO).unwrap();
            let point = MeterPoint { position: Vec3::ZERO, facing: Vec3::Z, receptor: Receptor::Flat };
            meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap().reading.lights[0].direct
        });
        let luminance = 0.2126 * tint[0] + 0.7152 * tint[1] + 0.0722 * tint[2];
        assert!((lux[1] / lux[0] / luminance - 1.0).abs() < 1e-4, "sheet {sheet}, meter: {lux:?}");

        // The view of a wall behind the glass
        let wall = behind(&glowing_wall(3.0), &tinted, 1.5);
        for method in [Method::Whitted, Method::Direct, Method::Path] {
            let relative = luminance_per_value(&wall.camera) / f64::from(LUMINANCE);
            for (reading, tint) in channels(&picture(&wall, &square(method, 16, 64))).into_iter().zip(tint) {
                let (reading, truth) = (reading.scaled(relative), pane(0.0, 1.52) * f64::from(tint));
                assert!(reading.agrees_with(truth, 2e-3, 18), "sheet {sheet}, {method:?}: {reading:?} for {truth}");
            }
        }
    }
}
