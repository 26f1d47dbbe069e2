//! What menus, shortcuts, panels and the viewport ask of the window. Changes of the scene travel inside as actions.

use crate::editor::commands::choices::{CentralView, HandleMode, LiveMode, PlaceLightBy, ViewSide};
use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use std::path::PathBuf;

/// One request.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Change the scene.
    Apply(Action),
    /// Change the scene after giving the new light or object a place in it.
    AddFromCatalog(Box<crate::editor::document::catalog::CatalogItem>),
    /// Select one thing, or nothing.
    Select(Option<Item>),
    /// Take a thing into the selection, or out of it.
    ToggleSelected(Item),
    /// Select these things, too.
    SelectAlso(Vec<Item>),
    /// Select all lights and things that are not locked.
    SelectAll,
    /// Leave what is under way: a drag, a mode, the selection.
    Escape,
    /// Begin to rename a thing in the list.
    BeginRename(Item),
    /// Delete what is selected.
    DeleteSelected,
    /// Copy what is selected.
    DuplicateSelected,
    /// Put what is selected, or copies of it, on the other side of the subject's face.
    MirrorSelected {
        /// Whether the originals stay.
        copies: bool,
    },
    /// Hide the selected things and mute the selected lights, or bring them back.
    HideSelected,
    /// Show every thing and unmute every light.
    ShowAll,
    /// Let the selected lights shine alone, or bring back what was on before.
    SoloSelected,
    /// Lock the selection in its place, or let it go.
    LockSelected,
    /// Look at the studio from a side, without perspective.
    LookFrom(ViewSide),
    /// Perspective on or off.
    ToggleParallel,
    /// Look through the last selected light, or back.
    ToggleLightView,
    /// Place the last selected light by its highlight or its light, or end that.
    TogglePlaceLight(PlaceLightBy),
    /// Snapping of handles on or off.
    ToggleSnap,
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
    UseFile(FilePurpose, PathBuf),
    /// Empty the list of recent studios.
    ClearRecent,
    /// Close the window.
    Quit,
    /// Start to render.
    Render,
    /// Stop rendering, keep what is there.
    CancelRender,
    /// Show something in the middle.
    ShowView(CentralView),
    /// Camera view on or off.
    ToggleCameraView,
    /// Bring the selection, or everything, into view.
    FrameSelection,
    /// Put the camera where the studio view looks from.
    CameraFromView,
    /// The live view by the graphics card or by the tracer.
    SetLiveMode(LiveMode),
    /// The other one of the two.
    ToggleLiveMode,
    /// Choose the handles.
    SetHandles(HandleMode),
    /// Show or hide the list of keys.
    ToggleHelp,
}
