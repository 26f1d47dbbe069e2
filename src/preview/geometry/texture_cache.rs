//! The texture cache: textures with mipmaps, and the bind groups of materials' textures.

use super::texture_sampling::{Samplers, SamplingKey};
use crate::color::{srgb_decode, srgb_encode};
use crate::scene::{MaterialTextures, Texture, TextureSlot};
use eframe::wgpu;
use std::collections::HashMap;
use std::sync::Arc;

/// A texture of a slot: the address of its pixels, and how they are read. The default is white, which is no texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct TextureKey {
    /// 0 for white.
    address: usize,
    is_srgb: bool,
    sampling: SamplingKey,
}

/// The textures of a surface, by slot.
pub(crate) type TextureKeys = [TextureKey; TextureSlot::COUNT];

/// A mip level: width, height, RGBA rows.
type MipLevel = (u32, u32, Vec<[u8; 4]>);

/// A texture on the GPU.
#[derive(Debug)]
struct CachedTexture {
    view: wgpu::TextureView,
    /// Keeps the texture alive, so that the address in the key stays unique.
    source: Option<Arc<Texture>>,
}

/// All textures on the GPU, by address of their source and encoding.
#[derive(Debug)]
pub(crate) struct TextureCache {
    layout: wgpu::BindGroupLayout,
    samplers: Samplers,
    textures: HashMap<(usize, bool), CachedTexture>,
    groups: HashMap<TextureKeys, wgpu::BindGroup>,
}

impl TextureKey {
    /// Returns true for a texture; false for white.
    pub fn is_texture(&self) -> bool {
        self.address != 0
    }
}

impl TextureCache {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let slots = 0..TextureSlot::COUNT as u32;
        let entries: Vec<_> = slots.flat_map(|slot| [entry(2 * slot, texture), entry(2 * slot + 1, sampler)]).collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("material textures"),
            entries: &entries,
        });
        let white = CachedTexture { view: upload(device, queue, false, &[(1, 1, vec![[255; 4]])]), source: None };
        let textures = HashMap::from([((0, false), white)]);
        let mut cache = TextureCache { layout, samplers: Samplers::new(device), textures, groups: HashMap::new() };
        cache.ensure_group(device, TextureKeys::default());
        cache
    }

    /// The layout of the bind groups.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Returns the bind group of keys from `ensure`; white for unknown keys.
    pub fn get(&self, keys: &TextureKeys) -> Option<&wgpu::BindGroup> {
        self.groups.get(keys).or_else(|| self.groups.get(&TextureKeys::default()))
    }

    /// Returns the keys of a material's textures, uploading them on first use; white for those that are missing, empty,
    /// inconsistent or too large.
    pub fn ensure(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        textures: &MaterialTextures,
        image: impl Fn(&crate::scene::TextureRef) -> Option<Arc<Texture>>,
    ) -> TextureKeys {
        let keys = textures.look_up(|slot, reference| {
            let address = self.ensure_texture(device, queue, &image(reference)?, slot.is_srgb())?;
            let sampling = SamplingKey::new(textures.placement(slot));
            Some(TextureKey { address, is_srgb: slot.is_srgb(), sampling })
        });
        let keys = keys.map(Option::unwrap_or_default);
        self.ensure_group(device, keys);
        keys
    }

    /// Returns the address of a texture, uploading it on first use.
    fn ensure_texture(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        texture: &Arc<Texture>,
        is_srgb: bool,
    ) -> Option<usize> {
        let address = Arc::as_ptr(texture) as usize;
        let pixels = texture.width as usize * texture.height as usize;
        let too_large = texture.width.max(texture.height) > device.limits().max_texture_dimension_2d;
        if pixels == 0 || texture.rgb.len() != pixels || too_large {
            return None;
        }
        self.textures.entry((address, is_srgb)).or_insert_with(|| CachedTexture {
            view: upload(device, queue, is_srgb, &mip_chain(texture, is_srgb)),
            source: Some(texture.clone()),
        });
        Some(address)
    }

    fn ensure_group(&mut self, device: &wgpu::Device, keys: TextureKeys) {
        if self.groups.contains_key(&keys) {
            return;
        }
        let views = keys.map(|key| self.textures.get(&(key.address, key.is_srgb)));
        let resources = views.into_iter().zip(&keys).enumerate().filter_map(|(slot, (texture, key))| {
            let view = wgpu::BindingResource::TextureView(&texture?.view);
            let sampler = wgpu::BindingResource::Sampler(self.samplers.get(key.sampling));
            let binding = 2 * slot as u32;
            Some([
                wgpu::BindGroupEntry { binding, resource: view },
                wgpu::BindGroupEntry { binding: binding + 1, resource: sampler },
            ])
        });
        let entries: Vec<_> = resources.flatten().collect();
        if entries.len() == 2 * TextureSlot::COUNT {
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("material textures"),
                layout: &self.layout,
                entries: &entries,
            });
            self.groups.insert(keys, group);
        }
    }

    /// Drops the textures that only this cache still references.
    pub fn drop_unused(&mut self) {
        // A texture that is read in both encodings is held twice
        let mut held: HashMap<usize, usize> = HashMap::new();
        for ((address, _), texture) in &self.textures {
            *held.entry(*address).or_default() += usize::from(texture.source.is_some());
        }
        let is_used = |address: usize, source: &Option<Arc<Texture>>| {
            source.as_ref().is_none_or(|source| Arc::strong_count(source) > held.get(&address).copied().unwrap_or(1))
        };
        self.textures.retain(|(address, _), texture| is_used(*address, &texture.source));
        let textures = &self.textures;
        self.groups.retain(|keys, _| keys.iter().all(|key| textures.contains_key(&(key.address, key.is_srgb))));
    }
}

