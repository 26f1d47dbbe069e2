//! Offscreen rendering and read-back of pictures.

use super::gpu::readback::read_back;
use super::targets::Output;
use super::{Gpu, ObjectMask, PreviewError, PreviewInput, PreviewRenderer};
use crate::photo::Picture;
use crate::scene::{Assets, Scene};

/// Draws the scene's camera view as a display picture: sRGB bytes, rows from the top. A size of 0 is taken as 1.
pub fn render_picture(
    scene: &Scene,
    assets: &Assets,
    width: u32,
    height: u32,
) -> Result<image::RgbImage, PreviewError> {
    let gpu = Gpu::headless()?;
    PreviewRenderer::new(&gpu.device, &gpu.queue)?.picture(&PreviewInput::camera_view(scene, assets, (width, height)))
}

/// Returns the object that the scene's camera sees in each pixel.
pub fn object_mask(scene: &Scene, assets: &Assets, width: u32, height: u32) -> Result<ObjectMask, PreviewError> {
    let gpu = Gpu::headless()?;
    let mut renderer = PreviewRenderer::new(&gpu.device, &gpu.queue)?;
    renderer.render(&PreviewInput::camera_view(scene, assets, (width, height)))?;
    renderer.object_mask()
}

impl PreviewRenderer {
    /// Draws and reads back a display picture: sRGB bytes, rows from the top.
    pub fn picture(&mut self, input: &PreviewInput) -> Result<image::RgbImage, PreviewError> {
        self.render_to(input, Output::Display)?;
        let (width, height) = self.size();
        let bytes = self.read_color(4)?;
        let rgb = bytes.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        image::RgbImage::from_raw(width, height, rgb)
            .ok_or_else(|| PreviewError::Driver("the picture came back with the wrong size".to_owned()))
    }

    /// Draws and reads back a scene-linear picture without overlay, in half floats (11 bits).
    pub fn linear_picture(&mut self, input: &PreviewInput) -> Result<Picture, PreviewError> {
        self.render_to(input, Output::Linear)?;
        let (width, height) = self.size();
        let bytes = self.read_color(8)?;
        let half = |pixel: &[u8], i: usize| half_to_f32(u16::from_ne_bytes([pixel[2 * i], pixel[2 * i + 1]]));
        let rgb = bytes.chunks_exact(8).map(|pixel| [half(pixel, 0), half(pixel, 1), half(pixel, 2)]).collect();
        Ok(Picture { width, height, rgb })
    }

    /// Draws and reads back the average of `samples` scene-linear pictures through other points of the pixels: its edges
    /// are smooth. See [`Options::sample`](super::Options::sample).
    pub fn still_picture(&mut self, input: &PreviewInput, samples: u32) -> Result<Picture, PreviewError> {
        let mut input = input.clone();
        let mut mean = self.linear_picture(&input)?;
        for sample in 1..samples {
            input.options.sample = sample;
            let picture = self.linear_picture(&input)?;
            let weight = 1.0 / (sample + 1) as f32;
            for (mean, value) in mean.rgb.iter_mut().flatten().zip(picture.rgb.iter().flatten()) {
                *mean += (value - *mean) * weight;
            }
        }
        Ok(mean)
    }

    fn read_color(&self, bytes_per_pixel: u32) -> Result<Vec<u8>, PreviewError> {
        let (gpu, size) = (&self.gpu, self.size());
        let color = &self.targets.current.color;
        gpu.guarded(|| read_back(&gpu.device, &gpu.queue, color, (0, 0), size, bytes_per_pixel))
    }
}

/// Converts IEEE 754 binary16 to binary32.
fn half_to_f32(half: u16) -> f32 {
    let sign = if half & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, mantissa) = (i32::from(half >> 10 & 31), f32::from(half & 0x3ff));
    sign * match exponent {
        0 => mantissa * (-24.0_f32).exp2(),
        31 if mantissa == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1024.0 + mantissa) * ((exponent - 25) as f32).exp2(),
    }
}

#[cfg(test)]
mod tests {
    use super::half_to_f32;

    #[test]
    fn half_floats_convert_exactly() {
        for (half, value) in [(0x0000, 0.0), (0x3c00, 1.0), (0xc000, -2.0), (0x7bff, 65504.0), (0x0001, 5.960_464_5e-8)]
        {
            assert_eq!(half_to_f32(half), value);
        }
        assert!(half_to_f32(0x7e00).is_nan() && half_to_f32(0x7c00).is_infinite());
    }
}
