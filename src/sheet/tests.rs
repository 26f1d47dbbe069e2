//! A sheet from scene to file.

use super::content::SheetContent;
use super::drawing::Element;
use super::file::{SheetFormat, sheet_file};
use super::font::Font;
use super::lengths::Units;
use super::page::page;
use super::view::{StudioView, ViewFrom};
use crate::io::bundled_gear;
use crate::photo::Picture;
use crate::photo::meter::{Receptor, nearest_third};
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, RenderControl};
use crate::scene::{
    Aim, Assets, Camera, Emitter, Facing, Gel, Light, LightId, Meter, Modifier, Object, ObjectId, Output, Role, Room,
    Scene, Shape, Transform,
};
use crate::setup::MeteredAt;
use glam::{Vec2, Vec3};

const SUBJECT: Vec3 = Vec3::new(0.0, 1.5, 0.12);

fn flash(id: u32, name: &str, role: Role, emitter: Emitter, position: Vec3, dial_stops: f32) -> Light {
    let output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 20.0 };
    let mut light = Light::new(emitter, output);
    (light.id, light.name, light.role, light.position) = (LightId(id), name.to_owned(), role, position);
    light.aim = Aim::Point(SUBJECT);
    light.power.dial_stops = dial_stops;
    light
}

/// Returns a ball of the size of a head before a sweep, with key, fill, rim and background light.
fn studio() -> Scene {
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let mut background = flash(
        4,
        "Back",
        Role::Background,
        Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 },
        Vec3::new(1.2, 1.2, -0.8),
        -4.0,
    );
    background.aim = Aim::Point(Vec3::new(0.0, 1.5, -2.0));
    let object = |id, name: &str, shape, position| Object {
        id: ObjectId(id),
        transform: Transform::at(position),
        ..Object::new(name, shape)
    };
    Scene {
        name: "Head & <shoulders>".to_owned(),
        description: "Two softboxes".to_owned(),
        camera: Camera {
            position: Vec3::new(0.0, 1.5, 2.62),
            aim: Aim::Point(SUBJECT),
            focal_length_mm: 135.0,
            f_number: 8.0,
            ..Camera::default()
        },
        room: Some(Room { size_m: Vec3::new(6.0, 3.2, 7.0), ..Room::default() }),
        objects: vec![
            object(1, "Head", Shape::Sphere { radius_m: 0.12 }, Vec3::new(0.0, 1.5, 0.0)),
            object(
                2,
                "Grey paper",
                Shape::Sweep { width_m: 2.72, height_m: 2.5, depth_m: 2.5, radius_m: 0.5 },
                Vec3::new(0.0, 0.0, -2.0),
            ),
        ],
        lights: vec![
            flash(1, "Key", Role::Key, softbox, SUBJECT + Vec3::new(1.0, 0.5, 1.0), -2.0),
            flash(2, "Fill", Role::Fill, softbox, SUBJECT + Vec3::new(-1.5, 0.0, 1.5), -4.0),
            flash(3, "Rim", Role::Rim, softbox, SUBJECT + Vec3::new(-0.9, 0.4, -1.2), -3.0),
            background,
        ],
        meter: Some(Meter { position: SUBJECT + Vec3::Z * 0.01, facing: Facing::Camera, receptor: Receptor::Flat }),
        ..Scene::default()
    }
}

fn content(scene: &Scene, units: Units) -> SheetContent {
    let picture = Picture { width: 6, height: 4, rgb: vec![[0.18; 3]; 24] };
    let (cache, control) = (GeometryCache::default(), RenderControl::new());
    SheetContent::new(scene, &Assets::default(), picture, units, bundled_gear(), &cache, &control).unwrap().unwrap()
}

fn text_of(facts: &[(&str, String)], name: &str) -> String {
    facts.iter().find(|(fact, _)| *fact == name).map(|(_, text)| text.clone()).unwrap_or_default()
}

