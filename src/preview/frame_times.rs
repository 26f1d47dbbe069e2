//! Frame times while the camera orbits, each frame waited for.

use super::{PreviewError, PreviewInput, PreviewRenderer};
use eframe::wgpu;
use glam::{Affine3A, Quat, Vec3};
use std::time::Instant;

/// Rotation of the camera per frame, radians: a slow drag of the mouse.
const TURN_RAD: f32 = 0.004;
/// Untimed frames at the start: the first compile pipelines and upload meshes.
const WARM_UP: u32 = 3;
/// Distance of the orbit's centre in front of the camera, metres.
const PIVOT_M: f32 = 2.0;

/// Frame times with a moving camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// Number of timed frames.
    pub frames: usize,
    /// Median, milliseconds.
    pub median_ms: f64,
    /// 90th percentile, milliseconds.
    pub ninety_percent_ms: f64,
}

impl PreviewRenderer {
    /// Draws frames with an orbiting camera and waits for the device after each. Nothing is read back.
    pub fn time_frames(&mut self, input: &PreviewInput, frames: u32) -> Result<FrameTimes, PreviewError> {
        let mut times = Vec::new();
        for step in 0..WARM_UP + frames.max(1) {
            let mut moved = input.clone();
            moved.frame.world_from_camera = orbited(&input.frame.world_from_camera, step as f32 * TURN_RAD);
            let began = Instant::now();
            self.render(&moved)?;
            self.wait()?;
            if step >= WARM_UP {
                times.push(began.elapsed().as_secs_f64() * 1e3);
            }
        }
        times.sort_by(f64::total_cmp);
        let percentile = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
        Ok(FrameTimes { frames: times.len(), median_ms: percentile(0.5), ninety_percent_ms: percentile(0.9) })
    }

    /// Waits until all submitted work is done.
    fn wait(&self) -> Result<(), PreviewError> {
        self.gpu.guarded(|| {
            let done = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
            done.map(|_| ()).map_err(|error| PreviewError::Driver(error.to_string()))
        })
    }
}

/// Returns a camera rotated about the vertical axis through a point in front of it.
fn orbited(world_from_camera: &Affine3A, angle_rad: f32) -> Affine3A {
    let pivot = world_from_camera.transform_point3(Vec3::NEG_Z * PIVOT_M);
    let turn = Affine3A::from_quat(Quat::from_rotation_y(angle_rad));
    Affine3A::from_translation(pivot) * turn * Affine3A::from_translation(-pivot) * *world_from_camera
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orbiting_keeps_the_distance_and_the_target() {
        let camera = Affine3A::from_translation(Vec3::new(0.0, 1.5, 3.0));
        let moved = orbited(&camera, 0.3);
        let pivot = Vec3::new(0.0, 1.5, 1.0);
        assert!((Vec3::from(moved.translation).distance(pivot) - PIVOT_M).abs() < 1e-5);
        let ahead = moved.transform_vector3(Vec3::NEG_Z);
        assert!((ahead - (pivot - Vec3::from(moved.translation)) / PIVOT_M).length() < 1e-5);
    }
}
