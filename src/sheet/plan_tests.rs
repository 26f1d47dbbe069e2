//! What is drawn in plans and elevations, for the shipped studios and a small one.

use super::content::{MEASURES, SheetContent};
use super::drawing::{Align, Drawing, Element, Text};
use super::font::Font;
use super::label_layout::{PageRect, contains, corners, segment_meets};
use super::lengths::Units;
use super::page::page;
use super::view::{Sight, StudioView, ViewFrom};
use crate::io::bundled_gear;
use crate::photo::Picture;
use crate::raytrace::{GeometryCache, RenderControl};
use crate::scene::{Aim, Assets, Emitter, Light, LightId, Output, Scene};
use glam::{Vec2, Vec3};

const MM_PER_M: f32 = 20.0;
const PEOPLE: [u8; 3] = [222, 203, 188];

/// Returns the elements of a view within its frame, and the frame.
fn drawn(scene: &Scene, assets: &Assets, from: ViewFrom) -> (Vec<Element>, PageRect) {
    let subject = scene.meter.map_or_else(|| scene.aim_point(&scene.camera.aim, scene.camera.position), |m| m.position);
    let sight = |light: &Light| Sight { aim: Some(scene.aim_point(&light.aim, light.position)), target: Some(subject) };
    let sights: Vec<Sight> = scene.lights.iter().map(sight).collect();
    let view = StudioView::new(scene, assets, subject, &sights, from);
    let elements = view.elements(Vec2::ZERO, MM_PER_M, &Font::new().unwrap(), Units::Metres);
    let Some(Element::Clipped { at, size, elements }) = elements.first().cloned() else { panic!("a view is clipped") };
    (elements, [at, at + size])
}

/// Returns the place of the characters of a text.
fn area_of(text: &Text, font: &Font) -> PageRect {
    let width = font.width(&text.text, text.size_mm);
    let left = match text.align {
        Align::Left => text.at.x,
        Align::Center => text.at.x - 0.5 * width,
        Align::Right => text.at.x - width,
    };
    [Vec2::new(left, text.at.y - 0.7 * text.size_mm), Vec2::new(left + width, text.at.y)]
}

#[test]
fn labels_of_shipped_studios_are_in_the_frame_and_cover_neither_each_other_nor_people() {
    let font = Font::new().unwrap();
    for preset in crate::io::presets() {
        let loaded = preset.load().unwrap();
        for from in [ViewFrom::Above, ViewFrom::Side] {
            let (elements, frame) = drawn(&loaded.scene, &loaded.assets, from);
            let name = &preset.file_name;
            let texts: Vec<(&str, PageRect)> = elements
                .iter()
                .filter_map(|element| match element {
                    Element::Text(text) => Some((text.text.as_str(), area_of(text, &font))),
                    _ => None,
                })
                .collect();
            for (index, (text, area)) in texts.iter().enumerate() {
                let fits = area[0].cmpge(frame[0]).all() && area[1].cmple(frame[1]).all();
                assert!(fits, "{name}, {from:?}: {text} is cut off");
                for (other, b) in &texts[..index] {
                    let is_apart = area[0].cmpge(b[1]).any() || b[0].cmpge(area[1]).any();
                    assert!(is_apart, "{name}, {from:?}: {text} covers {other}");
                }
                for element in &elements {
                    let Element::Path { lines, fill: Some(PEOPLE), .. } = element else { continue };
                    let edges = lines.iter().flat_map(|line| line.iter().zip(line.iter().cycle().skip(1)));
                    let mut edges = edges.filter(|(a, b)| segment_meets(*area, **a, **b));
                    assert!(edges.next().is_none(), "{name}, {from:?}: {text} covers a person");
                    assert!(!contains(lines, 0.5 * (area[0] + area[1])), "{name}, {from:?}: {text} is on a person");
                }
            }
        }
    }
}

#[test]
fn every_person_of_the_group_is_named_and_every_light_of_a_studio_is_numbered() {
    for (file, wanted) in
        [("group", ["Woman", "Man", "Child", "3"]), ("product", ["Chrome ball", "Matte tin", "1", "3"])]
    {
        let preset = crate::io::presets().iter().find(|preset| preset.file_name.starts_with(file)).unwrap();
        let loaded = preset.load().unwrap();
        let (elements, _) = drawn(&loaded.scene, &loaded.assets, ViewFrom::Above);
        for name in wanted {
            let is_name = |element: &Element| matches!(element, Element::Text(text) if text.text == name);
            assert!(elements.iter().any(is_name), "{file}: {name}");
        }
    }
}

/// Returns a studio with one light at a point, without things.
fn one_light(position: Vec3) -> Scene {
    let mut light = Light::new(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(1e4));
    (light.id, light.position, light.aim) = (LightId(1), position, Aim::Point(Vec3::Y));
    let mut scene = Scene { lights: vec![light], ..Scene::default() };
    (scene.camera.position, scene.camera.aim) = (Vec3::new(0.0, 1.0, 3.0), Aim::Point(Vec3::Y));
    scene
}

/// Returns the lengths that are written in a view.
fn lengths(scene: &Scene, from: ViewFrom) -> Vec<String> {
    let (elements, _) = drawn(scene, &Assets::default(), from);
    let texts = elements.into_iter().filter_map(|element| match element {
        Element::Text(text) => Some(text.text),
        _ => None,
    });
    texts.filter(|text| text.ends_with(" m")).collect()
}

#[test]
fn distances_are_along_the_floor_heights_over_it_and_the_sheet_says_so() {
    // 2 m away on the floor, and 1.5 m up
    let scene = one_light(Vec3::new(2.0, 2.5, 0.0));
    assert_eq!(lengths(&scene, ViewFrom::Above), ["2.00 m"]);
    assert_eq!(lengths(&scene, ViewFrom::Side), ["2.50 m"], "the height in the elevation");
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    let picture = Picture { width: 6, height: 4, rgb: vec![[0.18; 3]; 24] };
    let gear = bundled_gear();
    let content = SheetContent::new(&scene, &Assets::default(), picture, Units::Metres, gear, &cache, &control);
    let content = content.unwrap().unwrap();
    assert_eq!(content.lights[0].facts.cells()[3][1], "straight to subject");
    let Drawing { elements, size_mm } = page(&content, &Font::new().unwrap());
    for note in MEASURES {
        let found = elements.iter().find_map(|element| match element {
            Element::Text(text) if text.text == note => Some(area_of(text, &Font::new().unwrap())),
            _ => None,
        });
        assert!(found.unwrap()[1].x < size_mm.x - 10.0, "{note}");
    }
}

#[test]
fn a_light_over_the_subject_does_not_hide_it() {
    for height_m in [2.5, 0.2] {
        let scene = one_light(Vec3::new(0.1, height_m, 0.0));
        let (elements, frame) = drawn(&scene, &Assets::default(), ViewFrom::Above);
        let subject = elements.iter().find_map(|element| match element {
            Element::Path { lines, stroke: Some(stroke), .. } if stroke.color == [200, 30, 30] => {
                Some(lines[0].iter().sum::<Vec2>() / lines[0].len() as f32)
            }
            _ => None,
        });
        let subject = subject.unwrap();
        assert!(contains(&[corners(frame)], subject));
        let hides = |element: &Element| match element {
            Element::Path { lines, fill: Some(_), stroke: Some(stroke), .. } => {
                stroke.color != [200, 30, 30] && contains(lines, subject)
            }
            _ => false,
        };
        assert!(!elements.iter().any(hides), "{height_m}");
    }
}
