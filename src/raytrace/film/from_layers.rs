//! A film from developed layers, as an EXR file holds them.

use super::noise::PixelNoise;
use super::{Film, Layer};
use crate::color::luminance;
use crate::photo::{AovPicture, Picture};
use crate::raytrace::approximations::Approximations;
use crate::raytrace::settings::Settings;
use crate::scene::Scene;
use glam::Vec3;
use std::sync::Arc;

impl Film {
    /// Returns a film whose layers develop to these pictures with the lights of `scene`. What a light of no power or
    /// without a colour channel would add is not known: it is black. The noise of the samples is that of the AOVs.
    ///
    /// # Panics
    /// If a picture has another size than the settings.
    pub fn from_layers(
        settings: &Settings,
        approximations: Approximations,
        scene: &Scene,
        layers: &[(Layer, Picture)],
        aovs: Option<&AovPicture>,
    ) -> Film {
        let mut kinds: Vec<Layer> = layers.iter().map(|(layer, _)| layer.clone()).collect();
        // The last layer is that of emissive surfaces
        if kinds.last().is_none_or(|layer| layer.light.is_some()) {
            kinds.push(Layer::shared("Glow"));
        }
        let settings = Settings { aovs: aovs.is_some(), ..settings.clone() };
        let mut film = Film::new(&settings, kinds, approximations);
        let (samples, width) = (settings.spp.max(1) as f32, settings.width as usize);
        let per_weight = |weight: f32| if weight > 0.0 { samples / weight } else { 0.0 };
        let scales: Vec<Vec3> = film.weights(scene).into_iter().map(|weight| weight.map(per_weight)).collect();
        for tile in &mut film.tiles {
            let tile = Arc::make_mut(tile);
            let mut noise = Vec::with_capacity(tile.pixels());
            for pixel in 0..tile.pixels() {
                let (x, y) = tile.position(pixel);
                let at = y as usize * width + x as usize;
                for (layer, (_, picture)) in layers.iter().enumerate() {
                    tile.sums.set(layer, pixel, Vec3::from(picture.rgb[at]) * scales[layer]);
                }
                let exposed: Vec3 = layers.iter().map(|(_, picture)| Vec3::from(picture.rgb[at])).sum();
                let relative_variance = aovs.map_or(f32::INFINITY, |aovs| aovs.relative_variance[at]);
                noise.push(PixelNoise { luminance: luminance(exposed), relative_variance });
                if let (Some(tile), Some(aovs)) = (&mut tile.aovs, aovs) {
                    tile.set(pixel, samples, aovs, at);
                }
            }
            tile.blocks.set(settings.spp.max(1), &noise);
        }
        film
    }
}
