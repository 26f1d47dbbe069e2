//! The forecaster: pilot renders of the open studio in the background, and the measurements of its real renders.
//!
//! A pilot has the size of a thumbnail. Its pixels cost about as much as those of the large picture, and are a little
//! noisier, because each holds more edges.

use super::clock::Clock;
use super::forecast::{Estimate, Forecast};
use super::monitor::RenderMonitor;
use super::quiet_time::{Due, QuietTime};
use super::render::{RenderInput, RenderStage, render};
use super::threads::{Priority, background_pool};
use super::worker::{Inbox, Interrupt, Wake, Worker, WorkerSettings};
use crate::denoise::{Quality, denoise};
use crate::raytrace::{Film, GeometryCache, Method, RenderControl, Settings};
use crate::scene::{Assets, Camera, Scene};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Long edge of the pilot's picture, pixels.
const PILOT_EDGE: u32 = 120;
/// Samples per pixel of the pilot.
const PILOT_SPP: u32 = 16;
/// Samples after which the pilot's noise is measured a first time.
const FIRST_SPP: u32 = PILOT_SPP / 4;
/// Time without a change of the studio after which a pilot starts.
const PILOT_DELAY: Duration = Duration::from_millis(700);

/// The state of the studio that a forecast belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForecastSubject {
    /// Revision of the document.
    pub revision: u64,
    /// Method of the render.
    pub method: Method,
}

/// A pilot render to be made.
#[derive(Debug)]
struct Pilot {
    scene: Scene,
    assets: Assets,
    method: Method,
}

/// The forecast of the open studio.
#[derive(Debug)]
pub struct Forecaster {
    worker: Worker<Pilot, Option<Forecast>>,
    quiet: QuietTime<ForecastSubject>,
    forecast: Option<Forecast>,
    /// Time and noise of real renders of this studio as it is.
    measured: Vec<Estimate>,
}

const WORKER: WorkerSettings = WorkerSettings {
    name: "pilot",
    priority: Priority::Background,
    interrupt: Interrupt::Always,
    panic_message: "The pilot render stopped with an internal error.",
};

impl Forecaster {
    /// Returns a forecaster that shares BVHs of meshes with renders and live view.
    pub fn new(cache: Arc<GeometryCache>, clock: Clock) -> Self {
        let work = move |inbox: &Inbox<Pilot, Option<Forecast>>| {
            while let Some((pilot, control)) = inbox.next() {
                let forecast = run(&pilot, &cache, &control);
                inbox.publish_unless_cancelled(&control, forecast);
            }
        };
        let worker = Worker::new(WORKER, work);
        Forecaster { worker, quiet: QuietTime::new(PILOT_DELAY, clock), forecast: None, measured: Vec::new() }
    }

    /// Runs a pilot when the studio has changed and [`PILOT_DELAY`] has passed, but not beside a render. To be called
    /// each frame while the forecast is shown. Returns the time after which it is to be called again, if there is one.
    pub fn update(
        &mut self,
        subject: ForecastSubject,
        scene: &Scene,
        assets: &Assets,
        is_rendering: bool,
        wake: &Wake,
    ) -> Option<Duration> {
        if self.quiet.follow(subject) {
            self.worker.reset();
            self.measured.clear();
        }
        let wait = match self.quiet.due(!is_rendering) {
            Due::Now => {
                let pilot = Pilot { scene: scene.clone(), assets: assets.clone(), method: subject.method };
                self.worker.request(pilot, wake);
                None
            }
            Due::After(wait) => Some(wait),
            Due::No => None,
        };
        if let Some(result) = self.worker.take() {
            self.forecast = result.unwrap_or(None);
        }
        wait
    }

    /// Takes over the measurement of a real render, which replaces the pilot's.
    pub fn learn(&mut self, subject: ForecastSubject, forecast: Forecast, measured: Estimate) {
        if self.quiet.settle(subject) {
            self.measured.clear();
        }
        self.forecast = Some(forecast.with_pilot(self.forecast.as_ref()));
        self.worker.reset();
        self.measured.push(measured);
    }

    /// Returns the forecast, if there is one.
    pub fn forecast(&self) -> Option<&Forecast> {
        self.forecast.as_ref()
    }

    /// Returns time and noise of real renders of the studio as it is.
    pub fn measured(&self) -> &[Estimate] {
        &self.measured
    }

    /// Returns true if a pilot is running or about to start.
    pub fn is_busy(&self) -> bool {
        self.quiet.is_waiting() || self.worker.is_busy()
    }
}

/// Returns the pilot's settings for a camera.
fn pilot_settings(camera: &Camera, method: Method) -> Settings {
    let (width, height) = camera.picture_size(PILOT_EDGE);
    Settings { width, height, method, spp: PILOT_SPP, aovs: true, ..Settings::default() }
}

