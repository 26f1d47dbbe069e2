//! The textures of a picture's size.

use super::PreviewError;
use eframe::wgpu;

/// Normal, colour, face normal and gloss, packed by `scene.wgsl`.
pub(super) const GBUFFER_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Surface number plus one, and the bits of the depth.
pub(super) const ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Reversed: 1 near, 0 infinitely far.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What the lighting pass writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Output {
    /// sRGB-encoded 8 bits in a plain unorm texture, which is what egui samples.
    Display,
    /// Scene-linear half floats.
    Linear,
}

impl Output {
    pub fn format(self) -> wgpu::TextureFormat {
        match self {
            Output::Display => wgpu::TextureFormat::Rgba8Unorm,
            Output::Linear => wgpu::TextureFormat::Rgba16Float,
        }
    }
}

/// Everything of a picture's size.
#[derive(Debug)]
pub(super) struct Targets {
    pub size: (u32, u32),
    pub output: Output,
    pub gbuffer: wgpu::TextureView,
    pub ids: wgpu::Texture,
    pub ids_view: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    pub color: wgpu::Texture,
    pub color_view: wgpu::TextureView,
    /// G-buffer and ids, for reading.
    pub lookup: wgpu::BindGroup,
    /// Light of one pixel of each cell, for drafts, and the same for reading.
    pub cells: wgpu::TextureView,
    pub cells_lookup: wgpu::BindGroup,
}

/// Matte and glossy light, normal and depth of one pixel of each cell, packed by `scene.wgsl`.
pub(super) const CELL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

impl Targets {
    pub fn new(device: &wgpu::Device, layouts: &TargetLayouts, size: (u32, u32), output: Output) -> Self {
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
        let lookup = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("G-buffer"),
            layout: &layouts.gbuffer,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&gbuffer) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&ids_view) },
            ],
        });
        let half = (size.0.div_ceil(2), size.1.div_ceil(2));
        let cells = view(&sized("light cells", half, CELL_FORMAT, read));
        let cells_lookup = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light cells"),
            layout: &layouts.cells,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&cells) }],
        });
        Targets {
            cells,
            cells_lookup,
            size,
            output,
            gbuffer,
            ids_view,
            ids,
            depth: view(&texture("depth", DEPTH_FORMAT, wgpu::TextureUsages::empty())),
            color_view: view(&color),
            color,
            lookup,
        }
    }
}

/// Layouts with which passes read the targets.
#[derive(Debug)]
pub(super) struct TargetLayouts {
    /// G-buffer and ids.
    pub gbuffer: wgpu::BindGroupLayout,
    /// Light of one pixel of each cell.
    pub cells: wgpu::BindGroupLayout,
}

impl TargetLayouts {
    pub fn new(device: &wgpu::Device) -> Self {
        TargetLayouts { gbuffer: uint_layout(device, "G-buffer", 2), cells: uint_layout(device, "light cells", 1) }
    }
}

fn uint_layout(device: &wgpu::Device, label: &str, textures: u32) -> wgpu::BindGroupLayout {
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    };
    let entries: Vec<_> = (0..textures).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Copies a part of a texture to memory: `bytes_per_pixel` times width bytes a row, without padding.
pub(super) fn read_back(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    origin: (u32, u32),
    size: (u32, u32),
    bytes_per_pixel: u32,
) -> Result<Vec<u8>, PreviewError> {
    let row = size.0 * bytes_per_pixel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read back"),
        size: u64::from(padded) * u64::from(size.1),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    copy_to(device, queue, texture, origin, size, &buffer, padded);
    let slice = buffer.slice(..);
    let (sender, receiver) = std::sync::mpsc::channel();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| PreviewError::Driver(error.to_string()))?;
    match receiver.try_recv() {
        Ok(Ok(())) => {}
        _ => return Err(PreviewError::Driver("the picture could not be read back".to_owned())),
    }
    let mapped = slice.get_mapped_range().map_err(|error| PreviewError::Driver(error.to_string()))?;
    Ok(mapped.chunks_exact(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

/// Submits a copy of a part of a texture to a buffer with `padded` bytes a row.
pub(super) fn copy_to(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    origin: (u32, u32),
    size: (u32, u32),
    buffer: &wgpu::Buffer,
    padded: u32,
) {
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d { x: origin.0, y: origin.1, z: 0 },
            ..texture.as_image_copy()
        },
        wgpu::TexelCopyBufferInfo {
            buffer,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
        },
        wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
}
