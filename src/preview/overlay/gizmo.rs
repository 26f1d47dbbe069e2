//! Gizmos of lights, camera and floor grid, as lines and tinted triangles.

use crate::preview::input::{Overlay, Pick};
use crate::scene::{Assets, Camera, CameraFrame, Emitter, IntensityTable, Light, Role, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// A line of constant width on the screen; twin of the instance in `overlay.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuLine {
    /// Start point, world space.
    pub from: [f32; 3],
    /// Width on the screen, pixels.
    pub width_px: f32,
    /// End point, world space.
    pub to: [f32; 3],
    /// Opacity of the parts that surfaces hide, 0..1.
    pub through: f32,
    /// sRGB-encoded, straight alpha.
    pub color: [f32; 4],
}

/// A vertex of a tinted triangle; twin of the vertex in `overlay.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuTint {
    /// World space.
    pub position: [f32; 3],
    /// Opacity of the parts that surfaces hide, 0..1.
    pub through: f32,
    /// sRGB-encoded, straight alpha.
    pub color: [f32; 4],
}

/// The lines and triangles of all gizmos, and what a click on them selects.
#[derive(Clone, Debug, Default)]
pub struct Gizmos {
    /// Lines of constant width.
    pub lines: Vec<GpuLine>,
    /// Vertices of triangles, three each.
    pub tints: Vec<GpuTint>,
    /// Clickable ranges of `lines`.
    pub handles: Vec<(Pick, std::ops::Range<usize>)>,
}

/// sRGB colour of selected gizmos.
const SELECTED: Vec3 = Vec3::new(1.0, 0.72, 0.25);
/// sRGB colour of lights that are off.
const OFF: Vec3 = Vec3::new(0.45, 0.45, 0.45);
/// sRGB colour of the camera.
const CAMERA: Vec3 = Vec3::new(0.82, 0.86, 0.92);
/// Number of segments of a circle.
const SEGMENTS: usize = 32;
/// Opacity of the hidden parts of a gizmo.
const HIDDEN_OPACITY: f32 = 0.22;
/// Half the side of the floor grid, metres.
const GRID_HALF_SIZE: i32 = 12;

/// Returns the sRGB colour of a light's role.
fn role_color(role: Role) -> Vec3 {
    Vec3::from(role.srgb8().map(f32::from)) / 255.0
}

/// The line style of a gizmo.
#[derive(Clone, Copy, Debug)]
struct LineStyle {
    color: Vec3,
    alpha: f32,
    width_px: f32,
    through: f32,
}

impl LineStyle {
    /// Returns a thin line of a fraction of the opacity.
    fn faint(self, alpha: f32) -> Self {
        LineStyle { alpha: self.alpha * alpha, width_px: 1.0, ..self }
    }
}

impl Gizmos {
    /// Builds the gizmos that `overlay` enables, sized for `view`.
    pub fn new(scene: &Scene, assets: &Assets, overlay: &Overlay, view: &CameraFrame) -> Self {
        let mut gizmos = Gizmos::default();
        if overlay.grid {
            gizmos.add_grid(view.position());
        }
        if overlay.light_gizmos {
            for light in &scene.lights {
                gizmos.add_light(scene, assets, light, overlay, view);
            }
        }
        if let Some(aspect) = overlay.camera_gizmo.filter(|aspect| *aspect > 0.0) {
            gizmos.add_camera(&scene.camera, &scene.camera_frame(aspect), overlay);
        }
        gizmos.lines.retain(|line| line.from.iter().chain(&line.to).all(|x| x.is_finite()));
        gizmos
    }

    fn line(&mut self, style: LineStyle, from: Vec3, to: Vec3) {
        self.lines.push(GpuLine {
            from: from.into(),
            width_px: style.width_px,
            to: to.into(),
            through: style.through,
            color: style.color.extend(style.alpha).into(),
        });
    }

