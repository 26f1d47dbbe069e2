//! How long a render will take and how much grain it will have: from a pilot run of the studio, and from what renders
//! really took.
//!
//! Grain falls with the root of the samples, or faster where stratified samples do better: the pilot tells how much.
//! Time grows with samples and pixels. The pilot is the picture at the size of a thumbnail: a pixel of it costs about what
//! a pixel of the large one does, and scatters a little more, because it holds more edges.

use super::threads::background_pool;
use super::{Wake, lock};
use crate::raytrace::{self, Film, GeometryCache, RenderControl, Settings};
use crate::scene::{Assets, Camera, Scene};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Long edge of the pilot's picture, pixels.
const PILOT_EDGE: u32 = 120;
/// Its samples a pixel.
const PILOT_SPP: u32 = 16;
/// How long the studio must have been left alone before a pilot runs.
const AT_REST: Duration = Duration::from_millis(700);

/// Time and grain of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// From the button to the picture, seconds.
    pub seconds: f64,
    /// Noise of a pixel against its surroundings' brightness, stops.
    pub noise_stops: f64,
}

/// What is known of the cost of a studio's picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Trees and tables, seconds.
    build_s: f64,
    /// Samples of a pixel that all threads take in a second.
    samples_s: f64,
    /// Relative error of a pixel with `spp` samples.
    error: f64,
    spp: f64,
    /// Power of the samples with which the error falls.
    falls: f64,
}

/// Powers that are believed: the root of independent samples, and what stratified ones reach at best in practice.
const FALLS: [f64; 2] = [0.5, 0.8];

impl Forecast {
    /// From one render: `spp` samples of so many pixels took `trace_s` and left this noise. None where nothing was traced,
    /// or the picture is black.
    pub fn from_render(build_s: f64, trace_s: f64, pixels: u64, spp: u32, noise_stops: f32) -> Option<Self> {
        let (samples, error) = (pixels as f64 * f64::from(spp), relative_error(noise_stops));
        let known = samples > 0.0 && trace_s > 0.0 && error > 0.0 && error.is_finite();
        known.then(|| Forecast { build_s, samples_s: samples / trace_s, error, spp: spp.into(), falls: FALLS[0] })
    }

    /// The same, if the noise was `noise_stops` after the first `spp` samples.
    fn having_begun_at(self, spp: u32, noise_stops: f32) -> Self {
        let falls = (relative_error(noise_stops) / self.error).ln() / (self.spp / f64::from(spp.max(1))).ln();
        Forecast { falls: if falls.is_finite() { falls.clamp(FALLS[0], FALLS[1]) } else { FALLS[0] }, ..self }
    }

    /// Time and grain with so many samples.
    pub fn estimate(&self, pixels: u64, spp: u32) -> Estimate {
        Estimate {
            seconds: self.build_s + pixels as f64 * f64::from(spp) / self.samples_s,
            noise_stops: (1.0 + self.error * (self.spp / f64::from(spp.max(1))).powf(self.falls)).log2(),
        }
    }
}

fn relative_error(noise_stops: f32) -> f64 {
    f64::from(noise_stops).exp2() - 1.0
}

/// What a forecast is for.
#[derive(Clone, Debug, PartialEq)]
struct Subject {
    revision: u64,
    method: raytrace::Method,
}

/// The forecast of the open studio, and the pilots that make it.
#[derive(Debug, Default)]
pub struct Forecaster {
    trees: Arc<GeometryCache>,
    subject: Option<Subject>,
    since: Option<Instant>,
    pilot: Option<Pilot>,
    forecast: Option<Forecast>,
    /// Real renders of this studio as it is: seconds and noise.
    measured: Vec<Estimate>,
}

#[derive(Debug)]
struct Pilot {
    control: Arc<RenderControl>,
    result: Arc<Mutex<Option<Option<Forecast>>>>,
}

impl Drop for Pilot {
    fn drop(&mut self) {
        self.control.cancel();
    }
}

impl Forecaster {
    /// A forecaster that shares meshes' trees with renders and live view.
    pub fn new(trees: Arc<GeometryCache>) -> Self {
        Forecaster { trees, ..Forecaster::default() }
    }

    /// Runs a pilot when the studio has changed and come to rest. Call each frame while the forecast is on show; a render
    /// on its way has the CPU for itself. Returns the time after which it is to be called again, where there is one.
    pub fn update(
        &mut self,
        scene: &Scene,
        assets: &Assets,
        revision: u64,
        method: raytrace::Method,
        rendering: bool,
        wake: &Wake,
    ) -> Option<Duration> {
        let subject = Subject { revision, method };
        if self.subject.as_ref() != Some(&subject) {
            (self.subject, self.since, self.pilot) = (Some(subject), Some(Instant::now()), None);
            self.measured.clear();
        }
        let mut wait = None;
        if let Some(since) = self.since.filter(|_| !rendering) {
            if since.elapsed() >= AT_REST {
                self.since = None;
                self.pilot = Some(start(self.trees.clone(), scene.clone(), assets.clone(), method, wake.clone()));
            } else {
                wait = Some(AT_REST.saturating_sub(since.elapsed()));
            }
        }
        if let Some(forecast) = self.pilot.as_ref().and_then(|pilot| lock(&pilot.result).take()) {
            (self.pilot, self.forecast) = (None, forecast);
        }
        wait
    }

