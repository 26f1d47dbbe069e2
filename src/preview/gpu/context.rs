//! The device that a renderer draws on.

use super::device::{LossFlag, guarded, is_cpu_rasteriser};
use crate::preview::PreviewError;
use eframe::wgpu;

/// A device with its queue and its loss flag. Clones share all three.
#[derive(Clone, Debug)]
pub(crate) struct GpuContext {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub loss: LossFlag,
    /// True if the adapter is a software rasteriser that runs on the CPU.
    pub is_cpu: bool,
}

impl GpuContext {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, loss: LossFlag) -> Self {
        GpuContext { device: device.clone(), queue: queue.clone(), loss, is_cpu: is_cpu_rasteriser(device) }
    }

    /// Runs GPU work and returns driver errors as values, see [`guarded`].
    pub fn guarded<T>(&self, work: impl FnOnce() -> Result<T, PreviewError>) -> Result<T, PreviewError> {
        guarded(&self.device, &self.loss, work)
    }
}
