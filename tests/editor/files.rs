//! Opening, saving, dropping and importing of files, invalid files, unsaved changes.

use super::*;
use catchlight::io::{PictureInfo, export_picture};
use catchlight::photo::Picture;
use catchlight::scene::TextureSlot;

/// A file on the desktop.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub fn drop_file(window: &mut Window, path: &Path) {
    window.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    settle(window);
}

pub const PYRAMID: &str = "o Pyramid\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";

#[test]
fn unsaved_changes_prompt_before_they_are_lost() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("kept.ron");
    let mut window = window_with_answers([file.clone()]);
    assert!(close_requested(&mut window), "nothing to lose, so it closes");
    click(&mut window, "Add Octa 120");
    assert!(!close_requested(&mut window));
    click(&mut window, "Cancel");
    let changed = scene(&window).clone();

    press(&mut window, Modifiers::COMMAND, Key::N);
    click(&mut window, "Split");
    click(&mut window, "Open this studio");
    assert_eq!(*scene(&window), changed, "it asks first");
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert!(file.exists());
    assert_ne!(*scene(&window), changed, "and then goes on");

    click(&mut window, "Add Octa 120");
    assert!(!close_requested(&mut window));
    window.get_by_label("Don't save").click();
    window.run_steps(3);
    settle(&mut window);
    assert!(close_requested(&mut window), "told to lose the changes, it closes");
}

#[test]
fn a_picture_that_took_long_is_not_lost_unasked() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with_answers([folder.path().join("picture.png")]);
    render_tiny(&mut window);
    assert!(close_requested(&mut window), "this one did not take long");
    window.state_mut().rendering_mut().long_render = Duration::ZERO;
    assert!(!close_requested(&mut window));
    click(&mut window, "Cancel");
    assert!(!close_requested(&mut window));
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert!(folder.path().join("picture.png").exists());
    assert!(close_requested(&mut window), "exported, it is not lost");
}

#[test]
fn an_empty_studio_is_shown_in_a_work_light_until_a_light_is_on() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::COMMAND, Key::N);
    click(&mut window, "Empty studio");
    let empty = scene(&window);
    assert!(empty.lights.is_empty() && empty.objects.is_empty() && empty.room.is_some());
    assert!(!window.state().document().is_dirty() && window.state().document().path().is_none());
    let brightness = |window: &mut Window| {
        let (picture, view) = (window.render().unwrap(), window.get_by_label("Viewport").rect());
        let middle = (view.center() + vec2(0.0, 100.0)) * window.ctx.pixels_per_point();
        picture.get_pixel(middle.x as u32, middle.y as u32).0[0]
    };
    assert!(brightness(&mut window) > 60, "the floor can be seen: {}", brightness(&mut window));
    // In the picture there is no such light
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert!(brightness(&mut window) < 10, "{}", brightness(&mut window));
}

/// Writes a model, drops it onto a window that saves to `file`, and returns the window and the model's path.
fn window_with_pyramid(folder: &Path, file: &Path) -> (Window, PathBuf) {
    let model = folder.join("pyramid.obj");
    std::fs::write(&model, PYRAMID).unwrap();
    let mut window = window_with_answers([file.to_owned()]);
    drop_file(&mut window, &model);
    (window, model)
}

