//! Lights with photometric files, from the file on the disk to the meter, the software rasterizer and the tracer:
//! E = I cos / d2 with the intensity of the file.

use crate::studio::measure::{film_with, lux_per_value, meter_card, square, values};
use catchlight::io::{Loaded, load_scene, write_scene};
use catchlight::photo::PhotometricLight;
use catchlight::photo::meter::Receptor;
use catchlight::raster::{self, Shading};
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, Method, RenderControl};
use catchlight::scene::{Aim, Emitter, Light, Modifier, Output, Scene};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Returns the intensity of [`FILE`] by its formula, cd; bilinear interpolation meets it everywhere.
fn intensity(vertical_deg: f32, horizontal_deg: f32) -> f32 {
    let left = 1.0 - (horizontal_deg.rem_euclid(360.0) - 180.0).abs() / 180.0;
    let plane = |at_60: f32| match vertical_deg {
        v if v <= 60.0 => 1200.0 + (at_60 - 1200.0) * v / 60.0,
        v => (at_60 * (120.0 - v) / 60.0).max(0.0),
    };
    plane(1500.0) * (1.0 - left) + plane(200.0) * left
}

/// IES file of `intensity`: 1200 cd ahead, at 60 degrees 1500 cd on one side and 200 cd on the other, 0 at 120 degrees.
const FILE: &str = "IESNA:LM-63-2002\r\n[LUMINAIRE] Lopsided\r\nTILT=INCLUDE\r\n1\r\n2\r\n0 90\r\n1 0.6\r\n1 -1 10 4 2 1 2 0 0 0 \
                    1 1 100\r\n0 60 120 180\r\n0 180\r\n120 150 0 0\r\n120 20 0 0\r\n";

/// Returns a studio that was saved with the photometric file beside it, and loaded again.
fn loaded(scene: &Scene) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("lamps")).unwrap();
    std::fs::write(folder.path().join("lamps/lopsided.ies"), FILE).unwrap();
    std::fs::write(folder.path().join("a.ron"), write_scene(scene)).unwrap();
    let loaded = load_scene(&folder.path().join("a.ron")).unwrap();
    // Of this file an eighth goes behind a panel
    let of_file: Vec<&str> =
        loaded.warnings.iter().filter(|w| w.place.contains("photometric")).map(|w| &*w.message).collect();
    let is_panel = matches!(scene.lights[0].emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. });
    let expected: &[&str] = &["12 % of its light goes behind the panel and is lost; a point shows all of it"];
    assert_eq!(of_file, if is_panel { expected } else { &[] });
    loaded
}

/// Returns a light with the file, 3 m over the origin and aimed straight down, as bright as the file says.
fn measured(emitter: Emitter) -> Light {
    Light {
        position: Vec3::Y * 3.0,
        aim: Aim::Point(Vec3::ZERO),
        roll_deg: 25.0,
        photometric_file: Some("lamps/lopsided.ies".to_owned()),
        ..Light::new(emitter, Output::Candela(1500.0))
    }
}

/// Returns the intensity towards a point, by the angles in the light's frame: the vertical one from -Z, the horizontal
/// one from +X to +Y.
fn towards(scene: &Scene, point: Vec3) -> f32 {
    let frame = scene.light_frame(&scene.lights[0]);
    let direction = frame.inverse().transform_vector3(point - scene.lights[0].position).normalize();
    intensity(
        direction.x.hypot(direction.y).atan2(-direction.z).to_degrees(),
        direction.y.atan2(direction.x).to_degrees(),
    )
}

/// Returns the illuminance at positions that face the direction of `facing`, lux.
fn metered(loaded: &Loaded, positions: &[Vec3], facing: impl Fn(Vec3) -> Vec3) -> Vec<f32> {
    metered_by(1024, loaded, positions, facing)
}

