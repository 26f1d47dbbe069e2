//! The caustic view of a picture: the visible surfaces, and the density of photon starts that serves them.
//!
//! A close-up shows a small part of the studio, where few photons arrive that start everywhere. So photons start mostly
//! on those parts of the casters from which photons reached visible surfaces before (Peter and Pietrek 1998,
//! "Importance Driven Construction of Photon Maps"; Hachisuka and Jensen 2011, "Robust Adaptive Photon Tracing Using
//! Photon Path Visibility"). Their flux is divided by the density of their starts: the expected light is the same.

use super::grid::Positioned;
use super::photon::Photon;
use super::photon_spacing::PhotonSpacing;
use super::photon_tasks::PhotonTasks;
use super::photon_tracer::PhotonReceiver;
use super::start_density::{SECTIONS, StartDensity};
use super::start_learner::StartLearner;
use super::visible_points::{Surroundings, VisiblePoints};
use crate::raytrace::control::RenderControl;
use crate::raytrace::lens::PixelCamera;
use crate::raytrace::render_scene::RenderScene;
use glam::Vec3;
use rayon::prelude::*;

/// Rounds in which the density of starts is learned, each with the density that the last one has found.
const ROUNDS: u32 = 8;
/// Photons of a round that suffice to learn from.
const ENOUGH: usize = 64;
/// A round learns from photons near the visible points: within their radii if enough arrive there, or else within radii
/// that are wider by these factors.
const WIDENINGS: [f32; 7] = [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0];
/// Rounds that learn from photons within the points' own radii; no more are needed.
const EXACT_ROUNDS: u32 = 3;
/// Camera paths that find the visible points from which the density of starts is learned.
const PATHS: u32 = 4096;
/// Camera paths that find the distance of visible points alone.
const FEW_PATHS: u32 = 256;
/// Photons of a picture for each one to learn from.
const PHOTONS_PER_LEARNING_PHOTON: u64 = 4;
/// Photons of all rounds, at most.
const MAX_PHOTONS: u64 = 1 << 18;
/// The same for a picture with few photons of its own.
const MIN_PHOTONS: u64 = 1 << 16;
/// Photons of a task.
const TASK: u32 = 1 << 10;
/// Added to the seed, so that these photons and those of the picture have different random numbers.
const SEED: u32 = 0x76_69_65_77;

/// The visible surfaces of a picture, and the density of starts by which photons reach them.
#[derive(Debug)]
pub struct CausticView {
    /// Points on the visible surfaces.
    pub visible: VisiblePoints,
    /// Density of the photons' starts.
    pub starts: StartDensity,
    /// Spacing of the photons that arrive near the points; none if it is not known.
    pub spacing: Option<PhotonSpacing>,
    /// Width of a pixel at 1 m, metres.
    pub pixel_m: f32,
    /// Number of photons by which the density was learned.
    pub learning_photons: u64,
}

impl CausticView {
    /// The view of a camera. Photons start uniformly.
    pub fn unguided(scene: &RenderScene, camera: &impl PixelCamera) -> Self {
        Self::with_uniform_starts(scene, camera, FEW_PATHS)
    }

    /// The view of a camera by so many paths that find what is visible. Photons start uniformly.
    fn with_uniform_starts(scene: &RenderScene, camera: &impl PixelCamera, paths: u32) -> Self {
        let visible = VisiblePoints::trace(scene, camera, paths);
        let starts = StartDensity::default();
        CausticView { visible, starts, spacing: None, pixel_m: camera.pixel_m(), learning_photons: 0 }
    }

    /// Learns where photons start for a picture for which so many `photons` are traced, by a part of their number, on
    /// rayon's current pool. Of no use if `control` is cancelled.
    pub fn learn(
        scene: &RenderScene,
        camera: &impl PixelCamera,
        photons: u64,
        seed: u32,
        control: &RenderControl,
    ) -> Self {
        let mut view = Self::with_uniform_starts(scene, camera, PATHS);
        let all = (photons / PHOTONS_PER_LEARNING_PHOTON).clamp(MIN_PHOTONS, MAX_PHOTONS);
        let tasks = (all as u32 / ROUNDS).div_ceil(TASK);
        let mut learner = StartLearner::new(scene);
        let mut wider = Vec::new();
        let (mut widest, mut exact_rounds) = (WIDENINGS.len(), 0);
        for round in 0..ROUNDS {
            if control.is_cancelled() || exact_rounds == EXACT_ROUNDS {
                break;
            }
            let photons = PhotonTasks { tasks, photons: TASK, set: round, seed: seed ^ SEED };
            let recorders = photons.trace::<ArrivalRecorder>(scene, &view.starts, control);
            let arrived = recorders.into_iter().flat_map(|recorder| recorder.arrived).collect::<Vec<_>>();
            view.learning_photons += u64::from(photons.emitted());

            // Find the least radii within which enough photons arrive, at most those of the last round
            let (widening, near) = view.nearest(&arrived, widest, &mut wider);
            if near.is_empty() {
                break;
            }
            // Counts for other radii say nothing about these
            if widening < widest {
                learner.clear();
            }
            let sections: Vec<u16> = near.iter().map(|photon| photon.section).collect();
            learner.add(&view.starts, photons.emitted(), &sections);
            view.starts = learner.density();
            if widening < widest || near.len() >= ENOUGH {
                view.spacing = Some(PhotonSpacing::new(&near, photons.emitted()));
            }
            widest = widening;
            exact_rounds += u32::from(widening == 0);
        }
        view
    }

    /// Selects those photons that arrive near visible points: within the least radii that hold enough of them, up to
    /// the `widest`. Returns the index of the widening, too. `wider` keeps the widened points from round to round.
    fn nearest(
        &self,
        arrived: &[ArrivedPhoton],
        widest: usize,
        wider: &mut Vec<Surroundings>,
    ) -> (usize, Vec<ArrivedPhoton>) {
        let widest = widest.min(WIDENINGS.len() - 1);
        let mut near = Vec::new();
        for (index, factor) in WIDENINGS.into_iter().enumerate().take(widest + 1) {
            if wider.len() == index {
                wider.push(self.visible.surroundings(factor));
            }
            let within = arrived.par_iter().filter(|photon| wider[index].contains(photon.position));
            near = within.copied().collect();
            if near.len() >= ENOUGH {
                return (index, near);
            }
        }
        (widest, near)
    }
}

/// Start and end of a photon's path.
#[derive(Clone, Copy, Debug)]
struct ArrivedPhoton {
    position: Vec3,
    /// Section of the casters' curve in which it started.
    section: u16,
}

impl Positioned for ArrivedPhoton {
    fn position(&self) -> Vec3 {
        self.position
    }
}

/// Records where photons start and arrive.
#[derive(Debug, Default)]
struct ArrivalRecorder {
    /// Section of the present photon.
    section: u16,
    arrived: Vec<ArrivedPhoton>,
}

impl PhotonReceiver for ArrivalRecorder {
    fn start(&mut self, _photon: &Photon, curve_position: f64) {
        self.section = ((curve_position * SECTIONS as f64) as usize).min(SECTIONS - 1) as u16;
    }

    fn arrive(&mut self, photon: Photon) {
        self.arrived.push(ArrivedPhoton { position: photon.position, section: self.section });
    }
}
