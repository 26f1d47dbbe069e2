//! Renders from the window.

use super::*;
use catchlight::editor::SpotReading;
use catchlight::io::{LayeredPicture, Loaded, PictureInfo, picture_file, presets};
use catchlight::photo::{Histogram, Picture, PictureDisplay};
use catchlight::raytrace::{self, RenderControl, Settings};
use std::ops::ControlFlow;

#[test]
fn light_changes_redevelop_the_picture_without_tracing() {
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    let brightness = |window: &Window| -> f32 {
        let picture = &window.state().rendering().developed().unwrap().picture;
        picture.rgb.iter().flatten().sum()
    };
    let rays = |window: &Window| window.state().rendering().job().unwrap().progress();
    let (bright, traced) = (brightness(&window), rays(&window));
    let scene_now = scene(&window).clone();
    assert!(!window.state().rendering().is_out_of_date(&scene_now));
    for light in scene_now.lights.iter().map(|l| l.name.clone()) {
        click(&mut window, &format!("{light} on"));
    }
    let dark = scene(&window).clone();
    assert!(brightness(&window) < 0.02 * bright, "{} of {bright}", brightness(&window));
    assert!(!window.state().rendering().is_out_of_date(&dark), "switches need no render");
    assert_eq!(rays(&window), traced);
    let mut camera = dark.camera.clone();
    camera.position.x += 0.5;
    window.state_mut().run(Command::Apply(Action::SetCamera(Box::new(camera))), None, &egui::Context::default());
    settle(&mut window);
    let moved = scene(&window).clone();
    assert!(window.state().rendering().is_out_of_date(&moved), "a moved camera needs one");
}

#[test]
fn muting_soloing_and_locking_after_a_render_show_no_out_of_date_mark() {
    // All three marked the picture "Out of date", although it had just been relit rightly.
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    let lights: Vec<_> = scene(&window).lights.iter().map(|light| light.id).collect();
    let object = scene(&window).objects[0].id;
    let is_marked = |window: &Window| {
        let label = window.query_all_by_label_contains("Out of date").next().is_some();
        assert_eq!(label, window.state().rendering().is_out_of_date(scene(window)));
        label
    };
    let steps = [
        Action::Mute(vec![lights[0]], true),
        Action::Solo(vec![lights[1]]),
        Action::Solo(Vec::new()),
        Action::Lock(vec![Item::Object(object), Item::Light(lights[2])], true),
    ];
    for action in steps {
        let name = format!("{action:?}");
        window.state_mut().run(Command::Apply(action), None, &egui::Context::default());
        settle(&mut window);
        assert!(!is_marked(&window), "{name}");
    }
    let mut light = scene(&window).lights[1].clone();
    light.position.x += 0.5;
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &egui::Context::default());
    settle(&mut window);
    assert!(is_marked(&window), "a moved light needs a render");
}

#[test]
fn a_render_can_be_cancelled_and_keeps_what_it_has() {
    let Some(mut window) = preset_window() else { return };
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(160, 120);
    rendering.settings.samples = 60_000;
    rendering.settings.quality = Quality::Custom;
    settle(&mut window);
    window.get_by_label("Render the picture").click();
    wait_until(&mut window, |app| app.rendering().developed().is_some());
    // The small picture has just come into the panel: a frame for the layout to settle.
    window.run_steps(2);
    // Where the processors draw the window, its progress takes little of their time.
    let is_drawn_by_cpu = window.state().viewport().preview.window_is_drawn_by_cpu();
    let progress_ms = if is_drawn_by_cpu { 900..=1000 } else { 200..=250 };
    // A frame that waits for the next development of the picture comes sooner.
    let mut longest = 0;
    for _ in 0..MOST_FRAMES {
        window.step();
        longest = longest.max(window.output().viewport_output[&ViewportId::ROOT].repaint_delay.as_millis());
        if longest >= *progress_ms.start() {
            break;
        }
        wait_for_next_frame(&window);
    }
    assert!(progress_ms.contains(&longest), "the progress is drawn after {longest} ms, not {progress_ms:?}");
    window.get_by_label("Cancel").click();
    settle(&mut window);
    assert!(!window.state().rendering().is_running());
    assert!(window.state().rendering().developed().is_some_and(|d| d.spp > 0 && d.spp < 60_000));
}

