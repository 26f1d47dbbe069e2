//! What rays of a kind meet: which bodies of lights they pass, and which level of detail of strands they meet.

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
    /// Returns the filter of a ray from the camera, directly or by mirrors and glass.
    pub fn seen(passed: PassedBodies) -> Self {
        RayFilter { passed, strands: StrandUse::Seen }
    }

    /// Returns the filter of a camera path's ray after so many vertices, and so many non-specular ones among them.
    #[inline(always)]
    pub fn of_path(depth: u32, non_specular_depth: u32) -> Self {
        let passed = if depth == 0 { PassedBodies::Hidden } else { PassedBodies::None };
        let strands = if non_specular_depth == 0 { StrandUse::Seen } else { StrandUse::Lighting };
        RayFilter { passed, strands }
    }

    /// Returns the filter of a shadow ray, or of one that a surface scattered.
    pub fn lighting(passed: PassedBodies) -> Self {
        RayFilter { passed, strands: StrandUse::Lighting }
    }
}
