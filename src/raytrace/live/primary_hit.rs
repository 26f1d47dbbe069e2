//! The surface at the end of a pixel's primary ray: what reprojection, upsampling and the edge-aware filter compare.

use glam::Vec3;

/// The primary hit of a pixel. Positions are relative to the tracer's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryHit {
    /// Position of the hit.
    pub position: Vec3,
    /// Unit shading normal, on the camera's side.
    pub normal: Vec3,
    /// Index into the scene's objects, `u32::MAX` for the room; [`PrimaryHit::MISS`], or unknown before the ray is
    /// traced.
    pub object: u32,
    /// Index into the material table.
    pub material: u32,
    /// GGX alpha of the surface: while the view turns by less, reflected radiance is about the same.
    /// [`PrimaryHit::VIEW_DEPENDENT`] where nothing can be reprojected: glass, emitters, misses, edges.
    pub alpha: f32,
    /// Texture value that multiplies the base colour.
    pub texture: Vec3,
}

impl PrimaryHit {
    /// The `object` of a pixel whose ray is not traced yet.
    const UNTRACED: u32 = u32::MAX - 2;
    /// The `object` of a ray that leaves the scene.
    pub const MISS: u32 = u32::MAX - 1;
    /// The `alpha` of pixels that are never reprojected.
    pub const VIEW_DEPENDENT: f32 = -1.0;

    const fn without_surface(object: u32) -> Self {
        let (position, normal, texture) = (Vec3::ZERO, Vec3::ZERO, Vec3::ONE);
        PrimaryHit { position, normal, object, material: 0, alpha: Self::VIEW_DEPENDENT, texture }
    }

    /// The value of pixels whose ray is not traced yet.
    pub const NONE_YET: Self = Self::without_surface(Self::UNTRACED);

    /// The value of rays that leave the scene.
    pub const BACKGROUND: Self = Self::without_surface(Self::MISS);

    /// Returns true if the primary ray has been traced.
    pub fn is_traced(&self) -> bool {
        self.object != Self::UNTRACED
    }

    /// Returns true if two pixels show the same smooth surface: object, material, normal and tangent plane agree.
    /// `depth_scale_m` is their distance from the eye; less where the lens is long.
    pub fn is_same_surface(&self, other: &PrimaryHit, depth_scale_m: f32) -> bool {
        const MIN_COSINE: f32 = 0.9;
        const MAX_PLANE_DISTANCE: f32 = 0.01;
        let plane_distance_m = (other.position - self.position).dot(self.normal).abs();
        let is_coplanar =
            self.normal.dot(other.normal) > MIN_COSINE && plane_distance_m < MAX_PLANE_DISTANCE * depth_scale_m;
        self.object == other.object && self.material == other.material && (self.object == Self::MISS || is_coplanar)
    }
}
