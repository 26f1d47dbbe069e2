//! Sample passes: progressive rendering in passes of 1, 1, 2, 4 ... samples per pixel, each with its own photons and its
//! own cache of bounced light and its own blur.

use super::approximations::Approximations;
use super::caustics::{CausticView, MIN_PHOTONS, PhotonMap, PhotonPass};
use super::control::RenderControl;
use super::irradiance_cache::IrradianceCache;
use super::irradiance_gather;
use super::lens::FilmCamera;
use super::path_tracer::PathTracer;
use super::regularisation::BlurredMaterials;
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use super::settings::{Method, Settings};
use std::sync::Arc;

/// Maximum samples per pixel of a pass.
const MAX_PASS: u32 = 16;

/// The passes of a render; a function of scene and settings.
#[derive(Clone, Copy, Debug)]
pub struct PassSchedule {
    spp: u32,
    max_samples: u32,
}

impl PassSchedule {
    /// The passes of a render.
    pub fn new(scene: &RenderScene, settings: &Settings) -> Self {
        let with_photons = uses_photons(scene, settings);
        let limit = if with_photons { PhotonPass::max_samples(settings.pixels()) } else { MAX_PASS };
        PassSchedule { spp: settings.spp, max_samples: limit.min(MAX_PASS) }
    }

    /// The pass after so many samples per pixel; none after all of them.
    pub fn pass_after(&self, taken: u32) -> Option<SamplePass> {
        let samples = taken.clamp(1, self.max_samples).min(self.spp.saturating_sub(taken));
        (samples > 0).then_some(SamplePass { first_sample: taken, samples })
    }

    /// All passes in order.
    pub fn passes(self) -> impl Iterator<Item = SamplePass> {
        std::iter::successors(self.pass_after(0), move |pass| self.pass_after(pass.first_sample + pass.samples))
    }
}

/// Returns true if a render traces photons.
pub fn uses_photons(scene: &RenderScene, settings: &Settings) -> bool {
    scene.plan().photons && settings.method != Method::Whitted
}

/// Returns how a render approximates light: with photons, and, for paths of the plan's own depth at one time, with a
/// cache where it pays and with regularisation.
pub fn approximations(scene: &RenderScene, settings: &Settings) -> Approximations {
    let may_approximate = settings.method == Method::Path && settings.max_depth.is_none() && scene.moments.is_empty();
    let may_be_cached = may_approximate && scene.plan().irradiance_cache;
    Approximations {
        photons: uses_photons(scene, settings),
        irradiance_cache: may_be_cached
            && irradiance_gather::pays(scene, &scene.lens.film_camera(settings.width, settings.height)),
        regularisation: may_approximate && scene.plan().regularisation,
    }
}

/// What the samples of a pass share: photons of caustics, the cache of bounced light, and materials with blurred gloss.
#[derive(Debug, Default)]
pub struct SharedLight {
    /// The photons; none for a render without them.
    pub photon_map: Option<PhotonMap>,
    /// The cache; none where it does not pay.
    pub irradiance_cache: Option<IrradianceCache>,
    /// The materials; none without regularisation.
    pub blurred_materials: Option<BlurredMaterials>,
}

impl SharedLight {
    /// Returns a tracer for a scene with this light.
    pub fn tracer<'a>(&'a self, scene: &'a RenderScene) -> PathTracer<'a> {
        let mut tracer = PathTracer::new(scene, self.photon_map.as_ref());
        tracer.irradiance_cache = self.irradiance_cache.as_ref();
        tracer.blurred_materials = self.blurred_materials.as_ref();
        tracer
    }
}

/// Traces the shared light of a render's passes; a function of scene and settings.
#[derive(Debug)]
pub struct SharedLightTracer<'a> {
    scene: &'a RenderScene,
    settings: &'a Settings,
    /// Visible surfaces and density of starts. None for a render without photons.
    view: Option<Arc<CausticView>>,
    camera: FilmCamera,
    approximations: Approximations,
}

impl<'a> SharedLightTracer<'a> {
    /// Learns where photons start, if the render has any. Of no use if `control` is cancelled.
    pub fn new(
        scene: &'a RenderScene,
        settings: &'a Settings,
        approximations: Approximations,
        control: &RenderControl,
    ) -> Self {
        let camera = scene.lens.film_camera(settings.width, settings.height);
        let view = approximations.photons.then(|| {
            let photons = settings.pixels() * u64::from(settings.spp);
            Arc::new(CausticView::learn(scene, &camera, photons, settings.seed, control))
        });
        SharedLightTracer { scene, settings, view, camera, approximations }
    }

    /// Traces the shared light of a pass. Incomplete if `control` is cancelled.
    pub fn trace(&self, pass: SamplePass, control: &RenderControl) -> SharedLight {
        let SamplePass { first_sample, samples } = pass;
        let (scene, seed) = (self.scene, self.settings.seed);
        let photons = MIN_PHOTONS.max(self.settings.pixels() * u64::from(samples));
        let photon_pass = PhotonPass { first_sample, samples, photons, seed };
        let photon_map = self.view.as_ref().map(|view| PhotonMap::trace(scene, &photon_pass, view, control));
        let cached = || IrradianceCache::trace(scene, &self.camera, photon_map.as_ref(), pass, seed, control);
        let irradiance_cache = self.approximations.irradiance_cache.then(cached);
        let blurred_materials = self.approximations.regularisation.then(|| BlurredMaterials::new(scene, pass));
        SharedLight { photon_map, irradiance_cache, blurred_materials }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_grow_and_cover_every_sample_once() {
        let passes: Vec<u32> = PassSchedule { spp: 45, max_samples: 16 }.passes().map(|pass| pass.samples).collect();
        assert_eq!(passes, [1, 1, 2, 4, 8, 16, 13]);
        let few: Vec<SamplePass> = PassSchedule { spp: 3, max_samples: 1 }.passes().collect();
        assert_eq!(few, [0, 1, 2].map(|first_sample| SamplePass { first_sample, samples: 1 }));
        assert_eq!(PassSchedule { spp: 0, max_samples: 16 }.passes().count(), 0);
    }
}
