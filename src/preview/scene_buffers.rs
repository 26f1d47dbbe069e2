//! Bind group 0 of all passes: frame constants, surfaces, lights, light tiles, bounced light, intensity tables.

use super::geometry::surface::GpuSurface;
use super::lights::bounced_light::BouncedLightTexture;
use super::lights::environment::Environment;
use super::lights::intensity_tables::IntensityTables;
use super::lights::light_table::{Ambient, GpuLight, MAX_LIGHTS};
use super::lights::light_tiles::TILES_BYTES;
use crate::photo::irradiance_grid::{GridLayout, IrradianceGrid};
use crate::scene::{CameraFrame, IntensityTable};
use bytemuck::{Pod, Zeroable};
use eframe::wgpu;
use glam::Vec3;
use std::sync::Arc;

/// Near plane, metres. Reversed float depth allows a small value without loss of precision.
pub(crate) const NEAR_M: f32 = 0.005;

/// The frame constants; twin of `Frame` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct GpuFrame {
    pub clip_from_world: [[f32; 4]; 4],
    pub eye: [f32; 3],
    pub near_m: f32,
    pub ray_centre: [f32; 3],
    /// Picture pixels per shadow mask pixel along each axis.
    pub mask_scale: u32,
    pub ray_right: [f32; 3],
    /// Picture pixels per coarse pixel along each axis, in drafts.
    pub coarse_scale: u32,
    pub ray_up: [f32; 3],
    pub strand_width: f32,
    pub ambient: [f32; 3],
    pub pixel_angle: f32,
    pub void_radiance: [f32; 3],
    pub unused_3: f32,
    pub environment_low: [f32; 3],
    pub unused_0: f32,
    pub environment_high: [f32; 3],
    pub unused_1: f32,
    pub environment_radiance: [[f32; 4]; 6],
    /// Position of the first probe of the bounced light, world space.
    pub grid_low: [f32; 3],
    pub unused_4: f32,
    /// Probes per metre along each axis.
    pub grid_density: [f32; 3],
    pub unused_5: f32,
    /// Number of probes along each axis.
    pub grid_counts: [f32; 3],
    /// Distance from a surface at which its bounced light is looked up, metres.
    pub grid_offset_m: f32,
    pub size: [f32; 2],
    /// Distances that show as white and as black in the depth channel, metres; both 0 for a perspective view, where
    /// they are fixed.
    pub depth_range_m: [f32; 2],
    pub light_ends: [u32; 4],
}

impl GpuFrame {
    /// Returns the constants of a camera and a picture size.
    pub fn new(camera: &CameraFrame, size: (u32, u32)) -> Self {
        let axes = camera.world_from_camera.matrix3;
        let extent = camera.half_extent;
        GpuFrame {
            clip_from_world: camera.clip_from_world(NEAR_M).to_cols_array_2d(),
            eye: camera.position().into(),
            near_m: NEAR_M,
            ray_centre: camera.forward().into(),
            ray_right: (Vec3::from(axes.x_axis) * extent.x).into(),
            ray_up: (Vec3::from(axes.y_axis) * extent.y).into(),
            pixel_angle: extent.y / size.1.max(1) as f32,
            size: [size.0 as f32, size.1 as f32],
            ..GpuFrame::zeroed()
        }
    }

    /// Sets the ambient light, the background, and a uniform environment.
    pub fn set_ambient(&mut self, ambient: &Ambient, void_radiance: Vec3) {
        self.ambient = ambient.irradiance.into();
        self.void_radiance = void_radiance.max(ambient.void_radiance).into();
        self.environment_low = [-1e3; 3];
        self.environment_high = [1e3; 3];
        self.environment_radiance = [ambient.surround_radiance.extend(0.0).into(); 6];
    }

    /// Sets the environment box of reflections.
    pub fn set_environment(&mut self, environment: &Environment) {
        self.environment_low = environment.low.into();
        self.environment_high = environment.high.into();
        self.environment_radiance = environment.radiance.map(|c| c.extend(0.0).into());
    }

    /// Sets the place of the bounced light's probes.
    pub fn set_grid(&mut self, layout: &GridLayout) {
        self.grid_low = layout.low.into();
        self.grid_density = layout.step_m.recip().into();
        self.grid_counts = layout.counts.as_vec3().into();
        // One cell from a surface, all probes around are on its side, where the surface is flat.
        self.grid_offset_m = if layout.len() > 1 { layout.step_m.max_element() } else { 0.0 };
    }
}

