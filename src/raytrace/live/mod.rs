//! The live picture: the path tracer at work while the studio is being arranged.
//!
//! [`LivePicture::update`] is told of every edit and every move of the view and keeps what is still true: all of it when a
//! light is dimmed, coloured or switched, the other lights' layers when one moves, what another view knows of the same
//! surfaces when the camera moves. [`LivePicture::work`] then traces for as long as it is told, coarse first, until every
//! tile is quiet. There is no clock in here: whoever calls measures how fast it goes and says how much to do.

mod camera;
mod change;
mod history;
mod live_film;
mod photons;
mod smooth;
#[cfg(test)]
mod tests;
mod tile;

pub use camera::LiveCamera;
pub use smooth::Smoother;

use super::control::RenderControl;
use super::film::{Layer, assign_layers};
use super::geometry_cache::GeometryCache;
use super::prepare::{self, PrepareError};
use super::render_scene::RenderScene;
use super::retrace::Retrace;
use crate::photo::Picture;
use crate::scene::{Assets, LightId, Scene};
use glam::Vec3;
use history::History;
use live_film::LiveFilm;
use photons::LivePhotons;
use rayon::prelude::*;
use std::sync::Arc;
use tile::{Job, LiveTile, Step};

/// Noise of a tile at which it is left alone, stops: grain that the eye finds only if it looks for it.
const QUIET_STOPS: f32 = 0.06;
/// The tracer's origin follows the view at this distance, metres, to keep its digits.
const FARTHEST_ORIGIN_M: f32 = 30.0;
/// Pixels between those of a picture that is worth keeping as the view's past.
const WORTH_KEEPING: u32 = 4;
/// Where the past knows of fewer pixels than this share, the picture at hand takes its place sooner.
const LITTLE_REUSED: f32 = 0.5;

/// A picture that is traced while the scene changes under it.
#[derive(Debug, Default)]
pub struct LivePicture {
    cache: Arc<GeometryCache>,
    traced: Option<Traced>,
    view: Option<View>,
    history: Option<History>,
    /// Memory of a picture that is of no use any more: getting and clearing a hundred megabytes takes its time.
    spare: Option<LiveFilm>,
}

/// What is being traced.
#[derive(Debug)]
struct Traced {
    /// The scene of `full`; see [`change::between`].
    scene: Scene,
    assets: Assets,
    /// The tracer's origin in world space.
    origin: Vec3,
    full: RenderScene,
    photons: LivePhotons,
    /// The picture's layers, as `full` has them.
    layers: Vec<Option<usize>>,
    /// Lights whose layers are behind, alone in the same studio.
    lagging: Option<Lagging>,
}

#[derive(Debug)]
struct Lagging {
    lights: Vec<LightId>,
    scene: RenderScene,
    photons: LivePhotons,
    /// The picture's layer of each of this scene's.
    layers: Vec<Option<usize>>,
}

/// From where, and what has been seen.
#[derive(Debug)]
struct View {
    camera: LiveCamera,
    film: LiveFilm,
}