fn upload(device: &wgpu::Device, queue: &wgpu::Queue, is_srgb: bool, levels: &[MipLevel]) -> wgpu::TextureView {
    let extent = |width, height| wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("material texture"),
        size: levels.first().map_or(extent(1, 1), |&(width, height, _)| extent(width, height)),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: if is_srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm },
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
    texture.create_view(&Default::default())
}

/// Returns the mip levels of a texture down to one pixel: colours averaged in linear light, data and alpha as they are.
fn mip_chain(texture: &Texture, is_srgb: bool) -> Vec<MipLevel> {
    let linear = |code: u8| if is_srgb { srgb_decode(f32::from(code) / 255.0) } else { f32::from(code) / 255.0 };
    let decode: Vec<f32> = (0..=255).map(linear).collect();
    let encode = |value: f32| ((if is_srgb { srgb_encode(value) } else { value }) * 255.0 + 0.5) as u8;
    let pixel = |(i, &[r, g, b]): (usize, &[u8; 3])| [r, g, b, texture.alpha.get(i).copied().unwrap_or(255)];
    let first = texture.rgb.iter().enumerate().map(pixel).collect();
    let mut levels: Vec<MipLevel> = vec![(texture.width, texture.height, first)];
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
                    encode(0.25 * sum)
                };
                let alpha = four.iter().map(|pixel| u16::from(pixel[3])).sum::<u16>();
                half.push([mean(0), mean(1), mean(2), ((alpha + 2) / 4) as u8]);
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
    fn mipmaps_reach_one_pixel_and_average_light_or_data() {
        let rgb = (0..6).map(|i| if i % 2 == 0 { [0; 3] } else { [255; 3] }).collect();
        let texture = Texture { alpha: vec![0, 100, 0, 100, 0, 0], ..Texture::opaque(2, 3, rgb) };
        let levels = mip_chain(&texture, true);
        assert_eq!(levels.iter().map(|l| (l.0, l.1)).collect::<Vec<_>>(), [(2, 3), (1, 1)]);
        // Half the light is sRGB 188, not 128.
        assert_eq!(levels[1].2, [[188, 188, 188, 50]]);
        assert_eq!(mip_chain(&texture, false)[1].2, [[128, 128, 128, 50]]);
    }
}
