//! The fragment stage: shades rows of pixels with Lambert, Blinn-Phong, Gouraud or flat shading. Code for one pixel is
//! written in a plain loop over a row, which the compiler makes eight pixels wide.
#![expect(clippy::needless_range_loop, reason = "a pixel's index is the same in a dozen arrays")]

use super::gbuffer_row::{GBufferRow, PADDED_WIDTH, RowScalar, RowVec3, Span, VertexAttributes, WIDTH, splat};
use super::geometry::{Chunk, SceneGeometry, Surface};
use super::lights::{IncidentLight, RasterLights};
use super::material::{RowMaterials, ShadingMaterial, SpecularGeometry};
use super::surface_texture::{PixelFactors, linear_from_srgb};
use super::textured_triangle::TexturedTriangle;
use super::triangle::TriangleId;
use super::vertex_stage::ChunkVertices;
use crate::math::approx::max;
use crate::math::simd::{self, Avx2, SimdTask};
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use std::ops::Range;

/// The shading model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shading {
    /// Diffuse only, with the interpolated normal.
    Lambert,
    /// Diffuse, and a highlight around the half vector (Blinn 1977) whose exponent follows the roughness.
    #[default]
    BlinnPhong,
    /// Blinn-Phong at the vertices, with interpolated colours (Gouraud 1971): misses highlights inside large triangles.
    Gouraud,
    /// One colour per triangle, from its centroid and its plane.
    Flat,
}

/// Directions and cosines at the points that a row shows.
#[derive(Debug)]
struct ShadingPoints {
    /// Unit directions to the eye.
    view_dir: RowVec3,
    /// Unit shading normals, on the side of the eye.
    normal: RowVec3,
    /// Normals of the triangles' planes, of any length, on the side of the eye.
    geometric_normal: RowVec3,
    /// Cosine between shading normal and view direction.
    n_dot_v: RowScalar,
}

/// Reflected light: the irradiance for the diffuse lobe, and the radiance of the specular lobe.
#[derive(Debug)]
struct ReflectedLight {
    irradiance: RowVec3,
    specular: RowVec3,
}

/// Intermediate values of shading a row.
#[derive(Debug)]
pub(super) struct ShadingScratch {
    materials: RowMaterials,
    points: ShadingPoints,
    incident: IncidentLight,
    /// Cosine between the normals and the directions to a light.
    n_dot_l: RowScalar,
    /// The part of a light's strength that the points receive.
    received: RowScalar,
    reflected: ReflectedLight,
}

impl ShadingScratch {
    pub fn new() -> Self {
        let (vectors, scalars) = (RowVec3::ZERO, [0.0; PADDED_WIDTH]);
        ShadingScratch {
            materials: RowMaterials::ZERO,
            points: ShadingPoints { view_dir: vectors, normal: vectors, geometric_normal: vectors, n_dot_v: scalars },
            incident: IncidentLight::ZERO,
            n_dot_l: scalars,
            received: scalars,
            reflected: ReflectedLight { irradiance: vectors, specular: vectors },
        }
    }
}

/// The light and the surfaces of a frame.
#[derive(Debug)]
pub(super) struct FrameShading {
    lights: RasterLights,
    shading: Shading,
    /// Materials by surface.
    materials: Vec<ShadingMaterial>,
    /// Linear value of each sRGB byte.
    linear_from_srgb: [f32; 256],
    /// Some surface is masked or blended.
    has_holes: bool,
}

impl FrameShading {
    pub fn new(geometry: &SceneGeometry, lights: RasterLights, shading: Shading) -> Self {
        let material =
            |surface: &Surface| ShadingMaterial::new(&surface.material, &PixelFactors::ONE, lights.emission_scale);
        let materials = geometry.surfaces.iter().map(material).collect();
        let linear_from_srgb = linear_from_srgb();
        FrameShading { lights, shading, materials, linear_from_srgb, has_holes: geometry.has_holes() }
    }

    /// Returns the radiance of pixels that show no surface: that of a visible surround.
    pub fn background_radiance(&self) -> [f32; 3] {
        self.lights.background_radiance.into()
    }
}

/// The fragment shader of a chunk of a frame.
#[derive(Debug)]
pub(super) struct FragmentShader<'a> {
    frame: &'a FrameShading,
    geometry: &'a SceneGeometry,
    vertices: &'a ChunkVertices,
    /// For Gouraud shading, irradiance, specular radiance and texture coordinates of the vertices of each of the chunk's
    /// instances.
    lit_vertices: Vec<Vec<VertexAttributes>>,
}

