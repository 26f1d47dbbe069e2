//! The parts of the transform handles: arrows, squares, rings and knobs, their places on the screen and their looks.

use crate::editor::commands::choices::HandleMode;
use crate::editor::document::item::Item;
use crate::editor::ui::theme;
use crate::editor::viewport::tools::handle_view::HandleView;
use crate::scene::{Aim, Scene};
use eframe::egui::{self, Color32, Pos2, Shape, Stroke, vec2};
use glam::{Quat, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Radius of the rings of the axes, and length of the arrows, points.
pub const SIZE: f32 = 70.0;
/// Radius of the outermost ring, points.
const OUTER: f32 = 84.0;
/// Distance of the knob on the aim line, points.
const AIM_KNOB: f32 = 104.0;
/// Radius of the ring in the middle, points.
const MIDDLE: f32 = 12.0;
/// Start of the arrows, and near and far edge of the squares between them, as fractions of their length.
const ARROW_FROM: f32 = 0.27;
const SQUARE: [f32; 2] = [0.4, 0.62];
/// Largest distance of the pointer from the handle that it takes, points.
const REACH: f32 = 9.0;
/// Filled parts take the pointer only if no line is this much nearer, points.
const FILL_YIELDS: f32 = 4.0;
/// Shortest arrow on the screen, points: one that points at the eye can't be dragged.
const MIN_ARROW: f32 = 15.0;
/// Smallest cosine of the angle between a square's normal and the line of sight.
const MIN_SQUARE_COS: f32 = 0.15;
/// Cosine above which a ring is seen whole and not as the half in front.
const WHOLE_RING_COS: f32 = 0.97;
/// Smallest sine of the view's pitch at which objects are moved over the floor.
const MIN_PITCH_SIN: f32 = 0.1;
const AXIS_COLORS: [Color32; 3] =
    [Color32::from_rgb(235, 84, 84), Color32::from_rgb(120, 200, 84), Color32::from_rgb(84, 140, 245)];
const NEUTRAL: Color32 = Color32::from_gray(205);

/// What a part of the handles changes. Numbers are indices of axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandlePart {
    /// Moves along an axis.
    MoveAlong(usize),
    /// Moves in the plane across an axis.
    MoveAcross(usize),
    /// Moves in the plane of the screen.
    MoveOnScreen,
    /// Moves horizontally.
    MoveOnFloor,
    /// Moves nearer to the aim or away from it, at the same angle.
    MoveAlongAim,
    /// Rotates about an axis.
    TurnAbout(usize),
    /// Rotates about the line of sight.
    TurnOnScreen,
    /// Scales along an axis.
    SizeAlong(usize),
    /// Scales all axes by one factor.
    SizeEvenly,
}

/// The line from an item to its aim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimLine {
    /// Unit direction to the aim.
    pub direction: Vec3,
    /// Distance of the aim, metres; none if it is a direction only.
    pub distance_m: Option<f32>,
}

/// Position and directions of the handles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandleAxes {
    /// Position, world space.
    pub place: Vec3,
    /// Unit axes, world space.
    pub axes: [Vec3; 3],
    /// The aim line of a light or camera that is selected alone.
    pub aim: Option<AimLine>,
}

impl HandleAxes {
    /// Returns the axes of handles at `place`: those of the room, or of the item when it is scaled.
    pub fn new(scene: &Scene, items: &[Item], handle: HandleMode, place: Vec3) -> Self {
        let rotation = match (handle, items) {
            (HandleMode::Scale, [Item::Object(id)]) => scene.object(*id).map(|object| object.transform.rotation()),
            (HandleMode::Scale, [Item::Light(id)]) => {
                scene.light(*id).map(|light| Quat::from_mat3a(&scene.light_frame(light).matrix3))
            }
            _ => None,
        };
        let rotation = rotation.unwrap_or(Quat::IDENTITY);
        let aim = match items {
            [Item::Light(id)] => scene.light(*id).map(|light| &light.aim),
            [Item::Camera] => Some(&scene.camera.aim),
            _ => None,
        };
        let line = |aim: &Aim| {
            let to_aim = scene.aim_vector(aim, place);
            let distance_m = (!matches!(aim, Aim::Angles { .. })).then(|| to_aim.length());
            to_aim.try_normalize().map(|direction| AimLine { direction, distance_m })
        };
        HandleAxes { place, axes: [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| rotation * axis), aim: aim.and_then(line) }
    }

