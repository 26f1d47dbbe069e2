//! Pacing of the live traced view: the work per slice, and the times at which a picture is shown.
//!
//! The first picture after an edit comes from a few short slices of work. Later slices are longer and pictures rarer,
//! so that showing them costs little. While the user works, one core stays free.

use super::clock::Clock;
use super::threads::background_pool;
use crate::color::ToneTable;
use crate::photo::Picture;
use crate::raytrace::{AtrousFilter, GeometryCache, LiveCamera, LivePicture, PrepareError, RenderControl, SampleId};
use crate::scene::{Assets, Scene};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Length of a slice of work after an edit, and of one when nothing has changed for a while.
const SLICES: [Duration; 2] = [Duration::from_millis(20), Duration::from_millis(80)];
/// Time after an edit until which slices are short. At its end a first picture is shown, however coarse it is.
const FIRST_PICTURE: Duration = Duration::from_millis(55);
/// Time between two pictures, at first and in the end.
const PICTURE_INTERVALS: [Duration; 2] = [Duration::from_millis(120), Duration::from_millis(1500)];
/// Expected paths per second and thread before anything is measured.
const EXPECTED_PATHS_S: f64 = 40_000.0;

/// A picture to be shown.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveImage {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// sRGB bytes for the screen, three per pixel, rows from the top.
    pub rgb: Vec<u8>,
    /// The scene-linear picture of the same size.
    pub picture: Arc<Picture>,
    /// Samples that every pixel has.
    pub spp: u32,
    /// Nothing is left to trace.
    pub is_done: bool,
}

/// A live picture with its threads and its clock.
#[derive(Debug)]
pub struct LivePacing {
    picture: LivePicture,
    scene: Arc<Scene>,
    tone: ToneTable,
    /// A thread pool that leaves one core free, and one on all cores.
    pools: [rayon::ThreadPool; 2],
    clock: Clock,
    /// Measured paths per second and thread.
    paths_s: f64,
    edited: Instant,
    /// When the last picture was shown; none since the edit.
    last_shown: Option<Instant>,
    has_shown_end: bool,
    /// True if the non-finite samples of the picture have been logged.
    has_logged_nonfinite: bool,
    /// Smooths pictures that are not done; none where that is switched off.
    filter: Option<AtrousFilter>,
}

