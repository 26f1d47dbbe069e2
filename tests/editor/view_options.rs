//! The display options of the live view: channels, single light, denoising.

use super::*;
use catchlight::photo::{FALSE_STOPS, PictureDisplay, false_color};
use catchlight::preview::Channel;
use image::RgbaImage;

/// Returns the image of the viewport without menus, axis widget and messages.
fn view(window: &mut Window) -> RgbaImage {
    let rect = window.get_by_label("Viewport").rect();
    move_to(window, rect.center());
    settle(window);
    // The bounced light arrives in the background; channels do not show it.
    let is_lit = window.state().viewport().preview.view_options.channel == Channel::Lit;
    wait_until(window, |app| !is_lit || !app.viewport().preview.is_tracing_bounced_light());
    settle(window);
    let rect = rect.shrink2(vec2(120.0, 110.0));
    let picture = window.render().unwrap();
    let pixels = |points: f32| (points * window.ctx.pixels_per_point()) as u32;
    let [x, y, width, height] = [rect.min.x, rect.min.y, rect.width(), rect.height()].map(pixels);
    image::imageops::crop_imm(&picture, x, y, width, height).to_image()
}

/// Returns the mean absolute difference of two images, in 8-bit codes.
fn apart(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let off = a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b)));
    off.sum::<f64>() / a.as_raw().len() as f64
}

/// Asserts that the view is as it was before, and writes both images if it is not.
fn assert_restored(window: &mut Window, before: &RgbaImage, name: &str) {
    let after = view(window);
    assert_eq!(after.dimensions(), before.dimensions(), "{name}");
    let difference = apart(&after, before);
    if difference >= 0.01 {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        for (kind, image) in [("before", before), ("after", &after)] {
            image.save(folder.join(format!("editor_{name}_{kind}.png"))).unwrap();
        }
        let preview = &window.state().viewport().preview;
        let state = (preview.failure(), preview.is_draft(), preview.has_bounced_light());
        panic!(
            "{name}: {difference} codes; see {}/editor_{name}_*.png; failure, draft, bounced light: {state:?}",
            folder.display()
        );
    }
}

/// Opens the menu by its button and clicks entries.
fn choose(window: &mut Window, button: &str, entries: &[&str]) {
    click(window, button);
    for entry in entries {
        click(window, entry);
    }
    press(window, Modifiers::NONE, Key::Escape);
}

#[test]
fn false_colour_is_one_click_away_and_one_back() {
    let Some(mut window) = preset_window() else { return };
    let display = |window: &Window| window.state().viewport().preview.view_options.display;
    click(&mut window, "False colour");
    assert_eq!(display(&window), PictureDisplay::FalseColor);
    click(&mut window, "False colour");
    assert_eq!(display(&window), PictureDisplay::Plain);
}

#[test]
fn scopes_over_both_live_views_read_their_scene_linear_pictures() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let plain = view(&mut window);
    let depth = undo_depth(&window);
    for mode in [LiveMode::Quick, LiveMode::True] {
        run(&mut window, Command::SetLiveMode(mode));
        wait_until(&mut window, |app| mode == LiveMode::Quick || app.viewport().traced_view.is_settled());
        let histogram = |window: &Window| window.query_all_by_label_contains("Histogram: ").next().is_some();
        assert!(!histogram(&window), "{mode:?}: no scope is on at first");
        click(&mut window, "Scopes");
        click(&mut window, "Histogram");
        click(&mut window, "Waveform");
        assert!(histogram(&window) && window.query_by_label("Waveform of the picture").is_some(), "{mode:?}");
        click(&mut window, "Spot under the pointer");
        click(&mut window, "Stops in false colour");
        press(&mut window, Modifiers::NONE, Key::Escape);
        // Every pixel has a colour of the legend, clipped white or black; a photo has others
        let colors: Vec<[u8; 3]> =
            (FALSE_STOPS.0..=FALSE_STOPS.1).map(|stops| false_color(stops as f32)).chain([[0; 3], [255; 3]]).collect();
        let known = |picture: &RgbaImage| {
            let near =
                |pixel: &[u8; 4]| colors.iter().any(|color| color.iter().zip(pixel).all(|(a, b)| a.abs_diff(*b) <= 2));
            picture.pixels().filter(|pixel| near(&pixel.0)).count() as f64 / picture.pixels().len() as f64
        };
        assert!(window.query_by_label("As a photo").is_none(), "Esc closes the menu");
        let shown = view(&mut window);
        assert!(known(&shown) > 0.6 && known(&plain) < 0.4, "{mode:?}: {} and {}", known(&shown), known(&plain));
        // The light under the pointer, with the lights that give it
        let middle = window.get_by_label("Viewport").rect().center();
        move_to(&mut window, middle);
        settle(&mut window);
        let lux = window.query_all_by_label_contains(" lx over 1/").next();
        assert!(lux.is_some(), "{mode:?}: stops, RGB, lux and the lights under the pointer");
        click(&mut window, "Scopes");
        for entry in ["As a photo", "Histogram", "Waveform", "Spot under the pointer"] {
            click(&mut window, entry);
        }
        press(&mut window, Modifiers::NONE, Key::Escape);
        assert!(!histogram(&window), "{mode:?}");
    }
    run(&mut window, Command::SetLiveMode(LiveMode::Quick));
    assert_restored(&mut window, &plain, "without_scopes");
    assert_eq!(undo_depth(&window), depth, "a look is no change of the studio");
}

