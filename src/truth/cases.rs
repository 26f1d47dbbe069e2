//! The set-ups of the table, each measured by the light meter or rendered.

use super::{TruthRow, closed_forms};
use crate::photo::exposure;
use crate::photo::meter::Receptor;
use crate::raytrace::{self, LightMeter, MeterEffort, MeterPoint, RenderControl, Settings};
use crate::scene::{
    Aim, Assets, Camera, Emitter, Light, LightId, Material, MaterialPreset, Object, Output, Room, Scene, Sensor, Shape,
    Transform,
};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Measures every case, in the order of the table.
pub(super) fn all() -> Vec<TruthRow> {
    let mut rows = Vec::new();
    rows.extend(bulbs());
    rows.extend(panels());
    rows.extend(cones());
    rows.extend(far_lights());
    rows.extend(receptors());
    rows.extend(closed_rooms());
    rows.extend(panes());
    rows.extend(white_metal());
    rows.extend(flash());
    rows.extend(pictures());
    rows
}

fn row(case: impl Into<String>, unit: &'static str, closed_form: f64, measured: f64, tolerance: f64) -> TruthRow {
    TruthRow { case: case.into(), unit, closed_form, measured, tolerance }
}

/// Returns a light at `position` that aims at `target`.
fn light(emitter: Emitter, output: Output, position: Vec3, target: Vec3) -> Light {
    Light { position, aim: Aim::Point(target), ..Light::new(emitter, output) }
}

fn object(shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    Object {
        transform: Transform { position, rotation_deg, ..Transform::default() },
        material,
        ..Object::new("Thing", shape)
    }
}

fn lit_by(light: Light) -> Scene {
    Scene { lights: vec![light], ..Scene::default() }
}

/// Returns the meter's total illuminance, lux; NaN if the scene can't be prepared.
fn lux(scene: &Scene, position: Vec3, facing: Vec3, receptor: Receptor, effort: &MeterEffort) -> f64 {
    let reading = LightMeter::new(scene, &Assets::default(), position)
        .ok()
        .and_then(|meter| meter.read(&MeterPoint { position, facing, receptor }, effort, &RenderControl::new()));
    reading.map_or(f64::NAN, |reading| f64::from(reading.reading.total_lux_s() / scene.camera.shutter_s))
}

fn flat(scene: &Scene, position: Vec3, facing: Vec3) -> f64 {
    lux(scene, position, facing, Receptor::Flat, &MeterEffort::default())
}

fn bulbs() -> Vec<TruthRow> {
    let over_floor = |beside: f32| {
        let scene = lit_by(light(Emitter::Point, Output::Lumens(10_000.0), Vec3::Y * 3.0, Vec3::ZERO));
        let case = format!("bulb of 10 000 lm 3 m over the floor, {beside} m beside");
        // No sampling error: rounding, and the receptor's height of 0.02 mm.
        row(
            case,
            "lx",
            closed_forms::bulb_over_floor(1e4, 3.0, beside.into()),
            flat(&scene, Vec3::X * beside, Vec3::Y),
            1e-4,
        )
    };
    vec![over_floor(0.0), over_floor(4.0)]
}

/// Four of the standard errors at which the meter stops, 0.15 %.
const SAMPLED: f64 = 0.006;

fn panels() -> Vec<TruthRow> {
    let rectangle = |width_m: f32, height_m: f32, distance: f32| {
        let emitter = Emitter::RectPanel { width_m, height_m };
        let scene = lit_by(light(emitter, Output::Lumens(1000.0), Vec3::Z * distance, Vec3::ZERO));
        let [w, h, d] = [width_m, height_m, distance].map(f64::from);
        let case = format!("softbox {:.0} x {:.0} cm at {distance} m", 100.0 * w, 100.0 * h);
        row(case, "lx", closed_forms::rectangle_on_axis(1000.0, w, h, d), flat(&scene, Vec3::ZERO, Vec3::Z), SAMPLED)
    };
    let octa =
        lit_by(light(Emitter::RoundPanel { diameter_m: 1.2 }, Output::Lumens(1000.0), Vec3::Z * 0.5, Vec3::ZERO));
    let near = "octa 120 cm at 0.5 m";
    let near = row(near, "lx", closed_forms::disc_on_axis(1000.0, 1.2, 0.5), flat(&octa, Vec3::ZERO, Vec3::Z), SAMPLED);
    vec![rectangle(0.6, 0.9, 0.5), rectangle(0.9, 1.2, 1.0), rectangle(0.6, 0.9, 5.0), near, tilted_panel()]
}

