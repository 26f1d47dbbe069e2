//! The light meter that stands in the studio. It takes no light away and shows in no picture.

use super::Scene;
use glam::Vec3;

/// What gathers the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Receptor {
    /// A flat disc: Lambert's cosine law. For ratios, and for flat things.
    #[default]
    Flat,
    /// A dome: cardioid response, half of the light from the side and none from straight behind. For faces.
    Dome,
}

/// Where a meter looks.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Facing {
    /// Towards the camera, wherever that is.
    #[default]
    Camera,
    /// Fixed angles, degrees: yaw 0 looks along -Z and grows to the left, pitch is up.
    Angles {
        /// Turn about the vertical axis.
        yaw_deg: f32,
        /// Tilt, positive upwards.
        pitch_deg: f32,
    },
}

/// A light meter at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meter {
    /// Centre of the receptor, metres.
    pub position: Vec3,
    /// Where it looks.
    pub facing: Facing,
    /// Flat or dome.
    pub receptor: Receptor,
}

impl Meter {
    /// Unit direction that it faces. At the camera's own place it faces as the camera does.
    pub fn direction(&self, scene: &Scene) -> Vec3 {
        match self.facing {
            Facing::Camera => (scene.camera.position - self.position)
                .try_normalize()
                .unwrap_or_else(|| scene.camera_frame(1.0).forward()),
            Facing::Angles { yaw_deg, pitch_deg } => {
                let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
                let (sin_pitch, cos_pitch) = pitch_deg.to_radians().sin_cos();
                Vec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
            }
        }
    }
}
