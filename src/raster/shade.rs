//! From rows of pixels that show triangles to light, eight pixels at a time: Lambert, Blinn and Phong, Gouraud, flat.

use super::Shading;
use super::fill::ScreenTriangle;
use super::lights::Lights;
use super::packet::{self, LANES, Vec3x8};
use super::row::{Row, Run};
use super::world::{Surface, Vertices, World};
use crate::color::srgb_decode;
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;
use wide::f32x8;

/// Part of a clear surface that is shown as if it were paint, so that glass can be seen.
const GLASS_BODY: f32 = 0.15;

/// Where a highlight has fallen to 1e-6 of its middle.
const FAR_FROM_HIGHLIGHT: f32 = 14.0;

/// A material as it is shaded here.
#[derive(Clone, Copy, Debug, Default)]
struct Finish {
    /// Luminance for each unit of light on the matte part.
    paint: Vec3,
    /// Reflectance at normal incidence.
    f0: Vec3,
    /// Exponent of the highlight, and what makes it keep its energy.
    exponent: f32,
    scale: f32,
    glow: Vec3,
}

/// The finishes of eight pixels.
struct Finishes {
    paint: Vec3x8,
    glow: Vec3x8,
    f0: Vec3x8,
    exponent: f32x8,
    scale: f32x8,
}

/// Light that leaves eight points: for each unit of their paint, and the rest.
struct Lit {
    matte: Vec3x8,
    glossy: Vec3x8,
}

/// What is known of eight points. The point counts from the eye; normals may have any length.
struct Points {
    point: Vec3x8,
    normal: Vec3x8,
    face: Vec3x8,
}

/// Shades pixels.
#[derive(Debug)]
pub(super) struct Shader<'a> {
    world: &'a World,
    vertices: &'a [Vertices],
    lights: &'a Lights,
    shading: Shading,
    /// One a surface, and one for where there is nothing: it only glows.
    finishes: Vec<Finish>,
    /// Matte and glossy light at the vertices of each mesh, for Gouraud's shading.
    at_vertices: Vec<Vec<[Vec3; 2]>>,
    /// sRGB bytes as linear light.
    linear: [f32; 256],
}

impl<'a> Shader<'a> {
    pub fn new(world: &'a World, vertices: &'a [Vertices], lights: &'a Lights, shading: Shading) -> Self {
        let mut finishes: Vec<Finish> = world.surfaces.iter().map(|surface| finish(surface, lights.glow)).collect();
        finishes.push(Finish { glow: lights.void_radiance, ..Finish::default() });
        let linear = std::array::from_fn(|i| srgb_decode(i as f32 / 255.0));
        let mut shader = Shader { world, vertices, lights, shading, finishes, at_vertices: Vec::new(), linear };
        if shading == Shading::Gouraud {
            shader.at_vertices = (0..world.placed.len()).map(|placed| shader.lit_vertices(placed)).collect();
        }
        shader
    }

    /// Light at each vertex of a mesh, by its normal and the material of the last triangle that has it.
    fn lit_vertices(&self, placed: usize) -> Vec<[Vec3; 2]> {
        let (mesh, vertices) = (&self.world.placed[placed].mesh, &self.vertices[placed]);
        let mut seen_as = vec![(self.nothing(), Vec3::ZERO); vertices.view.len()];
        for (part, surface) in mesh.parts.iter().zip(self.world.placed[placed].first_surface..) {
            for corners in mesh.triangles.get(part.triangles.start as usize..part.triangles.end as usize).unwrap_or(&[])
            {
                let [a, b, c] = corners.map(|i| vertices.view[i as usize]);
                let face = (b - a).cross(c - a);
                corners.iter().for_each(|&i| seen_as[i as usize] = (surface, face));
            }
        }
        let eight = |chunk: usize| {
            let at = |k: usize| (chunk * LANES + k).min(seen_as.len() - 1);
            let points = Points {
                point: Vec3x8::from_lanes(|k| vertices.view[at(k)]),
                normal: Vec3x8::from_lanes(|k| vertices.normals.get(at(k)).copied().unwrap_or(seen_as[at(k)].1)),
                face: Vec3x8::from_lanes(|k| seen_as[at(k)].1),
            };
            let surfaces: [u32; LANES] = std::array::from_fn(|k| seen_as[at(k)].0);
            let lit = self.lit(&self.finishes_of(&surfaces), &points);
            let (matte, glossy) = (lit.matte.lanes(), lit.glossy.lanes());
            (0..LANES.min(seen_as.len() - chunk * LANES)).map(move |k| [matte[k], glossy[k]])
        };
        (0..seen_as.len().div_ceil(LANES)).into_par_iter().flat_map_iter(eight).collect()
    }

