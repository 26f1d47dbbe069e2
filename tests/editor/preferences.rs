//! Preferences: scale, theme, units of lengths, meter constant.

use super::*;
use catchlight::sheet::Units;
use egui::Theme;

fn preferences_in(folder: &Path) -> EditorOptions {
    EditorOptions { settings_folder: Some(folder.to_owned()), ..EditorOptions::default() }
}

#[test]
fn preferences_take_effect_at_once_and_at_the_next_start() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut first = window(preferences_in(folder.path()));
    let light = scene(&first).lights[0].name.clone();
    click(&mut first, &light);
    let in_feet = |window: &Window| {
        let is_in_feet = |label: String| label.contains(" at ") && label.contains("' ") && !label.contains(" m");
        window.query_all_by(|node| node.value().or(node.label()).is_some_and(is_in_feet)).count() > 0
    };
    assert!(!in_feet(&first) && first.ctx.theme() == Theme::Dark);
    press(&mut first, Modifiers::COMMAND, Key::Comma);
    click(&mut first, "Feet");
    // After the menu of that name and the button that places a light
    first.get_all_by_label("Light").last().unwrap().click();
    settle(&mut first);
    press(&mut first, Modifiers::COMMAND, Key::Plus);
    click(&mut first, "330");
    let kept = *first.state().preferences();
    assert_eq!((kept.scale, kept.units, kept.meter_constant), (1.1, Units::Feet, 330.0));
    assert!(in_feet(&first) && first.ctx.theme() == Theme::Light);
    assert_eq!(first.ctx.zoom_factor(), 1.1);
    press(&mut first, Modifiers::NONE, Key::Escape);
    assert!(first.query_by_label("Feet").is_none(), "Esc closes the window");
    assert_eq!(undo_depth(&first), 0, "preferences are no change of the studio");
    drop(first);

    let mut second = window(preferences_in(folder.path()));
    assert_eq!(*second.state().preferences(), kept);
    assert_eq!((second.ctx.theme(), second.ctx.zoom_factor()), (Theme::Light, 1.1));
    let light = scene(&second).lights[0].id;
    select(&mut second, &[Item::Light(light)]);
    assert!(in_feet(&second));
    press(&mut second, Modifiers::COMMAND, Key::Comma);
    click(&mut second, "As delivered");
    assert_eq!(*second.state().preferences(), Preferences::default());
    assert!(second.ctx.theme() == Theme::Dark && second.ctx.zoom_factor() == 1.0 && !in_feet(&second));
}

#[test]
fn new_studios_have_the_preferred_meter_constant_and_are_as_bright() {
    let Some(mut window) = preset_window() else { return };
    let before = catchlight::io::presets()[0].scene().unwrap().camera;
    let preferences = Preferences { meter_constant: 500.0, ..Preferences::default() };
    run(&mut window, Command::SetPreferences(preferences));
    assert_eq!(scene(&window).camera.meter_constant, 250.0, "the open studio keeps its own");
    for (new, f_number) in [(Command::NewFromPreset(0), before.f_number), (Command::NewEmpty, 5.6)] {
        run(&mut window, new);
        let camera = &scene(&window).camera;
        assert_eq!(camera.meter_constant, 500.0);
        // Twice the constant is a stop: the f-number over the square root of two.
        assert!((camera.f_number * 2.0_f32.sqrt() / f_number - 1.0).abs() < 0.03, "{}", camera.f_number);
        assert!(!window.state().document().is_dirty());
    }
}
