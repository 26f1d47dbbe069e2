//! What renderers without sheen and brushing draw in their place.

use super::Material;
use glam::Vec3;

/// Mean albedo of white sheen over all directions, which varies between 0.15 and 0.3 with its roughness.
const MEAN_SHEEN: f32 = 0.2;

/// The base colour and roughness by which a renderer without sheen and brushing comes near to a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainBase {
    /// The base colour with the mean of the sheen.
    pub base_color: [f32; 3],
    /// The roughness of a highlight of the same area.
    pub roughness: f32,
}

impl Material {
    /// Returns the base without sheen and brushing: the mean light of the sheen is diffuse, and highlights are round.
    pub fn plain_base(&self) -> PlainBase {
        let mut base_color = self.base_color;
        if let Some(sheen) = &self.sheen {
            let largest = Vec3::from(sheen.color).max_element().min(1.0);
            base_color = std::array::from_fn(|channel| {
                self.base_color[channel] * (1.0 - MEAN_SHEEN * largest) + MEAN_SHEEN * sheen.color[channel]
            });
        }
        let roughness = match self.anisotropy {
            Some(anisotropy) => {
                let [across, along] = anisotropy.alphas(self.roughness * self.roughness);
                // alpha is the square of the roughness
                (across * along).max(0.0).powf(0.25)
            }
            None => self.roughness,
        };
        PlainBase { base_color, roughness }
    }
}
