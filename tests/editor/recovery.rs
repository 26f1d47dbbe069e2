//! Recovery of unsaved studios, and files that other programs change.

use super::files::{PYRAMID, drop_file};
use super::*;
use catchlight::io::{RecoveryFolder, RecoveryInfo};
use catchlight::scene::{Material, MaterialTextures, Object, TextureRef};
use glam::Vec3;
use std::collections::BTreeMap;
use std::time::SystemTime;

fn options(recovery: &Path, initial: Option<&Path>, answers: &[PathBuf]) -> EditorOptions {
    EditorOptions {
        initial: initial.map(|file| StudioSource::File(file.to_owned())),
        dialogs: FileDialogs::scripted(answers.to_vec()),
        recovery_folder: Some(recovery.to_owned()),
        ..EditorOptions::default()
    }
}

/// Returns the unsaved studios that windows keep in a folder.
fn kept(recovery: &Path) -> Vec<String> {
    let windows = std::fs::read_dir(recovery).into_iter().flatten();
    windows.filter_map(|window| std::fs::read_to_string(window.unwrap().path().join("studio.ron")).ok()).collect()
}

/// Draws frames until the kept studios are as expected.
fn wait_for_kept(window: &mut Window, recovery: &Path, expected: impl Fn(&[String]) -> bool) {
    for _ in 0..MOST_FRAMES {
        if expected(&kept(recovery)) {
            return;
        }
        window.step();
    }
    panic!("not kept in {MOST_FRAMES} frames: {:?}", kept(recovery));
}

fn is_offered(window: &Window) -> bool {
    window.query_by_label("Recover").is_some()
}

#[test]
fn an_unsaved_studio_survives_a_crash_and_is_offered_at_the_next_start() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let recovery = folder.path().join("recovery");
    let (file, model) = (folder.path().join("portrait.ron"), folder.path().join("import/pyramid.obj"));
    std::fs::write(&file, catchlight::io::presets()[0].text).unwrap();
    std::fs::create_dir(model.parent().unwrap()).unwrap();
    std::fs::write(&model, PYRAMID).unwrap();
    let mut first = window(options(&recovery, Some(&file), &[]));
    assert!(!is_offered(&first), "nothing was lost before");
    drop_file(&mut first, &model);
    click(&mut first, "Add Octa 120");
    let changed = catchlight::io::write_scene(scene(&first));
    wait_for_kept(&mut first, &recovery, |kept| matches!(kept, [kept] if kept.ends_with(&changed)));
    // The end of the window without its close request is a crash to the next one.
    drop(first);

    let mut second = window(options(&recovery, None, &[]));
    assert!(is_offered(&second));
    assert_eq!(second.get_all_by_label_contains("portrait.ron").count(), 2, "the question names title and file");
    wait_until(&mut second, |app| app.thumbnails().drawn() == 1);
    let picture = second.get_by_label("Picture of the unsaved studio").rect();
    assert!(picture.width() > 80.0 && picture.height() > 80.0, "{picture}");
    // What this window has changed meanwhile is not thrown away unasked
    let lights = scene(&second).lights.iter().map(|light| light.id).collect();
    second.state_mut().run(Command::Apply(Action::Mute(lights, true)), None, &egui::Context::default());
    settle(&mut second);
    click(&mut second, "Recover");
    assert!(second.state().document().is_dirty() && second.query_by_label("Don't save").is_some());
    click(&mut second, "Don't save");
    let document = second.state().document();
    assert_eq!(catchlight::io::write_scene(document.scene()), changed);
    assert!(document.is_dirty() && document.path() == Some(&file));
    assert!(document.assets().mesh("import/pyramid.obj").is_some());
    assert_eq!(kept(&recovery).len(), 1, "it is kept until it is saved");
    press(&mut second, Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), changed);
    wait_for_kept(&mut second, &recovery, <[String]>::is_empty);
}

