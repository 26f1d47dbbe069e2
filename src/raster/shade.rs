//! From a triangle and the weights of its corners to light: Lambert, Blinn and Phong, Gouraud, flat.

use super::Shading;
use super::fill::ScreenTriangle;
use super::lights::Lights;
use super::world::{Surface, Vertices, World};
use crate::color::srgb_decode;
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Part of a clear surface that is shown as if it were paint, so that glass can be seen.
const GLASS_BODY: f32 = 0.15;

/// Where a highlight has fallen to 1e-6 of its middle.
const FAR_FROM_HIGHLIGHT: f32 = 14.0;

/// A material as it is shaded here.
#[derive(Clone, Copy, Debug)]
struct Finish {
    base: Vec3,
    /// Part of the base colour that is matte.
    matte: f32,
    /// Reflectance at normal incidence.
    f0: Vec3,
    /// Exponent of the highlight, and what makes it keep its energy.
    exponent: f32,
    scale: f32,
    glow: Vec3,
}

/// Light that leaves a point: for each unit of its base colour, and the rest.
#[derive(Clone, Copy, Debug, Default)]
struct Lit {
    matte: Vec3,
    glossy: Vec3,
}

/// Shades pixels.
#[derive(Debug)]
pub(super) struct Shader<'a> {
    world: &'a World,
    vertices: &'a [Vertices],
    lights: &'a Lights,
    eye: Vec3,
    shading: Shading,
    finishes: Vec<Finish>,
    /// Light at the vertices of each mesh, for Gouraud's shading.
    at_vertices: Vec<Vec<Lit>>,
    /// sRGB bytes as linear light.
    linear: [f32; 256],
}

impl<'a> Shader<'a> {
    pub fn new(world: &'a World, vertices: &'a [Vertices], lights: &'a Lights, eye: Vec3, shading: Shading) -> Self {
        let finishes = world.surfaces.iter().map(|surface| finish(surface, lights.glow)).collect();
        let linear = std::array::from_fn(|i| srgb_decode(i as f32 / 255.0));
        let mut shader = Shader { world, vertices, lights, eye, shading, finishes, at_vertices: Vec::new(), linear };
        if shading == Shading::Gouraud {
            shader.at_vertices = (0..world.placed.len()).map(|placed| shader.lit_vertices(placed)).collect();
        }
        shader
    }

    /// Light at each vertex of a mesh, by its normal and the material of the last triangle that has it.
    fn lit_vertices(&self, placed: usize) -> Vec<Lit> {
        let (mesh, vertices) = (&self.world.placed[placed].mesh, &self.vertices[placed]);
        let mut seen_as = vec![(0_u32, Vec3::ZERO); vertices.world.len()];
        for (part, surface) in mesh.parts.iter().zip(self.world.placed[placed].first_surface..) {
            for corners in mesh.triangles.get(part.triangles.start as usize..part.triangles.end as usize).unwrap_or(&[])
            {
                let [a, b, c] = corners.map(|i| vertices.world[i as usize]);
                let face = (b - a).cross(c - a);
                corners.iter().for_each(|&i| seen_as[i as usize] = (surface, face));
            }
        }
        seen_as
            .into_par_iter()
            .enumerate()
            .map(|(i, (surface, face))| {
                let normal = vertices.normals.get(i).copied().unwrap_or(face);
                self.lit(&self.finishes[surface as usize], vertices.world[i], normal, face)
            })
            .collect()
    }

    /// What is seen where there is nothing.
    pub fn nothing(&self) -> [f32; 3] {
        self.lights.void_radiance.into()
    }

    /// The object that a triangle belongs to.
    pub fn object(&self, triangle: &ScreenTriangle) -> u32 {
        self.world.placed[triangle.placed as usize].object
    }

