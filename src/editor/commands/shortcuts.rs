//! The keyboard shortcuts: bindings of keys to commands, shown in the list of keys.

use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::choices::ViewSide;
use crate::editor::commands::choices::{CentralView, HandleMode};
use crate::editor::commands::command::Command;
use eframe::egui::{Event, Key, KeyboardShortcut, Modifiers};

/// A key, its command, and a description.
#[derive(Clone, Copy, Debug)]
pub struct KeyBinding {
    /// The key with its modifiers.
    pub shortcut: KeyboardShortcut,
    /// Returns the command.
    pub command: fn() -> Command,
    /// Description in the list of keys; empty for one that the description of the key before covers.
    pub meaning: &'static str,
}

const fn bind(shortcut: KeyboardShortcut, command: fn() -> Command, meaning: &'static str) -> KeyBinding {
    KeyBinding { shortcut, command, meaning }
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

/// Returns the command of an event of the system's clipboard.
pub fn clipboard_command(event: &Event) -> Option<Command> {
    match event {
        Event::Copy => Some(Command::CopySelected),
        Event::Cut => Some(Command::CutSelected),
        Event::Paste(text) => Some(Command::Paste(text.clone())),
        _ => None,
    }
}

/// All key bindings, in the order of the list. Those of the clipboard arrive as events of the system instead of keys; see
/// [`clipboard_command`]. Of two with the same key, the one with more modifiers comes first.
pub const KEY_BINDINGS: [KeyBinding; 52] = [
    bind(ctrl_shift(Key::S), || Command::SaveAs, "Save the studio to another file"),
    bind(ctrl_shift(Key::Z), || Command::Redo, "Do the last step again"),
    bind(
        ctrl_shift(Key::D),
        || Command::MirrorSelected { copies: true },
        "Mirrored copy, on the other side of the subject's face",
    ),
    bind(
        shift(Key::L),
        || Command::TogglePlaceLight(PlaceLightBy::Shadow),
        "Place the light by the shadow of its aim: drag to where it shall fall",
    ),
    bind(shift(Key::H), || Command::ShowAll, "Show and unmute all"),
    bind(ctrl(Key::N), || Command::New, "New from a shipped studio"),
    bind(ctrl(Key::O), || Command::Open, "Open a studio, or a rendered picture with its studio"),
    bind(ctrl(Key::S), || Command::Save, "Save the studio"),
    bind(ctrl(Key::I), || Command::Import, "Import a model"),
    bind(ctrl(Key::E), || Command::ExportPicture, "Export the rendered picture"),
    bind(ctrl(Key::Comma), || Command::TogglePreferences, "Preferences: scale, theme, units, meter constant"),
    bind(ctrl(Key::Q), || Command::Quit, "Quit"),
    bind(ctrl(Key::Z), || Command::Undo, "Take the last step back"),
    bind(ctrl(Key::Y), || Command::Redo, "Do the last step again"),
    bind(ctrl(Key::A), || Command::SelectAll, "Select all that is not locked"),
    bind(key(Key::Escape), || Command::Escape, "Give up a drag, leave a mode, deselect"),
    bind(ctrl(Key::X), || Command::CutSelected, "Cut lights and things"),
    bind(ctrl(Key::C), || Command::CopySelected, "Copy lights and things, for this studio or another"),
    bind(ctrl(Key::V), || Command::RequestPaste, "Paste lights and things"),
    bind(ctrl(Key::D), || Command::DuplicateSelected, "Duplicate"),
    bind(key(Key::Delete), || Command::DeleteSelected, "Delete"),
    bind(key(Key::M), || Command::SetHandles(HandleMode::Move), "Handles that move"),
    bind(key(Key::T), || Command::SetHandles(HandleMode::Rotate), "Handles that turn"),
    bind(key(Key::Z), || Command::SetHandles(HandleMode::Scale), "Handles that size"),
    bind(key(Key::J), || Command::SetHandles(HandleMode::Pose), "Handles that pose a person, at its joints"),
    bind(key(Key::G), || Command::ToggleSnap, "Snap handles to 0.1 m and 15\u{b0} (Ctrl: the other way round)"),
    bind(
        key(Key::P),
        || Command::TogglePlaceLight(PlaceLightBy::Highlight),
        "Place the light by its highlight: drag over a face",
    ),
    bind(
        key(Key::L),
        || Command::TogglePlaceLight(PlaceLightBy::Light),
        "Place the light by where it falls: drag over a face",
    ),
    bind(key(Key::V), || Command::ToggleLightView, "Look through the light, and back"),
    bind(key(Key::X), || Command::MirrorSelected { copies: false }, "Mirror to the other side of the subject's face"),
    bind(key(Key::O), || Command::SoloSelected, "Solo: only the selected lights; again: as before"),
    bind(key(Key::H), || Command::HideSelected, "Hide things, mute lights; again: bring them back"),
    bind(key(Key::K), || Command::LockSelected, "Lock in place; again: unlock"),
    bind(key(Key::F), || Command::FrameSelection, "Bring the selection, or everything, into view"),
    bind(ctrl(Key::Num1), || Command::ShowVariantAt(0), "The studio itself; with 2 to 9 its other variants"),
    bind(ctrl(Key::Num2), || Command::ShowVariantAt(1), ""),
    bind(ctrl(Key::Num3), || Command::ShowVariantAt(2), ""),
    bind(ctrl(Key::Num4), || Command::ShowVariantAt(3), ""),
    bind(ctrl(Key::Num5), || Command::ShowVariantAt(4), ""),
    bind(ctrl(Key::Num6), || Command::ShowVariantAt(5), ""),
    bind(ctrl(Key::Num7), || Command::ShowVariantAt(6), ""),
    bind(ctrl(Key::Num8), || Command::ShowVariantAt(7), ""),
    bind(ctrl(Key::Num9), || Command::ShowVariantAt(8), ""),
    bind(key(Key::Num1), || Command::ToggleCameraView, "Camera view, and back"),
    bind(key(Key::Num2), || Command::ToggleLiveMode, "Live view: Quick, drawn at once, or True, traced"),
    bind(key(Key::Num3), || Command::ShowView(CentralView::Picture), "The rendered picture"),
    bind(key(Key::Num5), || Command::ToggleParallel, "Perspective on or off"),
    bind(key(Key::Num7), || Command::LookFrom(ViewSide::Top), "Look from the top, with a metre grid"),
    bind(key(Key::Num8), || Command::LookFrom(ViewSide::Front), "Look from the front"),
    bind(key(Key::Num9), || Command::LookFrom(ViewSide::Right), "Look from the right"),
    bind(key(Key::R), || Command::Render, "Render"),
    bind(key(Key::F1), || Command::ToggleHelp, "This list"),
];

impl Command {
    /// Returns the shortcut of the command, if any.
    pub fn shortcut(&self) -> Option<KeyboardShortcut> {
        KEY_BINDINGS.iter().find(|binding| (binding.command)() == *self).map(|binding| binding.shortcut)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_key_has_one_binding() {
        let keys: HashSet<String> = KEY_BINDINGS.iter().map(|binding| format!("{:?}", binding.shortcut)).collect();
        assert_eq!(keys.len(), KEY_BINDINGS.len());
    }

    #[test]
    fn bindings_with_modifiers_come_before_the_plain_key() {
        let held = |binding: &KeyBinding| {
            u8::from(binding.shortcut.modifiers.shift) + u8::from(binding.shortcut.modifiers.command)
        };
        for (i, later) in KEY_BINDINGS.iter().enumerate() {
            let same_key = |earlier: &&KeyBinding| earlier.shortcut.logical_key == later.shortcut.logical_key;
            let weaker = KEY_BINDINGS[..i].iter().filter(same_key).find(|earlier| held(earlier) < held(later));
            assert!(weaker.is_none(), "{:?} hides {:?}", weaker, later);
        }
    }

    #[test]
    fn documented_shortcuts_are_bound() {
        assert_eq!(Command::Render.shortcut(), Some(key(Key::R)));
        assert_eq!(Command::ToggleCameraView.shortcut(), Some(key(Key::Num1)));
        assert_eq!(Command::SaveAs.shortcut(), Some(ctrl_shift(Key::S)));
        assert_eq!(Command::DuplicateSelected.shortcut(), Some(ctrl(Key::D)));
    }
}
