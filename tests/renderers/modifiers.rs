//! Tests of modifiers: they only take light away, and meter, path tracer, preview and file agree about them.

use crate::studio::light;
use catchlight::photo::beam::{Beam, transmitted_flux_fraction};
use catchlight::photo::emitter::EmitterShape;
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, RenderControl};
use catchlight::scene::{
    Aim, Assets, BarnDoors, Cone, Emitter, Light, Modifier, NamedModifier, Output, Scene, Severity, validate,
};
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Returns a scene with a light at the origin that faces -Z, with this modifier.
fn modified(emitter: Emitter, modifier: Modifier) -> Scene {
    let mut source = light(emitter, Output::Lumens(1000.0), Vec3::ZERO);
    source.aim = Aim::Point(Vec3::NEG_Z);
    source.modifier = modifier;
    Scene { lights: vec![source], ..Scene::default() }
}

/// Returns the illuminance at positions that face `towards`, with 4096 light samples each.
fn lux(scene: &Scene, positions: &[Vec3], towards: Vec3) -> Vec<f32> {
    lux_by_paths(4096, scene, positions, towards)
}

fn lux_by_paths(paths: u32, scene: &Scene, positions: &[Vec3], towards: Vec3) -> Vec<f32> {
    let meter = LightMeter::new(scene, &Assets::default(), Vec3::ZERO).unwrap();
    let effort = MeterEffort { paths: Some(paths), ..MeterEffort::default() };
    let read = |&position: &Vec3| {
        let facing = (towards - position).normalize();
        let point = MeterPoint { position, facing, receptor: Receptor::Flat };
        meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.total_lux().0
    };
    positions.iter().map(read).collect()
}

#[test]
fn a_loss_in_stops_reads_as_many_stops_less_on_the_meter() {
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let at = [Vec3::NEG_Z];
    let bare = lux(&modified(panel, Modifier::default()), &at, Vec3::ZERO)[0];
    let lossy = Modifier { scrim_stops: 1.0, ..Modifier::loss(0.5) };
    let stops = (bare / lux(&modified(panel, lossy), &at, Vec3::ZERO)[0]).log2();
    // Both readings use the same light samples: only rounding differs.
    assert!((stops - 1.5).abs() < 1e-5, "{stops}");
}

#[test]
fn flux_outside_of_the_beam_is_lost_and_the_axial_intensity_is_kept() {
    let (grid, dish) =
        (Modifier { grid_deg: Some(40.0), ..Modifier::default() }, Cone { inner_deg: 50.0, outer_deg: 130.0 });
    let doors = BarnDoors { left_deg: 20.0, right_deg: 60.0, top_deg: 90.0, bottom_deg: 30.0 };
    for (emitter, modifier) in [
        (Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, grid),
        (
            Emitter::RoundPanel { diameter_m: 0.55 },
            Modifier { beam: Some(dish), grid_deg: Some(60.0), ..Modifier::default() },
        ),
        (Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 }, Modifier { doors: Some(doors), ..Modifier::default() }),
        (Emitter::Sphere { radius_m: 0.05 }, grid),
        (Emitter::Point, Modifier { beam: Some(dish), ..Modifier::default() }),
    ] {
        // Illuminance over a hemisphere of 20 m, where panels are points to 0.1 %: midpoints of 96 angles, and of 24
        // azimuths where the light depends on them.
        let (angles, distance) = (96, 20.0_f32);
        let azimuths = if modifier.doors.is_some() { 24 } else { 6 };
        let mut positions = vec![Vec3::NEG_Z * distance];
        let mut areas = vec![0.0];
        for i in 0..angles {
            let angle = (i as f32 + 0.5) / angles as f32 * FRAC_PI_2;
            for k in 0..azimuths {
                let (sin, cos) = ((k as f32 + 0.5) / azimuths as f32 * TAU).sin_cos();
                positions.push(Vec3::new(angle.sin() * cos, angle.sin() * sin, -angle.cos()) * distance);
                areas.push(distance * distance * angle.sin() * (FRAC_PI_2 / angles as f32) * (TAU / azimuths as f32));
            }
        }
        let scene = modified(emitter, modifier);
        // Hundreds of positions average the noise of each
        let flux_through = |scene: &Scene| lux_by_paths(128, scene, &positions, Vec3::ZERO);
        let (with, without) = (flux_through(&scene), flux_through(&modified(emitter, Modifier::default())));
        let flux: f32 = with.iter().zip(&areas).map(|(lux, area)| lux * area).sum();
        let fraction = transmitted_flux_fraction(&EmitterShape::new(&emitter), Beam::new(&modifier).as_ref());
        // Barn doors have edges of 4 degrees; the azimuths are 15 degrees apart.
        let allowed = if modifier.doors.is_some() { 0.02 } else { 0.006 };
        assert!((flux / (1000.0 * fraction) - 1.0).abs() < allowed, "{emitter:?}: {flux} lm of {fraction}");
        // The rim of the panel is 1.3 degrees off the axis; the grid falls to 0 at 20 degrees.
        assert!((with[0] / without[0] - 1.0).abs() < 0.05, "{emitter:?}: {} of {} lx ahead", with[0], without[0]);
        for (i, (with, without)) in with.iter().zip(&without).enumerate() {
            assert!(*with <= without * 1.001 + 1e-6, "{emitter:?}: position {i} gained: {with} of {without} lx");
        }
    }
}

