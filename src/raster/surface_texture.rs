//! The textures of surfaces: the nearest pixel, in the placement of each.

use crate::color::srgb_decode;
use crate::scene::{Texture, TexturePlacement, TextureSlot, Wrap};
use glam::{Affine2, Vec2, Vec3};
use std::sync::Arc;

/// A texture of a slot.
#[derive(Clone, Debug)]
pub(super) struct SurfaceTexture {
    texture: Arc<Texture>,
    is_srgb: bool,
    pub picture_from_mesh: Affine2,
    wrap: [Wrap; 2],
    pub second_uvs: bool,
}

/// What textures give to a material at a pixel: factors.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelFactors {
    /// Factor of the base colour.
    pub color: Vec3,
    /// Factor of the roughness.
    pub roughness: f32,
    /// Factor of the metal.
    pub metallic: f32,
    /// Factor of the emission.
    pub emission: Vec3,
}

impl PixelFactors {
    /// A pixel without textures.
    pub const ONE: Self = PixelFactors { color: Vec3::ONE, roughness: 1.0, metallic: 1.0, emission: Vec3::ONE };
}

impl SurfaceTexture {
    /// Returns a texture as it lies on a surface.
    pub fn new(texture: Arc<Texture>, slot: TextureSlot, placement: &TexturePlacement) -> Self {
        SurfaceTexture {
            texture,
            is_srgb: slot.is_srgb(),
            picture_from_mesh: placement.picture_from_mesh(),
            wrap: placement.wrap,
            second_uvs: placement.second_uvs,
        }
    }

    /// Returns the index of the pixel at both sets of texture coordinates.
    fn pixel(&self, [first, second]: [Vec2; 2]) -> usize {
        let picture = self.picture_from_mesh.transform_point2(if self.second_uvs { second } else { first });
        let (width, height) = (i64::from(self.texture.width), i64::from(self.texture.height));
        if width == 0 || height == 0 || !picture.is_finite() {
            return usize::MAX;
        }
        let x = (self.wrap[0].reduced(picture.x) * width as f32).floor() as i64;
        let y = ((1.0 - self.wrap[1].reduced(picture.y)) * height as f32).floor() as i64;
        (self.wrap[1].pixel(y, height) * width + self.wrap[0].pixel(x, width)) as usize
    }

    /// Returns linear RGB at texture coordinates; white beyond the data.
    pub fn rgb(&self, uvs: [Vec2; 2], linear_from_srgb: &[f32; 256]) -> Vec3 {
        let codes = self.texture.rgb.get(self.pixel(uvs)).copied().unwrap_or([255; 3]);
        let linear =
            |code: u8| if self.is_srgb { linear_from_srgb[usize::from(code)] } else { f32::from(code) / 255.0 };
        Vec3::from(codes.map(linear))
    }

    /// Returns the alpha at texture coordinates.
    pub fn alpha(&self, uvs: [Vec2; 2]) -> f32 {
        f32::from(self.texture.alpha.get(self.pixel(uvs)).copied().unwrap_or(255)) / 255.0
    }
}

/// Returns the linear value of each sRGB byte.
pub(super) fn linear_from_srgb() -> [f32; 256] {
    std::array::from_fn(|i| srgb_decode(i as f32 / 255.0))
}
