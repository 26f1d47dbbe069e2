//! What can go wrong between the preview and a graphics adapter.

/// Why there is no preview picture.
#[derive(Debug, thiserror::Error)]
pub enum PreviewError {
    /// The machine offers no adapter at all.
    #[error(
        "no graphics adapter found: a Vulkan, Metal or DirectX 12 driver is needed (on Linux, mesa-vulkan-drivers \
         renders on the processor): {0}"
    )]
    NoAdapter(String),
    /// There is an adapter, but it gives no device.
    #[error("the graphics adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The device cannot do what the preview needs.
    #[error("the graphics device cannot show the preview: {0}")]
    Unsupported(String),
    /// The device is gone (driver reset, unplugged, destroyed): build a new device and a new renderer.
    #[error("the graphics device was lost: {0}")]
    DeviceLost(String),
    /// The device has too little memory for this picture or scene.
    #[error("out of graphics memory")]
    OutOfMemory,
    /// The driver refused a command.
    #[error("the graphics driver refused the preview: {0}")]
    Driver(String),
}
