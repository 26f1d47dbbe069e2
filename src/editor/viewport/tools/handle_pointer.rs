//! The pointer over the transform handles, and the steps of snapping.

use eframe::egui;

/// Snapping steps: metres, degrees, part of the scale.
pub const STEP_M: f32 = 0.1;
/// Degrees of a snapped turn.
pub const STEP_DEG: f32 = 15.0;

/// What the mouse does over the handles.
#[derive(Clone, Copy, Debug)]
pub struct HandlePointer {
    /// Where it is, points.
    pub position: egui::Pos2,
    /// Nothing covers the viewport there, and the mouse is not navigating.
    pub is_over: bool,
    /// The left button went down just now.
    pub pressed: bool,
    /// The left button is down.
    pub down: bool,
    /// In steps.
    pub snap: bool,
}
