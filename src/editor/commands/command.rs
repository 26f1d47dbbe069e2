//! The commands of menus, shortcuts, panels and viewport. A change of the scene is an [`Action`] inside a command.

use crate::editor::commands::choices::Brush;
use crate::editor::commands::choices::{CentralView, Comparison, HandleMode, LiveMode, PlaceLightBy, ViewSide};
use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::commands::preferences::Preferences;
use crate::editor::document::action::Action;
use crate::editor::document::framing::Framing;
use crate::editor::document::gear_shelf::GearEntry;
use crate::editor::document::item::Item;
use crate::editor::document::light_mix::Fader;
use crate::photo::PictureDisplay;
use crate::scene::{LightId, ObjectId, TextureSlot, VariantId};
use crate::setup::DialPlan;
use crate::sheet::{LessonSeries, Units};
use std::path::PathBuf;

/// A command of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Changes the scene.
    Apply(Action),
    /// Adds a light or object of the catalog at a suitable position.
    AddFromCatalog(Box<crate::editor::document::catalog::CatalogItem>),
    /// Selects one item, or nothing.
    Select(Option<Item>),
    /// Adds an item to the selection or removes it.
    ToggleSelected(Item),
    /// Adds these items to the selection.
    SelectAlso(Vec<Item>),
    /// Selects all lights and visible objects that are not locked.
    SelectAll,
    /// Ends the current drag, mode or selection, whichever is innermost.
    Escape,
    /// Opens the name field of an item in the list.
    BeginRename(Item),
    /// Deletes the selection.
    DeleteSelected,
    /// Puts the selection on the clipboard.
    CopySelected,
    /// Puts the selection on the clipboard and deletes it.
    CutSelected,
    /// Requests what is on the clipboard.
    RequestPaste,
    /// Adds the lights and things of a text from the clipboard.
    Paste(String),
    /// Duplicates the selection.
    DuplicateSelected,
    /// Mirrors the selection, or copies of it, about the plane through the subject's face.
    MirrorSelected {
        /// True to mirror copies and keep the originals.
        copies: bool,
    },
    /// Hides the selected objects and mutes the selected lights, or reverts that.
    HideSelected,
    /// Shows every object and unmutes every light.
    ShowAll,
    /// Solos the selected lights, or ends the solo.
    SoloSelected,
    /// Locks the selection against moves, or unlocks it.
    LockSelected,
    /// Views the studio from a side in parallel projection.
    LookFrom(ViewSide),
    /// Switches between perspective and parallel projection.
    ToggleParallel,
    /// Switches to the view through the last selected light, or back.
    ToggleLightView,
    /// Starts or ends placing the last selected light by one of its features.
    TogglePlaceLight(PlaceLightBy),
    /// Switches the snapping of the handles.
    ToggleSnap,
    /// Undoes the last step.
    Undo,
    /// Redoes the step undone last.
    Redo,
    /// Opens the list of shipped studios.
    New,
    /// Opens a shipped studio, by its index in the list.
    NewFromPreset(usize),
    /// Opens a room without lights and figures.
    NewEmpty,
    /// Opens a studio that a dialog selects.
    Open,
    /// Opens this studio.
    OpenPath(PathBuf),
    /// Saves to the studio's file; a dialog selects one if it has none.
    Save,
    /// Saves to a file that a dialog selects.
    SaveAs,
    /// Imports a model that a dialog selects.
    Import,
    /// Imports this model.
    ImportPath(PathBuf),
    /// Cancels the models and studios that are read.
    CancelLoads,
    /// Gives this light (none: a new one) the photometric file that a dialog selects.
    MeasuredLight(Option<LightId>),
    /// Gives this light (none: a new one) this photometric file.
    MeasuredLightPath(Option<LightId>, PathBuf),
    /// Gives this surround (none: a new one) the environment map that a dialog selects.
    EnvironmentMap(Option<LightId>),
    /// Gives this surround (none: a new one) this environment map.
    EnvironmentMapPath(Option<LightId>, PathBuf),
    /// Sets the texture of the material of this item's part (none: the item's own) from a dialog.
    ChooseTexture(Item, Option<String>, TextureSlot),
    /// Writes the rendered picture to a file that a dialog selects.
    ExportPicture,
    /// Writes the set-up sheet, with lengths in these units, to a file that a dialog selects.
    ExportSheet(Units),
    /// Writes a lesson sheet of a series, in which this light changes (none: the key), to a file that a dialog selects.
    ExportLesson(LessonSeries, Option<LightId>),
    /// Uses a path that was chosen or typed for a purpose.
    UseFile(FilePurpose, PathBuf),
    /// Clears the list of recent studios.
    ClearRecent,
    /// Closes the window.
    Quit,
    /// Starts a render.
    Render,
    /// Cancels the render and keeps its samples.
    CancelRender,
    /// Shows the rendered picture denoised, or as it was traced.
    ToggleDenoise,
    /// Shows the rendered picture as a photo, in false colour or with a zebra.
    DisplayPicture(PictureDisplay),
    /// Sets the faders of lights over the rendered picture.
    MixLights(Vec<LightId>, Fader),
    /// Makes the changes of the mixer in the studio.
    ApplyMix,
    /// Forgets the changes of the mixer.
    ResetMix,
    /// Shows a variant of the studio.
    ShowVariant(VariantId),
    /// Shows a variant of the studio by its place in the list; the studio itself is 0.
    ShowVariantAt(usize),
    /// Adds a variant, equal to the shown one.
    AddVariant,
    /// Opens the name field of a variant.
    BeginRenameVariant(VariantId),
    /// Compares the picture with that of another variant.
    Compare(Comparison),
    /// Shows a view in the middle of the window.
    ShowView(CentralView),
    /// Switches between camera view and studio view.
    ToggleCameraView,
    /// Frames the selection, or everything, in the studio view.
    FrameSelection,
    /// Moves the camera before a person.
    FrameFigure(ObjectId, Framing),
    /// Aims and focuses the camera at a person's face, and holds the meter before it.
    SetUpAtFace(ObjectId),
    /// Moves the camera to the studio view's viewpoint.
    CameraFromView,
    /// Lets the water of a tank run in the studio; none holds it.
    PlayTank(Option<ObjectId>),
    /// Paints cells of a tank in the view, with a brush; none ends it.
    SetBrush(Option<Brush>),
    /// Sets the speed of the water that runs, as a multiple of nature's.
    SetTankSpeed(f32),
    /// Selects the renderer of the live view.
    SetLiveMode(LiveMode),
    /// Switches to the other renderer of the live view.
    ToggleLiveMode,
    /// Selects the kind of transform handles.
    SetHandles(HandleMode),
    /// Shows or hides the window of wanted exposures.
    ToggleDials,
    /// Shows or hides the window of the room's part in the light.
    ToggleRoomAudit,
    /// Shows or hides the window of the user's gear.
    ToggleGear,
    /// Notes how many pieces of an entry of the list of gear the user owns.
    SetOwned(GearEntry, u32),
    /// Reads the user's list of gear again.
    ReadGear,
    /// Sets the dials of lights.
    SetDials(Box<DialPlan>),
    /// Shows or hides the preferences.
    TogglePreferences,
    /// Changes the preferences.
    SetPreferences(Preferences),
    /// Shows or hides the list of keys.
    ToggleHelp,
    /// Starts the tour of the window.
    StartTour,
    /// Shows or hides version and licences.
    ToggleAbout,
}