#[test]
fn a_render_cancelled_before_its_first_sample_leaves_the_picture_of_before() {
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    let before = window.state().rendering().developed().unwrap().picture.clone();
    let mut camera = scene(&window).camera.clone();
    camera.position.x += 0.5;
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(160, 120);
    rendering.settings.samples = 60_000;
    // Before a frame takes the first samples
    for command in [Command::Apply(Action::SetCamera(Box::new(camera))), Command::Render, Command::CancelRender] {
        window.state_mut().run(command, None, &egui::Context::default());
    }
    settle(&mut window);
    let rendering = window.state().rendering();
    assert!(!rendering.is_running());
    assert_eq!(rendering.developed().map(|developed| &developed.picture), Some(&before));
    assert!(rendering.is_out_of_date(scene(&window)), "the camera has moved since");
}

#[test]
fn an_exported_picture_that_is_out_of_date_holds_the_studio_that_it_shows() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("before.exr");
    let mut window = window_with_answers([file.clone()]);
    render_tiny(&mut window);
    let rendered = scene(&window).clone();
    let mut light = rendered.lights[0].clone();
    light.position.x += 0.5;
    light.power.dial_stops -= 1.0;
    let dial = light.power.dial_stops;
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &egui::Context::default());
    settle(&mut window);
    window.state_mut().run(Command::ExportPicture, None, &egui::Context::default());
    settle(&mut window);
    let shown = catchlight::io::read_rendered(&file).unwrap().picture.scene;
    assert_eq!(shown.lights[0].position, rendered.lights[0].position, "where it stood");
    assert_eq!(shown.lights[0].power.dial_stops, dial, "by which it was developed");
}

#[test]
fn the_quality_chart_forecasts_time_and_noise_and_uses_measured_renders() {
    let Some(mut window) = preset_window() else { return };
    assert!(window.state().forecaster().forecast().is_none(), "nothing runs for it while it is folded");
    window.state_mut().rendering_mut().settings.size = PictureSize::Custom(60, 40);
    settle(&mut window);
    click(&mut window, "Time and noise");
    wait_until(&mut window, |app| app.forecaster().forecast().is_some());
    settle(&mut window);
    let forecast = window.state().forecaster().forecast().unwrap().clone();
    let [draft, fine] = [16, 1024].map(|samples| forecast.estimate(60 * 40, samples));
    assert!(draft.seconds < fine.seconds && draft.noise_stops > 4.0 * fine.noise_stops);
    // A line chooses its quality.
    window.get_by_label_contains("Good: ").click();
    settle(&mut window);
    let settings = window.state().rendering().settings;
    assert_eq!(settings.quality, Quality::Good);
    assert!(window.query_by_label_contains("Noise against time; chosen: ").is_some());
    // A time chooses the samples that fit into it.
    click(&mut window, "Best picture in 10 s");
    let settings = window.state().rendering().settings;
    let denoiser_s = forecast.denoiser_s(60 * 40);
    let fitting = forecast.estimate(60 * 40, settings.samples).seconds + denoiser_s;
    assert!(denoiser_s > 1e-4, "the denoiser's time is measured: {denoiser_s}");
    assert_eq!((settings.quality, settings.method), (Quality::Custom, raytrace::Method::Path));
    assert!(fitting <= 10.0 && fitting > 5.0, "{fitting} s for {} samples", settings.samples);
    // What a render took counts from then on.
    window.state_mut().rendering_mut().settings.samples = 32;
    window.state_mut().rendering_mut().settings.quality = Quality::Custom;
    settle(&mut window);
    // The panel has just grown by a line: a frame for the layout to settle.
    window.run_steps(3);
    click(&mut window, "Render the picture");
    let took = window.state().forecaster().measured().to_vec();
    assert_eq!(took.len(), 1);
    let now = window.state().forecaster().forecast().unwrap().estimate(60 * 40, 32);
    assert!(
        (now.seconds / took[0].seconds - 1.0).abs() < 1e-3
            && (now.noise_stops / took[0].noise_stops - 1.0).abs() < 1e-3
    );
}

