//! A picture of the processor's on the window's device: uploaded when it changes, and again when the device does.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::sync::Arc;

/// The picture and its texture.
#[derive(Default)]
pub struct ImageTexture {
    image: Option<Arc<ColorImage>>,
    texture: Option<TextureHandle>,
}

impl std::fmt::Debug for ImageTexture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ImageTexture")
            .field("size", &self.image.as_ref().map(|image| image.size))
            .finish_non_exhaustive()
    }
}

impl ImageTexture {
    /// Shows another picture.
    pub fn set(&mut self, ctx: &Context, image: impl Into<Arc<ColorImage>>) {
        let image = image.into();
        match &mut self.texture {
            Some(texture) => texture.set(image.clone(), TextureOptions::LINEAR),
            None => self.texture = Some(ctx.load_texture("image_texture", image.clone(), TextureOptions::LINEAR)),
        }
        self.image = Some(image);
    }

    /// Uploads the picture to the device that the window has now.
    pub fn renew(&mut self, ctx: &Context) {
        self.texture = None;
        if let Some(image) = self.image.take() {
            self.set(ctx, image);
        }
    }

    /// Shows nothing.
    pub fn clear(&mut self) {
        *self = ImageTexture::default();
    }

    /// Pixels of the picture.
    pub fn size(&self) -> Option<[usize; 2]> {
        self.image.as_ref().map(|image| image.size)
    }

    /// The texture, when there is a picture.
    pub fn id(&self) -> Option<TextureId> {
        self.texture.as_ref().map(TextureHandle::id)
    }
}
