//! Light through flat glass and water against Fresnel's equations and the Beer-Lambert law, summed independently, in
//! every method that models it. Which technique brings which light: `raytrace/straight_path.rs`.

use crate::studio;
use crate::studio::closed_forms::fresnel;
use crate::studio::light;
use crate::studio::measure::{
    film_with, illuminance, illuminance_by_paths, illuminance_over, lux_per_value, square, values, wide_meter_card,
};
use crate::studio::statistics::SampleMean;
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, Method, RenderControl, Settings};
use catchlight::scene::{
    Aim, Assets, Emitter, Light, Material, Mesh, MeshPart, Object, ObjectId, Output, Scene, Shape, Transform,
};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const GLASS: f64 = 1.52;
const WATER: f64 = 1.33;
const THICKNESS: f64 = 0.004;

fn clear(ior: f64) -> Material {
    Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: ior as f32, ..Material::default() }
}

fn thing(name: &str, shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    let transform = Transform { position, rotation_deg, ..Transform::default() };
    Object { material, transform, ..studio::object(name, shape, position) }
}

/// A flat body of glass: where it is before the card, and how it is tilted, about X or about Y.
#[derive(Clone, Copy, Debug)]
struct Pane {
    z: f32,
    tilt_deg: f32,
    about_y: bool,
}

const fn pane(z: f32, tilt_deg: f32) -> Pane {
    Pane { z, tilt_deg, about_y: false }
}

impl Pane {
    /// A little wider than the light of a card, as photons start everywhere on it; total reflection at its narrow sides
    /// misses the card.
    fn object(&self, id: u32) -> Object {
        let long = 0.16 / self.tilt_deg.to_radians().cos();
        let (size, turn) = if self.about_y {
            (Vec3::new(long, 0.16, THICKNESS as f32), Vec3::Y * self.tilt_deg)
        } else {
            (Vec3::new(0.16, long, THICKNESS as f32), Vec3::X * self.tilt_deg)
        };
        let id = ObjectId(100 + id);
        let name = format!("Pane {}", id.0);
        let pane = thing(&name, Shape::Box { size_m: size }, clear(GLASS), Vec3::Z * self.z, turn);
        Object { id, ..pane }
    }

    fn normal(&self) -> DVec3 {
        let (sin, cos) = f64::from(self.tilt_deg).to_radians().sin_cos();
        if self.about_y { DVec3::new(sin, 0.0, cos) } else { DVec3::new(0.0, -sin, cos) }
    }
}

/// Transmittance for light along Z: each pane with all its inner reflections, its polarisation carried to the next by
/// Jones matrices of both linear polarisations.
fn transmittance(panes: &[Pane]) -> f64 {
    // The mean over two orthogonal incoming fields; the inner reflections of a pane have no fixed phase, which leaves
    // the square root of its transmittance as its amplitude, as all panes here share a plane of incidence or are alike.
    let mut mean = 0.0;
    for start in [DVec3::X, DVec3::Y] {
        let mut field = start;
        for pane in panes {
            let normal = pane.normal();
            let s = DVec3::Z.cross(normal).try_normalize().unwrap_or(DVec3::X);
            let p = DVec3::Z.cross(s);
            let (rs, rp) = fresnel(normal.z.acos(), GLASS);
            let (ts, tp) = ((1.0 - rs) / (1.0 + rs), (1.0 - rp) / (1.0 + rp));
            field = s * field.dot(s) * ts.sqrt() + p * field.dot(p) * tp.sqrt();
        }
        mean += 0.5 * field.length_squared();
    }
    mean
}

/// Transmittance of parallel panes with all reflections between all faces: the pile of plates (Stokes 1862).
fn pile(count: usize, angle_deg: f64) -> f64 {
    let (rs, rp) = fresnel(angle_deg.to_radians(), GLASS);
    let faces = 2.0 * count as f64;
    let of = |r: f64| (1.0 - r) / (1.0 + (faces - 1.0) * r);
    0.5 * (of(rs) + of(rp))
}