#[test]
fn a_rendered_picture_survives_a_crash_with_its_lights_until_it_is_exported() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (recovery, file, exported) =
        (folder.path().join("recovery"), folder.path().join("portrait.ron"), folder.path().join("portrait.png"));
    std::fs::write(&file, catchlight::io::presets()[0].text).unwrap();
    let mut first = window(options(&recovery, Some(&file), &[]));
    render_tiny(&mut first);
    let picture = |window: &Window| window.state().rendering().developed().unwrap().picture.clone();
    let rendered = picture(&first);
    assert!(!first.state().document().is_dirty());
    wait_for_kept(&mut first, &recovery, |kept| kept.len() == 1);
    drop(first);

    let mut second = window(options(&recovery, None, std::slice::from_ref(&exported)));
    assert!(is_offered(&second));
    assert!(second.query_by_label_contains("before the picture of \"portrait.ron\" was exported").is_some());
    second.state_mut().rendering_mut().settings.denoise = false;
    click(&mut second, "Recover");
    assert!(second.state().rendering().job().is_some(), "{:?}", second.state().toasts().texts(ToastKind::Warning));
    wait_until(&mut second, |app| app.rendering().developed().is_some());
    assert_eq!(picture(&second), rendered);
    assert!(second.query_by_label("2 of 2 samples").is_some(), "the bar is full");
    let document = second.state().document();
    assert!(!document.is_dirty() && document.path() == Some(&file), "the studio was saved");
    assert!(!second.state().rendering().is_out_of_date(document.scene()));
    // The lights can still be changed.
    let name = format!("{} on", scene(&second).lights[0].name);
    click(&mut second, &name);
    let sum = |picture: &catchlight::photo::Picture| picture.rgb.iter().flatten().sum::<f32>();
    assert!(sum(&picture(&second)) < 0.98 * sum(&rendered));
    press(&mut second, Modifiers::COMMAND, Key::Z);
    assert_eq!(picture(&second), rendered);
    // Once it is on the disk it need not be kept.
    assert_eq!(kept(&recovery).len(), 1);
    second.state_mut().run(Command::ExportPicture, None, &egui::Context::default());
    wait_for_kept(&mut second, &recovery, <[String]>::is_empty);
    assert!(exported.exists(), "{:?}", errors(&second));
    let window = std::fs::read_dir(&recovery).unwrap().next().unwrap().unwrap();
    let left: Vec<_> = std::fs::read_dir(window.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(left, ["lock"], "nothing of the picture is left");
}

#[test]
fn a_running_window_keeps_its_unsaved_studio_to_itself_and_a_closed_one_leaves_none() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut running = window(options(folder.path(), None, &[]));
    click(&mut running, "Add Octa 120");
    wait_for_kept(&mut running, folder.path(), |kept| kept.len() == 1);
    assert!(RecoveryFolder::abandoned(folder.path()).is_empty(), "another window does not offer it");
    // The user closes the window and does not save.
    running.state().end_recovery();
    assert!(kept(folder.path()).is_empty());
    click(&mut running, "Add Octa 120");
    running.run_steps(90);
    assert!(kept(folder.path()).is_empty());
}

#[test]
fn an_offered_studio_can_be_put_off_and_discarded() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let info = RecoveryInfo {
        title: "Crashed".to_owned(),
        path: None,
        stamp: None,
        imported: BTreeMap::new(),
        changed_at: SystemTime::now(),
        is_saved: false,
    };
    let crashed = RecoveryFolder::create(folder.path()).unwrap();
    crashed.write(&Scene::default(), &info).unwrap();
    drop(crashed);
    let mut later = window(options(folder.path(), None, &[]));
    click(&mut later, "Later");
    assert!(!is_offered(&later) && kept(folder.path()).len() == 1);
    drop(later);
    let mut discarding = window(options(folder.path(), None, &[]));
    let opened = scene(&discarding).clone();
    // The buttons stay where they are when the picture arrives, whatever its shape.
    wait_until(&mut discarding, |app| app.thumbnails().drawn() == 1);
    let picture = discarding.get_by_label("Picture of the unsaved studio").rect();
    assert_eq!(picture.width(), picture.height(), "the frame is that of the picture");
    click(&mut discarding, "Discard");
    assert!(!is_offered(&discarding) && kept(folder.path()).is_empty());
    assert_eq!(*scene(&discarding), opened);
}

