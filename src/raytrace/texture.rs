//! Texture lookup: bilinear or nearest, with the placement of a texture on a surface.

use super::geometry::SurfaceInteraction;
use crate::color::srgb_decode;
use crate::scene::{Texture, TexturePlacement, Wrap};
use glam::{Affine2, Vec2, Vec3};
use std::sync::Arc;

/// A texture of a slot, with a lookup table from codes to linear values.
#[derive(Clone, Debug)]
pub struct TextureMap {
    texture: Arc<Texture>,
    linear: [f32; 256],
    /// Transform of the mesh's texture coordinates.
    picture_from_mesh: Affine2,
    wrap: [Wrap; 2],
    nearest: bool,
    second_uvs: bool,
}

impl TextureMap {
    /// Returns the lookup for a texture, whose pixels are shared. Colours are sRGB-encoded, data are linear.
    pub fn new(texture: &Arc<Texture>, is_srgb: bool, placement: &TexturePlacement) -> Self {
        let decode = |code: f32| if is_srgb { srgb_decode(code) } else { code };
        TextureMap {
            texture: texture.clone(),
            linear: std::array::from_fn(|i| decode(i as f32 / 255.0)),
            picture_from_mesh: placement.picture_from_mesh(),
            wrap: placement.wrap,
            nearest: placement.nearest,
            second_uvs: placement.second_uvs,
        }
    }

    /// Returns linear RGB at a surface.
    pub fn at_surface(&self, surface: &SurfaceInteraction) -> Vec3 {
        self.at(self.uv(surface))
    }

    /// Returns the alpha at a surface, 0 to 1.
    pub fn alpha_at_surface(&self, surface: &SurfaceInteraction) -> f32 {
        if self.texture.alpha.is_empty() {
            return 1.0;
        }
        let alpha = |pixel: usize| Vec3::splat(f32::from(self.texture.alpha.get(pixel).copied().unwrap_or(255)));
        self.filter(self.uv(surface), alpha).x / 255.0
    }

    /// Returns the transform of texture coordinates of the mesh to those of the picture.
    pub fn picture_from_mesh(&self) -> &Affine2 {
        &self.picture_from_mesh
    }

    /// Returns true if the texture lies by the second set of texture coordinates.
    pub fn uses_second_uvs(&self) -> bool {
        self.second_uvs
    }

    /// Returns linear RGB at texture coordinates of the mesh; (0, 0) is at the bottom left.
    fn at(&self, uv: Vec2) -> Vec3 {
        self.filter(uv, |pixel| {
            let rgb = self.texture.rgb.get(pixel).copied().unwrap_or([255; 3]);
            Vec3::from(rgb.map(|code| self.linear[usize::from(code)]))
        })
    }

    fn uv(&self, surface: &SurfaceInteraction) -> Vec2 {
        if self.second_uvs { surface.second_uv } else { surface.uv }
    }

    /// Blends the values of the pixels around texture coordinates of the mesh, or returns that of the nearest.
    fn filter(&self, uv: Vec2, value: impl Fn(usize) -> Vec3) -> Vec3 {
        let (width, height) = (i64::from(self.texture.width), i64::from(self.texture.height));
        let picture = self.picture_from_mesh.transform_point2(uv);
        // Whole repetitions are taken away for precision: two, so that a mirrored one stays mirrored
        let wrapped = Vec2::new(self.wrap[0].reduced(picture.x), self.wrap[1].reduced(picture.y));
        if width == 0 || height == 0 || !wrapped.is_finite() {
            return Vec3::ONE;
        }
        let x = wrapped.x * width as f32;
        let y = (1.0 - wrapped.y) * height as f32;
        let pixel =
            |x: i64, y: i64| value((self.wrap[1].pixel(y, height) * width + self.wrap[0].pixel(x, width)) as usize);
        if self.nearest {
            return pixel(x.floor() as i64, y.floor() as i64);
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let top = pixel(x, y).lerp(pixel(x + 1, y), fx);
        let bottom = pixel(x, y + 1).lerp(pixel(x + 1, y + 1), fx);
        top.lerp(bottom, fy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarters(placement: TexturePlacement) -> TextureMap {
        let rgb = vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        TextureMap::new(&Arc::new(Texture::opaque(2, 2, rgb)), true, &placement)
    }

    #[test]
    fn v_points_up_and_the_texture_repeats() {
        let map = quarters(TexturePlacement::default());
        assert_eq!(map.at(Vec2::new(0.25, 0.75)), Vec3::X);
        assert_eq!(map.at(Vec2::new(0.25, 0.25)), Vec3::Z);
        assert_eq!(map.at(Vec2::new(1.75, -0.25)), Vec3::Y);
        assert!((map.at(Vec2::new(0.5, 0.75)) - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6);
    }

    #[test]
    fn beyond_the_edge_it_mirrors_or_goes_on_and_the_nearest_pixel_is_not_blended() {
        let with = |wrap, nearest| quarters(TexturePlacement { wrap: [wrap; 2], nearest, ..Default::default() });
        let just_beyond = Vec2::new(1.25, 0.75);
        assert_eq!(with(Wrap::Repeat, false).at(just_beyond), Vec3::X);
        assert_eq!(with(Wrap::Mirror, false).at(just_beyond), Vec3::Y);
        assert_eq!(with(Wrap::Mirror, false).at(Vec2::new(-0.25, 0.75)), Vec3::X);
        assert_eq!(with(Wrap::Mirror, false).at(Vec2::new(41.25, 0.75)), Vec3::Y, "also far beyond");
        assert_eq!(with(Wrap::Clamp, false).at(Vec2::new(9.0, 9.0)), Vec3::Y);
        assert_eq!(with(Wrap::Clamp, false).at(Vec2::new(-9.0, -9.0)), Vec3::Z);
        assert_eq!(with(Wrap::Repeat, true).at(Vec2::new(0.49, 0.51)), Vec3::X);
        assert_eq!(with(Wrap::Repeat, true).at(Vec2::new(0.51, 0.49)), Vec3::ONE);
    }

    #[test]
    fn data_are_linear_and_a_placement_scales_them() {
        let texture = Arc::new(Texture::opaque(1, 1, vec![[51, 102, 255]]));
        let map = TextureMap::new(&texture, false, &TexturePlacement::default());
        assert!((map.at(Vec2::ZERO) - Vec3::new(0.2, 0.4, 1.0)).length() < 1e-6);
        let twice = quarters(TexturePlacement { scale: [2.0, 2.0], ..Default::default() });
        // The origin of the transform is the top left: the first picture fills the upper left quarter
        assert_eq!(twice.at(Vec2::new(0.125, 0.875)), Vec3::X);
        assert_eq!(twice.at(Vec2::new(0.375, 0.875)), Vec3::Y);
        assert_eq!(twice.at(Vec2::new(0.625, 0.125)), Vec3::Z);
    }
}
