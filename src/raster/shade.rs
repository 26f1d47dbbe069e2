//! From rows of pixels that show triangles to light: Lambert, Blinn and Phong, Gouraud, flat. What is written for one
//! pixel stands in a plain loop over a row, which the compiler makes eight pixels wide.
#![expect(clippy::needless_range_loop, reason = "a pixel's place in a dozen arrays is its number")]

use super::Shading;
use super::lights::{Incident, Lights};
use super::row::{Attributes, Line, ROOM, Row, Run, Vectors, WIDTH, spread};
use super::series::{self, at_least, at_most};
use super::triangle::ScreenTriangle;
use super::world::{Surface, Vertices, World};
use crate::color::srgb_decode;
use crate::math::simd::{self, Avx2, SimdTask};
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;
use std::ops::Range;

/// Part of a clear surface that is shown as if it were paint, so that glass can be seen.
const GLASS_BODY: f32 = 0.15;

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

/// The finishes of a row's pixels.
#[derive(Debug)]
struct Finishes {
    paint: Vectors,
    f0: Vectors,
    exponent: Line,
    scale: Line,
    glow: Vectors,
}

/// What is known of the points that a row shows.
#[derive(Debug)]
struct Points {
    /// Unit directions to the eye, of the shaded surface and of the triangle's plane, on the side that is seen. Planes
    /// keep any length.
    view: Vectors,
    normal: Vectors,
    face: Vectors,
    /// Cosine between normal and view.
    n_dot_v: Line,
}

/// Light that leaves the points: for each unit of their paint, and the rest.
#[derive(Debug)]
struct Lit {
    matte: Vectors,
    glossy: Vectors,
}

/// Room to shade a row in.
#[derive(Debug)]
pub(super) struct Scratch {
    finishes: Finishes,
    points: Points,
    incident: Incident,
    /// Cosine between a row's normals and the directions to a light, and the part of its strength that they receive.
    n_dot_l: Line,
    received: Line,
    lit: Lit,
}

impl Scratch {
    pub fn new() -> Self {
        let (none, zero) = (Vectors::ZERO, [0.0; ROOM]);
        Scratch {
            finishes: Finishes { paint: none, f0: none, exponent: zero, scale: zero, glow: none },
            points: Points { view: none, normal: none, face: none, n_dot_v: zero },
            incident: Incident::NONE,
            n_dot_l: zero,
            received: zero,
            lit: Lit { matte: none, glossy: none },
        }
    }
}

/// Shades pixels.
#[derive(Debug)]
pub(super) struct Shader<'a> {
    world: &'a World,
    vertices: &'a [Vertices],
    lights: &'a Lights,
    shading: Shading,
    /// One a surface.
    finishes: Vec<Finish>,
    /// For Gouraud's shading, matte and glossy light and texture at the vertices of each mesh.
    lit_vertices: Vec<Vec<Attributes>>,
    /// sRGB bytes as linear light.
    linear: [f32; 256],
}

impl<'a> Shader<'a> {
    pub fn new(world: &'a World, vertices: &'a [Vertices], lights: &'a Lights, shading: Shading) -> Self {
        let finishes: Vec<Finish> = world.surfaces.iter().map(|surface| finish(surface, lights.glow)).collect();
        let linear = std::array::from_fn(|i| srgb_decode(i as f32 / 255.0));
        let mut shader = Shader { world, vertices, lights, shading, finishes, lit_vertices: Vec::new(), linear };
        if shading == Shading::Gouraud {
            shader.lit_vertices = (0..world.placed.len()).map(|placed| shader.light_vertices(placed)).collect();
        }
        shader
    }

    /// Light at each vertex of a mesh, by its normal and the material of the last triangle that has it.
    fn light_vertices(&self, placed: usize) -> Vec<Attributes> {
        let (mesh, vertices) = (&self.world.placed[placed].mesh, &self.vertices[placed].attributes);
        let mut seen_as = vec![(self.nothing(), Vec3::ZERO); vertices.len()];
        for (part, surface) in mesh.parts.iter().zip(self.world.placed[placed].first_surface..) {
            for corners in mesh.triangles.get(part.triangles.start as usize..part.triangles.end as usize).unwrap_or(&[])
            {
                let face = face(corners.map(|i| &vertices[i as usize]));
                corners.iter().for_each(|&i| seen_as[i as usize] = (surface, face));
            }
        }
        let mut lit = vertices.clone();
        let chunks = lit.par_chunks_mut(WIDTH).zip(seen_as.par_chunks(WIDTH));
        chunks.for_each(|(vertices, seen_as)| {
            simd::dispatch(VertexRow { shader: self, has_normals: !mesh.normals.is_empty(), vertices, seen_as });
        });
        lit
    }

    /// The surface of pixels that show nothing.
    pub fn nothing(&self) -> u32 {
        self.world.surfaces.len() as u32
    }