/// As [`metered`], with so many paths from each position.
fn metered_by(paths: u32, loaded: &Loaded, positions: &[Vec3], facing: impl Fn(Vec3) -> Vec3) -> Vec<f32> {
    let meter = LightMeter::new(&loaded.scene, &loaded.assets, Vec3::ZERO).unwrap();
    let effort = MeterEffort { paths: Some(paths), ..MeterEffort::default() };
    let read = |&position: &Vec3| {
        let point = MeterPoint { position, facing: facing(position), receptor: Receptor::Flat };
        meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.total_lux().0
    };
    positions.iter().map(read).collect()
}

#[test]
fn meter_rasterizer_and_tracer_read_the_intensity_of_the_file() {
    let points = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.4), Vec3::new(-2.0, 0.0, 1.0), Vec3::new(0.3, 0.0, -4.0)];
    let spot = Emitter::Spot { inner_deg: 20.0, outer_deg: 40.0 };
    for emitter in [Emitter::Point, spot, Emitter::Sphere { radius_m: 0.01 }] {
        for point in points {
            let scene = Scene { lights: vec![measured(emitter)], ..meter_card(point, Vec3::Y) };
            let loaded = loaded(&scene);
            let to_light = scene.lights[0].position - point;
            let expected = towards(&scene, point) * to_light.normalize().y / to_light.length_squared();
            let metered = metered(&loaded, &[point], |_| Vec3::Y)[0];
            let traced =
                values(&film_with(&loaded.scene, &loaded.assets, &square(Method::Direct, 8, 16)).develop(&scene));
            let camera = scene.camera_frame(1.0);
            let drawn = raster::draw(&loaded.scene, &loaded.assets, &camera, (8, 8), Shading::Lambert).picture;
            let per_value = lux_per_value(&scene.camera) as f32;
            let readings = [metered, traced.mean as f32 * per_value, values(&drawn).mean as f32 * per_value];
            for (reading, of) in readings.into_iter().zip(["meter", "tracer", "rasterizer"]) {
                assert!(
                    (reading / expected - 1.0).abs() < 2e-3,
                    "{emitter:?} {point} {of}: {reading} for {expected} lx"
                );
            }
        }
    }
}

#[test]
fn a_panel_has_the_intensity_of_the_file_in_its_far_field() {
    for emitter in [Emitter::RectPanel { width_m: 0.3, height_m: 0.6 }, Emitter::RoundPanel { diameter_m: 0.4 }] {
        let loaded = loaded(&Scene { lights: vec![measured(emitter)], ..Scene::default() });
        let (centre, distance) = (loaded.scene.lights[0].position, 30.0);
        for angle_deg in [0.0_f32, 20.0, 50.0, 75.0, 80.0] {
            for turn in 0..8 {
                let (sin, cos) = (turn as f32 / 8.0 * TAU).sin_cos();
                let (across, down) = angle_deg.to_radians().sin_cos();
                let at = centre + distance * Vec3::new(across * cos, -down, across * sin);
                let lux = metered(&loaded, &[at], |at| (centre - at).normalize())[0];
                let expected = towards(&loaded.scene, at);
                let error = lux * distance * distance / expected - 1.0;
                assert!(error.abs() < 0.01, "{emitter:?} {angle_deg} {turn}: {error}");
            }
        }
        let above = centre + Vec3::new(0.3, 2.0, 0.3);
        assert_eq!(metered(&loaded, &[above], |at| (centre - at).normalize()), [0.0], "nothing behind");
        // The part behind the panel is lost
        let light = PhotometricLight::new(&loaded.scene, &loaded.assets, &loaded.scene.lights[0]);
        let whole = light.measured().unwrap().table().flux_lm();
        assert!(light.flux() < 0.93 * whole && light.flux() > 0.8 * whole, "{} of {whole} lm", light.flux());
    }
}

