//! What menus, shortcuts, panels and the viewport ask of the window. Changes of the scene travel inside as actions.

use super::action::{Action, Item};
use super::dialogs::Purpose;
use eframe::egui::{Key, KeyboardShortcut, Modifiers};
use std::path::PathBuf;

/// What the middle of the window shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Centre {
    /// The studio from anywhere.
    #[default]
    Studio,
    /// What the camera frames.
    Camera,
    /// The rendered picture.
    Picture,
}

/// What the handles in the viewport do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Handle {
    /// Move.
    #[default]
    Move,
    /// Rotate.
    Turn,
    /// Scale.
    Size,
}

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Change the scene.
    Do(Action),
    /// Change the scene after giving the new light or object a place in it.
    Place(Box<super::catalog::Made>),
    /// Select one thing or nothing.
    Select(Option<Item>),
    /// Begin to rename a thing in the list.
    BeginRename(Item),
    /// Delete the selected thing.
    DeleteSelected,
    /// Copy the selected thing.
    DuplicateSelected,
    /// Take the last step back.
    Undo,
    /// Do it again.
    Redo,
    /// Show the list of shipped studios.
    New,
    /// Open a shipped studio, by its place in the list.
    NewFromPreset(usize),
    /// Ask for a scene and open it.
    Open,
    /// Open this scene.
    OpenPath(PathBuf),
    /// Save to the scene's file; ask where if it has none.
    Save,
    /// Ask where, then save.
    SaveAs,
    /// Ask for a model and bring it in.
    Import,
    /// Bring in this model.
    ImportPath(PathBuf),
    /// Ask for a texture for the material of this item's part (none: the item's own).
    ChooseTexture(Item, Option<String>),
    /// Ask where, then write the rendered picture.
    ExportPicture,
    /// A path was typed for a purpose, because the desktop has no dialog.
    PathTyped(Purpose, PathBuf),
    /// Empty the list of recent studios.
    ClearRecent,
    /// Close the window.
    Quit,
    /// Start to render.
    Render,
    /// Stop rendering, keep what is there.
    CancelRender,
    /// Show something in the middle.
    Show(Centre),
    /// Camera view on or off.
    ToggleCameraView,
    /// Bring the selection, or everything, into view.
    FrameSelection,
    /// Put the camera where the studio view looks from.
    CameraFromView,
    /// Choose the handles.
    Handles(Handle),
    /// Show or hide the list of keys.
    ToggleHelp,
}

impl Command {
    /// The key that gives it, where there is one.
    pub fn shortcut(&self) -> Option<KeyboardShortcut> {
        BINDINGS.iter().find(|(_, command)| command() == *self).map(|(shortcut, _)| *shortcut)
    }
}

const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

/// A key and the command it gives.
type Binding = (KeyboardShortcut, fn() -> Command);

/// All keys with one fixed meaning. Of two that match, the one with more modifiers comes first.
pub const BINDINGS: [Binding; 20] = [
    (ctrl_shift(Key::S), || Command::SaveAs),
    (ctrl_shift(Key::Z), || Command::Redo),
    (ctrl(Key::Z), || Command::Undo),
    (ctrl(Key::Y), || Command::Redo),
    (ctrl(Key::N), || Command::New),
    (ctrl(Key::O), || Command::Open),
    (ctrl(Key::S), || Command::Save),
    (ctrl(Key::I), || Command::Import),
    (ctrl(Key::E), || Command::ExportPicture),
    (ctrl(Key::D), || Command::DuplicateSelected),
    (ctrl(Key::Q), || Command::Quit),
    (key(Key::Delete), || Command::DeleteSelected),
    (key(Key::F), || Command::FrameSelection),
    (key(Key::Num1), || Command::ToggleCameraView),
    (key(Key::Num3), || Command::Show(Centre::Picture)),
    (key(Key::R), || Command::Render),
    (key(Key::M), || Command::Handles(Handle::Move)),
    (key(Key::T), || Command::Handles(Handle::Turn)),
    (key(Key::Z), || Command::Handles(Handle::Size)),
    (key(Key::F1), || Command::ToggleHelp),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_key_means_two_things() {
        let keys: HashSet<String> = BINDINGS.iter().map(|(shortcut, _)| format!("{shortcut:?}")).collect();
        assert_eq!(keys.len(), BINDINGS.len());
    }

    #[test]
    fn the_contract_of_keys_holds() {
        assert_eq!(Command::Render.shortcut(), Some(key(Key::R)));
        assert_eq!(Command::ToggleCameraView.shortcut(), Some(key(Key::Num1)));
        assert_eq!(Command::SaveAs.shortcut(), Some(ctrl_shift(Key::S)));
        assert_eq!(Command::DuplicateSelected.shortcut(), Some(ctrl(Key::D)));
    }
}
