//! The wgpu device and its loss.

pub mod device;
