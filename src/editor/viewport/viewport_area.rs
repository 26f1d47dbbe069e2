//! The viewport: live view, navigation, selection, handles and overlays.

use crate::editor::commands::choices::{CentralView, HandleMode};
use crate::editor::commands::command::Command;
use crate::editor::commands::item_menu::{empty_selection_menu_ui, item_menu_ui};
use crate::editor::document::action::Action;
use crate::editor::document::bounds::bounds;
use crate::editor::document::item::Item;
use crate::editor::document::selection::{Selection, centre};
use crate::editor::document::studio_document::Document;
use crate::editor::ui::{scopes, spot_readout, theme};
use crate::editor::viewport::live::channel_menu::channel_menu_ui;
use crate::editor::viewport::live::live_scopes::LiveScopes;
use crate::editor::viewport::live::preview_host::{PreviewHost, ViewOptions};
use crate::editor::viewport::live::traced_view::TracedView;
use crate::editor::viewport::navigation::{camera_as_view, light_as_view, moved_camera, moved_light, steer};
use crate::editor::viewport::overlays::axis_widget::{self, axis_widget_ui};
use crate::editor::viewport::overlays::floor_plan;
use crate::editor::viewport::overlays::light_view;
use crate::editor::viewport::overlays::markers;
use crate::editor::viewport::studio_view::StudioView;
use crate::editor::viewport::tools::click_pick;
use crate::editor::viewport::tools::handle_pointer::HandlePointer;
use crate::editor::viewport::tools::handle_view::HandleView;
use crate::editor::viewport::tools::joint_handles::JointHandles;
use crate::editor::viewport::tools::marquee_selection::MarqueeSelection;
use crate::editor::viewport::tools::pointer_tool::PointerTool;
use crate::editor::viewport::tools::transform_handles::TransformHandles;
use crate::preview::{Channel, Overlay, Pick, is_dark};
use crate::raytrace::GeometryCache;
use crate::scene::{Camera, CameraFrame, Object, Scene, Shape};
use eframe::egui::{
    self, Align2, Color32, Context, EventFilter, FontId, Pos2, Rect, Response, RichText, Sense, Ui, vec2,
};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Fraction of the view that the picture's frame fills in the camera view.
const FRAME_MARGIN: f32 = 0.92;

/// The input of the viewport for one frame.
#[derive(Clone, Copy, Debug)]
pub struct ViewportInput<'a> {
    /// The open studio.
    pub document: &'a Document,
    /// The selection.
    pub selection: &'a Selection,
    /// The viewpoint: studio view, camera or a light.
    pub central_view: CentralView,
    /// Kind of transform handles.
    pub handles: HandleMode,
    /// Aspect (width / height) of the rendered picture.
    pub picture_aspect: f32,
}

/// The state of the viewport.
#[derive(Debug)]
pub struct Viewport {
    /// The studio view.
    pub view: StudioView,
    /// True if navigation in the camera view moves the camera.
    pub camera_follows: bool,
    /// True if handles snap; Ctrl inverts it.
    pub snap: bool,
    /// The tool that has the pointer, if one is active.
    pub tool: Option<PointerTool>,
    /// The GPU or CPU preview.
    pub preview: PreviewHost,
    /// The traced view.
    pub traced_view: TracedView,
    scopes: LiveScopes,
    handles: TransformHandles,
    joints: JointHandles,
    marquee: Option<MarqueeSelection>,
}

impl Viewport {
    /// Returns a viewport with these renderers, and with scopes that share the BLAS cache.
    pub fn new(preview: PreviewHost, traced_view: TracedView, cache: Arc<GeometryCache>) -> Self {
        Viewport {
            view: StudioView::default(),
            camera_follows: false,
            snap: false,
            tool: None,
            preview,
            traced_view,
            scopes: LiveScopes::new(cache),
            handles: TransformHandles::default(),
            joints: JointHandles::default(),
            marquee: None,
        }
    }

    /// Returns true while handles, a tool or a box are dragged: keys are numbers then, and Esc cancels the
    /// drag.
    pub fn is_dragging(&self) -> bool {
        let is_at_work = self.tool.as_ref().is_some_and(PointerTool::is_dragging);
        let handles = self.handles.is_dragging() || self.joints.is_dragging();
        handles || is_at_work || self.marquee.is_some()
    }

    /// Uploads the images of the views to the window's current device.
    pub fn move_to(&mut self, ctx: &Context) {
        self.traced_view.move_to(ctx);
        self.scopes.move_to(ctx);
    }

