//! The rendered pictures of the variants of a studio, and the comparison of two of them.

use crate::editor::commands::choices::{CompareMode, Comparison};
use crate::editor::picture::rendering::{Rendering, image_within};
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::wake::wake;
use crate::figures;
use crate::io::KeptPicture;
use crate::jobs::Priority;
use crate::jobs::worker::{Inbox, Interrupt, Worker, WorkerSettings};
use crate::photo::{Picture, PictureDifference};
use crate::raytrace::Film;
use crate::scene::{Scene, VariantId};
use eframe::egui::{ColorImage, Context, TextureId};
use std::collections::HashMap;
use std::sync::{Arc, Weak};

/// Two pictures: the shown one, and the other.
type Pair = [Arc<Picture>; 2];

/// A difference for the screen, of two pictures.
#[derive(Debug)]
struct ShownDifference {
    of: Pair,
    /// The image with the mean difference in stops; none of pictures of different sizes.
    image: Option<(ColorImage, f32)>,
}

/// The pictures of the variants that are not shown, and the difference from one of them.
#[derive(Debug)]
pub struct VariantPictures {
    /// The variant whose picture is not here, because the window shows it.
    shown: VariantId,
    others: HashMap<VariantId, Rendering>,
    worker: Worker<(Pair, usize), ShownDifference>,
    requested: Option<Pair>,
    /// The newest comparison: the mean difference in stops, or why there is none.
    latest: Option<(Pair, Result<f32, String>)>,
    texture: ImageTexture,
}

/// Message for pictures of different sizes.
const OTHER_SIZES: &str = "The two pictures have different sizes: render both in one size to compare them.";

const WORKER: WorkerSettings = WorkerSettings {
    name: "difference",
    priority: Priority::Normal,
    interrupt: Interrupt::AfterResult,
    panic_message: "The pictures could not be compared, because of an internal error.",
};

impl Default for VariantPictures {
    fn default() -> Self {
        VariantPictures {
            shown: VariantId::default(),
            others: HashMap::new(),
            worker: Worker::new(WORKER, serve),
            requested: None,
            latest: None,
            texture: ImageTexture::default(),
        }
    }
}

impl VariantPictures {
    /// Forgets all pictures, because a studio with these variants was opened.
    pub fn clear(&mut self, scene: &Scene) {
        self.others.clear();
        (self.shown, self.requested, self.latest) = (scene.variants.shown(), None, None);
        self.worker.reset();
        self.texture.clear();
    }

    /// Exchanges the picture in the window for that of the variant which the scene shows now, and forgets those of
    /// variants that are gone. A variant without a picture takes the one in the window if that needs only to be relit.
    /// Called once per frame.
    pub fn follow(&mut self, rendering: &mut Rendering, scene: &Scene) {
        let shown = scene.variants.shown();
        if shown != self.shown {
            let kept = self.others.remove(&shown);
            let next = match kept {
                Some(kept) if kept.is_busy() || (kept.texture().is_some() && !kept.is_out_of_date(scene)) => kept,
                // A picture that is only to be relit is better than one that is out of date
                kept => rendering.for_other_lights(scene).or(kept).unwrap_or_else(|| rendering.without_picture()),
            };
            let former = std::mem::replace(rendering, next);
            (rendering.settings, rendering.display) = (former.settings, former.display);
            self.others.insert(self.shown, former);
            self.shown = shown;
        }
        self.others.retain(|id, _| scene.variants.name(*id).is_some());
    }

    /// Updates the picture that is compared, and those that are being rendered. Called once per frame.
    pub fn update(&mut self, rendering: &Rendering, comparison: Comparison, scene: &Scene, ctx: &Context) {
        let compared = self.compared(comparison);
        for (id, other) in &mut self.others {
            if Some(*id) == compared || other.is_busy() {
                other.display = rendering.display;
                other.settings = rendering.settings;
                if let Some(scene) = figures::as_variant(scene, *id) {
                    other.update(&scene, ctx);
                }
                // Forecasts are made from the shown picture
                let _ = other.take_outcome();
            }
        }
        self.update_difference(rendering, comparison, ctx);
    }

