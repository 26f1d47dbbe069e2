//! Meshes ready for tracing, their instances, and what a hit says about the surface.

use super::blas::Blas;
use super::simd::TriangleHit;
use crate::math::{self, Ray, gamma};
use crate::scene::Mesh;
use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec3A};
use std::sync::{Arc, OnceLock};

/// A mesh with its tree.
#[derive(Debug)]
pub struct MeshGeometry {
    mesh: Arc<Mesh>,
    /// In object space.
    pub blas: Blas,
    /// Part of each triangle; empty when there is just one.
    part_of_triangle: Vec<u16>,
    /// Whether the mesh encloses a space; looked at once, and only where something is clear.
    closed: OnceLock<bool>,
}

impl MeshGeometry {
    /// Builds the tree over all triangles.
    pub fn new(mesh: Arc<Mesh>) -> Self {
        let blas = Blas::new(mesh.triangles.len(), |t| mesh.corners(t));
        let part_of_triangle = part_of_triangle(&mesh);
        MeshGeometry { mesh, blas, part_of_triangle, closed: OnceLock::new() }
    }

    /// The mesh itself.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Whether the mesh encloses a space.
    pub fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| self.mesh.is_closed())
    }

    /// Index of the part that a triangle belongs to.
    pub fn part(&self, triangle: u32) -> usize {
        self.part_of_triangle.get(triangle as usize).copied().unwrap_or(0).into()
    }
}

fn part_of_triangle(mesh: &Mesh) -> Vec<u16> {
    if mesh.parts.len() < 2 {
        return Vec::new();
    }
    let mut parts = vec![0; mesh.triangles.len()];
    for (index, part) in mesh.parts.iter().enumerate() {
        let range = part.triangles.start as usize..(part.triangles.end as usize).min(parts.len());
        parts[range].fill(index.min(usize::from(u16::MAX)) as u16);
    }
    parts
}

/// A mesh placed in the studio. All world positions of the tracer are relative to the camera, so that a studio far from
/// the origin keeps its precision near the lens.
#[derive(Debug)]
pub struct Instance {
    /// The mesh.
    pub geometry: Arc<MeshGeometry>,
    /// Index into the scene's objects; `u32::MAX` for the room.
    pub object: u32,
    /// Material of each part, as an index into the scene's material table.
    pub materials: Vec<u32>,
    /// The mesh encloses no space: where it is clear, it is a thin pane.
    pub is_thin: bool,
    world_from_object: Affine3A,
    object_from_world: Affine3A,
    /// Both ways in absolute values, for error bounds.
    forward_abs: Affine3A,
    backward_abs: Affine3A,
    /// Inverse transpose, for normals.
    normal_matrix: Mat3A,
}

impl Instance {
    /// Places a mesh; none when the transform cannot be inverted (a scale of zero): such a thing has no volume and is
    /// not seen.
    pub fn new(
        geometry: Arc<MeshGeometry>,
        world_from_object: Affine3A,
        object: u32,
        materials: Vec<u32>,
    ) -> Option<Self> {
        let object_from_world = world_from_object.inverse();
        let normal_matrix = object_from_world.matrix3.transpose();
        let usable = object_from_world.is_finite() && world_from_object.is_finite();
        usable.then_some(Instance {
            geometry,
            object,
            materials,
            is_thin: false,
            world_from_object,
            object_from_world,
            forward_abs: abs(&world_from_object),
            backward_abs: abs(&object_from_world),
            normal_matrix,
        })
    }

    /// Where the mesh stands.
    pub fn world_from_object(&self) -> &Affine3A {
        &self.world_from_object
    }

