//! The live traced picture against the clock: how much to trace before the next look, and when a look is worth it.
//!
//! The first picture after an edit comes from a few short slices of work; later ones take their time, so that showing
//! them costs little. While the user works, one core is left alone.

use super::threads::background_pool;
use crate::color::ToneTable;
use crate::raytrace::{GeometryCache, LiveCamera, LivePicture, PrepareError, RenderControl, Smoother};
use crate::scene::{Assets, Scene};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A slice of work after an edit, and one when nothing has changed for a while.
const SLICES: [Duration; 2] = [Duration::from_millis(25), Duration::from_millis(80)];
/// Until then slices are short, and a first picture is shown however coarse it is.
const FIRST_PICTURE: Duration = Duration::from_millis(70);
/// Looks are this far apart, at first and in the end.
const LOOKS: [Duration; 2] = [Duration::from_millis(120), Duration::from_millis(1500)];
/// Paths a second that a thread is expected to trace before anything is measured.
const EXPECTED_PATHS_S: f64 = 40_000.0;

/// What there is to show.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveImage {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// sRGB bytes as shown, three a pixel, rows from the top.
    pub rgb: Vec<u8>,
    /// Samples that every pixel has.
    pub spp: u32,
    /// Nothing is left to do.
    pub done: bool,
}

/// A live picture with its threads and its sense of time.
#[derive(Debug)]
pub struct LivePace {
    picture: LivePicture,
    scene: Arc<Scene>,
    tone: ToneTable,
    /// One that leaves a core alone, and one with all cores.
    pools: [rayon::ThreadPool; 2],
    /// Paths a second and thread, as measured.
    paths_s: f64,
    since_edit: Instant,
    /// When the last look was taken; none since the edit.
    last_look: Option<Instant>,
    looked_at_end: bool,
    /// Shows pictures that are not done with less grain than they have; none if that is not asked for.
    smoother: Option<Smoother>,
}