    /// Adds a closed polyline.
    fn closed_loop(&mut self, style: LineStyle, points: &[Vec3]) {
        for (i, &point) in points.iter().enumerate() {
            self.line(style, point, points[(i + 1) % points.len()]);
        }
    }

    /// Adds a triangle fan.
    fn tint(&mut self, color: Vec3, alpha: f32, outline: &[Vec3]) {
        let corner = |point: Vec3| GpuTint { position: point.into(), through: 0.0, color: color.extend(alpha).into() };
        for pair in outline.get(1..).unwrap_or_default().windows(2) {
            self.tints.extend([outline[0], pair[0], pair[1]].map(corner));
        }
    }

    /// Adds the metre grid of the floor, fading with distance; the axes are stronger.
    fn add_grid(&mut self, eye: Vec3) {
        let fade = |centre: Vec3| (1.2 - (centre - eye).length() / 22.0).clamp(0.0, 1.0);
        for step in -GRID_HALF_SIZE..=GRID_HALF_SIZE {
            for from in (-GRID_HALF_SIZE..GRID_HALF_SIZE).step_by(2) {
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
                        self.line(LineStyle { color, alpha, width_px: 1.0, through: 0.0 }, a, b);
                    }
                }
            }
        }
    }

    fn add_light(&mut self, scene: &Scene, assets: &Assets, light: &Light, overlay: &Overlay, view: &CameraFrame) {
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
        let style = LineStyle { color, alpha: if light.on { 0.95 } else { 0.6 }, width_px, through: HIDDEN_OPACITY };
        let first = self.lines.len();
        let frame = scene.light_frame(light);
        // Scale gizmos of lights without a size with the distance
        let half_view_m = (light.position - view.position()).length() * view.half_extent.y;
        let size_m = (0.035 * half_view_m).max(0.05);
        self.add_emitter(light, &frame, style, size_m);
        self.handles.push((pick, first..self.lines.len()));

        let reach = scene.aim_vector(&light.aim, light.position).length();
        if let Some(table) = assets.intensity_table(light) {
            let planes = if selected { 16 } else { 4 };
            self.add_photometric_solid(&table, &frame, style.faint(0.6), planes, (0.3 * reach).clamp(0.2, 0.8));
        } else if let Emitter::Spot { inner_deg, outer_deg } = light.emitter {
            self.add_cone(&frame, style, inner_deg.min(outer_deg), outer_deg, reach.clamp(0.4, 2.5));
        }
        if (has_direction(&light.emitter) || light.photometric_file.is_some()) && reach > 1e-3 {
            self.line(
                LineStyle { through: 0.12, ..style.faint(if selected { 0.7 } else { 0.28 }) },
                light.position,
                scene.aim_point(&light.aim, light.position),
            );
        }
    }

    /// Adds the photometric solid of a measured light: half planes of it, whose distance from the light is the intensity,
    /// with the largest at `radius_m`.
    fn add_photometric_solid(
        &mut self,
        table: &IntensityTable,
        frame: &Affine3A,
        style: LineStyle,
        planes: usize,
        radius_m: f32,
    ) {
        const ROWS: usize = 36;
        for plane in 0..planes {
            let horizontal_deg = 360.0 * plane as f32 / planes as f32;
            let turn = Vec2::from_angle(horizontal_deg.to_radians());
            // Denser near the axis, where beams are narrow
            let points: Vec<Vec3> = (0..=ROWS)
                .map(|row| {
                    let vertical_deg = 180.0 * (row as f32 / ROWS as f32).powi(2);
                    let (across, ahead) = vertical_deg.to_radians().sin_cos();
                    let length = radius_m * table.candela_at(vertical_deg, horizontal_deg) / table.peak_cd();
                    frame.transform_point3(length * Vec3::new(across * turn.x, across * turn.y, -ahead))
                })
                .collect();
            for pair in points.windows(2).filter(|pair| pair[0] != pair[1]) {
                self.line(style, pair[0], pair[1]);
            }
        }
    }

    fn add_emitter(&mut self, light: &Light, frame: &Affine3A, style: LineStyle, size_m: f32) {
        let at = |x: f32, y: f32, z: f32| frame.transform_point3(Vec3::new(x, y, z));
        match light.emitter {
            Emitter::Point => self.add_sphere(light.position, size_m, style),
            Emitter::Sphere { radius_m } => self.add_sphere(light.position, radius_m.max(0.5 * size_m), style),
            Emitter::Spot { .. } => {
                let (front, back) = (circle(frame, size_m, 0.0), circle(frame, 0.7 * size_m, 2.4 * size_m));
                for i in (0..SEGMENTS).step_by(SEGMENTS / 4) {
                    self.line(style, front[i], back[i]);
                }
                self.closed_loop(style, &front);
                self.closed_loop(style, &back);
            }
            Emitter::RectPanel { width_m, height_m } => {
                let (x, y) = (0.5 * width_m, 0.5 * height_m);
                self.add_panel(&[at(-x, -y, 0.0), at(x, -y, 0.0), at(x, y, 0.0), at(-x, y, 0.0)], frame, style);
            }
            Emitter::RoundPanel { diameter_m } => self.add_panel(&circle(frame, 0.5 * diameter_m, 0.0), frame, style),
            Emitter::Sun { .. } => {
                self.closed_loop(style, &circle(frame, 2.0 * size_m, 0.0));
                for (x, y) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                    let tip = at(2.0 * size_m * x, 2.0 * size_m * y, -7.0 * size_m);
                    self.line(style, at(2.0 * size_m * x, 2.0 * size_m * y, 0.0), tip);
                    let barb = |side: f32| at(2.0 * size_m * x + side, 2.0 * size_m * y, -6.0 * size_m);
                    self.line(style, tip, barb(0.5 * size_m));
                    self.line(style, tip, barb(-0.5 * size_m));
                }
            }
            Emitter::Surround => {}
        }
    }

    /// Adds three great circles of a sphere.
    fn add_sphere(&mut self, centre: Vec3, radius_m: f32, style: LineStyle) {
        for (x, y) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
            let points: Vec<Vec3> = (0..SEGMENTS)
                .map(|i| Vec2::from_angle(i as f32 / SEGMENTS as f32 * TAU))
                .map(|p| centre + radius_m * (p.x * x + p.y * y))
                .collect();
            self.closed_loop(style, &points);
        }
    }

    /// Adds a panel's outline, tint, and an arrow at its front.
    fn add_panel(&mut self, outline: &[Vec3], frame: &Affine3A, style: LineStyle) {
        self.tint(style.color, 0.09, outline);
        self.closed_loop(style, outline);
        let tick = |x: f32, z: f32| frame.transform_point3(Vec3::new(x, 0.0, z));
        self.line(style, tick(0.0, 0.0), tick(0.0, -0.2));
        self.line(style, tick(0.0, -0.2), tick(0.03, -0.15));
        self.line(style, tick(0.0, -0.2), tick(-0.03, -0.15));
    }

    fn add_cone(&mut self, frame: &Affine3A, style: LineStyle, inner_deg: f32, outer_deg: f32, reach_m: f32) {
        // Limit the angle: the base of a cone grows without bound towards 180 degrees
        let radius = |full_deg: f32| reach_m * (0.5 * full_deg.clamp(0.0, 150.0)).to_radians().tan();
        let outer = circle(frame, radius(outer_deg), -reach_m);
        self.closed_loop(style.faint(0.6), &outer);
        if inner_deg + 0.5 < outer_deg {
            self.closed_loop(style.faint(0.3), &circle(frame, radius(inner_deg), -reach_m));
        }
        for i in (0..SEGMENTS).step_by(SEGMENTS / 8) {
            self.line(style.faint(0.45), frame.translation.into(), outer[i]);
        }
    }

    fn add_camera(&mut self, camera: &Camera, frame: &CameraFrame, overlay: &Overlay) {
        let selected = overlay.selects(Pick::Camera);
        let style = LineStyle {
            color: if selected { SELECTED } else { CAMERA },
            alpha: 0.9,
            width_px: if selected { 2.4 } else { 1.6 },
            through: HIDDEN_OPACITY,
        };
        let first = self.lines.len();
        // The frustum's length grows with the focal length
        let reach_m = (camera.focal_length_mm / 110.0).clamp(0.3, 1.5);
        let corner = |x: f32, y: f32| frame.position() + reach_m * frame.direction(Vec2::new(x, y));
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        self.closed_loop(style, &corners);
        for end in corners {
            self.line(style, frame.position(), end);
        }
        // The triangle above the frame marks its top
        let up = Vec3::from(frame.world_from_camera.matrix3.y_axis) * reach_m * frame.half_extent.y * 0.35;
        let (left, right) = (corners[0].lerp(corners[1], 0.4), corners[0].lerp(corners[1], 0.6));
        self.closed_loop(style, &[left, right, 0.5 * (left + right) + up]);
        self.add_body(&frame.world_from_camera, style);
        self.handles.push((Pick::Camera, first..self.lines.len()));
    }

    /// Adds the camera's body, behind the lens centre.
    fn add_body(&mut self, world_from_camera: &Affine3A, style: LineStyle) {
        let at = |x: f32, y: f32, z: f32| world_from_camera.transform_point3(Vec3::new(x, y, z));
        let face = |z: f32| [at(-0.07, -0.05, z), at(0.07, -0.05, z), at(0.07, 0.05, z), at(-0.07, 0.05, z)];
        let (front, back) = (face(0.0), face(0.09));
        self.closed_loop(style, &front);
        self.closed_loop(style, &back);
        for (a, b) in front.into_iter().zip(back) {
            self.line(style, a, b);
        }
    }
}

