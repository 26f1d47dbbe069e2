//! The application: its state, and one frame of the window. `run_command` and `run_file_command` execute commands.

use crate::editor::commands::choices::CentralView;
use crate::editor::commands::command::Command;
use crate::editor::commands::shortcuts::{KEY_BINDINGS, KeyBinding, clipboard_command};
use crate::editor::document::files;
use crate::editor::document::files::StudioSource;
use crate::editor::document::gear_shelf::GearShelf;
use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::panels::menu::MenuState;
use crate::editor::panels::{self, about, add, help, inspector, menu, outliner, render, status, variants, view_bar};
use crate::editor::picture::picture_view::PictureInput;
use crate::editor::picture::rendering::Rendering;
use crate::editor::picture::variant_pictures::VariantPictures;
use crate::editor::ui::side_panel::PanelWidths;
use crate::editor::ui::theme;
use crate::editor::ui::toasts::Toasts;
use crate::editor::ui::wake::wake;
use crate::editor::ui::window_part::WindowPart;
use crate::editor::viewport::live::preview_host::{PreviewHost, RendererPool, ViewOptions};
use crate::editor::viewport::live::traced_view::TracedView;
use crate::editor::viewport::tools::pointer_tool::PointerTool;
use crate::editor::viewport::viewport_area::{Viewport, ViewportInput};
use crate::editor::window::app_state::{BackgroundState, Diagnostics, PanelState, ViewState, WindowState};
use crate::editor::window::dialogs::FileDialogs;
use crate::editor::window::recovery::Recovery;
use crate::editor::window::rescue;
use crate::editor::window::session::Session;
use crate::jobs::{Estimate, Forecast, ForecastSubject, RenderOutcome, WarmSubject, sentence};
use crate::raytrace::GeometryCache;
use crate::scene::SceneChange;
use eframe::egui::text_selection::LabelSelectionState;
use eframe::egui::{self, CentralPanel, Context, Frame, Margin, Panel, Rangef, Rect, Ui, ViewportCommand};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The options of the editor.
#[derive(Debug)]
pub struct EditorOptions {
    /// The studio to open; none opens the first shipped one.
    pub initial: Option<StudioSource>,
    /// The file dialogs.
    pub dialogs: FileDialogs,
    /// Folder of the preferences and of the list of recent studios; none keeps them in memory.
    pub settings_folder: Option<PathBuf>,
    /// Folder where unsaved studios are kept for the case of a crash; none keeps none.
    pub recovery_folder: Option<PathBuf>,
    /// At the first start, the tour of the window is shown; it needs the folder of the preferences.
    pub offers_tour: bool,
    /// What the live view shows at first.
    pub view_options: ViewOptions,
    /// Compiled renderers of the live view, for programs that open several windows on one device.
    pub renderer_pool: RendererPool,
    /// Start of the program, for the time to the first frame.
    pub started: Instant,
}

impl Default for EditorOptions {
    fn default() -> Self {
        EditorOptions {
            initial: None,
            dialogs: FileDialogs::Desktop,
            settings_folder: None,
            recovery_folder: None,
            offers_tour: false,
            view_options: ViewOptions::default(),
            renderer_pool: RendererPool::default(),
            started: Instant::now(),
        }
    }
}

/// The editor: the open studio and everything that shows and changes it.
#[derive(Debug)]
pub struct App {
    pub(super) document: Document,
    pub(super) selection: Selection,
    pub(super) views: ViewState,
    pub(super) panels: PanelState,
    pub(super) rendering: Rendering,
    pub(super) variant_pictures: VariantPictures,
    pub(super) background: BackgroundState,
    pub(super) session: Session,
    pub(super) toasts: Toasts,
    pub(super) window: WindowState,
    pub(super) diagnostics: Diagnostics,
}

/// Two device losses within this time switch to the CPU preview.
const REPEATED_LOSS_TIME: Duration = Duration::from_secs(60);

/// Widths that fit the tools of the view into one row in the narrowest window.
const LEFT: PanelWidths = PanelWidths { range: Rangef { min: 200.0, max: 420.0 }, first: 270.0, share: 0.26 };
const RIGHT: PanelWidths = PanelWidths { range: Rangef { min: 300.0, max: 560.0 }, first: 340.0, share: 0.342 };