/// Illuminance of a card that faces +Z by a point light of 1 cd at this distance on its axis, through a tilted pane:
/// the refracted path and those with inner reflections, each with its own angle and spreading, solved by bisection.
fn point_through_pane(distance: f64, tilt_deg: f64) -> f64 {
    let tilt = tilt_deg.to_radians();
    let (along, across) = (distance * tilt.cos(), distance * tilt.sin());
    let refracted = |i: f64| (i.sin() / GLASS).asin();
    let mut sum = 0.0;
    for order in 0..40 {
        let inside = f64::from(2 * order + 1) * THICKNESS;
        let offset = |i: f64| i.tan() * (along - THICKNESS) + refracted(i).tan() * inside;
        let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2 - 1e-9);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if offset(middle) < across { low = middle } else { high = middle }
        }
        let i = 0.5 * (low + high);
        let step = 1e-5_f64.min(0.5 * (std::f64::consts::FRAC_PI_2 - i));
        let tangential = i.cos() * (offset(i + step) - offset(i - step)) / (2.0 * step);
        let sagittal = if i > 1e-6 { offset(i) / i.sin() } else { along - THICKNESS + inside / GLASS };
        let (rs, rp) = fresnel(i, GLASS);
        let of = |r: f64| (1.0 - r).powi(2) * r.powi(2 * order);
        sum += 0.5 * (of(rs) + of(rp)) * (i - tilt).cos() / (tangential * sagittal).abs();
    }
    sum
}

/// A way to read the illuminance of the card.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reading {
    Photons(Method),
    Paths,
    Whitted,
    Meter,
}

const READINGS: [Reading; 5] = [
    Reading::Photons(Method::Path),
    Reading::Photons(Method::Direct),
    Reading::Paths,
    Reading::Whitted,
    Reading::Meter,
];

/// A card of 5 cm, which the photons of reflections need.
fn card() -> Scene {
    let mut scene = wide_meter_card(Vec3::ZERO, Vec3::Z);
    scene.objects[0].shape = Shape::Plane { width_m: 0.05, depth_m: 0.05 };
    scene.objects[0].material.base_color = [0.18; 3];
    scene
}

fn read(scene: &Scene, reading: Reading, spp: u32) -> SampleMean {
    match reading {
        Reading::Photons(method) => illuminance_over(6, scene, &square(method, 8, spp)),
        Reading::Paths => illuminance_by_paths(scene, &square(Method::Path, 8, spp)),
        Reading::Whitted => illuminance(scene, &square(Method::Whitted, 4, 1)),
        Reading::Meter => {
            let mut scene = scene.clone();
            scene.objects.remove(0);
            let point = MeterPoint { position: Vec3::ZERO, facing: Vec3::Z, receptor: Receptor::Flat };
            let meter = LightMeter::new(&scene, &Assets::default(), Vec3::ZERO).unwrap();
            let result = meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap();
            let of_light = &result.reading.lights[0];
            let mean = f64::from(of_light.direct + of_light.bounced);
            SampleMean { mean, standard_error: f64::from(of_light.standard_error) }
        }
    }
}

/// Lights of about the same illuminance, on the axis of the card.
fn sun(angular_diameter_deg: f32) -> Light {
    let aim = Aim::Angles { yaw_deg: 0.0, pitch_deg: 0.0 };
    Light { aim, ..light(Emitter::Sun { angular_diameter_deg }, Output::Lux(1000.0), Vec3::Z * 2.0) }
}

fn at_two_metres(emitter: Emitter) -> Light {
    light(emitter, Output::Lumens(12_566.37), Vec3::Z * 2.0)
}

/// Reads the card through panes in each way and compares with the illuminance without panes times a factor.
fn check(story: &str, light: &Light, panes: &[Pane], factor: f64, readings: &[Reading], bias: f64) {
    // Reflections between panes come by photons, whose radius is small after many samples.
    let spp = if panes.len() == 1 { 8 } else { 64 };
    let mut scene = card();
    scene.lights.push(light.clone());
    let mut failures = Vec::new();
    for &reading in readings {
        let open = Scene { objects: vec![scene.objects[0].clone()], ..scene.clone() };
        let open = if reading == Reading::Paths {
            read(&open, Reading::Photons(Method::Path), 64)
        } else {
            read(&open, reading, 64)
        };
        let mut glazed = scene.clone();
        glazed.objects.extend((0..).zip(panes).map(|(id, pane)| pane.object(id)));
        let through = read(&glazed, reading, spp);
        let truth = open.mean * factor;
        // The meter's photons may miss what two bodies reflect between them.
        let bias = if reading == Reading::Meter && panes.len() > 1 { 7e-3_f64.max(bias) } else { bias };
        let error = 100.0 * (through.mean / truth - 1.0);
        if !through.agrees_with(truth, bias, 60) || through.standard_error > 0.01 * open.mean {
            failures.push(format!("{reading:?}: {through:?} for {truth} lx, {error:+.2} %"));
        }
    }
    assert!(failures.is_empty(), "{story}:\n{}", failures.join("\n"));
}