#[test]
fn a_copied_model_takes_its_file_along_into_the_studio_of_another_window() {
    if !has_adapter() {
        return;
    }
    let (desktop, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (mut first, _) = window_with_pyramid(desktop.path(), &desktop.path().join("first.ron"));
    let text = copied_text(&mut first);
    let file = home.path().join("second.ron");
    let mut second = window_with_answers([file.clone()]);
    second.event(Event::Paste(text.clone()));
    settle(&mut second);
    let path = |window: &Window| match &scene(window).objects.last().unwrap().shape {
        Shape::MeshFile { path } => path.clone(),
        other => panic!("{other:?}"),
    };
    assert!(second.state().document().assets().mesh(&path(&second)).is_some(), "{:?}", errors(&second));
    press(&mut second, Modifiers::COMMAND, Key::S);
    assert!(home.path().join(path(&second)).exists());
    // In the window that it comes from it is no other model
    let name = path(&first);
    first.event(Event::Paste(text));
    settle(&mut first);
    assert_eq!(path(&first), name);
}

#[test]
fn files_can_be_dropped_and_models_travel_with_the_studio() {
    if !has_adapter() {
        return;
    }
    let (desktop, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let file = home.path().join("studio.ron");
    let (mut window, _) = window_with_pyramid(desktop.path(), &file);
    let object = scene(&window).objects.last().unwrap().clone();
    assert_eq!(object.name, "pyramid");
    assert!(matches!(&object.shape, Shape::MeshFile { path } if path == "models/pyramid.obj"), "{:?}", object.shape);
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(home.path().join("models/pyramid.obj").exists(), "{:?}", errors(&window));

    drop_file(&mut window, &desktop.path().join("notes.txt"));
    assert_eq!(errors(&window).len(), 1);
    let other = desktop.path().join("other.ron");
    std::fs::write(&other, catchlight::io::presets()[3].text).unwrap();
    drop_file(&mut window, &other);
    assert_eq!(window.state().document().path(), Some(other.as_path()));
    drop_file(&mut window, &file);
    let reopened = window.state().document();
    assert!(reopened.assets().mesh("models/pyramid.obj").is_some());
}

#[test]
fn a_model_in_millimetres_is_as_large_as_the_thing_and_stays_on_the_floor_when_its_height_is_set() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("bottle.obj");
    std::fs::write(&model, "v -40 -150 0\nv 40 -150 0\nv 0 150 0\nv 0 -150 40\nf 1 2 3\nf 2 4 3\nf 4 1 3\nf 1 4 2\n")
        .unwrap();
    let mut window = window_with_answers([]);
    drop_file(&mut window, &model);
    let bottle = |window: &Window| scene(window).objects.last().unwrap().transform;
    assert_eq!(bottle(&window).scale, glam::Vec3::splat(0.001));
    assert!((bottle(&window).position.y - 0.15).abs() < 1e-5, "{:?}", bottle(&window));
    let told = window.state().toasts().texts(ToastKind::Info);
    assert!(told.iter().any(|text| text.contains("in mm: 30.0 cm high")), "{told:?}");
    click(&mut window, "cm");
    assert!((bottle(&window).scale.y - 0.01).abs() < 1e-6 && (bottle(&window).position.y - 1.5).abs() < 1e-4);
    run(&mut window, Command::Undo);
    assert_eq!(bottle(&window).scale, glam::Vec3::splat(0.001), "one step");
}

#[test]
fn a_model_whose_file_was_deleted_after_the_import_is_saved_with_the_studio() {
    if !has_adapter() {
        return;
    }
    let (desktop, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let file = home.path().join("studio.ron");
    let (mut window, model) = window_with_pyramid(desktop.path(), &file);
    std::fs::remove_file(&model).unwrap();
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(errors(&window).is_empty(), "{:?}", errors(&window));
    let loaded = catchlight::io::load_scene(&file).unwrap();
    assert_eq!(loaded.warnings, []);
    let pyramid = loaded.assets.mesh("models/pyramid.obj").unwrap();
    assert_eq!((pyramid.triangles.len(), pyramid.parts[0].name.as_str()), (4, "Pyramid"));
}

#[test]
fn an_invalid_file_is_reported_and_leaves_the_open_studio_unchanged() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with_answers([]);
    let before = scene(&window).clone();
    let whole = catchlight::io::presets()[0].text;
    let broken = [&whole[..whole.len() / 2], "", "(format: 99)", "[[[[", &whole.replace("f_number", "f_numbr")];
    for (i, text) in broken.into_iter().enumerate() {
        let file = folder.path().join(format!("broken {i}.ron"));
        std::fs::write(&file, text).unwrap();
        drop_file(&mut window, &file);
        let told = errors(&window);
        assert!(told.last().is_some_and(|t| t.contains(&format!("broken {i}.ron"))), "{told:?}");
    }
    drop_file(&mut window, &folder.path().join("gone.ron"));
    let bad_model = folder.path().join("bad.obj");
    std::fs::write(&bad_model, "f 1 2 9\n").unwrap();
    drop_file(&mut window, &bad_model);
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 0));
    let shown = errors(&window).len();
    window.get_all_by_label("Dismiss").next().unwrap().click();
    settle(&mut window);
    assert_eq!(errors(&window).len(), shown - 1);
}

