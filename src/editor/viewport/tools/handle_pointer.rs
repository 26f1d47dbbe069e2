//! The pointer over the transform handles, and the steps of snapping.

use eframe::egui;

/// Snapping step of moves, metres.
pub const STEP_M: f32 = 0.1;
/// Snapping step of rotations, degrees.
pub const STEP_DEG: f32 = 15.0;

/// The state of the mouse over the handles.
#[derive(Clone, Copy, Debug)]
pub struct HandlePointer {
    /// Position, points.
    pub position: egui::Pos2,
    /// True if nothing covers the viewport there and the mouse does not navigate.
    pub is_over: bool,
    /// True if the left button was pressed in this frame.
    pub pressed: bool,
    /// True while the left button is down.
    pub down: bool,
    /// True if moves snap.
    pub snap: bool,
}
