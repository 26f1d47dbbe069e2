//! A finished picture in scene-linear units, before the tone curve.

/// Scene-linear RGB after exposure and white balance: 0.18 is a grey card metered right, rows from the top.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height` pixels.
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Picture { width, height, rgb: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// The pixel at (x, y), y down.
    pub fn at(&self, x: u32, y: u32) -> [f32; 3] {
        self.rgb[y as usize * self.width as usize + x as usize]
    }

    /// The picture as it is shown: tone curve and sRGB encoding, 8 bits a channel.
    pub fn to_srgb8(&self) -> Vec<[u8; 3]> {
        self.rgb.iter().map(|&c| crate::color::display_srgb8(c)).collect()
    }
}
