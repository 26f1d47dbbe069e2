//! What moves while it is lit: streaks by their closed form, for continuous light and for the decay of a flash.

use crate::studio::measure::{film_with, square};
use crate::studio::{light, object};
use catchlight::raytrace::Method;
use catchlight::scene::{
    Aim, Asset, AssetKey, Assets, Camera, Emitter, Head, HeadDial, Light, LightId, Mesh, Output, Scene, Sensor, Shape,
    Tank,
};
use glam::Vec3;
use std::borrow::Cow;
use std::sync::Arc;

/// Side of the card, metres; it starts left of the middle.
const SIDE_M: f32 = 0.02;
/// Its speed to the right, m/s.
const SPEED_M_S: f32 = 2.0;
/// Exposure time, and t0.1 of the flash: the card moves by its side.
const TIME_S: f32 = 0.01;
/// Pixels of the picture, of a millimetre each.
const PIXELS: u32 = 64;

/// Returns a scene with a card in place of a tank, and its mesh. A square millimetre of it is a pixel.
fn card(is_moving: bool, lights: Vec<Light>) -> (Scene, Assets) {
    let corners = [[-1.0, -0.5], [0.0, -0.5], [0.0, 0.5], [-1.0, 0.5]];
    let positions: Vec<Vec3> = corners.map(|[x, y]| Vec3::new(x, y, 0.0) * SIDE_M).into();
    let velocities = if is_moving { vec![Vec3::X * SPEED_M_S; 4] } else { Vec::new() };
    let mesh = Mesh { positions, velocities, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let tank = Tank { fluid: Some(Box::default()), ..Tank::default() };
    let mut assets = Assets::default();
    assets.insert(AssetKey::tank(Cow::Owned(tank.clone())), Asset::Tank(Arc::new(mesh.with_single_part("water"))));
    let mut card = object("Card", Shape::Tank(Box::new(tank)), Vec3::ZERO);
    card.part_materials = vec![("water".to_owned(), card.material.clone())];
    let camera = Camera {
        position: Vec3::Z,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 24.0 / (0.001 * PIXELS as f32),
        shutter_s: TIME_S,
        ..Camera::default()
    };
    (Scene { objects: vec![card], lights, camera, ..Scene::default() }, assets)
}

fn sun() -> Light {
    let sun = light(Emitter::Sun { angular_diameter_deg: 0.0 }, Output::Lux(10_000.0), Vec3::Z);
    Light { id: LightId(1), name: "Sun".to_owned(), ..sun }
}

fn flash(t01_s: Option<f32>) -> Light {
    let head = Head { name: "Head".to_owned(), dial: HeadDial::UNKNOWN, sync_s: None, hss_loss_stops: None, t01_s };
    let output = Output::FlashWs { energy_ws: 100.0, efficacy_lm_s_per_ws: 20.0 };
    let flash = light(Emitter::Point, output, Vec3::Z * 5.0);
    Light { id: LightId(2), name: "Flash".to_owned(), head: Some(head), ..flash }
}

/// Returns the mean of the rows through the card, by layer, as a part of the card at rest.
fn streaks(lights: &[Light]) -> Vec<Vec<f32>> {
    let [rest, moving] = [false, true].map(|is_moving| {
        let (scene, assets) = card(is_moving, lights.to_vec());
        film_with(&scene, &assets, &square(Method::Path, PIXELS, 64)).develop_layers(&scene)
    });
    let row = |picture: &catchlight::photo::Picture| -> Vec<f32> {
        let rows = PIXELS as usize / 2 - 8..PIXELS as usize / 2 + 8;
        let column = |x: usize| rows.clone().map(|y| picture.rgb[y * PIXELS as usize + x][1]).sum::<f32>() / 16.0;
        (0..PIXELS as usize).map(column).collect()
    };
    let parts = rest.iter().zip(&moving).take(lights.len()).map(|((_, rest), (_, moving))| {
        let (rest, moving) = (row(rest), row(moving));
        let full = rest[PIXELS as usize / 2 - 10];
        let (sum, expected): (f32, f32) = (moving.iter().sum(), rest.iter().sum());
        assert!((sum / expected - 1.0).abs() < 0.01, "all light is there: {sum} of {expected}");
        moving.iter().map(|value| value / full).collect()
    });
    parts.collect()
}

/// Returns the largest difference between a streak and that of light of which a part is given by a time.
fn difference(streak: &[f32], given: impl Fn(f32) -> f32) -> f32 {
    // Millimetres from the left edge at the start
    let place = |x: usize| x as f32 + 0.5 - 0.5 * PIXELS as f32 + 1000.0 * SIDE_M;
    let at = |way_mm: f32| given((way_mm / (1000.0 * SPEED_M_S)).max(0.0));
    let covered = |x: usize| at(place(x)) - at(place(x) - 1000.0 * SIDE_M);
    streak.iter().enumerate().map(|(x, value)| (value - covered(x)).abs()).fold(0.0, f32::max)
}

fn decay(time_s: f32) -> f32 {
    1.0 - (-time_s * 10.0_f32.ln() / TIME_S).exp()
}

#[test]
fn a_moving_card_is_the_streak_of_its_light() {
    // Sixteen moments: steps of a sixteenth of the light, half of one off at most, and noise
    let steps = 0.5 / 16.0 + 0.03;
    let off = difference(&streaks(&[sun()])[0], |time_s| (time_s / TIME_S).min(1.0));
    assert!(off < steps, "continuous light: {off}");
    let off = difference(&streaks(&[flash(Some(TIME_S))])[0], decay);
    assert!(off < steps, "flash: {off}");
    // Each light has its own time in one picture; the moments are shared
    let both = streaks(&[sun(), flash(Some(0.1 * TIME_S))]);
    let off = difference(&both[0], |time_s| (time_s / TIME_S).min(1.0));
    assert!(off < 2.0 * steps, "continuous light beside a flash: {off}");
    let off = difference(&both[1], |time_s| decay(10.0 * time_s));
    assert!(off < 2.0 * steps, "flash beside continuous light: {off}");
}

#[test]
fn a_flash_of_unknown_duration_freezes_what_moves_to_the_bit() {
    let [rest, moving] = [false, true].map(|is_moving| {
        let (scene, assets) = card(is_moving, vec![flash(None)]);
        film_with(&scene, &assets, &square(Method::Path, PIXELS, 4)).develop(&scene)
    });
    assert_eq!(rest, moving);
}
