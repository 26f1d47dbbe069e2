//! The state of the editor outside the document, grouped by what changes together.

use crate::editor::commands::choices::{CentralView, HandleMode};
use crate::editor::document::catalog::CatalogTab;
use crate::editor::document::dial_wishes::DialWishes;
use crate::editor::document::files::PresetInfo;
use crate::editor::document::gear_shelf::GearShelf;
use crate::editor::document::model_import::RunningLoad;
use crate::editor::document::tank_player::TankPlayer;
use crate::editor::panels::gear::GearTab;
use crate::editor::panels::outliner::OutlinerState;
use crate::editor::panels::presets::PresetPicker;
use crate::editor::panels::thumbnails::Thumbnails;
use crate::editor::panels::tour::Tour;
use crate::editor::panels::variants::VariantsState;
use crate::editor::picture::picture_view::PictureView;
use crate::editor::ui::side_panel::SidePanel;
use crate::editor::viewport::viewport_area::Viewport;
use crate::editor::window::background_tasks::{BackgroundTasks, TaskResult};
use crate::editor::window::frame_log::FrameLog;
use crate::jobs::{CacheWarmer, Clock, Forecaster, MeterJob, PatternJob};
use crate::raytrace::GeometryCache;
use crate::setup::{MeasurementJob, RoomAudit, SetupTransport};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The views in the middle of the window.
#[derive(Debug)]
pub struct ViewState {
    /// The view on show.
    pub central: CentralView,
    /// The view that closing the view through a light returns to.
    pub before_light: CentralView,
    /// The kind of transform handles.
    pub handles: HandleMode,
    /// The live views of the studio.
    pub viewport: Viewport,
    /// Zoom and offset of the rendered picture.
    pub picture: PictureView,
}

impl ViewState {
    /// Starts in the studio view with handles that move.
    pub fn new(viewport: Viewport) -> Self {
        ViewState {
            central: CentralView::default(),
            before_light: CentralView::default(),
            handles: HandleMode::default(),
            viewport,
            picture: PictureView::default(),
        }
    }
}

/// The panels and lists around the viewport.
#[derive(Debug)]
pub struct PanelState {
    /// The name field of the list of items.
    pub outliner: OutlinerState,
    /// The name field of the list of variants.
    pub variants: VariantsState,
    /// The list of shipped studios, open or closed.
    pub preset_picker: PresetPicker,
    /// The shipped studios.
    pub presets: Vec<PresetInfo>,
    /// The open tab of the catalog.
    pub catalog_tab: CatalogTab,
    /// What is searched for in the catalog.
    pub shelf_query: String,
    /// True while the preferences are open.
    pub show_preferences: bool,
    /// True while version and licences are shown.
    pub show_about: bool,
    /// True while the list of keys is open.
    pub show_help: bool,
    /// True while the window of wanted exposures is open.
    pub show_dials: bool,
    /// True while the window of the room's part in the light is open.
    pub show_room_audit: bool,
    /// True while the window of the user's gear is open.
    pub show_gear: bool,
    /// The open list of that window.
    pub gear_tab: GearTab,
    /// The list of gear.
    pub gear: GearShelf,
    /// The card of the tour.
    pub tour: Tour,
    /// The wanted exposures.
    pub dial_wishes: DialWishes,
    /// The water that runs.
    pub tank_player: TankPlayer,
    /// The panel of catalog and item list.
    pub left: SidePanel,
    /// The panel of inspector and render settings.
    pub right: SidePanel,
}

impl PanelState {
    /// Starts with the lights of the catalog.
    pub fn new(presets: Vec<PresetInfo>, gear: GearShelf) -> Self {
        PanelState {
            outliner: OutlinerState::default(),
            variants: VariantsState::default(),
            preset_picker: PresetPicker::default(),
            presets,
            catalog_tab: CatalogTab::Lights,
            shelf_query: String::new(),
            show_preferences: false,
            show_about: false,
            show_help: false,
            show_dials: false,
            show_room_audit: false,
            show_gear: false,
            gear_tab: GearTab::default(),
            gear,
            tour: Tour::default(),
            dial_wishes: DialWishes::default(),
            tank_player: TankPlayer::default(),
            left: SidePanel::default(),
            right: SidePanel::default(),
        }
    }

