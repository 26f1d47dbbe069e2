//! The surfaces that rays of a kind pass or meet.

use super::geometry::PassedBodies;
use super::strand_detail::StrandUse;

/// What a ray passes, and which strands it meets.
#[derive(Clone, Copy, Debug, Default)]
pub struct RayFilter {
    /// The bodies of lights that it passes.
    pub passed: PassedBodies,
    /// The strands that it meets.
    pub strands: StrandUse,
}

impl RayFilter {
    /// For a ray from the camera, or from it by mirrors and glass.
    pub fn seen(passed: PassedBodies) -> Self {
        RayFilter { passed, strands: StrandUse::Seen }
    }

    /// For the ray of a camera path after so many vertices, and so many non-specular ones among them.
    #[inline(always)]
    pub fn of_path(depth: u32, non_specular_depth: u32) -> Self {
        let passed = if depth == 0 { PassedBodies::Hidden } else { PassedBodies::None };
        let strands = if non_specular_depth == 0 { StrandUse::Seen } else { StrandUse::Lighting };
        RayFilter { passed, strands }
    }

    /// For a shadow ray, or one that a surface scattered.
    pub fn lighting(passed: PassedBodies) -> Self {
        RayFilter { passed, strands: StrandUse::Lighting }
    }
}
