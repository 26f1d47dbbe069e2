//! A drag of a transform handle: from the path of the pointer to the transform of the selection.

use crate::editor::document::action::Action;
use crate::editor::ui::lengths;
use crate::editor::viewport::tools::handle_part::{HandleAxes, HandlePart, SIZE};
use crate::editor::viewport::tools::handle_pointer::{HandlePointer, STEP_DEG, STEP_M};
use crate::editor::viewport::tools::handle_view::HandleView;
use crate::editor::viewport::tools::transform_selection::{DragSelection, DragTransform};
use crate::editor::viewport::tools::typed_number::TypedNumber;
use crate::sheet::Units;
use eframe::egui::Pos2;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Snapping step of factors.
const STEP_SCALE: f32 = 0.1;
/// Smallest factor of one drag.
const MIN_SCALE: f32 = 0.01;
/// Largest move of one drag, metres: near the horizon a pixel is a long distance.
const MAX_DRAG_M: f32 = 60.0;
/// Smallest distance from an aim, metres.
const MIN_AIM_M: f32 = 0.1;
/// Cosine of the angle between ring and line of sight under which a ring is turned along its line on the screen, not
/// round its middle.
const FLAT_RING_COS: f32 = 0.3;

/// Where the pointer took a handle.
#[derive(Clone, Copy, Debug)]
enum Grip {
    /// Distance along a line, metres.
    Along(f32),
    /// Point of a plane, world space.
    Point(Vec3),
    /// Angle in the plane of a ring now, and turn since the start, radians.
    Angle { last_rad: f32, turned_rad: f32 },
    /// Position on the screen.
    Screen(Pos2),
}

/// A drag of a handle.
#[derive(Clone, Debug)]
pub struct HandleDrag {
    part: HandlePart,
    /// The handles at the start of the drag.
    start: HandleAxes,
    /// Unit axis of a turn, world space.
    axis: Vec3,
    grip: Grip,
    held: DragSelection,
    change: DragTransform,
    /// The number typed so far.
    pub typed: TypedNumber,
    pressed_at: Pos2,
    has_changed: bool,
}

impl HandleDrag {
    /// Starts a drag where the pointer is; none where the part has no point under it.
    pub fn new(
        part: HandlePart,
        start: HandleAxes,
        held: DragSelection,
        view: HandleView<'_>,
        pointer: Pos2,
    ) -> Option<Self> {
        let axis = match part {
            HandlePart::TurnAbout(i) => start.axes[i],
            _ => view.towards_eye(start.place),
        };
        let change = match part {
            HandlePart::TurnAbout(_) | HandlePart::TurnOnScreen => DragTransform::Rotate(axis, 0.0),
            HandlePart::SizeAlong(_) | HandlePart::SizeEvenly => DragTransform::Scale(Vec3::ONE),
            _ => DragTransform::Move(Vec3::ZERO),
        };
        let grip = Grip::Screen(pointer);
        let typed = TypedNumber::default();
        let mut drag =
            HandleDrag { part, start, axis, grip, held, change, typed, pressed_at: pointer, has_changed: false };
        drag.grip = drag.grip_at(view, pointer)?;
        Some(drag)
    }

    /// Returns the dragged part.
    pub fn part(&self) -> HandlePart {
        self.part
    }

    fn grip_at(&self, view: HandleView<'_>, pointer: Pos2) -> Option<Grip> {
        let place = self.start.place;
        let along = |direction: Vec3| view.along_line(place, direction, pointer).map(Grip::Along);
        let point = |normal: Vec3| view.on_plane(place, normal, pointer).map(Grip::Point);
        match self.part {
            HandlePart::MoveAlong(i) | HandlePart::SizeAlong(i) => along(self.start.axes[i]),
            HandlePart::MoveAlongAim => along(self.start.aim?.direction),
            HandlePart::MoveAcross(i) => point(self.start.axes[i]),
            HandlePart::MoveOnFloor => point(Vec3::Y),
            HandlePart::MoveOnScreen => point(view.frame.forward()),
            HandlePart::TurnAbout(_) | HandlePart::TurnOnScreen => {
                let is_flat = self.axis.dot(view.towards_eye(place)).abs() < FLAT_RING_COS;
                let angle = || self.angle_rad(view, pointer).map(|a| Grip::Angle { last_rad: a, turned_rad: 0.0 });
                if is_flat { Some(Grip::Screen(pointer)) } else { angle() }
            }
            HandlePart::SizeEvenly => Some(Grip::Screen(pointer)),
        }
    }

