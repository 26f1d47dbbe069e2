//! The middle of the window: the live preview with navigation, selection and handles.

use super::action::{Action, Item};
use super::command::{Centre, Command, Handle};
use super::document::Document;
use super::gizmo::{Handles, Pointer};
use super::overlay;
use super::preview_host::PreviewHost;
use super::studio_view::StudioView;
use super::theme;
use crate::preview::{Overlay, Pick};
use crate::scene::{Aim, Camera, CameraFrame, Scene, Shape};
use eframe::egui::{self, EventFilter, Key, PointerButton, Pos2, Rect, Response, Sense, Ui, vec2};
use glam::{Vec2, Vec3};

/// Speed of flying, metres a second; four times with Shift.
const FLY_M_S: f32 = 1.8;
/// Room around the picture's frame in the camera view.
const FRAME_MARGIN: f32 = 0.92;

/// What the viewport is told for one frame.
#[derive(Clone, Copy, Debug)]
pub struct ViewportInput<'a> {
    /// The open studio.
    pub document: &'a Document,
    /// What is selected.
    pub selection: Option<Item>,
    /// Studio or camera view.
    pub centre: Centre,
    /// The handles to show.
    pub handles: Handle,
    /// Width over height of the picture to be rendered.
    pub picture_aspect: f32,
}

/// The viewport's own state.
#[derive(Debug)]
pub struct Viewport {
    /// The free view.
    pub view: StudioView,
    /// Whether navigation in the camera view moves the camera.
    pub camera_follows: bool,
    /// The live preview.
    pub preview: PreviewHost,
    handles: Handles,
}

impl Viewport {
    /// A viewport with a preview to come.
    pub fn new(preview: PreviewHost) -> Self {
        Viewport { view: StudioView::default(), camera_follows: false, preview, handles: Handles::default() }
    }