#[test]
fn a_draft_ends_when_its_noise_is_low_enough_and_is_denoised() {
    let Some(mut window) = preset_window() else { return };
    let settings = &mut window.state_mut().rendering_mut().settings;
    assert_eq!((settings.quality, settings.denoise), (Quality::Draft, true));
    settings.size = PictureSize::Custom(60, 90);
    settle(&mut window);
    click(&mut window, "Render the picture");
    wait_until(&mut window, |app| !app.rendering().is_busy());
    let rendering = window.state().rendering();
    let job = rendering.job().unwrap();
    assert_eq!((job.phase(), job.progress().fraction), (&catchlight::jobs::RenderPhase::Done, 1.0));
    assert!(rendering.is_denoised());
    let limit = job.settings.noise_stops.unwrap();
    let tiles = job.film().unwrap().tile_noise();
    let is_done = |(spp, noise): &(u32, Option<f32>)| *spp == 16 || noise.is_none_or(|noise| noise <= limit);
    assert!(tiles.iter().all(|tile| tile.0 >= 2 && is_done(tile)), "{tiles:?}");
    assert!(tiles.iter().any(|(spp, _)| *spp < 16), "even the most even wall has taken all samples: {tiles:?}");
}

#[test]
fn denoise_shows_marks_relights_and_exports_the_picture_without_noise() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("denoised.exr");
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([file.clone()]);
    render_tiny(&mut window);
    window.state_mut().run(Command::ShowView(CentralView::Picture), None, &egui::Context::default());
    settle(&mut window);
    let picture = |window: &Window| window.state().rendering().developed().unwrap().picture.clone();
    let is_marked = |window: &Window| {
        let label = window.query_by_label("Denoised").is_some();
        assert_eq!(label, window.state().rendering().is_denoised());
        label
    };
    let noisy = picture(&window);
    assert!(!is_marked(&window));
    let traced = window.state().rendering().job().unwrap().progress();
    click(&mut window, "Denoise");
    assert!(is_marked(&window));
    let denoised = picture(&window);
    assert!(denoised != noisy);
    assert_eq!(window.state().rendering().developed().unwrap().noisy, Some(noisy.clone()));
    // The file holds what is shown, and what was traced
    window.state_mut().run(Command::ExportPicture, None, &egui::Context::default());
    settle(&mut window);
    assert_eq!(catchlight::io::read_exr(&file).as_ref(), Ok(&*denoised));
    let header = exr::meta::MetaData::read_from_file(&file, false).unwrap().headers;
    let parts: Vec<String> =
        header.iter().map(|part| part.own_attributes.layer_name.as_ref().unwrap().to_string()).collect();
    let lights = scene(&window).lights.iter().map(|light| light.name.as_str());
    // After the lights, surfaces that glow
    assert_eq!(parts, ["picture"].into_iter().chain(lights).chain(["Glow"]).collect::<Vec<_>>());
    let names: Vec<String> = header[0].channels.list.iter().map(|channel| channel.name.to_string()).collect();
    for name in ["R", "noisy.R", "albedo.G", "normal.Z", "Z", "id"] {
        assert!(names.iter().any(|channel| channel == name), "{name} in {names:?}");
    }
    // Lights change the denoised picture: one stop more doubles it
    let lights = scene(&window).lights.clone();
    for mut light in lights {
        light.power.dial_stops += 1.0;
        window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &egui::Context::default());
    }
    settle(&mut window);
    assert!(is_marked(&window));
    let sum = |picture: &Picture| picture.rgb.iter().flatten().sum::<f32>();
    let ratio = sum(&picture(&window)) / sum(&denoised);
    // The brightness of the network's input does not depend on that of the picture, but for rounding.
    assert!((ratio - 2.0).abs() < 1e-3, "{ratio}");
    assert_eq!(window.state().rendering().job().unwrap().progress(), traced, "nothing is traced");
    // Off again: the traced picture
    (0..scene(&window).lights.len()).for_each(|_| {
        window.state_mut().run(Command::Undo, None, &egui::Context::default());
    });
    click(&mut window, "Denoise");
    assert!(!is_marked(&window));
    assert!(picture(&window) == noisy);
}

