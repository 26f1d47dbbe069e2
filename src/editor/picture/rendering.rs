//! The render job and its picture.

use super::render_settings::RenderSettings;
use crate::editor::document::light_mix::{Mix, MixerRow};
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::scopes::{ChartData, waveform_image};
use crate::editor::ui::spot_readout::{SpotLux, SpotReading};
use crate::editor::ui::wake::wake;
use crate::io::{AssetFiles, KeptPicture};
use crate::jobs::{Developed, Development, FilmDeveloper, RenderJob, RenderOutcome, RenderPhase, RenderRequest};
use crate::photo::{Histogram, Picture, PictureDisplay, Spot, Waveform, exposure};
use crate::raytrace::{self, Film, GeometryCache, Settings};
use crate::scene::{Assets, Light, LightId, Scene, SceneChange};
use eframe::egui::{Color32, ColorImage, Context, TextureId};
use std::collections::HashMap;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::{Arc, Weak};
use std::time::Duration;

/// Albedo under which the light on a surface can't be told from what it reflects.
const LEAST_ALBEDO: f32 = 0.01;

/// Default of [`Rendering::long_render`].
const LONG_RENDER: Duration = Duration::from_secs(60);

/// A requested picture. The pointer to the film is only compared.
#[derive(Debug)]
struct Requested {
    film: *const Film,
    scene: Scene,
    development: Development,
}

/// The picture as the window shows it.
#[derive(Debug)]
pub struct ShownPicture {
    image: Arc<ColorImage>,
    /// How it is displayed.
    pub display: PictureDisplay,
    /// The histogram of the whole picture.
    pub histogram: Histogram,
    /// The image of its waveform.
    waveform: Arc<ColorImage>,
}

impl ShownPicture {
    fn new(picture: &Picture, development: &Development) -> Self {
        let image = shown_within(picture, development.display, development.max_side);
        let waveform = Arc::new(waveform_image(&Waveform::of(picture)));
        ShownPicture {
            image: Arc::new(image),
            display: development.display,
            histogram: Histogram::of(picture),
            waveform,
        }
    }
}

/// The state of the rendered picture: settings, job, film and developed image.
#[derive(Debug)]
pub struct Rendering {
    /// The settings of the render panel.
    pub settings: RenderSettings,
    /// How the picture is displayed.
    pub display: PictureDisplay,
    /// The faders over the picture.
    pub mix: Mix,
    /// Time of a render from which on its picture is not thrown away unasked.
    pub long_render: Duration,
    /// The BLAS cache, shared with the live view.
    trees: Arc<GeometryCache>,
    job: Option<RenderJob>,
    film: Option<Arc<Film>>,
    /// The film that was exported last.
    exported: Option<Weak<Film>>,
    /// The picture before the running render, until that has one.
    former: Option<KeptPicture>,
    /// Models or textures have changed since the render began.
    has_other_assets: bool,
    developer: FilmDeveloper<ShownPicture>,
    /// The newest requested picture.
    requested: Option<Requested>,
    developed: Option<Developed<ShownPicture>>,
    develop_failure: Option<String>,
    image_texture: ImageTexture,
    waveform_texture: ImageTexture,
}

impl Rendering {
    /// Returns the state without a picture; the BLAS cache is shared.
    pub fn new(trees: Arc<GeometryCache>) -> Self {
        Rendering {
            settings: RenderSettings::default(),
            display: PictureDisplay::default(),
            mix: Mix::default(),
            long_render: LONG_RENDER,
            trees,
            job: None,
            film: None,
            exported: None,
            former: None,
            has_other_assets: false,
            developer: FilmDeveloper::new(ShownPicture::new),
            requested: None,
            developed: None,
            develop_failure: None,
            image_texture: ImageTexture::default(),
            waveform_texture: ImageTexture::default(),
        }
    }

    /// Starts a render of the studio; assets that are not loaded yet are read from `files`.
    pub fn start(&mut self, scene: &Scene, assets: &Assets, files: AssetFiles<'_>, ctx: &Context) {
        let settings = self.settings.render_settings(&scene.camera);
        let (folder, imported) = (files.folder.map(Path::to_owned), files.imported.clone());
        self.former = self.kept_picture().or(self.former.take());
        let (scene, assets, cache) = (Arc::new(scene.clone()), assets.clone(), self.trees.clone());
        let request = RenderRequest { scene, assets, folder, imported, cache, settings };
        (self.job, self.develop_failure) = (Some(RenderJob::start(request, &wake(ctx))), None);
        self.has_other_assets = false;
    }