impl App {
    /// Creates the application and loads the first studio.
    pub fn new(creation: &eframe::CreationContext<'_>, options: EditorOptions) -> Self {
        let ctx = &creation.egui_ctx;
        theme::install(ctx);
        let mut preview = PreviewHost::new(creation.wgpu_render_state.as_ref(), options.renderer_pool, ctx);
        preview.view_options = options.view_options;
        let geometry: Arc<GeometryCache> = Arc::default();
        let mut app = App {
            document: Document::default(),
            selection: Selection::default(),
            views: ViewState::new(Viewport::new(preview, TracedView::new(geometry.clone()), geometry.clone())),
            panels: PanelState::new(files::presets(), GearShelf::load(options.settings_folder.as_deref())),
            rendering: Rendering::new(geometry.clone()),
            variant_pictures: VariantPictures::default(),
            background: BackgroundState::new(geometry),
            session: Session::new(options.dialogs, options.settings_folder, Recovery::new(options.recovery_folder)),
            toasts: Toasts::default(),
            window: WindowState::default(),
            diagnostics: Diagnostics::new(options.started),
        };
        app.use_preferences(ctx);
        if options.offers_tour && app.session.preferences.is_first_start() {
            app.panels.tour.open();
        }
        let first = options.initial.unwrap_or(StudioSource::Preset(0));
        app.load(first, ctx);
        app.look_for_unsaved(ctx);
        app
    }

    /// Moves to a new window after a device loss, with the open studio, its history and all other state.
    pub fn move_to(&mut self, creation: &eframe::CreationContext<'_>) {
        let ctx = &creation.egui_ctx;
        theme::install(ctx);
        self.use_preferences(ctx);
        self.views.viewport.preview.move_to(creation.wgpu_render_state.as_ref(), ctx);
        self.views.viewport.move_to(ctx);
        self.rendering.move_to(ctx);
        self.variant_pictures.move_to(ctx);
        self.background.thumbnails.renew(ctx);
        let why = self.window.device_loss.take().unwrap_or_default();
        let news = "The GPU was lost and the window was opened again; the studio is as you left it.";
        if self.window.last_loss.replace(Instant::now()).is_some_and(|last| last.elapsed() < REPEATED_LOSS_TIME) {
            self.views.viewport.preview.use_cpu("The GPU was lost twice within a minute.");
        }
        self.toasts.warning(if why.is_empty() { news.to_owned() } else { format!("{news} ({why})") });
    }

    /// Returns true after a device loss, when the window closes to be reopened.
    pub fn has_lost_window(&self) -> bool {
        self.window.device_loss.is_some()
    }

    /// Drops a lost device; returns true if it is lost. A window can end by a loss before a frame detects it.
    pub(super) fn drop_lost_device(&mut self) -> bool {
        if self.window.device_loss.is_none() {
            self.window.device_loss = self.views.viewport.preview.lost_device().map(str::to_owned);
        }
        if self.window.device_loss.is_some() {
            self.views.viewport.preview.drop_device();
        }
        self.window.device_loss.is_some()
    }

    /// Saves unsaved changes to a new file after the window is lost: beside the studio's file, else in the home folder,
    /// else in the temporary folder. Returns the file or the error; none without unsaved changes.
    pub fn rescue(&self) -> Option<Result<PathBuf, String>> {
        let home = directories::UserDirs::new().map(|dirs| dirs.home_dir().to_owned());
        let elsewhere: Vec<PathBuf> = home.into_iter().chain([std::env::temp_dir()]).collect();
        let rescued = rescue::rescue(&self.document, &elsewhere);
        // A picture has no other place.
        if matches!(rescued, Some(Ok(_))) && self.variant_pictures.to_keep(&self.rendering).is_none() {
            self.end_recovery();
        }
        rescued
    }

    /// Forgets what is kept for the case of a crash, when the user closes the window.
    pub fn end_recovery(&self) {
        self.session.recovery.end();
    }

    /// Closes a window whose device is lost. It draws nothing until then: egui's painter panics without a device.
    fn leave_window(&mut self, ctx: &Context, why: String) {
        if self.window.device_loss.is_none() {
            log::warn!("the GPU device was lost: {why}");
            self.window.device_loss = Some(why);
        }
        ctx.send_viewport_cmd(ViewportCommand::Close);
    }

