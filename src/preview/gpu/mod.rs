//! Helpers around wgpu: the device and its loss, bind groups, pipelines, texture read-back.

pub mod bindings;
pub mod context;
pub mod device;
pub mod pipeline;
pub mod readback;
