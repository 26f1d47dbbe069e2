//! The live view: the path tracer with progressive refinement while the user arranges the studio.
//!
//! [`LivePicture::update`] receives every edit and every camera move and keeps the samples that are still valid: all of them
//! when a light is dimmed, coloured or switched; the other lights' layers when one light moves; the history,
//! reprojected, when the camera moves; and what is not water when water moves on. [`LivePicture::trace`] then traces a given number of paths, the coarsest tiles
//! first, until every tile is converged. There is no clock here: the caller measures the speed and chooses the number
//! of paths.

mod atrous_filter;
mod camera;
mod change;
mod history;
mod live_film;
mod live_tile;
mod photons;
mod primary_hit;
mod refinement;
#[cfg(test)]
mod tests;
mod tile_tracer;

pub use atrous_filter::AtrousFilter;
pub use camera::LiveCamera;

use super::control::RenderControl;
use super::film::{Layer, NonFiniteReport, assign_layers};
use super::geometry_cache::GeometryCache;
use super::prepare::{self, PrepareError, Viewpoint};
use super::render_scene::RenderScene;
use super::retrace::Retrace;
use crate::photo::Picture;
use crate::scene::{Assets, LightId, Scene};
use glam::Vec3;
use history::{FLOW_WEIGHT, MAX_WEIGHT, ReprojectionHistory};
use live_film::LiveFilm;
use live_tile::LiveTile;
use photons::LivePhotons;
use rayon::prelude::*;
use refinement::RefinementStep;
use std::sync::Arc;
use tile_tracer::{RefinementContext, refine};

/// Noise at which a tile is converged, stops: barely visible.
const CONVERGED_STOPS: f32 = 0.06;
/// Distance between the camera and the tracer's origin at which the origin moves, metres, for floating-point accuracy.
const MAX_ORIGIN_DISTANCE_M: f32 = 30.0;
/// Coarsest grid spacing of a picture that becomes the history, pixels.
const MAX_HISTORY_STRIDE: u32 = 4;
/// Fraction of reprojected pixels below which a coarse picture replaces the history.
const LOW_REPROJECTION: f32 = 0.5;

/// A progressively refined picture of a scene that is being edited.
#[derive(Debug, Default)]
pub struct LivePicture {
    cache: Arc<GeometryCache>,
    prepared: Option<PreparedScene>,
    view: Option<View>,
    history: Option<ReprojectionHistory>,
    /// A film whose memory is reused: allocating and clearing a hundred megabytes takes milliseconds.
    recycled: Option<LiveFilm>,
}

/// The scene as it is traced.
#[derive(Debug)]
struct PreparedScene {
    /// The source of `full`; see [`change::between`].
    scene: Scene,
    assets: Assets,
    /// The tracer's origin in world space.
    origin: Vec3,
    /// The scene with all lights.
    full: RenderScene,
    photons: LivePhotons,
    /// The film's layer of each of the layers of `full`.
    film_layers: Vec<Option<usize>>,
    /// The lights whose layers have fewer samples than the others.
    retraced: Option<RetracedLights>,
}

/// The scene with the retraced lights alone.
#[derive(Debug)]
struct RetracedLights {
    lights: Vec<LightId>,
    scene: RenderScene,
    photons: LivePhotons,
    /// The film's layer of each of this scene's layers.
    film_layers: Vec<Option<usize>>,
}

/// The camera and the film that it exposes.
#[derive(Debug)]
struct View {
    camera: LiveCamera,
    film: LiveFilm,
}

