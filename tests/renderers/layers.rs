//! Translucent sheets and frosted glass against closed forms.

use crate::studio::{self, light};
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, RenderControl};
use catchlight::scene::{Aim, Assets, Emitter, Light, Material, Object, Output, Scene, Shape, Transform};
use glam::Vec3;

/// Illuminance on the axis of a Lambertian square of this side and luminance, facing it.
fn square_on_axis(luminance: f32, side: f32, distance: f32) -> f32 {
    let (half, slant) = (0.5 * side, distance.hypot(0.5 * side));
    4.0 * luminance * (half / slant) * (half / slant).atan()
}

/// Returns a vertical square of 1.2 m about the origin, facing +Z and -Z, with a sun of 10 000 lx behind it.
fn behind_sheet(material: Material) -> Scene {
    let mut sheet: Object = studio::object("Scrim", Shape::Plane { width_m: 1.2, depth_m: 1.2 }, Vec3::ZERO);
    sheet.transform = Transform { rotation_deg: Vec3::X * 90.0, ..sheet.transform };
    sheet.material = material;
    let emitter = Emitter::Sun { angular_diameter_deg: 0.0 };
    let sun = Light { aim: Aim::Point(Vec3::ZERO), ..light(emitter, Output::Lux(10_000.0), Vec3::NEG_Z * 3.0) };
    Scene { objects: vec![sheet], lights: vec![sun], ..Scene::default() }
}

fn lux(scene: &Scene, position: Vec3) -> f32 {
    let meter = LightMeter::new(scene, &Assets::default(), position).unwrap();
    let point = MeterPoint { position, facing: Vec3::NEG_Z, receptor: Receptor::Flat };
    let (direct, bounced) =
        meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap().reading.total_lux();
    direct + bounced
}

#[test]
fn a_light_behind_a_scrim_of_1_2_m_reads_as_the_lambertian_panel_that_the_scrim_is() {
    let scrim =
        |translucency| Material { base_color: [0.9; 3], translucency, ior: 1.0, roughness: 1.0, ..Material::default() };
    for (translucency, distance) in [(0.5, 1.0), (0.5, 0.3), (0.25, 2.0)] {
        let luminance = 10_000.0 * 0.9 * translucency / std::f32::consts::PI;
        let expected = square_on_axis(luminance, 1.2, distance);
        let ours = lux(&behind_sheet(scrim(translucency)), Vec3::Z * distance);
        assert!((ours / expected - 1.0).abs() < 0.01, "{translucency} at {distance} m: {ours} lx for {expected}");
    }
    // Opaque paper lets nothing through, but for what comes round it: nothing here
    assert_eq!(lux(&behind_sheet(scrim(0.0)), Vec3::Z), 0.0);
}

#[test]
fn frosted_glass_before_a_wide_even_light_transmits_all_of_it() {
    // A body of frosted glass that absorbs nothing, all around even light: the meter inside of the room reads it as if
    // the glass were not there
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, frosting: 0.4, ..Material::default() };
    let ball = Object { material: glass, ..studio::object("Ball", Shape::Sphere { radius_m: 0.4 }, Vec3::ZERO) };
    let surround = light(Emitter::Surround, Output::Lux(5_000.0), Vec3::ZERO);
    let scene = Scene { objects: vec![ball], lights: vec![surround], ..Scene::default() };
    let ours = lux(&scene, Vec3::Z * 0.6);
    // The tables of the glass are good to half a percent, and light crosses several faces
    assert!((ours / 5_000.0 - 1.0).abs() < 0.015, "{ours} lx");
}
