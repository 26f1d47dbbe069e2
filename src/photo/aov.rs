//! AOVs (arbitrary output variables): albedo, normal, depth and object id of a picture's pixels.

use super::picture::resized;

/// Albedo, normal, depth, object and noise of every pixel, rows from the top.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct AovPicture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Base colour times its texture, linear RGB, also of clear glass, whose transmitted light it tints. Of a fibre, the
    /// mean albedo over all directions; white for emitters, zero where nothing is hit.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal towards the viewer, world space; zero where nothing is hit and for emitters. Shorter than 1 where
    /// the samples of a pixel differ.
    pub normal: Vec<[f32; 3]>,
    /// Albedo of what is seen directly or by mirrors and clear glass, times what these reflect and transmit.
    pub seen_albedo: Vec<[f32; 3]>,
    /// Normal of what is seen, as `seen_albedo`.
    pub seen_normal: Vec<[f32; 3]>,
    /// Distance along the view axis, metres; infinite where nothing is hit.
    pub depth_m: Vec<f32>,
    /// Object: [`AovPicture::NO_OBJECT`], [`AovPicture::ROOM`] or an [`AovPicture::object_id`].
    pub object_id: Vec<u32>,
    /// Estimated variance of the pixel's mean luminance, divided by the square of the mean; infinite where it is not
    /// known.
    pub relative_variance: Vec<f32>,
}

impl AovPicture {
    /// Id where nothing is hit, or an emitter that the camera sees.
    pub const NO_OBJECT: u32 = 0;
    /// Id of the room.
    pub const ROOM: u32 = 1;

    /// Creates the AOVs of a picture without hits.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        AovPicture {
            width,
            height,
            albedo: vec![[0.0; 3]; pixels],
            normal: vec![[0.0; 3]; pixels],
            seen_albedo: vec![[0.0; 3]; pixels],
            seen_normal: vec![[0.0; 3]; pixels],
            depth_m: vec![f32::INFINITY; pixels],
            object_id: vec![Self::NO_OBJECT; pixels],
            relative_variance: vec![f32::INFINITY; pixels],
        }
    }

    /// Returns the AOVs of a picture without mirrors and clear glass, where what is seen is what is hit first.
    pub fn seen_directly(self) -> Self {
        AovPicture { seen_albedo: self.albedo.clone(), seen_normal: self.normal.clone(), ..self }
    }

    /// Returns true if mirrors or clear glass show what is not hit first.
    pub fn has_mirrors(&self) -> bool {
        (&self.seen_albedo, &self.seen_normal) != (&self.albedo, &self.normal)
    }

    /// Resizes by the nearest pixel.
    pub fn into_resized(self, width: u32, height: u32) -> AovPicture {
        let (from, to) = ((self.width, self.height), (width, height));
        if from == to {
            return self;
        }
        AovPicture {
            width,
            height,
            albedo: resized(&self.albedo, from, to),
            normal: resized(&self.normal, from, to),
            seen_albedo: resized(&self.seen_albedo, from, to),
            seen_normal: resized(&self.seen_normal, from, to),
            depth_m: resized(&self.depth_m, from, to),
            object_id: resized(&self.object_id, from, to),
            relative_variance: resized(&self.relative_variance, from, to),
        }
    }

    /// Returns the id of an object by its index in the scene: from 2 on, in scene order.
    pub fn object_id(index: usize) -> u32 {
        u32::try_from(index + 2).unwrap_or(u32::MAX)
    }
}