    /// Draws it and takes mouse and keys in.
    pub fn ui(&mut self, ui: &mut Ui, input: ViewportInput<'_>, out: &mut Vec<Command>) {
        let size = ui.available_size().max(vec2(8.0, 8.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        super::widgets::named(ui, &response, "Viewport");
        self.navigate(ui, &response, input, out);
        let scene = input.document.scene();
        let (frame, picture) = self.frame(scene, input, rect);
        self.handle_drag(ui, &response, rect, &frame, input, out);
        self.click(ui, &response, rect, input, out);
        self.paint(ui, rect, frame, picture, input);
    }

    /// What the view frames, and where the picture's frame lies in it (camera view only).
    fn frame(&self, scene: &Scene, input: ViewportInput<'_>, rect: Rect) -> (CameraFrame, Option<Rect>) {
        let aspect = rect.width() / rect.height();
        if input.centre != Centre::Camera {
            return (self.view.frame(aspect), None);
        }
        let mut frame = scene.camera_frame(input.picture_aspect);
        let height = (rect.width() / input.picture_aspect).min(rect.height()) * FRAME_MARGIN;
        let picture = Rect::from_center_size(rect.center(), vec2(height * input.picture_aspect, height));
        frame.half_extent *= Vec2::new(rect.width() / picture.width(), rect.height() / picture.height());
        (frame, Some(picture))
    }

    fn navigate(&mut self, ui: &Ui, response: &Response, input: ViewportInput<'_>, out: &mut Vec<Command>) {
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.has_focus() {
            let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
            ui.memory_mut(|m| m.set_focus_lock_filter(response.id, filter));
        }
        let scene = input.document.scene();
        let in_camera = input.centre == Centre::Camera;
        let mut view = if in_camera { camera_as_view(scene) } else { self.view };
        let before = view;
        let kept_aim = self.steer(ui, response, &mut view);
        if view == before {
            return;
        }
        if in_camera && self.camera_follows {
            let action = Action::SetCamera(Box::new(moved_camera(scene, &view, kept_aim)));
            out.push(Command::Do(action));
            return;
        }
        if in_camera {
            out.push(Command::Show(Centre::Studio));
        }
        self.view = view;
    }

    /// Mouse and keys to a new view. True when the target stayed what it was (orbit, zoom).
    fn steer(&self, ui: &Ui, response: &Response, view: &mut StudioView) -> bool {
        let modifiers = ui.input(|i| i.modifiers);
        let travel = Vec2::new(response.drag_delta().x, response.drag_delta().y);
        let middle = response.dragged_by(PointerButton::Middle)
            || (response.dragged_by(PointerButton::Primary) && modifiers.alt && !self.handles.wants_pointer());
        let mut keeps_target = true;
        if middle && modifiers.shift {
            view.pan(travel, response.rect.height());
            keeps_target = false;
        } else if middle && modifiers.command {
            view.zoom(-travel.y * 0.05);
        } else if middle {
            view.orbit(travel);
        } else if response.dragged_by(PointerButton::Secondary) {
            view.look(travel);
            keeps_target = false;
        }
        if response.contains_pointer() {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            view.zoom(scroll * 0.02 + pinch.ln() * 8.0);
        }
        let flown = fly_step(ui, response);
        if flown != Vec3::ZERO {
            view.fly(flown);
            keeps_target = false;
        }
        keeps_target
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
        // From the camera's own view its handles would sit on the lens.
        let held = input.selection.filter(|item| input.centre != Centre::Camera || *item != Item::Camera);
        let (Some(item), Some(position)) = (held, ui.input(|i| i.pointer.latest_pos())) else {
            self.handles.reset();
            return;
        };
        let pointer = ui.input(|i| Pointer {
            position,
            is_over: response.contains_pointer() && !i.modifiers.alt,
            pressed: i.pointer.primary_pressed(),
            down: i.pointer.primary_down(),
            snap: i.modifiers.command,
        });
        let scene = input.document.scene();
        if let Some(action) = self.handles.update(scene, item, input.handles, frame, rect, pointer) {
            out.push(Command::Do(action));
        }
        if !item.exists_in(scene) {
            self.handles.reset();
        }
    }

    fn click(&self, ui: &Ui, response: &Response, rect: Rect, input: ViewportInput<'_>, out: &mut Vec<Command>) {
        let Some(position) = response.interact_pointer_pos().filter(|_| response.clicked()) else { return };
        if self.handles.wants_pointer() || ui.input(|i| i.modifiers.alt) {
            return;
        }
        let scale = ui.pixels_per_point();
        let pixel = (position - rect.min) * scale;
        let picked = self.preview.pick((pixel.x.max(0.0) as u32, pixel.y.max(0.0) as u32));
        let scene = input.document.scene();
        let (frame, _) = self.frame(scene, input, rect);
        if overlay::meter_at(scene, &frame, rect, position) {
            out.push(Command::Select(Some(Item::Meter)));
            return;
        }
        let item = match picked {
            Some(Pick::Light(id)) => Some(Item::Light(id)),
            Some(Pick::Camera) => Some(Item::Camera),
            Some(Pick::Object(id)) => {
                Some(overlay::light_at(scene, &frame, rect, position).unwrap_or(Item::Object(id)))
            }
            None => overlay::light_at(scene, &frame, rect, position),
        };
        out.push(Command::Select(item));
    }

    fn paint(&mut self, ui: &mut Ui, rect: Rect, frame: CameraFrame, picture: Option<Rect>, input: ViewportInput<'_>) {
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, theme::SURROUND);
        let pixels = rect.size() * ui.pixels_per_point();
        let size = ((pixels.x.round() as u32).max(1), (pixels.y.round() as u32).max(1));
        let overlay = overlay_of(input);
        match self.preview.show(ui.ctx(), input.document, frame, size, overlay) {
            Some(texture) => {
                let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
                painter.image(texture, rect, uv, egui::Color32::WHITE);
            }
            None => self.no_preview_ui(ui, rect),
        }
        if let Some(picture) = picture {
            overlay::paint_picture_frame(&painter, rect, picture);
        }
        let all = input.centre == Centre::Studio;
        overlay::paint_labels(&painter, input.document.scene(), &frame, rect, input.selection, all);
        overlay::paint_meter(&painter, input.document.scene(), &frame, rect);
        if input.selection.is_some_and(|item| item.exists_in(input.document.scene())) {
            self.handles.paint(&painter);
        }
    }

    fn no_preview_ui(&mut self, ui: &mut Ui, rect: Rect) {
        let middle = Rect::from_center_size(rect.center(), vec2(420.0f32.min(rect.width()), 100.0));
        ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
            ui.vertical_centered(|ui| match self.preview.failure().map(str::to_owned) {
                Some(message) => {
                    ui.label(egui::RichText::new(message).weak());
                    if ui.button("Try again").on_hover_text("Build the live view anew").clicked() {
                        self.preview.restart(ui.ctx());
                    }
                }
                None => drop(ui.label(egui::RichText::new("Preparing the live view\u{2026}").weak())),
            });
        });
    }

    /// Brings the selection, or everything that stands in the studio, into view.
    pub fn frame_selection(&mut self, document: &Document, selection: Option<Item>) {
        let (low, high) = bounds(document, selection).unwrap_or((Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0)));
        self.view.frame_box(low, high);
    }

    /// The camera at the studio view's eye, aimed the same way.
    pub fn camera_from_view(&self, scene: &Scene) -> Camera {
        moved_camera(scene, &self.view, false)
    }
}