    /// Scene-linear value of a point of a triangle, given by the weights of its corners.
    pub fn pixel(&self, triangle: &ScreenTriangle, weights: Vec3) -> Vec3 {
        let finish = &self.finishes[triangle.surface as usize];
        let corners = self.world.placed[triangle.placed as usize].mesh.triangles[triangle.triangle as usize];
        let vertices = &self.vertices[triangle.placed as usize];
        let points = corners.map(|i| vertices.world[i as usize]);
        let face = (points[1] - points[0]).cross(points[2] - points[0]);
        let blend = |values: [Vec3; 3], w: Vec3| values[0] * w.x + values[1] * w.y + values[2] * w.z;
        let normals =
            if vertices.normals.is_empty() { [face; 3] } else { corners.map(|i| vertices.normals[i as usize]) };
        let lit = match self.shading {
            Shading::Lambert | Shading::BlinnPhong => {
                self.lit(finish, blend(points, weights), blend(normals, weights), face)
            }
            Shading::Flat => self.lit(finish, blend(points, Vec3::splat(1.0 / 3.0)), face, face),
            Shading::Gouraud => {
                let [a, b, c] = corners.map(|i| self.at_vertices[triangle.placed as usize][i as usize]);
                Lit {
                    matte: blend([a.matte, b.matte, c.matte], weights),
                    glossy: blend([a.glossy, b.glossy, c.glossy], weights),
                }
            }
        };
        let texel = self.texel(triangle, corners, weights);
        finish.base * texel * finish.matte * lit.matte / PI + lit.glossy + finish.glow
    }

    fn texel(&self, triangle: &ScreenTriangle, corners: [u32; 3], weights: Vec3) -> Vec3 {
        let Some(texture) = &self.world.surfaces[triangle.surface as usize].texture else { return Vec3::ONE };
        let uvs = &self.world.placed[triangle.placed as usize].mesh.uvs;
        let uv = |i: u32| uvs.get(i as usize).copied().unwrap_or(Vec2::ZERO);
        let at = uv(corners[0]) * weights.x + uv(corners[1]) * weights.y + uv(corners[2]) * weights.z;
        nearest_texel(texture, at).map_or(Vec3::ONE, |rgb| Vec3::from(rgb.map(|c| self.linear[usize::from(c)])))
    }

    fn lit(&self, finish: &Finish, point: Vec3, normal: Vec3, face: Vec3) -> Lit {
        let view = (self.eye - point).normalize_or_zero();
        // The side that is seen.
        let face = if face.dot(view) < 0.0 { -face } else { face };
        let normal = if normal.dot(face) < 0.0 { -normal } else { normal }.normalize_or_zero();
        let mut lit = Lit { matte: self.lights.ambient, glossy: Vec3::ZERO };
        for (direction, illuminance) in self.lights.at(point) {
            let cos = normal.dot(direction);
            if cos <= 0.0 || face.dot(direction) <= 0.0 {
                continue;
            }
            lit.matte += illuminance * cos;
            if self.shading != Shading::Lambert {
                let half = (direction + view).normalize_or_zero();
                let n_dot_h = normal.dot(half).max(0.0);
                // x^n <= exp(-n (1 - x)): far from the highlight there is none.
                if finish.exponent * (1.0 - n_dot_h) > FAR_FROM_HIGHLIGHT {
                    continue;
                }
                let fresnel = finish.f0 + (Vec3::ONE - finish.f0) * (1.0 - view.dot(half)).clamp(0.0, 1.0).powi(5);
                let lobe = finish.scale * n_dot_h.powf(finish.exponent);
                lit.glossy += fresnel * illuminance * (lobe * cos);
            }
        }
        lit
    }
}

fn finish(surface: &Surface, glow: f32) -> Finish {
    let m = &surface.material;
    let base = Vec3::from(m.base_color);
    let dielectric = ((m.ior - 1.0) / (m.ior + 1.0)).powi(2);
    // The exponent whose lobe is as wide as GGX of this roughness: 2 / alpha2 - 2. Mirrors are blurred to what a pixel
    // can still show.
    let alpha2 = m.roughness.max(0.1).powi(4);
    let exponent = (2.0 / alpha2 - 2.0).max(0.0);
    Finish {
        base,
        matte: (1.0 - m.metallic) * (1.0 - m.transmission * (1.0 - GLASS_BODY)) * (1.0 - dielectric),
        f0: Vec3::splat(dielectric).lerp(base, m.metallic),
        exponent,
        // Normalised Blinn-Phong (Akenine-Moller, Real-Time Rendering, section 9.8): (n + 8) / 8 pi.
        scale: (exponent + 8.0) / (8.0 * PI),
        glow: Vec3::from(m.emission_cd_m2) * glow,
    }
}

fn nearest_texel(texture: &Texture, uv: Vec2) -> Option<[u8; 3]> {
    let wrapped = uv - uv.floor();
    let at = |part: f32, count: u32| ((part * count as f32) as u32).min(count.saturating_sub(1)) as usize;
    let (x, y) = (at(wrapped.x, texture.width), at(1.0 - wrapped.y, texture.height));
    texture.rgb.get(y * texture.width as usize + x).copied()
}
