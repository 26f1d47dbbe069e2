//! The software renderer: a z-buffer on the processor, the first rung of the ladder and the preview without an adapter.
//!
//! World -> clip space ([`world`]) -> inside the six planes ([`clip`]) -> sub-pixel screen positions and exact edges
//! ([`fill`]) -> one shading of each pixel that is left, eight at a time ([`shade`]), all parallel over rayon. Pictures
//! have the exposure and the scene-linear units of every other rung.
//!
//! Models visibility and direct light. Leaves out shadows, bounces and all reflections but an even surround's; panels
//! shine as from their middle, with a term that keeps a disc exact on its axis, however near; emitters themselves are
//! not drawn.

mod clip;
mod fill;
mod lights;
mod packet;
mod row;
mod shade;
mod world;

use crate::photo::Picture;
use crate::scene::{Assets, CameraFrame, Scene};
use fill::Screen;
use world::World;

/// How a pixel gets its light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Shading {
    /// Matte alone, with the interpolated normal.
    Lambert,
    /// Matte, and a highlight about the half vector (Blinn 1977) whose exponent follows the roughness.
    #[default]
    BlinnPhong,
    /// The same at the vertices, and colours interpolated (Gouraud 1971): highlights inside large triangles are missed.
    Gouraud,
    /// One colour a triangle, from its middle and its plane.
    Flat,
}

/// Mark of a pixel that shows no object: the room, or nothing.
pub const NO_OBJECT: u32 = u32::MAX;

/// A drawn picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Scene-linear.
    pub picture: Picture,
    /// Index of the object in the scene's list that each pixel shows, or [`NO_OBJECT`].
    pub objects: Vec<u32>,
    /// One over the distance along the camera's axis of what each pixel shows, 1/m; 0 where there is nothing.
    pub inverse_depths: Vec<f32>,
}

/// Draws what a camera sees of a studio. A size of 0 is taken as 1.
pub fn draw(scene: &Scene, assets: &Assets, camera: &CameraFrame, size: (u32, u32), shading: Shading) -> Drawing {
    Rasterizer::new(scene, assets).draw(scene, camera, size, shading)
}

/// A studio whose meshes are looked up once, to be drawn from many places.
#[derive(Debug)]
pub struct Rasterizer {
    world: World,
}

impl Rasterizer {
    /// Collects what stands in the studio.
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        Rasterizer { world: World::new(scene, assets) }
    }

    /// Triangles in the studio, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.world.triangle_count()
    }

    /// Draws what a camera sees. The scene is the one that this was made of; its lights and camera may have changed.
    pub fn draw(&self, scene: &Scene, camera: &CameraFrame, size: (u32, u32), shading: Shading) -> Drawing {
        let screen = Screen::new(size);
        let lights = lights::Lights::new(scene, camera.position());
        let vertices = self.world.transformed(camera, screen);
        let triangles = self.world.screen_triangles(&vertices, screen);
        let shader = shade::Shader::new(&self.world, &vertices, &lights, shading);
        fill::draw(screen, &triangles, &shader)
    }
}