    /// Takes all results and requests that arrived since the last frame.
    pub(super) fn take_in(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        for done in self.background.finished() {
            self.take_done(done, ctx);
        }
        self.take_dialog_answer(out);
        self.take_drops(ctx, out);
        self.take_close_request(ctx);
        self.quit_after_export(ctx);
        self.check_files_on_focus(ctx);
        self.keep_unsaved(ctx);
        self.advance_tank(ctx);
        self.load_wanted_assets(ctx);
        let scene = self.document.scene();
        self.variant_pictures.follow(&mut self.rendering, scene);
        self.rendering.update(scene, ctx);
        self.variant_pictures.update(&self.rendering, self.views.picture.comparison, scene, ctx);
        if self.rendering.is_running() {
            ctx.request_repaint_after(self.progress_time());
        }
        self.update_forecast();
        let document = &self.document;
        self.background.meter.update(document.scene(), document.assets(), document.revision(), &wake(ctx));
        let figure = if let Some(Item::Object(id)) = self.selection.last() { Some(id) } else { None };
        let (scene, assets) = (document.scene(), document.assets());
        self.background.pattern.update(scene, assets, figure, document.revision(), &wake(ctx));
        let (surfaces, picture) = (document.revisions().surfaces, self.rendering.settings.pixels(&scene.camera));
        let (subject, is_rendering) = (WarmSubject { surfaces, picture }, self.rendering.is_running());
        if let Some(wait) = self.background.warmer.update(subject, scene, assets, is_rendering, &wake(ctx)) {
            ctx.request_repaint_after(wait);
        }
        for warning in self.rendering.take_warnings() {
            self.toasts.warning(sentence(&warning));
        }
        match self.rendering.failure() {
            Some(message) if !self.window.render_failure_reported => {
                self.toasts.error(format!("The render failed. {message}"));
                self.window.render_failure_reported = true;
            }
            Some(_) => {}
            None => self.window.render_failure_reported = false,
        }
        self.selection.keep_existing(self.document.scene());
        if matches!(self.views.central, CentralView::Light(id) if self.document.scene().light(id).is_none()) {
            self.views.central = CentralView::Studio;
        }
    }

    /// Returns the time between two drawings of a render's progress.
    fn progress_time(&self) -> Duration {
        // A software rasteriser takes 40 ms of all processors for a frame, at four frames a second a sixth of the render.
        let is_drawn_by_cpu = self.views.viewport.preview.window_is_drawn_by_cpu();
        if is_drawn_by_cpu { Duration::from_secs(1) } else { Duration::from_millis(250) }
    }

    /// Updates the forecast from a finished render, if the studio has not changed.
    fn update_forecast(&mut self) {
        let Some((job, outcome)) = self.rendering.take_outcome() else { return };
        if !SceneChange::between(&job.scene, self.document.scene()).needs_redraw() {
            let RenderOutcome { build_s, trace_s } = outcome;
            // Renders of few samples have no noise estimate
            let Some(film) = job.film() else { return };
            let Some(forecast) = Forecast::from_render(build_s, trace_s, film) else { return };
            let measured = Estimate { seconds: build_s + trace_s, noise_stops: forecast.noise_stops() };
            let subject = ForecastSubject { revision: self.document.revisions().image, method: job.settings.method };
            self.background.forecaster.learn(subject, forecast, measured);
        }
    }

    /// Collects the commands of shortcuts, unless a text field, prompt or menu has the keyboard.
    fn shortcuts(&mut self, ctx: &Context, out: &mut Vec<Command>) {
        // An open menu handles Esc.
        let menu = egui::Popup::is_any_open(ctx);
        if ctx.text_edit_focused() || self.session.is_asking() || self.panels.preset_picker.is_open() || menu {
            return;
        }
        if self.views.viewport.is_dragging() {
            // Typed characters are the amount of the drag.
            if ctx.input_mut(|i| i.consume_key(egui::Modifiers::NONE, egui::Key::Escape)) {
                // Immediately, or the drag would continue in this frame.
                self.views.viewport.cancel_drag();
                // A box has no steps to discard, and has ended: Esc is not for anything else
                if self.views.viewport.is_dragging() {
                    out.push(Command::Escape);
                }
            }
            return;
        }
        // Only undo and redo repeat with a held key.
        let repeats =
            ctx.input(|i| i.events.iter().any(|e| matches!(e, egui::Event::Key { pressed: true, repeat: true, .. })));
        // The system's keys for the clipboard arrive as events. Selected text of a message is copied by egui.
        let has_text = ctx.with_plugin(|labels: &mut LabelSelectionState| labels.has_selection()).unwrap_or(false);
        if !has_text {
            out.extend(ctx.input(|i| i.events.iter().filter_map(clipboard_command).collect::<Vec<_>>()));
        }
        for KeyBinding { shortcut, command, .. } in &KEY_BINDINGS {
            if ctx.input_mut(|i| i.consume_shortcut(shortcut)) {
                let command = command();
                let may_repeat = matches!(command, Command::Undo | Command::Redo);
                out.extend((may_repeat || !repeats).then_some(command));
            }
        }
    }