#[test]
fn every_channel_changes_the_image_and_lit_restores_it() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let lit = view(&mut window);
    let mut seen = vec![("Lit", lit.clone())];
    for channel in Channel::ALL.into_iter().filter(|channel| *channel != Channel::Lit) {
        let shown = seen.last().unwrap().0;
        choose(&mut window, shown, &[channel.label()]);
        assert_eq!(window.state().viewport().preview.view_options.channel, channel);
        let picture = view(&mut window);
        for (other, before) in &seen {
            assert!(apart(&picture, before) > 0.5, "{} looks like {other}", channel.label());
        }
        seen.push((channel.label(), picture));
    }
    choose(&mut window, seen.last().unwrap().0, &["Lit"]);
    assert_restored(&mut window, &lit, "lit_after_channels");
    assert_eq!(undo_depth(&window), 0, "a look is no change of the studio");
}

#[test]
fn showing_a_single_light_does_not_change_the_studio() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let (before, lit) = (scene(&window).clone(), view(&mut window));
    let light = before.lights[1].clone();
    click(&mut window, "Lit");
    click(&mut window, "Show the light of");
    let entry = window.get_all_by_role_and_label(egui::accesskit::Role::RadioButton, &light.name).next();
    entry.unwrap().click();
    settle(&mut window);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(window.state().viewport().preview.view_options.only_light, Some(light.id));
    let alone = view(&mut window);
    let sum = |picture: &RgbaImage| picture.pixels().map(|p| u64::from(p.0[1])).sum::<u64>();
    assert!(sum(&alone) < sum(&lit) && apart(&alone, &lit) > 1.0);
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 0));
    choose(&mut window, &format!("Lit: light of {} only", light.name), &["Show the light of", "All lights"]);
    assert!(apart(&view(&mut window), &lit) < 0.01);
}

#[test]
fn the_depth_channel_has_contrast_in_parallel_views() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::NONE, Key::Num8);
    choose(&mut window, "Lit", &["Depth"]);
    let picture = view(&mut window);
    let codes: std::collections::BTreeSet<u8> = picture.pixels().map(|p| p.0[0]).collect();
    // A view from two kilometres away was black all over: its distances are all far.
    assert!(codes.len() > 20 && codes.last().is_some_and(|most| *most > 120), "{codes:?}");
}

#[test]
fn denoising_of_the_traced_view_is_off_by_default() {
    let Some(mut window) = preset_window() else { return };
    assert!(!window.state().viewport().preview.view_options.smooth);
    choose(&mut window, "Lit", &["Low-noise preview"]);
    assert!(window.state().viewport().preview.view_options.smooth);
    run(&mut window, Command::SetLiveMode(LiveMode::True));
    wait_until(&mut window, |app| app.viewport().traced_view.has_picture());
    assert_eq!(undo_depth(&window), 0, "a look is no change of the studio");
}

#[test]
fn edges_become_smooth_while_nothing_moves() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let jagged = view(&mut window);
    let draws = |window: &Window| window.state().viewport().preview.draws();
    let before = draws(&window);
    settle(&mut window);
    assert_eq!(draws(&window), before, "without it, one sample is all");
    choose(&mut window, "Lit", &["Smooth edges"]);
    let smooth = view(&mut window);
    assert!(draws(&window) >= before + 5, "{} samples", draws(&window) - before);
    let finished = draws(&window);
    settle(&mut window);
    assert_eq!(draws(&window), finished, "a finished view is drawn no more");
    let difference = apart(&smooth, &jagged);
    assert!((0.1..1.5).contains(&difference), "the same picture with other edges: {difference} codes");
    choose(&mut window, "Lit", &["Smooth edges"]);
    assert!(apart(&view(&mut window), &jagged) < 0.01, "without it the edges are as before");
}

#[test]
fn bounced_light_is_shown_or_left_out() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let direct = view(&mut window);
    assert!(!window.state().viewport().preview.has_bounced_light(), "nothing is traced that is not shown");
    choose(&mut window, "Lit", &["Bounced light"]);
    let with_bounces = view(&mut window);
    assert!(window.state().viewport().preview.has_bounced_light());
    let sum = |picture: &RgbaImage| picture.pixels().map(|p| u64::from(p.0[1])).sum::<u64>();
    assert!(sum(&with_bounces) > sum(&direct) && apart(&with_bounces, &direct) > 1.0);
    choose(&mut window, "Lit", &["Bounced light"]);
    assert!(apart(&view(&mut window), &direct) < 0.01);
}
