//! Lessons: what changes and what does not, and their files.

use super::contact_sheet::{LessonFormat, LessonSheet};
use super::series::{Lesson, LessonError, LessonSeries};
use crate::photo::LightBearing;
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, RenderControl};
use crate::scene::{
    Aim, Assets, Camera, Emitter, Facing, Light, LightId, Meter, NamedModifier, Object, Output, Receptor, Role, Room,
    Scene, Shape, Transform,
};
use crate::sheet::canvas::Canvas;
use glam::Vec3;
use std::path::Path;

const SUBJECT: Vec3 = Vec3::new(0.0, 1.4, 0.3);

fn studio() -> Scene {
    let light = |id, name: &str, role, emitter, position| {
        let output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 20.0 };
        let light = Light { position, aim: Aim::Point(SUBJECT), role, ..Light::new(emitter, output) };
        Light { id: LightId(id), name: name.to_owned(), ..light }
    };
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let ball = Object::new("Ball", Shape::Sphere { radius_m: 0.15 });
    Scene {
        name: "Ball".to_owned(),
        camera: Camera { position: Vec3::new(0.0, 1.4, 3.0), aim: Aim::Point(SUBJECT), ..Camera::default() },
        room: Some(Room { size_m: Vec3::new(5.0, 2.6, 7.0), ..Room::default() }),
        objects: vec![Object { transform: Transform::at(Vec3::new(0.0, 1.4, 0.0)), ..ball }],
        lights: vec![
            light(1, "Key", Role::Key, softbox, Vec3::new(1.2, 1.9, 1.5)),
            light(2, "Fill", Role::Fill, softbox, Vec3::new(-1.5, 1.4, 1.5)),
        ],
        meter: Some(Meter { position: SUBJECT, facing: Facing::Camera, receptor: Receptor::Dome }),
        ..Scene::default()
    }
}

fn lesson(series: LessonSeries, scene: &Scene, light: Option<u32>) -> Result<Lesson, LessonError> {
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    Lesson::new(series, scene, &Assets::default(), light.map(LightId), &cache, &control)
}

/// Returns the f-number that the meter shows at the subject.
fn metered(scene: &Scene) -> f32 {
    let meter = LightMeter::new(scene, &Assets::default(), SUBJECT).unwrap();
    let point = MeterPoint { position: SUBJECT, facing: Vec3::Z, receptor: Receptor::Dome };
    let effort = MeterEffort { seed: 3, ..MeterEffort::default() };
    meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.f_number()
}

#[test]
fn a_light_swings_round_the_subject_at_one_distance_and_power() {
    let lesson = lesson(LessonSeries::Azimuth, &studio(), None).unwrap();
    assert_eq!((lesson.cells.len(), lesson.columns), (15, 5));
    assert!(
        lesson.title.starts_with("Key round the subject") && lesson.cells[6].caption == "45\u{b0} round, 30\u{b0} up"
    );
    let mut places = Vec::new();
    for cell in &lesson.cells {
        let on: Vec<&Light> = cell.scene.lights.iter().filter(|light| light.on).collect();
        assert!(on.len() == 1 && on[0].id == LightId(1));
        let half = 0.5 * cell.scene.room.as_ref().unwrap().size_m;
        assert!(on[0].position.y < 2.6 && on[0].position.x.abs() < half.x && on[0].position.z.abs() < half.z);
        places.push((LightBearing::new(&cell.scene, on[0].position, SUBJECT), on[0].power.dial_stops));
    }
    let (first, dial) = places[0];
    assert!(places.iter().all(|(place, stops)| (place.distance_m - first.distance_m).abs() < 1e-4 && *stops == dial));
    assert!((places[7].0.azimuth_deg - 90.0).abs() < 0.01 && (places[7].0.elevation_deg - 30.0).abs() < 0.01);
    // In front it is exposed for the camera
    let in_front = metered(&lesson.cells[10].scene);
    assert!((in_front / studio().camera.f_number).log2().abs() < 0.02, "f/{in_front}");
}

#[test]
fn distances_and_modifiers_have_one_exposure() {
    let wanted = studio().camera.f_number;
    for (series, least) in [(LessonSeries::Distance, 4), (LessonSeries::Modifier, 8)] {
        let lesson = lesson(series, &studio(), Some(2)).unwrap();
        assert!(lesson.cells.len() >= least && lesson.title.contains("Fill"), "{}", lesson.title);
        for cell in &lesson.cells {
            let number = metered(&cell.scene);
            assert!((number / wanted).log2().abs() < 0.02, "{}: f/{number}", cell.caption);
        }
    }
    let modifiers = lesson(LessonSeries::Modifier, &studio(), None).unwrap();
    assert!(modifiers.cells.iter().all(|cell| NamedModifier::named(&cell.caption).is_some()));
}

#[test]
fn a_white_room_fills_the_shadows() {
    let lesson = lesson(LessonSeries::Room, &studio(), None).unwrap();
    let numbers: Vec<f32> = lesson.cells.iter().map(|cell| metered(&cell.scene)).collect();
    assert!(numbers.len() == 3 && numbers[0] < numbers[1] && 1.05 * numbers[1] < numbers[2], "{numbers:?}");
    assert!(lesson.cells.iter().all(|cell| cell.scene.lights == studio().lights && cell.note.contains("key:fill")));
}

#[test]
fn lights_without_a_place_and_dark_ones_are_refused() {
    let mut scene = studio();
    scene.lights[0].emitter = Emitter::Sun { angular_diameter_deg: 0.5 };
    scene.lights[0].power.output = Output::Lux(1000.0);
    assert!(matches!(lesson(LessonSeries::Azimuth, &scene, Some(1)), Err(LessonError::NoPlace(_))));
    scene.lights.clear();
    assert!(matches!(lesson(LessonSeries::Distance, &scene, None), Err(LessonError::NoLight)));
    let mut dark = studio();
    dark.lights[1].power.output = Output::Lumens(0.0);
    assert!(matches!(lesson(LessonSeries::Modifier, &dark, Some(2)), Err(LessonError::Dark(_))));
}

#[test]
fn a_sheet_has_a_picture_and_a_caption_for_each_cell() {
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let lesson = lesson(LessonSeries::Room, &studio(), None).unwrap();
    let mut observed = Vec::new();
    let mut observe = |index, _: &_| observed.push(index);
    let sheet = LessonSheet::render(lesson, &Assets::default(), 1, &cache, &control, &mut observe).unwrap();
    assert_eq!(observed, [0, 1, 2]);
    let png = sheet.file(LessonFormat::Png).unwrap();
    let image = image::load_from_memory(&png).unwrap().to_rgb8();
    let blank = Canvas::new(image.width(), image.height());
    let shown = image.pixels().zip(&blank.pixels).filter(|(pixel, blank)| pixel.0 != **blank).count();
    assert!(shown > 60_000 && image.width() > 900, "{shown} of {}", blank.pixels.len());
    let html = String::from_utf8(sheet.file(LessonFormat::Html).unwrap()).unwrap();
    let page = roxmltree::Document::parse(html.trim_start_matches("<!DOCTYPE html>")).unwrap();
    let count = |tag: &str| page.descendants().filter(|node| node.has_tag_name(tag)).count();
    assert_eq!((count("figure"), count("img"), count("figcaption")), (3, 3, 3));
    assert!(LessonFormat::of(Path::new("x.pdf")).is_err());
}