#[test]
fn the_illuminance_around_a_light_sums_up_to_the_lumens_of_its_file() {
    let mut scene = Scene { lights: vec![measured(Emitter::Point)], ..Scene::default() };
    scene.lights[0].position = Vec3::ZERO;
    scene.lights[0].aim = Aim::Point(Vec3::NEG_Y);
    let loaded_cd = loaded(&scene);
    let light = PhotometricLight::new(&loaded_cd.scene, &loaded_cd.assets, &loaded_cd.scene.lights[0]);
    // int I dO by the midpoint rule: over the horizontal angles, the mean of both sides
    let step = 0.1_f32;
    let along = |i: i32| (i as f32 + 0.5) * step;
    let ring = |v: f32| 0.5 * (intensity(v, 0.0) + intensity(v, 180.0)) * v.to_radians().sin();
    let flux = TAU * (0..1200).map(|i| ring(along(i))).sum::<f32>() * step.to_radians();
    assert!((light.flux() / flux - 1.0).abs() < 1e-4, "{} for {flux} lm", light.flux());
    let (rows, columns) = (120, 60);
    let mut positions = Vec::new();
    let mut areas = Vec::new();
    for row in 0..rows {
        let angle = (row as f32 + 0.5) / rows as f32 * PI;
        for column in 0..columns {
            let (sin, cos) = ((column as f32 + 0.5) / columns as f32 * TAU).sin_cos();
            positions.push(Vec3::new(angle.sin() * cos, angle.cos(), angle.sin() * sin));
            areas.push(angle.sin() * (PI / rows as f32) * (TAU / columns as f32));
        }
    }
    let sum = |loaded: &Loaded| {
        // A point's light has no noise
        let lux = metered_by(16, loaded, &positions, |at| -at);
        lux.iter().zip(&areas).map(|(lux, area)| lux * area).sum::<f32>()
    };
    let read = sum(&loaded_cd);
    assert!((read / flux - 1.0).abs() < 1e-3, "{read} for {flux} lm");
    // Stated in lumens, one stop down
    scene.lights[0].power.output = Output::Lumens(2.0 * flux);
    scene.lights[0].power.dial_stops = -1.0;
    let in_lumens = loaded(&scene);
    let read = sum(&in_lumens);
    assert!((read / flux - 1.0).abs() < 1e-3, "{read} for {flux} lm");
    // A grid takes light and adds none
    scene.lights[0].modifier = Modifier { grid_deg: Some(60.0), ..Modifier::default() };
    let gridded = loaded(&scene);
    let light = PhotometricLight::new(&gridded.scene, &gridded.assets, &gridded.scene.lights[0]);
    let read = sum(&gridded);
    assert!((read / light.flux() - 1.0).abs() < 0.01 && read < 0.3 * flux, "{read} and {}", light.flux());
}

#[test]
fn a_lamp_gives_the_light_of_its_burning_position() {
    let lux = |aim: Vec3| {
        let mut light = measured(Emitter::Point);
        light.aim = Aim::Point(light.position + aim);
        let at = light.position + aim.normalize() * 2.0;
        let loaded = loaded(&Scene { lights: vec![light], ..Scene::default() });
        metered(&loaded, &[at], |_| -aim.normalize())[0]
    };
    let down = lux(Vec3::NEG_Y);
    for (aim, factor) in [(Vec3::new(1.0, -1.0, 0.0), 0.8), (Vec3::X, 0.6), (Vec3::Y, 0.6)] {
        assert!((lux(aim) / down - factor).abs() < 5e-3, "{aim}: {} of {down}", lux(aim));
    }
}

#[test]
fn a_studio_whose_photometric_file_is_missing_opens_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene { lights: vec![measured(Emitter::Point)], ..Scene::default() };
    std::fs::write(folder.path().join("a.ron"), write_scene(&scene)).unwrap();
    let loaded = load_scene(&folder.path().join("a.ron")).unwrap();
    assert_eq!(loaded.scene, scene);
    let warning = loaded.warnings.iter().find(|warning| warning.place.contains("photometric_file")).unwrap();
    assert!(warning.message.starts_with("the light shines as its emitter does"), "{warning}");
    let lux = metered(&loaded, &[Vec3::ZERO], |_| Vec3::Y)[0];
    assert!((lux - 1500.0 / 9.0).abs() < 1e-3, "{lux}");
}