#[test]
fn a_point_light_through_a_pane_at_every_angle_has_refracted_path_and_inner_reflections_once() {
    for tilt in [0.0_f32, 20.0, 40.0, 60.0, 74.0, 80.0, 85.0] {
        let factor = point_through_pane(2.0, f64::from(tilt)) * 4.0;
        let spot = Emitter::Spot { inner_deg: 20.0, outer_deg: 30.0 };
        check(&format!("point at {tilt}"), &at_two_metres(Emitter::Point), &[pane(0.5, tilt)], factor, &READINGS, 2e-3);
        let path = [Reading::Photons(Method::Path)];
        check(&format!("spot at {tilt}"), &at_two_metres(spot), &[pane(0.5, tilt)], factor, &path, 2e-3);
    }
}

#[test]
fn a_sharp_sun_passes_stacks_of_panes_at_equal_and_unequal_tilts() {
    let stacks: [&[Pane]; 5] = [
        &[pane(1.0, 74.0)],
        &[pane(1.0, 0.0), pane(2.0, 5.0)],
        &[pane(1.0, 60.0), pane(2.0, -50.0), pane(3.0, 20.0)],
        &[pane(1.0, 60.0), Pane { about_y: true, ..pane(2.0, 60.0) }],
        &[pane(0.6, 8.0), pane(1.2, -5.0), pane(1.8, 12.0), pane(2.4, 4.0), pane(3.0, -9.0)],
    ];
    for panes in stacks {
        check(&format!("{panes:?}"), &sun(0.0), panes, transmittance(panes), &READINGS, 2e-3);
    }
}

#[test]
fn parallel_panes_transmit_as_a_pile_of_plates() {
    // So close that the light reflected between them reaches the card.
    for (count, tilt) in [(2, 0.0_f32), (2, 60.0), (2, 74.0), (3, 60.0), (5, 45.0)] {
        let panes: Vec<Pane> =
            (0..count).map(|i| pane(1.0 + 0.006 * i as f32 / tilt.to_radians().cos(), tilt)).collect();
        check(&format!("{count} panes at {tilt}"), &sun(0.0), &panes, pile(count, f64::from(tilt)), &READINGS, 3e-3);
    }
}

#[test]
fn small_and_large_lights_pass_panes_that_are_not_parallel() {
    let panes = [pane(0.5, 40.0), pane(1.2, -30.0)];
    let readings = [Reading::Photons(Method::Path), Reading::Photons(Method::Direct), Reading::Paths, Reading::Meter];
    check("sun of 0.53 degrees", &sun(0.53), &panes, transmittance(&panes), &readings, 2e-3);
    // Two panes bring the bulb nearer by some 4 mm of 2 m.
    let bulb = at_two_metres(Emitter::Sphere { radius_m: 0.005 });
    check("bulb of 1 cm", &bulb, &panes, transmittance(&panes), &readings, 6e-3);
    let softbox = at_two_metres(Emitter::RectPanel { width_m: 0.05, height_m: 0.05 });
    check("panel of 5 cm", &softbox, &panes, transmittance(&panes), &readings, 6e-3);
}