    /// Returns the angle of the pointer in the plane of the turn, radians, counter-clockwise about the axis.
    fn angle_rad(&self, view: HandleView<'_>, pointer: Pos2) -> Option<f32> {
        let from_middle = view.on_plane(self.start.place, self.axis, pointer)? - self.start.place;
        let u = self.axis.any_orthonormal_vector();
        Some(from_middle.dot(self.axis.cross(u)).atan2(from_middle.dot(u)))
    }

    /// Follows the pointer. Where it gives no transform, beyond the horizon for example, the last one stays.
    pub fn follow(&mut self, view: HandleView<'_>, pointer: HandlePointer) {
        // A press alone does not snap.
        if !self.has_changed && pointer.position == self.pressed_at {
            return;
        }
        let change = match self.part {
            HandlePart::TurnAbout(_) | HandlePart::TurnOnScreen => self.turn(view, pointer),
            HandlePart::SizeAlong(_) | HandlePart::SizeEvenly => self.scale(view, pointer).map(DragTransform::Scale),
            _ => self.movement(view, pointer).filter(|by| by.length() < MAX_DRAG_M).map(DragTransform::Move),
        };
        if let Some(change) = change {
            self.has_changed |= change != self.change;
            self.change = change;
        }
    }

    fn movement(&self, view: HandleView<'_>, pointer: HandlePointer) -> Option<Vec3> {
        let place = self.start.place;
        match (self.grip, self.grip_at(view, pointer.position)?) {
            (Grip::Along(from), Grip::Along(to)) => {
                if let (HandlePart::MoveAlongAim, Some(aim)) = (self.part, self.start.aim) {
                    let now_m = aim.distance_m.unwrap_or(0.0) - (to - from);
                    let snapped = snap(now_m, STEP_M, pointer.snap);
                    let left = if aim.distance_m.is_some() { snapped.max(MIN_AIM_M) } else { snapped };
                    return Some(aim.direction * (aim.distance_m.unwrap_or(0.0) - left));
                }
                let HandlePart::MoveAlong(i) = self.part else { return None };
                let axis = self.start.axes[i];
                Some(axis * snapped_by(place.dot(axis), to - from, pointer.snap))
            }
            (Grip::Point(from), Grip::Point(to)) => {
                let by = to - from;
                let along = |axis: Vec3| axis * snapped_by(place.dot(axis), by.dot(axis), pointer.snap);
                Some(match self.part {
                    HandlePart::MoveAcross(i) => self.start.across(i).map(along).into_iter().sum(),
                    HandlePart::MoveOnFloor => along(Vec3::X) + along(Vec3::Z),
                    _ => along(Vec3::X) + along(Vec3::Y) + along(Vec3::Z),
                })
            }
            _ => None,
        }
    }

    fn turn(&mut self, view: HandleView<'_>, pointer: HandlePointer) -> Option<DragTransform> {
        let turned = match self.grip {
            Grip::Angle { last_rad, turned_rad } => {
                let now_rad = self.angle_rad(view, pointer.position)?;
                let turned_rad = turned_rad + (now_rad - last_rad + PI).rem_euclid(TAU) - PI;
                self.grip = Grip::Angle { last_rad: now_rad, turned_rad };
                turned_rad
            }
            Grip::Screen(from) => {
                // The front of a ring that is seen edge-on moves along this direction.
                let ahead = self.axis.cross(view.towards_eye(self.start.place)).normalize_or_zero();
                let radius_m = SIZE * view.metres_a_point(self.start.place);
                let unit = view.place(self.start.place + ahead * radius_m)? - view.place(self.start.place)?;
                (pointer.position - from).dot(unit) / unit.length_sq().max(1.0)
            }
            Grip::Along(_) | Grip::Point(_) => return None,
        };
        Some(DragTransform::Rotate(self.axis, snap(turned, STEP_DEG.to_radians(), pointer.snap)))
    }

