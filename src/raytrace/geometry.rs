//! Meshes prepared for tracing, their instances, and the surface interaction at a hit of a triangle.

use super::blas::Blas;
use super::bvh::TraversalStack;
use super::simd::{Kernels, SlabRay, TriangleHit};
use super::strand_detail::StrandView;
use super::strand_geometry::{StrandBlases, StrandGeometry};
use crate::math::{self, Ray, gamma};
use crate::scene::{LightId, Mesh};
use glam::{Affine2, Affine3A, Mat3A, Vec2, Vec3, Vec3A};
use std::sync::{Arc, OnceLock};

/// A mesh with its BLASes.
#[derive(Debug)]
pub struct MeshGeometry {
    mesh: Arc<Mesh>,
    /// Over all triangles, in object space.
    pub blas: Blas,
    /// The strands.
    pub strands: StrandGeometry,
    /// Part of each triangle; empty for meshes of one part.
    part_of_triangle: Vec<u16>,
    /// True if the mesh encloses a volume. Computed on first use, which is only for clear materials.
    closed: OnceLock<bool>,
}

impl MeshGeometry {
    /// Builds the BLASes over all triangles and strands.
    pub fn new(mesh: Arc<Mesh>) -> Self {
        // Parts of each build run on one thread: side by side they keep two busy
        let (blas, strands) =
            rayon::join(|| Blas::new(mesh.triangles.len(), |t| mesh.corners(t)), || StrandGeometry::new(&mesh.strands));
        let part_of_triangle = part_of_triangle(&mesh);
        MeshGeometry { mesh, blas, strands, part_of_triangle, closed: OnceLock::new() }
    }

    /// Returns the mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Returns true if the mesh encloses a volume.
    pub fn is_closed(&self) -> bool {
        *self.closed.get_or_init(|| self.mesh.is_closed())
    }

    /// Returns the index of the part that a triangle belongs to.
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

/// The light of an instance that is a part of its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyInstance {
    /// The light.
    pub light: LightId,
    /// True if camera rays pass it.
    pub is_hidden: bool,
}

/// The bodies of lights that a ray passes as if they were not there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PassedBodies {
    /// None.
    #[default]
    None,
    /// Those that are hidden from the camera.
    Hidden,
    /// That of a light: its own light passes it.
    Of(LightId),
    /// All.
    All,
}

impl PassedBodies {
    /// Returns true for an instance that the ray passes.
    #[inline(always)]
    fn contain(self, body: Option<BodyInstance>) -> bool {
        match (self, body) {
            (_, None) | (PassedBodies::None, Some(_)) => false,
            (PassedBodies::Hidden, Some(body)) => body.is_hidden,
            (PassedBodies::Of(light), Some(body)) => body.light == light,
            (PassedBodies::All, Some(_)) => true,
        }
    }
}

/// A mesh with a transform and materials. World positions in the ray tracer are relative to the camera, so that
/// precision near the camera does not depend on the distance from the origin.
#[derive(Debug)]
pub struct Instance {
    /// The mesh.
    pub geometry: Arc<MeshGeometry>,
    /// Index into the scene's objects; `u32::MAX` for the room.
    pub object: u32,
    /// Material of each part, as an index into the scene's material table: of the triangles' parts, then of the
    /// strands'.
    pub materials: Vec<u32>,
    /// True for a clear mesh that encloses no volume: a thin pane.
    pub is_thin: bool,
    /// The light that it is a part of: a modifier, a head or a stand.
    pub body: Option<BodyInstance>,
    world_from_object: Affine3A,
    object_from_world: Affine3A,
    /// Absolute values of both transforms, for error bounds.
    abs_world_from_object: Affine3A,
    abs_object_from_world: Affine3A,
    /// Inverse transpose, for normals.
    normal_matrix: Mat3A,
    /// Of the strands; none without any.
    strands: Option<StrandBlases>,
}