impl<'a> FragmentShader<'a> {
    pub fn new(
        frame: &'a FrameShading,
        geometry: &'a SceneGeometry,
        chunk: &Chunk,
        vertices: &'a ChunkVertices,
    ) -> Self {
        let mut shader = FragmentShader { frame, geometry, vertices, lit_vertices: Vec::new() };
        if frame.shading == Shading::Gouraud {
            shader.lit_vertices = chunk.instances.clone().map(|i| shader.light_vertices(i)).collect();
        }
        shader
    }

    /// Computes the light at each vertex of an instance, with the material of the last triangle that uses it.
    fn light_vertices(&self, instance: usize) -> Vec<VertexAttributes> {
        let vertices = &self.vertices.of(instance).attributes;
        let instance = &self.geometry.instances[instance];
        let mesh = &instance.mesh;
        // Find a surface and a plane for each vertex
        let mut planes = vec![(self.background(), Vec3::ZERO); vertices.len()];
        for (part, surface) in mesh.parts.iter().zip(instance.first_surface..) {
            let range = part.triangles.start as usize..part.triangles.end as usize;
            for corners in mesh.triangles.get(range).unwrap_or(&[]) {
                let normal = geometric_normal(corners.map(|i| &vertices[i as usize]));
                corners.iter().for_each(|&i| planes[i as usize] = (surface, normal));
            }
        }
        // Shade the vertices in rows
        let mut lit = vertices.clone();
        let chunks = lit.par_chunks_mut(WIDTH).zip(planes.par_chunks(WIDTH));
        chunks.for_each(|(vertices, planes)| {
            simd::dispatch(VertexRowTask { shader: self, has_normals: !mesh.normals.is_empty(), vertices, planes });
        });
        lit
    }

    /// Returns the surface index of pixels that show nothing.
    pub fn background(&self) -> u32 {
        self.geometry.surfaces.len() as u32
    }

    /// Writes pixels that show nothing.
    #[inline(always)]
    pub fn write_background(&self, row: &mut GBufferRow, pixels: Range<usize>) {
        splat(&mut row.surface, &pixels, self.background());
    }

    /// Writes the attributes of a triangle's span, and returns its object index.
    #[inline(always)]
    pub fn write_span(&self, row: &mut GBufferRow, span: &Span, id: TriangleId) -> u32 {
        let surface = &self.geometry.surfaces[id.surface as usize];
        let instance = &self.geometry.instances[surface.instance as usize];
        let corners = instance.mesh.triangles[id.triangle as usize].map(|i| i as usize);
        let vertices = corners.map(|i| &self.vertices.of(surface.instance as usize).attributes[i]);
        let normal = geometric_normal(vertices);
        row.geometric_normal.splat(&span.pixels, normal);
        if !instance.mesh.colors.is_empty() {
            row.color.splat(&span.pixels, corners.map(|i| instance.mesh.colors[i]).iter().sum::<Vec3>() / 3.0);
        }
        match self.frame.shading {
            Shading::Gouraud => {
                let lit = &self.lit_vertices[self.vertices.index_of(surface.instance as usize)];
                row.interpolate(span, corners.map(|i| &lit[i]));
            }
            Shading::Lambert | Shading::BlinnPhong if !instance.mesh.normals.is_empty() => {
                row.interpolate(span, vertices);
            }
            Shading::Lambert | Shading::BlinnPhong => {
                row.interpolate(span, vertices);
                row.second.splat(&span.pixels, normal);
            }
            Shading::Flat => {
                row.interpolate(span, vertices);
                let centroid = vertices.map(position).iter().sum::<Vec3>() / 3.0;
                row.first.splat(&span.pixels, centroid);
                row.second.splat(&span.pixels, normal);
            }
        }
        splat(&mut row.surface, &span.pixels, id.surface);
        if surface.is_textured() {
            self.write_textures(row, span, TexturedTriangle::new(surface, &instance.mesh, corners), vertices);
        }
        instance.object
    }

