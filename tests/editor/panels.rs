//! Panels: sliders, names, lists, the inspector.

use super::*;
use catchlight::figures;
use catchlight::scene::{Material, MaterialPreset};

#[test]
fn a_slider_drag_is_one_undo_step_and_the_next_one_another() {
    let Some(mut window) = preset_window() else { return };
    let name = scene(&window).lights[0].name.clone();
    click(&mut window, &name);
    let before = scene(&window).lights[0].power.dial_stops;
    for step in 1..=2 {
        let slider = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").rect();
        drag(&mut window, PointerButton::Primary, slider.left_center() + vec2(40.0, 0.0), slider.center());
        let slider = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").rect();
        drag(
            &mut window,
            PointerButton::Primary,
            slider.center(),
            slider.left_center() + vec2(30.0 * step as f32, 0.0),
        );
        assert_eq!(undo_depth(&window), 2 * step);
    }
    for _ in 0..4 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(scene(&window).lights[0].power.dial_stops, before);
}

#[test]
fn a_selected_figure_shows_the_pattern_on_its_face_and_follows_the_key() {
    let Some(mut window) = figure_window() else { return };
    let figure = scene(&window).objects[0].clone();
    click(&mut window, &figure.name);
    let wait_for = |window: &mut Window, pattern: &str| {
        wait_until(window, |app| {
            let face = app.pattern().face(figure.id);
            face.is_some_and(|face| face.is_ok_and(|face| face.lighting.to_string().contains(pattern)))
        });
        settle(window);
        let (first, rest) = pattern.split_at(1);
        let text = first.to_uppercase() + rest;
        assert!(window.query_by_label_contains(&text).is_some(), "{text} is not in the inspector");
    };
    wait_for(&mut window, "loop lighting");
    // Straight before the face, above
    let mut key = scene(&window).lights[0].clone();
    key.position = glam::Vec3::new(0.0, 2.25, 1.1);
    let apply = Command::Apply(Action::SetLight(Box::new(key)));
    window.state_mut().run(apply, None, &egui::Context::default());
    wait_for(&mut window, "butterfly lighting");
}

#[test]
fn keys_are_letters_while_a_name_is_typed() {
    let Some(mut window) = preset_window() else { return };
    let name = scene(&window).lights[0].name.clone();
    let light = window.get_by_label(&name);
    light.click();
    light.click();
    settle(&mut window);
    let field = window.get_by_label("New name");
    assert!(field.is_focused());
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    for (key, letter) in [(Key::R, "r"), (Key::F, "f"), (Key::Num1, "1"), (Key::W, "w")] {
        window.event(Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE });
        window.event(Event::Text(letter.to_owned()));
        window.event(Event::Key { key, physical_key: None, pressed: false, repeat: false, modifiers: Modifiers::NONE });
    }
    settle(&mut window);
    assert!(window.state().rendering().job().is_none() && window.state().central_view() == CentralView::Studio);
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(scene(&window).lights[0].name, "rf1w");
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert_eq!(window.state().central_view(), CentralView::Camera);
}

#[test]
fn a_name_that_is_taken_is_refused_in_plain_words() {
    let Some(mut window) = preset_window() else { return };
    let (first, second) = (scene(&window).lights[0].clone(), scene(&window).lights[1].name.clone());
    let rename = Command::Apply(Action::Rename(Item::Light(first.id), second));
    window.state_mut().run(rename, None, &egui::Context::default());
    settle(&mut window);
    assert_eq!(scene(&window).lights[0].name, first.name);
    assert_eq!(errors(&window).len(), 1);
}

#[test]
fn a_figure_from_the_list_has_its_mesh_and_becomes_the_target_of_new_lights() {
    let Some(mut window) = preset_window_at(1.0) else { return };
    click(&mut window, "Figures");
    click(&mut window, "Add Woman, 34, long hair");
    let Some(Item::Object(id)) = window.state().selection().last() else { panic!("the figure is selected") };
    let shape = scene(&window).object(id).unwrap().shape.clone();
    let mesh = window.state().document().assets().mesh_of(&shape);
    assert!(mesh.is_some_and(|mesh| mesh.triangles.len() > 1000), "{:?}", window.state().toasts());
    window.get_all_by_label("Lights").next().unwrap().click();
    settle(&mut window);
    click(&mut window, "Add Softbox 60 x 60");
    let light = scene(&window).lights.last().unwrap();
    assert!(matches!(light.aim, Aim::Object { object, .. } if object == id));
}

