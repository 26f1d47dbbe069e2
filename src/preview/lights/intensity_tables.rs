//! The texture of the measured intensity distributions: a layer a table, relative to its peak.
//!
//! A row has the horizontal angles from 0 to 360 degrees, a column the vertical angles from 0 to 180, denser towards the
//! axis, where beams are narrow: row r of n is at 180 (r / (n - 1))^2 degrees. `light.wgsl` reads it.

use super::bounced_light::half;
use crate::scene::IntensityTable;
use eframe::wgpu;
use std::sync::Arc;

/// Largest number of different tables of a frame; the lights of further ones shine as their emitter does.
pub(crate) const MAX_TABLES: usize = 32;
/// Texels along the horizontal angles, the last of which repeats the first.
const WIDTH: u32 = 129;
/// Texels along the vertical angles.
const HEIGHT: u32 = 256;

/// The tables on the device.
#[derive(Debug)]
pub(crate) struct IntensityTables {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    written: Vec<Arc<IntensityTable>>,
}

impl IntensityTables {
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = create(device, 1);
        IntensityTables { view: array_view(&texture), texture, written: Vec::new() }
    }

    /// Uploads the tables where they differ from the last ones; returns true if the texture was replaced.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, tables: &[Arc<IntensityTable>]) -> bool {
        let tables = &tables[..tables.len().min(MAX_TABLES)];
        let is_written = |(index, table): (usize, &Arc<IntensityTable>)| {
            self.written.get(index).is_some_and(|written| Arc::ptr_eq(written, table))
        };
        if tables.iter().enumerate().all(is_written) {
            return false;
        }
        let layers = tables.len().next_power_of_two() as u32;
        let is_replaced = self.texture.depth_or_array_layers() < layers;
        if is_replaced {
            self.texture = create(device, layers);
            self.view = array_view(&self.texture);
        }
        for (layer, table) in (0..).zip(tables) {
            let origin = wgpu::Origin3d { x: 0, y: 0, z: layer };
            let target = wgpu::TexelCopyTextureInfo { origin, ..self.texture.as_image_copy() };
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(2 * WIDTH), rows_per_image: Some(HEIGHT) };
            queue.write_texture(target, bytemuck::cast_slice(&texels(table)), layout, extent(1));
        }
        self.written = tables.to_vec();
        is_replaced
    }
}

/// Returns the relative intensities of a layer, row by row.
fn texels(table: &IntensityTable) -> Vec<u16> {
    let row = |row: u32| {
        let part = row as f32 / (HEIGHT - 1) as f32;
        let vertical_deg = 180.0 * part * part;
        (0..WIDTH).map(move |column| {
            let horizontal_deg = 360.0 * column as f32 / (WIDTH - 1) as f32;
            half(table.candela_at(vertical_deg, horizontal_deg) / table.peak_cd())
        })
    };
    (0..HEIGHT).flat_map(row).collect()
}

fn extent(layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d { width: WIDTH, height: HEIGHT, depth_or_array_layers: layers }
}

fn create(device: &wgpu::Device, layers: u32) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("intensity tables"),
        size: extent(layers),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}
