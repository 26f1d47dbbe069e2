//! What stands at a pixel, from the id buffer.

use super::gpu::guarded;
use super::targets::{ID_FORMAT, read_back};
use super::{Pick, PreviewError, PreviewRenderer};
use crate::scene::ObjectId;

/// Bytes of a texel of the id buffer.
const ID_BYTES: u32 = 8;
const _: () = assert!(matches!(ID_FORMAT, eframe::wgpu::TextureFormat::Rg32Uint));

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

impl PreviewRenderer {
    /// What stands at a pixel of the last picture (from the top left corner); none for room, void, or a pixel outside.
    /// Waits for the device: a few milliseconds.
    pub fn pick_blocking(&self, pixel: (u32, u32)) -> Result<Option<Pick>, PreviewError> {
        let size = self.targets.size;
        if pixel.0 >= size.0 || pixel.1 >= size.1 {
            return Ok(None);
        }
        let bytes = self.read_ids(pixel, (1, 1))?;
        Ok(marks(&bytes).next().and_then(|(mark, _)| self.owner(mark)))
    }

    pub(super) fn read_ids(&self, origin: (u32, u32), size: (u32, u32)) -> Result<Vec<u8>, PreviewError> {
        guarded(&self.device, &self.loss, || {
            read_back(&self.device, &self.queue, &self.targets.ids, origin, size, ID_BYTES)
        })
    }

    /// What a mark of the id buffer stands for.
    pub(super) fn owner(&self, mark: u32) -> Option<Pick> {
        self.owners.get(mark.checked_sub(1)? as usize).copied().flatten()
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
}

/// Marks and depths of texels of the id buffer.
fn marks(bytes: &[u8]) -> impl Iterator<Item = (u32, f32)> {
    bytes.chunks_exact(ID_BYTES as usize).map(|texel| {
        let word = |at: usize| u32::from_ne_bytes([texel[at], texel[at + 1], texel[at + 2], texel[at + 3]]);
        (word(0), f32::from_bits(word(4)))
    })
}
