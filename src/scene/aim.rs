//! The direction of a camera or a light.

use super::ObjectId;
use glam::Vec3;

/// The direction of a camera or a light, as a photographer sets it: aim at a spot, follow the subject, or a fixed head
/// angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Aims at a fixed point of the studio, metres.
    Point(Vec3),
    /// Aims at a point of a subject and follows the subject when it moves.
    Object {
        /// The subject.
        object: ObjectId,
        /// The point in object space, metres before the object's scale: a figure's face, say.
        offset: Vec3,
    },
    /// Keeps its angles wherever the stand goes, degrees: pan 0 looks along -Z and grows counter-clockwise from above,
    /// tilt grows upwards.
    Angles {
        /// Pan, about the vertical axis.
        yaw_deg: f32,
        /// Tilt, positive upwards.
        pitch_deg: f32,
    },
}

/// Returns the unit direction of a pan and a tilt, degrees; see [`Aim::Angles`].
pub fn direction_of_angles(yaw_deg: f32, pitch_deg: f32) -> Vec3 {
    let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
    let (sin_pitch, cos_pitch) = pitch_deg.to_radians().sin_cos();
    Vec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
}