#[test]
fn scopes_show_clipping_false_colour_zebra_and_the_light_under_the_pointer() {
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    window.state_mut().run(Command::ShowView(CentralView::Picture), None, &egui::Context::default());
    settle(&mut window);
    // The histogram knows what the picture clips
    let picture = window.state().rendering().developed().unwrap().picture.clone();
    let histogram = Histogram::of(&picture);
    assert_eq!(window.state().rendering().developed().unwrap().image.histogram, histogram);
    assert!(window.query_all_by_label_contains("Histogram: ").next().is_some());
    // The pointer comes over the picture, and its read-out goes as it reaches the menu
    let place = window.get_by_label("Picture view").rect();
    window.hover_at(place.center());
    settle(&mut window);
    assert!(window.query_all_by_label_contains("stops from middle grey").next().is_some());
    let button = window.get_by_label("Scopes").rect().center();
    window.hover_at(button);
    settle(&mut window);
    click_at(&mut window, button, Modifiers::NONE);
    assert!(window.query_by_label("Stops in false colour").is_some(), "the menu is open");
    click(&mut window, "Histogram");
    assert!(window.query_all_by_label_contains("Histogram: ").next().is_none());
    assert!(window.query_by_label("Waveform of the picture").is_none());
    click(&mut window, "Waveform");
    assert!(window.query_by_label("Waveform of the picture").is_some());
    // The displays follow the menu; the pixels for the file stay
    click(&mut window, "Stops in false colour");
    settle(&mut window);
    assert_eq!(window.state().rendering().display, PictureDisplay::FalseColor);
    for display in [PictureDisplay::Zebra { thirds_under: 2 }, PictureDisplay::SkinZebra, PictureDisplay::Plain] {
        window.state_mut().run(Command::DisplayPicture(display), None, &egui::Context::default());
        settle(&mut window);
        assert!(Arc::ptr_eq(&window.state().rendering().developed().unwrap().picture, &picture));
    }
    // Under the pointer: the lights' shares are those of the layers
    let size = window.state().rendering().size().unwrap();
    let reading = window.state().rendering().read_spot((size.0 / 2, size.1 / 2), scene(&window)).unwrap();
    assert!((reading.lights.iter().map(|(_, share)| share).sum::<f32>() - 1.0).abs() < 1e-4, "{reading:?}");
    let key = reading.lights[0].0.clone();
    click(&mut window, &format!("{key} on"));
    settle(&mut window);
    let without = window.state().rendering().read_spot((size.0 / 2, size.1 / 2), scene(&window)).unwrap();
    let share = |reading: &SpotReading| reading.lights.iter().find(|(name, _)| *name == key).unwrap().1;
    assert!(share(&reading) > 0.2 && share(&without) == 0.0, "{reading:?} and {without:?}");
    assert!(without.spot.stops() < reading.spot.stops());
}

#[test]
fn an_exr_picture_without_albedo_and_normals_says_that_it_is_not_denoised() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plain.exr");
    let Loaded { scene, assets, .. } = presets()[0].load().unwrap();
    let prepared = raytrace::prepare(&scene, &assets).unwrap();
    let settings = Settings { width: 24, height: 36, spp: 1, ..Settings::default() };
    let film = raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
    let (picture, layers) = (film.develop(&scene), film.lazy_layers(&scene));
    let info = PictureInfo::new(&scene, &film.method(), film.spp(), 0);
    let shown = LayeredPicture { picture: &picture, layers: &layers };
    picture_file(&file, shown, None, None, &info).unwrap().write().unwrap();
    let mut window = window_with_answers([]);
    files::drop_file(&mut window, &file);
    assert_eq!(errors(&window), Vec::<String>::new());
    assert!(window.query_by_label("Not denoised").is_some() && window.query_by_label("Denoised").is_none());
    click(&mut window, "Denoise");
    assert!(window.query_by_label("Not denoised").is_none(), "the denoiser is off");
}