#[test]
fn the_numbers_of_a_sheet_are_those_of_the_scene_and_of_the_meter() {
    let scene = studio();
    let sheet = content(&scene, Units::Metres);
    let own = scene.meter.unwrap();
    let point = MeterPoint { position: own.position, facing: Vec3::Z, receptor: Receptor::Flat };
    let meter = LightMeter::new(&scene, &Assets::default(), own.position).unwrap();
    let reading = meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap().reading;
    let key_lux_s = reading.lux_s(reading.key().unwrap());
    for index in [0, 1] {
        let facts = &sheet.lights[index].facts;
        let exposure = facts.exposure.unwrap();
        let lux_s = reading.lux_s(&reading.lights[index]);
        // N^2 = H S / C
        let f_number = (lux_s * 100.0 / 250.0_f32).sqrt();
        assert!((exposure.f_number / f_number - 1.0).abs() < 1e-3, "{exposure:?} {f_number}");
        assert!((facts.stops_over_key.unwrap() - (lux_s / key_lux_s).log2()).abs() < 1e-3);
        assert_eq!(facts.metered_at, MeteredAt::Subject);
    }
    assert_eq!(text_of(&sheet.subject, "Meter").split(' ').next(), Some(nearest_third(reading.f_number()).as_str()));
    let cells = sheet.lights[0].facts.cells();
    assert_eq!(cells[0], ["Key", "Key"]);
    assert_eq!(cells[2], ["1/4", "\u{2212}2.0 stops, 100 Ws"]);
    // The meter is 1 cm before the subject
    assert_eq!([&cells[3][0], &cells[4][0], &cells[5][0]], ["1.49 m", "2.00 m", "45\u{b0} right"]);
    assert_eq!(content(&scene, Units::Feet).lights[1].facts.cells()[4][0], "4' 11\"");
    assert_eq!(text_of(&sheet.camera, "Distance"), "2.49 m to the subject");
    assert_eq!(text_of(&sheet.subject, "Background"), "Grey paper, 2.13 m behind the subject");
}

#[test]
fn rim_lights_are_metered_turned_to_them_and_background_lights_on_the_background() {
    let scene = studio();
    let sheet = content(&scene, Units::Metres);
    let [rim, back] = [&sheet.lights[2].facts, &sheet.lights[3].facts];
    assert_eq!((rim.metered_at, back.metered_at), (MeteredAt::Rim, MeteredAt::Aim));
    // At half of the key's energy and the same distance: a stop less, but for the key's angle of incidence, whose
    // cosine is 2/3
    let over_key = rim.stops_over_key.unwrap();
    assert!((-0.6..0.0).contains(&over_key), "{over_key}");
    assert!(back.exposure.unwrap().f_number > 1.0);
    assert!((back.aim_m.unwrap() - Vec3::new(1.2, -0.3, 1.2).length()).abs() < 1e-4);
    assert_eq!(rim.aim_m, None);
}

