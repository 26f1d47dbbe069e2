//! The mesh cache: vertex and index buffers, uploaded once and kept while in use.

use super::clusters::{Cluster, Clustered};
use super::strands::GpuStrands;
use crate::scene::{Assets, Mesh, MeshPart, PieceShape, Room, Shape, room_mesh, tessellate};
use bytemuck::{Pod, Zeroable};
use eframe::wgpu::{self, util::DeviceExt as _};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// Number of frames after which an unused mesh is dropped.
const KEPT_FRAMES: u64 = 300;

/// A vertex; twin of the vertex input in `geometry.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Vertex {
    position: [f32; 3],
    /// Zero selects the geometric normal.
    normal: [f32; 3],
    uv: [f32; 2],
    /// Factor of the base colour, 255 for 1.
    color: [u8; 4],
    second_uv: [f32; 2],
}

/// Layout of the vertex buffer.
pub(crate) const VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Unorm8x4, 4 => Float32x2
    ],
};

/// The mesh of an emitter that is visible to the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum EmitterSurface {
    /// Square from -1 to 1 in XY, facing -Z.
    Square,
    /// Unit disc in XY, facing -Z.
    Disc,
    /// Unit sphere.
    Sphere,
}

/// The identity of a mesh: the address of shared triangles, or the parameters of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MeshKey {
    Shared(usize),
    Parametric(u8, [u32; 4]),
    Room([u32; 3]),
    Emitter(EmitterSurface),
    Body([u32; 8]),
}

/// A mesh on the GPU.
#[derive(Debug)]
pub(crate) struct GpuMesh {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub parts: Vec<MeshPart>,
    pub strands: Option<GpuStrands>,
    /// Clusters of all triangles, in index order.
    clusters: Vec<Cluster>,
    /// Corners in object space.
    pub bounds: (Vec3, Vec3),
    last_used: u64,
    /// Keeps the mesh alive, so that the address in the key stays unique.
    _source: Option<Arc<Mesh>>,
}

impl GpuMesh {
    /// Returns the clusters of a part with this index range.
    pub fn clusters(&self, indices: &std::ops::Range<u32>) -> &[Cluster] {
        let cluster_at = |index: u32| self.clusters.partition_point(|cluster| cluster.indices.start < index);
        &self.clusters[cluster_at(indices.start)..cluster_at(indices.end)]
    }
}

/// All meshes on the GPU.
#[derive(Debug, Default)]
pub(crate) struct MeshCache {
    meshes: HashMap<MeshKey, GpuMesh>,
    frame: u64,
}

impl MeshCache {
    /// Begins a frame and drops meshes that have been unused for long.
    pub fn begin_frame(&mut self) {
        self.frame += 1;
        let frame = self.frame;
        // Nobody can ask any more for a mesh that only the cache holds: a figure or water as it was before
        let is_gone = |mesh: &GpuMesh| mesh._source.as_ref().is_some_and(|source| Arc::strong_count(source) == 1);
        self.meshes.retain(|_, mesh| {
            let unused = frame - mesh.last_used;
            unused <= KEPT_FRAMES && (unused <= 1 || !is_gone(mesh))
        });
    }

    /// Returns the mesh of a key.
    pub fn get(&self, key: MeshKey) -> Option<&GpuMesh> {
        self.meshes.get(&key)
    }

    /// Returns the key of a shape's mesh, uploading it on first use; none if it has no triangles.
    pub fn object(&mut self, device: &wgpu::Device, shape: &Shape, assets: &Assets) -> Option<MeshKey> {
        if let Some(key) = parametric_key(shape) {
            return self.ensure(device, key, || tessellate(shape));
        }
        let shared = assets.coarse_mesh_of(shape)?;
        let key = MeshKey::Shared(Arc::as_ptr(&shared) as usize);
        self.ensure(device, key, || Some(Mesh::clone(&shared)))?;
        if let Some(mesh) = self.meshes.get_mut(&key) {
            mesh._source = Some(shared);
        }
        Some(key)
    }

    /// Returns the key of the room's mesh, uploading it on first use.
    pub fn room(&mut self, device: &wgpu::Device, room: &Room) -> Option<MeshKey> {
        let key = MeshKey::Room(room.size_m.to_array().map(f32::to_bits));
        self.ensure(device, key, || Some(room_mesh(room)))
    }

    /// Returns the key of an emitter's mesh, uploading it on first use.
    pub fn emitter(&mut self, device: &wgpu::Device, surface: EmitterSurface) -> Option<MeshKey> {
        self.ensure(device, MeshKey::Emitter(surface), || emitter_mesh(surface))
    }

