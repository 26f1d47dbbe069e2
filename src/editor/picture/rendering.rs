//! The render settings, the running job, and the picture it leaves behind.

use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::wake::wake;
use crate::jobs::{Developed, FilmDeveloper, RenderJob, RenderOutcome, RenderPhase, RenderRequest};
use crate::photo::Picture;
use crate::raytrace::{self, Film, GeometryCache, Method, Settings};
use crate::scene::{Assets, Camera, Scene, SceneChange};
use eframe::egui::{Color32, ColorImage, Context, TextureId};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// How good a render is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// To judge the light: seconds.
    Draft,
    /// To show around.
    Good,
    /// To deliver.
    Final,
    /// As many samples as typed.
    Custom,
}

impl Quality {
    /// Samples a pixel; none for custom.
    pub fn samples(self) -> Option<u32> {
        match self {
            Quality::Draft => Some(16),
            Quality::Good => Some(128),
            Quality::Final => Some(1024),
            Quality::Custom => None,
        }
    }
}

/// Size of the picture, by its longer side or freely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// The sensor's shape, with this longer side in pixels.
    LongEdge(u32),
    /// Any size; a crop of the sensor where the shape differs.
    Custom(u32, u32),
}

/// What the render panel sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// Size of the picture.
    pub size: PictureSize,
    /// How good it is to be.
    pub quality: Quality,
    /// Samples a pixel.
    pub samples: u32,
    /// How light is followed.
    pub method: Method,
}

impl Default for RenderSettings {
    fn default() -> Self {
        RenderSettings { size: PictureSize::LongEdge(1080), quality: Quality::Draft, samples: 16, method: Method::Path }
    }
}

impl RenderSettings {
    /// Pixels across and down.
    pub fn pixels(&self, camera: &Camera) -> (u32, u32) {
        match self.size {
            PictureSize::LongEdge(edge) => camera.picture_size(edge),
            PictureSize::Custom(width, height) => (width.max(1), height.max(1)),
        }
    }
}

/// Everything about the rendered picture.
#[derive(Debug)]
pub struct Rendering {
    /// What the panel sets.
    pub settings: RenderSettings,
    /// Meshes' trees, shared with the live view.
    trees: Arc<GeometryCache>,
    job: Option<RenderJob>,
    film: Option<Arc<Film>>,
    developer: FilmDeveloper<Arc<ColorImage>>,
    /// Film and scene of the newest requested picture; the pointer is only compared.
    requested: Option<(*const Film, Scene)>,
    developed: Option<Developed<Arc<ColorImage>>>,
    develop_failure: Option<String>,
    image_texture: ImageTexture,
}

impl Rendering {
    /// No picture yet; meshes' trees are shared.
    pub fn new(trees: Arc<GeometryCache>) -> Self {
        Rendering {
            settings: RenderSettings::default(),
            trees,
            job: None,
            film: None,
            developer: FilmDeveloper::new(|picture, most| Arc::new(shown_within(picture, most))),
            requested: None,
            developed: None,
            develop_failure: None,
            image_texture: ImageTexture::default(),
        }
    }

    /// Starts to render.
    pub fn start(&mut self, scene: &Scene, assets: &Assets, folder: Option<PathBuf>, ctx: &Context) {
        let (width, height) = self.settings.pixels(&scene.camera);
        let settings = Settings {
            width,
            height,
            method: self.settings.method,
            spp: self.settings.samples.max(1),
            ..Settings::default()
        };
        let (scene, assets, cache) = (Arc::new(scene.clone()), assets.clone(), self.trees.clone());
        let request = RenderRequest { scene, assets, folder, cache, settings };
        (self.job, self.develop_failure) = (Some(RenderJob::start(request, &wake(ctx))), None);
    }

    /// Stops the running job; what is complete is kept.
    pub fn cancel(&self) {
        if let Some(job) = &self.job {
            job.cancel();
        }
    }

    /// Forgets job and picture, because another studio was opened.
    pub fn clear(&mut self) {
        *self = Rendering { settings: self.settings, ..Rendering::new(self.trees.clone()) };
    }

    /// The job, running or ended.
    pub fn job(&self) -> Option<&RenderJob> {
        self.job.as_ref()
    }

    /// Whether a render is on its way.
    pub fn is_running(&self) -> bool {
        self.job.as_ref().is_some_and(|job| job.phase().is_running())
    }

    /// Whether a render or the development of its film is on its way.
    pub fn is_busy(&self) -> bool {
        self.job.as_ref().is_some_and(RenderJob::is_busy) || self.developer.is_busy()
    }

    /// The picture as it is shown.
    pub fn texture(&self) -> Option<TextureId> {
        self.image_texture.id()
    }

    /// Brings the picture to the device that the window has now.
    pub fn move_to(&mut self, ctx: &Context) {
        self.image_texture.renew(ctx);
    }