    /// Shows a picture that was rendered before. One that a file holds need not be kept for the case of a crash.
    pub fn restore(&mut self, picture: KeptPicture, is_in_file: bool) {
        let KeptPicture { film, scene, settings, is_complete } = picture;
        self.clear();
        self.exported = is_in_file.then(|| Arc::downgrade(&film));
        self.job = Some(RenderJob::ended(scene, settings, film, is_complete));
    }

    /// Returns the picture as far as it is rendered, if it is not exported.
    pub fn to_keep(&self) -> Option<KeptPicture> {
        let picture = self.kept_picture().or_else(|| self.former.clone())?;
        let is_exported = self.exported.as_ref().is_some_and(|film| film.ptr_eq(&Arc::downgrade(&picture.film)));
        (!is_exported).then_some(picture)
    }

    /// Returns true if the picture is not exported, and took long to render.
    pub fn is_costly_to_lose(&self) -> bool {
        let took = self.job.as_ref().map(|job| job.progress().elapsed).unwrap_or_default();
        took >= self.long_render && self.to_keep().is_some()
    }

    /// Returns the picture of the job as far as it is rendered.
    fn kept_picture(&self) -> Option<KeptPicture> {
        let job = self.job.as_ref()?;
        let film = job.film().filter(|film| film.spp() > 0 && is_of(film, &job.settings))?.clone();
        let (scene, settings) = (job.scene.clone(), job.settings.clone());
        Some(KeptPicture { film, scene, settings, is_complete: *job.phase() == RenderPhase::Done })
    }

    /// Notes that the picture of a film was exported, if it is this one: it need not be kept for the case of a crash.
    pub fn mark_exported(&mut self, film: &Weak<Film>) {
        let is_here = |held: &Arc<Film>| film.ptr_eq(&Arc::downgrade(held));
        if self.film.as_ref().is_some_and(is_here) {
            self.exported = Some(film.clone());
        }
    }

    /// Cancels the job and keeps its samples.
    pub fn cancel(&self) {
        if let Some(job) = &self.job {
            job.cancel();
        }
    }

    /// Clears job and picture, because another studio was opened.
    pub fn clear(&mut self) {
        *self = self.without_picture();
    }

    /// Returns a state with the same film if a picture of `scene` can be developed from it.
    pub fn for_other_lights(&self, scene: &Scene) -> Option<Self> {
        if self.is_running() || self.is_out_of_date(scene) {
            return None;
        }
        let mut other = self.without_picture();
        other.restore(self.kept_picture()?, false);
        Some(other)
    }

    /// Returns a state without a picture, with the same settings.
    pub fn without_picture(&self) -> Self {
        Rendering { settings: self.settings, display: self.display, ..Rendering::new(self.trees.clone()) }
    }

    /// Returns the job, running or ended.
    pub fn job(&self) -> Option<&RenderJob> {
        self.job.as_ref()
    }

    /// Returns true during a render.
    pub fn is_running(&self) -> bool {
        self.job.as_ref().is_some_and(|job| job.phase().is_running())
    }

    /// Returns true during a render or the development of its film.
    pub fn is_busy(&self) -> bool {
        self.job.as_ref().is_some_and(RenderJob::is_busy) || self.developer.is_busy()
    }

    /// Returns the texture of the picture.
    pub fn texture(&self) -> Option<TextureId> {
        self.image_texture.id()
    }

    /// Uploads the picture to the window's current device.
    pub fn move_to(&mut self, ctx: &Context) {
        self.image_texture.renew(ctx);
        self.waveform_texture.renew(ctx);
    }

    /// Returns the picture for export; none while only a reduced one is available.
    pub fn developed(&self) -> Option<&Developed<ShownPicture>> {
        let (width, height) = self.size()?;
        self.developed.as_ref().filter(|d| (d.picture.width, d.picture.height) == (width, height))
    }