    /// Returns true while the light under the pointer is being read.
    pub fn is_reading_spot(&self) -> bool {
        self.scopes.is_busy()
    }

    /// Returns true if the pointer is on a handle.
    pub fn is_over_handle(&self) -> bool {
        self.handles.wants_pointer() || self.joints.wants_pointer()
    }

    /// Cancels a drag of handles, a tool or a box; the button may still be down.
    pub fn cancel_drag(&mut self) {
        self.marquee = None;
        self.handles.cancel();
        self.joints.cancel();
        if let Some(tool) = &mut self.tool {
            tool.cancel();
        }
    }

    /// Draws the viewport and handles mouse and keys.
    pub fn ui(&mut self, ui: &mut Ui, input: ViewportInput<'_>, out: &mut Vec<Command>) {
        let size = ui.available_size().max(vec2(8.0, 8.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        crate::editor::ui::widgets::named(ui, &response, "Viewport");
        self.navigate(ui, &response, input, out);
        let scene = input.document.scene();
        let (frame, picture) = self.frame(scene, input, rect);
        // A change of the selection ends a tool
        self.tool = self.tool.take().filter(|tool| tool.is_for(input.selection));
        if let Some(tool) = &mut self.tool {
            self.handles.reset();
            self.joints.reset();
            self.marquee = None;
            if !tool.drag(ui, &response, input.document, &frame, out) {
                self.tool = None;
            }
        } else {
            self.handle_drag(ui, &response, rect, &frame, input, out);
            self.marquee(ui, &response, &frame, input, out);
            self.click(ui, &response, &frame, input, out);
            self.context_menu(ui, &response, &frame, input, out);
        }
        self.paint(ui, rect, frame, picture, input);
        let on_cpu = self.preview.failure().is_some();
        channel_menu_ui(ui, rect, scene, &mut self.preview.view_options, on_cpu);
        self.cpu_notice_ui(ui, rect);
        if input.central_view == CentralView::Studio {
            axis_widget_ui(ui, rect, &self.view, &frame, out);
        }
        // Last: a widget that comes and goes would change the ids of those after it, which closes their menus
        self.scopes_ui(ui, &response, input.document, &frame);
    }

    /// Returns the camera frame of the view, and the rectangle of the picture (camera view only).
    fn frame(&self, scene: &Scene, input: ViewportInput<'_>, rect: Rect) -> (CameraFrame, Option<Rect>) {
        let aspect = rect.width() / rect.height();
        match input.central_view {
            CentralView::Camera => {
                let mut frame = scene.camera_frame(input.picture_aspect);
                let height = (rect.width() / input.picture_aspect).min(rect.height()) * FRAME_MARGIN;
                let picture = Rect::from_center_size(rect.center(), vec2(height * input.picture_aspect, height));
                frame.half_extent *= Vec2::new(rect.width() / picture.width(), rect.height() / picture.height());
                (frame, Some(picture))
            }
            CentralView::Light(id) => {
                let frame = scene.light(id).map(|light| light_view::frame(scene, light, aspect));
                (frame.unwrap_or_else(|| self.view.frame(aspect)), None)
            }
            CentralView::Studio | CentralView::Picture => (self.view.frame(aspect), None),
        }
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, input: ViewportInput<'_>, out: &mut Vec<Command>) {
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.has_focus() {
            // Esc is a command here and does not move the focus.
            let filter =
                EventFilter { horizontal_arrows: true, vertical_arrows: true, escape: true, ..EventFilter::default() };
            ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
        }
        let scene = input.document.scene();
        let light = if let CentralView::Light(id) = input.central_view { scene.light(id) } else { None };
        let (mut view, pivot) = match (input.central_view, light) {
            (CentralView::Camera, _) => (camera_as_view(scene), None),
            (_, Some(light)) => (light_as_view(scene, light), None),
            _ => (self.view, input.selection.centre(scene)),
        };
        let before = view;
        let kept_aim = steer(ui, response, &mut view, pivot, self.is_over_handle());
        if view == before {
            return;
        }
        if let Some(light) = light {
            out.push(Command::Apply(Action::SetLight(Box::new(moved_light(light, &view, kept_aim)))));
        } else if input.central_view == CentralView::Camera && self.camera_follows {
            out.push(Command::Apply(Action::SetCamera(Box::new(moved_camera(scene, &view, kept_aim)))));
        } else {
            if input.central_view == CentralView::Camera {
                out.push(Command::ShowView(CentralView::Studio));
            }
            self.view = view;
        }
    }

    fn handle_drag(
        &mut self,
        ui: &Ui,
        response: &Response,
        rect: Rect,
        frame: &CameraFrame,
        input: ViewportInput<'_>,
        out: &mut Vec<Command>,
    ) {
        let scene = input.document.scene();
        let items = items_with_handles(scene, input);
        let Some(position) = ui.input(|i| i.pointer.latest_pos()).filter(|_| !items.is_empty()) else {
            self.handles.reset();
            self.joints.reset();
            return;
        };
        let on_cross = input.central_view == CentralView::Studio && axis_widget::place(rect).contains(position);
        let pointer = ui.input(|i| HandlePointer {
            position,
            is_over: response.contains_pointer() && !on_cross && !i.modifiers.alt,
            pressed: i.pointer.primary_pressed(),
            down: i.pointer.primary_down(),
            snap: i.modifiers.command != self.snap,
        });
        let keys = if self.handles.is_dragging() { ui.input(|i| i.events.clone()) } else { Vec::new() };
        let view = HandleView { frame, rect };
        if let Some(figure) = posed_figure(scene, input) {
            self.handles.reset();
            out.extend(self.joints.update(figure, view, pointer).map(Command::Apply));
            return;
        }
        self.joints.reset();
        if let Some(action) = self.handles.update(scene, &items, input.handles, view, pointer, &keys) {
            out.push(Command::Apply(action));
        }
    }

    /// Handles the selection box.
    fn marquee(
        &mut self,
        ui: &Ui,
        response: &Response,
        frame: &CameraFrame,
        input: ViewportInput<'_>,
        out: &mut Vec<Command>,
    ) {
        let taken = self.is_over_handle();
        if let Some(chosen) = MarqueeSelection::drag(&mut self.marquee, ui, response, taken, frame, input.document) {
            let adds = ui.input(|i| i.modifiers.shift || i.modifiers.command);
            if !adds {
                out.push(Command::Select(None));
            }
            out.push(Command::SelectAlso(chosen));
        }
    }

    /// Returns the item at a screen position.
    fn under(&self, ui: &Ui, rect: Rect, frame: &CameraFrame, scene: &Scene, position: Pos2) -> Option<Item> {
        let pixel = (position - rect.min) * ui.pixels_per_point();
        let picked = self.preview.pick((pixel.x.max(0.0) as u32, pixel.y.max(0.0) as u32));
        click_pick::item_at(scene, frame, rect, position, picked)
    }

    fn click(
        &self,
        ui: &Ui,
        response: &Response,
        frame: &CameraFrame,
        input: ViewportInput<'_>,
        out: &mut Vec<Command>,
    ) {
        let Some(position) = response.interact_pointer_pos().filter(|_| response.clicked()) else { return };
        let (alt, adds) = ui.input(|i| (i.modifiers.alt, i.modifiers.shift || i.modifiers.command));
        if self.is_over_handle() || alt {
            return;
        }
        let item = self.under(ui, response.rect, frame, input.document.scene(), position);
        out.extend(match (item, adds) {
            (Some(item), true) => Some(Command::ToggleSelected(item)),
            // A click on nothing with Shift or Ctrl keeps the selection.
            (None, true) => None,
            (item, false) => Some(Command::Select(item)),
        });
    }

    /// Handles the right button: selects the item under it, unless selected, and opens the menu of the selection.
    fn context_menu(
        &self,
        ui: &Ui,
        response: &Response,
        frame: &CameraFrame,
        input: ViewportInput<'_>,
        out: &mut Vec<Command>,
    ) {
        let scene = input.document.scene();
        if let Some(position) = response.interact_pointer_pos().filter(|_| response.secondary_clicked()) {
            let item = self.under(ui, response.rect, frame, scene, position);
            let is_selected = item.is_some_and(|item| input.selection.contains(item));
            out.extend((!is_selected).then_some(Command::Select(item)));
        }
        response.context_menu(|ui| match input.selection.last() {
            Some(item) => item_menu_ui(ui, scene, item, input.selection, out),
            None => empty_selection_menu_ui(ui, out),
        });
    }

    fn paint(&mut self, ui: &mut Ui, rect: Rect, frame: CameraFrame, picture: Option<Rect>, input: ViewportInput<'_>) {
        // Update the images of the live view and its scopes, and draw them
        let painter = ui.painter_at(rect);
        let pixels = rect.size() * ui.pixels_per_point();
        let size = ((pixels.x.round() as u32).max(1), (pixels.y.round() as u32).max(1));
        let overlay = self.overlay_of(input);
        let has_work_light = overlay.work_light;
        let through_camera = input.central_view == CentralView::Camera;
        let traced =
            self.traced_view.show(ui.ctx(), input.document, frame, size, through_camera, self.preview.view_options);
        let preview = self.preview.show(ui.ctx(), input.document, frame, size, overlay, traced.is_some());
        let view_options = self.preview.view_options;
        let linear = if traced.is_some() { self.traced_view.picture() } else { self.preview.linear_picture() };
        let linear = linear.filter(|_| view_options.has_scopes());
        let scopes = (view_options.display, view_options.charts);
        let scoped = self.scopes.show(ui.ctx(), linear, scopes, part_of(rect, picture.unwrap_or(rect)));
        if scoped.or(traced).or(preview).is_none() {
            painter.rect_filled(rect, 0.0, theme::SURROUND);
        }
        for texture in [scoped.or(traced), preview].into_iter().flatten() {
            let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(texture, rect, uv, Color32::WHITE);
        }
        self.preview.paint_over(&painter, rect);
        // Draw notes over the image
        let font = FontId::proportional(13.0);
        let is_lit_view = self.preview.view_options.channel == Channel::Lit;
        let shows_work_light = has_work_light && is_lit_view && is_dark(input.document.scene());
        if shows_work_light && traced.is_none() && self.preview.failure().is_none() {
            let at = rect.center_bottom() - vec2(0.0, 14.0);
            let text = "No light is on. This is a work light, which pictures do not have.";
            painter.text(at, Align2::CENTER_BOTTOM, text, font.clone(), theme::ACCENT);
        }
        if traced.or(preview).is_none() {
            let text = "Preparing the live view\u{2026}";
            painter.text(rect.center(), Align2::CENTER_CENTER, text, font, Color32::from_gray(140));
        }
        // Draw the picture's frame, the plan's grid and distances, and how far the traced view is
        let scene = input.document.scene();
        if let Some(picture) = picture {
            markers::paint_picture_frame(&painter, rect, picture);
        }
        let side = self.view.side.filter(|_| input.central_view == CentralView::Studio);
        if let Some(side) = side {
            floor_plan::paint_grid(&painter, &frame, rect, side, self.view.target, self.view.half_height_m());
            floor_plan::paint_distances(&painter, input.document, &frame, rect, input.selection);
        }
        if traced.is_some() || self.traced_view.has_failed() {
            markers::paint_note(&painter, rect, &self.traced_view.status(), side.is_some());
        }
        // Draw labels, or, through a light, its beam
        if let CentralView::Light(id) = input.central_view {
            if let Some(light) = scene.light(id) {
                let distance_m = scene.aim_vector(&light.aim, light.position).length();
                light_view::paint(&painter, light, distance_m, &frame, rect);
                let text =
                    format!("Through {}: orbit swings it, the wheel moves it nearer or away.    Esc ends", light.name);
                markers::paint_banner(&painter, rect, &text);
            }
        } else {
            let all = input.central_view == CentralView::Studio;
            markers::paint_labels(&painter, scene, &frame, rect, input.selection, all, side.is_none());
        }
        // Draw the meter, the tool in use or the handles, and the box of a selection
        markers::paint_meter(&painter, scene, &frame, rect);
        if let Some(tool) = &self.tool {
            tool.paint(&painter, scene, &frame, rect);
        } else if !items_with_handles(scene, input).is_empty() {
            let pointer = ui.input(|i| i.pointer.latest_pos());
            self.handles.paint(&painter, pointer);
            self.joints.paint(&painter);
        }
        if let Some(marquee) = &self.marquee {
            marquee.paint(&painter);
        }
    }

    /// Draws legend and charts of the scopes, and the light under the pointer.
    fn scopes_ui(&mut self, ui: &mut Ui, response: &Response, document: &Document, frame: &CameraFrame) {
        let (view, ViewOptions { display, charts, .. }) = (response.rect, self.preview.view_options);
        if !self.preview.view_options.has_scopes() {
            return;
        }
        // Above the line that tells how far the traced view is
        scopes::legend_ui(ui, view.with_max_y(view.bottom() - 24.0), display);
        scopes::charts_ui(ui, view, charts, self.scopes.charts());
        let is_still = charts.spot && !self.is_dragging();
        if let Some(pointer) = response.hover_pos().filter(|_| is_still) {
            let point = (pointer - view.min) / view.size();
            if let Some(reading) = self.scopes.read_spot(ui.ctx(), document, frame, Vec2::new(point.x, point.y)) {
                spot_readout::spot_ui(ui, view, &reading, None);
            }
        }
    }

    /// Draws the note that the CPU draws the view, with the reason.
    fn cpu_notice_ui(&mut self, ui: &mut Ui, rect: Rect) {
        let Some(why) = self.preview.failure().map(str::to_owned) else { return };
        let place = Rect::from_min_size(rect.min + vec2(8.0, 38.0), vec2((rect.width() - 16.0).min(420.0), 24.0));
        ui.scope_builder(egui::UiBuilder::new().max_rect(place), |ui| {
            ui.horizontal(|ui| {
                let text = RichText::new("Drawn by the CPU, without shadows").small().color(theme::ACCENT);
                ui.label(text).on_hover_text(&why);
                let can_retry = self.preview.has_device();
                let tip = format!("{why}\n\nBuild the view on the GPU again");
                if can_retry && ui.small_button("Try again").on_hover_text(tip).clicked() {
                    self.preview.restart(ui.ctx());
                }
            });
        });
    }

    /// Frames the selection, or everything, in the studio view.
    pub fn frame_selection(&mut self, document: &Document, selection: &Selection) {
        // In an empty studio, the floor and the camera of a new one
        let new_studio = (Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 2.2, 3.5));
        let (low, high) = bounds(document, selection).unwrap_or(new_studio);
        self.view.frame_box(low, high);
    }

    /// Returns the camera moved to the studio view.
    pub fn camera_from_view(&self, scene: &Scene) -> Camera {
        moved_camera(scene, &self.view, false)
    }

    fn overlay_of(&self, input: ViewportInput<'_>) -> Overlay {
        let studio = input.central_view == CentralView::Studio;
        let pick = |item: &Item| match *item {
            Item::Object(id) => Some(Pick::Object(id)),
            Item::Light(id) => Some(Pick::Light(id)),
            Item::Camera if studio => Some(Pick::Camera),
            Item::Camera | Item::Room | Item::Meter => None,
        };
        // The camera view shows light gizmos only while a light is selected.
        let lights = match input.central_view {
            CentralView::Studio => true,
            CentralView::Camera => !input.selection.lights().is_empty(),
            CentralView::Light(_) | CentralView::Picture => false,
        };
        Overlay {
            // Views from a side have the grid with numbers instead.
            grid: studio && self.view.side.is_none(),
            light_gizmos: lights,
            camera_gizmo: studio.then_some(input.picture_aspect),
            selection: input.selection.items().iter().filter_map(pick).collect(),
            void_color: Vec3::splat(0.012),
            work_light: studio,
            ..Overlay::default()
        }
    }
}

/// Returns the corners of a rectangle in fractions of a view.
fn part_of(view: Rect, part: Rect) -> [Vec2; 2] {
    let inside = |at: Pos2| Vec2::new((at.x - view.left()) / view.width(), (at.y - view.top()) / view.height());
    [inside(part.min), inside(part.max)].map(|at| at.clamp(Vec2::ZERO, Vec2::ONE))
}

/// Returns the figure whose joints are handles: the selected one, if it is alone and not locked.
fn posed_figure<'a>(scene: &'a Scene, input: ViewportInput<'_>) -> Option<&'a Object> {
    let [Item::Object(id)] = items_with_handles(scene, input)[..] else { return None };
    let is_posed = |object: &&Object| input.handles == HandleMode::Pose && matches!(object.shape, Shape::Figure(_));
    scene.object(id).filter(is_posed)
}

/// Returns the selected items that have handles: those with a position that are not locked, without the camera in its
/// own view, and none in the view through a light.
fn items_with_handles(scene: &Scene, input: ViewportInput<'_>) -> Vec<Item> {
    let mut items = input.selection.movable(scene);
    match input.central_view {
        CentralView::Camera => items.retain(|item| *item != Item::Camera),
        CentralView::Light(_) => items.clear(),
        CentralView::Studio | CentralView::Picture => {}
    }
    if centre(&items, scene).is_none() {
        items.clear();
    }
    items
}