    /// Returns the key of the mesh of a piece of a light's body, uploading it on first use.
    pub fn body(&mut self, device: &wgpu::Device, piece: &PieceShape) -> Option<MeshKey> {
        self.ensure(device, MeshKey::Body(piece.key()), || Some(piece.mesh()))
    }

    fn ensure(&mut self, device: &wgpu::Device, key: MeshKey, make: impl FnOnce() -> Option<Mesh>) -> Option<MeshKey> {
        if let Some(mesh) = self.meshes.get_mut(&key) {
            mesh.last_used = self.frame;
        } else {
            let mesh = upload(device, &make()?, self.frame)?;
            self.meshes.insert(key, mesh);
        }
        Some(key)
    }
}

fn parametric_key(shape: &Shape) -> Option<MeshKey> {
    let (tag, numbers) = match *shape {
        Shape::MeshFile { .. } | Shape::Figure(_) | Shape::Tank(_) => return None,
        Shape::Plane { width_m, depth_m } => (0, [width_m, depth_m, 0.0, 0.0]),
        Shape::Box { size_m } => (1, [size_m.x, size_m.y, size_m.z, 0.0]),
        Shape::Sphere { radius_m } => (2, [radius_m, 0.0, 0.0, 0.0]),
        Shape::Cylinder { radius_m, height_m } => (3, [radius_m, height_m, 0.0, 0.0]),
        Shape::Sweep { width_m, height_m, depth_m, radius_m } => (4, [width_m, height_m, depth_m, radius_m]),
        Shape::VFlat { wing_m, height_m, angle_deg } => (5, [wing_m, height_m, angle_deg, 0.0]),
        Shape::Prop(model) => (6, [f32::from(model as u8), 0.0, 0.0, 0.0]),
    };
    Some(MeshKey::Parametric(tag, numbers.map(f32::to_bits)))
}

/// Uploads a mesh; none if it has no triangles, an index out of range, or does not fit into a buffer.
fn upload(device: &wgpu::Device, mesh: &Mesh, frame: u64) -> Option<GpuMesh> {
    let count = mesh.positions.len();
    let in_range = mesh.triangles.iter().flatten().all(|&i| (i as usize) < count);
    let largest = device.limits().max_buffer_size as usize;
    let fits = count.max(mesh.triangles.len()) < largest / size_of::<Vertex>();
    if mesh.triangles.is_empty() || !in_range || !fits {
        return None;
    }
    let clustered = Clustered::new(mesh);
    let vertices: Vec<Vertex> = clustered
        .vertices
        .iter()
        .map(|&i| i as usize)
        .map(|i| Vertex {
            position: mesh.positions[i].into(),
            normal: mesh.normals.get(i).copied().unwrap_or(Vec3::ZERO).into(),
            uv: mesh.uvs.get(i).copied().unwrap_or(Vec2::ZERO).into(),
            color: mesh.colors.get(i).map_or([255; 4], |color| color.extend(1.0).to_array().map(unorm8)),
            second_uv: mesh.second_uvs.get(i).copied().unwrap_or(Vec2::ZERO).into(),
        })
        .collect();
    let buffer = |label, contents, usage| {
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    };
    let triangles = mesh.triangles.len() as u32;
    let inside = |part: &MeshPart| MeshPart {
        name: part.name.clone(),
        triangles: part.triangles.start.min(triangles)..part.triangles.end.min(triangles),
    };
    Some(GpuMesh {
        vertices: buffer("vertices", bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX),
        indices: buffer("indices", bytemuck::cast_slice(&clustered.triangles), wgpu::BufferUsages::INDEX),
        parts: mesh.parts.iter().map(inside).filter(|part| !part.triangles.is_empty()).collect(),
        strands: GpuStrands::upload(device, &mesh.strands),
        clusters: clustered.clusters,
        bounds: mesh.bounds(),
        last_used: frame,
        _source: None,
    })
}

/// Returns a number from 0 to 1 as a fraction of 255.
fn unorm8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn emitter_mesh(surface: EmitterSurface) -> Option<Mesh> {
    let flat = |outline: Vec<Vec3>| {
        let count = outline.len() as u32;
        Mesh {
            normals: vec![Vec3::NEG_Z; outline.len()],
            positions: outline,
            // A triangle fan, counter-clockwise as seen from -Z
            triangles: (1..count - 1).map(|i| [0, i + 1, i]).collect(),
            ..Mesh::default()
        }
    };
    let mesh = match surface {
        EmitterSurface::Square => {
            flat([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec())
        }
        EmitterSurface::Disc => {
            flat((0..96).map(|i| Vec2::from_angle(i as f32 / 96.0 * std::f32::consts::TAU).extend(0.0)).collect())
        }
        EmitterSurface::Sphere => return tessellate(&Shape::Sphere { radius_m: 1.0 }),
    };
    Some(mesh.with_single_part("emitter"))
}