    /// The surface of pixels that show nothing.
    pub fn nothing(&self) -> u32 {
        self.world.surfaces.len() as u32
    }

    /// The object that a triangle belongs to.
    pub fn object(&self, triangle: &ScreenTriangle) -> u32 {
        self.world.placed[triangle.placed as usize].object
    }

    /// Notes what a run of pixels shows of a triangle.
    pub fn show(&self, row: &mut Row, run: &Run, triangle: &ScreenTriangle) {
        let placed = triangle.placed as usize;
        let mesh = &self.world.placed[placed].mesh;
        let vertices = &self.vertices[placed];
        let corners = mesh.triangles[triangle.triangle as usize].map(|i| i as usize);
        let points = corners.map(|i| vertices.view[i]);
        let face = (points[1] - points[0]).cross(points[2] - points[0]);
        row.surface[run.pixels()].fill(triangle.surface);
        let [first, second] = match self.shading {
            Shading::Gouraud => {
                let light = corners.map(|i| self.at_vertices[placed][i]);
                [light.map(|[matte, _]| matte), light.map(|[_, glossy]| glossy)]
            }
            Shading::Flat => [[(points[0] + points[1] + points[2]) / 3.0; 3], [face; 3]],
            Shading::Lambert | Shading::BlinnPhong if vertices.normals.is_empty() => [points, [face; 3]],
            Shading::Lambert | Shading::BlinnPhong => [points, corners.map(|i| vertices.normals[i])],
        };
        row.blend(run, first, second);
        row.set_face(run, face);
        row.set_plain(run);
        if let Some(texture) = &self.world.surfaces[triangle.surface as usize].texture {
            let uvs = corners.map(|i| mesh.uvs.get(i).copied().unwrap_or(Vec2::ZERO));
            for x in run.pixels() {
                let w = run.weights(x);
                let at = uvs[0] * w.x + uvs[1] * w.y + uvs[2] * w.z;
                if let Some(rgb) = nearest_texel(texture, at) {
                    row.set_texel(x, rgb.map(|c| self.linear[usize::from(c)]).into());
                }
            }
        }
    }

    /// Scene-linear values of a row's pixels.
    pub fn pixels(&self, row: &Row, rgb: &mut [[f32; 3]]) {
        for (start, rgb) in (0..).step_by(LANES).zip(rgb.chunks_mut(LANES)) {
            let surfaces = &row.surface[start..start + LANES];
            let finishes = self.finishes_of(surfaces);
            let (first, second) = row.blended(start);
            let lit = if self.shading == Shading::Gouraud {
                Lit { matte: first, glossy: second }
            } else {
                self.lit(&finishes, &Points { point: first, normal: second, face: row.face(start) })
            };
            let painted = finishes.paint.tinted(row.texel(start)).tinted(lit.matte);
            let values = (painted + lit.glossy + finishes.glow).lanes();
            rgb.iter_mut().zip(values).for_each(|(rgb, value)| *rgb = value.into());
        }
    }

