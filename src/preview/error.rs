//! Errors of the preview.

/// The reason why a preview picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum PreviewError {
    /// The machine has no adapter.
    #[error(
        "no GPU adapter found: a Vulkan, Metal or DirectX 12 driver is needed (on Linux, mesa-vulkan-drivers renders on \
         the CPU): {0}"
    )]
    NoAdapter(String),
    /// The adapter refused to create a device.
    #[error("the GPU adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// Message of the driver.
        reason: String,
    },
    /// The device lacks a limit that the preview needs.
    #[error("the GPU cannot show the preview: {0}")]
    Unsupported(String),
    /// The device is lost (driver reset, unplugged, destroyed): create a new device and a new renderer.
    #[error("the GPU device was lost: {0}")]
    DeviceLost(String),
    /// The device has too little memory for this picture or scene.
    #[error("out of GPU memory")]
    OutOfMemory,
    /// The driver refused a command.
    #[error("the GPU driver refused the preview: {0}")]
    Driver(String),
}
