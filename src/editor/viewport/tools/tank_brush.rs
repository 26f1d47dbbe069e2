//! The brush that paints cells of a water tank in the view.

use crate::editor::commands::choices::Brush;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::studio_document::Document;
use crate::editor::viewport::overlays::markers::{paint_banner, place_of};
use crate::editor::viewport::tools::surface_pick::{self, SurfaceHit};
use crate::editor::viewport::tools::tool_pointer::ToolPointer;
use crate::scene::{Assets, BrushStroke, CameraFrame, Object, Scene, Shape, Tank};
use eframe::egui::{Color32, Painter, Rect, Shape as PaintedShape, Stroke};
use glam::Vec3;
use std::f32::consts::TAU;

/// Distance between two points of a stroke, as a part of its radius.
const SPACING: f32 = 0.4;
/// Corners of the circle that shows the size of the brush.
const CORNERS: usize = 48;

/// The brush at work.
#[derive(Clone, Debug)]
pub struct TankBrush {
    brush: Brush,
    held: Option<Box<HeldStroke>>,
    /// True after a stroke was cancelled, until the button is released.
    cancelled: bool,
    /// The surface under the pointer.
    at: Option<SurfaceHit>,
    /// The tank takes no further stroke.
    is_full: bool,
}

/// The stroke under way.
#[derive(Clone, Debug)]
struct HeldStroke {
    /// The tank at the press. The pointer moves over its surface, whatever the stroke adds.
    before: Object,
    assets: Assets,
    path_m: Vec<Vec3>,
}

impl TankBrush {
    /// Starts without a stroke.
    pub fn new(brush: Brush) -> Self {
        TankBrush { brush, held: None, cancelled: false, at: None, is_full: false }
    }

    /// Returns what it paints, and where.
    pub fn brush(&self) -> Brush {
        self.brush
    }

    /// Returns true during a stroke.
    pub fn is_dragging(&self) -> bool {
        self.held.is_some() || self.cancelled
    }

    /// Cancels the stroke; the button may still be down.
    pub fn cancel(&mut self) {
        self.cancelled = self.is_dragging();
        self.held = None;
    }

    /// Handles the mouse. Returns false if the tank no longer exists.
    pub fn drag(&mut self, pointer: &ToolPointer, document: &Document, out: &mut Vec<Command>) -> bool {
        let Some(object) = document.scene().object(self.brush.tank) else { return false };
        let Shape::Tank(tank) = &object.shape else { return false };
        if !pointer.is_down {
            (self.held, self.cancelled) = (None, false);
        }
        self.is_full = self.held.is_none() && !tank.has_room_for_strokes();
        let Some((eye, direction)) = pointer.ray(self.held.is_some()) else {
            self.at = None;
            return true;
        };
        let (surface, assets) =
            self.held.as_ref().map_or((object, document.assets()), |held| (&held.before, &held.assets));
        self.at = surface_pick::hit_object(surface, assets, eye, direction);
        let Some(hit) = self.at else { return true };
        if pointer.is_pressed && !self.is_full {
            let (before, assets) = (object.clone(), document.assets().clone());
            self.held = Some(Box::new(HeldStroke { before, assets, path_m: Vec::new() }));
            out.push(Command::PlayTank(None));
        }
        if let Some(painted) = self.held.as_mut().and_then(|held| held.painted_to(self.brush, hit.point)) {
            out.push(Command::Apply(Action::SetObject(Box::new(painted))));
        }
        true
    }

    /// Draws the brush on the surface, and the line of help.
    pub fn paint(&self, painter: &Painter, scene: &Scene, frame: &CameraFrame, rect: Rect) {
        let Some(object) = scene.object(self.brush.tank) else { return };
        let help = if self.is_full {
            format!("{} has as many strokes as it can have: undo or clear some.    Esc ends", object.name)
        } else {
            format!("Brush: drag over {} to paint it, at the start of its time.    Esc ends", object.name)
        };
        paint_banner(painter, rect, &help);
        let Some(hit) = &self.at else { return };
        let (across, along) = hit.normal.any_orthonormal_pair();
        let corner = |index: usize| {
            let (sin, cos) = (index as f32 * TAU / CORNERS as f32).sin_cos();
            place_of(frame, rect, hit.point + self.brush.radius_m * (cos * across + sin * along))
        };
        let corners: Vec<_> = (0..CORNERS).filter_map(corner).collect();
        let color = if self.is_full { Color32::from_rgb(240, 110, 100) } else { Color32::WHITE };
        painter.add(PaintedShape::closed_line(corners, Stroke::new(1.5, color)));
    }
}

impl HeldStroke {
    /// Adds a point of the world to the stroke. Returns the tank with it; none if the point is next to the last one, or
    /// too many are there.
    fn painted_to(&mut self, brush: Brush, point: Vec3) -> Option<Object> {
        let Shape::Tank(before) = &self.before.shape else { return None };
        let world_from_object = self.before.transform.world_from_object();
        let at_m = world_from_object.inverse().transform_point3(point);
        let is_near = |last: &Vec3| last.distance(at_m) < SPACING * brush.radius_m;
        let is_full = before.stroke_points() + self.path_m.len() >= Tank::MAX_STROKE_POINTS;
        if !at_m.is_finite() || self.path_m.last().is_some_and(is_near) || is_full {
            return None;
        }
        self.path_m.push(at_m);
        let mut tank = Tank { time_s: 0.0, ..(**before).clone() };
        let radius_m = brush.radius_m.min(BrushStroke::MAX_RADIUS_CELLS * tank.cell_m);
        tank.strokes.push(BrushStroke { content: brush.content, radius_m, path_m: self.path_m.clone() });
        Some(Object { shape: Shape::Tank(Box::new(tank)), ..self.before.clone() })
    }
}
