//! The photons of a live picture: few at once, more and others for every wave of samples.

use super::camera::LiveCamera;
use crate::raytrace::RenderControl;
use crate::raytrace::caustics::{MIN_PHOTONS, PhotonMap, PhotonPass};
use crate::raytrace::render_scene::RenderScene;

/// Pixels for each photon of a wave.
const PIXELS_A_PHOTON: u64 = 4;
/// A photon takes as long as this part of a path.
const PHOTONS_A_PATH: u64 = 4;

/// Photons for one scene, kept until the next wave.
#[derive(Debug, Default)]
pub struct LivePhotons {
    /// The sample that they are for.
    sample: u32,
    map: Option<PhotonMap>,
}

impl LivePhotons {
    /// Sends out the photons of a sample, if they are not there yet and of any use. What it took is returned in paths.
    pub fn prepare(&mut self, scene: &RenderScene, camera: &LiveCamera, sample: u32, control: &RenderControl) -> u64 {
        if !scene.plan().photons || (self.map.is_some() && self.sample == sample) {
            return 0;
        }
        let pixels = u64::from(camera.size.0) * u64::from(camera.size.1);
        // The first picture has some 20 ms for them, on one thread.
        let photons = if sample == 0 { MIN_PHOTONS } else { pixels / PIXELS_A_PHOTON };
        let pixel_m = 2.0 * camera.frame.half_extent.x / camera.size.0 as f32;
        let pass = PhotonPass { first_sample: sample, samples: 1, photons, pixel_m, eye: camera.eye(), seed: 0 };
        let map = PhotonMap::trace(scene, &pass, control);
        // Cancelled, it is not whole.
        self.map = (!control.is_cancelled()).then_some(map);
        self.sample = sample;
        photons / PHOTONS_A_PATH
    }

    /// What was prepared last.
    pub fn map(&self) -> Option<&PhotonMap> {
        self.map.as_ref()
    }
}