    /// Writes what the textures of a triangle give to the pixels of a span: factors of the material, and normals.
    fn write_textures(
        &self,
        row: &mut GBufferRow,
        span: &Span,
        triangle: TexturedTriangle<'_>,
        vertices: [&VertexAttributes; 3],
    ) {
        let has_normals = matches!(self.frame.shading, Shading::Lambert | Shading::BlinnPhong);
        let dome = triangle.dome(vertices).filter(|_| has_normals);
        for i in span.pixels.clone() {
            let over_w = span.start + span.step * (i - span.pixels.start) as f32;
            if let Some(dome) = &dome {
                let (position, normal) = (row.first.at(i), row.second.at(i));
                let (factors, normal) = dome.seen(over_w, position, normal, &self.frame.linear_from_srgb);
                row.factors[i] = factors;
                row.second.set(i, normal);
                row.color.set(i, Vec3::ONE);
            } else {
                row.factors[i] = triangle.factors(triangle.uvs_at(over_w), &self.frame.linear_from_srgb);
            }
        }
        if has_normals && dome.is_none() {
            triangle.tilt_normals(span, vertices, |i, tilted| {
                row.second.set(i, tilted(row.first.at(i), row.second.at(i)));
            });
        }
    }

    /// Returns true if pixels show triangles with holes, which the fragment shader tests.
    pub fn has_holes(&self) -> bool {
        self.frame.has_holes
    }

    /// Returns a test of a triangle's pixels, by their barycentric coordinates over w and their place; none for a surface
    /// that is opaque.
    pub fn hole_test(&self, id: TriangleId) -> Option<impl Fn(Vec3, (usize, usize)) -> bool> {
        let surface = Some(&self.geometry.surfaces[id.surface as usize]).filter(|surface| surface.has_holes())?;
        let mesh = &self.geometry.instances[surface.instance as usize].mesh;
        let corners = mesh.triangles[id.triangle as usize].map(|i| i as usize);
        let triangle = TexturedTriangle::new(surface, mesh, corners);
        Some(move |over_w, pixel| triangle.is_there(over_w, pixel))
    }

    /// Computes the scene-linear values of a row's pixels.
    #[inline(always)]
    pub fn shade(&self, row: &GBufferRow, scratch: &mut ShadingScratch, rgb: &mut [[f32; 3]]) {
        // Look up materials and textures, surface by surface
        let materials = &mut scratch.materials;
        let mut any_surface = false;
        for (surface, pixels) in row.surfaces(rgb.len()) {
            if let Some(material) = self.frame.materials.get(surface as usize) {
                materials.set(&pixels, material);
                self.apply_textures(row, surface, pixels.clone(), materials);
                self.apply_colors(row, surface, pixels, &mut materials.diffuse);
                any_surface = true;
            }
        }
        if any_surface {
            self.shade_surfaces(row, scratch, rgb);
        }
    }

    #[inline(always)]
    fn shade_surfaces(&self, row: &GBufferRow, scratch: &mut ShadingScratch, rgb: &mut [[f32; 3]]) {
        if self.frame.shading == Shading::Gouraud {
            (scratch.reflected.irradiance, scratch.reflected.specular) = (row.first, row.second);
        } else {
            self.light(row, scratch);
        }
        let ShadingScratch { materials, reflected: ReflectedLight { irradiance, specular }, .. } = scratch;
        for i in 0..WIDTH {
            let radiance = materials.diffuse.at(i) * irradiance.at(i) + specular.at(i) + materials.emission.at(i);
            irradiance.set(i, radiance);
        }
        for (i, rgb) in rgb.iter_mut().enumerate() {
            *rgb = irradiance.at(i).into();
        }
    }

    /// Multiplies the diffuse BRDF of pixels by the vertex colours of their mesh.
    #[inline(always)]
    fn apply_colors(&self, row: &GBufferRow, surface: u32, pixels: Range<usize>, diffuse: &mut RowVec3) {
        let instance = self.geometry.surfaces[surface as usize].instance;
        if !self.geometry.instances[instance as usize].mesh.colors.is_empty() {
            pixels.for_each(|i| diffuse.set(i, diffuse.at(i) * row.color.at(i)));
        }
    }

    /// Sets the materials of pixels of a textured surface, each by what its textures give.
    #[inline(always)]
    fn apply_textures(&self, row: &GBufferRow, surface: u32, pixels: Range<usize>, materials: &mut RowMaterials) {
        let surface = &self.geometry.surfaces[surface as usize];
        if !surface.is_textured() {
            return;
        }
        for i in pixels {
            let scale = self.frame.lights.emission_scale;
            materials.set(&(i..i + 1), &ShadingMaterial::new(&surface.material, &row.factors[i], scale));
        }
    }

