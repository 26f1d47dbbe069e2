//! What the textures of a triangle give to its pixels: factors of the material, normals, and holes.

use super::gbuffer_row::{Span, VertexAttributes};
use super::geometry::Surface;
use super::surface_texture::PixelFactors;
use crate::math::{Dome, decode_normal, position_derivatives, tangent_frame, tilted_normal};
use crate::scene::{Mesh, TextureSlot};
use glam::{Vec2, Vec3};

/// A triangle of a surface, by which texture coordinates are interpolated.
#[derive(Clone, Copy, Debug)]
pub(super) struct TexturedTriangle<'a> {
    surface: &'a Surface,
    /// Texture coordinates of the corners, by set.
    uvs: [[Vec2; 3]; 2],
}

impl<'a> TexturedTriangle<'a> {
    /// Returns a triangle of a mesh.
    pub fn new(surface: &'a Surface, mesh: &Mesh, corners: [usize; 3]) -> Self {
        let of = |uvs: &[Vec2]| corners.map(|i| uvs.get(i).copied().unwrap_or_default());
        TexturedTriangle { surface, uvs: [of(&mesh.uvs), of(&mesh.second_uvs)] }
    }

    /// Returns both sets of texture coordinates at barycentric coordinates, which may be over w.
    pub fn uvs_at(&self, over_w: Vec3) -> [Vec2; 2] {
        let weights = over_w / over_w.element_sum();
        self.uvs.map(|[a, b, c]| a * weights.x + b * weights.y + c * weights.z)
    }

    /// Returns the factors of the material at both sets of texture coordinates.
    pub fn factors(&self, uvs: [Vec2; 2], linear_from_srgb: &[f32; 256]) -> PixelFactors {
        let rgb = |slot: TextureSlot| {
            self.surface.textures[slot as usize].as_ref().map_or(Vec3::ONE, |map| map.rgb(uvs, linear_from_srgb))
        };
        let gloss = rgb(TextureSlot::MetallicRoughness);
        PixelFactors {
            color: rgb(TextureSlot::BaseColor),
            roughness: gloss.y,
            metallic: gloss.z,
            emission: rgb(TextureSlot::Emission),
        }
    }

    /// Returns true if the surface is there at a pixel: a blended one by a pattern of 4 x 4 pixels.
    pub fn is_there(&self, over_w: Vec3, (x, y): (usize, usize)) -> bool {
        let map = self.surface.textures[TextureSlot::BaseColor as usize].as_ref();
        let alpha = map.map_or(1.0, |map| map.alpha(self.uvs_at(over_w)));
        self.surface.material.alpha.coverage(alpha) > screen_threshold(x, y)
    }

    /// Tilts a normal by the normal map, for the derivatives of the position by its picture and the direction to the
    /// eye; the side of the geometric normal is kept.
    fn tilted(
        &self,
        normal: Vec3,
        geometric_normal: Vec3,
        view_dir: Vec3,
        over_w: Vec3,
        derivatives: [Vec3; 2],
    ) -> Vec3 {
        let Some(map) = &self.surface.textures[TextureSlot::Normal as usize] else { return normal };
        let scale = self.surface.material.textures.normal_scale;
        let tilt = decode_normal(map.rgb(self.uvs_at(over_w), &[0.0; 256]), scale);
        let side = if geometric_normal.dot(view_dir) < 0.0 { -1.0 } else { 1.0 };
        let outward = if normal.dot(geometric_normal) < 0.0 { -normal } else { normal };
        tilted_normal(outward, derivatives, tilt) * side
    }

    /// Returns the derivatives of the position by the picture of the normal map; none without a map.
    fn derivatives(&self, corners: [Vec3; 3]) -> Option<[Vec3; 2]> {
        let map = self.surface.textures[TextureSlot::Normal as usize].as_ref()?;
        let uvs = self.uvs[usize::from(map.second_uvs)].map(|uv| map.picture_from_mesh.transform_vector2(uv));
        let [a, b, c] = corners;
        position_derivatives([b - a, c - a], [uvs[1] - uvs[0], uvs[2] - uvs[0]])
    }

