//! Lines and tints that stand for what has no surface: lights, their beams and aims, the camera, the floor's grid.

use crate::preview::input::{Overlay, Pick};
use crate::scene::{Camera, CameraFrame, Emitter, Light, Role, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// A line of constant width on the screen; twin of the instance in `overlay.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuLine {
    /// Where it begins, metres.
    pub from: [f32; 3],
    /// Pixels across.
    pub width_px: f32,
    /// Where it ends, metres.
    pub to: [f32; 3],
    /// How much of it shows through things, 0..1.
    pub through: f32,
    /// sRGB-encoded, straight alpha.
    pub color: [f32; 4],
}

/// A corner of a tinted triangle; twin of the vertex in `overlay.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuTint {
    /// Metres.
    pub position: [f32; 3],
    /// How much of it shows through things, 0..1.
    pub through: f32,
    /// sRGB-encoded, straight alpha.
    pub color: [f32; 4],
}

/// Everything drawn over the lit picture, and what a click on the lines means.
#[derive(Clone, Debug, Default)]
pub struct Gizmos {
    /// Lines of constant width.
    pub lines: Vec<GpuLine>,
    /// Corners of triangles, three each.
    pub tints: Vec<GpuTint>,
    /// Runs of `lines` that can be clicked.
    pub handles: Vec<(Pick, std::ops::Range<usize>)>,
}

/// sRGB of the selection.
const SELECTED: Vec3 = Vec3::new(1.0, 0.72, 0.25);
/// sRGB of what is switched off.
const OFF: Vec3 = Vec3::new(0.45, 0.45, 0.45);
/// sRGB of the camera.
const CAMERA: Vec3 = Vec3::new(0.82, 0.86, 0.92);
/// Segments of a circle.
const AROUND: usize = 32;
/// How much of a gizmo shows through things.
const THROUGH: f32 = 0.22;
/// Half the side of the grid, metres.
const GRID_REACH: i32 = 12;

/// sRGB of a light's role.
fn role_color(role: Role) -> Vec3 {
    match role {
        Role::Key => Vec3::new(1.0, 0.72, 0.24),
        Role::Fill => Vec3::new(0.36, 0.63, 1.0),
        Role::Rim => Vec3::new(1.0, 0.47, 0.68),
        Role::Hair => Vec3::new(0.71, 0.53, 1.0),
        Role::Background => Vec3::new(0.43, 0.80, 0.47),
        Role::Accent => Vec3::new(0.74, 0.74, 0.74),
    }
}

/// Colour and weight of the lines of one gizmo.
#[derive(Clone, Copy, Debug)]
struct Pen {
    color: Vec3,
    alpha: f32,
    width_px: f32,
    through: f32,
}

impl Pen {
    fn faint(self, alpha: f32) -> Self {
        Pen { alpha: self.alpha * alpha, width_px: 1.0, ..self }
    }
}

impl Gizmos {
    /// All that `overlay` asks for, as it is seen from `view`.
    pub fn new(scene: &Scene, overlay: &Overlay, view: &CameraFrame) -> Self {
        let mut gizmos = Gizmos::default();
        if overlay.grid {
            gizmos.add_grid(view.position());
        }
        if overlay.light_gizmos {
            for light in &scene.lights {
                gizmos.add_light(scene, light, overlay, view);
            }
        }
        if let Some(aspect) = overlay.camera_gizmo.filter(|aspect| *aspect > 0.0) {
            gizmos.add_camera(&scene.camera, &scene.camera_frame(aspect), overlay);
        }
        gizmos.lines.retain(|line| line.from.iter().chain(&line.to).all(|x| x.is_finite()));
        gizmos
    }

    fn line(&mut self, pen: Pen, from: Vec3, to: Vec3) {
        self.lines.push(GpuLine {
            from: from.into(),
            width_px: pen.width_px,
            to: to.into(),
            through: pen.through,
            color: pen.color.extend(pen.alpha).into(),
        });
    }

    fn loop_through(&mut self, pen: Pen, points: &[Vec3]) {
        for (i, &point) in points.iter().enumerate() {
            self.line(pen, point, points[(i + 1) % points.len()]);
        }
    }

