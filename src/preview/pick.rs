//! What stands at a pixel, from the id buffer and the gizmos' lines.

use super::gpu::device::guarded;
use super::scene_buffers::NEAR_M;
use super::targets::{copy_to, read_back};
use super::{Pick, PreviewError, PreviewRenderer};
use crate::scene::ObjectId;
use eframe::wgpu;
use glam::{Vec2, Vec3};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Bytes of a texel of the id buffer.
const ID_BYTES: u32 = 8;
/// The bits of a mark that number a surface; twin of `MARK_NUMBER` in `scene.wgsl`.
const NUMBER_BITS: u32 = (1 << 30) - 1;
/// How near to a gizmo's line a click means it, pixels.
pub const REACH_PX: f32 = 5.0;

/// Which object each pixel of a picture shows, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectMask {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The object seen in each pixel; none for room, emitters and void.
    pub objects: Vec<Option<ObjectId>>,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickHit {
    /// What a click there means; none for room and void.
    pub pick: Option<Pick>,
    /// The point of the studio that is seen there; none in the void.
    pub point: Option<Vec3>,
}

/// A pixel that is on its way back from the device.
#[derive(Debug)]
pub(super) struct WaitingPick {
    pixel: (u32, u32),
    buffer: wgpu::Buffer,
    mapped: Receiver<bool>,
}

impl PreviewRenderer {
    /// What stands at a pixel of the last picture (from the top left corner); none for room, void, or a pixel outside.
    /// Waits for the device: a few milliseconds.
    pub fn pick_blocking(&self, pixel: (u32, u32)) -> Result<Option<Pick>, PreviewError> {
        Ok(self.hit_blocking(pixel)?.and_then(|hit| hit.pick))
    }

    /// The same with the point that is seen; none for a pixel outside.
    pub fn hit_blocking(&self, pixel: (u32, u32)) -> Result<Option<PickHit>, PreviewError> {
        if !self.is_inside(pixel) {
            return Ok(None);
        }
        let bytes = self.read_ids(pixel, (1, 1))?;
        Ok(marks(&bytes).next().map(|texel| self.hit(pixel, texel)))
    }

    /// Asks for what stands at a pixel of the last picture, without waiting; `poll_pick` has the answer some frames
    /// later. A newer question replaces an older one.
    pub fn request_pick(&mut self, pixel: (u32, u32)) -> Result<(), PreviewError> {
        self.waiting_pick = None;
        if !self.is_inside(pixel) {
            return Ok(());
        }
        let waiting = guarded(&self.device, &self.loss, || {
            let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pick"),
                size: u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let row = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
            copy_to(&self.device, &self.queue, &self.targets.ids, pixel, (1, 1), &buffer, row);
            let (sender, mapped) = channel();
            buffer.map_async(wgpu::MapMode::Read, .., move |result| {
                let _ = sender.send(result.is_ok());
            });
            Ok(WaitingPick { pixel, buffer, mapped })
        })?;
        self.waiting_pick = Some(waiting);
        Ok(())
    }

    /// The answer to `request_pick`, once; none while it is on its way or nothing was asked.
    pub fn poll_pick(&mut self) -> Option<PickHit> {
        self.loss.ask(&self.device);
        let waiting = self.waiting_pick.take()?;
        match waiting.mapped.try_recv() {
            Ok(true) => {
                let bytes = waiting.buffer.get_mapped_range(..u64::from(ID_BYTES)).ok()?;
                marks(&bytes).next().map(|texel| self.hit(waiting.pixel, texel))
            }
            Ok(false) | Err(TryRecvError::Disconnected) => None,
            Err(TryRecvError::Empty) => {
                self.waiting_pick = Some(waiting);
                None
            }
        }
    }

    /// The objects of the last picture, pixel by pixel.
    pub fn object_mask(&self) -> Result<ObjectMask, PreviewError> {
        let (width, height) = self.targets.size;
        let bytes = self.read_ids((0, 0), (width, height))?;
        let object = |(mark, _)| match self.owner(mark) {
            Some(Pick::Object(id)) => Some(id),
            _ => None,
        };
        Ok(ObjectMask { width, height, objects: marks(&bytes).map(object).collect() })
    }

    fn is_inside(&self, pixel: (u32, u32)) -> bool {
        pixel.0 < self.targets.size.0 && pixel.1 < self.targets.size.1
    }

    fn read_ids(&self, origin: (u32, u32), size: (u32, u32)) -> Result<Vec<u8>, PreviewError> {
        guarded(&self.device, &self.loss, || {
            read_back(&self.device, &self.queue, &self.targets.ids, origin, size, ID_BYTES)
        })
    }

    /// A gizmo's line wins over what lies behind it: it is thin, and shows through.
    fn hit(&self, pixel: (u32, u32), (mark, depth): (u32, f32)) -> PickHit {
        let size = self.targets.size;
        let at = Vec2::new(pixel.0 as f32 + 0.5, pixel.1 as f32 + 0.5);
        let gizmo = self.view.and_then(|frame| self.gizmos.pick(&frame, size, at, REACH_PX));
        let place = at / Vec2::new(size.0 as f32, size.1 as f32);
        let seen = self.view.filter(|_| depth > 0.0);
        PickHit {
            pick: gizmo.or_else(|| self.owner(mark)),
            point: seen.map(|frame| frame.position() + frame.direction(place) * (NEAR_M / depth)),
        }
    }

    /// What a mark of the id buffer stands for.
    fn owner(&self, mark: u32) -> Option<Pick> {
        self.owners.get((mark & NUMBER_BITS).checked_sub(1)? as usize).copied().flatten()
    }
}

/// Marks and depths of texels of the id buffer.
fn marks(bytes: &[u8]) -> impl Iterator<Item = (u32, f32)> {
    bytes.chunks_exact(ID_BYTES as usize).map(|texel| {
        let word = |at: usize| u32::from_ne_bytes([texel[at], texel[at + 1], texel[at + 2], texel[at + 3]]);
        (word(0), f32::from_bits(word(4)))
    })
}