fn overlay_of(input: ViewportInput<'_>) -> Overlay {
    let studio = input.centre == Centre::Studio;
    let pick = match input.selection {
        Some(Item::Object(id)) => Some(Pick::Object(id)),
        Some(Item::Light(id)) => Some(Pick::Light(id)),
        Some(Item::Camera) if studio => Some(Pick::Camera),
        _ => None,
    };
    Overlay {
        grid: studio,
        // In the camera view the picture counts: only a light that is being worked on shows itself.
        light_gizmos: studio || matches!(input.selection, Some(Item::Light(_))),
        camera_gizmo: studio.then_some(input.picture_aspect),
        selection: pick.into_iter().collect(),
        void_color: Vec3::splat(0.012),
        ..Overlay::default()
    }
}

/// Metres to fly this frame (right, up, ahead), while keys are held and nothing else listens to them.
fn fly_step(ui: &Ui, response: &Response) -> Vec3 {
    let focused = ui.memory(|m| m.focused());
    let listens = response.has_focus() || (focused.is_none() && response.contains_pointer());
    if !listens {
        return Vec3::ZERO;
    }
    let (step, dt, fast) = ui.input(|i| {
        let plain = !i.modifiers.command && !i.modifiers.alt;
        let held = |a: Key, b: Key| f32::from(u8::from(plain && (i.key_down(a) || i.key_down(b))));
        let right = held(Key::D, Key::ArrowRight) - held(Key::A, Key::ArrowLeft);
        let ahead = held(Key::W, Key::ArrowUp) - held(Key::S, Key::ArrowDown);
        let up = held(Key::E, Key::PageUp) - held(Key::Q, Key::PageDown);
        (Vec3::new(right, up, ahead), i.stable_dt.min(0.1), i.modifiers.shift)
    });
    if step != Vec3::ZERO {
        ui.ctx().request_repaint();
    }
    step * FLY_M_S * dt * if fast { 4.0 } else { 1.0 }
}

/// The camera's place as a view that can be steered.
fn camera_as_view(scene: &Scene) -> StudioView {
    let camera = &scene.camera;
    StudioView::looking(camera.position, scene.aim_point(&camera.aim, camera.position))
}

/// The camera where a view looks from. Its aim stays what it is when the target did.
fn moved_camera(scene: &Scene, view: &StudioView, kept_aim: bool) -> Camera {
    let mut camera = scene.camera.clone();
    camera.position = view.eye();
    if !kept_aim || matches!(camera.aim, Aim::Angles { .. }) {
        camera.aim = Aim::Point(view.target);
    }
    camera
}

/// The box around the selection, or around all figures, props and lights.
fn bounds(document: &Document, selection: Option<Item>) -> Option<(Vec3, Vec3)> {
    let scene = document.scene();
    let point = |p: Vec3| (p - Vec3::splat(0.4), p + Vec3::splat(0.4));
    let of_object = |object: &crate::scene::Object| {
        let (low, high) = document.assets().mesh_of(&object.shape)?.bounds();
        let world = object.transform.world_from_object();
        let corners =
            (0..8).map(|i| Vec3::new([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2]));
        join(corners.map(|corner| world.transform_point3(corner)).map(|p| (p, p)))
    };
    match selection {
        Some(Item::Object(id)) => scene.object(id).and_then(of_object),
        Some(Item::Light(id)) => scene.light(id).map(|light| point(light.position)),
        Some(Item::Camera) => Some(point(scene.camera.position)),
        Some(Item::Meter) => scene.meter.map(|meter| point(meter.position)),
        Some(Item::Room) | None => {
            let things = scene.objects.iter().filter(|o| !matches!(o.shape, Shape::Sweep { .. } | Shape::Plane { .. }));
            let lights = scene.lights.iter().filter(|l| !l.emitter.is_infinite()).map(|l| point(l.position));
            join(things.filter_map(of_object).chain(lights))
        }
    }
}

fn join(boxes: impl Iterator<Item = (Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}