#[test]
fn without_desktop_dialogs_a_prompt_takes_the_path() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("typed.ron");
    let answers = VecDeque::from([DialogAnswer::Unavailable, DialogAnswer::Cancelled]);
    let mut window = window(EditorOptions { dialogs: FileDialogs::Scripted(answers), ..EditorOptions::default() });
    press(&mut window, Modifiers::COMMAND, Key::S);
    let field = window.get_by_label("Path");
    field.set_text_value_accesskit(&file.to_string_lossy());
    settle(&mut window);
    click(&mut window, "Save here");
    assert!(file.exists(), "{:?}", errors(&window));
}

#[test]
fn a_set_up_sheet_is_exported_from_the_menu_with_the_rendered_picture() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let [metres, feet, wrong] = ["plan.html", "plan", "plan.txt"].map(|name| folder.path().join(name));
    let mut window = window_with_answers([metres.clone(), feet.clone(), wrong.clone()]);
    render_tiny(&mut window);
    let size = window.state().rendering().size().unwrap();
    let mut export = |entry: &str, kind: ToastKind| {
        click(&mut window, "File");
        window.get_by_label_contains(entry).click();
        settle(&mut window);
        window.state().toasts().texts(kind).last().map_or_else(String::new, |text| (*text).to_owned())
    };
    assert!(export("set-up sheet\u{2026}", ToastKind::Info).starts_with("Set-up sheet written to"));
    let html = std::fs::read_to_string(metres).unwrap();
    assert!(html.contains("Three-point portrait") && html.contains("1.42 m"), "{}", html.len());
    let picture = html.split("base64,").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
    assert!(picture.len() < 20_000, "the picture of {size:?} pixels, not a larger one");
    export("sheet in feet\u{2026}", ToastKind::Info);
    assert!(std::fs::read(feet.with_extension("pdf")).unwrap().starts_with(b"%PDF"), "without extension it is a PDF");
    assert!(export("set-up sheet\u{2026}", ToastKind::Error).contains(".pdf, .svg or .html"));
    assert!(!wrong.exists());
}

#[test]
fn a_lesson_sheet_is_exported_for_the_selected_light() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let [lesson, wrong] = ["lesson.html", "lesson.pdf"].map(|name| folder.path().join(name));
    // A ball in the figure's place: a lesson has three renders
    let mut studio = catchlight::io::presets()[0].scene().unwrap();
    for object in &mut studio.objects {
        if matches!(object.shape, Shape::Figure(_)) {
            object.shape = Shape::Sphere { radius_m: 0.2 };
            object.part_materials.clear();
        }
    }
    let mut window = window(EditorOptions {
        initial: Some(StudioSource::Memory(Box::new(studio))),
        dialogs: FileDialogs::scripted([lesson.clone(), wrong.clone()]),
        ..EditorOptions::default()
    });
    let fill = scene(&window).lights[1].id;
    let mut export = |kind: ToastKind| {
        let command = Command::ExportLesson(LessonSeries::Room, Some(fill));
        window.state_mut().run(command, None, &egui::Context::default());
        settle(&mut window);
        window.state().toasts().texts(kind).last().map_or_else(String::new, |text| (*text).to_owned())
    };
    assert!(export(ToastKind::Info).starts_with("Lesson sheet written to"));
    let html = std::fs::read_to_string(lesson).unwrap();
    assert!(html.contains("Colour of the room") && html.matches("<figure>").count() == 3, "{}", html.len());
    assert!(export(ToastKind::Error).contains(".png or .html") && !wrong.exists());
}