    /// Returns the press that changes of this frame belong to; none without a held button or key.
    fn press_id(&mut self, ctx: &Context) -> Option<u64> {
        let (began, held) = ctx.input(|i| {
            let key_began = i.events.iter().any(|e| matches!(e, egui::Event::Key { pressed: true, repeat: false, .. }));
            let held = i.pointer.any_down() || i.pointer.any_released() || !i.keys_down.is_empty();
            // A key pressed during a drag belongs to the drag.
            (i.pointer.any_pressed() || (key_began && !i.pointer.any_down()), held)
        });
        self.window.press_id += u64::from(began);
        held.then_some(self.window.press_id)
    }

    /// Draws all panels; returns the rectangle of the central one.
    fn panels_ui(&mut self, ui: &mut Ui, out: &mut Vec<Command>) -> Rect {
        // The window is cleared to the panels' colour and each view covers the middle; filling the panels again would
        // cost a software renderer most of its time.
        let bar = Frame::new().inner_margin(Margin::symmetric(8, 3));
        let side = Frame::new().inner_margin(Margin::symmetric(10, 4));
        Panel::top("menu").frame(bar).show(ui, |ui| menu::menu_ui(ui, self.menu_state(), out));
        Panel::bottom("status").frame(bar).exact_size(26.0).show(ui, |ui| {
            let activity = self.background.activity();
            let busy = (activity, &*self.background.loads);
            status::status_ui(ui, &self.document, &self.selection, self.views.central, busy, out);
        });
        let (mut left, mut right) = (self.panels.left, self.panels.right);
        left.show(ui, "things", Panel::left("things").frame(side), LEFT, |ui| {
            let add_height = (ui.available_height() * 0.46).max(120.0);
            Panel::top("add").frame(Frame::new()).default_size(add_height).resizable(true).show(ui, |ui| {
                WindowPart::Shelf.note(ui.ctx(), ui.max_rect());
                let PanelState { catalog_tab, shelf_query, gear, .. } = &mut self.panels;
                let (thumbnails, scene) = (&mut self.background.thumbnails, self.document.scene());
                add::add_ui(ui, catalog_tab, shelf_query, thumbnails, gear, scene, out);
            });
            outliner::outliner_ui(ui, &self.document, &self.selection, &mut self.panels.outliner, out);
        });
        right.show(ui, "details", Panel::right("details").frame(side), RIGHT, |ui| {
            Panel::bottom("render").frame(Frame::new()).resizable(false).show(ui, |ui| {
                WindowPart::Render.note(ui.ctx(), ui.max_rect());
                let (rendering, forecaster) = (&mut self.rendering, &mut self.background.forecaster);
                render::render_ui(ui, rendering, forecaster, &self.document, self.views.central, out);
            });
            WindowPart::Inspector.note(ui.ctx(), ui.available_rect_before_wrap());
            let (patterns, gear) = (&self.background.pattern, self.panels.gear.list());
            let brush = self.views.viewport.tool.as_ref().and_then(PointerTool::brush);
            let tank_tools = inspector::TankTools { player: &self.panels.tank_player, brush };
            inspector::inspector_ui(ui, &self.document, &self.selection, patterns, gear, tank_tools, out);
        });
        (self.panels.left, self.panels.right) = (left, right);
        CentralPanel::default().frame(Frame::new()).show(ui, |ui| self.central_ui(ui, out)).response.rect
    }

    fn central_ui(&mut self, ui: &mut Ui, out: &mut Vec<Command>) {
        let bar = Frame::new().inner_margin(Margin::symmetric(8, 4));
        Panel::top("views").frame(bar).show(ui, |ui| {
            let mut follows = self.views.viewport.camera_follows;
            view_bar::view_bar_ui(ui, self.menu_state(), &mut follows, out);
            self.views.viewport.camera_follows = follows;
        });
        if !self.document.scene().variants.is_empty() {
            let (scene, pictures) = (self.document.scene(), &self.variant_pictures);
            Panel::top("variants").frame(bar).show(ui, |ui| {
                variants::variants_ui(ui, scene, pictures, &mut self.panels.variants, out);
            });
        }
        let view = ui.available_rect_before_wrap();
        theme::draw_over_picture(ui);
        if self.views.central == CentralView::Picture {
            self.views.viewport.traced_view.pause();
            let input = PictureInput {
                rendering: &self.rendering,
                pictures: &self.variant_pictures,
                scene: self.document.scene(),
            };
            self.views.picture.ui(ui, input, out);
            self.meter_ui(ui.ctx(), view, out);
            return;
        }
        let (width, height) = self.rendering.settings.pixels(&self.document.scene().camera);
        let input = ViewportInput {
            document: &self.document,
            selection: &self.selection,
            central_view: self.views.central,
            handles: self.views.handles,
            picture_aspect: width as f32 / height as f32,
        };
        self.views.viewport.ui(ui, input, out);
        self.meter_ui(ui.ctx(), view, out);
    }