#[test]
fn an_exr_picture_opens_with_its_studio_and_can_be_mixed() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("portrait.exr");
    let mut window = window_with_answers([file.clone()]);
    render_tiny(&mut window);
    run(&mut window, Command::ExportPicture);
    let rendered = scene(&window).clone();
    let picture = |window: &Window| window.state().rendering().developed().unwrap().picture.clone();
    let before = picture(&window);
    // Another studio is open when the picture is dropped on the window
    run(&mut window, Command::NewFromPreset(3));
    assert_ne!(*scene(&window), rendered);
    files::drop_file(&mut window, &file);
    assert_eq!((errors(&window), scene(&window)), (Vec::new(), &rendered));
    assert!(window.query_by_label("Picture view").is_some() && window.query_by_label("Out of date").is_none());
    let near = |a: &Picture, b: &Picture, factor: f32| {
        // Samples of skin that are negative are cut off in the file
        let off: f32 = a.rgb.iter().flatten().zip(b.rgb.iter().flatten()).map(|(a, b)| (a * factor - b).abs()).sum();
        off < 0.01 * b.rgb.iter().flatten().sum::<f32>()
    };
    assert!(near(&before, &picture(&window), 1.0));
    assert!(!window.state().document().is_dirty() && window.state().document().path().is_none());
    click(&mut window, "Mixer");
    for light in &rendered.lights {
        run(&mut window, Command::MixLights(vec![light.id], Fader { thirds: -3, ..Fader::default() }));
    }
    assert!(near(&before, &picture(&window), 0.5));
    click(&mut window, "Apply to studio");
    assert_eq!(scene(&window).lights[0].power.dial_stops, rendered.lights[0].power.dial_stops - 1.0);
    // A picture of another program, and a damaged one
    for content in [&b"no picture"[..], &std::fs::read(&file).unwrap()[..2000]] {
        let other = folder.path().join("other.exr");
        std::fs::write(&other, content).unwrap();
        run(&mut window, Command::Undo);
        files::drop_file(&mut window, &other);
        assert!(errors(&window).iter().any(|error| error.contains("other.exr")), "{:?}", errors(&window));
        assert_eq!(*scene(&window), rendered, "what is open stays open");
        run(&mut window, Command::Redo);
        run(&mut window, Command::Undo);
    }
}

#[test]
fn the_mixer_dims_the_picture_without_tracing_and_applies_to_the_studio_as_one_step() {
    let Some(mut window) = preset_window() else { return };
    render_tiny(&mut window);
    window.state_mut().run(Command::ShowView(CentralView::Picture), None, &egui::Context::default());
    settle(&mut window);
    // A colour temperature that few lamps have: the mixer shows it and leaves it
    let mut cold = scene(&window).lights[1].clone();
    cold.color.source = ColorSource::Kelvin(20_000.0);
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(cold))), None, &egui::Context::default());
    settle(&mut window);
    let before = scene(&window).clone();
    let sum =
        |window: &Window| window.state().rendering().developed().unwrap().picture.rgb.iter().flatten().sum::<f32>();
    let traced = (sum(&window), window.state().rendering().job().unwrap().progress());
    click(&mut window, "Mixer");
    assert!(window.query_by_label("Fader of Key softbox").is_some() && window.query_by_label("Mixed").is_none());
    // All lights a stop up: twice the light
    for light in &before.lights {
        let fader = Fader { thirds: 3, ..Fader::default() };
        window.state_mut().run(Command::MixLights(vec![light.id], fader), None, &egui::Context::default());
    }
    settle(&mut window);
    assert!((sum(&window) / traced.0 - 2.0).abs() < 1e-3, "{}", sum(&window) / traced.0);
    assert_eq!(*scene(&window), before, "the studio is as it was");
    assert!(window.query_by_label("Mixed").is_some() && window.query_by_label("Out of date").is_none());
    // Mute and solo by their buttons
    click(&mut window, "Mute Key softbox in the mix");
    let muted = sum(&window);
    assert!(muted < 1.5 * traced.0);
    click(&mut window, "Solo Hair strip in the mix");
    let alone = sum(&window);
    assert!(alone < muted);
    click(&mut window, "Solo Hair strip in the mix");
    assert_eq!(sum(&window), muted);
    click(&mut window, "Apply to studio");
    let lights = scene(&window).lights.clone();
    assert!((lights[0].power.dial_stops - before.lights[0].power.dial_stops - 1.0).abs() < 1e-6);
    assert_eq!((lights[0].on, lights[0].muted, lights[1].on), (false, true, true));
    assert!(window.query_by_label("Fader of Key softbox").is_none(), "a light that is off has no fader");
    assert!((sum(&window) / muted - 1.0).abs() < 1e-5, "the picture stays");
    assert!(window.query_by_label("Mixed").is_none() && window.query_by_label("Out of date").is_none());
    window.state_mut().run(Command::Undo, None, &egui::Context::default());
    settle(&mut window);
    assert_eq!(*scene(&window), before, "one step");
    assert_eq!(sum(&window), traced.0);
    // Reset forgets
    let fader = Fader { kelvin: Some(3000.0), ..Fader::default() };
    window.state_mut().run(Command::MixLights(vec![before.lights[0].id], fader), None, &egui::Context::default());
    settle(&mut window);
    assert_ne!(sum(&window), traced.0);
    click(&mut window, "Reset");
    assert_eq!((sum(&window), window.state().rendering().job().unwrap().progress()), traced, "nothing was traced");
}
