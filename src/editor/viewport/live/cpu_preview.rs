//! The CPU preview for windows without a GPU: the image of `raster`, without shadows, with the overlays of the GPU
//! preview.

use crate::color::ToneTable;
use crate::editor::ui::image_texture::ImageTexture;
use crate::photo::Picture;
use crate::preview::{Gizmos, GpuLine, GpuTint, Pick, PreviewInput, REACH_PX};
use crate::raster::{Framebuffer, NO_OBJECT, Rasterizer, Shading};
use crate::scene::{CameraFrame, LightId, ObjectId, Scene};
use eframe::egui::{Color32, ColorImage, Context, Mesh, Painter, Pos2, Rect, Shape, Stroke, TextureId, vec2};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Most pixels of a draft; larger views are drawn at 1/2, 1/3 ... and enlarged.
const MOVING_PIXELS: f32 = 1_000_000.0;
/// Width of the outline around selected objects, pixels.
const OUTLINE: usize = 2;
/// sRGB of the outline; twin of `outline.wgsl`.
const OUTLINE_COLOR: Color32 = Color32::from_rgb(255, 168, 41);
/// Distance of the near plane, metres.
const NEAR_M: f32 = 0.02;
/// Spacing of the occlusion tests along a line, pixels.
const OCCLUSION_STEP_PX: f32 = 4.0;

/// The CPU preview and its last frame.
#[derive(Debug, Default)]
pub struct CpuPreview {
    tone: ToneTable,
    /// The studio's surfaces and their revision.
    rasterizer: Option<(u64, Rasterizer)>,
    drawn: Option<CpuFrame>,
    image_texture: ImageTexture,
}

#[derive(Debug)]
struct CpuFrame {
    drawing: Framebuffer,
    frame: CameraFrame,
    gizmos: Gizmos,
    /// The objects of the scene, in its order.
    objects: Vec<ObjectId>,
    /// Pixels of the view per pixel of the framebuffer, along each side.
    scale: u32,
}

/// Returns the pixels of the view per pixel of a draft, along each side.
fn moving_scale((width, height): (u32, u32)) -> u32 {
    (width as f32 * height as f32 / MOVING_PIXELS).sqrt().ceil().max(1.0) as u32
}

impl CpuPreview {
    /// Returns true if a draft of a view of `size` is coarser than the full image.
    pub fn draws_drafts(size: (u32, u32)) -> bool {
        moving_scale(size) > 1
    }

    /// Draws the image; `revision` is that of the studio's surfaces.
    pub fn draw(&mut self, ctx: &Context, input: &PreviewInput, revision: u64) {
        if self.rasterizer.as_ref().is_none_or(|(of, _)| *of != revision) {
            self.rasterizer = Some((revision, Rasterizer::new(input.scene, input.assets)));
        }
        let Some((_, rasterizer)) = &mut self.rasterizer else { return };
        let scale = if input.options.draft { moving_scale(input.size) } else { 1 };
        let size = (input.size.0.div_ceil(scale), input.size.1.div_ceil(scale));
        let alone;
        let scene = match input.options.only_light {
            Some(id) => {
                alone = with_light_alone(input.scene, id);
                &alone
            }
            None => input.scene,
        };
        let mut drawing = self.drawn.take().map(|drawn| drawn.drawing).unwrap_or_default();
        rasterizer.draw(scene, input.assets, &input.frame, size, Shading::default(), &mut drawing);
        let selected = |object: &ObjectId| input.overlay.selects(Pick::Object(*object));
        let objects: Vec<ObjectId> = input.scene.objects.iter().map(|object| object.id).collect();
        let selected: Vec<bool> = objects.iter().map(selected).collect();
        let mut image = self.image(&drawing, input);
        outline(&mut image, &drawing.objects, &selected);
        self.image_texture.set(ctx, image);
        let gizmos = Gizmos::new(input.scene, input.assets, &input.overlay, &input.frame);
        self.drawn = Some(CpuFrame { drawing, frame: input.frame, gizmos, objects, scale });
    }