#[test]
fn eyes_and_hair_of_a_figure_take_the_colour_of_a_square_at_a_click() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Figures");
    click(&mut window, "Add Woman, 34, long hair");
    let before = scene(&window).objects.last().unwrap().clone();
    let [blue, red] = [figures::EYE_COLORS[4].material(), MaterialPreset::HairRed.material()];
    for (square, parts, material) in
        [("Eyes: Blue", vec!["iris"], blue), ("Hair colour: red", vec!["hair", "beard", "brows"], red)]
    {
        window.get_by_label(square).scroll_to_me();
        settle(&mut window);
        click(&mut window, square);
        let object = scene(&window).objects.last().unwrap();
        assert!(parts.into_iter().all(|part| *object.material_of(part) == material), "{square}");
        press(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(scene(&window).objects.last().unwrap(), &before, "one step of undo");
    }
}

#[test]
fn clothes_of_a_figure_take_a_colour_at_a_click_and_keep_their_cloth() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Figures");
    click(&mut window, "Add Woman, 34, long hair");
    let before = scene(&window).objects.last().unwrap().clone();
    for (square, part, index) in [("Top colour: Red", "top", 3), ("Shoe colour: White", "shoes", 0)] {
        window.get_by_label(square).scroll_to_me();
        settle(&mut window);
        click(&mut window, square);
        let object = scene(&window).objects.last().unwrap().clone();
        let expected =
            Material { base_color: figures::CLOTH_COLORS[index].base_color, ..before.material_of(part).clone() };
        assert_eq!(*object.material_of(part), expected, "{square}");
        assert_eq!(object.material_of("bottom"), before.material_of("bottom"), "the other garments keep theirs");
        press(&mut window, Modifiers::COMMAND, Key::Z);
        assert_eq!(scene(&window).objects.last().unwrap(), &before, "one step of undo");
    }
}

#[test]
fn the_dome_over_an_iris_is_taken_off_in_the_surface_of_the_iris() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Figures");
    click(&mut window, "Add Woman, 34, long hair");
    let radius = |window: &Window| scene(window).objects.last().unwrap().material_of("iris").textures.dome_radius;
    let before = radius(&window);
    assert!(before > 1.0, "{before}");
    for label in ["Surface of iris", "Over the textures"] {
        // That of the iris is below that of the skin
        window.get_all_by_label(label).last().unwrap().scroll_to_me();
        settle(&mut window);
        window.get_all_by_label(label).last().unwrap().click();
        settle(&mut window);
    }
    assert_eq!(radius(&window), 0.0);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(radius(&window), before, "one step of undo");
}

#[test]
fn shelves_and_the_list_of_studios_fill_with_pictures() {
    let Some(mut window) = preset_window() else { return };
    let wait_for = |window: &mut Window, count: usize| {
        wait_until(window, |app| app.thumbnails().drawn() >= count);
    };
    assert_eq!(window.state().thumbnails().drawn(), 0, "nothing is drawn before it is looked at");
    click(&mut window, "Figures");
    let figures = window.query_all_by(|node| node.label().is_some_and(|l| l.starts_with("Add "))).count();
    wait_for(&mut window, figures);
    press(&mut window, Modifiers::COMMAND, Key::N);
    let studios = catchlight::io::presets().len();
    wait_for(&mut window, figures + studios);
    let drawn = window.state().thumbnails().drawn();
    click(&mut window, "Cancel");
    click(&mut window, "Figures");
    assert_eq!(window.state().thumbnails().drawn(), drawn, "what is drawn is kept");
}

#[test]
fn every_preset_opens_and_every_panel_draws() {
    let Some(mut window) = preset_window() else { return };
    for index in 0..catchlight::io::presets().len() {
        window.state_mut().run(Command::NewFromPreset(index), None, &egui::Context::default());
        settle(&mut window);
        let items: Vec<Item> = {
            let scene = scene(&window);
            let objects = scene.objects.iter().map(|o| Item::Object(o.id));
            let lights = scene.lights.iter().map(|l| Item::Light(l.id));
            objects.chain(lights).chain([Item::Camera, Item::Room]).collect()
        };
        for item in items {
            let select = Command::Select(Some(item));
            window.state_mut().run(select, None, &egui::Context::default());
            // One frame to draw the inspector, one for what it would change.
            window.run_steps(2);
        }
        settle(&mut window);
        let changed = window.state().document().history().undo_label().map(str::to_owned);
        assert_eq!(changed, None, "drawing the inspector changes nothing");
        assert!(errors(&window).is_empty(), "{:?}", errors(&window));
    }
}