    /// Returns the dome over the textures, for the triangle's vertices relative to the eye; none without one.
    pub fn dome(&self, vertices: [&VertexAttributes; 3]) -> Option<DomedTriangle<'a>> {
        let dome = self.surface.material.dome()?;
        let [a, b, c] = vertices.map(|[x, y, z, ..]| Vec3::new(*x, *y, *z));
        let [uv_a, uv_b, uv_c] = self.uvs[0];
        let derivatives = position_derivatives([b - a, c - a], [uv_b - uv_a, uv_c - uv_a])?;
        let geometric_normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        Some(DomedTriangle { triangle: *self, dome, derivatives, geometric_normal })
    }

    /// Returns the tilted normal of each pixel of a span: for its index and its normal of any length. `vertices` are those
    /// of the triangle, relative to the eye.
    pub fn tilt_normals(
        &self,
        span: &Span,
        vertices: [&VertexAttributes; 3],
        mut change: impl FnMut(usize, &dyn Fn(Vec3, Vec3) -> Vec3),
    ) {
        let corners = vertices.map(|[x, y, z, ..]| Vec3::new(*x, *y, *z));
        let Some(derivatives) = self.derivatives(corners) else { return };
        let [a, b, c] = corners;
        let geometric_normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        for i in span.pixels.clone() {
            let over_w = span.start + span.step * (i - span.pixels.start) as f32;
            change(i, &|position, normal| {
                let normal = normal.normalize_or(geometric_normal);
                self.tilted(normal, geometric_normal, (-position).normalize_or_zero(), over_w, derivatives)
            });
        }
    }
}

/// A triangle of a dome, through which its textures are seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct DomedTriangle<'a> {
    triangle: TexturedTriangle<'a>,
    dome: Dome,
    /// Of the position by the texture coordinates.
    derivatives: [Vec3; 2],
    geometric_normal: Vec3,
}

impl DomedTriangle<'_> {
    /// Returns what is seen at barycentric coordinates over w: factors of the material, and the normal below the dome. The
    /// position is relative to the eye; the normal may have any length.
    pub fn seen(
        &self,
        over_w: Vec3,
        position: Vec3,
        normal: Vec3,
        linear_from_srgb: &[f32; 256],
    ) -> (PixelFactors, Vec3) {
        let [uv, second_uv] = self.triangle.uvs_at(over_w);
        let view_dir = (-position).normalize_or_zero();
        let side = if self.geometric_normal.dot(view_dir) < 0.0 { -1.0 } else { 1.0 };
        let normal = normal.normalize_or(self.geometric_normal);
        let outward = if normal.dot(self.geometric_normal) < 0.0 { -normal } else { normal };
        let Some(frame) = tangent_frame(outward, self.derivatives) else {
            return (self.triangle.factors([uv, second_uv], linear_from_srgb), normal);
        };
        let (uv, world_from_base) = self.dome.seen(uv, frame, view_dir);
        let uvs = [uv, second_uv];
        let Surface { material, textures, .. } = self.triangle.surface;
        let tilt = textures[TextureSlot::Normal as usize]
            .as_ref()
            .map_or(Vec3::Z, |map| decode_normal(map.rgb(uvs, &[0.0; 256]), material.textures.normal_scale));
        let below = world_from_base * tilt.normalize_or(Vec3::Z);
        (self.triangle.factors(uvs, linear_from_srgb), below * side)
    }
}

/// Returns the coverage from which on a pixel shows a blended surface: a Bayer matrix of 4 x 4.
fn screen_threshold(x: usize, y: usize) -> f32 {
    const BAYER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    (f32::from(BAYER[y % 4][x % 4]) + 0.5) / 16.0
}
