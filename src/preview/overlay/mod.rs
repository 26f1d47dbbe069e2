//! What is drawn over the lit picture: light and camera gizmos, grid, selection outline.

pub mod gizmo;
pub mod overlay_pass;