#[test]
fn a_model_comes_in_with_its_texture_and_the_surfaces_of_its_groups() {
    let Some(mut window) = preset_window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| std::fs::write(folder.path().join(name), content).unwrap();
    image::RgbImage::from_pixel(4, 4, image::Rgb([200, 40, 40])).save(folder.path().join("red.png")).unwrap();
    write("a.mtl", "newmtl red\nKd 1 1 1\nmap_Kd red.png\nnewmtl blue\nKd 0.1 0.1 0.8\n");
    let corners = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    let groups =
        "g front\nusemtl red\nf 1/1 2/2 3/3\ng left\nusemtl blue\nf 1/1 4/2 2/3\ng back\nusemtl red\nf 2/1 4/2 3/3\n";
    write("shop.obj", &format!("{corners}{groups}"));
    drop_file(&mut window, &folder.path().join("shop.obj"));
    let told = [ToastKind::Info, ToastKind::Warning, ToastKind::Error]
        .map(|kind| window.state().toasts().texts(kind))
        .concat();
    assert!(told.iter().all(|text| !text.contains("shop.obj") && !text.contains("texture")), "{told:?}");
    // The surface of the whole is that of the first group, and one group has its own
    let object = scene(&window).objects.last().unwrap().clone();
    assert!(object.name == "shop" && object.material.textures.base_color.is_some(), "{object:?}");
    let [(part, blue)] = &object.part_materials[..] else { panic!("{object:?}") };
    assert!(part == "left" && blue.base_color[2] > 0.5 && blue.textures.base_color.is_none());
}

#[test]
fn a_model_that_is_chosen_as_a_texture_is_refused_and_told() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("pyramid.obj");
    std::fs::write(&model, PYRAMID).unwrap();
    let mut window = window_with_answers([model]);
    let before = scene(&window).clone();
    run(&mut window, Command::ChooseTexture(Item::Room, Some("floor".to_owned()), TextureSlot::BaseColor));
    let error = errors(&window).pop().unwrap();
    assert!(error.contains("pyramid.obj is no picture") && error.contains("Import model"), "{error}");
    assert_eq!(*scene(&window), before);
}

/// Returns a textured triangle as a glTF file, of a height in metres.
fn label_gltf(height: f32) -> String {
    let base64 = |bytes: &[u8]| base64::Engine::encode(&base64::engine::general_purpose::STANDARD, bytes);
    let corners: [f32; 15] = [0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, height, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|value| value.to_le_bytes()).collect();
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(2, 2, image::Rgb([9, 90, 200])).write_to(&mut png, image::ImageFormat::Png).unwrap();
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"name": "Label", "mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "material": 0}}]}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "metallicFactor": 0}}}}],
        "textures": [{{"source": 0}}], "images": [{{"uri": "data:image/png;base64,{}"}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0.2, {height}, 0]}},
                      {{"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 60}}],
        "buffers": [{{"byteLength": 60, "uri": "data:application/octet-stream;base64,{}"}}]}}"#,
        base64(png.get_ref()),
        base64(&bytes)
    )
}

