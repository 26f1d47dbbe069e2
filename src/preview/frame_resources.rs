//! The resources that every pass of a frame reads.

use super::geometry::caches::GeometryCaches;
use super::targets::Targets;
use eframe::wgpu;

/// Borrowed resources of the frame that is being encoded.
#[derive(Clone, Copy)]
pub(crate) struct FrameResources<'a> {
    /// Bind group 0 of all pipelines: frame constants, surfaces, lights, light tiles.
    pub scene: &'a wgpu::BindGroup,
    pub targets: &'a Targets,
    pub caches: &'a GeometryCaches,
}
