//! What is known from before the camera moved: the reverse-reprojection cache.
//!
//! A pixel of the new view asks where its surface was seen in the old one, and takes over the mean of the four pixels
//! around that place which show the same surface: object, material, normal and depth agree (Nehab et al. 2007,
//! "Accelerating Real-Time Shading with Reverse Reprojection Caching"). What depends on the view counts the less the
//! more the view has turned about the surface, and not at all where it has turned by more than the gloss is wide.
//! What is taken over counts as few samples: the picture converges to the truth, not to its past.

use super::camera::LiveCamera;
use super::live_film::LiveFilm;
use super::tile::Shown;
use crate::math;
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// Samples as which a pixel's past counts at most.
pub const MOST_WEIGHT: f32 = 16.0;

/// Share of the four pixels around a place that must show the surface.
const ENOUGH: f32 = 0.3;

/// A picture that the camera has moved away from.
#[derive(Debug)]
pub struct History {
    film: LiveFilm,
    camera: LiveCamera,
    /// Pixels between those that have a value.
    stride: u32,
}

impl History {
    /// Keeps a picture whose pixels have values at every `stride`th. Pixels at edges are left out: they hold some of both
    /// sides.
    pub fn new(mut film: LiveFilm, camera: LiveCamera, stride: u32) -> Self {
        let edges: Vec<Vec<usize>> = film.tiles.par_iter().map(|tile| edges(&film, &camera, stride, tile)).collect();
        for (tile, edges) in film.tiles.iter_mut().zip(edges) {
            for pixel in edges {
                tile.shown[pixel].alpha = Shown::NEVER;
            }
        }
        History { film, camera, stride }
    }

    /// The picture itself, for what it is still worth: its memory.
    pub fn into_film(self) -> LiveFilm {
        self.film
    }

    /// Writes what is known of a surface seen from `eye` to `layers`: sum and weight. False where nothing is.
    pub fn recall(&self, shown: &Shown, eye: Vec3, layers: &mut [Vec4]) -> bool {
        let most = MOST_WEIGHT * self.kept(shown, eye);
        if most < 1.0 {
            return false;
        }
        let Some(place) = self.camera.project(shown.position) else { return false };
        let place = (place - 0.5) / self.stride as f32;
        let (corner, part) = (place.floor(), place - place.floor());
        let scale = self.camera.depth_scale(shown.position);
        let mut found = 0.0;
        for step in [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE] {
            let across = Vec2::ONE - part + step * (2.0 * part - 1.0);
            let at = (corner + step) * self.stride as f32;
            let Some((tile, pixel)) = self.film.at(at) else { continue };
            let weight = across.x * across.y;
            let there = &tile.shown[pixel];
            let has_all = (0..layers.len()).all(|layer| tile.sum(layer, pixel).w > 0.0);
            if there.alpha < 0.0 || !has_all || !shown.agrees(there, scale) {
                continue;
            }
            found += weight;
            for (layer, value) in layers.iter_mut().enumerate() {
                let sum = tile.sum(layer, pixel);
                *value += (sum.truncate() / sum.w).extend(sum.w.min(most)) * weight;
            }
        }
        if found < ENOUGH {
            return false;
        }
        for value in layers {
            let weight = value.w / found;
            *value = (value.truncate() / found * weight).extend(weight);
        }
        true
    }

    /// Makes what is known wrong by a factor.
    #[cfg(test)]
    pub fn distort(&mut self, factor: f32) {
        for sum in self.film.tiles.iter_mut().flat_map(|tile| &mut tile.sums) {
            *sum = (sum.truncate() * factor).extend(sum.w);
        }
    }

    /// Share that is kept of a surface whose view has turned.
    fn kept(&self, shown: &Shown, eye: Vec3) -> f32 {
        if shown.alpha < 0.0 {
            return 0.0;
        }
        let turned_rad = math::angle_between(shown.position - eye, shown.position - self.camera.eye());
        // A mirror is kept only where the view is the very same.
        if turned_rad <= 0.0 { 1.0 } else { (1.0 - turned_rad / shown.alpha.max(f32::MIN_POSITIVE)).max(0.0) }
    }
}

/// Pixels of a tile whose neighbours show something else.
fn edges(film: &LiveFilm, camera: &LiveCamera, stride: u32, tile: &super::tile::LiveTile) -> Vec<usize> {
    let is_edge = |pixel: &usize| {
        let (x, y) = tile.place(*pixel);
        let (shown, step) = (&tile.shown[*pixel], stride as f32);
        let scale = camera.depth_scale(shown.position);
        [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].into_iter().any(|side| {
            let there = film.at(Vec2::new(x as f32, y as f32) + side * step);
            there.is_some_and(|(tile, pixel)| !shown.agrees(&tile.shown[pixel], scale))
        })
    };
    (0..tile.pixels()).filter(|pixel| tile.shown[*pixel].alpha >= 0.0).filter(is_edge).collect()
}
