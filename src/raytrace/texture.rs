//! Texture lookup: bilinear, repeating.

use crate::color::srgb_decode;
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// A texture with a lookup table from sRGB codes to linear values.
#[derive(Clone, Debug)]
pub struct TextureMap {
    texture: Arc<Texture>,
    linear: [f32; 256],
}

impl TextureMap {
    /// Returns the lookup for a texture, whose pixels are shared.
    pub fn new(texture: &Arc<Texture>) -> Self {
        let linear = std::array::from_fn(|i| srgb_decode(i as f32 / 255.0));
        TextureMap { texture: texture.clone(), linear }
    }

    /// Returns linear RGB at texture coordinates; (0, 0) is at the bottom left. Repeats outside 0..1.
    pub fn at(&self, uv: Vec2) -> Vec3 {
        let (width, height) = (i64::from(self.texture.width), i64::from(self.texture.height));
        let wrapped = uv - uv.floor();
        if width == 0 || height == 0 || !wrapped.is_finite() {
            return Vec3::ONE;
        }
        let x = wrapped.x * width as f32 - 0.5;
        let y = (1.0 - wrapped.y) * height as f32 - 0.5;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let texel = |dx: i64, dy: i64| {
            let (x, y) = ((x + dx).rem_euclid(width), (y + dy).rem_euclid(height));
            Vec3::from(self.texture.rgb[(y * width + x) as usize].map(|c| self.linear[usize::from(c)]))
        };
        let top = texel(0, 0).lerp(texel(1, 0), fx);
        let bottom = texel(0, 1).lerp(texel(1, 1), fx);
        top.lerp(bottom, fy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn v_points_up_and_the_texture_repeats() {
        let rgb = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        let map = TextureMap::new(&Arc::new(Texture { width: 2, height: 2, rgb }));
        assert_eq!(map.at(Vec2::new(0.25, 0.75)), Vec3::X);
        assert_eq!(map.at(Vec2::new(0.25, 0.25)), Vec3::Z);
        assert_eq!(map.at(Vec2::new(1.75, -0.25)), Vec3::Y);
        assert!((map.at(Vec2::new(0.5, 0.75)) - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6);
    }
}
