//! The photons of the live view: few at first, then a new set for every sample pass.

use super::camera::LiveCamera;
use crate::raytrace::RenderControl;
use crate::raytrace::caustics::{CausticView, MIN_PHOTONS, PhotonMap, PhotonPass};
use crate::raytrace::render_scene::RenderScene;
use std::sync::Arc;

/// Pixels per photon of a pass.
const PIXELS_PER_PHOTON: u64 = 4;
/// Samples whose photons the effort to guide them is made for.
const LEARNING_SAMPLES: u64 = 1;
/// Photons that cost as much as one path.
const PHOTONS_PER_PATH: u64 = 4;

/// The photon map of one scene, camera and sample.
#[derive(Debug, Default)]
pub struct LivePhotons {
    /// Index of the sample that the map is for.
    sample: u32,
    map: Option<PhotonMap>,
    /// Visible surfaces and density of starts; none until they are learned.
    view: Option<Arc<CausticView>>,
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
        let pass = PhotonPass { first_sample: sample, samples: 1, photons, seed: 0 };
        let (view, learned) = self.view(scene, camera, sample, control);
        if sample > 0 && !control.is_cancelled() {
            self.view = Some(view.clone());
        }
        let map = PhotonMap::trace(scene, &pass, &view, control);
        // A cancelled map is incomplete.
        self.map = (!control.is_cancelled()).then_some(map);
        self.sample = sample;
        (photons + learned) / PHOTONS_PER_PATH
    }

    /// Returns the caustic view and the number of photons that were traced for it: none for the first picture, which
    /// has no time for them.
    fn view(
        &self,
        scene: &RenderScene,
        camera: &LiveCamera,
        sample: u32,
        control: &RenderControl,
    ) -> (Arc<CausticView>, u64) {
        let pixels = u64::from(camera.size.0) * u64::from(camera.size.1);
        match &self.view {
            Some(view) => (view.clone(), 0),
            None if sample == 0 => (Arc::new(CausticView::unguided(scene, camera)), 0),
            None => {
                let view = CausticView::learn(scene, camera, pixels * LEARNING_SAMPLES, 0, control);
                let photons = view.learning_photons;
                (Arc::new(view), photons)
            }
        }
    }

    /// The map that was traced last.
    pub fn map(&self) -> Option<&PhotonMap> {
        self.map.as_ref()
    }
}
