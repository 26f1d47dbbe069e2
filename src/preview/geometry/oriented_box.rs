//! Oriented bounding boxes.

use crate::scene::LightId;
use glam::{Affine3A, Vec3};

/// The bounding box of a mesh in object space, with the object's transform.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrientedBox {
    pub world_from_object: Affine3A,
    pub low: Vec3,
    pub high: Vec3,
    /// The light whose body it bounds: its own light passes it.
    pub body_of: Option<LightId>,
}

/// The corners of each face of a box, as indices into [`OrientedBox::corners`].
pub(crate) const FACES: [[usize; 4]; 6] =
    [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];

impl OrientedBox {
    /// Returns the axis-aligned box around the corners in world space.
    fn world_box(&self) -> (Vec3, Vec3) {
        let corners = self.corners();
        corners.iter().fold((corners[0], corners[0]), |(low, high), corner| (low.min(*corner), high.max(*corner)))
    }

    /// Returns the distance from a point to the axis-aligned box in world space, metres.
    pub fn distance(&self, point: Vec3) -> f32 {
        let (low, high) = self.world_box();
        point.clamp(low, high).distance(point)
    }

    /// Returns true if a point lies in the axis-aligned box in world space, or less than 2 cm outside of it.
    pub fn may_contain(&self, point: Vec3) -> bool {
        let (low, high) = self.world_box();
        let margin = Vec3::splat(0.02);
        point.cmpge(low - margin).all() && point.cmple(high + margin).all()
    }

    /// Returns the eight corners in world space. Bit 0 of an index selects the high x, bit 1 y, bit 2 z.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            let corner = Vec3::new(
                pick(0, self.low.x, self.high.x),
                pick(1, self.low.y, self.high.y),
                pick(2, self.low.z, self.high.z),
            );
            self.world_from_object.transform_point3(corner)
        })
    }
}
