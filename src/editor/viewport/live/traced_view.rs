//! The live view as the tracer sees it, *True*: requested for when something changed, shown while it grows.

use crate::editor::commands::choices::LiveMode;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::wake::wake;
use crate::editor::viewport::live::preview_host::ViewOptions;
use crate::jobs::{LiveImage, LiveJob, LiveRequest};
use crate::preview::Channel;
use crate::raytrace::{GeometryCache, LiveCamera, MAX_LIGHT_LAYERS};
use crate::scene::{CameraFrame, LightId};
use eframe::egui::{ColorImage, Context, TextureId};
use std::sync::Arc;

/// Pixels of a traced view at most: larger ones are traced at a half, a third ... and enlarged.
const MOST_PIXELS: f32 = 1_300_000.0;
/// Pixels times layers at most: 16 bytes each, twice while the view moves.
const MOST_SUMS: f32 = 12_000_000.0;

/// What a picture is made from; while it is the same, nothing is requested for.
#[derive(Clone, Debug, PartialEq)]
struct TracedViewKey {
    revision: u64,
    camera: LiveCamera,
    only_light: Option<LightId>,
    smooth: bool,
}

/// The thread, the picture it made last, and what it was requested for.
#[derive(Debug, Default)]
pub struct TracedView {
    /// Which of the two the viewport shows.
    pub mode: LiveMode,
    job: LiveJob,
    requested: Option<TracedViewKey>,
    image_texture: ImageTexture,
    /// The view that the picture on show belongs to is the one that was requested for.
    shown: Option<(u32, bool)>,
    failure: Option<String>,
}

impl TracedView {
    /// A view that shares meshes' trees with the renders.
    pub fn new(cache: Arc<GeometryCache>) -> Self {
        TracedView { job: LiveJob::new(cache), ..TracedView::default() }
    }

    /// The other mode.
    pub fn toggle(&mut self) {
        self.mode = match self.mode {
            LiveMode::Quick => LiveMode::True,
            LiveMode::True => LiveMode::Quick,
        };
    }

    /// Forgets the picture, because another studio was opened.
    pub fn clear(&mut self) {
        self.image_texture.clear();
        (self.shown, self.requested, self.failure) = (None, None, None);
    }

    /// Brings the picture to the device that the window has now.
    pub fn move_to(&mut self, ctx: &Context) {
        self.image_texture.renew(ctx);
    }

    /// Stops the tracer while its picture is not on show.
    pub fn pause(&self) {
        self.job.pause(true);
    }

    /// The traced picture of a view of `size` pixels, as far as there is one; asks for what has changed.
    pub fn show(
        &mut self,
        ctx: &Context,
        document: &Document,
        frame: CameraFrame,
        size: (u32, u32),
        through_camera: bool,
        view_options: ViewOptions,
    ) -> Option<TextureId> {
        // What the G-buffer holds is the graphics card's affair.
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
        self.image_texture.set(ctx, ColorImage::from_rgb([image.width, image.height], &image.rgb));
    }

    /// What the view says of itself: how far it is, or why there is none.
    pub fn status(&self) -> String {
        match (&self.failure, self.shown) {
            (Some(message), _) => message.clone(),
            (None, Some((spp, true))) => format!("True: settled, {spp} samples"),
            (None, Some((0, false))) | (None, None) => "True: tracing\u{2026}".to_owned(),
            (None, Some((spp, false))) => format!("True: {spp} sample{}\u{2026}", if spp == 1 { "" } else { "s" }),
        }
    }

    /// Whether all that was requested for has been traced and is on show.
    pub fn is_settled(&self) -> bool {
        self.job.is_idle()
    }

    /// Whether there is no picture because the scene cannot be traced.
    pub fn has_failed(&self) -> bool {
        self.mode == LiveMode::True && self.failure.is_some()
    }

    /// Whether there is a picture to show.
    pub fn has_picture(&self) -> bool {
        self.image_texture.id().is_some()
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.job.rays()
    }
}

/// The size at which a view under so many lights is traced.
fn traced_size((width, height): (u32, u32), lights: usize) -> (u32, u32) {
    let layers = lights.min(MAX_LIGHT_LAYERS) + 1;
    let most = MOST_PIXELS.min(MOST_SUMS / layers as f32);
    let times = (1..).find(|n| width as f32 * height as f32 <= most * (n * n) as f32).unwrap_or(1);
    (width.div_ceil(times).max(1), height.div_ceil(times).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_views_are_traced_at_a_part_of_their_size() {
        for (size, traced) in
            [((850, 760), (850, 760)), ((1920, 1200), (960, 600)), ((3840, 2160), (1280, 720)), ((1, 1), (1, 1))]
        {
            assert_eq!(traced_size(size, 4), traced);
        }
        assert_eq!(traced_size((1280, 720), 40), (640, 360), "many layers take their memory");
    }
}
