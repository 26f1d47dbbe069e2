//! Read-back of textures to memory.

use crate::preview::PreviewError;
use eframe::wgpu;
use std::time::Duration;

/// Time after the end of its work in which a device reports it. A lost device drops the report, and nothing waits.
const LONGEST_CALLBACK: Duration = Duration::from_secs(5);

/// Reads a part of a texture back and waits for the device. Rows have `bytes_per_pixel` times width bytes, without
/// padding.
pub(crate) fn read_back(
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
    // Another thread that waits for the device may be the one that calls back, a moment later
    match receiver.recv_timeout(LONGEST_CALLBACK) {
        Ok(Ok(())) => {}
        _ => return Err(PreviewError::Driver("the picture could not be read back".to_owned())),
    }
    let mapped = slice.get_mapped_range().map_err(|error| PreviewError::Driver(error.to_string()))?;
    Ok(mapped.chunks_exact(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
}

/// Submits a copy of a part of a texture to a buffer with `padded` bytes a row.
pub(crate) fn copy_to(
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
