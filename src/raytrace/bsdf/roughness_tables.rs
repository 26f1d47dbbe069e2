//! Directional albedos for every roughness, for materials whose roughness has a map.

use super::albedo::AlbedoTables;
use rayon::prelude::*;

/// Number of steps of the user's roughness from 0 to 1; in between, albedos are interpolated.
const STEPS: usize = 32;

/// The directional albedos of an index of refraction, by roughness.
#[derive(Debug)]
pub struct RoughnessTables {
    ior: f32,
    levels: Vec<AlbedoTables>,
}

impl RoughnessTables {
    /// Tabulates all levels of an index of refraction.
    pub fn new(ior: f32) -> Self {
        let level = |step: usize| {
            let roughness = step as f32 / STEPS as f32;
            AlbedoTables::new(ior, roughness * roughness)
        };
        RoughnessTables { ior, levels: (0..=STEPS).into_par_iter().map(level).collect() }
    }

    /// Returns the index of refraction.
    pub fn ior(&self) -> f32 {
        self.ior
    }

    /// Returns the levels, from smooth to rough.
    pub fn levels(&self) -> &[AlbedoTables] {
        &self.levels
    }

    /// Returns the levels below and above a roughness in 0..1, and how near to the upper one it is, 0 to 1.
    pub fn around(&self, roughness: f32) -> (&AlbedoTables, &AlbedoTables, f32) {
        let position = roughness.clamp(0.0, 1.0) * STEPS as f32;
        let below = (position as usize).min(STEPS - 1);
        (&self.levels[below], &self.levels[below + 1], position - below as f32)
    }

    /// Returns the largest mean albedo of the coat.
    pub fn largest_coat_mean(&self) -> f32 {
        self.levels.iter().map(|level| level.coat.mean).fold(0.0, f32::max)
    }
}
