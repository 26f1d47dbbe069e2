//! Directional albedo of the microfacet lobes, tabulated once a material. Coat and diffuse base share the energy by it.

mod facet_quadrature;

use super::{fresnel, ggx};
use crate::math::simd::LANES;
use facet_quadrature::FacetQuadrature;
use std::f64::consts::PI;

/// Number of table entries, which are interpolated linearly.
const ENTRIES: usize = 384;
/// Number of cosines for which the albedo is integrated: Chebyshev nodes, between which it is interpolated by a
/// polynomial.
const NODES: usize = 40;

/// The directional albedo of a lobe by cosine, and its cosine-weighted mean; within 1e-4.
#[derive(Clone, Debug)]
pub struct AlbedoTable {
    entries: [f32; ENTRIES],
    spacing: Spacing,
    /// Mean albedo: the integral of 2 E(mu) mu dmu.
    pub mean: f32,
}

/// The cosines of the entries: uniform in `x = r (1 + b) / (r + b)`, with the square root r of the cosine. They are
/// densest at grazing angles, where the albedo changes over a range of cosines as large as alpha.
#[derive(Clone, Copy, Debug)]
struct Spacing {
    b: f32,
}

/// The tables of a material.
#[derive(Clone, Debug)]
pub struct AlbedoTables {
    /// Of the dielectric coat.
    pub coat: AlbedoTable,
    /// Of a reflector of reflectance 1, with single scattering.
    pub perfect_reflector: AlbedoTable,
}

impl AlbedoTables {
    /// Tabulates the lobes of an index of refraction and a GGX alpha.
    pub fn new(ior: f32, alpha: f32) -> Self {
        let spacing = Spacing { b: (2.0 * alpha.sqrt()).max(0.15) };
        let reflectance = |cos: f64| f64::from(fresnel::dielectric(cos as f32, ior));
        if alpha < ggx::MIN_ALPHA {
            return AlbedoTables {
                coat: AlbedoTable::new(spacing, |x| reflectance(spacing.cos(x))),
                perfect_reflector: AlbedoTable::new(spacing, |_| 1.0),
            };
        }
        let quadrature = FacetQuadrature::new(alpha);
        let nodes = chebyshev_nodes();
        let (mut coat, mut perfect_reflector) = ([0.0; NODES], [0.0; NODES]);
        for (i, &node) in nodes.iter().enumerate() {
            quadrature.for_each_facet(spacing.cos(node), |cos_half, weight| {
                coat[i] += weight * reflectance(cos_half);
                perfect_reflector[i] += weight;
            });
        }
        AlbedoTables {
            coat: AlbedoTable::new(spacing, |x| interpolate(&nodes, &coat, x)),
            perfect_reflector: AlbedoTable::new(spacing, |x| interpolate(&nodes, &perfect_reflector, x)),
        }
    }
}

impl AlbedoTable {
    /// Tabulates an albedo that is known by its coordinate in 0..1.
    fn new(spacing: Spacing, albedo: impl Fn(f64) -> f64) -> Self {
        let entry = |i: usize| albedo(i as f64 / (ENTRIES - 1) as f64).min(1.0) as f32;
        let mut table = AlbedoTable { entries: std::array::from_fn(entry), spacing, mean: 0.0 };
        // Integrate the mean by the midpoint rule over the square root of the cosine: 2 mu dmu = 4 r3 dr
        let steps = 2048;
        let roots = (0..steps).map(|i| (f64::from(i) + 0.5) / f64::from(steps));
        let sum: f64 = roots.map(|r| 4.0 * r.powi(3) * f64::from(table.at((r * r) as f32))).sum();
        table.mean = (sum / f64::from(steps)) as f32;
        table
    }

    /// Returns the albedo for a cosine.
    #[inline]
    pub fn at(&self, cos: f32) -> f32 {
        let (below, fraction) = self.entry_below(cos);
        self.between_entries(below, fraction)
    }

    /// Returns the albedo for a cosine a lane.
    #[inline(always)]
    pub fn at_lanes(&self, cosines: &[f32; LANES]) -> [f32; LANES] {
        // Find the entries of all lanes before the first look-up, in loops that vectorize
        let (mut below, mut fractions) = ([0; LANES], [0.0; LANES]);
        for (i, cos) in cosines.iter().enumerate() {
            (below[i], fractions[i]) = self.entry_below(*cos);
        }
        std::array::from_fn(|i| self.between_entries(below[i], fractions[i]))
    }

    /// Returns the last entry before a cosine, and how near to the next it is, 0 to 1.
    #[inline(always)]
    fn entry_below(&self, cos: f32) -> (i32, f32) {
        let x = self.spacing.coordinate(cos) * (ENTRIES - 1) as f32;
        let i = (x as i32).min(ENTRIES as i32 - 2);
        (i, x - i as f32)
    }

    /// Returns the albedo between two entries.
    #[inline(always)]
    fn between_entries(&self, i: i32, fraction: f32) -> f32 {
        let i = i as usize;
        self.entries[i] + (self.entries[i + 1] - self.entries[i]) * fraction
    }
}

impl Spacing {
    /// Returns the coordinate of a cosine, both in 0..1.
    #[inline(always)]
    fn coordinate(self, cos: f32) -> f32 {
        let root = cos.clamp(0.0, 1.0).sqrt();
        root * (1.0 + self.b) / (root + self.b)
    }

    /// Returns the cosine at a coordinate.
    fn cos(self, coordinate: f64) -> f64 {
        let b = f64::from(self.b);
        (b * coordinate / (1.0 + b - coordinate)).powi(2)
    }
}

/// Returns the Chebyshev nodes in 0..1, with both ends.
fn chebyshev_nodes() -> [f64; NODES] {
    std::array::from_fn(|i| 0.5 - 0.5 * (PI * i as f64 / (NODES - 1) as f64).cos())
}

/// Interpolates values at the Chebyshev nodes (Berrut and Trefethen 2004, "Barycentric Lagrange Interpolation", equation
/// 5.4).
fn interpolate(nodes: &[f64; NODES], values: &[f64; NODES], x: f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, (node, value)) in nodes.iter().zip(values).enumerate() {
        if x == *node {
            return *value;
        }
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        let weight = if i == 0 || i == NODES - 1 { 0.5 * sign } else { sign } / (x - node);
        sum += weight * value;
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests;