    /// Notes that a run of pixels shows nothing, and gives its object.
    #[inline(always)]
    pub fn show_nothing(&self, row: &mut Row, pixels: Range<usize>) -> u32 {
        spread(&mut row.surface, &pixels, self.nothing());
        super::NO_OBJECT
    }

    /// Notes what a run of pixels shows of a triangle, and gives its object.
    #[inline(always)]
    pub fn show(&self, row: &mut Row, run: &Run, triangle: &ScreenTriangle) -> u32 {
        let surface = &self.world.surfaces[triangle.surface as usize];
        let placed = &self.world.placed[surface.placed as usize];
        let corners = placed.mesh.triangles[triangle.triangle as usize].map(|i| i as usize);
        let vertices = corners.map(|i| &self.vertices[surface.placed as usize].attributes[i]);
        let face = face(vertices);
        row.face.spread(&run.pixels, face);
        match self.shading {
            Shading::Gouraud => row.blend(run, corners.map(|i| &self.lit_vertices[surface.placed as usize][i])),
            Shading::Lambert | Shading::BlinnPhong if !placed.mesh.normals.is_empty() => row.blend(run, vertices),
            Shading::Lambert | Shading::BlinnPhong => {
                row.blend(run, vertices);
                row.second.spread(&run.pixels, face);
            }
            Shading::Flat => {
                row.blend(run, vertices);
                let middle = vertices.map(point).iter().sum::<Vec3>() / 3.0;
                row.first.spread(&run.pixels, middle);
                row.second.spread(&run.pixels, face);
            }
        }
        spread(&mut row.surface, &run.pixels, triangle.surface);
        placed.object
    }

    /// Scene-linear values of a row's pixels.
    #[inline(always)]
    pub fn shade(&self, row: &Row, scratch: &mut Scratch, rgb: &mut [[f32; 3]]) {
        let finishes = &mut scratch.finishes;
        let mut anything = false;
        for (surface, pixels) in row.surfaces(rgb.len()) {
            if let Some(finish) = self.finishes.get(surface as usize) {
                finishes.set(&pixels, finish);
                self.paint_texture(row, surface, pixels, &mut finishes.paint);
                anything = true;
            }
        }
        if anything {
            self.shade_surfaces(row, scratch, rgb);
        }
        for (_, pixels) in row.surfaces(rgb.len()).filter(|(surface, _)| *surface == self.nothing()) {
            rgb[pixels].fill(self.lights.void_radiance.into());
        }
    }

    #[inline(always)]
    fn shade_surfaces(&self, row: &Row, scratch: &mut Scratch, rgb: &mut [[f32; 3]]) {
        if self.shading == Shading::Gouraud {
            (scratch.lit.matte, scratch.lit.glossy) = (row.first, row.second);
        } else {
            self.light(row, scratch);
        }
        let Scratch { finishes, lit, .. } = scratch;
        for i in 0..WIDTH {
            let light = finishes.paint.at(i) * lit.matte.at(i) + lit.glossy.at(i) + finishes.glow.at(i);
            lit.matte.set(i, light);
        }
        for (i, rgb) in rgb.iter_mut().enumerate() {
            *rgb = lit.matte.at(i).into();
        }
    }

    /// Multiplies the paint of a run of pixels by the texture of their surface.
    #[inline(always)]
    fn paint_texture(&self, row: &Row, surface: u32, pixels: Range<usize>, paint: &mut Vectors) {
        let Some(texture) = &self.world.surfaces[surface as usize].texture else { return };
        for i in pixels {
            if let Some(rgb) = nearest_texel(texture, Vec2::new(row.uv[0][i], row.uv[1][i])) {
                paint.set(i, paint.at(i) * Vec3::from(rgb.map(|c| self.linear[usize::from(c)])));
            }
        }
    }

    /// Light at a row's points, whose normals may have any length and either side.
    #[inline(always)]
    fn light(&self, row: &Row, scratch: &mut Scratch) {
        let Scratch { finishes, points, incident, n_dot_l, received, lit } = scratch;
        points.see(row);
        lit.matte.spread(&(0..WIDTH), self.lights.ambient);
        // An even surround: its mirror image is as bright everywhere.
        let surround = self.lights.ambient / PI;
        for i in 0..WIDTH {
            lit.glossy.set(i, finishes.f0.at(i) * surround);
        }
        for light in &self.lights.lights {
            light.reach(&row.first, incident);
            let mut any = false;
            for i in 0..WIDTH {
                let direction = incident.direction.at(i);
                n_dot_l[i] = points.normal.at(i).dot(direction);
                // What comes from behind the triangle's plane does not shine through it.
                let before = points.face.at(i).dot(direction) > 0.0;
                received[i] = if before { incident.factor[i] * at_least(n_dot_l[i], 0.0) } else { 0.0 };
                any |= received[i] > 0.0;
            }
            if !any {
                continue;
            }
            for i in 0..WIDTH {
                lit.matte.set(i, lit.matte.at(i) + light.strength * received[i]);
            }
            if self.shading != Shading::Lambert {
                let seen = (&*points, &incident.direction, &*n_dot_l);
                finishes.add_highlight(light.strength, received, seen, &mut lit.glossy);
            }
        }
    }
}

