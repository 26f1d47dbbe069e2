//! The shading frame at a surface and the outgoing direction in it.

use crate::math::orthonormal_basis;
use glam::Vec3;

/// The shading frame and the outgoing direction. All normals are on the side of the outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct ShadingGeometry {
    tangent: Vec3,
    bitangent: Vec3,
    /// Shading normal: +Z of the local frame.
    pub normal: Vec3,
    pub geometric_normal: Vec3,
    /// Outgoing direction, local frame.
    pub wo: Vec3,
    /// Outgoing direction, world space.
    pub wo_world: Vec3,
    /// 1 on the outer side of the surface, -1 on the inner one.
    side: f32,
}

impl ShadingGeometry {
    /// Returns the frame for an outgoing direction (unit, world space) and the outward normals of the surface.
    #[inline(always)]
    pub fn new(normal: Vec3, geometric_normal: Vec3, wo: Vec3) -> Self {
        let side = if wo.dot(geometric_normal) >= 0.0 { 1.0 } else { -1.0 };
        let geometric_normal = geometric_normal * side;
        // An interpolated normal that faces away from `wo` would shade the back side: use the geometric normal
        let normal = if normal.dot(wo) * side > 1e-4 { normal * side } else { geometric_normal };
        let (tangent, bitangent) = orthonormal_basis(normal);
        let wo_world = wo;
        let wo = Vec3::new(wo.dot(tangent), wo.dot(bitangent), wo.dot(normal).max(1e-6));
        ShadingGeometry { tangent, bitangent, normal, geometric_normal, wo, wo_world, side }
    }

    /// Returns the frame whose X axis is along this direction, world space, as far as the surface allows.
    pub fn with_tangent(self, tangent: Vec3) -> Self {
        let along = tangent - self.normal * tangent.dot(self.normal);
        let Some(tangent) = along.try_normalize() else { return self };
        let bitangent = self.normal.cross(tangent);
        let w = self.wo_world;
        let wo = Vec3::new(w.dot(tangent), w.dot(bitangent), self.wo.z);
        ShadingGeometry { tangent, bitangent, wo, ..self }
    }

    /// Returns the factor that brings an outward normal to the side of the outgoing direction: 1 or -1.
    pub fn side(&self) -> f32 {
        self.side
    }

    /// Transforms a local direction to world space.
    #[inline(always)]
    pub fn to_world(self, w: Vec3) -> Vec3 {
        self.tangent * w.x + self.bitangent * w.y + self.normal * w.z
    }

    /// Transforms a world direction to the local frame.
    #[inline(always)]
    pub fn to_local(self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.tangent), w.dot(self.bitangent), w.dot(self.normal))
    }

    /// Returns true if a world direction is on the side of the outgoing direction.
    #[inline(always)]
    pub fn is_above(&self, direction: Vec3) -> bool {
        direction.dot(self.geometric_normal) > 0.0
    }

    /// Returns the direction of specular reflection about the shading normal; about the geometric normal if it would be
    /// below the surface.
    pub fn specular_reflection(&self) -> Option<Vec3> {
        let about = |normal: Vec3| (2.0 * self.wo_world.dot(normal) * normal - self.wo_world).normalize_or_zero();
        let above = |direction: &Vec3| self.is_above(*direction);
        Some(about(self.normal)).filter(above).or(Some(about(self.geometric_normal)).filter(above))
    }
}
