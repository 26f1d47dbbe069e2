//! A graphics device without a window, and the guard that turns driver errors into ours.

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

impl Gpu {
    /// The fastest adapter of the machine; a software one where there is no other. The variables `WGPU_BACKEND` and
    /// `WGPU_ADAPTER_NAME` narrow the choice.
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

/// Whether a device is gone, and why; set by the driver's callback. Clones watch the same device.
#[derive(Clone, Debug, Default)]
pub struct LossFlag(Arc<OnceLock<String>>);

impl LossFlag {
    /// A flag that the device raises when it is lost. A device has one: it raises the newest.
    pub fn watch(device: &wgpu::Device) -> Self {
        let flag = LossFlag::default();
        let raised = flag.clone();
        device.set_device_lost_callback(move |reason, message| {
            let message = if message.is_empty() { format!("{reason:?}") } else { format!("{reason:?}: {message}") };
            let _ = raised.0.set(message);
        });
        flag
    }

    /// Why the device is gone, if it is.
    pub fn reason(&self) -> Option<&str> {
        self.0.get().map(String::as_str)
    }

    /// Why the device is gone, if it is. Asks it: one that was destroyed says so only then.
    pub fn ask(&self, device: &wgpu::Device) -> Option<&str> {
        if self.reason().is_none() {
            // wgpu panics where it asks a device that the driver has lost; the flag is up by then.
            let _ = catch_unwind(AssertUnwindSafe(|| device.poll(wgpu::PollType::Poll)));
        }
        self.reason()
    }

    /// An error if the device is gone.
    pub(crate) fn check(&self) -> Result<(), PreviewError> {
        self.0.get().map_or(Ok(()), |why| Err(PreviewError::DeviceLost(why.clone())))
    }
}

/// Runs GPU work so that an error of the driver comes back as a value; left alone, wgpu would panic.
pub(crate) fn guarded<T>(
    device: &wgpu::Device,
    loss: &LossFlag,
    work: impl FnOnce() -> Result<T, PreviewError>,
) -> Result<T, PreviewError> {
    loss.check()?;
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    // wgpu panics where it waits for a device that the driver has lost.
    let done = catch_unwind(AssertUnwindSafe(work));
    // On native backends the scopes are settled by the time they are popped, so nothing waits here.
    let errors = [validation.pop(), internal.pop()].map(pollster::block_on);
    let out_of_memory = pollster::block_on(memory.pop());
    loss.ask(device);
    loss.check()?;
    if out_of_memory.is_some() {
        return Err(PreviewError::OutOfMemory);
    }
    match errors.into_iter().flatten().next() {
        Some(error) => Err(PreviewError::Driver(error.to_string())),
        None => done.unwrap_or_else(|panic| resume_unwind(panic)),
    }
}
