//! Picking: the thing and the point at a pixel of the last picture, from the id buffer and the gizmos' lines.

use super::gizmo::Gizmos;
use crate::preview::PreviewError;
use crate::preview::gpu::context::GpuContext;
use crate::preview::gpu::readback::{copy_to, read_back};
use crate::preview::input::Pick;
use crate::preview::scene_buffers::NEAR_M;
use crate::preview::targets::Targets;
use crate::scene::{CameraFrame, ObjectId};
use eframe::wgpu;
use glam::{Vec2, Vec3};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Bytes per texel of the id buffer.
const ID_BYTES: u32 = 8;
/// The bits of an id that hold the surface index plus one; twin of `ID_INDEX_MASK` in `scene.wgsl`.
const ID_INDEX_MASK: u32 = (1 << 30) - 1;
/// Largest distance from a gizmo's line at which a click selects it, pixels.
pub const REACH_PX: f32 = 5.0;

/// The object visible in each pixel of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectMask {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Rows from the top; none for room, emitters and void.
    pub objects: Vec<Option<ObjectId>>,
}

/// The result of a pick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickHit {
    /// The thing that a click selects; none for room and void.
    pub pick: Option<Pick>,
    /// The visible point in world space; none in the void.
    pub point: Option<Vec3>,
}

/// An asynchronous read-back of one texel of the id buffer.
#[derive(Debug)]
struct PendingPick {
    pixel: (u32, u32),
    buffer: wgpu::Buffer,
    mapped: Receiver<bool>,
}

/// The state of the last picture that picking needs, and the pending pick.
#[derive(Debug, Default)]
pub(crate) struct Picking {
    /// The thing that a click on each surface selects.
    pub surfaces: Vec<Option<Pick>>,
    pub gizmos: Gizmos,
    pub view: Option<CameraFrame>,
    pending: Option<PendingPick>,
}

impl Picking {
    /// Picks at a pixel and waits for the device; none for a pixel outside of the picture.
    pub fn hit_blocking(
        &self,
        gpu: &GpuContext,
        targets: &Targets,
        pixel: (u32, u32),
    ) -> Result<Option<PickHit>, PreviewError> {
        if !is_inside(targets, pixel) {
            return Ok(None);
        }
        let bytes = read_ids(gpu, targets, pixel, (1, 1))?;
        Ok(id_texels(&bytes).next().map(|texel| self.hit(targets.size, pixel, texel)))
    }

    /// Starts a pick at a pixel, replacing a pending one.
    pub fn request(&mut self, gpu: &GpuContext, targets: &Targets, pixel: (u32, u32)) -> Result<(), PreviewError> {
        self.pending = None;
        if !is_inside(targets, pixel) {
            return Ok(());
        }
        let pending = gpu.guarded(|| {
            let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pick"),
                size: u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let row = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
            copy_to(&gpu.device, &gpu.queue, &targets.ids, pixel, (1, 1), &buffer, row);
            let (sender, mapped) = channel();
            buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                let _ = sender.send(result.is_ok());
            });
            Ok(PendingPick { pixel, buffer, mapped })
        })?;
        self.pending = Some(pending);
        Ok(())
    }

    /// Returns the result of the pending pick once it has arrived.
    pub fn poll(&mut self, gpu: &GpuContext, targets: &Targets) -> Option<PickHit> {
        gpu.loss.poll(&gpu.device);
        let pending = self.pending.take()?;
        match pending.mapped.try_recv() {
            Ok(true) => {
                let bytes = pending.buffer.get_mapped_range(..u64::from(ID_BYTES)).ok()?;
                id_texels(&bytes).next().map(|texel| self.hit(targets.size, pending.pixel, texel))
            }
            Ok(false) | Err(TryRecvError::Disconnected) => None,
            Err(TryRecvError::Empty) => {
                self.pending = Some(pending);
                None
            }
        }
    }

    /// Reads back the object visible in each pixel.
    pub fn object_mask(&self, gpu: &GpuContext, targets: &Targets) -> Result<ObjectMask, PreviewError> {
        let (width, height) = targets.size;
        let bytes = read_ids(gpu, targets, (0, 0), (width, height))?;
        let object = |(id, _)| match self.surface_pick(id) {
            Some(Pick::Object(id)) => Some(id),
            _ => None,
        };
        Ok(ObjectMask { width, height, objects: id_texels(&bytes).map(object).collect() })
    }

    /// Resolves a texel of the id buffer. A gizmo's line wins over surfaces: it is thin and shows through them.
    fn hit(&self, size: (u32, u32), pixel: (u32, u32), (id, depth): (u32, f32)) -> PickHit {
        let centre_px = Vec2::new(pixel.0 as f32 + 0.5, pixel.1 as f32 + 0.5);
        let gizmo = self.view.and_then(|frame| self.gizmos.pick(&frame, size, centre_px, REACH_PX));
        let uv = centre_px / Vec2::new(size.0 as f32, size.1 as f32);
        let view = self.view.filter(|_| depth > 0.0);
        PickHit {
            pick: gizmo.or_else(|| self.surface_pick(id)),
            point: view.map(|frame| frame.position() + frame.direction(uv) * (NEAR_M / depth)),
        }
    }

    fn surface_pick(&self, id: u32) -> Option<Pick> {
        self.surfaces.get((id & ID_INDEX_MASK).checked_sub(1)? as usize).copied().flatten()
    }
}

fn is_inside(targets: &Targets, pixel: (u32, u32)) -> bool {
    pixel.0 < targets.size.0 && pixel.1 < targets.size.1
}

fn read_ids(
    gpu: &GpuContext,
    targets: &Targets,
    origin: (u32, u32),
    size: (u32, u32),
) -> Result<Vec<u8>, PreviewError> {
    gpu.guarded(|| read_back(&gpu.device, &gpu.queue, &targets.ids, origin, size, ID_BYTES))
}

/// Returns the ids and depths of texels of the id buffer.
fn id_texels(bytes: &[u8]) -> impl Iterator<Item = (u32, f32)> {
    bytes.chunks_exact(ID_BYTES as usize).map(|texel| {
        let word = |at: usize| u32::from_ne_bytes([texel[at], texel[at + 1], texel[at + 2], texel[at + 3]]);
        (word(0), f32::from_bits(word(4)))
    })
}
