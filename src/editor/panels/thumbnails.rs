//! Textures of thumbnails: shipped studios as their cameras see them, and the things that can be added. Each is
//! requested when it is first shown.

use crate::editor::document::catalog::{CatalogEntry, CatalogItem};
use crate::editor::ui::image_texture::ImageTexture;
use crate::editor::ui::wake::wake;
use crate::jobs::{ThumbnailImage, ThumbnailJob, ThumbnailSubject};
use eframe::egui::{self, Color32, ColorImage, Context, Pos2, Rect, TextureId, pos2};
use std::collections::HashMap;
use std::time::SystemTime;

/// Longer side of a studio's thumbnail, points.
pub const STUDIO_POINTS: f32 = 92.0;
/// Longer side of an unsaved studio's thumbnail, points.
pub const UNSAVED_POINTS: f32 = 150.0;
/// Side of a thing's thumbnail, points.
pub const THING_POINTS: f32 = 30.0;
/// Pixels per point, along each side: the density of a high-resolution display. Others show means of four pixels.
const PIXELS_PER_POINT: f32 = 2.0;

/// Identifies a thumbnail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ThumbnailKey {
    /// A shipped studio, by its index in the list.
    Studio(usize),
    /// A figure, prop or backdrop, by its name in the catalog.
    Thing(&'static str),
    /// A studio that was not saved, by the time of its last change.
    Unsaved(SystemTime),
}

/// A thumbnail that can be painted.
#[derive(Clone, Copy, Debug)]
pub struct Thumbnail {
    texture: TextureId,
    /// Points.
    size: egui::Vec2,
}

impl Thumbnail {
    fn of(image_texture: &ImageTexture) -> Option<Self> {
        let size = image_texture.size()?.map(|pixels| pixels as f32 / PIXELS_PER_POINT);
        Some(Thumbnail { texture: image_texture.id()?, size: size.into() })
    }

    /// Paints it in the middle of `rect`, no larger than that.
    pub fn paint(&self, ui: &egui::Ui, rect: Rect) {
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let size = self.size * (rect.size() / self.size).min_elem().min(1.0);
        ui.painter().image(self.texture, Rect::from_center_size(rect.center(), size), whole, Color32::WHITE);
    }
}

/// The thumbnails that were requested.
#[derive(Debug, Default)]
pub struct Thumbnails {
    /// Empty until they are drawn.
    canvases: HashMap<ThumbnailKey, ImageTexture>,
    job: ThumbnailJob<ThumbnailKey>,
}

impl Thumbnails {
    /// Returns the thumbnail of a shipped studio; none until it is drawn.
    pub fn studio(&mut self, ctx: &Context, index: usize) -> Option<Thumbnail> {
        let subject = || Some(ThumbnailSubject::Studio(index));
        self.thumbnail(ctx, ThumbnailKey::Studio(index), STUDIO_POINTS, subject)
    }

    /// Returns the thumbnail of a figure, prop or backdrop; none until it is drawn, and none for lights.
    pub fn thing(&mut self, ctx: &Context, entry: &'static CatalogEntry) -> Option<Thumbnail> {
        let subject = || match entry.make() {
            CatalogItem::Object(object) => Some(ThumbnailSubject::Object(Box::new(object))),
            CatalogItem::Light(_) => None,
        };
        self.thumbnail(ctx, ThumbnailKey::Thing(entry.name), THING_POINTS, subject)
    }

    /// Returns the thumbnail of a studio that was last changed at some time; none until it is drawn.
    pub fn unsaved(
        &mut self,
        ctx: &Context,
        changed_at: SystemTime,
        subject: impl FnOnce() -> Option<ThumbnailSubject>,
    ) -> Option<Thumbnail> {
        self.thumbnail(ctx, ThumbnailKey::Unsaved(changed_at), UNSAVED_POINTS, subject)
    }

    fn thumbnail(
        &mut self,
        ctx: &Context,
        key: ThumbnailKey,
        points: f32,
        subject: impl FnOnce() -> Option<ThumbnailSubject>,
    ) -> Option<Thumbnail> {
        for (key, ThumbnailImage { size, rgb }) in self.job.take() {
            self.canvases.entry(key).or_default().set(ctx, ColorImage::from_rgb(size, &rgb));
        }
        if let Some(image_texture) = self.canvases.get(&key) {
            return Thumbnail::of(image_texture);
        }
        let subject = subject()?;
        self.canvases.insert(key, ImageTexture::default());
        self.job.request(key, subject, (points * PIXELS_PER_POINT) as u32, &wake(ctx));
        None
    }

    /// Returns the number of drawn thumbnails, as of the last request.
    pub fn drawn(&self) -> usize {
        self.canvases.values().filter(|image_texture| image_texture.id().is_some()).count()
    }

    /// Uploads all thumbnails to the device that the window has now.
    pub fn renew(&mut self, ctx: &Context) {
        self.canvases.values_mut().for_each(|image_texture| image_texture.renew(ctx));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog::{CatalogTab, entries};
    use crate::jobs::{BACKGROUND, draw_thumbnail};

    #[test]
    fn every_thing_in_the_catalog_fills_its_thumbnail_and_differs_from_the_background() {
        for tab in [CatalogTab::Figures, CatalogTab::Props, CatalogTab::Backdrops] {
            for entry in entries(tab) {
                let CatalogItem::Object(object) = entry.make() else { panic!("{} is a light", entry.name) };
                let image = draw_thumbnail(ThumbnailSubject::Object(Box::new(object)), 60).unwrap();
                let [width, height] = image.size;
                let drawn = |x: usize, y: usize| image.rgb[3 * (y * width + x)..][..3] != BACKGROUND;
                let columns = (0..width).filter(|x| (0..height).any(|y| drawn(*x, y))).count();
                let rows = (0..height).filter(|y| (0..width).any(|x| drawn(x, *y))).count();
                // Its bounding box fills one of the sides; a ball fills less of it than its box.
                assert!(columns.max(rows) >= 6 * width / 10, "{}: {columns} x {rows} of {width}", entry.name);
                assert!(!drawn(0, 0) && !drawn(width - 1, 0), "{} is cut off", entry.name);
                let contrast = image.rgb.iter().map(|channel| channel.abs_diff(BACKGROUND[1])).max().unwrap();
                assert!(contrast > 20, "{} has too little contrast: {contrast}", entry.name);
            }
        }
    }
}