#[test]
fn a_file_that_another_program_has_changed_is_not_overwritten_without_a_question() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (file, other) = (folder.path().join("portrait.ron"), folder.path().join("mine.ron"));
    let presets = catchlight::io::presets();
    std::fs::write(&file, presets[0].text).unwrap();
    let mut window = window(EditorOptions {
        initial: Some(StudioSource::File(file.clone())),
        dialogs: FileDialogs::scripted([other.clone()]),
        ..EditorOptions::default()
    });
    let on_disk = || std::fs::read_to_string(&file).unwrap();
    // Without a change from outside a save asks nothing.
    click(&mut window, "Add Octa 120");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(on_disk(), catchlight::io::write_scene(scene(&window)));

    // Take theirs.
    click(&mut window, "Add Octa 120");
    std::fs::write(&file, presets[1].text).unwrap();
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(on_disk(), presets[1].text);
    click(&mut window, "Take theirs");
    assert_eq!(catchlight::io::write_scene(scene(&window)), presets[1].text);
    assert!(!window.state().document().is_dirty());

    // Keep mine.
    click(&mut window, "Add Octa 120");
    std::fs::write(&file, presets[2].text).unwrap();
    press(&mut window, Modifiers::COMMAND, Key::S);
    click(&mut window, "Keep mine");
    assert_eq!(on_disk(), catchlight::io::write_scene(scene(&window)));
    assert!(!window.state().document().is_dirty());

    // Keep both.
    click(&mut window, "Add Octa 120");
    std::fs::write(&file, presets[2].text).unwrap();
    press(&mut window, Modifiers::COMMAND, Key::S);
    click(&mut window, "Save as\u{2026}");
    assert_eq!(on_disk(), presets[2].text);
    assert_eq!(std::fs::read_to_string(&other).unwrap(), catchlight::io::write_scene(scene(&window)));
    assert!(errors(&window).is_empty(), "{:?}", errors(&window));
}

/// Tells the window that it has the keyboard or not.
fn set_focus(window: &mut Window, focused: bool) {
    window.input_mut().viewports.get_mut(&ViewportId::ROOT).unwrap().focused = Some(focused);
    settle(window);
}

#[test]
fn a_texture_that_another_program_has_painted_is_read_again_when_the_window_is_used_again() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (studio, picture) = (folder.path().join("studio.ron"), folder.path().join("paper.png"));
    let paint = |rgb: [u8; 3]| image::RgbImage::from_pixel(4, 4, image::Rgb(rgb)).save(&picture).unwrap();
    paint([200, 40, 40]);
    let texture = TextureRef::file("paper.png");
    let textures = MaterialTextures::with_base_color(texture.clone());
    let board = Object {
        material: Material { textures, ..Material::default() },
        ..Object::new("Board", Shape::Box { size_m: Vec3::ONE })
    };
    catchlight::io::save_scene(&Scene { objects: vec![board], ..Scene::default() }, &studio).unwrap();
    let mut window = window(EditorOptions { initial: Some(StudioSource::File(studio)), ..EditorOptions::default() });
    let color = |window: &Window| window.state().document().assets().texture(&texture).unwrap().rgb[0];
    set_focus(&mut window, true);
    assert_eq!(color(&window), [200, 40, 40]);
    set_focus(&mut window, false);
    set_focus(&mut window, true);
    let said = |window: &Window, kind: ToastKind| {
        let texts = window.state().toasts().texts(kind);
        texts.into_iter().filter(|text| text.contains("paper.png")).map(str::to_owned).collect::<Vec<String>>()
    };
    assert!(said(&window, ToastKind::Info).is_empty(), "nothing has changed");
    render_tiny(&mut window);
    let is_out_of_date = |window: &Window| window.query_all_by_label_contains("Out of date").next().is_some();
    assert!(!is_out_of_date(&window));

    // Half a file is not taken, and the whole one is at the next time
    set_focus(&mut window, false);
    std::fs::write(&picture, "half").unwrap();
    set_focus(&mut window, true);
    assert_eq!((color(&window), said(&window, ToastKind::Warning).len()), ([200, 40, 40], 1));
    set_focus(&mut window, false);
    paint([40, 40, 200]);
    set_focus(&mut window, true);
    assert_eq!(color(&window), [40, 40, 200]);
    assert_eq!(said(&window, ToastKind::Info), ["Changed by another program, and read again: paper.png."]);
    assert!(is_out_of_date(&window), "the picture shows the former texture");
    assert!(!window.state().document().is_dirty());
}

#[test]
fn a_change_by_another_window_is_noticed_when_this_one_is_used_again() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("portrait.ron");
    let presets = catchlight::io::presets();
    std::fs::write(&file, presets[0].text).unwrap();
    let mut window =
        window(EditorOptions { initial: Some(StudioSource::File(file.clone())), ..EditorOptions::default() });
    set_focus(&mut window, false);
    set_focus(&mut window, true);
    assert!(window.query_by_label("Take theirs").is_none(), "nothing has changed");
    set_focus(&mut window, false);
    std::fs::write(&file, presets[1].text).unwrap();
    set_focus(&mut window, true);
    assert!(!window.state().document().is_dirty());
    click(&mut window, "Keep mine");
    assert!(window.state().document().is_dirty(), "the file is not what the window shows");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), presets[0].text);
}