impl Instance {
    /// Returns an instance of a mesh, whose strands are thinned for a view; none for a singular transform (a scale of
    /// zero): no ray hits such an instance.
    pub fn new(
        geometry: Arc<MeshGeometry>,
        world_from_object: Affine3A,
        object: u32,
        materials: Vec<u32>,
        view: Option<&StrandView>,
    ) -> Option<Self> {
        let object_from_world = world_from_object.inverse();
        let normal_matrix = object_from_world.matrix3.transpose();
        let is_invertible = object_from_world.is_finite() && world_from_object.is_finite();
        let mut instance = is_invertible.then_some(Instance {
            geometry,
            object,
            materials,
            is_thin: false,
            body: None,
            world_from_object,
            object_from_world,
            abs_world_from_object: abs(&world_from_object),
            abs_object_from_world: abs(&object_from_world),
            normal_matrix,
            strands: None,
        })?;
        instance.thin_strands(view);
        Some(instance)
    }

    /// Chooses the levels of detail of the strands for a view; all strands without one.
    pub fn thin_strands(&mut self, view: Option<&StrandView>) {
        let strands = &self.geometry.mesh.strands;
        let Some(bounds) = self.strand_bounds() else { return };
        let levels = view.zip(self.geometry.strands.thinned_width_m());
        let levels = levels.map(|(view, width_m)| view.levels(bounds, width_m * self.largest_scale()));
        let levels = levels.unwrap_or_default();
        if self.strands.as_ref().is_none_or(|known| known.levels() != levels) {
            self.strands = Some(self.geometry.strands.blases(strands, levels));
        }
    }

    /// Returns the BLASes of its strands; none without any.
    pub fn strands(&self) -> Option<&StrandBlases> {
        self.strands.as_ref()
    }

    /// Returns the world bounding box of its strands at any level of detail; none without any.
    pub fn strand_bounds(&self) -> Option<(Vec3, Vec3)> {
        self.geometry.strands.bounds().map(|bounds| self.world_bounds(bounds))
    }

    /// Returns true if a ray that passes these bodies passes the instance.
    #[inline(always)]
    pub fn is_passed(&self, passed: PassedBodies) -> bool {
        passed.contain(self.body)
    }

    /// Returns the transform of the instance.
    pub fn world_from_object(&self) -> &Affine3A {
        &self.world_from_object
    }

    /// Returns the world bounding box of the corners of a bounding box in object space, rounded outwards.
    pub fn world_bounds(&self, (low, high): (Vec3, Vec3)) -> (Vec3, Vec3) {
        let centre = (low + high) * 0.5;
        let half = (high - low) * 0.5;
        let matrix = self.world_from_object.matrix3;
        let extent = Vec3::from(matrix.x_axis).abs() * half.x
            + Vec3::from(matrix.y_axis).abs() * half.y
            + Vec3::from(matrix.z_axis).abs() * half.z;
        let world_centre = self.world_from_object.transform_point3(centre);
        let slack = (world_centre.abs() + extent) * gamma(8);
        (world_centre - extent - slack, world_centre + extent + slack)
    }

    /// Returns the largest factor by which the transform scales the axes.
    pub(super) fn largest_scale(&self) -> f32 {
        let matrix = self.world_from_object.matrix3;
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        columns.into_iter().map(Vec3A::length_squared).fold(0.0, f32::max).sqrt()
    }

    /// Returns the corners of a triangle in world space.
    pub fn world_corners(&self, triangle: usize) -> [Vec3; 3] {
        self.geometry.mesh.corners(triangle).map(|corner| self.world_from_object.transform_point3(corner))
    }