impl LivePacing {
    /// Returns the pacing of an empty picture, whose BVHs are shared with other renders.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(cache: Arc<GeometryCache>, clock: Clock) -> Result<Self, rayon::ThreadPoolBuildError> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let pool = |threads: usize| background_pool(threads, "live");
        Ok(LivePacing {
            picture: LivePicture::new(cache),
            scene: Arc::default(),
            tone: ToneTable::new(),
            pools: [pool(cores.saturating_sub(1).max(1))?, pool(cores)?],
            paths_s: EXPECTED_PATHS_S,
            edited: clock.now(),
            clock,
            last_shown: None,
            has_shown_end: true,
            has_logged_nonfinite: false,
            filter: None,
        })
    }

    /// Returns the traced picture.
    pub fn picture(&self) -> &LivePicture {
        &self.picture
    }

    /// Returns the number of threads that trace while the user works.
    pub fn threads(&self) -> usize {
        self.pools[0].current_num_threads()
    }

    /// Switches smoothing of pictures that are not done on or off; see [`LivePicture::develop_filtered`]. It starts
    /// off.
    pub fn set_smooth(&mut self, smooth: bool) {
        self.filter = smooth.then(|| self.filter.take().unwrap_or_default());
    }

    /// Changes studio and view.
    ///
    /// # Errors
    /// When the scene cannot be rendered.
    pub fn update(&mut self, scene: Arc<Scene>, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        (self.edited, self.last_shown, self.has_shown_end) = (self.clock.now(), None, true);
        let picture = &mut self.picture;
        self.pools[0].install(|| picture.update(&scene, assets, camera))?;
        (self.scene, self.has_shown_end) = (scene, false);
        Ok(())
    }

    /// Returns true if a picture has been shown since the last edit.
    pub fn has_shown(&self) -> bool {
        self.last_shown.is_some()
    }

    /// Returns true if nothing is left to trace or to show.
    pub fn is_idle(&self) -> bool {
        self.picture.is_converged() && self.has_shown_end
    }

    /// Traces a slice of work, unless `control` is cancelled, and returns the picture if it is time to show one.
    /// `user_is_active` leaves a core free.
    pub fn step(&mut self, user_is_active: bool, control: &RenderControl) -> Option<LiveImage> {
        self.trace_slice(user_is_active, control);
        self.log_nonfinite();
        self.image_if_due(user_is_active)
    }

    fn trace_slice(&mut self, user_is_active: bool, control: &RenderControl) {
        let pool = &self.pools[usize::from(!user_is_active)];
        let began = self.clock.now();
        let slice = SLICES[usize::from(began - self.edited > 4 * FIRST_PICTURE)];
        let threads = pool.current_num_threads() as f64;
        let paths = (self.paths_s * threads * slice.as_secs_f64()).max(64.0) as u64;
        let picture = &mut self.picture;
        let done = pool.install(|| picture.trace(paths, control));
        if done > 0 && !control.is_cancelled() {
            let measured = done as f64 / (self.clock.now() - began).as_secs_f64().max(1e-6) / threads;
            // The estimate follows slowly: one tile of glass does not make all tiles slow.
            self.paths_s += (measured.clamp(1e3, 1e7) - self.paths_s) * 0.3;
        }
    }

    /// Logs the first non-finite sample of the picture, as a render does.
    fn log_nonfinite(&mut self) {
        let report = self.picture.nonfinite();
        if let Some(SampleId { x, y, index, seed }) = report.first.filter(|_| !self.has_logged_nonfinite) {
            let count = report.count;
            log::warn!(
                "the live view shows {count} non-finite contributions black; the first at pixel {x},{y}, sample {index}, seed {seed}"
            );
        }
        self.has_logged_nonfinite = report.first.is_some();
    }

    /// Returns the picture if it is time to show one.
    fn image_if_due(&mut self, user_is_active: bool) -> Option<LiveImage> {
        let (is_done, now) = (self.picture.is_converged(), self.clock.now());
        let age = now - self.edited;
        let is_due = match self.last_shown {
            None => is_done || self.picture.completed_steps() >= LivePicture::HISTORY_STEPS || age > FIRST_PICTURE,
            Some(last) => {
                let interval = (age / 6).clamp(PICTURE_INTERVALS[0], PICTURE_INTERVALS[1]);
                now - last > interval || (is_done && !self.has_shown_end)
            }
        };
        if self.is_idle() || !is_due || !(self.picture.has_picture() || is_done) {
            return None;
        }
        self.has_shown_end = is_done;
        let image = self.develop(user_is_active);
        self.last_shown = Some(self.clock.now());
        Some(image)
    }

    fn develop(&mut self, user_is_active: bool) -> LiveImage {
        let every = self.picture.display_stride();
        let Self { picture: traced, filter, scene, tone, pools, .. } = self;
        pools[usize::from(!user_is_active)].install(|| {
            // A picture of half the resolution is the history of before the view moved, which has little noise.
            let picture = match filter.as_mut().filter(|_| every != 2 && !traced.is_converged()) {
                Some(filter) => traced.develop_filtered(scene, every, filter),
                None => traced.develop_strided(scene, every),
            };
            let row = |row: &[[f32; 3]]| row.iter().flat_map(|rgb| tone.display_srgb8(*rgb)).collect::<Vec<u8>>();
            let rgb = picture.rgb.par_chunks(picture.width.max(1) as usize).flat_map_iter(row).collect();
            let (width, height) = (picture.width as usize, picture.height as usize);
            let (spp, is_done) = (traced.spp(), traced.is_converged());
            LiveImage { width, height, rgb, picture: Arc::new(picture), spp, is_done }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io;
    use crate::scene::Shape;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// A clock that advances by 5 ms each time it is read.
    fn ticking() -> Clock {
        let (start, readings) = (Instant::now(), AtomicU32::new(0));
        Clock::new(move || start + Duration::from_millis(5) * readings.fetch_add(1, Ordering::Relaxed))
    }

    /// Returns a studio with balls in the place of figures: few triangles.
    fn without_figures(mut scene: Scene) -> Scene {
        for object in &mut scene.objects {
            if let Shape::Figure(_) = object.shape {
                (object.shape, object.part_materials) = (Shape::Sphere { radius_m: 0.5 }, Vec::new());
            }
        }
        scene
    }

    #[test]
    fn a_coarse_picture_is_shown_first_and_the_finished_one_last() {
        let loaded = io::find_preset("product_still_life").unwrap().load().unwrap();
        let scene = Arc::new(loaded.scene);
        let mut pacing = LivePacing::new(Arc::default(), ticking()).unwrap();
        let camera = LiveCamera::pinhole(scene.camera_frame(1.5), (48, 32));
        pacing.update(scene.clone(), &loaded.assets, camera).unwrap();
        assert!(!pacing.has_shown() && pacing.image_if_due(true).is_none(), "there is nothing to show yet");
        let control = RenderControl::new();
        let mut images = Vec::new();
        while !pacing.is_idle() {
            images.extend(pacing.step(true, &control));
        }
        assert!(images.len() > 1 && !images[0].is_done && images.last().is_some_and(|image| image.is_done));
        assert!(images.last().is_some_and(|image| (image.width, image.height) == (48, 32)));
        assert!(pacing.image_if_due(true).is_none(), "nothing new");
        // Adaptive sampling ends before the largest number of samples.
        assert!(pacing.picture().spp() < 512);
        let rays = control.rays();
        let mut dimmed = (*scene).clone();
        dimmed.lights[0].power.dial_stops -= 1.0;
        pacing.update(Arc::new(dimmed), &loaded.assets, camera).unwrap();
        let image = pacing.step(false, &control);
        assert!(image.is_some_and(|image| image.is_done) && control.rays() == rays, "dimming is developed, not traced");
    }

    #[test]
    fn pictures_become_rarer_with_time_after_the_edit() {
        let loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let scene = Arc::new(without_figures(loaded.scene));
        let (clock, shown) = (ticking(), Arc::new(std::sync::Mutex::new(Vec::new())));
        let mut pacing = LivePacing::new(Arc::default(), clock.clone()).unwrap();
        let camera = LiveCamera::pinhole(scene.camera_frame(1.5), (96, 64));
        pacing.update(scene.clone(), &loaded.assets, camera).unwrap();
        let control = RenderControl::new();
        for _ in 0..400 {
            // The smallest slices: the picture is unfinished for long.
            pacing.paths_s = 1.0;
            if pacing.step(true, &control).is_some_and(|image| !image.is_done) {
                shown.lock().unwrap().push(clock.now());
            }
        }
        let shown = shown.lock().unwrap();
        let intervals: Vec<Duration> = shown.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(intervals.iter().all(|interval| *interval > PICTURE_INTERVALS[0]), "{intervals:?}");
        assert!(intervals.last() > intervals.first(), "{intervals:?}");
    }

    #[test]
    fn smoothing_reduces_noise_before_the_end_and_does_not_change_the_finished_picture() {
        let loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let scene = Arc::new(without_figures(loaded.scene));
        let camera = LiveCamera::pinhole(scene.camera_frame(1.5), (48, 32));
        let pictures = |smooth: bool| {
            let mut pacing = LivePacing::new(Arc::default(), ticking()).unwrap();
            pacing.set_smooth(smooth);
            pacing.update(scene.clone(), &loaded.assets, camera).unwrap();
            let control = RenderControl::new();
            // Every pixel with one sample: the same picture, for any clock.
            while pacing.picture().stride() != Some(1) {
                pacing.picture.trace(1, &control);
            }
            let unfinished = pacing.develop(true);
            while !pacing.picture().is_converged() {
                pacing.picture.trace(10_000, &control);
            }
            (unfinished, pacing.develop(true))
        };
        let ((noisy, plain), (smooth, end)) = (pictures(false), pictures(true));
        assert_eq!(plain, end, "a finished picture is not smoothed");
        let steps = |image: &LiveImage| image.rgb.windows(4).map(|w| u64::from(w[0].abs_diff(w[3]))).sum::<u64>();
        assert!(steps(&smooth) < steps(&noisy), "{} and {}", steps(&smooth), steps(&noisy));
    }
}