#[test]
fn a_gltf_model_comes_in_with_the_image_inside_and_travels_with_the_studio() {
    if !has_adapter() {
        return;
    }
    let (folder, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let json = label_gltf(0.3);
    let model = folder.path().join("label.gltf");
    std::fs::write(&model, json).unwrap();
    let studio = home.path().join("shop.ron");
    let mut window = window_with_answers([studio.clone()]);
    drop_file(&mut window, &model);
    assert_eq!((errors(&window), window.state().toasts().texts(ToastKind::Warning)), (Vec::new(), Vec::new()));
    let object = scene(&window).objects.last().unwrap().clone();
    let texture = object.material.textures.base_color.clone().unwrap();
    assert!(object.name == "label" && object.part_materials.is_empty() && texture.path() == Some("models/label.gltf"));
    assert_eq!(window.state().document().assets().texture(&texture).unwrap().rgb[0], [9, 90, 200]);
    // Saved, the model lies beside the studio, and the image in it is found again
    run(&mut window, Command::SaveAs);
    std::fs::remove_dir_all(folder.path()).unwrap();
    run(&mut window, Command::OpenPath(studio));
    let document = window.state().document();
    assert_eq!((errors(&window), document.scene().objects.last()), (Vec::new(), Some(&object)));
    assert!(document.assets().mesh("models/label.gltf").is_some() && document.assets().texture(&texture).is_some());
}

#[test]
fn a_gltf_model_of_30_m_is_asked_about_and_comes_with_its_lamp_and_camera_in_one_step() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let set_up = r#""extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "name": "Bulb", "intensity": 40000}]}},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.4, "znear": 0.1}}],
        "scenes": [{"nodes": [0, 1, 2]}], "nodes": [
        {"translation": [0, 100, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"translation": [0, 15, 300], "camera": 0}, "#;
    let json = label_gltf(30.0).replacen(r#""scenes": [{"nodes": [0]}], "nodes": ["#, set_up, 1);
    let model = folder.path().join("label.gltf");
    std::fs::write(&model, json).unwrap();
    let mut window = window_with_answers([]);
    let (before, depth) = (scene(&window).clone(), undo_depth(&window));
    drop_file(&mut window, &model);
    assert_eq!((errors(&window).len(), scene(&window)), (0, &before), "it asks first");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(scene(&window), &before);
    drop_file(&mut window, &model);
    click(&mut window, "0.300 m long: its unit is cm");
    click(&mut window, "Look through its camera");
    press(&mut window, Modifiers::NONE, Key::Enter);
    let now = scene(&window).clone();
    assert_eq!((now.objects.len(), now.lights.len()), (before.objects.len() + 1, before.lights.len() + 1));
    let (object, lamp) = (now.objects.last().unwrap().transform, now.lights.last().unwrap());
    assert_eq!((object.scale, lamp.name.as_str()), (glam::Vec3::splat(0.01), "Bulb"));
    let place = |height: f32, depth: f32| object.position + glam::Vec3::new(0.0, height, depth);
    assert!(lamp.position.distance(place(1.0, 0.0)) < 1e-4, "{}", lamp.position);
    assert!(now.camera.position.distance(place(0.15, 3.0)) < 1e-4, "{}", now.camera.position);
    assert!(now.camera.focal_length_mm != before.camera.focal_length_mm && now.camera.iso == before.camera.iso);
    assert_eq!(undo_depth(&window), depth + 1);
    run(&mut window, Command::Undo);
    assert_eq!(scene(&window), &before);
}

#[test]
fn a_dropped_exr_without_a_studio_becomes_the_environment_if_it_is_a_panorama() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, width: u32, height: u32| {
        let path = folder.path().join(name);
        let picture = Picture { width, height, rgb: vec![[1.0, 0.9, 0.8]; (width * height) as usize] };
        let info = PictureInfo { studio: String::new(), ..PictureInfo::new(&Scene::default(), "path", 1, 0) };
        export_picture(&path, &picture, &info).unwrap();
        path
    };
    let (sky, square) = (write("sky.exr", 16, 8), write("square.exr", 8, 8));
    let mut window = window_with_answers([]);
    let (before, depth) = (scene(&window).clone(), undo_depth(&window));
    select(&mut window, &[]);
    drop_file(&mut window, &sky);
    assert_eq!(scene(&window), &before, "it asks first");
    click(&mut window, "As environment");
    wait_until(&mut window, |app| app.document().scene().lights.len() > before.lights.len());
    let light = scene(&window).lights.last().unwrap();
    assert_eq!(light.environment_map.as_deref(), Some("environments/sky.exr"));
    assert_eq!((errors(&window).len(), undo_depth(&window)), (0, depth + 1));
    // No panorama: the message of before
    drop_file(&mut window, &square);
    click(&mut window, "Don't save");
    assert!(errors(&window).iter().any(|error| error.contains("there is no studio in it")), "{:?}", errors(&window));
}

#[test]
fn what_is_changed_while_a_studio_is_read_is_asked_about() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let studio = folder.path().join("other.ron");
    std::fs::write(&studio, catchlight::io::find_preset("split").unwrap().text).unwrap();
    let mut window = window_with_answers([]);
    let mut light = scene(&window).lights[0].clone();
    light.power.dial_stops -= 1.0;
    // Before a frame takes the result
    for command in [Command::OpenPath(studio), Command::Apply(Action::SetLight(Box::new(light)))] {
        window.state_mut().run(command, None, &egui::Context::default());
    }
    settle(&mut window);
    let changed = scene(&window).clone();
    assert!(window.query_by_label("Unsaved changes").is_some() && window.state().document().is_dirty());
    assert_eq!(undo_depth(&window), 1);
    click(&mut window, "Cancel");
    assert_eq!(*scene(&window), changed);
    // The one that is asked for last is opened
    let again = folder.path().join("again.ron");
    std::fs::write(&again, catchlight::io::find_preset("butterfly").unwrap().text).unwrap();
    window.state_mut().run(Command::Undo, None, &egui::Context::default());
    for path in [folder.path().join("other.ron"), again] {
        window.state_mut().run(Command::OpenPath(path), None, &egui::Context::default());
    }
    wait_until(&mut window, |app| app.document().scene().name == "Butterfly");
    settle(&mut window);
    assert_eq!(scene(&window).name, "Butterfly");
}

#[test]
fn a_file_of_the_name_that_an_extension_makes_is_not_replaced_unasked() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (typed, file) = (folder.path().join("Portrait 1.2"), folder.path().join("Portrait 1.2.ron"));
    std::fs::write(&file, "another studio").unwrap();
    let mut window = window_with_answers([typed.clone(), typed]);
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    settle(&mut window);
    click(&mut window, "Cancel");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "another studio");
    press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    settle(&mut window);
    click(&mut window, "Replace");
    assert!(catchlight::io::load_scene(&file).is_ok());
    assert_eq!(window.state().document().path(), Some(&*file));
}