impl LivePicture {
    /// A picture that shares the BVHs of meshes with others.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        LivePicture { cache, ..LivePicture::default() }
    }

    /// Sets the scene and the view. Samples that are still valid are kept.
    ///
    /// # Errors
    /// When the scene cannot be rendered; the picture is then empty.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        let is_far = |prepared: &PreparedScene| {
            let origin = camera.natural_origin(prepared.scene.room.as_ref());
            prepared.origin.distance(origin) > MAX_ORIGIN_DISTANCE_M
        };
        let kept = self.prepared.as_ref().zip(self.view.as_ref()).filter(|(prepared, _)| !is_far(prepared));
        if kept.is_some_and(|(prepared, view)| change::only_flows(&prepared.scene, &view.film.layers, scene)) {
            return self.flow(scene.clone(), assets, camera);
        }
        let kept = kept.filter(|(prepared, _)| prepared.assets.is_same(assets));
        let (to_trace, retrace) = match kept {
            Some((prepared, view)) => change::between(&prepared.scene, &view.film.layers, scene),
            None => (scene.clone(), Retrace::Everything),
        };
        match retrace {
            Retrace::Nothing => {}
            Retrace::Lights(lights) => self.retrace_lights(to_trace, lights)?,
            Retrace::Everything => return self.restart(to_trace, assets, camera),
        }
        self.move_camera(camera);
        Ok(())
    }

    /// Discards all samples and prepares the scene.
    fn restart(&mut self, scene: Scene, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        self.recycled = self.view.take().map(|view| view.film).or(self.recycled.take());
        (self.prepared, self.history) = (None, None);
        let origin = camera.natural_origin(scene.room.as_ref());
        self.begin(scene, assets, camera, origin)
    }

    /// Prepares a scene whose water has moved on; the picture becomes the history if it is better than the one there is.
    fn flow(&mut self, scene: Scene, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        let (Some(prepared), Some(view)) = (self.prepared.take(), self.view.take()) else {
            return self.restart(scene, assets, camera);
        };
        self.retire(view.film, view.camera, &camera, FLOW_WEIGHT);
        self.begin(scene, assets, camera, prepared.origin)
    }

    /// Prepares the scene and begins a picture of it.
    fn begin(&mut self, scene: Scene, assets: &Assets, camera: LiveCamera, origin: Vec3) -> Result<(), PrepareError> {
        let camera = camera.around(origin, scene.room.as_ref());
        let viewpoint = Viewpoint { origin, view: Some(camera.strand_view()) };
        let full = prepare::prepare_all(&scene, assets, &viewpoint, assign_layers, &self.cache)?;
        let layers = full.layers.clone();
        let film_layers = (0..layers.len()).map(Some).collect();
        self.view = Some(View { camera, film: LiveFilm::recycling(self.recycled.take(), camera.size, layers) });
        let (assets, photons) = (assets.clone(), LivePhotons::default());
        self.prepared = Some(PreparedScene { scene, assets, origin, full, photons, film_layers, retraced: None });
        Ok(())
    }

    /// Discards the layers of some lights, beside those of lights that are being retraced already.
    fn retrace_lights(&mut self, scene: Scene, mut lights: Vec<LightId>) -> Result<(), PrepareError> {
        let (Some(prepared), Some(view)) = (&mut self.prepared, &mut self.view) else { return Ok(()) };
        lights.extend(prepared.retraced.iter().flat_map(|retraced| &retraced.lights));

        // Prepare the scene with all lights, and with the retraced ones alone
        let viewpoint = Viewpoint { origin: prepared.origin, view: Some(view.camera.strand_view()) };
        let prepare_lights =
            |scene: &Scene| prepare::prepare_all(scene, &prepared.assets, &viewpoint, assign_layers, &self.cache);
        let full = prepare_lights(&scene)?;
        let mut retraced_only = scene.clone();
        retraced_only.lights.retain(|light| lights.contains(&light.id));
        let retraced_scene = prepare_lights(&retraced_only)?;

        // Map the film's layers: former to new, and those of the retraced scene to the film's
        let layers = full.layers.clone();
        let position = |layers: &[Layer], layer: &Layer| layers.iter().position(|other| other.light == layer.light);
        let is_retraced = |layer: &Layer| layer.light.is_some_and(|id| lights.contains(&id));
        let kept = |layer: &Layer| position(&view.film.layers, layer).filter(|_| !is_retraced(layer));
        let from: Vec<Option<usize>> = layers.iter().map(kept).collect();
        let in_film = |layer: &Layer| layer.light.and_then(|_| position(&layers, layer));
        let film_layers: Vec<Option<usize>> = retraced_scene.layers.iter().map(in_film).collect();

        // Replace the scene and the layers; the history has the former layers
        (prepared.scene, prepared.full, prepared.photons) = (scene, full, LivePhotons::default());
        prepared.film_layers = (0..layers.len()).map(Some).collect();
        let has_layers = film_layers.iter().any(Option::is_some);
        let photons = LivePhotons::default();
        let retraced = RetracedLights { lights, scene: retraced_scene, photons, film_layers };
        prepared.retraced = has_layers.then_some(retraced);
        view.film.remap(layers, &from);
        self.history = None;
        Ok(())
    }

    /// Moves the camera; the picture becomes the history if it is better than the one there is.
    fn move_camera(&mut self, camera: LiveCamera) {
        let (Some(prepared), Some(view)) = (&mut self.prepared, &mut self.view) else { return };
        let camera = camera.around(prepared.origin, prepared.scene.room.as_ref());
        if camera == view.camera {
            return;
        }
        prepared.full.thin_strands(&camera.strand_view());
        let old_camera = std::mem::replace(&mut view.camera, camera);
        let layers = view.film.layers.clone();
        let old_film = std::mem::take(&mut view.film);
        (prepared.retraced, prepared.photons) = (None, LivePhotons::default());
        self.retire(old_film, old_camera, &camera, MAX_WEIGHT);
        if let Some(view) = &mut self.view {
            view.film = LiveFilm::recycling(self.recycled.take(), camera.size, layers);
        }
    }

    /// Makes a picture the history for another camera if it is better than the one there is; keeps its memory otherwise.
    fn retire(&mut self, film: LiveFilm, camera: LiveCamera, next: &LiveCamera, max_weight: f32) {
        if camera.has_aperture() || next.has_aperture() {
            (self.history, self.recycled) = (None, Some(film));
        } else if let Some(stride) = film.stride().filter(|stride| self.is_better_history(&film, *stride)) {
            self.recycled = self.history.take().map(ReprojectionHistory::into_film).or(self.recycled.take());
            self.history = Some(ReprojectionHistory::new(film, camera, stride, max_weight));
        } else {
            self.recycled = Some(film);
        }
    }

    /// Returns true if a picture is a better history than the one there is.
    fn is_better_history(&self, film: &LiveFilm, stride: u32) -> bool {
        match &self.history {
            None => stride <= MAX_HISTORY_STRIDE,
            Some(_) => stride == 1 || (stride <= MAX_HISTORY_STRIDE && film.reprojected_fraction() < LOW_REPROJECTION),
        }
    }

    /// Traces about `paths` paths, or until `control` is cancelled, on rayon's current pool; the coarsest tiles first.
    /// Returns the number of paths; 0 when every tile is converged.
    pub fn trace(&mut self, paths: u64, control: &RenderControl) -> u64 {
        let (Some(prepared), Some(view)) = (&mut self.prepared, &mut self.view) else { return 0 };
        let mut traced = 0;
        while traced < paths && !control.is_cancelled() {
            // Choose the tiles with the fewest completed steps, as many as the budget pays for
            let completed = |tile: &LiveTile| tile.progress.completed();
            let Some(fewest) = view.film.tiles.iter().filter(|tile| tile.is_active()).map(completed).min() else {
                break;
            };
            let mut tiles: Vec<&mut LiveTile> = Vec::new();
            for tile in view.film.tiles.iter_mut().filter(|tile| tile.is_active() && completed(tile) == fewest) {
                if traced >= paths {
                    break;
                }
                traced += RefinementStep::after(fewest).cost(tile.pixels()).max(1);
                tiles.push(tile);
            }

            // Trace the photons of the pass
            let (camera, history) = (&view.camera, self.history.as_ref());
            let sample = RefinementStep::samples(fewest);
            if tiles.iter().any(|tile| !tile.progress.is_retracing()) {
                traced += prepared.photons.prepare(&prepared.full, camera, sample, control);
            }
            if let Some(RetracedLights { scene, photons, .. }) = &mut prepared.retraced {
                traced += photons.prepare(scene, camera, sample, control);
            }

            // Refine the tiles in parallel: all layers, or those of the retraced lights
            let (layer_times, noise_stops) = (&prepared.full.layer_times, CONVERGED_STOPS);
            let context = |scene, photons, film_layers| RefinementContext {
                scene,
                film_layers,
                layer_times,
                camera,
                photons,
                history,
                noise_stops,
                control,
            };
            let full = context(&prepared.full, prepared.photons.map(), &prepared.film_layers);
            let retraced = prepared.retraced.as_ref().map(|r| context(&r.scene, r.photons.map(), &r.film_layers));
            tiles.par_iter_mut().with_max_len(1).for_each(|tile| match &retraced {
                Some(retraced) if tile.progress.is_retracing() => refine(tile, retraced),
                Some(_) | None => refine(tile, &full),
            });
        }
        if !view.film.tiles.iter().any(|tile| tile.progress.is_retracing()) {
            prepared.retraced = None;
        }
        traced
    }

    /// Returns true if every tile is converged, or has the maximum of samples.
    pub fn is_converged(&self) -> bool {
        self.view.as_ref().is_none_or(|view| !view.film.tiles.iter().any(LiveTile::is_active))
    }

    /// Returns true if there is a picture to develop: a value at every sixteenth pixel at least.
    pub fn has_picture(&self) -> bool {
        self.stride().is_some()
    }

    /// Spacing of the pixels that have a value; `None` before there are any.
    pub fn stride(&self) -> Option<u32> {
        self.view.as_ref().and_then(|view| view.film.stride())
    }

    /// Samples that every pixel has.
    pub fn spp(&self) -> u32 {
        self.view.as_ref().map_or(0, |view| view.film.spp())
    }

    /// Fraction of the pixels that took their value from the history.
    pub fn reprojected_fraction(&self) -> f32 {
        self.view.as_ref().map_or(0.0, |view| view.film.reprojected_fraction())
    }

    /// The non-finite contributions that were discarded and are shown black.
    pub fn nonfinite(&self) -> NonFiniteReport {
        self.view.iter().flat_map(|view| view.film.tiles.iter().map(|tile| &tile.nonfinite)).collect()
    }

    /// Develops the picture with the exposure, and each light's power, colour and switch, in `scene`. Empty before
    /// there is one.
    pub fn develop(&self, scene: &Scene) -> Picture {
        self.develop_strided(scene, 1)
    }

    /// Develops every `stride`th pixel of every `stride`th row, which is 1, 2, 4, 8 or 16.
    pub fn develop_strided(&self, scene: &Scene, stride: u32) -> Picture {
        self.view.as_ref().map_or_else(Picture::default, |view| view.film.develop(scene, &view.camera, stride))
    }

    /// Develops with an edge-aware filter, for display until the picture is converged. The samples stay as they are.
    pub fn develop_filtered(&self, scene: &Scene, stride: u32, filter: &mut AtrousFilter) -> Picture {
        let mut picture = self.develop_strided(scene, stride);
        if let Some(view) = &self.view {
            filter.apply(&mut picture, |x, y| view.film.filter_input(&view.camera, stride, (x, y)));
        }
        picture
    }

    /// Refinement steps that every tile has completed: a coarse grid of paths, a finer one, primary hits at every
    /// fourth pixel, every second, every one, paths at the pixels between, then sample passes.
    pub fn completed_steps(&self) -> u32 {
        self.view.as_ref().map_or(0, |view| view.film.completed_steps())
    }

    /// Steps after which every second pixel has its primary hit and its history.
    pub const HISTORY_STEPS: u32 = 4;

    /// Spacing of the pixels to develop for display: a finer grid has no more detail yet.
    pub fn display_stride(&self) -> u32 {
        let steps = self.completed_steps();
        match self.stride() {
            Some(1) => 1,
            // The history is as fine as the primary hits.
            _ if self.history.is_some() && steps > Self::HISTORY_STEPS => 1,
            _ if self.history.is_some() && steps == Self::HISTORY_STEPS => 2,
            Some(stride) if stride < 8 => 1,
            Some(_) => 4,
            None => 16,
        }
    }
}
