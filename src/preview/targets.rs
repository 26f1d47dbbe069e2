//! The render targets of a frame, which have the picture's size.

use super::gpu::bindings::{texture_group, texture_layout};
use eframe::wgpu;

/// G-buffer: normal, base colour, geometric normal, roughness and metallic, packed by `scene.wgsl`.
pub(crate) const GBUFFER_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Id buffer: surface index plus one with outline flags, and the bits of the depth.
pub(crate) const ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Depth buffer, reversed: 1 at the near plane, 0 at infinity.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Coarse lighting: diffuse and specular light, normal and depth, packed by `scene.wgsl`.
pub(crate) const COARSE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

/// The encoding of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Output {
    /// sRGB-encoded 8 bits in a plain unorm texture, which is what egui samples.
    Display,
    /// Scene-linear half floats.
    Linear,
}

impl Output {
    /// Returns the format of the colour texture.
    pub fn format(self) -> wgpu::TextureFormat {
        match self {
            Output::Display => wgpu::TextureFormat::Rgba8Unorm,
            Output::Linear => wgpu::TextureFormat::Rgba16Float,
        }
    }
}

/// Layouts of the bind groups through which passes read the targets.
#[derive(Clone, Debug)]
pub(crate) struct TargetLayouts {
    /// G-buffer and id buffer.
    pub gbuffer: wgpu::BindGroupLayout,
    pub coarse: wgpu::BindGroupLayout,
}

impl TargetLayouts {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = |label, count| {
            texture_layout(device, label, wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2, count)
        };
        TargetLayouts { gbuffer: layout("G-buffer", 2), coarse: layout("coarse lighting", 1) }
    }
}

/// The textures of one picture size and the bind groups that read them.
#[derive(Debug)]
pub(crate) struct Targets {
    pub size: (u32, u32),
    pub output: Output,
    /// The coarse lighting has the picture's size, for the diffusion pass; else half of it.
    pub is_coarse_full: bool,
    pub gbuffer: wgpu::TextureView,
    pub ids: wgpu::Texture,
    pub ids_view: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    pub color: wgpu::Texture,
    pub color_view: wgpu::TextureView,
    /// Reads the G-buffer and the id buffer.
    pub gbuffer_group: wgpu::BindGroup,
    pub coarse: wgpu::TextureView,
    /// Reads the coarse lighting.
    pub coarse_group: wgpu::BindGroup,
}

impl Targets {
    pub fn new(
        device: &wgpu::Device,
        layouts: &TargetLayouts,
        size: (u32, u32),
        output: Output,
        is_coarse_full: bool,
    ) -> Self {
        let sized = |label, size: (u32, u32), format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let texture = |label, format, usage| sized(label, size, format, usage);
        let (read, copy) = (wgpu::TextureUsages::TEXTURE_BINDING, wgpu::TextureUsages::COPY_SRC);
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        let gbuffer = view(&texture("G-buffer", GBUFFER_FORMAT, read));
        let ids = texture("ids", ID_FORMAT, read | copy);
        let ids_view = view(&ids);
        let color = texture("preview", output.format(), read | copy);
        // Drafts shade at most one pixel in 2 x 2.
        let half = (size.0.div_ceil(2), size.1.div_ceil(2));
        let coarse_size = if is_coarse_full { size } else { half };
        let coarse = view(&sized("coarse lighting", coarse_size, COARSE_FORMAT, read));
        Targets {
            size,
            output,
            is_coarse_full,
            gbuffer_group: texture_group(device, "G-buffer", &layouts.gbuffer, &[&gbuffer, &ids_view]),
            gbuffer,
            ids_view,
            ids,
            depth: view(&texture("depth", DEPTH_FORMAT, wgpu::TextureUsages::empty())),
            color_view: view(&color),
            color,
            coarse_group: texture_group(device, "coarse lighting", &layouts.coarse, &[&coarse]),
            coarse,
        }
    }
}

/// The render targets of a renderer, one set for each output, recreated when the size changes.
#[derive(Debug)]
pub(crate) struct RenderTargets {
    layouts: TargetLayouts,
    pub current: Targets,
    /// The targets of the output that is not drawn now, if it ever was.
    other: Option<Targets>,
    /// Number of times that the textures for display have been replaced.
    pub generation: u64,
}

impl RenderTargets {
    /// Targets of one pixel.
    pub fn new(device: &wgpu::Device, layouts: TargetLayouts) -> Self {
        let current = Targets::new(device, &layouts, (1, 1), Output::Display, false);
        RenderTargets { layouts, current, other: None, generation: 0 }
    }

    /// Exchanges the targets for those of another output, and recreates them if the size differs, or if the diffusion
    /// pass needs a coarse target of full size; returns true if it did either. The size is clamped to what the device
    /// supports, and to at least one pixel.
    pub fn resize(&mut self, device: &wgpu::Device, size: (u32, u32), output: Output, diffuses: bool) -> bool {
        let largest = device.limits().max_texture_dimension_2d;
        let size = (size.0.clamp(1, largest), size.1.clamp(1, largest));
        let is_other = self.current.output != output;
        if is_other {
            let other = self.other.take().unwrap_or_else(|| Targets::new(device, &self.layouts, (1, 1), output, false));
            self.other = Some(std::mem::replace(&mut self.current, other));
        }
        let is_coarse_full = self.current.is_coarse_full || diffuses;
        let is_stale = self.current.size != size || self.current.is_coarse_full != is_coarse_full;
        if is_stale {
            self.current = Targets::new(device, &self.layouts, size, output, is_coarse_full);
            self.generation += u64::from(output == Output::Display);
        }
        is_stale || is_other
    }
}
