//! The overlay over the lit picture (light and camera gizmos, grid, selection outline) and picking.

pub mod gizmo;
pub mod overlay_pass;
pub mod pick;
pub mod pipelines;