    /// World box of the eight corners of the mesh's box, rounded outwards.
    pub fn world_bounds(&self) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.geometry.blas.bounds()?;
        let centre = (low + high) * 0.5;
        let half = (high - low) * 0.5;
        let matrix = self.world_from_object.matrix3;
        let reach = Vec3::from(matrix.x_axis).abs() * half.x
            + Vec3::from(matrix.y_axis).abs() * half.y
            + Vec3::from(matrix.z_axis).abs() * half.z;
        let middle = self.world_from_object.transform_point3(centre);
        let slack = (middle.abs() + reach) * gamma(8);
        Some((middle - reach - slack, middle + reach + slack))
    }

    /// The corners of a triangle in world space.
    pub fn world_corners(&self, triangle: usize) -> [Vec3; 3] {
        self.geometry.mesh.corners(triangle).map(|corner| self.world_from_object.transform_point3(corner))
    }

    /// The ray in object space. `t` keeps its meaning.
    #[inline(always)]
    pub fn to_object(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_from_world.transform_point3(ray.origin),
            direction: self.object_from_world.transform_vector3(ray.direction),
            t_max: ray.t_max,
        }
    }

    /// All about the surface at a hit, in world space.
    pub fn surface(&self, hit: &TriangleHit) -> SurfaceInteraction {
        let mesh = &*self.geometry.mesh;
        let indices = mesh.triangles[hit.triangle as usize].map(|i| i as usize);
        let corners = indices.map(|i| Vec3A::from(mesh.positions[i]));
        let [b1, b2] = hit.barycentric;
        let weights = [1.0 - b1 - b2, b1, b2];
        let terms = [corners[0] * weights[0], corners[1] * weights[1], corners[2] * weights[2]];
        let local = terms[0] + terms[1] + terms[2];
        // The distances of a ray that starts here come from differences to the corners: a triangle that lies in a plane
        // of coordinate 0 has an exact point on it, and would still be met again by rays that leave it.
        let reach = corners.map(|corner| (corner - local).abs().max_element());
        let reach = reach[0].max(reach[1]).max(reach[2]) * gamma(16);
        let error = (terms[0].abs() + terms[1].abs() + terms[2].abs()) * gamma(7) + Vec3A::splat(reach);
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let geometric_normal = (self.normal_matrix * face).normalize_or_zero();
        let (normal, bulge) = if mesh.normals.is_empty() {
            (geometric_normal, Vec3A::ZERO)
        } else {
            let normals = indices.map(|i| Vec3A::from(mesh.normals[i]));
            let smooth = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
            let smooth = (self.normal_matrix * smooth).try_normalize().unwrap_or(geometric_normal);
            // Normals that disagree with the winding: the winding says where outside is.
            let smooth = if smooth.dot(geometric_normal) < 0.0 { -smooth } else { smooth };
            (smooth, bulge(local, corners, normals, weights))
        };
        let uv = if mesh.uvs.is_empty() {
            Vec2::ZERO
        } else {
            let uvs = indices.map(|i| mesh.uvs[i]);
            uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2]
        };
        let part = self.geometry.part(hit.triangle);
        SurfaceInteraction {
            position: self.world_from_object.transform_point3a(local).into(),
            position_error: self.world_error(local, error).into(),
            smooth_offset: self.world_from_object.transform_vector3a(bulge).into(),
            geometric_normal: geometric_normal.into(),
            normal: normal.into(),
            uv,
            material: self.materials.get(part).copied().unwrap_or(0),
            is_thin: self.is_thin,
        }
    }

    /// Error of a transformed point, and of the way back that a ray from there will take into this same mesh.
    fn world_error(&self, local: Vec3A, local_error: Vec3A) -> Vec3A {
        let (forward, backward) = (&self.forward_abs, &self.backward_abs);
        let world = forward.transform_point3a(local.abs());
        let back = backward.transform_point3a(world) * gamma(4);
        forward.transform_vector3a(local_error + back) * (1.0 + gamma(3)) + world * gamma(4)
    }
}

/// The transform of absolute values.
fn abs(transform: &Affine3A) -> Affine3A {
    Affine3A { matrix3: transform.matrix3.abs(), translation: transform.translation.abs() }
}

/// From the flat triangle to the curved surface its normals describe: the mean of the projections onto the planes at
/// the corners (Hanika 2021, "Hacking the Shadow Terminator"). Zero on flat and on concave places.
fn bulge(local: Vec3A, corners: [Vec3A; 3], normals: [Vec3A; 3], weights: [f32; 3]) -> Vec3A {
    let mut offset = Vec3A::ZERO;
    for k in 0..3 {
        let height = (local - corners[k]).dot(normals[k]).min(0.0);
        offset -= normals[k] * (height * weights[k]);
    }
    offset
}

/// What a hit says about the surface, in world space.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// On the flat triangle.
    pub position: Vec3,
    /// Absolute error of `position`, an axis each.
    pub position_error: Vec3,
    /// From the flat triangle to the curved surface that the normals describe; rays towards the outside start there.
    pub smooth_offset: Vec3,
    /// Of the triangle, unit length, to the side from which its corners run counter-clockwise.
    pub geometric_normal: Vec3,
    /// Interpolated, on the same side as `geometric_normal`.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index into the material table.
    pub material: u32,
    /// Of a mesh that encloses no space.
    pub is_thin: bool,
}

impl SurfaceInteraction {
    /// Start of a ray that leaves in `direction`, off the surface by its error bound.
    pub fn spawn_origin(&self, direction: Vec3) -> Vec3 {
        let outside = direction.dot(self.geometric_normal) > 0.0;
        let from = if outside { self.position + self.smooth_offset } else { self.position };
        math::offset_origin(from, self.position_error, self.geometric_normal, direction)
    }
}
