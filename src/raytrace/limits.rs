//! Path depths and split factors of each rendering method.

use super::plan::RenderPlan;
use super::settings::Method;

/// The limits of a path.
#[derive(Clone, Copy, Debug)]
pub struct PathLimits {
    /// Maximum number of scattering events at non-specular surfaces.
    pub max_non_specular_depth: u32,
    /// Maximum number of all scattering events.
    pub max_depth: u32,
    /// Paths that continue from the first non-specular surface; they share the path up to it.
    pub split_factor: u32,
}

/// Mirrors and glass faces that Whitted's method follows: enough to look through a bottle and back.
const WHITTED_DEPTH: u32 = 10;
/// Largest split factor of the direct method, whose paths from the first surface find emitters alone.
const DIRECT_SPLIT_FACTOR: u32 = 4;
/// Least specular depth of the direct method.
const DIRECT_DEPTH: u32 = 16;

impl PathLimits {
    /// Limits far beyond the depth at which Russian roulette ends paths.
    pub const UNTIL_ROULETTE: PathLimits =
        PathLimits { max_non_specular_depth: 4096, max_depth: 4096, split_factor: 1 };

    /// The limits of a method for a plan; `max_depth` overrides the plan's depth.
    pub fn new(method: Method, plan: &RenderPlan, max_depth: Option<u32>) -> Self {
        match method {
            Method::Whitted => {
                PathLimits { max_non_specular_depth: 1, max_depth: max_depth.unwrap_or(WHITTED_DEPTH), split_factor: 1 }
            }
            Method::Direct => PathLimits {
                max_non_specular_depth: 1,
                max_depth: max_depth.unwrap_or(plan.max_depth.max(DIRECT_DEPTH)),
                // Without emitters to hit nothing is found beyond the first surface.
                split_factor: if plan.has_area_emitters { plan.split_factor.min(DIRECT_SPLIT_FACTOR) } else { 1 },
            },
            Method::Path => {
                let depth = max_depth.unwrap_or(plan.max_depth);
                PathLimits { max_non_specular_depth: depth, max_depth: depth, split_factor: plan.split_factor }
            }
        }
    }
}