    fn tint(&mut self, color: Vec3, alpha: f32, outline: &[Vec3]) {
        let corner = |point: Vec3| GpuTint { position: point.into(), through: 0.0, color: color.extend(alpha).into() };
        for pair in outline.get(1..).unwrap_or_default().windows(2) {
            self.tints.extend([outline[0], pair[0], pair[1]].map(corner));
        }
    }

    /// Metre lines of the floor, fading into the distance; the axes a little stronger.
    fn add_grid(&mut self, eye: Vec3) {
        let fade = |middle: Vec3| (1.2 - (middle - eye).length() / 22.0).clamp(0.0, 1.0);
        for step in -GRID_REACH..=GRID_REACH {
            for from in (-GRID_REACH..GRID_REACH).step_by(2) {
                let (across, start, end) = (step as f32, from as f32, (from + 2) as f32);
                let strength = if step == 0 { 0.38 } else { 0.15 };
                let lines = [
                    (Vec3::new(start, 0.0, across), Vec3::new(end, 0.0, across), Vec3::new(0.85, 0.45, 0.45)),
                    (Vec3::new(across, 0.0, start), Vec3::new(across, 0.0, end), Vec3::new(0.45, 0.55, 0.9)),
                ];
                for (a, b, axis_color) in lines {
                    let color = if step == 0 { axis_color } else { Vec3::splat(0.8) };
                    let alpha = strength * fade(0.5 * (a + b));
                    if alpha > 0.01 {
                        self.line(Pen { color, alpha, width_px: 1.0, through: 0.0 }, a, b);
                    }
                }
            }
        }
    }

    fn add_light(&mut self, scene: &Scene, light: &Light, overlay: &Overlay, view: &CameraFrame) {
        if light.emitter == Emitter::Surround {
            return;
        }
        let pick = Pick::Light(light.id);
        let selected = overlay.selects(pick);
        let hovered = overlay.hovered == Some(pick);
        let color = match (selected, light.on) {
            (true, _) => SELECTED,
            (false, true) => role_color(light.role),
            (false, false) => OFF,
        };
        let width_px = if selected || hovered { 2.4 } else { 1.6 };
        let pen = Pen { color, alpha: if light.on { 0.95 } else { 0.6 }, width_px, through: THROUGH };
        let first = self.lines.len();
        let frame = scene.light_frame(light);
        // A gizmo without a size of its own stays visible from afar.
        let half_view_m = (light.position - view.position()).length() * view.half_extent.y;
        let size_m = (0.035 * half_view_m).max(0.05);
        self.add_emitter(light, &frame, pen, size_m);
        self.handles.push((pick, first..self.lines.len()));

        let target = scene.aim_point(&light.aim, light.position);
        let reach = (target - light.position).length();
        if let Emitter::Spot { inner_deg, outer_deg } = light.emitter {
            self.add_cone(&frame, pen, inner_deg.min(outer_deg), outer_deg, reach.clamp(0.4, 2.5));
        }
        if has_direction(&light.emitter) && reach > 1e-3 {
            self.line(Pen { through: 0.12, ..pen.faint(if selected { 0.7 } else { 0.28 }) }, light.position, target);
        }
    }

