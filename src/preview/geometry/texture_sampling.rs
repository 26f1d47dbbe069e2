//! The samplers of textures: what is beyond an edge, and whether pixels are blended.

use crate::scene::{TexturePlacement, Wrap};
use eframe::wgpu;

/// How a texture is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SamplingKey {
    wrap: [Wrap; 2],
    nearest: bool,
}

impl SamplingKey {
    /// Returns the sampling of a placement.
    pub fn new(placement: &TexturePlacement) -> Self {
        SamplingKey { wrap: placement.wrap, nearest: placement.nearest }
    }

    fn index(self) -> usize {
        (self.wrap[0] as usize * Wrap::ALL.len() + self.wrap[1] as usize) * 2 + usize::from(self.nearest)
    }
}

/// A sampler for each key.
#[derive(Debug)]
pub(super) struct Samplers(Vec<wgpu::Sampler>);

impl Samplers {
    /// Creates the samplers.
    pub fn new(device: &wgpu::Device) -> Self {
        let keys = Wrap::ALL.into_iter().flat_map(|across| {
            let down = Wrap::ALL.into_iter();
            down.flat_map(move |down| [false, true].map(|nearest| SamplingKey { wrap: [across, down], nearest }))
        });
        Samplers(keys.map(|key| sampler(device, key)).collect())
    }

    /// Returns the sampler of a key.
    pub fn get(&self, key: SamplingKey) -> &wgpu::Sampler {
        &self.0[key.index()]
    }
}

fn sampler(device: &wgpu::Device, key: SamplingKey) -> wgpu::Sampler {
    let address = |wrap: Wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let filter = if key.nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("material texture"),
        address_mode_u: address(key.wrap[0]),
        address_mode_v: address(key.wrap[1]),
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: if key.nearest { wgpu::MipmapFilterMode::Nearest } else { wgpu::MipmapFilterMode::Linear },
        // Anisotropy needs linear filters
        anisotropy_clamp: if key.nearest { 1 } else { 8 },
        ..Default::default()
    })
}