    /// Learns from a render of the studio at this revision.
    pub fn learn(&mut self, revision: u64, method: raytrace::Method, forecast: Option<Forecast>, took: Estimate) {
        let subject = Subject { revision, method };
        if self.subject.as_ref() != Some(&subject) {
            self.measured.clear();
            self.subject = Some(subject);
        }
        // What a real render of the studio says counts more than a pilot.
        let falls = self.forecast.map_or(FALLS[0], |known| known.falls);
        self.forecast = forecast.map(|forecast| Forecast { falls, ..forecast }).or(self.forecast);
        (self.pilot, self.since) = (None, None);
        self.measured.push(took);
    }

    /// What is known, if anything.
    pub fn forecast(&self) -> Option<&Forecast> {
        self.forecast.as_ref()
    }

    /// Renders of the studio as it is: what they took and left.
    pub fn measured(&self) -> &[Estimate] {
        &self.measured
    }

    /// Whether a pilot is on its way or about to start.
    pub fn is_busy(&self) -> bool {
        self.since.is_some() || self.pilot.is_some()
    }
}

/// The pilot's settings for a camera.
fn pilot_settings(camera: &Camera, method: raytrace::Method) -> Settings {
    let (width, height) = camera.picture_size(PILOT_EDGE);
    Settings { width, height, method, spp: PILOT_SPP, ..Settings::default() }
}

fn start(trees: Arc<GeometryCache>, scene: Scene, assets: Assets, method: raytrace::Method, wake: Wake) -> Pilot {
    let pilot = Pilot { control: Arc::new(RenderControl::new()), result: Arc::default() };
    let (control, result) = (pilot.control.clone(), pilot.result.clone());
    std::thread::spawn(move || {
        let forecast = run(&trees, &scene, &assets, &pilot_settings(&scene.camera, method), &control);
        *lock(&result) = Some(forecast);
        wake();
    });
    pilot
}

/// Renders the pilot on as many threads as a render would take.
fn run(
    trees: &GeometryCache,
    scene: &Scene,
    assets: &Assets,
    settings: &Settings,
    control: &RenderControl,
) -> Option<Forecast> {
    let pool = background_pool(0, "pilot").ok()?;
    let began = Instant::now();
    let prepared = pool.install(|| raytrace::prepare_kept(scene, assets, trees)).ok()?;
    let build_s = began.elapsed().as_secs_f64();
    let began = Instant::now();
    let mut begun = None;
    let film = pool.install(|| {
        raytrace::render(&prepared, settings, control, &mut |film: &Film| {
            if film.spp() == PILOT_SPP / 4 {
                begun = Some(film.noise_stops());
            }
            ControlFlow::Continue(())
        })
    });
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    let trace_s = began.elapsed().as_secs_f64();
    let forecast = Forecast::from_render(build_s, trace_s, pixels, film.spp(), film.noise_stops())?;
    Some(begun.map_or(forecast, |noise| forecast.having_begun_at(PILOT_SPP / 4, noise)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io;

    #[test]
    fn four_times_the_samples_take_four_times_as_long_and_halve_the_grain() {
        let forecast = Forecast::from_render(0.5, 2.0, 10_000, 16, 0.2).unwrap();
        let same = forecast.estimate(10_000, 16);
        assert!((same.seconds - 2.5).abs() < 1e-9 && (same.noise_stops - 0.2).abs() < 1e-6);
        let four = forecast.estimate(10_000, 64);
        assert!((four.seconds - 8.5).abs() < 1e-9);
        let error = |estimate: Estimate| estimate.noise_stops.exp2() - 1.0;
        assert!((error(four) / error(same) - 0.5).abs() < 1e-9);
        let faster = forecast.having_begun_at(4, 0.5).estimate(10_000, 64);
        assert!(
            faster.noise_stops < four.noise_stops,
            "where the first samples did better than the root, so do the next"
        );
        assert_eq!(forecast.having_begun_at(4, f32::INFINITY).falls, FALLS[0]);
        assert_eq!(Forecast::from_render(0.5, 2.0, 10_000, 1, f32::INFINITY), None, "one sample tells no noise");
        assert_eq!(Forecast::from_render(0.5, 0.0, 10_000, 16, 0.2), None);
    }

    #[test]
    fn a_pilot_foretells_the_noise_of_a_larger_render() {
        let loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let (scene, trees) = (loaded.scene, GeometryCache::default());
        let method = raytrace::Method::Path;
        let pilot = pilot_settings(&scene.camera, method);
        let forecast = run(&trees, &scene, &loaded.assets, &pilot, &RenderControl::new()).unwrap();
        let (width, height) = scene.camera.picture_size(200);
        let settings = Settings { width, height, spp: 48, ..pilot };
        let prepared = raytrace::prepare_kept(&scene, &loaded.assets, &trees).unwrap();
        let film = raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let foretold = forecast.estimate(u64::from(width) * u64::from(height), 48).noise_stops;
        let ratio = foretold / f64::from(film.noise_stops());
        // Smaller pixels hold fewer edges, and stratified samples do better the more there are.
        assert!((0.5..2.2).contains(&ratio), "{foretold} stops foretold, {} found", film.noise_stops());
    }
}
