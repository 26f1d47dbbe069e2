//! How a texture lies on a surface: its transform, its coordinates, and what is beyond its edges.

use glam::{Affine2, Mat2, Vec2};

/// What is beyond the edge of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash, PartialOrd, Ord)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// Its mirror image.
    Mirror,
    /// Its outermost pixels.
    Clamp,
}

impl Wrap {
    /// All variants.
    pub const ALL: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    /// Returns a texture coordinate that shows the same and is near 0..1, without whole repetitions.
    pub fn reduced(self, coordinate: f32) -> f32 {
        match self {
            Wrap::Repeat => coordinate - coordinate.floor(),
            Wrap::Mirror => coordinate - 2.0 * (0.5 * coordinate).floor(),
            Wrap::Clamp => coordinate.clamp(-1.0, 2.0),
        }
    }

    /// Returns the pixel in 0 to `count` that a pixel index shows.
    pub fn pixel(self, index: i64, count: i64) -> i64 {
        match self {
            Wrap::Repeat => index.rem_euclid(count),
            Wrap::Clamp => index.clamp(0, count - 1),
            Wrap::Mirror => {
                let within = index.rem_euclid(2 * count);
                if within < count { within } else { 2 * count - 1 - within }
            }
        }
    }
}

/// How a texture lies on a surface. The transform is that of glTF's `KHR_texture_transform`: texture coordinates are
/// scaled, rotated and moved, in this order, with the origin at the picture's top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePlacement {
    /// Offset across and down, in pictures.
    pub offset: [f32; 2],
    /// Rotation of the coordinates, degrees; the picture turns clockwise.
    pub rotation_deg: f32,
    /// Factors of the coordinates: 2 shows the picture twice.
    pub scale: [f32; 2],
    /// What is beyond the left and right edge, and beyond the top and bottom edge.
    pub wrap: [Wrap; 2],
    /// Shows the nearest pixel instead of blending four.
    pub nearest: bool,
    /// Uses the second set of texture coordinates of a mesh.
    pub second_uvs: bool,
}

impl Default for TexturePlacement {
    fn default() -> Self {
        TexturePlacement {
            offset: [0.0; 2],
            rotation_deg: 0.0,
            scale: [1.0; 2],
            wrap: [Wrap::Repeat; 2],
            nearest: false,
            second_uvs: false,
        }
    }
}

impl TexturePlacement {
    /// Returns the transform from texture coordinates of a mesh to those of the picture, both from the bottom left.
    pub fn picture_from_mesh(&self) -> Affine2 {
        if (self.offset, self.rotation_deg, self.scale) == ([0.0; 2], 0.0, [1.0; 2]) {
            return Affine2::IDENTITY;
        }
        // In coordinates from the top left, a positive angle turns U towards -V (KHR_texture_transform, "Overview")
        let flip = Affine2::from_mat2_translation(Mat2::from_diagonal(Vec2::new(1.0, -1.0)), Vec2::Y);
        let turned = Mat2::from_angle(-self.rotation_deg.to_radians()) * Mat2::from_diagonal(Vec2::from(self.scale));
        flip * Affine2::from_mat2_translation(turned, Vec2::from(self.offset)) * flip
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_its_edges_a_texture_repeats_mirrors_or_goes_on() {
        let row = |wrap: Wrap| (-4..7).map(|index| wrap.pixel(index, 3)).collect::<Vec<_>>();
        assert_eq!(row(Wrap::Repeat), [2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0]);
        assert_eq!(row(Wrap::Mirror), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0]);
        assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2]);
    }

    #[test]
    fn the_transform_is_that_of_the_extension() {
        // The matrices of KHR_texture_transform for (u, v) from the top left: translation * rotation * scale
        let placement = TexturePlacement {
            offset: [0.25, 0.5],
            rotation_deg: 30.0,
            scale: [2.0, 3.0],
            ..TexturePlacement::default()
        };
        let (sin, cos) = 30.0_f32.to_radians().sin_cos();
        let [u, v] = [0.3, 0.1];
        let expected = [cos * 2.0 * u + sin * 3.0 * v + 0.25, -sin * 2.0 * u + cos * 3.0 * v + 0.5];
        let ours = placement.picture_from_mesh().transform_point2(Vec2::new(u, 1.0 - v));
        assert!((ours - Vec2::new(expected[0], 1.0 - expected[1])).length() < 1e-6, "{ours} {expected:?}");
        assert_eq!(TexturePlacement::default().picture_from_mesh(), Affine2::IDENTITY);
    }
}