#[test]
fn a_near_softbox_with_a_grid_lights_through_the_cells_that_see_the_receptor() {
    // A disc of luminance L, on its axis: the grid passes rays under half its angle, falling linearly.
    let (emitter, distance) = (Emitter::RoundPanel { diameter_m: 1.2 }, 0.8_f32);
    let grid = Modifier { grid_deg: Some(60.0), ..Modifier::default() };
    let metered = lux(&modified(emitter, grid), &[Vec3::NEG_Z * distance], Vec3::ZERO)[0];
    let luminance = 1000.0 / PI / (PI * 0.36);
    let n = 20_000;
    let expected: f64 = (0..n)
        .map(|i| {
            let half_angle = f64::from(0.6_f32 / distance).atan();
            let angle = (f64::from(i) + 0.5) / f64::from(n) * half_angle;
            let passed = (1.0 - angle / 30.0_f64.to_radians()).max(0.0);
            std::f64::consts::TAU * passed * angle.sin() * angle.cos() * half_angle / f64::from(n)
        })
        .sum::<f64>()
        * f64::from(luminance);
    // 4096 stratified samples, of which a quarter pass.
    assert!((f64::from(metered) / expected - 1.0).abs() < 0.004, "{metered} for {expected}");
}

#[test]
fn files_keep_modifiers_and_omit_the_empty_one() {
    for named in &NamedModifier::ALL {
        let mut scene = modified(named.emitter, named.modifier);
        scene.lights[0].name = named.name.to_owned();
        let text = catchlight::io::write_scene(&scene);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.ron"), &text).unwrap();
        let loaded = catchlight::io::load_scene(&folder.path().join("a.ron")).unwrap();
        assert_eq!(loaded.scene.lights[0].modifier, named.modifier, "{text}");
        assert_eq!(text.contains("modifier:"), named.modifier != Modifier::default());
        let errors = validate(&scene).into_iter().filter(|f| f.severity == Severity::Error).count();
        assert_eq!(errors, 0, "{}", named.name);
    }
}

#[test]
fn impossible_modifiers_are_errors_that_name_the_field() {
    type Break = fn(&mut Light);
    let cases: [(&str, Break); 5] = [
        ("modifier.loss_stops", |l| l.modifier.loss_stops = -1.0),
        ("modifier.grid_deg", |l| l.modifier.grid_deg = Some(f32::NAN)),
        ("modifier.beam.inner_deg", |l| l.modifier.beam = Some(Cone { inner_deg: 50.0, outer_deg: 20.0 })),
        ("modifier.doors.top_deg", |l| l.modifier.doors = Some(BarnDoors { top_deg: 100.0, ..BarnDoors::HALF_OPEN })),
        ("modifier", |l| {
            (l.emitter, l.power.output) = (Emitter::Surround, Output::Lux(100.0));
            l.modifier.grid_deg = Some(40.0);
        }),
    ];
    for (field, break_it) in cases {
        let mut scene = modified(Emitter::RoundPanel { diameter_m: 1.0 }, Modifier::default());
        break_it(&mut scene.lights[0]);
        let findings = validate(&scene);
        assert!(
            findings.iter().any(|f| f.severity == Severity::Error && f.place.ends_with(field)),
            "{field}: {findings:?}"
        );
    }
}