impl LivePicture {
    /// A picture that shares its meshes' trees with others.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        LivePicture { cache, ..LivePicture::default() }
    }

    /// Takes in the scene and the view as they are now. What is still true is kept, the rest will be traced.
    ///
    /// # Errors
    /// When the scene cannot be rendered; the picture is then empty.
    pub fn update(&mut self, scene: &Scene, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        let far = |traced: &Traced| {
            traced.origin.distance(camera.natural_origin(traced.scene.room.as_ref())) > FARTHEST_ORIGIN_M
        };
        let kept = self.traced.as_ref().zip(self.view.as_ref());
        let kept = kept.filter(|(traced, _)| !far(traced) && change::same_assets(&traced.assets, assets));
        let (wanted, retrace) = match kept {
            Some((traced, view)) => change::between(&traced.scene, &view.film.layers, scene),
            None => (scene.clone(), Retrace::Everything),
        };
        match retrace {
            Retrace::Nothing => {}
            Retrace::Lights(changed) => self.take_lights(wanted, changed)?,
            Retrace::Everything => return self.begin(wanted, assets, camera),
        }
        self.look_from(camera);
        Ok(())
    }

    /// Everything anew.
    fn begin(&mut self, scene: Scene, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        self.spare = self.view.take().map(|view| view.film).or(self.spare.take());
        (self.traced, self.history) = (None, None);
        let origin = camera.natural_origin(scene.room.as_ref());
        let full = prepare::prepare_all(&scene, assets, origin, assign_layers, &self.cache)?;
        let (film_layers, camera) = (full.layers.clone(), camera.around(origin, scene.room.as_ref()));
        let layers = (0..film_layers.len()).map(Some).collect();
        self.view = Some(View { camera, film: LiveFilm::reusing(self.spare.take(), camera.size, film_layers) });
        let (assets, photons) = (assets.clone(), LivePhotons::default());
        self.traced = Some(Traced { scene, assets, origin, full, photons, layers, lagging: None });
        Ok(())
    }

    /// Some lights shine differently: their layers start anew, beside those of lights that have not caught up yet.
    fn take_lights(&mut self, wanted: Scene, mut changed: Vec<LightId>) -> Result<(), PrepareError> {
        let (Some(traced), Some(view)) = (&mut self.traced, &mut self.view) else { return Ok(()) };
        changed.extend(traced.lagging.iter().flat_map(|lagging| &lagging.lights));
        let prepared =
            |scene: &Scene| prepare::prepare_all(scene, &traced.assets, traced.origin, assign_layers, &self.cache);
        let full = prepared(&wanted)?;
        let mut alone = wanted.clone();
        alone.lights.retain(|light| changed.contains(&light.id));
        let alone = prepared(&alone)?;
        let new = full.layers.clone();
        let place = |layers: &[Layer], layer: &Layer| layers.iter().position(|l| l.light == layer.light);
        let is_behind = |layer: &Layer| layer.light.is_some_and(|id| changed.contains(&id));
        let from: Vec<Option<usize>> =
            new.iter().map(|layer| place(&view.film.layers, layer).filter(|_| !is_behind(layer))).collect();
        let of_alone = |layer: &Layer| layer.light.and_then(|_| place(&new, layer));
        let layers: Vec<Option<usize>> = alone.layers.iter().map(of_alone).collect();
        (traced.scene, traced.full, traced.photons) = (wanted, full, LivePhotons::default());
        traced.layers = (0..new.len()).map(Some).collect();
        let photons = LivePhotons::default();
        let lagging = || Lagging { lights: changed, scene: alone, photons, layers: layers.clone() };
        traced.lagging = layers.iter().any(Option::is_some).then(lagging);
        view.film.remap(new, &from);
        // The past has other layers.
        self.history = None;
        Ok(())
    }

    /// Another view of the same studio.
    fn look_from(&mut self, camera: LiveCamera) {
        let (Some(traced), Some(view)) = (&mut self.traced, &mut self.view) else { return };
        let camera = camera.around(traced.origin, traced.scene.room.as_ref());
        if camera == view.camera {
            return;
        }
        let old_camera = std::mem::replace(&mut view.camera, camera);
        let layers = view.film.layers.clone();
        let old = std::mem::take(&mut view.film);
        (traced.lagging, traced.photons) = (None, LivePhotons::default());
        if camera.has_aperture() || old_camera.has_aperture() {
            (self.history, self.spare) = (None, Some(old));
        } else if let Some(stride) = old.stride().filter(|stride| is_worth_keeping(&old, *stride, &self.history)) {
            self.spare = self.history.take().map(History::into_film).or(self.spare.take());
            self.history = Some(History::new(old, old_camera, stride));
        } else {
            self.spare = Some(old);
        }
        view.film = LiveFilm::reusing(self.spare.take(), camera.size, layers);
    }

    /// Traces about `paths` paths, or until `control` is cancelled, on rayon's current pool; the coarsest tiles first.
    /// Returns how many it did; 0 when nothing is left to do.
    pub fn work(&mut self, paths: u64, control: &RenderControl) -> u64 {
        let (Some(traced), Some(view)) = (&mut self.traced, &mut self.view) else { return 0 };
        let mut spent = 0;
        while spent < paths && !control.is_cancelled() {
            let active = || view.film.tiles.iter().filter(|tile| tile.is_active());
            let Some(next) = active().map(|tile| tile.progress.next()).min() else { break };
            let mut tiles: Vec<&mut LiveTile> = Vec::new();
            for tile in view.film.tiles.iter_mut().filter(|tile| tile.is_active() && tile.progress.next() == next) {
                if spent >= paths {
                    break;
                }
                spent += Step::after(next).cost(tile.pixels()).max(1);
                tiles.push(tile);
            }
            let (camera, history) = (&view.camera, self.history.as_ref());
            let sample = Step::samples(next);
            if tiles.iter().any(|tile| !tile.progress.lags()) {
                spent += traced.photons.prepare(&traced.full, camera, sample, control);
            }
            if let Some(Lagging { scene, photons, .. }) = &mut traced.lagging {
                spent += photons.prepare(scene, camera, sample, control);
            }
            let times = &traced.full.layer_times;
            let noise_stops = QUIET_STOPS;
            let job =
                |scene, caustics, layers| Job { scene, layers, times, camera, caustics, history, noise_stops, control };
            let full = job(&traced.full, traced.photons.map(), &traced.layers);
            let alone = traced.lagging.as_ref().map(|l| job(&l.scene, l.photons.map(), &l.layers));
            tiles.par_iter_mut().with_max_len(1).for_each(|tile| match &alone {
                Some(alone) if tile.progress.lags() => tile.advance(alone),
                Some(_) | None => tile.advance(&full),
            });
        }
        if traced.lagging.is_some() && !view.film.tiles.iter().any(|tile| tile.progress.lags()) {
            traced.lagging = None;
        }
        spent
    }

    /// Whether nothing is left to do: every tile is quiet, or has been sampled enough.
    pub fn is_done(&self) -> bool {
        self.view.as_ref().is_none_or(|view| !view.film.tiles.iter().any(LiveTile::is_active))
    }

    /// Whether there is something to show: a value at every sixteenth pixel, at least.
    pub fn is_begun(&self) -> bool {
        self.stride().is_some()
    }

    /// Pixels between those that have a value of their own; none before there are any.
    pub fn stride(&self) -> Option<u32> {
        self.view.as_ref().and_then(|view| view.film.stride())
    }

    /// Samples that every pixel has.
    pub fn spp(&self) -> u32 {
        self.view.as_ref().map_or(0, |view| view.film.spp())
    }

    /// Share of the pixels that took over what was known from before the view moved.
    pub fn reused(&self) -> f32 {
        self.view.as_ref().map_or(0.0, |view| view.film.reused())
    }

    /// Non-finite contributions that were dropped and are shown black.
    pub fn nonfinite(&self) -> u64 {
        self.view.as_ref().map_or(0, |view| view.film.tiles.iter().map(|tile| tile.nonfinite).sum())
    }

    /// The picture with exposure, and each light's power, colour and switch, as in `scene`. Empty before there is one.
    pub fn develop(&self, scene: &Scene) -> Picture {
        self.develop_every(scene, 1)
    }

    /// The same for a grid of its pixels, each `every`th across and down, which is 1, 2, 4, 8 or 16: quicker, and no worse
    /// while no more of them are traced.
    pub fn develop_every(&self, scene: &Scene, every: u32) -> Picture {
        self.view.as_ref().map_or_else(Picture::default, |view| view.film.develop(scene, &view.camera, every))
    }

    /// The same with less grain, by an edge-aware filter: for the eye, while the picture settles. See [`smooth`].
    pub fn develop_smooth(&self, scene: &Scene, every: u32, smoother: &mut Smoother) -> Picture {
        let mut picture = self.develop_every(scene, every);
        if let Some(view) = &self.view {
            smoother.smooth(&mut picture, |x, y| view.film.guide(&view.camera, every, (x, y)));
        }
        picture
    }

    /// Steps that every tile has done: a coarse grid of paths, a finer one, surfaces at every fourth pixel, every second,
    /// every one, then ever more paths. What the camera's last move left is on show from [`LivePicture::SEEN`] on.
    pub fn steps(&self) -> u32 {
        let tiles = self.view.iter().flat_map(|view| &view.film.tiles);
        tiles.map(|tile| tile.progress.next()).min().unwrap_or(0)
    }

    /// Steps after which every second pixel knows its surface, and what is known of it.
    pub const SEEN: u32 = 4;

    /// Of how many pixels one is worth developing, along each side: there is nothing finer to show yet.
    pub fn coarseness(&self) -> u32 {
        let steps = self.steps();
        match self.stride() {
            Some(1) => 1,
            // What is taken over from before is as fine as the surfaces are known.
            _ if self.history.is_some() && steps > Self::SEEN => 1,
            _ if self.history.is_some() && steps == Self::SEEN => 2,
            Some(stride) if stride < 8 => 1,
            Some(_) => 4,
            None => 16,
        }
    }
}

/// Whether a picture that the view has left tells more about the next one than what was kept before.
fn is_worth_keeping(film: &LiveFilm, stride: u32, known: &Option<History>) -> bool {
    match known {
        None => stride <= WORTH_KEEPING,
        Some(_) => stride == 1 || (stride <= WORTH_KEEPING && film.reused() < LITTLE_REUSED),
    }
}
