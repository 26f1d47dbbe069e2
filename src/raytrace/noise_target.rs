//! The end of a render by its noise: each tile takes samples until its noise is below a limit, and what is left can be
//! predicted.

use super::film::{Film, FilmTile, MIN_ROUGH_ESTIMATE_SPP};
use super::passes::PassSchedule;
use super::render_scene::RenderScene;
use super::settings::Settings;

/// Samples per pixel before a tile may be below a fine limit: fewer make the estimate unreliable.
const MIN_SPP: u32 = 8;
/// Limit from which a rough estimate will do, stops: it is off by a quarter at most.
const ROUGH_LIMIT_STOPS: f32 = 0.2;

/// The noise of a tile below which it takes no more samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTarget {
    limit_stops: f32,
}

impl NoiseTarget {
    /// Returns the target of a limit in stops.
    pub fn new(limit_stops: f32) -> Self {
        NoiseTarget { limit_stops }
    }

    /// Returns the target of a render; none where it takes a fixed number of samples.
    pub fn of(settings: &Settings) -> Option<Self> {
        settings.noise_stops.map(NoiseTarget::new)
    }

    /// Returns true if a render may end before it has all its samples.
    pub fn may_end(settings: &Settings) -> bool {
        NoiseTarget::of(settings).is_some_and(|target| target.least_spp() < settings.spp)
    }

    /// Returns the noise below which a tile takes no more samples, stops.
    pub fn limit_stops(&self) -> f32 {
        self.limit_stops
    }

    /// Returns the samples per pixel that every tile takes.
    pub fn least_spp(&self) -> u32 {
        if self.limit_stops >= ROUGH_LIMIT_STOPS { MIN_ROUGH_ESTIMATE_SPP } else { MIN_SPP }
    }

    /// Returns true if a tile needs no more samples. One too dark for an estimate needs no more than the least number.
    pub fn is_met(&self, tile: &FilmTile) -> bool {
        let noise = tile.blocks.rough_noise_stops(tile.mean());
        tile.spp() >= self.least_spp() && noise.is_none_or(|noise| noise <= self.limit_stops)
    }

    /// Predicts the samples per pixel after which a tile is below the limit, by the passes of a schedule.
    fn predicted_spp(&self, tile: &FilmTile, schedule: &PassSchedule) -> u32 {
        let (mut spp, mean) = (tile.spp(), tile.mean());
        let is_met = |spp: u32| {
            let noise = tile.blocks.predicted_noise_stops(spp, mean);
            spp >= self.least_spp() && noise.is_none_or(|noise| noise <= self.limit_stops)
        };
        while let Some(pass) = schedule.pass_after(spp).filter(|_| !is_met(spp)) {
            spp += pass.samples;
        }
        spp
    }
}

/// Predicts the rays that a render still needs to bring each tile below its noise limit, after so many rays of its tiles
/// and of what they share: photons and the cache, as many for each sample of the picture. None for a render of a fixed
/// number of samples, and before every tile has [`MIN_ROUGH_ESTIMATE_SPP`] samples.
pub fn predicted_rays_left(film: &Film, scene: &RenderScene, settings: &Settings, rays: u64) -> Option<u64> {
    let target = NoiseTarget::of(settings).filter(|_| film.spp() >= MIN_ROUGH_ESTIMATE_SPP)?;
    let schedule = PassSchedule::new(scene, settings);
    let (mut left, mut of_tiles, mut last_spp) = (0.0, 0, 0);
    for tile in film.tiles() {
        let spp = target.predicted_spp(tile, &schedule);
        let samples = u64::from(spp - tile.spp()) * tile.pixels() as u64;
        left += samples as f64 * tile.rays as f64 / tile.traced_samples.max(1) as f64;
        (of_tiles, last_spp) = (of_tiles + tile.rays, last_spp.max(spp));
    }
    let shared = rays.saturating_sub(of_tiles) as f64;
    let most_spp = film.most_spp();
    left += shared * f64::from(last_spp - most_spp) / f64::from(most_spp.max(1));
    Some(left as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{RenderControl, prepare, render};
    use crate::scene::{Assets, Emitter, Light, Output, Room, Scene};
    use glam::Vec3;
    use std::ops::ControlFlow;

    /// Renders a room under a bulb and returns its film, with the rays so far and the predicted rest after each pass.
    fn rendered(noise_stops: Option<f32>) -> (Film, Vec<(u64, Option<u64>)>) {
        let bulb = Emitter::Sphere { radius_m: 0.2 };
        let light = Light { position: Vec3::Y * 2.0, ..Light::new(bulb, Output::Lumens(1000.0)) };
        let scene = Scene { room: Some(Room::default()), lights: vec![light], ..Scene::default() };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 96, height: 64, spp: 256, noise_stops, ..Settings::default() };
        let control = RenderControl::new();
        let mut passes = Vec::new();
        let film = render(&prepared, &settings, &control, &mut |film| {
            passes.push((control.rays(), predicted_rays_left(film, &prepared, &settings, control.rays())));
            ControlFlow::Continue(())
        });
        (film, passes)
    }

    #[test]
    fn tiles_stop_below_the_limit_and_the_work_is_predicted_within_a_fifth_after_a_tenth_of_it() {
        let (film, passes) = rendered(Some(0.004));
        assert!(film.tile_noise().iter().all(|(spp, noise)| *spp == 256 || noise.is_none_or(|noise| noise <= 0.004)));
        assert!(film.spp() >= MIN_SPP && film.mean_spp() < 256.0, "{}", film.mean_spp());
        let total = passes.last().unwrap().0;
        let later = passes.iter().skip(1).filter(|(done, _)| 10 * done > total);
        for (done, left) in later {
            let ratio = (done + left.unwrap()) as f64 / total as f64;
            assert!((0.8..1.2).contains(&ratio), "{ratio} after {done} of {total} rays");
        }
    }

    #[test]
    fn a_coarse_limit_takes_two_samples_and_a_fixed_number_of_samples_has_no_prediction() {
        let (film, passes) = rendered(Some(0.5));
        assert_eq!(film.spp(), MIN_ROUGH_ESTIMATE_SPP);
        assert_eq!(passes[0].1, None, "one sample says nothing about noise");
        assert!(passes[1].1.is_some());
        let settings = Settings { noise_stops: None, ..Settings::default() };
        assert_eq!(NoiseTarget::of(&settings), None);
    }
}