    /// The finishes of eight surfaces, which mostly are one.
    fn finishes_of(&self, surfaces: &[u32]) -> Finishes {
        let finish = |surface: u32| &self.finishes[surface as usize];
        if surfaces.iter().all(|surface| *surface == surfaces[0]) {
            let one = finish(surfaces[0]);
            return Finishes {
                paint: Vec3x8::splat(one.paint),
                glow: Vec3x8::splat(one.glow),
                f0: Vec3x8::splat(one.f0),
                exponent: f32x8::splat(one.exponent),
                scale: f32x8::splat(one.scale),
            };
        }
        let lanes: [&Finish; LANES] = std::array::from_fn(|k| finish(surfaces[k]));
        Finishes {
            paint: Vec3x8::from_lanes(|k| lanes[k].paint),
            glow: Vec3x8::from_lanes(|k| lanes[k].glow),
            f0: Vec3x8::from_lanes(|k| lanes[k].f0),
            exponent: f32x8::from(lanes.map(|finish| finish.exponent)),
            scale: f32x8::from(lanes.map(|finish| finish.scale)),
        }
    }

    fn lit(&self, finishes: &Finishes, points: &Points) -> Lit {
        let view = (-points.point).normalize_or_zero();
        // The side that is seen.
        let face = points.face.towards(view);
        let normal = points.normal.towards(face).normalize_or_zero();
        // An even surround: its mirror image is as bright everywhere.
        let surround = Vec3x8::splat(self.lights.ambient / PI);
        let mut lit = Lit { matte: Vec3x8::splat(self.lights.ambient), glossy: finishes.f0.tinted(surround) };
        for light in &self.lights.lights {
            let (direction, factor) = light.at(points.point);
            let cos = normal.dot(direction).fast_max(f32x8::ZERO);
            let received = face.dot(direction).simd_gt(f32x8::ZERO) & (factor * cos);
            if !received.simd_gt(f32x8::ZERO).any() {
                continue;
            }
            let strength = Vec3x8::splat(light.strength);
            lit.matte = lit.matte + strength.times(received);
            if self.shading != Shading::Lambert
                && let Some(reflected) = highlight(finishes, direction, view, normal)
            {
                lit.glossy = lit.glossy + strength.times(received).tinted(reflected);
            }
        }
        lit
    }
}

/// Blinn's lobe with Schlick's Fresnel term; none if all eight points lie far from the highlight.
fn highlight(finishes: &Finishes, direction: Vec3x8, view: Vec3x8, normal: Vec3x8) -> Option<Vec3x8> {
    // For unit vectors |d + v|2 = 2 + 2 d.v, and the half vector's cosines follow without the vector itself.
    let half = f32x8::splat(0.5);
    let squared = (f32x8::ONE + direction.dot(view)).fast_max(f32x8::splat(1e-12)) * f32x8::splat(2.0);
    let inverse = f32x8::ONE / squared.sqrt();
    let n_dot_h = (normal.dot(direction) + normal.dot(view)) * inverse;
    let n_dot_h = n_dot_h.fast_max(f32x8::splat(f32::MIN_POSITIVE)).fast_min(f32x8::ONE);
    let v_dot_h = half * squared * inverse;
    // x^n <= exp(-n (1 - x)): far from the highlight there is none.
    let near = (finishes.exponent * (f32x8::ONE - n_dot_h)).simd_lt(f32x8::splat(FAR_FROM_HIGHLIGHT));
    if !near.any() {
        return None;
    }
    let lobe = near & (finishes.scale * packet::power(n_dot_h, finishes.exponent));
    let grazing = (f32x8::ONE - v_dot_h).fast_max(f32x8::ZERO);
    let fifth = (grazing * grazing) * (grazing * grazing) * grazing;
    let white = Vec3x8::splat(Vec3::ONE);
    Some((finishes.f0 + (white - finishes.f0).times(fifth)).times(lobe))
}

fn finish(surface: &Surface, glow: f32) -> Finish {
    let m = &surface.material;
    let base = Vec3::from(m.base_color);
    let dielectric = ((m.ior - 1.0) / (m.ior + 1.0)).powi(2);
    // The exponent whose lobe is as wide as GGX of this roughness: 2 / alpha2 - 2. Mirrors are blurred to what a pixel
    // can still show.
    let alpha2 = m.roughness.max(0.1).powi(4);
    let exponent = (2.0 / alpha2 - 2.0).max(0.0);
    let matte = (1.0 - m.metallic) * (1.0 - m.transmission * (1.0 - GLASS_BODY)) * (1.0 - dielectric);
    Finish {
        paint: base * (matte / PI),
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
