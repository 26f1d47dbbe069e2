//! The texture cache: base colour textures with mipmaps.

use crate::color::{srgb_decode, srgb_encode};
use crate::scene::Texture;
use eframe::wgpu;
use std::collections::HashMap;
use std::sync::Arc;

/// Key of the white texture of untextured surfaces.
pub(crate) const WHITE: usize = 0;

/// A mip level: width, height, RGBA rows.
type MipLevel = (u32, u32, Vec<[u8; 4]>);

#[derive(Debug)]
struct CachedTexture {
    bind_group: wgpu::BindGroup,
    /// Keeps the texture alive, so that the address in the key stays unique.
    _source: Option<Arc<Texture>>,
}

/// All textures on the GPU, by address of their source.
#[derive(Debug)]
pub(crate) struct TextureCache {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    entries: HashMap<usize, CachedTexture>,
}

impl TextureCache {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("base colour"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("base colour"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            anisotropy_clamp: 8,
            ..Default::default()
        });
        let mut cache = TextureCache { layout, sampler, entries: HashMap::new() };
        let bind_group = cache.upload(device, queue, vec![(1, 1, vec![[255; 4]])]);
        cache.entries.insert(WHITE, CachedTexture { bind_group, _source: None });
        cache
    }

    /// The layout of the bind groups.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Returns the bind group of a key from `ensure`; white for an unknown key.
    pub fn get(&self, key: usize) -> Option<&wgpu::BindGroup> {
        self.entries.get(&key).or_else(|| self.entries.get(&WHITE)).map(|entry| &entry.bind_group)
    }

    /// Returns the key of a texture, uploading it on first use; `WHITE` if it is empty, inconsistent or too large.
    pub fn ensure(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, texture: &Arc<Texture>) -> usize {
        let key = Arc::as_ptr(texture) as usize;
        let pixels = texture.width as usize * texture.height as usize;
        let too_large = texture.width.max(texture.height) > device.limits().max_texture_dimension_2d;
        if pixels == 0 || texture.rgb.len() != pixels || too_large {
            return WHITE;
        }
        if !self.entries.contains_key(&key) {
            let bind_group = self.upload(device, queue, mip_chain(texture));
            self.entries.insert(key, CachedTexture { bind_group, _source: Some(texture.clone()) });
        }
        key
    }

    /// Drops the textures that only this cache still references.
    pub fn drop_unused(&mut self) {
        self.entries.retain(|_, entry| entry._source.as_ref().is_none_or(|source| Arc::strong_count(source) > 1));
    }

    fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue, levels: Vec<MipLevel>) -> wgpu::BindGroup {
        let extent = |width, height| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("base colour"),
            size: levels.first().map_or(extent(1, 1), |&(width, height, _)| extent(width, height)),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (level, (width, height, pixels)) in levels.iter().enumerate() {
            queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level: level as u32, ..texture.as_image_copy() },
                bytemuck::cast_slice(pixels),
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None },
                extent(*width, *height),
            );
        }
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("base colour"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&texture.create_view(&Default::default())),
                },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        })
    }
}

/// Returns the mip levels of a texture down to one pixel, averaged in linear light.
fn mip_chain(texture: &Texture) -> Vec<MipLevel> {
    let decode: Vec<f32> = (0..=255).map(|code| srgb_decode(code as f32 / 255.0)).collect();
    let opaque = texture.rgb.iter().map(|&[r, g, b]| [r, g, b, 255]).collect();
    let mut levels: Vec<MipLevel> = vec![(texture.width, texture.height, opaque)];
    while let Some((width, height, pixels)) = levels.last() {
        let (width, height) = (*width, *height);
        if width == 1 && height == 1 {
            break;
        }
        let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
        let at = |x: u32, y: u32| pixels[(y.min(height - 1) * width + x.min(width - 1)) as usize];
        let mut half = Vec::with_capacity((half_width * half_height) as usize);
        for y in 0..half_height {
            for x in 0..half_width {
                let four = [at(2 * x, 2 * y), at(2 * x + 1, 2 * y), at(2 * x, 2 * y + 1), at(2 * x + 1, 2 * y + 1)];
                let mean = |channel: usize| {
                    let sum: f32 = four.iter().map(|pixel| decode[pixel[channel] as usize]).sum();
                    (srgb_encode(0.25 * sum) * 255.0 + 0.5) as u8
                };
                half.push([mean(0), mean(1), mean(2), 255]);
            }
        }
        levels.push((half_width, half_height, half));
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mipmaps_reach_one_pixel_and_average_light() {
        let rgb = (0..6).map(|i| if i % 2 == 0 { [0; 3] } else { [255; 3] }).collect();
        let levels = mip_chain(&Texture { width: 2, height: 3, rgb });
        assert_eq!(levels.iter().map(|l| (l.0, l.1)).collect::<Vec<_>>(), [(2, 3), (1, 1)]);
        // Half the light is sRGB 188, not 128.
        assert_eq!(levels[1].2, [[188, 188, 188, 255]]);
    }
}
