//! An image with its texture on the window's device, uploaded when image or device changes.

use eframe::egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};
use std::sync::Arc;

/// An image and its texture.
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
    /// Sets another image.
    pub fn set(&mut self, ctx: &Context, image: impl Into<Arc<ColorImage>>) {
        let image = image.into();
        match &mut self.texture {
            Some(texture) => texture.set(image.clone(), TextureOptions::LINEAR),
            None => self.texture = Some(ctx.load_texture("image_texture", image.clone(), TextureOptions::LINEAR)),
        }
        self.image = Some(image);
    }

    /// Uploads the image to the window's current device.
    pub fn renew(&mut self, ctx: &Context) {
        self.texture = None;
        if let Some(image) = self.image.take() {
            self.set(ctx, image);
        }
    }

    /// Removes the image.
    pub fn clear(&mut self) {
        *self = ImageTexture::default();
    }

    /// Returns width and height, pixels.
    pub fn size(&self) -> Option<[usize; 2]> {
        self.image.as_ref().map(|image| image.size)
    }

    /// Returns the texture, if there is an image.
    pub fn id(&self) -> Option<TextureId> {
        self.texture.as_ref().map(TextureHandle::id)
    }
}