    /// Returns the rows of the mixer: the layers of the film, then the lights that have none. Lights that are off in
    /// `scene` have no row.
    pub fn mixer_rows(&self, scene: &Scene) -> Vec<MixerRow> {
        let layers = self.film.as_deref().map(Film::layers).unwrap_or_default();
        let lit = || scene.lights.iter().filter(|light| light.on);
        let mut without: HashMap<LightId, &Light> = lit().map(|light| (light.id, light)).collect();
        let mut rows = Vec::new();
        for layer in layers {
            let name = layer.light.and_then(|id| without.get(&id)).map_or(&layer.name, |light| &light.name).clone();
            let lights: Vec<LightId> = layer.lights().filter(|id| without.remove(id).is_some()).collect();
            rows.extend((!lights.is_empty()).then_some(MixerRow { name, lights, has_layer: true }));
        }
        let without = lit().filter(|light| without.contains_key(&light.id));
        rows.extend(without.map(|light| MixerRow {
            name: light.name.clone(),
            lights: vec![light.id],
            has_layer: false,
        }));
        rows
    }

    /// Reads the light around a pixel of the picture, with the lights as in `scene` and the mix. None outside of it, and
    /// while there is no whole picture.
    pub fn read_spot(&self, pixel: (u32, u32), scene: &Scene) -> Option<SpotReading> {
        let developed = self.developed()?;
        let size = self.size().filter(|size| pixel.0 < size.0 && pixel.1 < size.1)?;
        let spot = Spot::around(pixel, size, |x, y| developed.picture.at(x, y));
        let film = developed.film.upgrade()?;
        let mixed = self.mix.mixed(scene);
        let layers = film.lazy_layers(&mixed).into_iter();
        let lights = layers.map(|(name, layer)| (name, Spot::around(pixel, size, |x, y| layer.at(x, y)).luminance()));
        let lights: Vec<(String, f32)> = lights.collect();
        // L = albedo E / pi
        let albedo = Spot::around(pixel, size, |x, y| film.albedo_at(x, y).unwrap_or([0.0; 3])).luminance();
        let lux_s = spot.luminance() * PI / (albedo * exposure::pixel_per_cd_s_m2(scene));
        let is_known = albedo >= LEAST_ALBEDO && lux_s.is_finite();
        let lux = is_known.then_some(SpotLux { lux_s, shutter_s: scene.camera.shutter_s });
        Some(SpotReading::new(spot, lux, lights))
    }