/// A frame's data.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameData<'a> {
    pub frame: &'a GpuFrame,
    pub surfaces: &'a [GpuSurface],
    pub lights: &'a [GpuLight],
    /// Lights per tile; none where they are not read.
    pub tiles: Option<&'a [[u32; 4]]>,
    pub bounced_light: &'a IrradianceGrid,
    /// The measured distributions of the lights.
    pub tables: &'a [Arc<IntensityTable>],
}

/// Size of the light buffer, bytes.
pub(crate) const LIGHTS_BYTES: u64 = (MAX_LIGHTS * size_of::<GpuLight>()) as u64;

/// A storage buffer that grows on demand.
#[derive(Debug)]
struct GrowingBuffer {
    buffer: wgpu::Buffer,
    label: &'static str,
}

impl GrowingBuffer {
    fn new(device: &wgpu::Device, label: &'static str, bytes: u64) -> Self {
        GrowingBuffer { buffer: storage(device, label, bytes), label }
    }

    /// Writes the bytes and returns true if the buffer was replaced.
    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let grows = bytes.len() as u64 > self.buffer.size();
        if grows {
            self.buffer = storage(device, self.label, (bytes.len() as u64).next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        grows
    }
}

fn storage(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

/// Bind group 0 of all pipelines.
#[derive(Debug)]
pub(crate) struct SceneBuffers {
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    frame: wgpu::Buffer,
    surfaces: GrowingBuffer,
    /// A uniform rather than a storage buffer: CPU rasterisers read uniforms several times faster.
    lights: wgpu::Buffer,
    tiles: wgpu::Buffer,
    bounced_light: BouncedLightTexture,
    intensity_tables: IntensityTables,
}

impl SceneBuffers {
    pub fn new(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: stages,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let texture_entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let storage_type = wgpu::BufferBindingType::Storage { read_only: true };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("scene"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Uniform),
                entry(1, storage_type),
                entry(2, wgpu::BufferBindingType::Uniform),
                entry(3, wgpu::BufferBindingType::Uniform),
                texture_entry(
                    4,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D3,
                        multisampled: false,
                    },
                ),
                texture_entry(5, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
                texture_entry(
                    6,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2Array,
                        multisampled: false,
                    },
                ),
            ],
        });
        let frame = uniform(device, "frame", size_of::<GpuFrame>() as u64);
        let lights = uniform(device, "lights", LIGHTS_BYTES);
        let tiles = uniform(device, "light tiles", TILES_BYTES);
        let surfaces = GrowingBuffer::new(device, "surfaces", 64 * size_of::<GpuSurface>() as u64);
        let bounced_light = BouncedLightTexture::new(device);
        let intensity_tables = IntensityTables::new(device);
        let buffers = [&frame, &surfaces.buffer, &lights, &tiles];
        let bind_group = bind(device, &layout, buffers, &bounced_light, &intensity_tables);
        SceneBuffers { layout, bind_group, frame, surfaces, lights, tiles, bounced_light, intensity_tables }
    }

    /// The layout of the bind group.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The bind group.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Uploads a frame's data.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, data: &FrameData) {
        let FrameData { frame, surfaces, lights, tiles, bounced_light, tables } = *data;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        let lights: &[u8] = bytemuck::cast_slice(&lights[..lights.len().min(MAX_LIGHTS)]);
        if !lights.is_empty() {
            queue.write_buffer(&self.lights, 0, lights);
        }
        if let Some(tiles) = tiles {
            queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(tiles));
        }
        let new_surfaces = self.surfaces.write(device, queue, bytemuck::cast_slice(surfaces));
        let new_bounced_light = self.bounced_light.write(device, queue, bounced_light);
        let new_tables = self.intensity_tables.write(device, queue, tables);
        if new_surfaces || new_bounced_light || new_tables {
            let buffers = [&self.frame, &self.surfaces.buffer, &self.lights, &self.tiles];
            self.bind_group = bind(device, &self.layout, buffers, &self.bounced_light, &self.intensity_tables);
        }
    }
}

fn uniform(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffers: [&wgpu::Buffer; 4],
    bounced_light: &BouncedLightTexture,
    intensity_tables: &IntensityTables,
) -> wgpu::BindGroup {
    let light = [
        wgpu::BindingResource::TextureView(&bounced_light.view),
        wgpu::BindingResource::Sampler(&bounced_light.sampler),
        wgpu::BindingResource::TextureView(&intensity_tables.view),
    ];
    let resources = buffers.map(wgpu::Buffer::as_entire_binding).into_iter().chain(light);
    let entries: Vec<_> =
        (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("scene"), layout, entries: &entries })
}