/// Renders a pilot on as many threads as a render has. None if the studio cannot be rendered or the picture is black.
fn run(pilot: &Pilot, cache: &GeometryCache, control: &Arc<RenderControl>) -> Option<Forecast> {
    let Pilot { scene, assets, method } = pilot;
    let settings = &pilot_settings(&scene.camera, *method);
    let pool = background_pool(0, "pilot").ok()?;
    let input = RenderInput::new(scene, assets, cache, settings);
    let monitor = RenderMonitor::new(settings, control.clone());
    let mut first_noise = None;
    let rendered = render(&input, &pool, &monitor, &mut |stage| match stage {
        RenderStage::Pass(film) if film.spp() == FIRST_SPP => first_noise = Some(film.noise_stops()),
        _ => {}
    });
    let rendered = rendered.ok()?;
    let forecast = Forecast::from_render(rendered.build_s, rendered.trace_s, &rendered.film)?
        .with_denoiser(measure_denoiser(scene, &rendered.film, control)?);
    Some(match first_noise {
        Some(noise) => forecast.with_noise_at(FIRST_SPP, noise),
        None => forecast,
    })
}

/// Returns the time of the final picture's denoiser for a pixel, seconds. None once cancelled.
fn measure_denoiser(scene: &Scene, film: &Film, control: &RenderControl) -> Option<f64> {
    let (picture, aovs) = (film.develop(scene), film.aovs()?);
    let started = Instant::now();
    denoise(&picture, &aovs, Quality::Best, &|| control.is_cancelled()).ok()?;
    Some(started.elapsed().as_secs_f64() / picture.rgb.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io;
    use crate::jobs::render_all_passes;
    use crate::raytrace;
    use crate::scene::{HairStyle, Shape};
    use std::sync::mpsc::channel;

    #[test]
    fn a_pilot_forecasts_the_noise_of_a_larger_render() {
        let mut loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let (mut scene, cache) = (loaded.scene, GeometryCache::default());
        // With soft skin and hair, ears and locks before the rim light are noisier in the pilot's small picture: the
        // forecast is 2.5 times the noise of the large one.
        for object in &mut scene.objects {
            let parts = object.part_materials.iter_mut().map(|(_, material)| material);
            parts.chain([&mut object.material]).for_each(|material| material.subsurface = None);
            if let Shape::Figure(figure) = &mut object.shape {
                figure.hair = HairStyle::Bald;
            }
        }
        assert!(io::load_assets(&scene, None, &mut loaded.assets).is_empty());
        let pilot = Pilot { scene: scene.clone(), assets: loaded.assets.clone(), method: Method::Path };
        let forecast = run(&pilot, &cache, &Arc::default()).unwrap();
        let (width, height) = scene.camera.picture_size(200);
        let settings = Settings { width, height, spp: 24, ..pilot_settings(&scene.camera, Method::Path) };
        let prepared = raytrace::prepare_kept(&scene, &loaded.assets, &cache).unwrap();
        let film = render_all_passes(&prepared, &settings, &RenderControl::new());
        let expected = forecast.estimate(u64::from(width) * u64::from(height), 24).noise_stops;
        let ratio = expected / f64::from(film.noise_stops());
        // Smaller pixels hold fewer edges, and stratified samples do better the more there are.
        assert!((0.5..2.2).contains(&ratio), "{expected} stops expected, {} measured", film.noise_stops());
    }

    #[test]
    fn a_pilot_starts_when_the_studio_has_not_changed_for_a_while_and_nothing_renders() {
        let (clock, advance) = Clock::by_hand();
        let (sender, woken) = channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let mut forecaster = Forecaster::new(Arc::default(), clock);
        // An empty scene: its picture is black and has no forecast.
        let (scene, assets) = (Scene::default(), Assets::default());
        let subject = |revision| ForecastSubject { revision, method: Method::Direct };
        let update = |forecaster: &mut Forecaster, revision, is_rendering| {
            forecaster.update(subject(revision), &scene, &assets, is_rendering, &wake)
        };
        assert_eq!(update(&mut forecaster, 1, false), Some(PILOT_DELAY));
        advance(Duration::from_millis(600));
        assert_eq!(update(&mut forecaster, 1, false), Some(Duration::from_millis(100)));
        assert_eq!(update(&mut forecaster, 2, false), Some(PILOT_DELAY), "a change starts the delay anew");
        advance(PILOT_DELAY);
        assert_eq!(update(&mut forecaster, 2, true), None, "a render has the CPU for itself");
        assert!(forecaster.quiet.is_waiting());
        assert_eq!(update(&mut forecaster, 2, false), None);
        assert!(!forecaster.quiet.is_waiting() && forecaster.is_busy(), "the pilot has started");
        while forecaster.is_busy() {
            woken.recv().unwrap();
            update(&mut forecaster, 2, false);
        }
        assert_eq!(forecaster.forecast(), None);
    }
}