    /// Transforms a ray to object space. Distances `t` stay the same.
    #[inline(always)]
    pub fn to_object(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_from_world.transform_point3(ray.origin),
            direction: self.object_from_world.transform_vector3(ray.direction),
            t_max: ray.t_max,
        }
    }

    /// Returns the closest hit of a ray with the triangles of this instance alone.
    #[inline(always)]
    pub fn intersect<K: Kernels>(&self, ray: &Ray, stack: &mut TraversalStack) -> Option<TriangleHit> {
        let local = self.to_object(ray);
        self.geometry.blas.intersect::<K>(&local, &SlabRay::new(local.origin, local.direction), stack)
    }

    /// Returns the surface interaction at a hit of a triangle, in world space.
    pub fn surface(&self, hit: &TriangleHit) -> SurfaceInteraction {
        // Interpolate the position
        let mesh = &*self.geometry.mesh;
        let indices = mesh.triangles[hit.triangle as usize].map(|i| i as usize);
        let corners = indices.map(|i| Vec3A::from(mesh.positions[i]));
        let [b1, b2] = hit.barycentric;
        let weights = [1.0 - b1 - b2, b1, b2];
        let terms = [corners[0] * weights[0], corners[1] * weights[1], corners[2] * weights[2]];
        let local = terms[0] + terms[1] + terms[2];
        // Bound its error (PBRT, 4th ed., section 6.8.5). Rays that start here subtract it from the corners: in a plane
        // of coordinate 0 the position is exact, but those differences are not
        let extent = corners.map(|corner| (corner - local).abs().max_element());
        let corner_error = extent[0].max(extent[1]).max(extent[2]) * gamma(16);
        let error = (terms[0].abs() + terms[1].abs() + terms[2].abs()) * gamma(7) + Vec3A::splat(corner_error);
        // Compute the geometric normal, and interpolate the shading normal
        let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let geometric_normal = (self.normal_matrix * face).normalize_or_zero();
        let (normal, smooth_offset) = if mesh.normals.is_empty() {
            (geometric_normal, Vec3A::ZERO)
        } else {
            let normals = indices.map(|i| Vec3A::from(mesh.normals[i]));
            let smooth = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
            let smooth = (self.normal_matrix * smooth).try_normalize().unwrap_or(geometric_normal);
            // The winding defines the outside, also for vertex normals on the other side.
            let smooth = if smooth.dot(geometric_normal) < 0.0 { -smooth } else { smooth };
            (smooth, smooth_surface_offset(local, corners, normals, weights))
        };
        // Interpolate the texture coordinates
        let interpolate = |values: &[Vec2]| {
            let [a, b, c] = indices.map(|i| values.get(i).copied().unwrap_or_default());
            a * weights[0] + b * weights[1] + c * weights[2]
        };
        let uv = interpolate(&mesh.uvs);
        let second_uv = if mesh.second_uvs.is_empty() { Vec2::ZERO } else { interpolate(&mesh.second_uvs) };
        // Interpolate the colour
        let color = if mesh.colors.is_empty() {
            Vec3::ONE
        } else {
            let colors = indices.map(|i| mesh.colors[i]);
            colors[0] * weights[0] + colors[1] * weights[1] + colors[2] * weights[2]
        };
        let part = self.geometry.part(hit.triangle);
        SurfaceInteraction {
            position: self.world_from_object.transform_point3a(local).into(),
            position_error: self.world_error(local, error).into(),
            smooth_offset: self.world_from_object.transform_vector3a(smooth_offset).into(),
            geometric_normal: geometric_normal.into(),
            normal: normal.into(),
            relief_normal: normal.into(),
            uv,
            second_uv,
            color,
            material: self.materials.get(part).copied().unwrap_or(0),
            is_thin: self.is_thin,
            tangent: Vec3::ZERO,
            strand: None,
        }
    }

    /// Returns the derivatives of the position on a triangle by the coordinates of a picture, world space, for the
    /// transform from the texture coordinates to those of the picture. Returns none where the texture has no area.
    pub fn position_derivatives(
        &self,
        triangle: u32,
        second_uvs: bool,
        picture_from_mesh: &Affine2,
    ) -> Option<[Vec3; 2]> {
        let mesh = self.geometry.mesh();
        let [a, b, c] = self.world_corners(triangle as usize);
        let uvs = if second_uvs { &mesh.second_uvs } else { &mesh.uvs };
        let corners = mesh.triangles[triangle as usize].map(|i| uvs.get(i as usize).copied().unwrap_or_default());
        let [uv_a, uv_b, uv_c] = corners.map(|uv| picture_from_mesh.transform_vector2(uv));
        math::position_derivatives([b - a, c - a], [uv_b - uv_a, uv_c - uv_a])
    }

    /// Returns the error bound of a transformed point, including that of the transform back to object space that a ray
    /// from there undergoes.
    pub(super) fn world_error(&self, local: Vec3A, local_error: Vec3A) -> Vec3A {
        let (forward, backward) = (&self.abs_world_from_object, &self.abs_object_from_world);
        let world = forward.transform_point3a(local.abs());
        let back = backward.transform_point3a(world) * gamma(4);
        forward.transform_vector3a(local_error + back) * (1.0 + gamma(3)) + world * gamma(4)
    }
}

