//! The sheen of cloth: Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF" (the "Charlie" distribution),
//! with the visibility term of Ashikhmin and Premoze 2007, "Distribution-based BRDFs". What lies below is scaled by its
//! directional albedo, as in glTF's KHR_materials_sheen.

use super::direction_table::DirectionTable;
use crate::scene::Sheen;
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Least alpha: the rim of a narrower one is within a degree of the horizon.
const MIN_ALPHA: f32 = 0.05;
/// Steps of the albedo's quadrature: cosine, and half of the azimuth.
const STEPS: [u32; 2] = [40, 24];

/// The sheen lobe of a material.
#[derive(Clone, Debug)]
pub struct SheenLobe {
    color: Vec3,
    inverse_alpha: f32,
    /// Directional albedo for the colour white, times the colour's largest channel.
    albedo: DirectionTable,
}

impl SheenLobe {
    /// Tabulates the lobe of a sheen.
    pub fn new(sheen: &Sheen) -> Self {
        let inverse_alpha = 1.0 / (sheen.roughness * sheen.roughness).max(MIN_ALPHA);
        let unit = DirectionTable::by_cosine(|wo| albedo(inverse_alpha, wo));
        // The visibility term lets narrow lobes reflect more than arrives at the horizon: scale them
        let scale = 1.0 / unit.largest().max(1.0);
        let color = Vec3::from(sheen.color) * scale;
        let largest = color.max_element();
        SheenLobe { color, inverse_alpha, albedo: DirectionTable::by_cosine(|wo| (unit.at(wo) * largest).min(1.0)) }
    }

    /// Returns the directional albedo of its strongest channel.
    pub fn albedo(&self, wo: Vec3) -> f32 {
        self.albedo.at(wo)
    }

    /// Returns the mean of that albedo, cosine-weighted, by the midpoint rule over the square of the cosine.
    pub fn mean_albedo(&self) -> f32 {
        let cosines = (0..16).map(|i| ((i as f32 + 0.5) / 16.0).sqrt());
        cosines.map(|cos| self.albedo(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos))).sum::<f32>() / 16.0
    }

    /// Returns BSDF times cosine for directions above the surface, local frame.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        self.color * value(self.inverse_alpha, wo, wi)
    }
}

/// Returns BSDF times cosine of white sheen.
fn value(inverse_alpha: f32, wo: Vec3, wi: Vec3) -> f32 {
    let m = (wo + wi).normalize_or(Vec3::Z);
    let sin = (m.x * m.x + m.y * m.y).sqrt();
    let distribution = (2.0 + inverse_alpha) * sin.powf(inverse_alpha) / TAU;
    let visibility = 1.0 / (4.0 * (wi.z + wo.z - wi.z * wo.z)).max(1e-4);
    distribution * visibility * wi.z
}

/// Returns the directional albedo of white sheen by the midpoint rule.
fn albedo(inverse_alpha: f32, wo: Vec3) -> f32 {
    let [cosines, turns] = STEPS;
    let mut sum = 0.0;
    for i in 0..cosines {
        // Denser towards the horizon, where the lobe is: cos = x2
        let x = (i as f32 + 0.5) / cosines as f32;
        let cos = x * x;
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..turns {
            let (y, x_axis) = (PI * (j as f32 + 0.5) / turns as f32).sin_cos();
            sum += 2.0 * x * value(inverse_alpha, wo, Vec3::new(sin * x_axis, sin * y, cos));
        }
    }
    sum * TAU / (cosines * turns) as f32
}