    fn add_emitter(&mut self, light: &Light, frame: &Affine3A, pen: Pen, size_m: f32) {
        let at = |x: f32, y: f32, z: f32| frame.transform_point3(Vec3::new(x, y, z));
        match light.emitter {
            Emitter::Point => self.add_ball(light.position, size_m, pen),
            Emitter::Sphere { radius_m } => self.add_ball(light.position, radius_m.max(0.5 * size_m), pen),
            Emitter::Spot { .. } => {
                let (front, back) = (circle(frame, size_m, 0.0), circle(frame, 0.7 * size_m, 2.4 * size_m));
                for i in (0..AROUND).step_by(AROUND / 4) {
                    self.line(pen, front[i], back[i]);
                }
                self.loop_through(pen, &front);
                self.loop_through(pen, &back);
            }
            Emitter::RectPanel { width_m, height_m } => {
                let (x, y) = (0.5 * width_m, 0.5 * height_m);
                self.add_panel(&[at(-x, -y, 0.0), at(x, -y, 0.0), at(x, y, 0.0), at(-x, y, 0.0)], frame, pen);
            }
            Emitter::RoundPanel { diameter_m } => self.add_panel(&circle(frame, 0.5 * diameter_m, 0.0), frame, pen),
            Emitter::Sun { .. } => {
                self.loop_through(pen, &circle(frame, 2.0 * size_m, 0.0));
                for (x, y) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                    let tip = at(2.0 * size_m * x, 2.0 * size_m * y, -7.0 * size_m);
                    self.line(pen, at(2.0 * size_m * x, 2.0 * size_m * y, 0.0), tip);
                    let barb = |side: f32| at(2.0 * size_m * x + side, 2.0 * size_m * y, -6.0 * size_m);
                    self.line(pen, tip, barb(0.5 * size_m));
                    self.line(pen, tip, barb(-0.5 * size_m));
                }
            }
            Emitter::Surround => {}
        }
    }

    fn add_ball(&mut self, centre: Vec3, radius_m: f32, pen: Pen) {
        for (x, y) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
            let points: Vec<Vec3> = (0..AROUND)
                .map(|i| Vec2::from_angle(i as f32 / AROUND as f32 * TAU))
                .map(|p| centre + radius_m * (p.x * x + p.y * y))
                .collect();
            self.loop_through(pen, &points);
        }
    }

    /// Outline, a tint, and a tick that tells front from back.
    fn add_panel(&mut self, outline: &[Vec3], frame: &Affine3A, pen: Pen) {
        self.tint(pen.color, 0.09, outline);
        self.loop_through(pen, outline);
        let tick = |x: f32, z: f32| frame.transform_point3(Vec3::new(x, 0.0, z));
        self.line(pen, tick(0.0, 0.0), tick(0.0, -0.2));
        self.line(pen, tick(0.0, -0.2), tick(0.03, -0.15));
        self.line(pen, tick(0.0, -0.2), tick(-0.03, -0.15));
    }

    fn add_cone(&mut self, frame: &Affine3A, pen: Pen, inner_deg: f32, outer_deg: f32, reach_m: f32) {
        // A cone wider than this would reach to infinity on its plane.
        let radius = |full_deg: f32| reach_m * (0.5 * full_deg.clamp(0.0, 150.0)).to_radians().tan();
        let outer = circle(frame, radius(outer_deg), -reach_m);
        self.loop_through(pen.faint(0.6), &outer);
        if inner_deg + 0.5 < outer_deg {
            self.loop_through(pen.faint(0.3), &circle(frame, radius(inner_deg), -reach_m));
        }
        for i in (0..AROUND).step_by(AROUND / 8) {
            self.line(pen.faint(0.45), frame.translation.into(), outer[i]);
        }
    }

    fn add_camera(&mut self, camera: &Camera, frame: &CameraFrame, overlay: &Overlay) {
        let selected = overlay.selects(Pick::Camera);
        let pen = Pen {
            color: if selected { SELECTED } else { CAMERA },
            alpha: 0.9,
            width_px: if selected { 2.4 } else { 1.6 },
            through: THROUGH,
        };
        let first = self.lines.len();
        // Longer lenses reach farther, as their barrels do.
        let reach_m = (camera.focal_length_mm / 110.0).clamp(0.3, 1.5);
        let corner = |x: f32, y: f32| frame.position() + reach_m * frame.direction(Vec2::new(x, y));
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        self.loop_through(pen, &corners);
        for end in corners {
            self.line(pen, frame.position(), end);
        }
        // The triangle that says which way is up.
        let up = Vec3::from(frame.world_from_camera.matrix3.y_axis) * reach_m * frame.half_extent.y * 0.35;
        let (left, right) = (corners[0].lerp(corners[1], 0.4), corners[0].lerp(corners[1], 0.6));
        self.loop_through(pen, &[left, right, 0.5 * (left + right) + up]);
        self.add_body(&frame.world_from_camera, pen);
        self.handles.push((Pick::Camera, first..self.lines.len()));
    }

    /// The camera's box, behind the lens centre.
    fn add_body(&mut self, world_from_camera: &Affine3A, pen: Pen) {
        let at = |x: f32, y: f32, z: f32| world_from_camera.transform_point3(Vec3::new(x, y, z));
        let face = |z: f32| [at(-0.07, -0.05, z), at(0.07, -0.05, z), at(0.07, 0.05, z), at(-0.07, 0.05, z)];
        let (front, back) = (face(0.0), face(0.09));
        self.loop_through(pen, &front);
        self.loop_through(pen, &back);
        for (a, b) in front.into_iter().zip(back) {
            self.line(pen, a, b);
        }
    }
}