/// A card under a tank of clear bodies, seen from above; `direct` leaves out what card and faces throw on each other.
fn under_water(bodies: &[(f64, f32, f32)], sun_deg: f32) -> Scene {
    let mut scene = wide_meter_card(Vec3::ZERO, Vec3::Z);
    scene.objects[0].shape = Shape::Plane { width_m: 0.3, depth_m: 0.3 };
    for (id, &(ior, low, high)) in (0..).zip(bodies) {
        let size_m = Vec3::new(0.36 - 0.01 * id as f32, 0.36 - 0.01 * id as f32, high - low);
        let body =
            thing(&format!("Body {id}"), Shape::Box { size_m }, clear(ior), Vec3::Z * 0.5 * (low + high), Vec3::ZERO);
        scene.objects.push(Object { id: ObjectId(200 + id), ..body });
    }
    // Light that enters by the side would be guided to the card by total reflection.
    let black = Material { base_color: [0.0; 3], ior: 1.0, ..Material::default() };
    let size_m = Vec3::new(0.5, 0.01, 0.06);
    let wall = thing("Wall", Shape::Box { size_m }, black, Vec3::new(0.0, 0.186, 0.019), Vec3::ZERO);
    scene.objects.push(Object { id: ObjectId(300), ..wall });
    let aim = Aim::Angles { yaw_deg: 0.0, pitch_deg: -sun_deg };
    scene.lights.push(Light { aim, ..sun(0.0) });
    scene
}

#[test]
fn a_sharp_sun_lights_what_lies_under_water_and_glass() {
    // The card is in the water, or in air under a pane that lies on or in the water. Irradiance is that of each face
    // in turn by both polarisations, at most one reflection counted: faces return less than 0.3 % here.
    let passed = |deg: f64, indices: &[f64]| {
        let sin = deg.to_radians().sin();
        let (mut s, mut p) = (1.0, 1.0);
        for pair in indices.windows(2) {
            let (rs, rp) = fresnel((sin / pair[0]).asin(), pair[1] / pair[0]);
            s *= 1.0 - rs;
            p *= 1.0 - rp;
        }
        0.5 * (s + p) * deg.to_radians().cos()
    };
    type Case<'a> = (&'a str, &'a [(f64, f32, f32)], &'a [f64]);
    let cases: [Case<'_>; 3] = [
        ("in water", &[(WATER, -0.01, 0.05)], &[1.0, WATER]),
        ("in water under glass", &[(WATER, -0.01, 0.05), (GLASS, 0.02, 0.03)], &[1.0, WATER, GLASS, WATER]),
        ("in glass", &[(GLASS, -0.01, 0.03)], &[1.0, GLASS]),
    ];
    for (story, bodies, indices) in cases {
        for deg in [0.0_f32, 6.0, 45.0] {
            let scene = under_water(bodies, deg);
            // The camera looks through the faces, too: radiance over n2, and at nearly normal incidence.
            let n = indices[indices.len() - 1];
            let seen = passed(0.0, &indices.iter().rev().copied().collect::<Vec<_>>()) / (n * n);
            let truth = 1000.0 * passed(f64::from(deg), indices) * seen;
            let reading = illuminance_over(8, &scene, &square(Method::Direct, 8, 64));
            assert!(reading.agrees_with(truth, 5e-3, 9), "{story} at {deg}: {reading:?} for {truth} lx");
            assert!(reading.standard_error < 0.015 * truth, "{story} at {deg}: {reading:?} says little");
        }
    }
}

#[test]
fn a_lamp_inside_of_coloured_glass_is_absorbed_by_the_glass() {
    // A bulb in the middle of a block of 10 cm that absorbs four fifths on the way to a face, 20 cm before the card.
    // Its image is nearer by refraction, and its light spreads into a solid angle n2 times as large; the reflection in
    // the back face brings another 0.2 %.
    let half = 0.05_f64;
    let per_m = 5.0_f64.ln() / half;
    let block = Material { absorption_per_m: [per_m as f32; 3], ..clear(GLASS) };
    let mut scene = wide_meter_card(Vec3::ZERO, Vec3::Z);
    scene.objects[0].shape = Shape::Plane { width_m: 0.3, depth_m: 0.3 };
    let shape = Shape::Box { size_m: Vec3::splat(2.0 * half as f32) };
    let block = thing("Block", shape, block, Vec3::Z * 0.25, Vec3::ZERO);
    scene.objects.push(Object { id: ObjectId(400), ..block });
    let passed = 1.0 - ((GLASS - 1.0) / (GLASS + 1.0)).powi(2);
    let image = |glass: f64| passed * (-per_m * glass).exp() / (glass + GLASS * 0.2).powi(2);
    let of_point = 1000.0 * (image(half) + (1.0 - passed) * image(3.0 * half));
    // The surface of a bulb is nearer to the face than its centre: the mean of exp(a s) over its disc
    let radius = 0.005;
    let a = per_m * radius;
    let nearer = 2.0 / (a * a) * (a.exp() * (a - 1.0) + 1.0);
    let bulb = Emitter::Sphere { radius_m: radius as f32 };
    for (emitter, truth) in [(Emitter::Point, of_point), (bulb, nearer * of_point)] {
        scene.lights = vec![light(emitter, Output::Lumens(12_566.37), Vec3::Z * 0.25)];
        let reading = illuminance_over(6, &scene, &square(Method::Direct, 8, 256));
        assert!(reading.agrees_with(truth, 1.5e-2, 2), "{emitter:?}: {reading:?} for {truth} lx");
        assert!(reading.standard_error < 0.1 * truth, "{emitter:?}: {reading:?} says little");
    }
}