    /// Returns the tone-mapped image; transparent if only the overlays are drawn.
    fn image(&self, drawing: &Framebuffer, input: &PreviewInput) -> ColorImage {
        let picture = &drawing.picture;
        let size = [picture.width as usize, picture.height as usize];
        if input.options.overlay_alone {
            return ColorImage::filled(size, Color32::TRANSPARENT);
        }
        let shown = |(rgb, depth): (&[f32; 3], &f32)| {
            let [r, g, b] = self.tone.display_srgb8(if *depth > 0.0 { *rgb } else { input.overlay.void_color.into() });
            Color32::from_rgb(r, g, b)
        };
        ColorImage::new(size, picture.rgb.par_iter().zip(&drawing.inverse_depths).map(shown).collect())
    }

    /// Returns the scene-linear picture of the last image.
    pub fn picture(&self) -> Option<&Picture> {
        self.drawn.as_ref().map(|drawn| &drawn.drawing.picture)
    }

    /// Returns the texture of the last image.
    pub fn texture(&self) -> Option<TextureId> {
        self.image_texture.id()
    }

    /// Clears all, because the window has another device.
    pub fn clear(&mut self) {
        (self.drawn, self.rasterizer) = (None, None);
        self.image_texture.clear();
    }

    /// Returns the object or gizmo at a pixel of the last image; a gizmo's line precedes the objects behind it.
    pub fn pick(&self, (x, y): (u32, u32)) -> Option<Pick> {
        let CpuFrame { drawing, frame, gizmos, objects, scale } = self.drawn.as_ref()?;
        let size = (drawing.picture.width, drawing.picture.height);
        let pixel = (x / scale, y / scale);
        let inside = pixel.0 < size.0 && pixel.1 < size.1;
        let at = Vec2::new(pixel.0 as f32 + 0.5, pixel.1 as f32 + 0.5);
        let gizmo = gizmos.pick(frame, size, at, REACH_PX / *scale as f32).filter(|_| inside);
        let object = || objects.get(*drawing.objects.get((pixel.1 * size.0 + pixel.0) as usize)? as usize);
        gizmo.or_else(|| object().filter(|_| inside).map(|id| Pick::Object(*id)))
    }

    /// Paints lights, beams, camera and grid over the image in `rect`; occluded lines are faint.
    pub fn paint_over(&self, painter: &Painter, rect: Rect) {
        let Some(drawn) = &self.drawn else { return };
        for corners in drawn.gizmos.tints.chunks_exact(3) {
            drawn.paint_tint(painter, rect, corners);
        }
        for line in &drawn.gizmos.lines {
            drawn.paint_line(painter, rect, line);
        }
    }
}

impl CpuFrame {
    /// Projects a camera-space point: position in fractions of the image, and 1/w; none in front of the near plane.
    fn place(&self, local: Vec3) -> Option<Vec3> {
        (local.z <= -NEAR_M).then(|| {
            let inverse_w = -local.z.recip();
            let at = Vec2::new(local.x, -local.y) * inverse_w / self.frame.half_extent;
            (0.5 * (at + 1.0)).extend(inverse_w)
        })
    }

    fn local(&self, point: [f32; 3]) -> Vec3 {
        self.frame.world_from_camera.inverse().transform_point3(point.into())
    }

    /// Returns true if a projected point is occluded or outside of the image.
    fn is_hidden(&self, place: Vec3) -> bool {
        let (width, height) = (self.drawing.picture.width, self.drawing.picture.height);
        let pixel = place.truncate() * Vec2::new(width as f32, height as f32);
        if pixel.min_element() < 0.0 || pixel.x >= width as f32 || pixel.y >= height as f32 {
            return true;
        }
        let depth = self.drawing.inverse_depths[pixel.y as usize * width as usize + pixel.x as usize];
        // Depth bias of 0.5 % of the distance, at most 5 cm: as in `overlay.wgsl`.
        place.z * (1.0 + 0.05 * place.z).min(1.005) < depth
    }

    fn paint_tint(&self, painter: &Painter, rect: Rect, corners: &[GpuTint]) {
        let places: Vec<Vec3> = corners.iter().filter_map(|corner| self.place(self.local(corner.position))).collect();
        if places.len() < 3 || self.is_hidden(places.iter().sum::<Vec3>() / 3.0) {
            return;
        }
        let mut mesh = Mesh::default();
        for (place, corner) in places.iter().zip(corners) {
            mesh.colored_vertex(on_screen(rect, *place), color(corner.color, 1.0));
        }
        mesh.add_triangle(0, 1, 2);
        painter.add(Shape::mesh(mesh));
    }