    /// The picture for export; not yet while only a small forerunner of a large one is on show.
    pub fn developed(&self) -> Option<&Developed<Arc<ColorImage>>> {
        let (width, height) = self.size()?;
        self.developed.as_ref().filter(|d| (d.picture.width, d.picture.height) == (width, height))
    }

    /// Pixels across and down of the picture that is on show or on its way.
    pub fn size(&self) -> Option<(u32, u32)> {
        self.job.as_ref().map(|job| (job.settings.width, job.settings.height))
    }

    /// Whether the picture is not what a render would show now.
    pub fn is_out_of_date(&self, now: &Scene) -> bool {
        match (&self.film, &self.job) {
            (Some(film), Some(job)) => !raytrace::is_up_to_date(film.layers(), &job.scene, now),
            _ => false,
        }
    }

    /// Takes in what the threads have made and asks for what the scene needs now. Call once a frame.
    pub fn update(&mut self, scene: &Scene, ctx: &Context) {
        if let Some(job) = &mut self.job {
            job.update();
            self.film = job.film().cloned().or(self.film.take());
        }
        if let Some(film) = &self.film {
            let is_requested = self.requested.as_ref().is_some_and(|(requested, developed)| {
                *requested == Arc::as_ptr(film) && !SceneChange::between(developed, scene).needs_development()
            });
            if !is_requested {
                let most = ctx.input(|i| i.max_texture_side);
                self.developer.request(film.clone(), scene.clone(), most, &wake(ctx));
                self.requested = Some((Arc::as_ptr(film), scene.clone()));
            }
        }
        match self.developer.take() {
            Some(Ok(developed)) => {
                self.image_texture.set(ctx, developed.image.clone());
                self.developed = Some(developed);
            }
            Some(Err(message)) => self.develop_failure = Some(message),
            None => {}
        }
        // Progress numbers move between snapshots, too.
        if self.is_running() {
            ctx.request_repaint_after(Duration::from_millis(250));
        }
    }

    /// Takes the outcome of a render that was not cancelled, with the job that made it.
    pub fn take_outcome(&mut self) -> Option<(&RenderJob, RenderOutcome)> {
        let job = self.job.as_mut()?;
        let outcome = job.take_outcome()?;
        Some((job, outcome))
    }

    /// Returns the message of a render or a development that failed.
    pub fn failure(&self) -> Option<&str> {
        match self.job.as_ref().map(RenderJob::phase) {
            Some(RenderPhase::Failed(message)) => Some(message),
            _ => self.develop_failure.as_deref(),
        }
    }
}

/// The picture as it is shown: of a larger one than a texture can hold, the mean of each 2x2, 3x3 ... pixels.
fn shown_within(picture: &Picture, most: usize) -> ColorImage {
    let (size, codes) = ([picture.width as usize, picture.height as usize], picture.to_srgb8());
    let times = size[0].max(size[1]).div_ceil(most.max(1)).max(1);
    if times == 1 {
        return ColorImage::from_rgb(size, codes.as_flattened());
    }
    let shown = size.map(|side| side.div_ceil(times));
    let mut image = ColorImage::filled(shown, Color32::BLACK);
    for (at, pixel) in image.pixels.iter_mut().enumerate() {
        let [x, y] = [at % shown[0] * times, at / shown[0] * times];
        let (right, bottom) = ((x + times).min(size[0]), (y + times).min(size[1]));
        let mut sum = [0_u32; 3];
        for row in y..bottom {
            for code in &codes[row * size[0] + x..row * size[0] + right] {
                sum = [0, 1, 2].map(|c| sum[c] + u32::from(code[c]));
            }
        }
        let count = ((right - x) * (bottom - y)) as u32;
        let [r, g, b] = sum.map(|sum| ((sum + count / 2) / count) as u8);
        *pixel = Color32::from_rgb(r, g, b);
    }
    image
}

/// Said of a picture that no longer shows the studio as it is.
pub const OUT_OF_DATE: &str = "Out of date: the studio has changed since. Light power, colour and switches follow at once; the rest needs a render.";

/// Name of a method in lists.
pub fn method_label(method: Method) -> &'static str {
    match method {
        Method::Whitted => "Hard shadows, no bounced light",
        Method::Direct => "Direct light only",
        Method::Path => "With bounced light",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_larger_than_a_texture_is_shown_by_means_of_its_pixels() {
        let rgb = (0..7 * 3).map(|i| if i % 7 < 4 { [0.0; 3] } else { [1e3; 3] }).collect();
        let picture = Picture { width: 7, height: 3, rgb };
        let whole = shown_within(&picture, 7);
        assert_eq!((whole.size, whole.pixels[3], whole.pixels[6]), ([7, 3], Color32::BLACK, Color32::WHITE));
        let shown = shown_within(&picture, 3);
        // Of each 3x3: all black, one column of three black, and what is left at the edge.
        assert_eq!(
            (shown.size, &shown.pixels[..]),
            ([3, 1], &[Color32::BLACK, Color32::from_gray(170), Color32::WHITE][..])
        );
        assert_eq!(shown_within(&picture, 1).size, [1, 1]);
    }
}
