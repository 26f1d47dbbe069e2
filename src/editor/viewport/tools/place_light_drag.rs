//! The drag that places a light by its highlight, its light or its shadow.

use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::theme;
use crate::editor::viewport::overlays::markers::{paint_banner, paint_text, place_of};
use crate::editor::viewport::tools::place_light::{LightPlacement, PlaceLightError, placed_light};
use crate::editor::viewport::tools::surface_pick::{self, SurfaceHit};
use crate::editor::viewport::tools::tool_pointer::ToolPointer;
use crate::scene::{CameraFrame, Light, ObjectId, Scene};
use eframe::egui::{Align2, Color32, Painter, Rect, Stroke, vec2};

/// The state of placing a light.
#[derive(Clone, Debug)]
pub struct PlaceLightDrag {
    placing: LightPlacement,
    /// The light and the object under the pointer at the press; the drag stays on this object.
    held: Option<(Light, ObjectId)>,
    /// True after the drag was cancelled, until the button is released.
    cancelled: bool,
    /// The surface under the pointer, and the reason why the light cannot be placed there.
    at: Option<(SurfaceHit, Option<PlaceLightError>)>,
}

impl PlaceLightDrag {
    /// Starts without a drag.
    pub fn new(placing: LightPlacement) -> Self {
        PlaceLightDrag { placing, held: None, cancelled: false, at: None }
    }

    /// Returns the light and the feature.
    pub fn placing(&self) -> LightPlacement {
        self.placing
    }

    /// Returns true during a drag.
    pub fn is_dragging(&self) -> bool {
        self.held.is_some() || self.cancelled
    }

    /// Cancels the drag; the button may still be down.
    pub fn cancel(&mut self) {
        self.cancelled = self.is_dragging();
        self.held = None;
    }

    /// Handles the mouse. Returns false if the light no longer exists.
    pub fn drag(&mut self, pointer: &ToolPointer, document: &Document, out: &mut Vec<Command>) -> bool {
        let scene = document.scene();
        let Some(light) = scene.light(self.placing.light) else { return false };
        if !pointer.is_down {
            (self.held, self.cancelled) = (None, false);
        }
        let Some((eye, direction)) = pointer.ray(self.held.is_some()) else {
            self.at = None;
            return true;
        };
        let only = self.held.as_ref().map(|(_, object)| *object);
        let Some(hit) = surface_pick::hit(scene, document.assets(), eye, direction, only) else {
            // Beyond the object's edge the light keeps its position.
            self.at = self.at.filter(|_| self.held.is_some());
            return true;
        };
        if pointer.is_pressed {
            self.held = Some((light.clone(), hit.object));
        }
        // The distance is that of the press, so that a distance shortened by the floor is restored later in the drag.
        let start = self.held.as_ref().map_or(light, |(start, _)| start);
        let result = placed_light(scene, start, &hit, self.placing.by);
        self.at = Some((hit, result.as_ref().err().copied()));
        if let (true, Ok(placed)) = (self.held.is_some(), result) {
            let changed = Light { position: placed.position, aim: placed.aim, ..light.clone() };
            out.push(Command::Apply(Action::SetLight(Box::new(changed))));
        }
        true
    }

    /// Draws the surface point, lines to light and camera, and the line of help.
    pub fn paint(&self, painter: &Painter, scene: &Scene, frame: &CameraFrame, rect: Rect) {
        let Some(light) = scene.light(self.placing.light) else { return };
        paint_banner(painter, rect, &self.placing.by.hint(&light.name));
        let Some((at, error)) = &self.at else { return };
        let Some(place) = place_of(frame, rect, at.point) else { return };
        if let Some(error) = error {
            let red = Color32::from_rgb(240, 110, 100);
            painter.circle_stroke(place, 7.0, Stroke::new(2.0, red));
            paint_text(painter, place + vec2(12.0, -12.0), Align2::LEFT_BOTTOM, &error.to_string(), red);
            return;
        }
        let color = theme::role_color(light.role);
        painter.circle_stroke(place, 7.0, Stroke::new(2.0, color));
        painter.circle_filled(place, 2.0, color);
        let line = |to, width: f32, color: Color32| {
            if let Some(end) = place_of(frame, rect, to) {
                painter.line_segment([place, end], Stroke::new(width, color));
            }
        };
        line(at.point + 0.12 * at.normal, 2.0, Color32::WHITE);
        if self.held.is_some() {
            line(light.position, 1.0, color);
            if self.placing.by == PlaceLightBy::Shadow
                && let Some(aim) = place_of(frame, rect, scene.aim_point(&light.aim, light.position))
            {
                painter.circle_stroke(aim, 4.0, Stroke::new(1.5, color));
            }
            if self.placing.by == PlaceLightBy::Highlight {
                line(scene.camera.position, 1.0, Color32::from_gray(190));
            }
        }
    }
}