    fn paint_line(&self, painter: &Painter, rect: Rect, line: &GpuLine) {
        let (mut a, mut b) = (self.local(line.from), self.local(line.to));
        if a.z.min(b.z) > -NEAR_M {
            return;
        }
        // Clip against the near plane.
        if a.z > -NEAR_M {
            a = a.lerp(b, (a.z + NEAR_M) / (a.z - b.z));
        }
        if b.z > -NEAR_M {
            b = b.lerp(a, (b.z + NEAR_M) / (b.z - a.z));
        }
        // Clipped ends may be nearer by a rounding error.
        let cut = |end: Vec3| self.place(end.with_z(end.z.min(-NEAR_M)));
        let (Some(a), Some(b)) = (cut(a), cut(b)) else { return };
        let Some((a, b)) = inside(a, b) else { return };
        let width = line.width_px / painter.pixels_per_point();
        let length = (on_screen(rect, b) - on_screen(rect, a)).length() * painter.pixels_per_point();
        let steps = (length / OCCLUSION_STEP_PX).ceil().clamp(1.0, 1024.0) as usize;
        let hidden = |step: usize| self.is_hidden(a.lerp(b, (step as f32 + 0.5) / steps as f32));
        let mut begin = (0, hidden(0));
        for step in 1..=steps {
            let same = step < steps && hidden(step) == begin.1;
            if same {
                continue;
            }
            let strength = if begin.1 { line.through } else { 1.0 };
            if strength > 0.0 {
                let ends = [begin.0, step].map(|step| on_screen(rect, a.lerp(b, step as f32 / steps as f32)));
                painter.line_segment(ends, Stroke::new(width, color(line.color, strength)));
            }
            begin = (step, !begin.1);
        }
    }
}

fn with_light_alone(scene: &Scene, only: LightId) -> Scene {
    let mut scene = scene.clone();
    scene.lights.iter_mut().for_each(|light| light.on &= light.id == only);
    scene
}

fn on_screen(rect: Rect, place: Vec3) -> Pos2 {
    rect.min + vec2(place.x * rect.width(), place.y * rect.height())
}

/// Clips a line to the image with a margin (Liang and Barsky 1984); none if it lies outside.
fn inside(a: Vec3, b: Vec3) -> Option<(Vec3, Vec3)> {
    const BEYOND: f32 = 0.01;
    let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
    let along = b - a;
    for (from, step) in [(a.x, along.x), (a.y, along.y)] {
        for (room, towards) in [(from + BEYOND, -step), (1.0 + BEYOND - from, step)] {
            match towards {
                t if t > 0.0 => leave = leave.min(room / t),
                t if t < 0.0 => enter = enter.max(room / t),
                _ if room < 0.0 => return None,
                _ => {}
            }
        }
    }
    (enter < leave).then(|| (a + along * enter, a + along * leave))
}

/// Converts a gizmo's colour: sRGB-encoded, straight alpha.
fn color(color: [f32; 4], strength: f32) -> Color32 {
    let [r, g, b, a] = (Vec4::from(color).clamp(Vec4::ZERO, Vec4::ONE) * 255.0).round().to_array();
    Color32::from_rgba_unmultiplied(r as u8, g as u8, b as u8, (a * strength) as u8)
}

/// Draws an outline around the selected objects.
fn outline(image: &mut ColorImage, objects: &[u32], selected: &[bool]) {
    let is_selected = |object: u32| object != NO_OBJECT && selected.get(object as usize).is_some_and(|is| *is);
    if !selected.contains(&true) {
        return;
    }
    let [width, height] = image.size;
    image.pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        let rows = y.saturating_sub(OUTLINE)..(y + OUTLINE + 1).min(height);
        for (x, pixel) in row.iter_mut().enumerate() {
            let own = objects[y * width + x];
            if is_selected(own) {
                continue;
            }
            let columns = x.saturating_sub(OUTLINE)..(x + OUTLINE + 1).min(width);
            let beside = |y: usize| objects[y * width..][columns.clone()].iter().any(|o| *o != own && is_selected(*o));
            if rows.clone().any(beside) {
                *pixel = OUTLINE_COLOR;
            }
        }
    });
}