/// A wedge with a flat top at `top` and a lower face that falls towards +Y by an angle, from `top - 0.02` at the
/// middle.
fn wedge(top: f32, tilt_deg: f32) -> Mesh {
    let half = 0.1;
    let fall = half * tilt_deg.to_radians().tan();
    let corner = |x: f32, y: f32| [Vec3::new(x, y, top), Vec3::new(x, y, top - 0.02 - fall * y / half)];
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| corner(x, y));
    let positions: Vec<Vec3> = corners.into_iter().flatten().collect();
    let (up, low) = (|i: u32| 2 * (i % 4), |i: u32| 2 * (i % 4) + 1);
    let mut triangles =
        vec![[up(0), up(1), up(2)], [up(0), up(2), up(3)], [low(0), low(2), low(1)], [low(0), low(3), low(2)]];
    for i in 0..4 {
        triangles.extend([[low(i), low(i + 1), up(i + 1)], [low(i), up(i + 1), up(i)]]);
    }
    let parts = vec![MeshPart { name: "Wedge".into(), triangles: 0..triangles.len() as u32 }];
    Mesh { positions, triangles, parts, ..Mesh::default() }
}

#[test]
fn a_wedge_bends_the_sun_and_compresses_its_light() {
    // Snell's law at the tilted lower face: the light turns by d = asin(n sin a) - a towards the thick side. A row of
    // rays is displaced by z tan d, where the face lies at z: the nearer the face, the less, so that the light is
    // denser by 1 / (1 - tan a tan d).
    let tilt = 10.0_f64.to_radians();
    let turn = (GLASS * tilt.sin()).asin() - tilt;
    let (rs, rp) = fresnel(tilt, 1.0 / GLASS);
    let passed = (1.0 - ((GLASS - 1.0) / (GLASS + 1.0)).powi(2)) * (1.0 - 0.5 * (rs + rp));
    let truth = 1000.0 * passed / (1.0 - tilt.tan() * turn.tan());
    let mut scene = card();
    scene.lights.push(sun(0.0));
    let file = Shape::MeshFile { path: "wedge.obj".into() };
    let wedge_object = thing("Wedge", file, clear(GLASS), Vec3::ZERO, Vec3::ZERO);
    scene.objects.push(Object { id: ObjectId(500), ..wedge_object });
    let mut assets = Assets::default();
    assets.insert_mesh("wedge.obj", Arc::new(wedge(0.3, 10.0)));
    for method in [Method::Path, Method::Direct] {
        let reading = |seed| {
            let settings = Settings { seed, ..square(method, 8, 64) };
            let picture = film_with(&scene, &assets, &settings).develop(&scene);
            values(&picture).scaled(lux_per_value(&scene.camera)).mean
        };
        let reading = SampleMean::of((0..24).map(reading));
        assert!(reading.agrees_with(truth, 5e-3, 3), "{method:?}: {reading:?} for {truth} lx");
        assert!(reading.standard_error < 0.015 * truth, "{method:?}: {reading:?} says little");
    }
    scene.objects.remove(0);
    let meter = LightMeter::new(&scene, &assets, Vec3::ZERO).unwrap();
    let point = MeterPoint { position: Vec3::ZERO, facing: Vec3::Z, receptor: Receptor::Flat };
    let result = meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap();
    let light = &result.reading.lights[0];
    let reading = SampleMean { mean: f64::from(light.sum()), standard_error: f64::from(light.standard_error) };
    assert!(reading.agrees_with(truth, 5e-3, 3), "meter: {reading:?} for {truth} lx");
    assert!(reading.standard_error < 0.02 * truth, "meter: {reading:?} says little");
}
