//! Shadow slots: the uniforms through which the mask shader reads a light's shadow maps.

use super::parts::MAX_PARTS;
use bytemuck::{Pod, Zeroable};

/// How a slot's map is projected; twin of the numbers in `shadow_mask.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Projection {
    Perspective = 1,
    Parallel = 2,
    Cube = 3,
}

/// ShadowView of a light or of a part of it; twin of `Slot` in `shadow_mask.wgsl`. All zero: no shadow.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadowSlot {
    pub position: [f32; 3],
    pub layer: u32,
    pub right: [f32; 3],
    pub kind: u32,
    pub up: [f32; 3],
    /// Depth is near over distance; in a parallel view the depth of the field, metres.
    pub near_m: f32,
    pub forward: [f32; 3],
    /// Distance of depth 0 in a parallel view, metres.
    pub far_m: f32,
    /// Corner and size of the field: tangents, or metres in a parallel view.
    pub low: [f32; 2],
    pub field: [f32; 2],
    pub softness: [f32; 2],
    pub unused: [f32; 2],
}

/// Four lights' views; twin of `Shadows` in `shadow_mask.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadows {
    /// Of each light, the parts in which it is taken.
    pub counts: [u32; 4],
    pub slots: [[GpuShadowSlot; MAX_PARTS]; 4],
}