impl LivePace {
    /// A picture that shares its trees with others.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn new(cache: Arc<GeometryCache>) -> Result<Self, rayon::ThreadPoolBuildError> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let pool = |threads: usize| background_pool(threads, "live");
        Ok(LivePace {
            picture: LivePicture::new(cache),
            scene: Arc::default(),
            tone: ToneTable::new(),
            pools: [pool(cores.saturating_sub(1).max(1))?, pool(cores)?],
            paths_s: EXPECTED_PATHS_S,
            since_edit: Instant::now(),
            last_look: None,
            looked_at_end: true,
            smoother: None,
        })
    }

    /// The picture itself.
    pub fn picture(&self) -> &LivePicture {
        &self.picture
    }

    /// Threads that trace while the user works.
    pub fn threads(&self) -> usize {
        self.pools[0].current_num_threads()
    }

    /// Whether pictures are smoothed until they are done; see [`LivePicture::develop_smooth`]. Not by itself.
    pub fn set_smooth(&mut self, smooth: bool) {
        self.smoother = smooth.then(|| self.smoother.take().unwrap_or_default());
    }

    /// Takes in the studio and the view as they are now.
    ///
    /// # Errors
    /// When the scene cannot be rendered.
    pub fn update(&mut self, scene: Arc<Scene>, assets: &Assets, camera: LiveCamera) -> Result<(), PrepareError> {
        (self.since_edit, self.last_look, self.looked_at_end) = (Instant::now(), None, true);
        let picture = &mut self.picture;
        self.pools[0].install(|| picture.update(&scene, assets, camera))?;
        (self.scene, self.looked_at_end) = (scene, false);
        Ok(())
    }

    /// Whether the picture since the last edit has been looked at.
    pub fn has_shown(&self) -> bool {
        self.last_look.is_some()
    }

    /// Whether nothing is left to trace or to show.
    pub fn is_idle(&self) -> bool {
        self.picture.is_done() && self.looked_at_end
    }

    /// Works for a moment, or until `control` is cancelled. `user_is_active` leaves a core alone.
    pub fn slice(&mut self, user_is_active: bool, control: &RenderControl) {
        let pool = &self.pools[usize::from(!user_is_active)];
        let slice = SLICES[usize::from(self.since_edit.elapsed() > 4 * FIRST_PICTURE)];
        let (began, threads) = (Instant::now(), pool.current_num_threads() as f64);
        let paths = (self.paths_s * threads * slice.as_secs_f64()).max(64.0) as u64;
        let picture = &mut self.picture;
        let done = pool.install(|| picture.work(paths, control));
        if done > 0 && !control.is_cancelled() {
            let measured = done as f64 / began.elapsed().as_secs_f64().max(1e-6) / threads;
            // A little at a time: a tile of glass is no sign that all are slow.
            self.paths_s += (measured.clamp(1e3, 1e7) - self.paths_s) * 0.3;
        }
    }

    /// The picture, if it is time for a look.
    pub fn look(&mut self) -> Option<LiveImage> {
        let (done, age) = (self.picture.is_done(), self.since_edit.elapsed());
        let due = match self.last_look {
            None => done || self.picture.steps() >= LivePicture::SEEN || age > FIRST_PICTURE,
            Some(last) => {
                let apart = (age / 6).clamp(LOOKS[0], LOOKS[1]);
                last.elapsed() > apart || (done && !self.looked_at_end)
            }
        };
        if self.is_idle() || !due || !(self.picture.is_begun() || done) {
            return None;
        }
        self.looked_at_end = done;
        let image = self.develop();
        self.last_look = Some(Instant::now());
        Some(image)
    }

    fn develop(&mut self) -> LiveImage {
        let every = self.picture.coarseness();
        let Self { picture: traced, smoother, scene, tone, pools, .. } = self;
        pools[0].install(|| {
            // Half as fine is what was known before the view moved: it has little grain.
            let picture = match smoother.as_mut().filter(|_| every != 2 && !traced.is_done()) {
                Some(smoother) => traced.develop_smooth(scene, every, smoother),
                None => traced.develop_every(scene, every),
            };
            let row = |row: &[[f32; 3]]| row.iter().flat_map(|rgb| tone.shown(*rgb)).collect::<Vec<u8>>();
            let rgb = picture.rgb.par_chunks(picture.width.max(1) as usize).flat_map_iter(row).collect();
            let (width, height) = (picture.width as usize, picture.height as usize);
            LiveImage { width, height, rgb, spp: traced.spp(), done: traced.is_done() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io;

    #[test]
    fn a_first_look_comes_soon_and_the_last_one_when_all_is_quiet() {
        let loaded = io::find_preset("product_still_life").unwrap().load().unwrap();
        let scene = Arc::new(loaded.scene);
        let mut pace = LivePace::new(Arc::default()).unwrap();
        let camera = LiveCamera::pinhole(scene.camera_frame(1.5), (48, 32));
        pace.update(scene.clone(), &loaded.assets, camera).unwrap();
        assert!(!pace.has_shown() && pace.look().is_none(), "there is nothing to show yet");
        let control = RenderControl::new();
        let mut looks = Vec::new();
        while !pace.is_idle() {
            pace.slice(true, &control);
            looks.extend(pace.look());
        }
        assert!(looks.len() > 1 && !looks[0].done && looks.last().is_some_and(|look| look.done));
        assert!(looks.last().is_some_and(|look| (look.width, look.height) == (48, 32)));
        assert!(pace.look().is_none(), "nothing new");
        // The whole of it costs less than the most samples anyone could ask for.
        assert!(pace.picture().spp() < 512);
        let rays = control.rays();
        let mut dimmed = (*scene).clone();
        dimmed.lights[0].power.dial_stops -= 1.0;
        pace.update(Arc::new(dimmed), &loaded.assets, camera).unwrap();
        pace.slice(false, &control);
        let look = pace.look();
        assert!(look.is_some_and(|look| look.done) && control.rays() == rays, "dimming is developed, not traced");
    }

    #[test]
    fn smoothing_shows_less_grain_on_the_way_and_the_same_picture_in_the_end() {
        let loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let scene = Arc::new(loaded.scene);
        let camera = LiveCamera::pinhole(scene.camera_frame(1.5), (48, 32));
        let looks = |smooth: bool| {
            let mut pace = LivePace::new(Arc::default()).unwrap();
            pace.set_smooth(smooth);
            pace.update(scene.clone(), &loaded.assets, camera).unwrap();
            let control = RenderControl::new();
            // Every pixel with one sample: the same picture, whatever the clock says.
            while pace.picture().stride() != Some(1) {
                pace.picture.work(1, &control);
            }
            let begun = pace.develop();
            while !pace.picture().is_done() {
                pace.picture.work(10_000, &control);
            }
            (begun, pace.develop())
        };
        let ((grainy, plain), (smooth, end)) = (looks(false), looks(true));
        assert_eq!(plain, end, "what is done is shown as it was traced");
        let steps = |image: &LiveImage| image.rgb.windows(4).map(|w| u64::from(w[0].abs_diff(w[3]))).sum::<u64>();
        assert!(steps(&smooth) < steps(&grainy), "{} and {}", steps(&smooth), steps(&grainy));
    }
}
