//! Shadow slots: the uniforms through which the mask shader reads a light's shadow maps.

use super::parts::MAX_PARTS;
use bytemuck::{Pod, Zeroable};

/// The projection of a shadow map; the values are repeated in `shadow_mask.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Projection {
    Perspective = 1,
    Parallel = 2,
    Cube = 3,
    /// The five faces of a cube before a panel, which shines forwards.
    PanelCube = 4,
}

/// The shadow map of a light or of a part of its emitter; twin of `Slot` in `shadow_mask.wgsl`. All zero: no shadow.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadowSlot {
    pub position: [f32; 3],
    pub layer: u32,
    pub right: [f32; 3],
    pub kind: u32,
    pub up: [f32; 3],
    /// Near distance, metres: depth is near over distance. In a parallel view, the depth range of the map.
    pub near_m: f32,
    pub forward: [f32; 3],
    /// Distance of depth 0 in a parallel view, metres.
    pub far_m: f32,
    /// Lower corner and size of the map in its image plane: tangents, or metres in a parallel view.
    pub low: [f32; 2],
    pub field: [f32; 2],
    /// Half axes of the emitter: metres, or tangents in a parallel view.
    pub softness: [f32; 2],
    pub unused: [f32; 2],
}

/// The slots of one mask, four lights; twin of `Shadows` in `shadow_mask.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadows {
    /// Number of emitter parts of each light.
    pub counts: [u32; 4],
    pub slots: [[GpuShadowSlot; MAX_PARTS]; 4],
}
