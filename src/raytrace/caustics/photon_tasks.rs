//! Photons in tasks that run side by side, with the same photons for any number of threads.

use super::photon_tracer::{PhotonReceiver, PhotonTracer};
use super::start_density::StartDensity;
use crate::raytrace::control::RenderControl;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::Sampler;
use rayon::prelude::*;

/// Tasks of photons.
#[derive(Clone, Copy, Debug)]
pub struct PhotonTasks {
    /// Number of tasks.
    pub tasks: u32,
    /// Photons per task, which share a sequence of random numbers.
    pub photons: u32,
    /// Index of the set of photons: each has its own random numbers.
    pub set: u32,
    /// Seed of the random numbers.
    pub seed: u32,
}

impl PhotonTasks {
    /// Returns the number of emitted photons.
    pub fn emitted(&self) -> u32 {
        self.tasks * self.photons
    }

    /// Traces the photons on rayon's current pool and returns the receiver of each task. Incomplete if `control` is
    /// cancelled.
    pub fn trace<R: PhotonReceiver + Default + Send>(
        &self,
        scene: &RenderScene,
        starts: &StartDensity,
        control: &RenderControl,
    ) -> Vec<R> {
        let trace_task = |task: u32| {
            let mut receiver = R::default();
            if !control.is_cancelled() {
                let in_moment = |scene| PhotonTracer::new(scene, starts);
                let mut tracers: Vec<_> = scene.moments().iter().map(in_moment).collect();
                for index in 0..self.photons {
                    let sampler = Sampler::new(task, self.set, index, self.seed);
                    tracers[scene.moment_of(&sampler)].trace(&sampler, self.emitted(), &mut receiver);
                }
                control.count(tracers.iter().map(|tracer| tracer.caster.rays).sum(), 0);
            }
            receiver
        };
        (0..self.tasks).into_par_iter().map(trace_task).collect()
    }
}
