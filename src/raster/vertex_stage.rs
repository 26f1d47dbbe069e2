//! The vertex stage: object space to camera-relative world space and to clip space.

use super::clip::{self, Outcode};
use super::gbuffer_row::VertexAttributes;
use super::geometry::{Chunk, MeshInstance, SceneGeometry};
use super::viewport::{ScreenVertex, Viewport};
use crate::scene::CameraFrame;
use glam::{Affine3A, Mat3, Mat4, Vec3, Vec3A, Vec4};
use rayon::prelude::*;

/// Distance of the near plane, metres.
const NEAR_M: f32 = 0.005;
/// Smallest number of vertices of a parallel task.
const TASK_VERTICES: usize = 4096;

/// The transformed vertices of an instance.
#[derive(Debug, Default)]
pub(super) struct VertexBuffer {
    pub positions: Vec<VertexPosition>,
    /// Position from the eye along the world's axes; normal of any length, zero where there is none; and texture
    /// coordinates.
    pub attributes: Vec<VertexAttributes>,
}

/// The transformed vertices of a chunk. Their memory is reused from chunk to chunk and from frame to frame.
#[derive(Debug, Default)]
pub(super) struct ChunkVertices {
    first_instance: usize,
    buffers: Vec<VertexBuffer>,
}

impl ChunkVertices {
    /// Returns the index in the chunk of an instance, by its index in the scene's geometry.
    #[inline(always)]
    pub fn index_of(&self, instance: usize) -> usize {
        instance - self.first_instance
    }

    /// Returns the vertices of an instance, by its index in the scene's geometry.
    #[inline(always)]
    pub fn of(&self, instance: usize) -> &VertexBuffer {
        &self.buffers[self.index_of(instance)]
    }
}

/// The position of a vertex after the vertex stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexPosition {
    pub clip: Vec4,
    /// Undefined outside the clip volume.
    pub screen: ScreenVertex,
    pub outcode: Outcode,
}

/// Transforms the vertices of a chunk's instances, for a camera.
pub(super) fn transform(
    geometry: &SceneGeometry,
    chunk: &Chunk,
    camera: &CameraFrame,
    viewport: Viewport,
    vertices: &mut ChunkVertices,
) {
    let eye = Vec3A::from(camera.position());
    let clip_from_relative = camera.clip_from_world(NEAR_M) * Mat4::from_translation(eye.into());
    let instances = &geometry.instances[chunk.instances.clone()];
    vertices.first_instance = chunk.instances.start;
    vertices.buffers.resize_with(instances.len(), VertexBuffer::default);
    for (instance, buffer) in instances.iter().zip(&mut vertices.buffers) {
        transform_instance(instance, eye, clip_from_relative, viewport, buffer);
    }
}

fn transform_instance(
    instance: &MeshInstance,
    eye: Vec3A,
    clip_from_relative: Mat4,
    viewport: Viewport,
    VertexBuffer { positions, attributes }: &mut VertexBuffer,
) {
    let (mesh, Affine3A { matrix3, translation }) = (&instance.mesh, instance.world_from_object);
    // World space relative to the eye
    let relative_from_object = Affine3A { matrix3, translation: translation - eye };
    let clip_from_object = clip_from_relative * Mat4::from(relative_from_object);
    let position = |point: &Vec3| {
        let clip = clip_from_object * point.extend(1.0);
        VertexPosition { clip, screen: viewport.screen_from_clip(clip), outcode: clip::outcode(clip) }
    };
    // Normals transform by the cofactor matrix, which exists for every scale
    let [x, y, z] = [0, 1, 2].map(|i| Vec3::from(matrix3.col(i)));
    let mirror = if x.dot(y.cross(z)) < 0.0 { -1.0 } else { 1.0 };
    let cofactors = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * mirror;
    let attribute = |i: usize| {
        let point = relative_from_object.transform_point3(mesh.positions[i]);
        let normal = mesh.normals.get(i).map_or(Vec3::ZERO, |normal| cofactors * *normal);
        let uv = mesh.uvs.get(i).copied().unwrap_or_default();
        [point.x, point.y, point.z, normal.x, normal.y, normal.z, uv.x, uv.y]
    };
    mesh.positions.par_iter().with_min_len(TASK_VERTICES).map(position).collect_into_vec(positions);
    let indices = (0..mesh.positions.len()).into_par_iter().with_min_len(TASK_VERTICES);
    indices.map(attribute).collect_into_vec(attributes);
}
