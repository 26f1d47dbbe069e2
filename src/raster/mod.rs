//! The software rasterizer: a z-buffer on the CPU, the first rung of the ladder and the preview without a GPU.
//!
//! World space -> camera-relative world space -> clip space -> screen space, in stages, each parallel over rayon:
//!
//! 1. [`vertex_stage`]: vertices of the mesh instances ([`geometry`]) to clip space;
//! 2. [`primitive_stage`]: clipping at the six planes ([`clip`]), the perspective division and viewport transform to
//!    1/256 of a pixel ([`viewport`]), triangle set-up ([`triangle`]) and tile binning ([`binning`]);
//! 3. [`tile`]: coverage by edge functions with the top-left rule ([`edge_function`]) and the depth test, then G-buffer
//!    rows ([`gbuffer_row`]) and one evaluation of the fragment shader per pixel ([`shade`], [`material`], [`lights`]).
//!
//! Inner loops are branch-free code for one pixel that runs eight pixels wide: see [`crate::math::simd`] and
//! [`approx`]. Pictures have the exposure and the scene-linear units of every other rung.
//!
//! Models visibility and direct light. Leaves out shadows, bounces and reflections other than that of a uniform
//! surround; panels shine from their centre, with a term that is exact on the axis of a disc at any distance; emitters
//! themselves are not drawn.

mod approx;
mod binning;
mod clip;
mod edge_function;
mod framebuffer;
mod gbuffer_row;
mod geometry;
mod lights;
mod material;
mod primitive_stage;
mod shade;
mod tile;
mod triangle;
mod vertex_stage;
mod viewport;

use crate::scene::{Assets, CameraFrame, Scene};
use binning::TriangleBatch;
pub use framebuffer::{Framebuffer, NO_OBJECT};
use geometry::SceneGeometry;
use lights::RasterLights;
use shade::FragmentShader;
pub use shade::Shading;
use vertex_stage::VertexBuffer;
use viewport::Viewport;

/// Draws a scene from a camera. A size of 0 counts as 1.
pub fn draw(scene: &Scene, assets: &Assets, camera: &CameraFrame, size: (u32, u32), shading: Shading) -> Framebuffer {
    let mut framebuffer = Framebuffer::default();
    Rasterizer::new(scene, assets).draw(scene, camera, size, shading, &mut framebuffer);
    framebuffer
}

/// The geometry of a scene, ready to be drawn from many cameras, and buffers that are reused from frame to frame.
#[derive(Debug)]
pub struct Rasterizer {
    geometry: SceneGeometry,
    vertices: Vec<VertexBuffer>,
    batches: Vec<TriangleBatch>,
}

impl Rasterizer {
    /// Collects the geometry of a scene.
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        Rasterizer { geometry: SceneGeometry::new(scene, assets), vertices: Vec::new(), batches: Vec::new() }
    }

    /// Returns the number of triangles, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.geometry.triangle_count()
    }

    /// Draws into a framebuffer of any earlier size. The scene's objects are those of [`Rasterizer::new`]; its lights
    /// and camera may have changed.
    pub fn draw(
        &mut self,
        scene: &Scene,
        camera: &CameraFrame,
        size: (u32, u32),
        shading: Shading,
        framebuffer: &mut Framebuffer,
    ) {
        let Rasterizer { geometry, vertices, batches } = self;
        let viewport = Viewport::new(size);
        framebuffer.resize(viewport);
        vertex_stage::transform(geometry, camera, viewport, vertices);
        primitive_stage::set_up(geometry, vertices, viewport, batches);
        let lights = RasterLights::new(scene, camera.position());
        let shader = FragmentShader::new(geometry, vertices, &lights, shading);
        tile::draw(viewport, batches, &shader, framebuffer);
    }
}