    /// Ends what the panels show of the former studio, because another one is open.
    pub fn begin_studio(&mut self) {
        (self.outliner, self.variants) = (OutlinerState::default(), VariantsState::default());
        self.tank_player.hold();
        self.dial_wishes.clear();
    }
}

/// Background work other than renders and the live view.
#[derive(Debug)]
pub struct BackgroundState {
    /// File operations that the studio waits for.
    pub tasks: BackgroundTasks,
    /// The models and studios among them that are read.
    pub loads: Vec<RunningLoad>,
    /// Pictures and sheets that are made and written.
    pub exports: BackgroundTasks,
    /// The reading of the light meter.
    pub meter: MeterJob,
    /// The exposures of all lights, for wanted ones.
    pub transport: MeasurementJob<SetupTransport>,
    /// What the room does to the light.
    pub room_audit: MeasurementJob<RoomAudit>,
    /// The lighting of the selected figure's face.
    pub pattern: PatternJob,
    /// The estimate of render time and noise.
    pub forecaster: Forecaster,
    /// The BVHs of the next render.
    pub warmer: CacheWarmer,
    /// The pictures of presets and catalog entries.
    pub thumbnails: Thumbnails,
}

impl BackgroundState {
    /// Returns idle work that shares BVHs of meshes with renders and live view.
    pub fn new(geometry: Arc<GeometryCache>) -> Self {
        BackgroundState {
            tasks: BackgroundTasks::default(),
            loads: Vec::new(),
            exports: BackgroundTasks::default(),
            meter: MeterJob::new(geometry.clone()),
            transport: MeasurementJob::new(SetupTransport::measure, geometry.clone()),
            room_audit: MeasurementJob::new(RoomAudit::measure, geometry.clone()),
            pattern: PatternJob::default(),
            forecaster: Forecaster::new(geometry.clone(), Clock::default()),
            warmer: CacheWarmer::new(geometry, Clock::default()),
            thumbnails: Thumbnails::default(),
        }
    }

    /// Returns the results of tasks since the last call.
    pub fn finished(&mut self) -> Vec<TaskResult> {
        let mut finished = self.tasks.finished();
        finished.append(&mut self.exports.finished());
        finished
    }

    /// Returns true while a task or the meter is running.
    pub fn is_busy(&self) -> bool {
        self.tasks.is_busy()
            || self.exports.is_busy()
            || self.meter.is_busy()
            || self.transport.is_busy()
            || self.room_audit.is_busy()
    }

    /// Returns what the tasks are doing, for the status line.
    pub fn activity(&self) -> Option<&'static str> {
        let loading = self.tasks.is_busy().then_some("Loading\u{2026}");
        loading.or(self.exports.is_busy().then_some("Exporting\u{2026}"))
    }
}

/// The native window and its input.
#[derive(Debug, Default)]
pub struct WindowState {
    /// The title as last sent to the window.
    pub title: String,
    /// Number of the last press of a button or key; the changes of one press are one undo step.
    pub press_id: u64,
    /// The reason why the window's device was lost; none while the window can draw.
    pub device_loss: Option<String>,
    /// Time of the last device loss.
    pub last_loss: Option<Instant>,
    /// The window has the keyboard.
    pub has_focus: bool,
    /// True once the failure of the current render job has been reported.
    pub render_failure_reported: bool,
}

/// Timings for the log.
#[derive(Debug)]
pub struct Diagnostics {
    /// Start of the program.
    pub started: Instant,
    /// Time from the start of the program to the end of the first frame.
    pub first_frame: Option<Duration>,
    /// True once the time of the first live view has been logged.
    pub first_view_logged: bool,
    /// Times between frames.
    pub frame_log: FrameLog,
}

impl Diagnostics {
    /// Starts without any frame.
    pub fn new(started: Instant) -> Self {
        Diagnostics { started, first_frame: None, first_view_logged: false, frame_log: FrameLog::default() }
    }
}
