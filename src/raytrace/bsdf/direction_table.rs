//! Directional albedos by direction, tabulated once a material and interpolated linearly.

use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

/// Entries by cosine.
const COSINES: usize = 48;
/// Entries by azimuth of a table that depends on it.
const AZIMUTHS: usize = 9;

/// An albedo by the cosine of the outgoing direction, and by its azimuth where the surface is brushed: the same in all
/// four quadrants.
#[derive(Clone, Debug)]
pub struct DirectionTable {
    /// By azimuth, then by the square root of the cosine.
    rows: Vec<[f32; COSINES]>,
}

impl DirectionTable {
    /// Tabulates an albedo that is the same for all azimuths.
    pub fn by_cosine(albedo: impl Fn(Vec3) -> f32) -> Self {
        DirectionTable { rows: vec![row(0.0, &albedo)] }
    }

    /// Tabulates an albedo that depends on the azimuth.
    pub fn by_direction(albedo: impl Fn(Vec3) -> f32) -> Self {
        let azimuth = |i: usize| FRAC_PI_2 * i as f32 / (AZIMUTHS - 1) as f32;
        DirectionTable { rows: (0..AZIMUTHS).map(|i| row(azimuth(i), &albedo)).collect() }
    }

    /// Returns the albedo for a unit direction.
    pub fn at(&self, w: Vec3) -> f32 {
        let x = w.z.abs().clamp(0.0, 1.0).sqrt() * (COSINES - 1) as f32;
        let i = (x as usize).min(COSINES - 2);
        let along = |row: &[f32; COSINES]| row[i] + (row[i + 1] - row[i]) * (x - i as f32);
        let last = self.rows.len() - 1;
        if last == 0 {
            return along(&self.rows[0]);
        }
        let y = w.y.abs().atan2(w.x.abs()) / FRAC_PI_2 * last as f32;
        let k = (y as usize).min(last - 1);
        let (low, high) = (along(&self.rows[k]), along(&self.rows[k + 1]));
        low + (high - low) * (y - k as f32)
    }

    /// Returns the largest entry.
    pub fn largest(&self) -> f32 {
        self.rows.iter().flatten().copied().fold(0.0, f32::max)
    }
}

/// Returns the entries of an azimuth.
fn row(azimuth: f32, albedo: &impl Fn(Vec3) -> f32) -> [f32; COSINES] {
    std::array::from_fn(|i| {
        let root = i as f32 / (COSINES - 1) as f32;
        let cos = (root * root).max(1e-5);
        let sin = (1.0 - cos * cos).sqrt();
        albedo(Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos))
    })
}
