//! The path-traced live view (*True*): requested after a change, displayed progressively.

use crate::editor::commands::choices::LiveMode;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::wake::wake;
use crate::editor::viewport::live::preview_host::ViewOptions;
use crate::jobs::{LiveImage, LiveJob, LiveRequest};
use crate::photo::Picture;
use crate::preview::Channel;
use crate::raytrace::{GeometryCache, LiveCamera, MAX_LIGHT_LAYERS};
use crate::scene::{CameraFrame, LightId};
use eframe::egui::{ColorImage, Context, TextureId};
use std::sync::Arc;

/// Most pixels of a traced view; larger views are traced at 1/2, 1/3 ... and enlarged.
const MAX_PIXELS: f32 = 1_300_000.0;
/// Most pixels times light layers: 16 bytes each, twice while the view moves.
const MAX_LAYER_PIXELS: f32 = 12_000_000.0;

/// Everything that the image depends on; an equal key needs no request.
#[derive(Clone, Debug, PartialEq)]
struct TracedViewKey {
    revision: u64,
    camera: LiveCamera,
    only_light: Option<LightId>,
    smooth: bool,
}

/// The traced view: its job, its last image and its last request.
#[derive(Debug, Default)]
pub struct TracedView {
    /// The renderer that the viewport shows.
    pub mode: LiveMode,
    job: LiveJob,
    requested: Option<TracedViewKey>,
    image_texture: ImageTexture,
    /// The scene-linear picture of the image.
    picture: Option<Arc<Picture>>,
    /// Samples per pixel of the current image, and true if it is finished.
    shown: Option<(u32, bool)>,
    failure: Option<String>,
}

impl TracedView {
    /// Returns a view that shares the BLAS cache with the renders.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        TracedView { job: LiveJob::new(cache), ..TracedView::default() }
    }

    /// Switches to the other renderer.
    pub fn toggle(&mut self) {
        self.mode = match self.mode {
            LiveMode::Quick => LiveMode::True,
            LiveMode::True => LiveMode::Quick,
        };
    }

    /// Clears the image, because another studio was opened.
    pub fn clear(&mut self) {
        self.job.forget();
        self.image_texture.clear();
        (self.shown, self.requested, self.failure, self.picture) = (None, None, None, None);
    }

    /// Uploads the image to the window's current device.
    pub fn move_to(&mut self, ctx: &Context) {
        self.image_texture.renew(ctx);
    }

    /// Pauses the tracer while its image is not displayed.
    pub fn pause(&self) {
        self.job.pause(true);
    }

    /// Returns the traced image of a view of `size` pixels, if any; requests a new one after a change.
    pub fn show(
        &mut self,
        ctx: &Context,
        document: &Document,
        frame: CameraFrame,
        size: (u32, u32),
        through_camera: bool,
        view_options: ViewOptions,
    ) -> Option<TextureId> {
        // The other channels come from the G-buffer of the GPU preview.
        if self.mode == LiveMode::Quick || view_options.channel != Channel::Lit {
            self.pause();
            return None;
        }
        self.job.pause(false);
        if ctx.input(|i| !i.events.is_empty()) {
            self.job.note_input();
        }
        let lights = document.scene().lights.iter().filter(|light| light.on).count();
        let size = traced_size(size, lights);
        let camera = if through_camera {
            LiveCamera::through_lens(document.scene(), frame, size)
        } else {
            LiveCamera::pinhole(frame, size)
        };
        let only_light = view_options.only_light.filter(|id| document.scene().light(*id).is_some());
        let requested =
            TracedViewKey { revision: document.revisions().image, camera, only_light, smooth: view_options.smooth };
        if self.requested.as_ref() != Some(&requested) {
            let (mut scene, assets) = (document.scene().clone(), document.assets().clone());
            if let Some(only) = only_light {
                scene.lights.iter_mut().for_each(|light| light.on &= light.id == only);
            }
            self.job.request(
                LiveRequest { scene: Arc::new(scene), assets, camera, smooth: view_options.smooth },
                &wake(ctx),
            );
            self.requested = Some(requested);
        }
        match self.job.take() {
            Some(Ok(image)) => self.take_in(image, ctx),
            Some(Err(message)) => self.failure = Some(message),
            None => {}
        }
        self.image_texture.id()
    }

    fn take_in(&mut self, image: LiveImage, ctx: &Context) {
        (self.shown, self.failure) = (Some((image.spp, image.is_done)), None);
        self.picture = Some(image.picture);
        self.image_texture.set(ctx, ColorImage::from_rgb([image.width, image.height], &image.rgb));
    }

    /// Returns the status line: the progress, or the reason of a failure.
    pub fn status(&self) -> String {
        match (&self.failure, self.shown) {
            (Some(message), _) => message.clone(),
            (None, Some((spp, true))) => format!("True: settled, {spp} samples"),
            (None, Some((0, false))) | (None, None) => "True: tracing\u{2026}".to_owned(),
            (None, Some((spp, false))) => format!("True: {spp} sample{}\u{2026}", if spp == 1 { "" } else { "s" }),
        }
    }

    /// Returns true if the last request has been traced and displayed.
    pub fn is_settled(&self) -> bool {
        self.job.is_idle()
    }

    /// Returns true if the scene cannot be traced.
    pub fn has_failed(&self) -> bool {
        self.mode == LiveMode::True && self.failure.is_some()
    }

    /// Returns the scene-linear picture of the image.
    pub fn picture(&self) -> Option<&Arc<Picture>> {
        self.picture.as_ref()
    }

    /// Returns true if there is an image.
    pub fn has_picture(&self) -> bool {
        self.image_texture.id().is_some()
    }

    /// Returns true if tracing is paused and has stopped.
    pub fn is_stopped(&self) -> bool {
        self.job.is_stopped()
    }

    /// Returns the number of rays traced.
    pub fn rays(&self) -> u64 {
        self.job.rays()
    }
}

/// Returns the size at which a view with this number of lights is traced.
fn traced_size((width, height): (u32, u32), lights: usize) -> (u32, u32) {
    let layers = lights.min(MAX_LIGHT_LAYERS) + 1;
    let most = MAX_PIXELS.min(MAX_LAYER_PIXELS / layers as f32);
    let times = (1..).find(|n| width as f32 * height as f32 <= most * (n * n) as f32).unwrap_or(1);
    (width.div_ceil(times).max(1), height.div_ceil(times).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_views_are_traced_at_a_fraction_of_their_size() {
        for (size, traced) in
            [((850, 760), (850, 760)), ((1920, 1200), (960, 600)), ((3840, 2160), (1280, 720)), ((1, 1), (1, 1))]
        {
            assert_eq!(traced_size(size, 4), traced);
        }
        assert_eq!(traced_size((1280, 720), 40), (640, 360), "many layers take their memory");
    }
}
