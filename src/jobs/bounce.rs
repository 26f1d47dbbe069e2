//! The bounced light of the live view: traced on a grid of probes, first quickly, then with less noise. The command line
//! traces once, the window in the background.

use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::photo::irradiance_grid::IrradianceGrid;
use crate::raytrace::{GeometryCache, IrradianceProbes, PrepareError, ProbeScene, RenderControl};
use crate::scene::{Assets, LightId, Scene};
use std::sync::Arc;

/// Paths of each probe in the first gather: some 0.1 s for a studio.
const QUICK_PATHS: u32 = 24;
/// Paths of each probe in the last gather: some 5 % noise at a probe.
const FULL_PATHS: u32 = 256;

/// Traces the bounced light of a scene, or that of one light alone; none where nothing bounces light.
///
/// # Errors
/// When the scene cannot be prepared.
pub fn trace_bounced_light(
    scene: &Scene,
    assets: &Assets,
    only_light: Option<LightId>,
) -> Result<Option<IrradianceGrid>, PrepareError> {
    let prepared = ProbeScene::new(scene, assets, &GeometryCache::default())?;
    let probes = prepared.and_then(|prepared| prepared.trace(FULL_PATHS, &RenderControl::new()));
    Ok(probes.map(|probes| develop(&probes, scene, only_light)))
}

/// Develops the light of all lights, or of one alone.
fn develop(probes: &IrradianceProbes, scene: &Scene, only_light: Option<LightId>) -> IrradianceGrid {
    let Some(id) = only_light else { return probes.develop(scene) };
    let mut alone = scene.clone();
    alone.lights.iter_mut().for_each(|light| light.on &= light.id == id);
    probes.develop(&alone)
}

#[derive(Debug)]
struct Request {
    scene: Scene,
    assets: Assets,
}

/// The bounced light of the open studio, in the background.
#[derive(Debug)]
pub struct BounceJob {
    worker: Worker<Request, Option<IrradianceProbes>>,
    /// Revision of the image, and the light that was shown alone, at the last update.
    seen: Option<(u64, Option<LightId>)>,
    /// The scene that was requested last, and its revision of the surfaces.
    requested: Option<(Scene, u64)>,
    probes: Option<IrradianceProbes>,
    grid: Option<Arc<IrradianceGrid>>,
    /// Number of grids so far.
    generation: u64,
}

/// The quick gather is always finished: the light follows the mouse in a drag.
const WORKER: WorkerSettings = WorkerSettings {
    name: "bounced light",
    priority: Priority::Background,
    interrupt: Interrupt::AfterResult,
    panic_message: "The bounced light failed. This is an error in Catchlight.",
};

impl Default for BounceJob {
    fn default() -> Self {
        BounceJob {
            worker: Worker::new(WORKER, serve),
            seen: None,
            requested: None,
            probes: None,
            grid: None,
            generation: 0,
        }
    }
}

impl BounceJob {
    /// Takes in the newest result, develops it again after a change of the image, and requests another where that is not
    /// enough. To be called once a frame with the revisions of image and surfaces; equal numbers mean no change.
    pub fn update(
        &mut self,
        scene: &Scene,
        assets: &Assets,
        only_light: Option<LightId>,
        (image, surfaces): (u64, u64),
        wake: &Wake,
    ) {
        let traced = match self.worker.take() {
            Some(Ok(probes)) => {
                self.probes = probes;
                true
            }
            // The view has its estimates without traced light, too.
            Some(Err(message)) => {
                log::debug!("no bounced light: {message}");
                self.probes = None;
                true
            }
            None => false,
        };
        let changed = self.seen != Some((image, only_light));
        if changed {
            self.seen = Some((image, only_light));
            let is_enough = |(requested, known): &(Scene, u64)| {
                *known == surfaces && IrradianceProbes::can_follow(requested, scene)
            };
            if !self.requested.as_ref().is_some_and(is_enough) {
                self.requested = Some((scene.clone(), surfaces));
                self.worker.request(Request { scene: scene.clone(), assets: assets.clone() }, wake);
            }
        }
        if traced || changed {
            let grid = self.probes.as_ref().map(|probes| Arc::new(develop(probes, scene, only_light)));
            self.generation += u64::from(grid != self.grid);
            self.grid = grid;
        }
    }

    /// Returns the bounced light; none until the first result is there, and where there is nothing that bounces light.
    pub fn grid(&self) -> Option<Arc<IrradianceGrid>> {
        self.grid.clone()
    }

    /// Returns a number that differs for each grid.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns true while paths are traced.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

/// The body of the thread.
fn serve(inbox: &Inbox<Request, Option<IrradianceProbes>>) {
    let pool = match background_pool(0, "bounced light") {
        Ok(pool) => pool,
        Err(error) => return inbox.fail_all(&format!("No threads to trace bounced light with: {error}.")),
    };
    let cache = GeometryCache::default();
    while let Some((Request { scene, assets }, control)) = inbox.next() {
        let gather = || -> Result<(), PrepareError> {
            let Some(prepared) = ProbeScene::new(&scene, &assets, &cache)? else {
                inbox.publish(None);
                return Ok(());
            };
            for paths in [QUICK_PATHS, FULL_PATHS] {
                match prepared.trace(paths, &control) {
                    Some(probes) => inbox.publish(Some(probes)),
                    None => break,
                }
            }
            Ok(())
        };
        if let Err(error) = pool.install(gather) {
            inbox.fail(error.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Light, Output, Room};
    use glam::Vec3;
    use std::sync::mpsc::channel;

    fn sum(grid: &IrradianceGrid) -> Vec3 {
        grid.probes.iter().flatten().sum()
    }

    #[test]
    fn light_arrives_in_the_background_a_dimmed_light_costs_no_path_and_a_moved_one_is_traced() {
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let lamp = Light { position: Vec3::Y * 2.0, ..Light::new(Emitter::Point, Output::Lumens(5000.0)) };
        let mut scene = Scene { room: Some(Room::default()), lights: vec![lamp], ..Scene::default() };
        let (mut job, assets) = (BounceJob::default(), Assets::default());
        job.update(&scene, &assets, None, (1, 1), &wake);
        assert!(job.is_busy() && job.grid().is_none());
        while job.is_busy() || job.grid().is_none() {
            woken.recv().unwrap();
            job.update(&scene, &assets, None, (1, 1), &wake);
        }
        let bright = job.grid().unwrap();
        assert!(sum(&bright).min_element() > 0.0);

        scene.lights[0].power.dial_stops = -1.0;
        job.update(&scene, &assets, None, (2, 1), &wake);
        assert!(!job.is_busy() && (sum(&job.grid().unwrap()) / sum(&bright) - 0.5).abs().max_element() < 1e-4);
        let (other, generation) = (LightId(9), job.generation());
        job.update(&scene, &assets, Some(other), (2, 1), &wake);
        assert_eq!((sum(&job.grid().unwrap()), job.is_busy()), (Vec3::ZERO, false), "another light is shown alone");
        assert_ne!(job.generation(), generation);

        scene.lights[0].position.x += 0.5;
        job.update(&scene, &assets, None, (3, 1), &wake);
        assert!(job.is_busy() && job.grid().is_some(), "the former light is shown until the new one is there");
    }
}