/// Returns the transform with absolute values.
fn abs(transform: &Affine3A) -> Affine3A {
    Affine3A { matrix3: transform.matrix3.abs(), translation: transform.translation.abs() }
}

/// Returns the offset from the flat triangle to the smooth surface that its normals describe: the mean of the
/// projections onto the tangent planes at the corners (Hanika 2021, "Hacking the Shadow Terminator"). 0 on flat and
/// concave surfaces.
fn smooth_surface_offset(local: Vec3A, corners: [Vec3A; 3], normals: [Vec3A; 3], weights: [f32; 3]) -> Vec3A {
    let mut offset = Vec3A::ZERO;
    for k in 0..3 {
        let height = (local - corners[k]).dot(normals[k]).min(0.0);
        offset -= normals[k] * (height * weights[k]);
    }
    offset
}

/// The surface at a hit, in world space.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInteraction {
    /// Position on the flat triangle or ribbon.
    pub position: Vec3,
    /// Absolute error bound of `position` along each axis.
    pub position_error: Vec3,
    /// Offset to the smooth surface that the normals describe. Rays to the outside start there, which avoids the shadow
    /// terminator artefact.
    pub smooth_offset: Vec3,
    /// Unit normal of the triangle, on the side from which its corners are counter-clockwise.
    pub geometric_normal: Vec3,
    /// Interpolated shading normal, on the same side as `geometric_normal`.
    pub normal: Vec3,
    /// Normal of the diffuse lobe: that of the normal map, where `normal` is bent towards the viewer, and `normal`
    /// elsewhere.
    pub relief_normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Texture coordinates of the second set.
    pub second_uv: Vec2,
    /// Interpolated vertex colour, a factor of the base colour.
    pub color: Vec3,
    /// Index into the material table.
    pub material: u32,
    /// True for a clear mesh that encloses no volume: a thin pane. True for strands.
    pub is_thin: bool,
    /// Direction across the grooves of a brushed surface, world space, of any length; zero for others.
    pub tangent: Vec3,
    /// Position on the strand, for hits of strands.
    pub strand: Option<StrandCoordinates>,
}

/// The position on a strand, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandCoordinates {
    /// Unit direction of the strand towards its tip, interpolated between segments.
    pub tangent: Vec3,
    /// Offset across the width, -1 to 1, along N x T for the direction N towards the ray's origin.
    pub h: f32,
    /// Position along the strand: 0 at its root, 1 at its tip.
    pub u: f32,
}

impl SurfaceInteraction {
    /// Returns the shading normal on the side from which a ray of this direction comes.
    pub fn facing_normal(&self, direction: Vec3) -> Vec3 {
        if self.normal.dot(direction) > 0.0 { -self.normal } else { self.normal }
    }

    /// Returns the origin of a ray that passes the surface straight, as if it were not there.
    pub fn pass_origin(&self, direction: Vec3) -> Vec3 {
        math::offset_origin(self.position, self.position_error, self.geometric_normal, direction)
    }

    /// Returns the origin of a ray that leaves the surface in `direction`, offset by the error bound.
    pub fn spawn_origin(&self, direction: Vec3) -> Vec3 {
        let is_outwards = direction.dot(self.geometric_normal) > 0.0;
        let from = if is_outwards { self.position + self.smooth_offset } else { self.position };
        math::offset_origin(from, self.position_error, self.geometric_normal, direction)
    }
}
