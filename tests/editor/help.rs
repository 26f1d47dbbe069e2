//! The menu Help: version and licences.

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
