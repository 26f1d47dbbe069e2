//! The content of a preview picture: channel, light and highlight model.

/// The content of a preview picture.
#[derive(Clone, Debug, Default)]
pub struct PreviewLook {
    /// Name of the channel.
    pub channel: String,
    /// Name of the only light that is on; none for all lights.
    pub light: Option<String>,
    /// Blinn-Phong highlights instead of GGX.
    pub blinn_phong: bool,
}