    /// Draws the read-out of the light meter over the view, if there is one.
    fn meter_ui(&self, ctx: &Context, view: Rect, out: &mut Vec<Command>) {
        if let Some(meter) = &self.document.scene().meter {
            panels::meter::meter_ui(ctx, view, meter, self.background.meter.reading(), out);
        }
    }

    fn menu_state(&self) -> MenuState<'_> {
        MenuState {
            document: &self.document,
            selection: &self.selection,
            recent: self.session.recent.paths(),
            central_view: self.views.central,
            handles: self.views.handles,
            snap: self.views.viewport.snap,
            live: self.views.viewport.traced_view.mode,
            has_picture: self.rendering.developed().is_some(),
            rendering: self.rendering.is_running(),
        }
    }

    fn update_title(&mut self, ctx: &Context) {
        let star = if self.document.is_dirty() { "*" } else { "" };
        let title = format!("{}{star} \u{2013} Catchlight", self.document.title());
        if title != self.window.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.window.title = title;
        }
    }
}

impl eframe::App for App {
    /// Returns the colour of the panels.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    /// Handles a minimised or covered window, whose frames are not drawn.
    fn logic(&mut self, ctx: &Context, _frame: &mut eframe::Frame) {
        if ctx.input(|i| i.viewport().visible()) != Some(false) {
            return;
        }
        // Nothing is visible: pause the tracer.
        self.views.viewport.traced_view.pause();
        self.keep_unsaved(ctx);
        if let Some(why) = self.views.viewport.preview.lost_device().map(str::to_owned) {
            self.leave_window(ctx, why);
        } else {
            self.take_close_request(ctx);
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        if let Some(why) = self.views.viewport.preview.lost_device().map(str::to_owned) {
            self.leave_window(&ctx, why);
            return;
        }
        let rendering = if self.rendering.is_running() { ", rendering" } else { "" };
        let has_input = ctx.input(|i| !i.events.is_empty());
        self.diagnostics
            .frame_log
            .frame(has_input, &format!("{:?} view{rendering}", self.views.viewport.traced_view.mode));
        let mut out = Vec::new();
        let press_id = self.press_id(&ctx);
        self.take_in(&ctx, &mut out);
        self.shortcuts(&ctx, &mut out);
        let middle = self.panels_ui(ui, &mut out);
        self.panels.preset_picker.ui(&ctx, &self.panels.presets, &mut self.background.thumbnails, &mut out);
        help::help_ui(&ctx, &mut self.panels.show_help);
        about::about_ui(&ctx, &mut self.panels.show_about);
        self.preferences_ui(&ctx, &mut out);
        self.tour_ui(&ctx, middle, &mut out);
        self.setup_windows_ui(&ctx, middle, &mut out);
        self.ask(&ctx, &mut out);
        self.drop_hint(&ctx);
        self.toasts.ui(&ctx, middle);
        let changed = !out.is_empty();
        for command in out {
            self.run(command, press_id, &ctx);
        }
        if changed {
            // The panels were drawn before the commands ran.
            ctx.request_repaint();
        }
        self.update_title(&ctx);
        if self.diagnostics.first_frame.is_none() {
            let elapsed = self.diagnostics.started.elapsed();
            log::debug!("first frame after {} ms", elapsed.as_millis());
            self.diagnostics.first_frame = Some(elapsed);
        }
        if !self.diagnostics.first_view_logged
            && self.views.viewport.preview.draws() > 0
            && !self.background.tasks.is_busy()
        {
            log::debug!("first live view of the studio after {} ms", self.diagnostics.started.elapsed().as_millis());
            self.diagnostics.first_view_logged = true;
        }
        if self.views.viewport.preview.lost_device().is_some() {
            // The loss occurred in this frame: discard it.
            ctx.request_discard("the GPU device was lost");
        }
    }
}