    fn scale(&self, view: HandleView<'_>, pointer: HandlePointer) -> Option<Vec3> {
        let factor = match (self.grip, self.grip_at(view, pointer.position)?) {
            (Grip::Along(from), Grip::Along(to)) => to / from,
            (Grip::Screen(from), Grip::Screen(to)) => {
                let middle = view.place(self.start.place)?;
                to.distance(middle) / from.distance(middle).max(1.0)
            }
            _ => return None,
        };
        let smallest = if pointer.snap { STEP_SCALE } else { MIN_SCALE };
        let factor = snap(factor, STEP_SCALE, pointer.snap).max(smallest);
        let mut factors = Vec3::splat(factor);
        if let HandlePart::SizeAlong(i) = self.part {
            factors = Vec3::ONE;
            factors[i] = factor;
        }
        Some(factors)
    }

    /// Returns the transform with the typed amount, if any, in the direction of the drag.
    fn with_typed_amount(&self) -> DragTransform {
        let Some(amount) = self.typed.value() else { return self.change };
        match self.change {
            DragTransform::Move(by) => DragTransform::Move(by.normalize_or_zero() * amount),
            DragTransform::Rotate(axis, angle) => {
                DragTransform::Rotate(axis, amount.to_radians() * if angle < 0.0 { -1.0 } else { 1.0 })
            }
            DragTransform::Scale(factor) => {
                let by = (factor - Vec3::ONE).abs();
                DragTransform::Scale(Vec3::ONE + by / by.max_element().max(1e-6) * (amount - 1.0))
            }
        }
    }

    /// Returns the action of the drag so far; none before the first change.
    pub fn action(&self) -> Option<Action> {
        if self.has_changed { self.held.changed(self.with_typed_amount()) } else { None }
    }

    /// Returns the amount of the drag as text, typed (in metres) or measured.
    pub fn amount(&self, units: Units) -> String {
        let unit = match self.change {
            DragTransform::Move(_) => " m",
            DragTransform::Rotate(..) => "\u{b0}",
            DragTransform::Scale(_) => " times",
        };
        match self.change {
            _ if !self.typed.text().is_empty() => format!("{}{unit}    Enter sets it", self.typed.text()),
            DragTransform::Move(by) => {
                let to_aim = self.start.aim.filter(|_| self.part == HandlePart::MoveAlongAim);
                let left = to_aim.and_then(|aim| Some(aim.distance_m? - by.dot(aim.direction)));
                match left {
                    Some(left) => format!("{} to its aim", lengths::text(units, left)),
                    None => lengths::text(units, by.length()),
                }
            }
            DragTransform::Rotate(_, angle) => format!("{:.1}{unit}", angle.to_degrees().abs()),
            DragTransform::Scale(factor) => {
                let most = factor.to_array().into_iter().max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()));
                format!("{:.2}{unit}", most.unwrap_or(1.0))
            }
        }
    }
}

fn snap(value: f32, step: f32, snaps: bool) -> f32 {
    if snaps { (value / step).round() * step } else { value }
}