    fn update_difference(&mut self, rendering: &Rendering, comparison: Comparison, ctx: &Context) {
        match (self.worker.take(), self.requested.clone()) {
            (Some(Ok(difference)), _) => {
                let mean = difference.image.map(|(image, mean)| {
                    self.texture.set(ctx, image);
                    mean
                });
                self.latest = Some((difference.of, mean.ok_or_else(|| OTHER_SIZES.to_owned())));
            }
            (Some(Err(message)), Some(requested)) => self.latest = Some((requested, Err(message))),
            _ => {}
        }
        if comparison.mode != CompareMode::Difference {
            // The pictures need no memory meanwhile
            (self.requested, self.latest) = (None, None);
            return;
        }
        let Some(pair) = self.pair(rendering, comparison) else { return };
        if !self.requested.as_ref().is_some_and(|requested| is_same(requested, &pair)) {
            self.requested = Some(pair.clone());
            self.worker.request((pair, ctx.input(|i| i.max_texture_side)), &wake(ctx));
        }
    }

    fn pair(&self, rendering: &Rendering, comparison: Comparison) -> Option<Pair> {
        let other = self.other(comparison)?.1;
        Some([rendering.developed()?.picture.clone(), other.developed()?.picture.clone()])
    }

    /// Returns the variant that is compared, if it has a picture.
    fn compared(&self, comparison: Comparison) -> Option<VariantId> {
        let has_picture = |id: &VariantId| self.has_picture(*id);
        let first = || self.others.keys().copied().filter(has_picture).min();
        (comparison.mode != CompareMode::Off).then(|| comparison.with.filter(has_picture).or_else(first))?
    }

    /// Returns the variant that is compared, with its picture.
    pub fn other(&self, comparison: Comparison) -> Option<(VariantId, &Rendering)> {
        let id = self.compared(comparison)?;
        Some((id, self.others.get(&id)?))
    }

    /// Notes that models or textures of the studio have other content now, for the shown picture and all others.
    pub fn note_changed_assets(&mut self, rendering: &mut Rendering) {
        self.others.values_mut().chain([rendering]).for_each(Rendering::note_changed_assets);
    }

    /// Returns true if the picture of a variant that is not shown is there.
    pub fn has_picture(&self, id: VariantId) -> bool {
        self.others.get(&id).is_some_and(|other| other.texture().is_some())
    }

    /// Returns the difference of the two pictures: its texture, and its mean in stops, or why there is none. None until it
    /// is there.
    pub fn difference(&self, rendering: &Rendering, comparison: Comparison) -> Option<Result<(TextureId, f32), &str>> {
        let pair = self.pair(rendering, comparison)?;
        let (_, mean) = self.latest.as_ref().filter(|(of, _)| is_same(of, &pair))?;
        match mean {
            Ok(mean) => Some(Ok((self.texture.id()?, *mean))),
            Err(message) => Some(Err(message)),
        }
    }

    /// Returns the picture to keep for the case of a crash: the one in the window, else one of another variant.
    pub fn to_keep(&self, rendering: &Rendering) -> Option<KeptPicture> {
        let running_first = |(id, other): &(&VariantId, &Rendering)| (!other.is_running(), **id);
        let mut others: Vec<_> = self.others.iter().collect();
        others.sort_by_key(running_first);
        rendering.to_keep().or_else(|| others.into_iter().find_map(|(_, other)| other.to_keep()))
    }

    /// Returns true if a picture, of any variant, is not exported and took long to render.
    pub fn is_costly_to_lose(&self, rendering: &Rendering) -> bool {
        rendering.is_costly_to_lose() || self.others.values().any(Rendering::is_costly_to_lose)
    }

    /// Notes the film whose picture was exported.
    pub fn mark_exported(&mut self, rendering: &mut Rendering, film: &Weak<Film>) {
        for rendering in self.others.values_mut().chain([rendering]) {
            rendering.mark_exported(film);
        }
    }

    /// Returns a variant that is not shown and is being rendered.
    pub fn running(&self) -> Option<VariantId> {
        self.others.iter().find(|(_, other)| other.is_running()).map(|(id, _)| *id)
    }

    /// Returns true during renders and comparisons.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy() || self.others.values().any(Rendering::is_busy)
    }

    /// Uploads the pictures to the window's current device.
    pub fn move_to(&mut self, ctx: &Context) {
        self.others.values_mut().for_each(|other| other.move_to(ctx));
        self.texture.renew(ctx);
    }
}

fn is_same(pair: &Pair, other: &Pair) -> bool {
    pair.iter().zip(other).all(|(a, b)| Arc::ptr_eq(a, b))
}

/// The body of the thread.
fn serve(inbox: &Inbox<(Pair, usize), ShownDifference>) {
    while let Some(((of, max_side), _)) = inbox.next() {
        let difference = PictureDifference::between(&of[0], &of[1]);
        let image = difference.map(|PictureDifference { size, srgb8, mean_stops }| {
            (image_within([size.0 as usize, size.1 as usize], &srgb8, max_side), mean_stops)
        });
        inbox.publish(ShownDifference { of, image });
    }
}