#[cfg(feature = "gui")]
mod preview {
    use super::*;
    use crate::adapter::headless_gpu;
    use catchlight::photo::exposure;
    use catchlight::preview::{Gpu, Options, PreviewInput, PreviewRenderer};
    use catchlight::scene::{Camera, MaterialPreset, Shape};

    /// Returns a renderer; without a GPU adapter it reports a skip, or fails if one is required.
    fn renderer() -> Option<(Gpu, PreviewRenderer)> {
        let gpu = headless_gpu()?;
        let renderer = PreviewRenderer::new(&gpu.device, &gpu.queue).unwrap();
        Some((gpu, renderer))
    }

    #[test]
    fn the_preview_shows_the_beam_that_the_meter_reads() {
        let Some((_gpu, mut renderer)) = renderer() else { return };
        let tilted = BarnDoors { left_deg: 15.0, right_deg: 60.0, top_deg: 40.0, bottom_deg: 90.0 };
        for (emitter, modifier) in [
            (
                Emitter::RectPanel { width_m: 0.6, height_m: 0.9 },
                Modifier { grid_deg: Some(50.0), ..Modifier::loss(1.0) },
            ),
            (Emitter::RoundPanel { diameter_m: 0.55 }, NamedModifier::named("Beauty dish 55").unwrap().modifier),
            (
                Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 },
                Modifier { doors: Some(tilted), ..Modifier::loss(0.3) },
            ),
            (Emitter::Sphere { radius_m: 0.04 }, Modifier { grid_deg: Some(60.0), ..Modifier::default() }),
        ] {
            let mut source = light(emitter, Output::Lumens(10_000.0), Vec3::new(0.3, 2.0, 0.4));
            (source.modifier, source.roll_deg) = (modifier, 20.0);
            let mut floor = crate::studio::object("Floor", Shape::Plane { width_m: 8.0, depth_m: 8.0 }, Vec3::ZERO);
            floor.material = MaterialPreset::GreyCard.material();
            let camera = Camera {
                position: Vec3::new(0.0, 5.0, 5.0),
                aim: Aim::Point(Vec3::ZERO),
                focal_length_mm: 28.0,
                f_number: 4.0,
                shutter_s: 0.5,
                ..Camera::default()
            };
            let scene = Scene { objects: vec![floor], lights: vec![source], camera, ..Scene::default() };
            let assets = Assets::default();
            let view = PreviewInput::camera_view(&scene, &assets, (600, 400));
            let input = PreviewInput { options: Options { shadows: false, ..Options::direct_only() }, ..view };
            let picture = renderer.linear_picture(&input).unwrap();
            let per_lux = exposure::pixel_per_cd_s_m2(&scene) * scene.camera.shutter_s * 0.18 / PI;
            let positions: Vec<Vec3> =
                (0..25).map(|i| Vec3::new((i % 5 - 2) as f32 * 0.4, 0.0, (i / 5 - 2) as f32 * 0.4)).collect();
            let meter = LightMeter::new(&scene, &assets, Vec3::ZERO).unwrap();
            let read = |position: Vec3| {
                let point = MeterPoint { position, facing: Vec3::Y, receptor: Receptor::Flat };
                let effort = MeterEffort { paths: Some(4096), ..MeterEffort::default() };
                meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.total_lux().0
            };
            let brightest = positions.iter().map(|p| read(*p)).fold(0.0, f32::max);
            for point in positions {
                let metered = read(point);
                let at = input.frame.project(point).unwrap() * glam::Vec2::new(600.0, 400.0);
                let shown = picture.at(at.x as u32, at.y as u32)[1] / per_lux;
                // 36 samples per panel, and a pixel is a centimetre on the edge of a beam: 3 % of the maximum.
                assert!((shown - metered).abs() < 0.03 * brightest, "{emitter:?} at {point}: {shown} for {metered} lx");
            }
        }
    }
}
