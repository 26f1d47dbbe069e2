//! The geometry of a scene: mesh instances, their surfaces, and batches of triangles.

use super::binning::BATCH_TRIANGLES;
use super::framebuffer::NO_OBJECT;
use super::surface_texture::SurfaceTexture;
use super::triangle::PrimitiveState;
use crate::scene::{Alpha, Assets, Material, Mesh, Scene, TextureSlot, body_material, room_mesh, strand_ribbons};
use glam::Affine3A;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Depth bias of the room: paper that lies on its floor is drawn over it.
const ROOM_DEPTH_FACTOR: f32 = 1.0 - 1e-4;

/// Number of strands of a mesh that are drawn, as ribbons that are wider for those left out.
const MAX_RIBBONS: usize = 2000;

/// An instance of a mesh.
#[derive(Debug)]
pub(super) struct MeshInstance {
    pub mesh: Arc<Mesh>,
    pub world_from_object: Affine3A,
    /// Index among the scene's objects, or [`NO_OBJECT`].
    pub object: u32,
    /// The surface of its first part.
    pub first_surface: u32,
    pub state: PrimitiveState,
    /// Its batches.
    batches: Range<usize>,
}

/// Consecutive instances that are drawn together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub instances: Range<usize>,
    pub batches: Range<usize>,
}

/// A part of an instance with its material and texture.
#[derive(Debug)]
pub(super) struct Surface {
    /// Index among the instances.
    pub instance: u32,
    pub material: Material,
    /// By slot.
    pub textures: [Option<SurfaceTexture>; TextureSlot::COUNT],
}

impl Surface {
    /// Returns true if the surface has a texture.
    pub fn is_textured(&self) -> bool {
        self.textures.iter().any(Option::is_some)
    }

    /// Returns true if the surface is masked or blended.
    pub fn has_holes(&self) -> bool {
        self.material.alpha != Alpha::Opaque && self.material.transmission <= 0.0
    }
}

/// The triangles of a batch: consecutive in a mesh, all of one surface.
#[derive(Clone, Debug)]
pub(super) struct BatchTriangles {
    pub surface: u32,
    pub triangles: Range<usize>,
}

/// The meshes and materials of a scene.
#[derive(Debug, Default)]
pub(super) struct SceneGeometry {
    pub instances: Vec<MeshInstance>,
    pub surfaces: Vec<Surface>,
    /// All triangles, in scene order.
    pub batches: Vec<BatchTriangles>,
}

impl SceneGeometry {
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        let mut geometry = SceneGeometry::default();
        if let Some(room) = &scene.room {
            let state = PrimitiveState { cull_back_faces: true, depth_factor: ROOM_DEPTH_FACTOR };
            let material = |part: &str| room.material_of(part).clone();
            geometry.add(Arc::new(room_mesh(room)), Affine3A::IDENTITY, NO_OBJECT, state, assets, material);
        }
        // Objects share the ribbons of a mesh as they share the mesh
        let mut known_ribbons: HashMap<*const Mesh, Arc<Mesh>> = HashMap::new();
        for (index, object) in (0..).zip(&scene.objects) {
            let world_from_object = object.transform.world_from_object();
            let Some(mesh) =
                assets.coarse_mesh_of(&object.shape).filter(|_| object.visible && world_from_object.is_finite())
            else {
                continue;
            };
            let state = PrimitiveState { cull_back_faces: false, depth_factor: 1.0 };
            let material = |part: &str| object.untraced_material_of(part).into_owned();
            if !mesh.strands.is_empty() {
                let ribbons = known_ribbons.entry(Arc::as_ptr(&mesh));
                let ribbons = ribbons.or_insert_with(|| Arc::new(strand_ribbons(&mesh.strands, MAX_RIBBONS)));
                geometry.add(ribbons.clone(), world_from_object, index, state, assets, material);
            }
            geometry.add(mesh, world_from_object, index, state, assets, material);
        }
        geometry.add_bodies(scene, assets);
        geometry
    }

    /// Adds the bodies of lights that the camera sees.
    fn add_bodies(&mut self, scene: &Scene, assets: &Assets) {
        let state = PrimitiveState { cull_back_faces: true, depth_factor: 1.0 };
        for piece in scene.light_bodies().filter(|(_, body)| body.is_seen).flat_map(|(_, body)| body.pieces()) {
            self.add(Arc::new(piece.shape.mesh()), piece.world_from_piece, NO_OBJECT, state, assets, body_material);
        }
    }

    fn add(
        &mut self,
        mesh: Arc<Mesh>,
        world_from_object: Affine3A,
        object: u32,
        state: PrimitiveState,
        assets: &Assets,
        material: impl Fn(&str) -> Material,
    ) {
        let first_surface = self.surfaces.len() as u32;
        let first_batch = self.batches.len();
        for part in &mesh.parts {
            let material = material(&part.name);
            let textures = material.textures.look_up(|slot, texture| {
                Some(SurfaceTexture::new(assets.texture(texture)?, slot, material.textures.placement(slot)))
            });
            let end = (part.triangles.end as usize).min(mesh.triangles.len());
            let starts = (part.triangles.start as usize..end).step_by(BATCH_TRIANGLES);
            let surface = self.surfaces.len() as u32;
            self.batches.extend(starts.map(|first| {
                let triangles = first..(first + BATCH_TRIANGLES).min(end);
                BatchTriangles { surface, triangles }
            }));
            self.surfaces.push(Surface { instance: self.instances.len() as u32, material, textures });
        }
        let batches = first_batch..self.batches.len();
        self.instances.push(MeshInstance { mesh, world_from_object, object, first_surface, state, batches });
    }

    /// Returns true if some surface is masked or blended.
    pub fn has_holes(&self) -> bool {
        self.surfaces.iter().any(Surface::has_holes)
    }

    /// Returns the chunks in which the instances are drawn, in scene order. A chunk of several instances has at most
    /// `most_vertices`.
    pub fn chunks(&self, most_vertices: usize) -> Vec<Chunk> {
        let mut chunks: Vec<Chunk> = Vec::new();
        let mut vertices = 0;
        for (index, instance) in self.instances.iter().enumerate() {
            vertices += instance.mesh.positions.len();
            match chunks.last_mut().filter(|_| vertices <= most_vertices) {
                Some(chunk) => (chunk.instances.end, chunk.batches.end) = (index + 1, instance.batches.end),
                None => {
                    vertices = instance.mesh.positions.len();
                    chunks.push(Chunk { instances: index..index + 1, batches: instance.batches.clone() });
                }
            }
        }
        chunks
    }

    /// Returns the number of triangles, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|instance| instance.mesh.triangles.len() as u64).sum()
    }
}