#[test]
fn a_typed_title_is_one_step_and_survives_a_click_elsewhere() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].name.clone();
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, "Title").click();
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    for letter in ["D", "u", "s", "k"] {
        window.event(Event::Text(letter.to_owned()));
    }
    settle(&mut window);
    click(&mut window, &light);
    assert_eq!(scene(&window).name, "Dusk");
    assert_eq!(undo_depth(&window), 1);
}

#[test]
fn the_light_meter_reads_in_the_background_follows_the_dial_and_can_be_undone() {
    let Some(mut window) = preset_window() else { return };
    let reading = |window: &Window| window.state().meter().reading().unwrap().as_ref().unwrap().clone();
    assert!(window.state().meter().reading().is_none());
    click(&mut window, "Light meter");
    assert_eq!(window.state().selection().last(), Some(Item::Meter));
    let before = reading(&window);
    let key = before.key().unwrap().clone();
    assert_eq!((before.lights.len(), key.name.as_str()), (scene(&window).lights.len(), "Key softbox"));
    for label in ["Light meter, dome", "No light reaches the meter."] {
        let shown = window.query_by_label(label).is_some();
        assert_eq!(shown, label == "Light meter, dome", "{label}");
    }
    assert!(window.query_by_label_contains("key:fill").is_some());
    assert!(window.query_by_label_contains("Flash 100 %").is_some());
    // A stop less on the key is a stop less at the meter.
    let mut light = scene(&window).lights[0].clone();
    light.power.dial_stops -= 1.0;
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &egui::Context::default());
    settle(&mut window);
    let after = reading(&window);
    let stops = (after.lux_s(&after.lights[0]) / before.lux_s(&before.lights[0])).log2();
    // Both readings are good to 0.15 %.
    assert!((stops + 1.0).abs() < 0.01, "{stops}");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!((scene(&window).meter, undo_depth(&window)), (None, 0));
    assert!(window.query_by_label_contains("key:fill").is_none(), "no meter, no read-out");
}

/// Types into the text field of a label.
pub fn search(window: &mut Window, field: &str, query: &str) {
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, field).click();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(Event::Text(query.to_owned()));
    settle(window);
}

#[test]
fn the_shelf_is_searched_in_all_tabs_and_a_tab_ends_the_search() {
    let Some(mut window) = preset_window() else { return };
    let shown = |window: &Window, name: &str| window.query_by_label(&format!("Add {name}")).is_some();
    assert!(shown(&window, "Octa 120") && !shown(&window, "Chrome ball"));
    search(&mut window, "Search the shelf", "chrome BALL");
    assert!(shown(&window, "Chrome ball") && !shown(&window, "Octa 120"));
    let things = scene(&window).objects.len();
    click(&mut window, "Add Chrome ball");
    assert_eq!(scene(&window).objects.len(), things + 1);
    search(&mut window, "Search the shelf", "unobtainium");
    assert!(window.query_by_label_contains("Nothing on the shelf").is_some());
    window.get_all_by_label("Lights").next().unwrap().click();
    settle(&mut window);
    assert!(shown(&window, "Octa 120") && !shown(&window, "Chrome ball"));
}

#[test]
fn the_list_of_studios_is_grouped_and_searched_while_typing() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::COMMAND, Key::N);
    let below = |window: &Window, name: &str| window.get_by_label(name).rect().top();
    let tops = ["Portrait", "Rembrandt", "Groups", "Family group", "Product", "Continuous light", "Interview"]
        .map(|name| below(&window, name));
    assert!(tops.is_sorted(), "{tops:?}");
    // The field has the focus: what is typed is searched for, and Enter opens the first studio found.
    window.event(Event::Text("tungsten film".to_owned()));
    settle(&mut window);
    assert!(window.query_by_label("Interview").is_some() && window.query_by_label("Rembrandt").is_none());
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(scene(&window).name, "Interview");
    press(&mut window, Modifiers::COMMAND, Key::N);
    assert!(window.query_by_label("Rembrandt").is_some(), "the last search is forgotten");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("Rembrandt").is_none(), "Esc closes the list");
}