impl Points {
    /// Takes a row's, normals and planes turned to the side that is seen.
    #[inline(always)]
    fn see(&mut self, row: &Row) {
        for i in 0..WIDTH {
            let view = normalize_or_zero(-row.first.at(i));
            let face = towards(row.face.at(i), view);
            let normal = normalize_or_zero(towards(row.second.at(i), face));
            self.view.set(i, view);
            self.face.set(i, face);
            self.normal.set(i, normal);
            self.n_dot_v[i] = normal.dot(view);
        }
    }
}

/// A unit vector; zero where there is no direction.
#[inline(always)]
fn normalize_or_zero(v: Vec3) -> Vec3 {
    let squared = v.length_squared();
    v * if squared > 0.0 { 1.0 / squared.sqrt() } else { 0.0 }
}

/// Turned round where it points away from `other`.
#[inline(always)]
fn towards(v: Vec3, other: Vec3) -> Vec3 {
    v * if v.dot(other) < 0.0 { -1.0 } else { 1.0 }
}

impl Finishes {
    #[inline(always)]
    fn set(&mut self, pixels: &Range<usize>, finish: &Finish) {
        self.paint.spread(pixels, finish.paint);
        self.f0.spread(pixels, finish.f0);
        self.glow.spread(pixels, finish.glow);
        spread(&mut self.exponent, pixels, finish.exponent);
        spread(&mut self.scale, pixels, finish.scale);
    }

    /// Blinn's lobe with Schlick's Fresnel term. In three loops: the processor overlaps more pixels of short ones.
    #[inline(always)]
    fn add_highlight(
        &self,
        strength: Vec3,
        received: &Line,
        (points, directions, n_dot_l): (&Points, &Vectors, &Line),
        glossy: &mut Vectors,
    ) {
        let (mut n_dot_h_squared, mut grazing) = ([0.0; ROOM], [0.0; ROOM]);
        for i in 0..WIDTH {
            // For unit vectors |l + v|2 = 2 + 2 l.v, and the half vector's cosines follow without the vector itself.
            let squared = 2.0 * at_least(1.0 + directions.at(i).dot(points.view.at(i)), 1e-12);
            let cos = at_least(n_dot_l[i] + points.n_dot_v[i], 0.0);
            n_dot_h_squared[i] = at_most(at_least(cos * cos / squared, f32::MIN_POSITIVE), 1.0);
            grazing[i] = at_least(1.0 - 0.5 * squared.sqrt(), 0.0);
        }
        let mut lobe = [0.0; ROOM];
        for i in 0..WIDTH {
            lobe[i] = received[i] * self.scale[i] * series::power(n_dot_h_squared[i], 0.5 * self.exponent[i]);
        }
        for i in 0..WIDTH {
            let fifth = (grazing[i] * grazing[i]) * (grazing[i] * grazing[i]) * grazing[i];
            let f0 = self.f0.at(i);
            let reflected = (f0 + (Vec3::ONE - f0) * fifth) * lobe[i];
            glossy.set(i, glossy.at(i) + strength * reflected);
        }
    }
}

/// Vertices that are shaded as if they were a row of pixels.
struct VertexRow<'a> {
    shader: &'a Shader<'a>,
    has_normals: bool,
    /// Point and normal; then matte and glossy light.
    vertices: &'a mut [Attributes],
    /// Surface and plane of one of the triangles around.
    seen_as: &'a [(u32, Vec3)],
}

impl SimdTask for VertexRow<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let (mut row, mut scratch) = (Row::new(self.shader.nothing()), Scratch::new());
        for (i, (vertex, (surface, face))) in self.vertices.iter().zip(self.seen_as).enumerate() {
            let [_, _, _, x, y, z, ..] = *vertex;
            row.first.set(i, point(vertex));
            row.second.set(i, if self.has_normals { Vec3::new(x, y, z) } else { *face });
            row.face.set(i, *face);
            // A vertex of no triangle shows nothing.
            let finish = self.shader.finishes.get(*surface as usize).copied().unwrap_or_default();
            scratch.finishes.set(&(i..i + 1), &finish);
        }
        self.shader.light(&row, &mut scratch);
        for (i, vertex) in self.vertices.iter_mut().enumerate() {
            let ([a, b, c], [d, e, f]) = (scratch.lit.matte.at(i).into(), scratch.lit.glossy.at(i).into());
            let [.., u, v] = *vertex;
            *vertex = [a, b, c, d, e, f, u, v];
        }
    }
}

#[inline(always)]
fn point([x, y, z, ..]: &Attributes) -> Vec3 {
    Vec3::new(*x, *y, *z)
}

/// Normal of a triangle's plane.
#[inline(always)]
fn face(corners: [&Attributes; 3]) -> Vec3 {
    let [a, b, c] = corners.map(point);
    (b - a).cross(c - a)
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