#[test]
fn a_cancelled_import_or_opening_leaves_the_studio_as_it_is() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("pyramid.obj");
    std::fs::write(&model, PYRAMID).unwrap();
    let studio = folder.path().join("other.ron");
    std::fs::write(&studio, catchlight::io::find_preset("split").unwrap().text).unwrap();
    let mut window = window_with_answers([]);
    let (before, depth) = (scene(&window).clone(), undo_depth(&window));
    // Before a frame takes the result
    for command in [Command::ImportPath(model.clone()), Command::OpenPath(studio.clone()), Command::CancelLoads] {
        window.state_mut().run(command, None, &egui::Context::default());
    }
    settle(&mut window);
    wait_until(&mut window, |app| app.toasts().texts(ToastKind::Info).len() > 1);
    let told = window.state().toasts().texts(ToastKind::Info);
    assert!(told.contains(&"The import of pyramid.obj was cancelled."), "{told:?}");
    assert!(told.contains(&"other.ron was not opened: cancelled."), "{told:?}");
    assert_eq!((scene(&window), undo_depth(&window), errors(&window).len()), (&before, depth, 0));
    drop_file(&mut window, &model);
    assert_eq!(scene(&window).objects.len(), before.objects.len() + 1, "the next one comes in");
    window.state_mut().run(Command::Undo, None, &egui::Context::default());
    settle(&mut window);
    drop_file(&mut window, &studio);
    wait_until(&mut window, |app| app.document().scene().name != before.name);
}