    /// Returns the other two axes.
    pub fn across(&self, axis: usize) -> [Vec3; 2] {
        [self.axes[(axis + 1) % 3], self.axes[(axis + 2) % 3]]
    }
}

/// Returns the parts of the handles of a selection.
pub fn parts(items: &[Item], handle: HandleMode, axes: &HandleAxes, view: HandleView<'_>) -> Vec<HandlePart> {
    let all = |part: fn(usize) -> HandlePart| (0..3).map(part);
    let mut parts = Vec::new();
    match handle {
        HandleMode::Move | HandleMode::Pose => {
            let is_on_floor = items.iter().any(|item| matches!(item, Item::Object(_)));
            let sees_floor = view.frame.forward().y.abs() > MIN_PITCH_SIN;
            parts.push(if is_on_floor && sees_floor { HandlePart::MoveOnFloor } else { HandlePart::MoveOnScreen });
            parts.extend(axes.aim.map(|_| HandlePart::MoveAlongAim));
            parts.extend(all(HandlePart::MoveAlong).chain(all(HandlePart::MoveAcross)));
        }
        HandleMode::Rotate => parts.extend(all(HandlePart::TurnAbout).chain([HandlePart::TurnOnScreen])),
        HandleMode::Scale => {
            // A light has a width and a height.
            let count = if let [Item::Light(_)] = items { 2 } else { 3 };
            parts.extend((0..count).map(HandlePart::SizeAlong).chain([HandlePart::SizeEvenly]));
        }
    }
    parts
}

/// The end of a handle's line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineEnd {
    Plain,
    Arrow,
    Square,
    Knob,
}

/// A part of the handles on the screen.
#[derive(Clone, Debug)]
pub struct HandleShape {
    /// What it changes.
    pub part: HandlePart,
    line: Vec<Pos2>,
    end: LineEnd,
    is_filled: bool,
    color: Color32,
}

impl HandleShape {
    /// Returns the shape of a part; none if it can't be dragged from this side.
    pub fn new(part: HandlePart, axes: &HandleAxes, view: HandleView<'_>) -> Option<Self> {
        let unit = view.metres_a_point(axes.place);
        let middle = view.place(axes.place)?;
        let at = |direction: Vec3, points: f32| view.place(axes.place + direction * (points * unit));
        let shape = |line, end, is_filled, color| Some(HandleShape { part, line, end, is_filled, color });
        let arrow = |direction: Vec3, length: f32, end, color| {
            let tip = at(direction, length)?;
            let is_long = tip.distance(middle) > MIN_ARROW;
            let line = vec![at(direction, ARROW_FROM * SIZE)?, tip];
            if is_long { shape(line, end, false, color) } else { None }
        };
        match part {
            HandlePart::MoveAlong(i) => arrow(axes.axes[i], SIZE, LineEnd::Arrow, AXIS_COLORS[i]),
            HandlePart::SizeAlong(i) => arrow(axes.axes[i], SIZE, LineEnd::Square, AXIS_COLORS[i]),
            HandlePart::MoveAlongAim => arrow(axes.aim?.direction, AIM_KNOB, LineEnd::Knob, theme::ACCENT),
            HandlePart::MoveAcross(i) => {
                let [u, v] = axes.across(i);
                let [near, far] = SQUARE.map(|part| part * SIZE * unit);
                let corners = [(near, near), (far, near), (far, far), (near, far), (near, near)];
                let line = corners.into_iter().map(|(a, b)| view.place(axes.place + u * a + v * b)).collect();
                let is_edge_on = axes.axes[i].dot(view.towards_eye(axes.place)).abs() < MIN_SQUARE_COS;
                if is_edge_on { None } else { shape(line_of(line)?, LineEnd::Plain, true, AXIS_COLORS[i]) }
            }
            HandlePart::TurnAbout(i) => {
                let ring = ring(axes, i, view).map(|direction| at(direction, SIZE)).collect();
                shape(line_of(ring)?, LineEnd::Plain, false, AXIS_COLORS[i])
            }
            HandlePart::MoveOnScreen | HandlePart::MoveOnFloor => {
                shape(circle(middle, MIDDLE), LineEnd::Plain, true, NEUTRAL)
            }
            HandlePart::TurnOnScreen | HandlePart::SizeEvenly => {
                shape(circle(middle, OUTER), LineEnd::Plain, false, NEUTRAL)
            }
        }
    }

    /// Returns the points of its line.
    #[cfg(test)]
    pub fn outline(&self) -> &[Pos2] {
        &self.line
    }

