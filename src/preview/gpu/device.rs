//! The wgpu device without a window, its loss flag, and conversion of driver errors to `PreviewError`.

use crate::preview::PreviewError;
use eframe::wgpu;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, OnceLock};

/// Instance, adapter and device for work without a window.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name of the adapter and its driver, for messages.
    pub name: String,
}

/// Returns true if a device's adapter is a software rasteriser that runs on the CPU.
pub fn is_cpu_rasteriser(device: &wgpu::Device) -> bool {
    device.adapter_info().device_type == wgpu::DeviceType::Cpu
}

impl Gpu {
    /// Opens the fastest adapter of the machine, a CPU rasteriser if there is no other. The environment variables
    /// `WGPU_BACKEND` and `WGPU_ADAPTER_NAME` restrict the choice.
    pub fn headless() -> Result<Self, PreviewError> {
        pollster::block_on(Self::headless_async())
    }

    async fn headless_async() -> Result<Self, PreviewError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = match wgpu::util::initialize_adapter_from_env(&instance, None).await {
            Ok(named) => named,
            Err(_) => instance
                .request_adapter(&wgpu::RequestAdapterOptions {
                    power_preference: wgpu::PowerPreference::HighPerformance,
                    ..Default::default()
                })
                .await
                .map_err(|error| PreviewError::NoAdapter(error.to_string()))?,
        };
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("preview"),
            required_limits: wgpu::Limits::default().or_worse_values_from(&adapter.limits()),
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| PreviewError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Gpu { device, queue, name: format!("{} ({})", info.name, info.backend) })
    }
}

/// The loss of a device and its reason, set by the driver's callback. Clones share the state.
#[derive(Clone, Debug, Default)]
pub struct LossFlag(Arc<OnceLock<String>>);

impl LossFlag {
    /// Registers a flag that is set when the device is lost, replacing an earlier one of that device.
    pub fn watch(device: &wgpu::Device) -> Self {
        let flag = LossFlag::default();
        let raised = flag.clone();
        device.set_device_lost_callback(move |reason, message| {
            let message = if message.is_empty() { format!("{reason:?}") } else { format!("{reason:?}: {message}") };
            let _ = raised.0.set(message);
        });
        flag
    }

    /// Returns the reason if the device is lost.
    pub fn reason(&self) -> Option<&str> {
        self.0.get().map(String::as_str)
    }

    /// Polls the device and returns the reason if it is lost. A destroyed device reports its loss only when polled.
    pub fn poll(&self, device: &wgpu::Device) -> Option<&str> {
        if self.reason().is_none() {
            // wgpu panics when it polls a device that the driver has lost; the flag is set by then
            let _ = catch_unwind(AssertUnwindSafe(|| device.poll(wgpu::PollType::Poll)));
        }
        self.reason()
    }

    /// Returns an error if the device is lost.
    pub(crate) fn check(&self) -> Result<(), PreviewError> {
        self.0.get().map_or(Ok(()), |why| Err(PreviewError::DeviceLost(why.clone())))
    }
}

/// Runs GPU work and returns driver errors as values, where wgpu would panic.
pub(crate) fn guarded<T>(
    device: &wgpu::Device,
    loss: &LossFlag,
    work: impl FnOnce() -> Result<T, PreviewError>,
) -> Result<T, PreviewError> {
    loss.check()?;
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    // wgpu panics when it waits for a device that the driver has lost
    let done = catch_unwind(AssertUnwindSafe(work));
    // On native backends the scopes are settled by the time they are popped, so nothing waits here.
    let errors = [validation.pop(), internal.pop()].map(pollster::block_on);
    let out_of_memory = pollster::block_on(memory.pop());
    loss.poll(device);
    loss.check()?;
    if out_of_memory.is_some() {
        return Err(PreviewError::OutOfMemory);
    }
    match errors.into_iter().flatten().next() {
        Some(error) => Err(PreviewError::Driver(error.to_string())),
        None => done.unwrap_or_else(|panic| resume_unwind(panic)),
    }
}
