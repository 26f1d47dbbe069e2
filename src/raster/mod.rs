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
//! [`crate::math::approx`]. Pictures have the exposure and the scene-linear units of every other rung.
//!
//! Models visibility and direct light. Leaves out shadows, bounces and reflections other than that of a uniform
//! surround; panels shine from their centre, with a term that is exact on the axis of a disc at any distance; emitters
//! themselves are not drawn.

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
mod surface_texture;
mod textured_triangle;
mod tile;
mod triangle;
mod vertex_stage;
mod viewport;

use crate::scene::{Assets, CameraFrame, Scene};
use binning::TriangleBatch;
pub use framebuffer::{Framebuffer, NO_OBJECT};
use geometry::SceneGeometry;
use lights::RasterLights;
pub use shade::Shading;
use shade::{FragmentShader, FrameShading};
use vertex_stage::ChunkVertices;
use viewport::Viewport;

/// Most vertices of the instances that are drawn together, if they are more than one: what bounds the memory of a frame.
const CHUNK_VERTICES: usize = 1 << 20;

/// Draws a scene from a camera. A size of 0 counts as 1.
pub fn draw(scene: &Scene, assets: &Assets, camera: &CameraFrame, size: (u32, u32), shading: Shading) -> Framebuffer {
    let mut framebuffer = Framebuffer::default();
    Rasterizer::new(scene, assets).draw(scene, assets, camera, size, shading, &mut framebuffer);
    framebuffer
}

/// The geometry of a scene, ready to be drawn from many cameras, and buffers that are reused from frame to frame.
#[derive(Debug)]
pub struct Rasterizer {
    geometry: SceneGeometry,
    vertices: ChunkVertices,
    batches: Vec<TriangleBatch>,
}

impl Rasterizer {
    /// Collects the geometry of a scene.
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        Rasterizer {
            geometry: SceneGeometry::new(scene, assets),
            vertices: ChunkVertices::default(),
            batches: Vec::new(),
        }
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
        assets: &Assets,
        camera: &CameraFrame,
        size: (u32, u32),
        shading: Shading,
        framebuffer: &mut Framebuffer,
    ) {
        self.draw_chunks(CHUNK_VERTICES, (scene, assets, camera), size, shading, framebuffer);
    }

    fn draw_chunks(
        &mut self,
        most_vertices: usize,
        (scene, assets, camera): (&Scene, &Assets, &CameraFrame),
        size: (u32, u32),
        shading: Shading,
        framebuffer: &mut Framebuffer,
    ) {
        let Rasterizer { geometry, vertices, batches } = self;
        let viewport = Viewport::new(size);
        let frame = FrameShading::new(geometry, RasterLights::new(scene, assets, camera.position()), shading);
        framebuffer.clear(viewport, frame.background_radiance());
        // A chunk after the other, over what is nearer of those before
        for chunk in &geometry.chunks(most_vertices) {
            vertex_stage::transform(geometry, chunk, camera, viewport, vertices);
            primitive_stage::set_up(geometry, chunk, vertices, viewport, batches);
            let shader = FragmentShader::new(&frame, geometry, chunk, vertices);
            tile::draw(viewport, batches, &shader, framebuffer);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::presets;
    use crate::scene::{Aim, Camera, Emitter, Light, Object, Output, Shape};
    use glam::Vec3;

    #[test]
    fn a_visible_surround_is_seen_where_there_is_no_surface() {
        let surround = Light { visible_to_camera: true, ..Light::new(Emitter::Surround, Output::Lux(1000.0)) };
        let ball = Object::new("Ball", Shape::Sphere { radius_m: 0.2 });
        let camera = Camera { position: Vec3::Z * 2.0, aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
        let scene = Scene { objects: vec![ball], lights: vec![surround], camera, ..Scene::default() };
        let drawn = draw(&scene, &Assets::default(), &scene.camera_frame(1.5), (60, 40), Shading::default());
        assert_ne!(drawn.objects[20 * 60 + 30], NO_OBJECT, "the ball");
        // Once per row that the ball crosses, and in a row that it does not.
        for corner in [0, 20 * 60] {
            assert_eq!(drawn.objects[corner], NO_OBJECT);
            let expected = RasterLights::new(&scene, &Assets::default(), Vec3::Z * 2.0).background_radiance;
            assert!(expected.min_element() > 0.0);
            assert_eq!(drawn.picture.rgb[corner], expected.to_array());
        }
    }

    #[test]
    fn a_large_scene_that_is_drawn_in_chunks_looks_as_in_one_piece() {
        let loaded =
            presets().iter().find(|preset| preset.file_name.starts_with("three_point")).unwrap().load().unwrap();
        let camera = loaded.scene.camera_frame(1.5);
        for shading in [Shading::BlinnPhong, Shading::Gouraud, Shading::Flat] {
            let frame = |most_vertices| {
                let mut framebuffer = Framebuffer::default();
                let mut rasterizer = Rasterizer::new(&loaded.scene, &loaded.assets);
                let seen = (&loaded.scene, &loaded.assets, &camera);
                rasterizer.draw_chunks(most_vertices, seen, (150, 100), shading, &mut framebuffer);
                (framebuffer, rasterizer.geometry.chunks(most_vertices).len())
            };
            let ((whole, one), (chunked, several)) = (frame(usize::MAX), frame(1000));
            assert_eq!(one, 1);
            assert!(several >= 3, "{several}");
            assert_eq!(chunked.objects, whole.objects);
            assert_eq!(chunked.inverse_depths, whole.inverse_depths);
            for (a, b) in chunked.picture.rgb.as_flattened().iter().zip(whole.picture.rgb.as_flattened()) {
                assert!((a - b).abs() <= 1e-3 * b.abs() + 1e-6, "{shading:?}: {a} {b}");
            }
        }
    }
}