#[test]
fn a_set_up_that_works_has_nothing_to_check_and_faults_are_named() {
    let mut scene = studio();
    // Out of the camera's view, and nothing flares
    scene.lights.truncate(2);
    scene.room.as_mut().unwrap().size_m.x = 5.0;
    assert_eq!(content(&scene, Units::Metres).checks, ["Nothing that a plan can see."]);
    let named = |change: &dyn Fn(&mut Scene), wanted: &str| {
        let mut scene = scene.clone();
        change(&mut scene);
        let checks = content(&scene, Units::Metres).checks;
        assert!(checks.iter().any(|check| check.contains(wanted)), "{wanted}: {checks:?}");
    };
    named(&|scene| scene.lights[0].position.y = 3.0, "\"Key\" does not fit");
    named(&|scene| scene.lights[0].position.y = 2.75, "between \"Key\" and the ceiling");
    named(&|scene| scene.camera.shutter_s = 1.0 / 500.0, "high-speed sync");
    let on_head = |scene: &mut Scene, name: &str| {
        bundled_gear().head(name).unwrap().mount(&mut scene.lights[1]);
        scene.camera.shutter_s = 1.0 / 500.0;
    };
    named(&|scene| on_head(scene, "Monolight 600 Ws, battery"), "Monolight 600 Ws, battery then loses about 4.0 stops");
    named(&|scene| on_head(scene, "Monolight 400 Ws"), "faster than the sync of Monolight 400 Ws (1/250)");
    named(&|scene| scene.lights[1].on = false, "Switched off in the plan: Fill");
    named(&|scene| scene.lights[1].power.output = Output::Lumens(2e6), "of the light is continuous");
    named(
        &|scene| scene.lights[1].position = Vec3::new(0.3, 2.6, -0.6),
        "The stand of \"Fill\" would be in the picture",
    );
    named(&|scene| scene.lights[1].position = Vec3::new(0.2, 1.5, -0.6), "\"Fill\" itself is in the picture (the plan");
    let at_the_camera = |scene: &mut Scene| {
        scene.lights[1].position = Vec3::new(-0.6, 1.7, -1.0);
        scene.lights[1].aim = Aim::Point(scene.camera.position);
    };
    named(&at_the_camera, "\"Fill\" shines at the lens");
    named(&|scene| scene.room.as_mut().unwrap().size_m.x = 12.0, "Cable: ");
    named(&|scene| scene.camera.position.z = 9.0, "camera: ");
    named(
        &|scene| (scene.lights[1].color.gel, scene.lights[1].color.gel_loss_counts) = (Gel::Mired(159.0), false),
        "The gel of \"Fill\" takes 0.9 stops",
    );
    named(&|scene| scene.name = "\u{65e5}".to_owned(), "characters that the font of the PDF lacks");
    let has_flare = |change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        at_the_camera(&mut scene);
        change(&mut scene);
        content(&scene, Units::Metres).checks.iter().any(|check| check.contains("shines at the lens"))
    };
    assert!(has_flare(&|_| ()));
    // 20 degrees off its axis
    let turned = |scene: &mut Scene| scene.lights[1].aim = Aim::Point(scene.camera.position + Vec3::X * 1.3);
    assert!(has_flare(&turned));
    assert!(!has_flare(&|scene| {
        turned(scene);
        scene.lights[1].modifier.grid_deg = Some(30.0);
    }));
    assert!(!has_flare(&|scene| {
        let mut flag = Object::new("Flag", Shape::Box { size_m: Vec3::splat(0.3) });
        (flag.id, flag.transform.position) = (ObjectId(9), Vec3::new(-0.5, 1.65, -0.4));
        scene.objects.push(flag);
    }));
}

#[test]
fn bulbs_suns_and_lights_aimed_by_angles_have_the_numbers_of_their_light() {
    let mut scene = studio();
    // A bulb shines everywhere, whatever its aim
    scene.lights[1].emitter = Emitter::Sphere { radius_m: 0.04 };
    scene.lights[1].aim = Aim::Angles { yaw_deg: 90.0, pitch_deg: 0.0 };
    // From behind, 1.1 m from the backdrop, by angles
    scene.lights[3].aim = Aim::Angles { yaw_deg: 0.0, pitch_deg: 0.0 };
    let mut sun = Light::new(Emitter::Sun { angular_diameter_deg: 0.5 }, Output::Lux(1e4));
    (sun.id, sun.name) = (LightId(9), "Sun".to_owned());
    sun.aim = Aim::Angles { yaw_deg: 180.0, pitch_deg: -30.0 };
    scene.lights.push(sun);
    let sheet = content(&scene, Units::Metres);
    let facts = |index: usize| &sheet.lights[index].facts;
    assert_eq!((facts(1).metered_at, facts(1).aim_m), (MeteredAt::Subject, None));
    assert!(facts(1).exposure.is_some());
    assert_eq!(facts(3).metered_at, MeteredAt::Aim);
    assert!((facts(3).aim_m.unwrap() - 1.2).abs() < 0.01, "{:?}", facts(3).aim_m);
    // It shines along +Z and down: from behind
    let bearing = facts(4).bearing.unwrap();
    assert!((bearing.elevation_deg - 30.0).abs() < 0.01 && bearing.azimuth_deg.abs() > 179.0, "{bearing:?}");
    // A camera that is aimed by angles meters what it sees
    scene.meter = None;
    scene.camera.aim = Aim::Angles { yaw_deg: 0.0, pitch_deg: 0.0 };
    let distance = text_of(&content(&scene, Units::Metres).camera, "Distance");
    assert_eq!(distance, "2.50 m to the subject");
}