    /// Computes the reflected light of a row's points, whose normals may have any length and either side.
    #[inline(always)]
    fn light(&self, row: &GBufferRow, scratch: &mut ShadingScratch) {
        let ShadingScratch { materials, points, incident, n_dot_l, received, reflected } = scratch;
        points.orient(row);
        // Add the surround, whose mirror image has the same luminance everywhere
        reflected.irradiance.splat(&(0..WIDTH), self.frame.lights.ambient_irradiance);
        let surround = self.frame.lights.ambient_irradiance / PI;
        for i in 0..WIDTH {
            reflected.specular.set(i, materials.f0.at(i) * surround);
        }
        for light in &self.frame.lights.lights {
            // Compute the received part of the light's strength
            light.illuminate(&row.first, incident);
            let mut any = false;
            for i in 0..WIDTH {
                let light_dir = incident.direction.at(i);
                n_dot_l[i] = points.normal.at(i).dot(light_dir);
                // No light leaks through the triangle's plane from behind
                let before = points.geometric_normal.at(i).dot(light_dir) > 0.0;
                received[i] = if before { incident.factor[i] * max(n_dot_l[i], 0.0) } else { 0.0 };
                any |= received[i] > 0.0;
            }
            if !any {
                continue;
            }
            // Add the diffuse and the specular lobe
            for i in 0..WIDTH {
                reflected.irradiance.set(i, reflected.irradiance.at(i) + light.strength * received[i]);
            }
            if self.frame.shading != Shading::Lambert {
                let (light_dir, view_dir) = (&incident.direction, &points.view_dir);
                let geometry = SpecularGeometry { view_dir, light_dir, n_dot_v: &points.n_dot_v, n_dot_l };
                materials.add_specular(light.strength, received, geometry, &mut reflected.specular);
            }
        }
    }
}

impl ShadingPoints {
    /// Reads a row's points, with normals flipped to the side of the eye.
    #[inline(always)]
    fn orient(&mut self, row: &GBufferRow) {
        for i in 0..WIDTH {
            let view_dir = normalize_or_zero(-row.first.at(i));
            let geometric_normal = face_forward(row.geometric_normal.at(i), view_dir);
            let normal = normalize_or_zero(face_forward(row.second.at(i), geometric_normal));
            self.view_dir.set(i, view_dir);
            self.geometric_normal.set(i, geometric_normal);
            self.normal.set(i, normal);
            self.n_dot_v[i] = normal.dot(view_dir);
        }
    }
}

/// Returns the unit vector; zero where there is no direction.
#[inline(always)]
fn normalize_or_zero(v: Vec3) -> Vec3 {
    let squared = v.length_squared();
    v * if squared > 0.0 { 1.0 / squared.sqrt() } else { 0.0 }
}

/// Flips a vector that points away from `reference`.
#[inline(always)]
fn face_forward(v: Vec3, reference: Vec3) -> Vec3 {
    v * if v.dot(reference) < 0.0 { -1.0 } else { 1.0 }
}

/// The shading of vertices as if they were a row of pixels.
struct VertexRowTask<'a> {
    shader: &'a FragmentShader<'a>,
    has_normals: bool,
    /// Input: position and normal. Output: irradiance and specular radiance.
    vertices: &'a mut [VertexAttributes],
    /// Surface and geometric normal of one of the triangles around each vertex.
    planes: &'a [(u32, Vec3)],
}

impl SimdTask for VertexRowTask<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self, _: Option<Avx2>) {
        let (mut row, mut scratch) = (GBufferRow::new(self.shader.background()), ShadingScratch::new());
        for (i, (vertex, (surface, geometric_normal))) in self.vertices.iter().zip(self.planes).enumerate() {
            let [_, _, _, x, y, z, ..] = *vertex;
            row.first.set(i, position(vertex));
            row.second.set(i, if self.has_normals { Vec3::new(x, y, z) } else { *geometric_normal });
            row.geometric_normal.set(i, *geometric_normal);
            // A vertex of no triangle has no material.
            let material = self.shader.frame.materials.get(*surface as usize).copied().unwrap_or_default();
            scratch.materials.set(&(i..i + 1), &material);
        }
        self.shader.light(&row, &mut scratch);
        for (i, vertex) in self.vertices.iter_mut().enumerate() {
            let [a, b, c] = scratch.reflected.irradiance.at(i).into();
            let [d, e, f] = scratch.reflected.specular.at(i).into();
            let [.., u, v] = *vertex;
            *vertex = [a, b, c, d, e, f, u, v];
        }
    }
}

#[inline(always)]
fn position([x, y, z, ..]: &VertexAttributes) -> Vec3 {
    Vec3::new(*x, *y, *z)
}

/// Returns the normal of a triangle's plane, of any length.
#[inline(always)]
fn geometric_normal(vertices: [&VertexAttributes; 3]) -> Vec3 {
    let [a, b, c] = vertices.map(position);
    (b - a).cross(c - a)
}
