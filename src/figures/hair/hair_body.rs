//! The body that hair grows on.

use crate::figures::body_data::BodyData;
use glam::{Affine3A, Vec3};

/// The posed body that hair grows on.
#[derive(Debug)]
pub struct HairBody<'a> {
    /// Body data.
    pub data: &'a BodyData,
    /// Its vertices in the pose, metres.
    pub positions: &'a [Vec3],
    /// World from head: origin between the eyes, +Z the direction of the face.
    pub head: Affine3A,
    /// Middle of the eyeballs in the world, left and right.
    pub eyes: [Vec3; 2],
}
