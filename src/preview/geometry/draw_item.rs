//! Draw items: a run of a mesh's triangles with its surface, its pass and its face culling.

use super::mesh_cache::MeshKey;
use super::strands::StrandShadows;
use super::texture_cache::TextureKeys;
use crate::preview::input::sample_point;
use crate::scene::Shape;
use eframe::wgpu;
use glam::Affine3A;
use std::ops::Range;

/// A run of triangles of one surface.
#[derive(Clone, Debug)]
pub(crate) struct DrawItem {
    pub mesh: MeshKey,
    pub indices: Range<u32>,
    /// Index of its surface record; the id buffer stores it plus one.
    pub surface: u32,
    /// Keys of the cached textures, by slot.
    pub textures: TextureKeys,
    /// The surface is masked or blended.
    pub has_holes: bool,
    /// A dome lies over its textures.
    pub has_dome: bool,
    pub pass: DrawPass,
    pub shadow: ShadowCasting,
    /// Sides of glass in drawing order: the far side of a solid first.
    pub glass_sides: &'static [Sides],
    /// Index of its box among the casters, if it casts a shadow.
    pub caster: usize,
}

/// The pass in which a run of triangles is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DrawPass {
    /// The geometry pass, two-sided.
    Opaque,
    /// The geometry pass with back faces culled: a camera outside looks into the room.
    OneSided,
    /// The glass pass over the lit picture: clear glass or water.
    Glass,
    /// Shadow maps alone: the body of a light that the camera does not see.
    Shadow,
}

/// The sides of triangles that are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Sides {
    /// Both: sheets, and solids that contain the camera.
    Both = 0,
    /// The front, of a room that is seen into from outside.
    Room = 1,
    /// The front, of a solid, whose far side is hidden.
    Front = 2,
    /// The back, of a solid that is mirrored by its scale.
    Back = 3,
}

impl Sides {
    /// All variants, in the order of their values.
    pub const ALL: [Sides; 4] = [Sides::Both, Sides::Room, Sides::Front, Sides::Back];

    /// Returns the face that the rasteriser culls.
    pub fn cull_mode(self) -> Option<wgpu::Face> {
        match self {
            Sides::Both => None,
            Sides::Room | Sides::Front => Some(wgpu::Face::Back),
            Sides::Back => Some(wgpu::Face::Front),
        }
    }
}

/// The kind of shadow caster that a run of triangles is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ShadowCasting {
    /// Casts no shadow.
    None,
    /// An open sheet: both sides cast.
    Sheet,
    /// A closed body: the sides that face away from the light cast. The far side is nearest to the receiver that the
    /// body touches, so that contact shadows do not leak.
    Solid,
    /// A closed body that is mirrored by its scale.
    MirroredSolid,
}

impl ShadowCasting {
    /// Returns the kind of caster of a shape under a transform.
    pub fn of(shape: &Shape, world_from_object: &Affine3A) -> Self {
        match shape {
            // The garments of a figure are open.
            Shape::Plane { .. }
            | Shape::Sweep { .. }
            | Shape::VFlat { .. }
            | Shape::MeshFile { .. }
            | Shape::Figure(_)
            | Shape::Prop(_) => ShadowCasting::Sheet,
            Shape::Box { .. } | Shape::Sphere { .. } | Shape::Cylinder { .. } | Shape::Tank(_) => {
                let mirrored = world_from_object.matrix3.determinant() < 0.0;
                if mirrored { ShadowCasting::MirroredSolid } else { ShadowCasting::Solid }
            }
        }
    }

    /// Returns the sides in the order in which glass of such a shape is drawn.
    pub fn glass_sides(self) -> &'static [Sides] {
        match self {
            ShadowCasting::Solid => &[Sides::Back, Sides::Front],
            ShadowCasting::MirroredSolid => &[Sides::Front, Sides::Back],
            ShadowCasting::None | ShadowCasting::Sheet => &[Sides::Both],
        }
    }
}

/// Fraction of the strands that is drawn at least.
const MIN_FRACTION: f32 = 0.02;

/// A part of a mesh's strands with its surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StrandItem {
    pub mesh: MeshKey,
    pub instances: Range<u32>,
    pub mean_radius_m: f32,
    /// How it is drawn into shadow maps.
    pub shadows: StrandShadows,
    /// Index of its surface record.
    pub surface: u32,
    /// Index of its box among the casters.
    pub caster: usize,
}

impl StrandItem {
    /// Returns the instances that cover the area of all where a pixel is `pixel_m` wide and each is `factor` times as wide
    /// as it is, for a transform to the world. Each sample of a still picture has others.
    pub fn visible(&self, pixel_m: f32, factor: f32, sample: u32, world_from_object: &Affine3A) -> Range<u32> {
        let scale = world_from_object.matrix3.determinant().abs().cbrt();
        let width_px = 2.0 * self.mean_radius_m * scale / pixel_m.max(1e-9);
        let visible = self.first(width_px.clamp(MIN_FRACTION, 1.0 / factor));
        let hidden = (self.instances.len() - visible.len()) as f32;
        let skipped = if sample == 0 { 0 } else { (sample_point(sample).x * hidden) as u32 };
        visible.start + skipped..visible.end + skipped
    }

    /// Returns the instances of a fraction of the strands.
    pub fn first(&self, fraction: f32) -> Range<u32> {
        let count = self.instances.len() as f32 * fraction;
        self.instances.start..self.instances.start + count.ceil() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn thin_strands_are_as_many_as_cover_the_area_of_all() {
        let item = StrandItem {
            mesh: MeshKey::Shared(0),
            instances: 0..5000,
            mean_radius_m: 4e-5,
            shadows: StrandShadows::Dense,
            surface: 0,
            caster: 0,
        };
        // A pixel of 0.4 mm is five hairs wide; at twice the scale they are twice as wide.
        assert_eq!(item.visible(4e-4, 1.0, 0, &Affine3A::IDENTITY), 0..1000);
        assert_eq!(item.visible(4e-4, 1.0, 0, &Affine3A::from_scale(Vec3::splat(2.0))), 0..2000);
        assert_eq!(item.visible(1e-5, 1.0, 0, &Affine3A::IDENTITY), 0..5000);
        assert_eq!(item.visible(1e-5, 4.0, 0, &Affine3A::IDENTITY), 0..1250, "four times as wide");
    }
}