/// A panel half below the horizon of a receiver beside it.
fn tilted_panel() -> TruthRow {
    let (position, normal) = (Vec3::new(0.9, 0.2, 0.4), Vec3::new(0.8, 0.0, 0.6));
    let panel = light(
        Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
        Output::Lumens(1000.0),
        Vec3::new(1.2, 0.1, 1.0),
        Vec3::ZERO,
    );
    let scene = lit_by(panel);
    let frame = scene.light_frame(&scene.lights[0]);
    let corner = |x: f32, y: f32| frame.transform_point3(Vec3::new(0.3 * x, 0.45 * y, 0.0)).as_dvec3();
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let truth = closed_forms::polygon(&corners, 1000.0 / (PI * 0.54), position.as_dvec3(), DVec3::new(0.8, 0.0, 0.6));
    row(
        "softbox 60 x 90 cm 0.7 m beside a turned receiver (Lambert's polygon)",
        "lx",
        truth,
        flat(&scene, position, normal),
        SAMPLED,
    )
}

fn cones() -> Vec<TruthRow> {
    let spot = |inner_deg: f32, outer_deg: f32, truth: f64| {
        let emitter = Emitter::Spot { inner_deg, outer_deg };
        let scene = lit_by(light(emitter, Output::Lumens(1000.0), Vec3::Z * 2.0, Vec3::ZERO));
        let edge = if inner_deg == outer_deg { "hard" } else { "soft" };
        let case = format!("spot of 1000 lm, {edge} cone of {outer_deg}\u{b0}, on its axis");
        row(case, "cd", truth, 4.0 * flat(&scene, Vec3::ZERO, Vec3::Z), 1e-4)
    };
    // Half of the intensity at half of the outer angle, from so far away that coordinates have steps of 6 cm.
    let far_m = 1e6;
    let emitter = Emitter::Spot { inner_deg: 0.0, outer_deg: 20.0 };
    let aim = Aim::Angles { yaw_deg: 5.0, pitch_deg: 0.0 };
    let far = Light { aim, ..light(emitter, Output::Candela(1000.0), Vec3::Z * far_m, Vec3::ZERO) };
    let intensity = f64::from(far_m).powi(2) * flat(&lit_by(far), Vec3::ZERO, Vec3::Z);
    vec![
        spot(15.0, 15.0, closed_forms::hard_cone(1000.0, 15.0)),
        spot(40.0, 70.0, closed_forms::soft_cone(1000.0, 40.0, 70.0)),
        row("spot of 20\u{b0} at a fixed angle, 5\u{b0} off its axis, from 1000 km", "cd", 500.0, intensity, 1e-4),
    ]
}

fn far_lights() -> Vec<TruthRow> {
    let sun = Emitter::Sun { angular_diameter_deg: 0.53 };
    let sun = lit_by(light(sun, Output::Lux(80_000.0), Vec3::Y, Vec3::ZERO));
    let tilted = Vec3::new(0.0, 0.5, 0.75_f32.sqrt());
    let surround = lit_by(light(Emitter::Surround, Output::Lux(2000.0), Vec3::Y, Vec3::ZERO));
    vec![
        row(
            "sun of 80 000 lx at 60\u{b0} from the receiver's normal",
            "lx",
            40_000.0,
            flat(&sun, Vec3::ZERO, tilted),
            2e-3,
        ),
        row("even surround of 2000 lx", "lx", 2000.0, flat(&surround, Vec3::ZERO, Vec3::Y), 1e-4),
    ]
}

fn receptors() -> Vec<TruthRow> {
    let scene = lit_by(light(Emitter::Point, Output::Candela(1000.0), Vec3::Z, Vec3::ZERO));
    let aside = Vec3::new(0.75_f32.sqrt(), 0.0, 0.5);
    let dome = lux(&scene, Vec3::ZERO, aside, Receptor::Dome, &MeterEffort::default());
    vec![row("dome at 60\u{b0} from 1000 lx", "lx", 750.0, dome, 1e-4)]
}

fn matte(reflectance: f32) -> Material {
    Material { base_color: [reflectance; 3], ior: 1.0, roughness: 1.0, ..Material::default() }
}