#[test]
fn the_key_of_shipped_studios_is_metered_at_the_subject_and_all_lights_have_a_reading() {
    // From the side, from behind alone, aimed past the subject, with gels, through a window
    let chosen = ["split", "rim_low_key", "interview", "gel_portrait", "window_light"];
    for preset in
        crate::io::presets().iter().filter(|preset| chosen.iter().any(|name| preset.file_name.starts_with(name)))
    {
        let loaded = preset.load().unwrap();
        let (cache, control) = (GeometryCache::default(), RenderControl::new());
        let picture = Picture::new(4, 4);
        let gear = bundled_gear();
        let sheet = SheetContent::new(&loaded.scene, &loaded.assets, picture, Units::Metres, gear, &cache, &control);
        let sheet = sheet.unwrap().unwrap();
        let key = sheet.lights.iter().map(|light| &light.facts).find(|facts| facts.stops_over_key == Some(0.0));
        let at = if preset.file_name.starts_with("rim") { MeteredAt::Rim } else { MeteredAt::Subject };
        assert_eq!(key.map(|facts| facts.metered_at), Some(at), "{}", preset.file_name);
        assert!(
            sheet.lights.iter().all(|light| light.facts.stops_over_key.unwrap().abs() < 5.0),
            "{}",
            preset.file_name
        );
        assert!(sheet.subject.iter().any(|(name, _)| *name == "Background"), "{}", preset.file_name);
        let unlit: Vec<_> = sheet.lights.iter().filter(|l| l.facts.is_on && l.facts.exposure.is_none()).collect();
        assert!(unlit.is_empty(), "{}: {unlit:?}", preset.file_name);
    }
}

#[test]
fn a_light_whose_stand_is_seen_needs_a_boom() {
    let mut scene = studio();
    scene.lights[2].position = Vec3::new(0.3, 2.6, -0.6);
    let gear = content(&scene, Units::Metres).gear;
    let count = |name: &str| gear.iter().find(|(_, listed)| listed == name).map_or(0, |(count, _)| *count);
    assert_eq!(count("Flash 400 Ws head"), 4);
    assert_eq!(count("Softbox or panel 60 x 90 cm"), 3);
    assert_eq!((count("Boom with counterweight"), count("Light stand")), (1, 3));
    assert_eq!(count("Grey paper, 2.72 m wide, on a crossbar"), 1);
    assert_eq!(count("Crossbar 2.50 m up, with its two stands"), 1);
}

/// Returns the text of the elements of an XML file.
fn text_of_xml(bytes: &[u8]) -> String {
    let text = std::str::from_utf8(bytes).unwrap();
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).unwrap();
    document.descendants().filter_map(|node| node.text()).map(str::trim).collect::<Vec<_>>().join("\n")
}

#[test]
fn pdf_svg_and_html_hold_the_same_text_and_the_picture() {
    let mut scene = studio();
    scene.lights[0].name = "K\u{e4}y \u{1}\"<b>&".to_owned();
    let sheet = content(&scene, Units::Metres);
    let files =
        [SheetFormat::Pdf, SheetFormat::Svg, SheetFormat::Html].map(|format| sheet_file(&sheet, format).unwrap());
    let pdf = lopdf::Document::load_mem(&files[0]).unwrap();
    assert_eq!(pdf.get_pages().len(), 1);
    let texts = [pdf.extract_text(&[1]).unwrap(), text_of_xml(&files[1]), text_of_xml(&files[2])];
    let shown =
        ["Head & <shoulders>", "K\u{e4}y \"<b>&", "Fill", "135 mm", "Softbox or panel 60 x 90 cm", "1.49 m", "2.00 m"];
    for (text, format) in texts.iter().zip(["pdf", "svg", "html"]) {
        for wanted in shown {
            assert!(text.contains(wanted), "{wanted} is not in the {format}:\n{text}");
        }
    }
    let images = pdf.get_page_images(*pdf.get_pages().values().next().unwrap()).unwrap();
    assert_eq!(images.iter().map(|image| (image.width, image.height)).collect::<Vec<_>>(), [(6, 4)]);
    for file in &files[1..] {
        assert_eq!(String::from_utf8_lossy(file).matches("data:image/jpeg;base64,").count(), 1);
    }
}