    /// Returns the distance of the pointer, points, if the part may take it.
    fn distance(&self, pointer: Pos2) -> Option<f32> {
        let to_line = self.line.windows(2).map(|ends| distance_to_segment(pointer, ends[0], ends[1]));
        let to_line = to_line.fold(f32::INFINITY, f32::min);
        let distance =
            if self.is_filled && is_inside(&self.line, pointer) { to_line.min(FILL_YIELDS) } else { to_line };
        (distance < REACH).then_some(distance)
    }

    /// Draws the part; `is_active` if the pointer is on it or drags it.
    pub fn paint(&self, painter: &egui::Painter, is_active: bool) {
        let color = if is_active { self.color.lerp_to_gamma(Color32::WHITE, 0.6) } else { self.color };
        let width = if is_active { 4.0 } else { 2.5 };
        // The dark line under it is seen before a white backdrop.
        for stroke in [Stroke::new(width + 2.0, Color32::from_black_alpha(90)), Stroke::new(width, color)] {
            painter.add(Shape::line(self.line.clone(), stroke));
        }
        let [.., before, tip] = self.line[..] else { return };
        let ahead = (tip - before).normalized();
        match self.end {
            LineEnd::Plain if self.is_filled && matches!(self.part, HandlePart::MoveAcross(_)) => {
                painter.add(Shape::convex_polygon(self.line.clone(), color.gamma_multiply(0.45), Stroke::NONE));
            }
            LineEnd::Plain => {}
            LineEnd::Arrow => {
                let across = vec2(-ahead.y, ahead.x) * (width + 3.0);
                let corners = vec![tip + ahead * 12.0, tip + across, tip - across];
                painter.add(Shape::convex_polygon(corners, color, Stroke::new(1.0, Color32::from_black_alpha(120))));
            }
            LineEnd::Square => {
                let rect = egui::Rect::from_center_size(tip, egui::Vec2::splat(2.0 * width + 5.0));
                painter.rect(
                    rect,
                    1.0,
                    color,
                    Stroke::new(1.0, Color32::from_black_alpha(120)),
                    egui::StrokeKind::Outside,
                );
            }
            LineEnd::Knob => {
                painter.circle(tip, width + 4.0, color, Stroke::new(1.0, Color32::from_black_alpha(160)));
            }
        }
    }
}

/// Returns the part under the pointer: the nearest one.
pub fn part_at(shapes: &[HandleShape], pointer: Pos2) -> Option<HandlePart> {
    let near = shapes.iter().filter_map(|shape| Some((shape.distance(pointer)?, shape.part)));
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, part)| part)
}

/// Returns the directions from the middle to the points of a ring about an axis: all of it if it faces the eye, else
/// the half in front.
fn ring(axes: &HandleAxes, axis: usize, view: HandleView<'_>) -> impl Iterator<Item = Vec3> {
    let ([u, v], to_eye) = (axes.across(axis), view.towards_eye(axes.place));
    let is_whole = axes.axes[axis].dot(to_eye).abs() > WHOLE_RING_COS;
    let front = v.dot(to_eye).atan2(u.dot(to_eye));
    let (from, turn) = if is_whole { (0.0, TAU) } else { (front - FRAC_PI_2, PI) };
    (0..=48).map(move |i| {
        let (sin, cos) = (from + turn * i as f32 / 48.0).sin_cos();
        u * cos + v * sin
    })
}

/// Returns the points, if all are on the screen.
fn line_of(points: Vec<Option<Pos2>>) -> Option<Vec<Pos2>> {
    points.into_iter().collect()
}

fn circle(middle: Pos2, radius: f32) -> Vec<Pos2> {
    let point = |i: u16| middle + radius * egui::Vec2::angled(TAU * f32::from(i) / 64.0);
    (0..=64).map(point).collect()
}

fn distance_to_segment(point: Pos2, from: Pos2, to: Pos2) -> f32 {
    let along = to - from;
    let t = ((point - from).dot(along) / along.length_sq().max(1e-6)).clamp(0.0, 1.0);
    point.distance(from + along * t)
}

/// Returns true if the point is inside of a closed, convex line.
fn is_inside(line: &[Pos2], point: Pos2) -> bool {
    let turns = line.windows(2).map(|ends| {
        let (edge, to) = (ends[1] - ends[0], point - ends[0]);
        edge.x * to.y - edge.y * to.x
    });
    let (low, high) = turns.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
    low >= 0.0 || high <= 0.0
}
