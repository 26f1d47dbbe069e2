//! The software renderer: a z-buffer on the processor, the first rung of the ladder and the preview without an adapter.
//!
//! A picture takes three steps, each parallel over rayon:
//!
//! 1. vertices go from their meshes into clip space ([`world`]);
//! 2. triangles are cut at the six planes ([`clip`]), placed on the screen in 1/256 of a pixel ([`triangle`]), and
//!    sorted by the tiles that they touch ([`batch`]);
//! 3. each tile finds the nearest triangle of every pixel ([`fill`]), collects what its rows show ([`row`]), and shades
//!    each pixel once ([`shade`], [`lights`]).
//!
//! The inner loops are written for one pixel and free of jumps: they run eight pixels wide, see [`crate::math::simd`].
//! Pictures have the exposure and the scene-linear units of every other rung.
//!
//! Models visibility and direct light. Leaves out shadows, bounces and all reflections but an even surround's; panels
//! shine as from their middle, with a term that keeps a disc exact on its axis, however near; emitters themselves are
//! not drawn.

mod batch;
mod clip;
mod fill;
mod lights;
mod row;
mod series;
mod shade;
mod triangle;
mod world;

use crate::photo::Picture;
use crate::scene::{Assets, CameraFrame, Scene};
use batch::Batch;
use triangle::Screen;
use world::{Vertices, World};

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
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Drawing {
    /// Scene-linear.
    pub picture: Picture,
    /// Index of the object in the scene's list that each pixel shows, or [`NO_OBJECT`].
    pub objects: Vec<u32>,
    /// One over the distance along the camera's axis of what each pixel shows, 1/m; 0 where there is nothing.
    pub inverse_depths: Vec<f32>,
}

impl Drawing {
    /// Takes a size; what it shows stays undefined until it is drawn.
    fn resize(&mut self, Screen { width, height }: Screen) {
        let pixels = width as usize * height as usize;
        (self.picture.width, self.picture.height) = (width, height);
        self.picture.rgb.resize(pixels, [0.0; 3]);
        self.objects.resize(pixels, NO_OBJECT);
        self.inverse_depths.resize(pixels, 0.0);
    }
}

/// Draws what a camera sees of a studio. A size of 0 is taken as 1.
pub fn draw(scene: &Scene, assets: &Assets, camera: &CameraFrame, size: (u32, u32), shading: Shading) -> Drawing {
    let mut drawing = Drawing::default();
    Rasterizer::new(scene, assets).draw(scene, camera, size, shading, &mut drawing);
    drawing
}

/// A studio whose meshes are looked up once, to be drawn from many places. Keeps its memory from one picture to the
/// next.
#[derive(Debug)]
pub struct Rasterizer {
    world: World,
    vertices: Vec<Vertices>,
    batches: Vec<Batch>,
}

impl Rasterizer {
    /// Collects what stands in the studio.
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        Rasterizer { world: World::new(scene, assets), vertices: Vec::new(), batches: Vec::new() }
    }

    /// Triangles in the studio, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.world.triangle_count()
    }

    /// Draws what a camera sees over an older drawing, of any size. The scene is the one that this was made of; its
    /// lights and camera may have changed.
    pub fn draw(
        &mut self,
        scene: &Scene,
        camera: &CameraFrame,
        size: (u32, u32),
        shading: Shading,
        drawing: &mut Drawing,
    ) {
        let Rasterizer { world, vertices, batches } = self;
        let screen = Screen::new(size);
        drawing.resize(screen);
        world.transform(camera, screen, vertices);
        world.set_up(vertices, screen, batches);
        let lights = lights::Lights::new(scene, camera.position());
        let shader = shade::Shader::new(world, vertices, &lights, shading);
        fill::draw(screen, batches, &shader, drawing);
    }
}
