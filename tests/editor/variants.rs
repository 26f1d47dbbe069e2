//! Variants of a studio in the window: shown, changed, saved, compared.

use super::*;
use catchlight::scene::VariantId;

fn run(window: &mut Window, command: Command) {
    window.state_mut().run(command, None, &egui::Context::default());
    settle(window);
}

fn shown(window: &Window) -> &str {
    let variants = &scene(window).variants;
    variants.name(variants.shown()).unwrap()
}

fn dim_key(window: &mut Window, stops: f32) {
    let mut key = scene(window).lights[0].clone();
    key.power.dial_stops += stops;
    run(window, Command::Apply(Action::SetLight(Box::new(key))));
}

#[test]
fn a_variant_is_added_changed_shown_by_keys_saved_and_made_the_studio() {
    let Some(mut window) = preset_window() else { return };
    assert!(window.query_by_label("Variant A").is_none(), "a studio without variants has no row");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num2);
    settle(&mut window);
    assert!(window.state().toasts().texts(ToastKind::Info)[0].contains("no variants"));
    run(&mut window, Command::AddVariant);
    assert_eq!(shown(&window), "B");
    let dial = scene(&window).lights[0].power.dial_stops;
    dim_key(&mut window, -1.0);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    settle(&mut window);
    assert_eq!((shown(&window), scene(&window).lights[0].power.dial_stops), ("A", dial));
    click(&mut window, "Variant B");
    assert_eq!((shown(&window), scene(&window).lights[0].power.dial_stops), ("B", dial - 1.0));

    // A save writes the studio itself, and showing another variant is no change
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.ron");
    run(&mut window, Command::UseFile(catchlight::editor::FilePurpose::SaveScene, file.clone()));
    assert!(!window.state().document().is_dirty(), "{:?}", errors(&window));
    click(&mut window, "Variant A");
    assert!(!window.state().document().is_dirty());
    let saved = catchlight::io::load_scene(&file).unwrap().scene;
    assert_eq!((saved.lights[0].power.dial_stops, saved.variants.others.len()), (dial, 1));

    // Undo shows the variant that it changes
    run(&mut window, Command::Undo);
    assert_eq!((shown(&window), scene(&window).lights[0].power.dial_stops), ("B", dial));
    run(&mut window, Command::Redo);
    assert_eq!(scene(&window).lights[0].power.dial_stops, dial - 1.0);

    let b = scene(&window).variants.shown();
    run(&mut window, Command::Apply(Action::MakeStudio(b)));
    assert_eq!((scene(&window).variants.studio_id, shown(&window)), (b, "B"));
    assert!(window.state().document().is_dirty());
    click(&mut window, "Variant A");
    assert_eq!(scene(&window).lights[0].power.dial_stops, dial);
    run(&mut window, Command::Undo);
    assert_eq!(scene(&window).variants.studio_id, VariantId(0));
}

#[test]
fn a_variant_is_renamed_and_deleted_in_the_row() {
    let Some(mut window) = preset_window() else { return };
    run(&mut window, Command::AddVariant);
    let b = scene(&window).variants.shown();
    run(&mut window, Command::BeginRenameVariant(b));
    let field = window.get_by_label("Name of the variant");
    field.type_text(" dimmer");
    window.step();
    window.key_press(Key::Enter);
    settle(&mut window);
    assert_eq!(shown(&window), "B dimmer");
    run(&mut window, Command::Apply(Action::RenameVariant(b, "A".to_owned())));
    assert!(errors(&window)[0].contains("Another variant"), "{:?}", errors(&window));
    run(&mut window, Command::Apply(Action::DeleteVariant(b)));
    assert!(scene(&window).variants.is_empty() && window.query_by_label("Variant A").is_none());
    run(&mut window, Command::Apply(Action::DeleteVariant(VariantId(0))));
    assert!(errors(&window).iter().any(|error| error.contains("studio itself")), "{:?}", errors(&window));
}

