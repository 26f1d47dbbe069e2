//! The menu Help: version and licences, the tour of the window.

use super::*;

#[test]
fn the_help_menu_names_version_and_licences() {
    let Some(mut window) = preset_window() else { return };
    let version = concat!("Version ", env!("CARGO_PKG_VERSION"));
    assert!(window.query_by_label(version).is_none());
    click(&mut window, "Help");
    window.get_by_label_contains("About Catchlight").click();
    settle(&mut window);
    for text in [version, "MIT or Apache-2.0", "Ubuntu Font Licence", "CC0", "Apache-2.0"] {
        assert!(window.query_by_label(text).is_some(), "{text}");
    }
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label(version).is_none(), "Esc closes it");
}

const HEADINGS: [&str; 6] = ["The shelf", "The studio", "Power of a light", "The light meter", "Render", "The picture"];

/// Returns the number of the card on show.
fn card(window: &Window) -> Option<usize> {
    (1..=HEADINGS.len()).find(|number| window.query_by_label(&format!("{number} of 6")).is_some())
}

#[test]
fn the_tour_is_shown_at_the_first_start_alone_and_again_from_the_menu() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let start = || {
        let settings_folder = Some(folder.path().to_owned());
        window(EditorOptions { settings_folder, offers_tour: true, ..EditorOptions::default() })
    };
    let mut first = start();
    for (number, heading) in (1..).zip(HEADINGS) {
        assert_eq!(card(&first), Some(number));
        assert!(first.query_all_by_label(heading).next().is_some(), "{heading}");
        click(&mut first, if number == HEADINGS.len() { "Done" } else { "Next" });
    }
    assert_eq!(card(&first), None);
    assert!(matches!(first.state().selection().last(), Some(Item::Light(_))), "a light shows its power");
    assert_eq!(undo_depth(&first), 0);
    drop(first);

    let mut second = start();
    assert_eq!(card(&second), None, "it was shown already");
    click(&mut second, "Help");
    second.get_by_label_contains("Tour").click();
    settle(&mut second);
    assert_eq!(card(&second), Some(1));
    click(&mut second, "Next");
    click(&mut second, "Back");
    assert_eq!(card(&second), Some(1));
    press(&mut second, Modifiers::NONE, Key::Escape);
    assert_eq!(card(&second), None, "Esc skips the rest");
}

#[test]
fn the_studio_can_be_used_during_the_tour() {
    let Some(mut window) = preset_window() else { return };
    run(&mut window, Command::StartTour);
    let lights = scene(&window).lights.len();
    click(&mut window, "Add Octa 120");
    assert_eq!((scene(&window).lights.len(), card(&window)), (lights + 1, Some(1)));
}

#[test]
fn the_tour_leaves_a_render_free_and_goes_on_with_the_picture() {
    let Some(mut window) = preset_window() else { return };
    for (pages, after_render) in [(0, None), (4, Some(6))] {
        run(&mut window, Command::StartTour);
        for _ in 0..pages {
            click(&mut window, "Next");
        }
        assert_eq!(card(&window), Some(pages + 1));
        render_tiny(&mut window);
        assert_eq!(card(&window), after_render);
    }
}
