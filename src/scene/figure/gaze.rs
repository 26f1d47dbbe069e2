//! What the eyes of a figure follow.

use crate::scene::LightId;

/// What the eyes of a figure follow. `figures::follow_gazes` turns them: the angles of the pose are always those that
/// the eyes have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Gaze {
    /// Nothing: they keep the angles of the pose.
    #[default]
    Pose,
    /// The camera.
    Camera,
    /// The middle of a light.
    Light(LightId),
}

impl Gaze {
    /// Returns its part of the key of caches.
    pub(super) fn key(self) -> [u32; 2] {
        match self {
            Gaze::Pose => [0, 0],
            Gaze::Camera => [1, 0],
            Gaze::Light(LightId(id)) => [2, id],
        }
    }
}
