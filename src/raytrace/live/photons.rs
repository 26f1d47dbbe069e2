//! The photons of the live view: few at first, then a new set for every sample pass.

use super::camera::LiveCamera;
use crate::raytrace::RenderControl;
use crate::raytrace::caustics::{MIN_PHOTONS, PhotonMap, PhotonPass};
use crate::raytrace::render_scene::RenderScene;

/// Pixels per photon of a pass.
const PIXELS_PER_PHOTON: u64 = 4;
/// Photons that cost as much as one path.
const PHOTONS_PER_PATH: u64 = 4;

/// The photon map of one scene and sample.
#[derive(Debug, Default)]
pub struct LivePhotons {
    /// Index of the sample that the map is for.
    sample: u32,
    map: Option<PhotonMap>,
}

impl LivePhotons {
    /// Traces the photons of a sample if the plan has photons and they are not there yet. Returns the cost in paths.
    pub fn prepare(&mut self, scene: &RenderScene, camera: &LiveCamera, sample: u32, control: &RenderControl) -> u64 {
        if !scene.plan().photons || (self.map.is_some() && self.sample == sample) {
            return 0;
        }
        let pixels = u64::from(camera.size.0) * u64::from(camera.size.1);
        // The first picture has about 20 ms for them, on one thread.
        let photons = if sample == 0 { MIN_PHOTONS } else { pixels / PIXELS_PER_PHOTON };
        let pixel_m = 2.0 * camera.frame.half_extent.x / camera.size.0 as f32;
        let pass = PhotonPass { first_sample: sample, samples: 1, photons, pixel_m, eye: camera.eye(), seed: 0 };
        let map = PhotonMap::trace(scene, &pass, control);
        // A cancelled map is incomplete.
        self.map = (!control.is_cancelled()).then_some(map);
        self.sample = sample;
        photons / PHOTONS_PER_PATH
    }

    /// The map that was traced last.
    pub fn map(&self) -> Option<&PhotonMap> {
        self.map.as_ref()
    }
}