/// Points of a circle about the frame's axis, `z` along it.
fn circle(frame: &Affine3A, radius_m: f32, z: f32) -> Vec<Vec3> {
    (0..AROUND)
        .map(|i| Vec2::from_angle(i as f32 / AROUND as f32 * TAU) * radius_m)
        .map(|p| frame.transform_point3(p.extend(z)))
        .collect()
}

impl Gizmos {
    /// The handle whose lines pass nearest to a pixel, if one passes within `reach_px`.
    pub fn pick(&self, frame: &CameraFrame, size: (u32, u32), pixel: Vec2, reach_px: f32) -> Option<Pick> {
        let scale = Vec2::new(size.0 as f32, size.1 as f32);
        let distance = |line: &GpuLine| {
            let (a, b) = (frame.project(line.from.into())? * scale, frame.project(line.to.into())? * scale);
            let along = ((pixel - a).dot(b - a) / (b - a).length_squared().max(1e-6)).clamp(0.0, 1.0);
            Some((a.lerp(b, along) - pixel).length())
        };
        let nearest = |range: &std::ops::Range<usize>| {
            self.lines.get(range.clone())?.iter().filter_map(distance).min_by(f32::total_cmp)
        };
        self.handles
            .iter()
            .filter_map(|(pick, range)| Some((*pick, nearest(range)?)))
            .filter(|(_, distance)| *distance <= reach_px)
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(pick, _)| pick)
    }
}

fn has_direction(emitter: &Emitter) -> bool {
    match emitter {
        Emitter::Spot { .. } | Emitter::RectPanel { .. } | Emitter::RoundPanel { .. } | Emitter::Sun { .. } => true,
        Emitter::Point | Emitter::Sphere { .. } | Emitter::Surround => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aim, LightColor, LightId, Modifier, Output, Power};

    fn studio() -> Scene {
        let light = |id, x, emitter| Light {
            id: LightId(id),
            name: format!("Light {id}"),
            role: Role::Key,
            position: Vec3::new(x, 1.5, 0.0),
            aim: Aim::Point(Vec3::ZERO),
            roll_deg: 0.0,
            emitter,
            modifier: Modifier::default(),
            power: Power { output: Output::Lumens(1000.0), dial_stops: 0.0 },
            color: LightColor::default(),
            on: true,
            visible_to_camera: false,
            muted: false,
            locked: false,
        };
        Scene {
            lights: vec![
                light(0, -0.5, Emitter::RectPanel { width_m: 0.3, height_m: 0.3 }),
                light(1, 0.5, Emitter::Point),
                light(2, 0.0, Emitter::Spot { inner_deg: 180.0, outer_deg: 180.0 }),
                light(3, 0.2, Emitter::Surround),
            ],
            ..Scene::default()
        }
    }

    #[test]
    fn a_click_on_a_gizmo_finds_its_light_and_a_click_beside_it_finds_none() {
        let scene = studio();
        let frame = scene.camera_frame(1.5);
        let overlay = Overlay { light_gizmos: true, ..Overlay::default() };
        let gizmos = Gizmos::new(&scene, &overlay, &frame);
        assert!(gizmos.lines.iter().all(|line| line.from.iter().all(|x| x.is_finite())));
        let line = gizmos.lines[gizmos.handles[0].1.start];
        let corner = frame.project(line.from.into()).unwrap() * Vec2::new(600.0, 400.0);
        assert_eq!(gizmos.pick(&frame, (600, 400), corner, 4.0), Some(Pick::Light(LightId(0))));
        assert_eq!(gizmos.pick(&frame, (600, 400), Vec2::new(2.0, 2.0), 4.0), None);
    }

    #[test]
    fn nothing_is_drawn_unless_asked_for() {
        let scene = studio();
        let gizmos = Gizmos::new(&scene, &Overlay::default(), &scene.camera_frame(1.5));
        assert!(gizmos.lines.is_empty() && gizmos.tints.is_empty());
    }
}