/// Returns points of a circle around a frame's Z axis, at `z` along it.
fn circle(frame: &Affine3A, radius_m: f32, z: f32) -> Vec<Vec3> {
    (0..SEGMENTS)
        .map(|i| Vec2::from_angle(i as f32 / SEGMENTS as f32 * TAU) * radius_m)
        .map(|p| frame.transform_point3(p.extend(z)))
        .collect()
}

impl Gizmos {
    /// Returns the handle with the line nearest to a pixel, within `radius_px`.
    pub fn pick(&self, frame: &CameraFrame, size: (u32, u32), pixel: Vec2, radius_px: f32) -> Option<Pick> {
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
            .filter(|(_, distance)| *distance <= radius_px)
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
    use crate::scene::{Aim, LightId, Output};

    fn studio() -> Scene {
        let light = |id, x, emitter| Light {
            id: LightId(id),
            name: format!("Light {id}"),
            position: Vec3::new(x, 1.5, 0.0),
            aim: Aim::Point(Vec3::ZERO),
            ..Light::new(emitter, Output::Lumens(1000.0))
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
    fn a_pick_on_a_gizmo_returns_its_light_and_beside_it_none() {
        let scene = studio();
        let frame = scene.camera_frame(1.5);
        let overlay = Overlay { light_gizmos: true, ..Overlay::default() };
        let gizmos = Gizmos::new(&scene, &Assets::default(), &overlay, &frame);
        assert!(gizmos.lines.iter().all(|line| line.from.iter().all(|x| x.is_finite())));
        let line = gizmos.lines[gizmos.handles[0].1.start];
        let corner = frame.project(line.from.into()).unwrap() * Vec2::new(600.0, 400.0);
        assert_eq!(gizmos.pick(&frame, (600, 400), corner, 4.0), Some(Pick::Light(LightId(0))));
        assert_eq!(gizmos.pick(&frame, (600, 400), Vec2::new(2.0, 2.0), 4.0), None);
    }

    #[test]
    fn the_default_overlay_has_no_gizmos() {
        let scene = studio();
        let gizmos = Gizmos::new(&scene, &Assets::default(), &Overlay::default(), &scene.camera_frame(1.5));
        assert!(gizmos.lines.is_empty() && gizmos.tints.is_empty());
    }
}