fn closed_rooms() -> Vec<TruthRow> {
    let ball = |reflectance: f32| {
        let mut scene = lit_by(light(Emitter::Point, Output::Lumens(10_000.0), Vec3::ZERO, Vec3::Y));
        scene.objects.push(object(Shape::Sphere { radius_m: 2.0 }, matte(reflectance), Vec3::ZERO, Vec3::ZERO));
        let case = format!("closed white ball of 4 m, 10 000 lm, r = {reflectance}");
        let truth = closed_forms::closed_box(1e4, 16.0 * PI, reflectance.into());
        // The sphere is a polyhedron, with a mean radius 0.1 % smaller.
        row(case, "lx", truth, flat(&scene, Vec3::Y * -1.999, Vec3::Y), 0.01)
    };
    vec![cube(0.8), ball(0.5), ball(0.95)]
}

/// Mean illuminance on the floor of a cube with a lamp in its centre; all walls are equal.
fn cube(reflectance: f32) -> TruthRow {
    let paint = matte(reflectance);
    let room = Room { size_m: Vec3::splat(4.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
    let lamp = light(Emitter::Point, Output::Lumens(10_000.0), Vec3::Y * 2.0, Vec3::ZERO);
    let scene = Scene { room: Some(room), ..lit_by(lamp) };
    let n = 8;
    let at = |k: i32| (k as f32 + 0.5) / n as f32 * 4.0 - 2.0;
    // A seed for each cell, so that the errors are independent.
    let read = |i: i32| {
        let effort = MeterEffort { paths: Some(2048), seed: i as u32, ..MeterEffort::default() };
        lux(&scene, Vec3::new(at(i % n), 0.0, at(i / n)), Vec3::Y, Receptor::Flat, &effort)
    };
    let mean = (0..n * n).map(read).sum::<f64>() / f64::from(n * n);
    // The midpoint rule over 64 cells is off by 0.1 % at the lamp's peak, 64 x 2048 paths by 0.2 %.
    row(
        "closed cube of 4 m, 10 000 lm, r = 0.8, mean",
        "lx",
        closed_forms::closed_box(1e4, 96.0, reflectance.into()),
        mean,
        0.008,
    )
}

fn panes() -> Vec<TruthRow> {
    let pane = |degrees: f32| {
        let mut scene = lit_by(light(Emitter::Point, Output::Candela(1000.0), Vec3::Z * 10.0, Vec3::ZERO));
        let open = flat(&scene, Vec3::ZERO, Vec3::Z);
        let glass =
            Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.52, ..Material::default() };
        let shape = Shape::Box { size_m: Vec3::new(8.0, 8.0, 0.004) };
        scene.objects.push(object(shape, glass, Vec3::Z * 2.0, Vec3::X * degrees));
        let case = format!("clear pane, n = 1.52, under {degrees}\u{b0}");
        let angle = f64::from(degrees).to_radians();
        // The closed form includes all interreflections between the faces, as the tracer does.
        row(case, "", closed_forms::pane(angle, 1.52), flat(&scene, Vec3::ZERO, Vec3::Z) / open, 2e-3)
    };
    // A softbox behind a window.
    let mut window = lit_by(light(
        Emitter::RectPanel { width_m: 0.3, height_m: 0.3 },
        Output::Lumens(1000.0),
        Vec3::Z * 3.0,
        Vec3::ZERO,
    ));
    let open = flat(&window, Vec3::ZERO, Vec3::Z);
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.52, ..Material::default() };
    let sheet = Shape::Plane { width_m: 4.0, depth_m: 4.0 };
    window.objects.push(object(sheet, glass, Vec3::Z, Vec3::X * 90.0));
    // Angles of incidence up to 4 degrees change the transmittance by less than 0.01 %.
    let softbox = flat(&window, Vec3::ZERO, Vec3::Z) / open;
    vec![
        pane(0.0),
        pane(60.0),
        row("softbox behind a window pane, n = 1.52", "", closed_forms::pane(0.0, 1.52), softbox, 2e-3),
    ]
}

