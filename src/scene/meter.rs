//! The light meter in the studio. It casts no shadow and shows in no picture.

use super::Scene;
use super::aim::direction_of_angles;
use glam::Vec3;

/// The receptor of an incident meter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Receptor {
    /// Flat receptor: Lambert's cosine law. For lighting ratios and flat subjects.
    #[default]
    Flat,
    /// Dome: cardioid response, half of the light from the side and none from behind. For faces.
    Dome,
}

/// The direction of a meter.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Facing {
    /// Towards the camera.
    #[default]
    Camera,
    /// Fixed angles, degrees: pan 0 looks along -Z and grows to the left, tilt grows upwards.
    Angles {
        /// Pan, about the vertical axis.
        yaw_deg: f32,
        /// Tilt, positive upwards.
        pitch_deg: f32,
    },
}

/// A light meter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meter {
    /// Centre of the receptor, metres.
    pub position: Vec3,
    /// Direction.
    pub facing: Facing,
    /// Receptor.
    pub receptor: Receptor,
}

impl Meter {
    /// Returns the unit direction that it faces; the camera's own if both are at one position.
    pub fn direction(&self, scene: &Scene) -> Vec3 {
        match self.facing {
            Facing::Camera => (scene.camera.position - self.position)
                .try_normalize()
                .unwrap_or_else(|| scene.camera_frame(1.0).forward()),
            Facing::Angles { yaw_deg, pitch_deg } => direction_of_angles(yaw_deg, pitch_deg),
        }
    }
}