fn lowest(elements: &[Element]) -> f32 {
    let of_element = |element: &Element| match element {
        Element::Path { lines, .. } => lines.iter().flatten().map(|point| point.y).fold(0.0, f32::max),
        Element::Text(text) => text.at.y,
        Element::Picture { at, size } | Element::Clipped { at, size, .. } => at.y + size.y,
    };
    elements.iter().map(of_element).fold(0.0, f32::max)
}

#[test]
fn a_sheet_of_many_lights_and_long_names_stays_on_its_page() {
    let mut scene = studio();
    scene.name = "A very long name ".repeat(11);
    scene.description = "words ".repeat(150);
    for id in 5..60 {
        let place = SUBJECT + Vec3::new(0.05 * id as f32 - 1.5, 0.6, 1.2);
        scene.lights.push(flash(id, &format!("{id} {}", "long ".repeat(20)), Role::Fill, Emitter::Point, place, -5.0));
    }
    let sheet = content(&scene, Units::Feet);
    let font = Font::new().unwrap();
    let drawing = page(&sheet, &font);
    assert!(lowest(&drawing.elements) < drawing.size_mm.y - 5.0, "{}", lowest(&drawing.elements));
    let html = String::from_utf8(sheet_file(&sheet, SheetFormat::Html).unwrap()).unwrap();
    assert_eq!(html.matches("<tr>").count(), 1 + scene.lights.len(), "the web page has them all");
}

#[test]
fn plans_are_to_scale_with_the_camera_at_the_bottom() {
    let scene = studio();
    let font = Font::new().unwrap();
    for turn_deg in [0.0_f32, 90.0, 180.0, -100.0] {
        // Turn the camera about the subject
        let mut scene = scene.clone();
        let around = glam::Quat::from_rotation_y(turn_deg.to_radians());
        let away = scene.camera.position - SUBJECT;
        scene.camera.position = SUBJECT + around * away;
        scene.room = None;
        let view = StudioView::new(&scene, &Assets::default(), SUBJECT, &[], ViewFrom::Above);
        let elements = view.elements(Vec2::ZERO, 25.0, &font, Units::Metres);
        let Element::Clipped { elements, .. } = &elements[0] else { panic!("a view is clipped") };
        // The field's lines begin at the camera
        let dashed = elements.iter().find_map(|element| match element {
            Element::Path { lines, stroke: Some(stroke), .. } if stroke.dash_mm.is_some() => Some(lines[0][0]),
            _ => None,
        });
        let camera = dashed.unwrap();
        let subject = elements.iter().find_map(|element| match element {
            Element::Path { lines, stroke: Some(stroke), fill: Some([255, 255, 255]), .. }
                if stroke.color == [200, 30, 30] =>
            {
                Some(lines[0].iter().sum::<Vec2>() / lines[0].len() as f32)
            }
            _ => None,
        });
        let subject = subject.unwrap();
        assert!(camera.y - subject.y > 40.0, "{turn_deg}: {camera} {subject}");
        assert!(((camera - subject).length() - 25.0 * away.length()).abs() < 0.1, "{turn_deg}");
    }
}

#[test]
fn studios_without_lights_room_or_things_have_a_sheet() {
    let sun = Light::new(Emitter::Sun { angular_diameter_deg: 0.5 }, Output::Lux(1e4));
    let odd = Light {
        modifier: Modifier { grid_deg: Some(30.0), ..Modifier::default() },
        ..Light::new(Emitter::Point, Output::Candela(5.0))
    };
    for lights in [vec![], vec![sun], vec![odd]] {
        let scene = Scene { lights, ..Scene::default() };
        let sheet = content(&scene, Units::Metres);
        let pdf = sheet_file(&sheet, SheetFormat::Pdf).unwrap();
        assert!(lopdf::Document::load_mem(&pdf).is_ok());
        assert!(sheet_file(&sheet, SheetFormat::Html).is_ok());
    }
}