/// The part of an even light that a white metal plane gives back: the mean of a rendered picture.
fn white_metal() -> Vec<TruthRow> {
    let plane = |roughness: f32, angle_deg: f32| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let mut scene = lit_by(light(Emitter::Surround, Output::Lux(1000.0), Vec3::Y, Vec3::ZERO));
        let metal = Material { base_color: [0.999; 3], metallic: 1.0, roughness, ..Material::default() };
        let shape = Shape::Plane { width_m: 100.0, depth_m: 100.0 };
        scene.objects.push(object(shape, metal, Vec3::ZERO, Vec3::ZERO));
        scene.camera = Camera {
            position: Vec3::new(sin, cos, 0.0),
            aim: Aim::Point(Vec3::ZERO),
            sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
            focal_length_mm: 5000.0,
            ..Camera::default()
        };
        let white = f64::from(exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s) * 1000.0 / PI;
        let case = format!("white metal plane, roughness {roughness}, seen under {angle_deg}\u{b0}, in even light");
        // The error of 16 x 16 x 64 stratified samples. The whitest base colour is 0.999.
        row(case, "", 0.999, mean_pixel(&scene) / white, 1e-3)
    };
    vec![plane(0.45, 0.0), plane(0.5, 60.0)]
}

fn flash() -> Vec<TruthRow> {
    let camera = Camera { iso: 100.0, shutter_s: 1.0 / 125.0, ..Camera::default() };
    let aperture = |scene: &Scene| {
        let lux_s = flat(scene, Vec3::ZERO, Vec3::Z) * f64::from(scene.camera.shutter_s);
        f64::from(exposure::f_number(lux_s as f32, scene.camera.iso, scene.camera.meter_constant))
    };
    let head = lit_by(light(Emitter::Point, Output::FlashGuideNumber(32.0), Vec3::Z * 4.0, Vec3::ZERO));
    let head = Scene { camera: camera.clone(), ..head };
    let mut both = lit_by(light(Emitter::Point, Output::FlashGuideNumber(16.0), Vec3::Z * 2.0, Vec3::ZERO));
    let lamp = light(Emitter::Point, Output::Candela(80_000.0), Vec3::Z * 2.0, Vec3::ZERO);
    both.lights.push(Light { id: LightId(1), name: "Lamp".to_owned(), ..lamp });
    both.camera = camera;
    vec![
        row("flash of guide number 32 at 4 m, ISO 100: f-number", "", 8.0, aperture(&head), 1e-4),
        // 160 lx s of flash and 20 000 lx for 1/125 s: N2 = (160 + 160) 100 / 250.
        row("flash for f/8 and 20 000 lx for 1/125 s together: f-number", "", 128.0_f64.sqrt(), aperture(&both), 1e-4),
    ]
}

/// A metered grey card, rendered, rendered again one stop darker, and behind a filter.
fn pictures() -> Vec<TruthRow> {
    let emitter = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let mut scene = lit_by(light(emitter, Output::Lumens(200_000.0), Vec3::new(0.4, 0.3, 1.5), Vec3::ZERO));
    let card = Shape::Plane { width_m: 0.1, depth_m: 0.1 };
    scene.objects.push(object(card, MaterialPreset::GreyCard.material(), Vec3::ZERO, Vec3::X * 90.0));
    scene.camera = Camera {
        position: Vec3::new(0.02, 0.0, 0.1),
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 300.0,
        ..Camera::default()
    };
    let lux_s = flat(&scene, Vec3::ZERO, Vec3::Z) * f64::from(scene.camera.shutter_s);
    scene.camera.f_number = exposure::f_number(lux_s as f32, scene.camera.iso, scene.camera.meter_constant);
    let metered = mean_pixel(&scene);
    scene.lights[0].power.dial_stops = -1.0;
    let darker = mean_pixel(&scene);
    let stops = (darker / metered).log2();
    scene.camera.nd_stops = 3.0;
    let filtered_stops = (mean_pixel(&scene) / darker).log2();
    vec![
        // The error of 16 x 16 x 64 samples, and that of the meter.
        row("18 % card, exposed as the meter says, rendered", "", 0.18, metered, SAMPLED),
        row("a light a stop down, rendered", "stops", -1.0, stops, 1e-4),
        row("an ND filter of 3 stops (ND8), rendered", "stops", -3.0, filtered_stops, 1e-4),
    ]
}

/// Returns the mean green of a small rendered picture; NaN if the scene can't be prepared.
fn mean_pixel(scene: &Scene) -> f64 {
    let Ok(prepared) = raytrace::prepare(scene, &Assets::default()) else { return f64::NAN };
    let settings = Settings { width: 16, height: 16, spp: 64, ..Settings::default() };
    let film = raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
    let picture = film.develop(scene);
    picture.rgb.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / picture.rgb.len() as f64
}
