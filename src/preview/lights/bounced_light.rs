//! The texture of the bounced light: the six irradiances of each probe as six grids, one behind the other in z.

use crate::photo::irradiance_grid::IrradianceGrid;
use eframe::wgpu;
use glam::{UVec3, Vec3};

/// The bounced light on the device.
#[derive(Debug)]
pub(crate) struct BouncedLightTexture {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
    written: Option<Vec<[Vec3; 6]>>,
}

impl BouncedLightTexture {
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = create(device, UVec3::ONE);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("bounced light"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        BouncedLightTexture { view: texture.create_view(&Default::default()), texture, sampler, written: None }
    }

    /// Uploads a grid where it differs from the last one; returns true if the texture was replaced.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, grid: &IrradianceGrid) -> bool {
        let counts = grid.layout.counts;
        let size = extent(counts);
        let is_replaced = self.texture.size() != size;
        if is_replaced {
            self.texture = create(device, counts);
            (self.view, self.written) = (self.texture.create_view(&Default::default()), None);
        }
        if self.written.as_ref() == Some(&grid.probes) {
            return is_replaced;
        }
        let face = |face: usize| grid.probes.iter().map(move |probe| probe[face]);
        let texels: Vec<[u16; 4]> = (0..6).flat_map(face).map(|v| [half(v.x), half(v.y), half(v.z), 0]).collect();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * counts.x),
            rows_per_image: Some(counts.y),
        };
        queue.write_texture(self.texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, size);
        self.written = Some(grid.probes.clone());
        is_replaced
    }
}

fn extent(counts: UVec3) -> wgpu::Extent3d {
    wgpu::Extent3d { width: counts.x, height: counts.y, depth_or_array_layers: 6 * counts.z }
}

fn create(device: &wgpu::Device, counts: UVec3) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("bounced light"),
        size: extent(counts),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// Converts a value to IEEE 754 binary16, from 0 to the largest finite one.
pub(super) fn half(value: f32) -> u16 {
    const LARGEST: f32 = 65504.0;
    let clamped = if value > 0.0 { value.min(LARGEST) } else { 0.0 };
    // The product has the exponent of the half; adding half of the last place rounds.
    let shifted = clamped * (-112.0_f32).exp2();
    ((shifted.to_bits() + 0x0fff) >> 13) as u16
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn values_become_the_nearest_half() {
        for (value, bits) in [
            (0.0, 0x0000),
            (1.0, 0x3c00),
            (0.5, 0x3800),
            (65504.0, 0x7bff),
            (1e9, 0x7bff),
            (-1.0, 0x0000),
            (f32::NAN, 0x0000),
            (1.0 + 1.5 / 1024.0, 0x3c01),
            (1.0 + 1.6 / 1024.0, 0x3c02),
        ] {
            assert_eq!(half(value), bits, "{value}");
        }
    }
}