/// Returns a move along an axis that snaps to coordinates of the room, so that things line up.
fn snapped_by(from: f32, by: f32, snaps: bool) -> f32 {
    if snaps { snap(from + by, STEP_M, true) - from } else { by }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::commands::choices::HandleMode;
    use crate::editor::document::catalog;
    use crate::editor::document::item::Item;
    use crate::editor::viewport::studio_view::StudioView;
    use crate::scene::{Aim, LightId, Scene};
    use eframe::egui::{Rect, pos2, vec2};

    const RECT: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(1000.0, 650.0) };

    /// A softbox 2 m before its aim.
    fn softbox() -> Scene {
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        light.position = Vec3::new(0.0, 1.13, 0.0);
        light.aim = Aim::Point(Vec3::new(0.0, 1.13, -2.0));
        let mut scene = Scene::default();
        Action::AddLight(Box::new(light)).apply(&mut scene).unwrap();
        scene
    }

    /// Returns the drag of a part of the softbox's handles from one place of the screen to another.
    fn drag(part: HandlePart, handle: HandleMode, view: HandleView<'_>, path: [Pos2; 2], snap: bool) -> HandleDrag {
        let (scene, items) = (softbox(), [Item::Light(LightId(0))]);
        let axes = HandleAxes::new(&scene, &items, handle, scene.lights[0].position);
        let held = DragSelection::new(&scene, &items, handle).unwrap();
        let mut drag = HandleDrag::new(part, axes, held, view, path[0]).unwrap();
        let pointer = |position| HandlePointer { position, is_over: true, pressed: false, down: true, snap };
        drag.follow(view, pointer(path[0]));
        assert!(drag.action().is_none(), "a press alone changes nothing");
        for i in 1..=8 {
            drag.follow(view, pointer(path[0].lerp(path[1], i as f32 / 8.0)));
        }
        drag
    }

    #[test]
    fn moves_follow_the_pointer_along_axes_over_planes_and_towards_the_aim() {
        let frame = StudioView::default().frame(1.5);
        let view = HandleView { frame: &frame, rect: RECT };
        let place = softbox().lights[0].position;
        for (part, by) in [
            (HandlePart::MoveAlong(0), Vec3::new(0.42, 0.0, 0.0)),
            (HandlePart::MoveAlong(1), Vec3::new(0.0, -0.31, 0.0)),
            (HandlePart::MoveAcross(1), Vec3::new(0.3, 0.0, -0.24)),
            (HandlePart::MoveOnFloor, Vec3::new(-0.3, 0.0, 0.4)),
            (HandlePart::MoveAlongAim, Vec3::new(0.0, 0.0, -0.6)),
        ] {
            let path = [place, place + by].map(|point| view.place(point).unwrap());
            let found = drag(part, HandleMode::Move, view, path, false).change;
            let DragTransform::Move(moved) = found else { panic!("{found:?}") };
            assert!((moved - by).length() < 1e-4, "{part:?}: {moved}, not {by}");
            let DragTransform::Move(snapped) = drag(part, HandleMode::Move, view, path, true).change else { panic!() };
            let steps = (place + snapped) / STEP_M;
            let off = (steps - steps.round()).abs();
            let is_moved = |i: &usize| snapped[*i].abs() > 1e-4;
            assert!(snapped.length() > 0.1 && (0..3).filter(is_moved).all(|i| off[i] < 1e-3), "{part:?}: {snapped}");
        }
        let path = [place, place + Vec3::NEG_Z * 0.6].map(|point| view.place(point).unwrap());
        assert_eq!(
            drag(HandlePart::MoveAlongAim, HandleMode::Move, view, path, false).amount(Units::Metres),
            "1.40 m to its aim"
        );
        let through = [place, place + Vec3::NEG_Z * 2.6].map(|point| view.place(point).unwrap());
        let stopped = drag(HandlePart::MoveAlongAim, HandleMode::Move, view, through, false).change;
        assert_eq!(stopped, DragTransform::Move(Vec3::NEG_Z * (2.0 - MIN_AIM_M)), "no light is moved through its aim");
    }

    #[test]
    fn a_ring_turns_round_its_middle_and_one_seen_edge_on_along_its_line() {
        let place = softbox().lights[0].position;
        // From above, the ring about the vertical is a circle; from the front it is a line.
        let above = StudioView { target: place, pitch_rad: 1.3, yaw_rad: 0.0, ..StudioView::default() };
        let front = StudioView { pitch_rad: 0.0, ..above };
        // The front of the ring is a tenth nearer to the eye than its middle.
        for (view, angles, error) in [(above, [0.2_f32, 1.3], 1e-3), (front, [-0.15, 0.2], 0.1)] {
            let frame = view.frame(1.5);
            let view = HandleView { frame: &frame, rect: RECT };
            let radius_m = SIZE * view.metres_a_point(place);
            let on_ring = |angle: f32| {
                let (sin, cos) = angle.sin_cos();
                view.place(place + Vec3::new(sin, 0.0, cos) * radius_m).unwrap()
            };
            let by = angles[1] - angles[0];
            let path = angles.map(on_ring);
            let DragTransform::Rotate(axis, turned) =
                drag(HandlePart::TurnAbout(1), HandleMode::Rotate, view, path, false).change
            else {
                panic!("a turn")
            };
            assert!(axis == Vec3::Y && (turned - by).abs() < error * by, "{turned}, not {by}");
            let DragTransform::Rotate(_, snapped) =
                drag(HandlePart::TurnAbout(1), HandleMode::Rotate, view, path, true).change
            else {
                panic!("a turn")
            };
            let steps = snapped.to_degrees() / STEP_DEG;
            assert!((steps - steps.round()).abs() < 1e-3, "{steps}");
        }
    }

    #[test]
    fn factors_are_ratios_of_distances_from_the_middle() {
        let place = softbox().lights[0].position;
        let frame = StudioView { target: place, yaw_rad: 0.3, ..StudioView::default() }.frame(1.5);
        let view = HandleView { frame: &frame, rect: RECT };
        let right = Vec3::from(softbox().light_frame(&softbox().lights[0]).matrix3.x_axis);
        let path = [0.4, 0.9].map(|along| view.place(place + right * along).unwrap());
        let wider = drag(HandlePart::SizeAlong(0), HandleMode::Scale, view, path, false).change;
        let DragTransform::Scale(factor) = wider else { panic!("{wider:?}") };
        assert!((factor - Vec3::new(2.25, 1.0, 1.0)).length() < 1e-3, "{factor}");
        let middle = view.place(place).unwrap();
        let path = [middle + vec2(0.0, 84.0), middle + vec2(0.0, 42.0)];
        let smaller = drag(HandlePart::SizeEvenly, HandleMode::Scale, view, path, false).change;
        let DragTransform::Scale(factor) = smaller else { panic!("{smaller:?}") };
        assert!((factor - Vec3::splat(0.5)).length() < 1e-3, "{factor}");
        let through = [path[0], middle];
        let least = drag(HandlePart::SizeEvenly, HandleMode::Scale, view, through, false).change;
        assert_eq!(least, DragTransform::Scale(Vec3::splat(MIN_SCALE)), "nothing is turned inside out");
    }

    #[test]
    fn a_typed_number_keeps_the_direction_of_the_drag() {
        let frame = StudioView::default().frame(1.5);
        let view = HandleView { frame: &frame, rect: RECT };
        let path = [RECT.center(), RECT.center()];
        let mut drag = drag(HandlePart::MoveOnScreen, HandleMode::Move, view, path, false);
        drag.change = DragTransform::Move(Vec3::new(0.0, -0.2, 0.0));
        assert_eq!(drag.with_typed_amount(), drag.change);
        drag.typed.take(&[eframe::egui::Event::Text("1.5".into())]);
        assert_eq!(drag.with_typed_amount(), DragTransform::Move(Vec3::new(0.0, -1.5, 0.0)));
        drag.change = DragTransform::Rotate(Vec3::Y, -0.1);
        assert_eq!(drag.with_typed_amount(), DragTransform::Rotate(Vec3::Y, -1.5_f32.to_radians()));
        drag.change = DragTransform::Scale(Vec3::new(1.0, 0.8, 1.0));
        assert_eq!(drag.with_typed_amount(), DragTransform::Scale(Vec3::new(1.0, 1.5, 1.0)));
        drag.change = DragTransform::Scale(Vec3::splat(1.2));
        assert_eq!(drag.with_typed_amount(), DragTransform::Scale(Vec3::splat(1.5)));
    }
}