    /// Returns the charts of the picture; none while there is no whole picture.
    pub fn charts(&self) -> ChartData<'_> {
        match self.developed() {
            Some(developed) => {
                ChartData { histogram: Some(&developed.image.histogram), waveform: self.waveform_texture.id() }
            }
            None => ChartData::default(),
        }
    }

    /// Returns true if the picture on the screen is denoised.
    pub fn is_denoised(&self) -> bool {
        self.developed.as_ref().is_some_and(|developed| developed.denoiser.is_some())
    }

    /// Returns true if there is a picture that the denoiser cannot read: it was opened from a file without AOVs.
    pub fn lacks_aovs(&self) -> bool {
        self.film.as_ref().is_some_and(|film| !film.has_aovs())
    }

    /// Returns width and height of the picture of the job, pixels.
    pub fn size(&self) -> Option<(u32, u32)> {
        self.job.as_ref().map(|job| (job.settings.width, job.settings.height))
    }

    /// Notes that models or textures of the studio have other content now.
    pub fn note_changed_assets(&mut self) {
        self.has_other_assets = true;
    }

    /// Returns true if a new render would differ from the picture.
    pub fn is_out_of_date(&self, now: &Scene) -> bool {
        match (&self.film, &self.job) {
            (Some(_), Some(_)) if self.has_other_assets => true,
            (Some(film), Some(job)) => !raytrace::is_up_to_date(film.layers(), &job.scene, &self.mix.mixed(now)),
            _ => false,
        }
    }

    /// Takes the results of the jobs and requests the development that the scene needs. Called once per frame.
    pub fn update(&mut self, scene: &Scene, ctx: &Context) {
        self.mix.fit(scene, self.film.as_deref().map(Film::layers).unwrap_or_default());
        let mixed = self.mix.mixed(scene);
        let scene = &*mixed;
        if let Some(job) = &mut self.job {
            job.update();
            self.film = job.film().cloned().or(self.film.take());
            let has_picture = job.film().is_some_and(|film| is_of(film, &job.settings));
            if has_picture {
                self.former = None;
            } else if !job.phase().is_running() {
                self.show_former();
            }
        }
        if let Some(film) = &self.film {
            let max_side = ctx.input(|i| i.max_texture_side);
            // The picture before a running render is final, too.
            let is_final = !self.job.as_ref().is_some_and(|job| job.phase().is_running() && job.film().is_some());
            let denoise = self.settings.denoise;
            let display = self.display;
            let development = Development { max_side, denoise, is_final: is_final && denoise, display };
            let last = self.requested.as_ref().filter(|requested| {
                requested.development == development
                    && !SceneChange::between(&requested.scene, scene).needs_development()
            });
            let is_requested = last.is_some_and(|requested| requested.film == Arc::as_ptr(film));
            // A film that only has more samples can wait
            let pause = last.and_then(|_| self.pause());
            if let Some(pause) = pause.filter(|_| !is_requested) {
                ctx.request_repaint_after(pause);
            } else if !is_requested {
                self.developer.request(film.clone(), scene.clone(), development, &wake(ctx));
                self.requested = Some(Requested { film: Arc::as_ptr(film), scene: scene.clone(), development });
            }
        }
        match self.developer.take() {
            Some(Ok(developed)) => {
                self.image_texture.set(ctx, developed.image.image.clone());
                self.waveform_texture.set(ctx, developed.image.waveform.clone());
                self.developed = Some(developed);
            }
            Some(Err(message)) => self.develop_failure = Some(message),
            None => {}
        }
    }

    /// Brings the picture of before a render back, which has ended without one of its own.
    fn show_former(&mut self) {
        let Some(KeptPicture { film, scene, settings, is_complete }) = self.former.take() else { return };
        self.develop_failure = self.failure().map(str::to_owned);
        self.film = Some(film.clone());
        self.job = Some(RenderJob::ended(scene, settings, film, is_complete));
    }

    /// Returns how long the next film of a running render should still wait, if it should.
    fn pause(&self) -> Option<Duration> {
        let job = self.job.as_ref().filter(|job| job.phase().is_running())?;
        if self.developer.is_busy() {
            // Its end wakes the window.
            return Some(Duration::MAX);
        }
        let pause = self.developed.as_ref()?.pause(job.settings.pixels(), job.progress().elapsed);
        (!pause.is_zero()).then_some(pause)
    }

    /// Takes the outcome of a render that was not cancelled, with the job that made it.
    pub fn take_outcome(&mut self) -> Option<(&RenderJob, RenderOutcome)> {
        let job = self.job.as_mut()?;
        let outcome = job.take_outcome()?;
        Some((job, outcome))
    }

    /// Returns what the user should know about the picture, once.
    pub fn take_warnings(&mut self) -> Vec<String> {
        self.job.as_mut().map(RenderJob::take_warnings).unwrap_or_default()
    }

    /// Returns the message of a render or a development that failed.
    pub fn failure(&self) -> Option<&str> {
        match self.job.as_ref().map(RenderJob::phase) {
            Some(RenderPhase::Failed(message)) => Some(message),
            _ => self.develop_failure.as_deref(),
        }
    }
}

/// Returns true if a film is of the size of a render, not its coarse version.
fn is_of(film: &Film, settings: &Settings) -> bool {
    (film.width(), film.height()) == (settings.width, settings.height)
}

fn shown_within(picture: &Picture, display: PictureDisplay, most: usize) -> ColorImage {
    image_within([picture.width as usize, picture.height as usize], &display.to_srgb8(picture), most)
}

/// Returns an image of display values; larger ones than a texture are reduced by means of 2x2, 3x3 ... pixels.
pub(super) fn image_within(size: [usize; 2], codes: &[[u8; 3]], most: usize) -> ColorImage {
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

/// Message for an outdated picture.
pub const OUT_OF_DATE: &str = "Out of date: the studio has changed since. Light power, colour and switches follow at once; the rest needs a render.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_larger_than_a_texture_is_reduced_by_pixel_means() {
        let rgb = (0..7 * 3).map(|i| if i % 7 < 4 { [0.0; 3] } else { [1e3; 3] }).collect();
        let picture = Picture { width: 7, height: 3, rgb };
        let whole = shown_within(&picture, PictureDisplay::Plain, 7);
        assert_eq!((whole.size, whole.pixels[3], whole.pixels[6]), ([7, 3], Color32::BLACK, Color32::WHITE));
        let shown = shown_within(&picture, PictureDisplay::Plain, 3);
        // Means of 3x3 blocks: all black, one of three columns black, and the rest at the edge.
        assert_eq!(
            (shown.size, &shown.pixels[..]),
            ([3, 1], &[Color32::BLACK, Color32::from_gray(170), Color32::WHITE][..])
        );
        assert_eq!(shown_within(&picture, PictureDisplay::Plain, 1).size, [1, 1]);
    }
}
