//! The mouse in the view while a light is placed by its highlight, its light or its shadow.

use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::theme;
use crate::editor::viewport::overlays::markers::{paint_banner, paint_text, place_of};
use crate::editor::viewport::tools::place_light::{LightPlacement, PlaceLightError, placed_light};
use crate::editor::viewport::tools::surface_pick::{self, SurfaceHit};
use crate::scene::{CameraFrame, Light, ObjectId, Scene};
use eframe::egui::{Align2, Color32, CursorIcon, Painter, Rect, Response, Stroke, Ui, vec2};
use glam::Vec2;

/// A light that is placed, and where the mouse is with it.
#[derive(Clone, Debug)]
pub struct PlaceLightDrag {
    placing: LightPlacement,
    /// The light when the button went down, and the thing that was under the pointer then: a drag stays on it.
    held: Option<(Light, ObjectId)>,
    /// The drag was given up; what is left of the press does nothing.
    spent: bool,
    /// The surface under the pointer, and whether the light can be put so.
    at: Option<(SurfaceHit, Option<PlaceLightError>)>,
}

impl PlaceLightDrag {
    /// Begins.
    pub fn new(placing: LightPlacement) -> Self {
        PlaceLightDrag { placing, held: None, spent: false, at: None }
    }

    /// What is placed.
    pub fn placing(&self) -> LightPlacement {
        self.placing
    }

    /// Whether a drag is under way.
    pub fn is_dragging(&self) -> bool {
        self.held.is_some() || self.spent
    }

    /// Ends a drag; the button may still be held.
    pub fn give_up(&mut self) {
        self.spent = self.is_dragging();
        self.held = None;
    }

    /// Takes the mouse in. False when the light has gone.
    pub fn drag(
        &mut self,
        ui: &Ui,
        response: &Response,
        document: &Document,
        frame: &CameraFrame,
        out: &mut Vec<Command>,
    ) -> bool {
        let scene = document.scene();
        let Some(light) = scene.light(self.placing.light) else { return false };
        let (position, pressed, down, alt) = ui.input(|i| {
            let pointer = &i.pointer;
            (pointer.latest_pos(), pointer.primary_pressed(), pointer.primary_down(), i.modifiers.alt)
        });
        if !down {
            (self.held, self.spent) = (None, false);
        }
        let Some(position) = position.filter(|_| response.contains_pointer() || self.held.is_some()) else {
            self.at = None;
            return true;
        };
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        let point = (position - response.rect.min) / response.rect.size();
        let (eye, direction) = (frame.position(), frame.direction(Vec2::new(point.x, point.y)));
        let only = self.held.as_ref().map(|(_, object)| *object);
        let Some(hit) = surface_pick::hit(scene, document.assets(), eye, direction, only) else {
            // Off the edge of the thing the light stays where the drag left it.
            self.at = self.at.filter(|_| self.held.is_some());
            return true;
        };
        if pressed && !alt && response.contains_pointer() {
            self.held = Some((light.clone(), hit.object));
        }
        // The distance is that of the press: what the floor made nearer comes back with the rest of the drag.
        let start = self.held.as_ref().map_or(light, |(start, _)| start);
        let result = placed_light(scene, start, &hit, self.placing.by);
        self.at = Some((hit, result.as_ref().err().copied()));
        if let (true, Ok(swung)) = (self.held.is_some(), result) {
            let changed = Light { position: swung.position, aim: swung.aim, ..light.clone() };
            out.push(Command::Apply(Action::SetLight(Box::new(changed))));
        }
        true
    }

    /// Draws the point, the way to light and camera, and what to do.
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