#[test]
fn pictures_of_variants_are_kept_and_compared_in_stops() {
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    run(&mut window, Command::ShowView(CentralView::Picture));
    let sum =
        |window: &Window| -> f32 { window.state().rendering().developed().unwrap().picture.rgb.iter().flatten().sum() };
    let of_a = sum(&window);
    // Another light alone needs no render: the layers are shared
    run(&mut window, Command::AddVariant);
    let lights = scene(&window).lights.clone();
    let dimmed = lights.iter().map(|light| {
        let mut light = light.clone();
        light.power.dial_stops -= 1.0;
        Action::SetLight(Box::new(light))
    });
    run(&mut window, Command::Apply(Action::Together { label: "Dim".to_owned(), actions: dimmed.collect() }));
    assert!((sum(&window) / of_a - 0.5).abs() < 1e-3, "{}", sum(&window) / of_a);
    assert!(window.query_by_label("Out of date").is_none());

    // A variant that was seen before there was a picture takes one, too
    run(&mut window, Command::ShowVariantAt(0));
    run(&mut window, Command::ShowVariantAt(1));
    let difference = Comparison { mode: CompareMode::Difference, with: None };
    run(&mut window, Command::Compare(difference));
    let app = window.state();
    let (_, mean) = app.variant_pictures().difference(app.rendering(), difference).unwrap().unwrap();
    // Black shadows count as equal
    assert!(mean > 0.5 && mean < 1.001, "{mean}");

    for mode in [CompareMode::Wipe, CompareMode::SideBySide] {
        run(&mut window, Command::Compare(Comparison { mode, with: None }));
        assert_eq!(window.query_by_label("Wipe line").is_some(), mode == CompareMode::Wipe);
    }
    // The picture of A is there again, with the switches of B unchanged
    click(&mut window, "Variant A");
    assert_eq!(sum(&window), of_a);
    // A variant that needs another trace has no picture, until it is rendered
    run(&mut window, Command::AddVariant);
    let mut camera = scene(&window).camera.clone();
    camera.position.x += 0.3;
    run(&mut window, Command::Apply(Action::SetCamera(Box::new(camera))));
    let now = scene(&window).clone();
    assert!(window.state().rendering().is_out_of_date(&now));
    click(&mut window, "Render the picture");
    assert!(!window.state().rendering().is_out_of_date(&now));
    click(&mut window, "Variant B");
    assert!((sum(&window) / of_a - 0.5).abs() < 1e-3);
}

#[test]
fn a_render_goes_on_while_another_variant_is_shown() {
    let Some(mut window) = preset_window() else { return };
    run(&mut window, Command::AddVariant);
    let mut camera = scene(&window).camera.clone();
    camera.position.x += 0.3;
    run(&mut window, Command::Apply(Action::SetCamera(Box::new(camera))));
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(48, 32);
    // More than end within this test
    rendering.settings.samples = 60_000;
    rendering.settings.quality = Quality::Custom;
    let ctx = egui::Context::default();
    window.state_mut().run(Command::Render, None, &ctx);
    window.state_mut().run(Command::ShowVariantAt(0), None, &ctx);
    window.state_mut().run(Command::Render, None, &ctx);
    assert!(window.state().toasts().texts(ToastKind::Info)[0].contains("is being rendered"));
    window.state_mut().run(Command::ShowVariantAt(1), None, &ctx);
    window.state_mut().run(Command::CancelRender, None, &ctx);
    settle(&mut window);
    window.state_mut().rendering_mut().settings.samples = 2;
    click(&mut window, "Render the picture");
    run(&mut window, Command::ShowVariantAt(0));
    let app = window.state();
    let b = app.document().scene().variants.named("B").unwrap();
    assert!(app.variant_pictures().has_picture(b), "it is kept for B");
    assert_eq!(app.rendering().settings.samples, 2, "the settings are those of the window");
}
