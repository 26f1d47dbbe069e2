//! The history of the live view: the reverse-reprojection cache.
//!
//! Each pixel of the new view is projected into the view before the camera moved. Its value there is the mean of the
//! four pixels around the projected position that show the same surface: object, material, normal and tangent plane
//! agree (Nehab et al. 2007, "Accelerating Real-Time Shading with Reverse Reprojection Caching"). Disoccluded pixels
//! find none and are traced. The weight of view-dependent reflection falls with the angle by which the view has turned
//! about the surface, to zero at the width of the gloss. The weight is limited, so that the accumulated mean converges
//! to the new view.
//!
//! When water moves on, the picture before is a history, too: the water itself, which is clear, is never taken from it;
//! the land around it is, where the surface is the same, with less weight, since the light on it has changed.

use super::camera::LiveCamera;
use super::live_film::LiveFilm;
use super::live_tile::LiveTile;
use super::primary_hit::PrimaryHit;
use crate::math;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Largest weight of a reprojected pixel after the camera moved, in samples.
pub const MAX_WEIGHT: f32 = 16.0;
/// The same after water moved.
pub const FLOW_WEIGHT: f32 = 4.0;

/// Smallest bilinear weight of the neighbours that show the surface.
const MIN_COVERAGE: f32 = 0.3;

/// A picture of the live view before the camera or water moved.
#[derive(Debug)]
pub struct ReprojectionHistory {
    film: LiveFilm,
    camera: LiveCamera,
    /// Spacing of the pixels that have a value.
    stride: u32,
    /// Largest weight of a reprojected pixel, in samples.
    max_weight: f32,
}

impl ReprojectionHistory {
    /// Keeps a picture whose pixels have values at every `stride`th. Pixels at edges are excluded: their samples come
    /// from both sides.
    pub fn new(mut film: LiveFilm, camera: LiveCamera, stride: u32, max_weight: f32) -> Self {
        let edges: Vec<Vec<usize>> =
            film.tiles.par_iter().map(|tile| edge_pixels(&film, &camera, stride, tile)).collect();
        for (tile, edges) in film.tiles.iter_mut().zip(edges) {
            for pixel in edges {
                tile.primary_hits[pixel].alpha = PrimaryHit::VIEW_DEPENDENT;
            }
        }
        ReprojectionHistory { film, camera, stride, max_weight }
    }

    /// Returns the film, to reuse its memory.
    pub fn into_film(self) -> LiveFilm {
        self.film
    }

    /// Writes the history of a surface seen from `eye` to `layers`: sum and weight. Returns false where there is none.
    pub fn reproject(&self, hit: &PrimaryHit, eye: Vec3, layers: &mut [Vec4]) -> bool {
        // Limit the weight by the angle between the two views
        let max_weight = self.max_weight * self.view_agreement(hit, eye);
        if max_weight < 1.0 {
            return false;
        }

        // Project the hit into the former view, in units of its pixel grid
        let Some(pixel) = self.camera.project(hit.position) else { return false };
        let grid = (pixel - 0.5) / self.stride as f32;
        let (corner, fraction) = (grid.floor(), grid - grid.floor());
        let depth_scale_m = self.camera.depth_scale(hit.position);

        // Accumulate the bilinear neighbours that show the same surface
        let mut coverage = 0.0;
        for offset in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let Some((tile, pixel)) = self.film.pixel_at((corner + offset) * self.stride as f32) else { continue };
            let neighbour = &tile.primary_hits[pixel];
            let has_all_layers = (0..layers.len()).all(|layer| tile.sums.at(layer, pixel).w > 0.0);
            if neighbour.alpha < 0.0 || !has_all_layers || !hit.is_same_surface(neighbour, depth_scale_m) {
                continue;
            }
            let bilinear = Vec2::ONE - fraction + offset * (2.0 * fraction - 1.0);
            let weight = bilinear.x * bilinear.y;
            coverage += weight;
            for (layer, value) in layers.iter_mut().enumerate() {
                let sum = tile.sums.at(layer, pixel);
                *value += (sum.truncate() / sum.w).extend(sum.w.min(max_weight)) * weight;
            }
        }
        if coverage < MIN_COVERAGE {
            return false;
        }

        // Turn the means into sums with their weight
        for value in layers {
            let weight = value.w / coverage;
            *value = (value.truncate() / coverage * weight).extend(weight);
        }
        true
    }

    /// Scales the radiance of the history.
    #[cfg(test)]
    pub fn distort(&mut self, factor: f32) {
        let layers = self.film.layers.len();
        for tile in &mut self.film.tiles {
            for layer in 0..layers {
                for pixel in 0..tile.pixels() {
                    let sum = tile.sums.at(layer, pixel);
                    tile.sums.set(layer, pixel, (sum.truncate() * factor).extend(sum.w));
                }
            }
        }
    }

    /// Returns the fraction of the weight that a surface keeps after the view has turned about it: 1 for the same view,
    /// 0 from an angle as wide as its gloss.
    fn view_agreement(&self, hit: &PrimaryHit, eye: Vec3) -> f32 {
        if hit.alpha < 0.0 {
            return 0.0;
        }
        let angle_rad = math::angle_between(hit.position - eye, hit.position - self.camera.eye());
        // A mirror has no width: it keeps its value only in the very same view.
        if angle_rad <= 0.0 { 1.0 } else { (1.0 - angle_rad / hit.alpha.max(f32::MIN_POSITIVE)).max(0.0) }
    }
}

/// Returns the pixels of a tile with a neighbour that shows another surface.
fn edge_pixels(film: &LiveFilm, camera: &LiveCamera, stride: u32, tile: &LiveTile) -> Vec<usize> {
    let is_edge = |pixel: &usize| {
        let (x, y) = tile.position(*pixel);
        let hit = &tile.primary_hits[*pixel];
        let depth_scale_m = camera.depth_scale(hit.position);
        [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].into_iter().any(|offset| {
            let neighbour = film.pixel_at(Vec2::new(x as f32, y as f32) + offset * stride as f32);
            neighbour.is_some_and(|(tile, pixel)| !hit.is_same_surface(&tile.primary_hits[pixel], depth_scale_m))
        })
    };
    (0..tile.pixels()).filter(|pixel| tile.primary_hits[*pixel].alpha >= 0.0).filter(is_edge).collect()
}
