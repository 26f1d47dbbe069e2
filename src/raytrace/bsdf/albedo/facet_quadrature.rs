//! The directional albedo of a rough reflector, by quadrature in double precision.
//!
//! The albedo is the integral of F(o.m) G2(o, i) D(m) (o.m) / (o.n) over facet normals m whose reflected direction i is
//! above the horizon (Walter et al. 2007, equation 20, with the Jacobian of equation 14). In polar coordinates about the
//! normal, with tan(theta_m) = alpha tan(chi), D is constant in sin2(chi), and what is left is
//!
//! ```text
//! E(o) = 1/pi  int_0^pi dphi  int_0^chi_max(phi) dchi  2 sin(chi) (cos(chi) + alpha tan(theta_o) sin(chi) cos(phi)) F G2
//! ```
//!
//! At `chi_max` the reflected direction is at the horizon. The integrand is smooth between these limits, with layers of
//! width `cos(theta_o)` where the azimuth passes a quarter turn and where `chi` begins and ends.

use crate::math::gauss_legendre;
use std::f64::consts::FRAC_PI_2;

/// Nodes of each of the two halves of the azimuth.
const AZIMUTH_NODES: usize = 12;
/// Nodes of the polar angle.
const POLAR_NODES: usize = 20;
/// Least cosine of the outgoing direction; the albedo has a limit at 0.
const MIN_COS: f64 = 1e-6;

/// A quadrature over the facets of a GGX surface, weighted as they reflect light; within 4e-5 for alpha of at least
/// 1e-3.
#[derive(Debug)]
pub struct FacetQuadrature {
    alpha: f64,
    /// Cosine of the azimuth, and weight; the weights sum to 1.
    azimuths: Vec<(f64, f64)>,
    /// Nodes in 0..1, clustered towards both ends, and weights.
    polar: [(f64, f64); POLAR_NODES],
}

impl FacetQuadrature {
    /// Returns the quadrature for a GGX alpha.
    pub fn new(alpha: f32) -> Self {
        let halves = [0.0, FRAC_PI_2];
        let nodes = gauss_legendre::<AZIMUTH_NODES>();
        let azimuths =
            halves.iter().flat_map(|start| nodes.map(|(x, weight)| ((start + FRAC_PI_2 * x).cos(), 0.5 * weight)));
        // Cluster by the cubic 3 x2 - 2 x3
        let polar = gauss_legendre().map(|(x, weight)| (x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x) * weight));
        FacetQuadrature { alpha: alpha.into(), azimuths: azimuths.collect(), polar }
    }

    /// Calls `facet` with the cosine between facet normal and outgoing direction, and a weight. The sum of weight times
    /// reflectance is the directional albedo for an outgoing direction of this cosine.
    pub fn for_each_facet(&self, cos: f64, mut facet: impl FnMut(f64, f64)) {
        let (alpha, cos) = (self.alpha, cos.clamp(MIN_COS, 1.0));
        let sin = (1.0 - cos * cos).sqrt();
        let alpha_tan = alpha * sin / cos;
        let lambda = 0.5 * ((1.0 + alpha_tan * alpha_tan).sqrt() - 1.0);
        for &(cos_azimuth, azimuth_weight) in &self.azimuths {
            // Compute the polar angle of the facet that reflects to the horizon: i.n = R cos(2 theta - delta)
            let max_theta = 0.5 * ((sin * cos_azimuth).atan2(cos) + FRAC_PI_2);
            let max_chi = max_theta.sin().atan2(alpha * max_theta.cos());
            let max_tan_half = (0.5 * max_chi).tan();
            for &(x, polar_weight) in &self.polar {
                // Compute sine and cosine of chi from the tangent of its half
                let tan_half = max_tan_half * x;
                let inverse = 1.0 / (1.0 + tan_half * tan_half);
                let (sin_chi, cos_chi) = (2.0 * tan_half * inverse, (1.0 - tan_half * tan_half) * inverse);

                // Compute the facet normal and the reflected direction
                let length = (cos_chi * cos_chi + alpha * alpha * sin_chi * sin_chi).sqrt();
                let cos_half = (sin * alpha * sin_chi * cos_azimuth + cos * cos_chi) / length;
                let reflected_cos = (2.0 * cos_half * cos_chi / length - cos).max(0.0);

                // Compute masking-shadowing: Smith's Lambda of the reflected direction is (root / cos - 1) / 2
                let root = (reflected_cos * reflected_cos * (1.0 - alpha * alpha) + alpha * alpha).sqrt();
                let masking_shadowing = reflected_cos / (reflected_cos * (0.5 + lambda) + 0.5 * root);
                let density = 2.0 * sin_chi * (cos_chi + alpha_tan * sin_chi * cos_azimuth);
                let step = 2.0 * max_tan_half * inverse * polar_weight;
                facet(cos_half, azimuth_weight * step * density * masking_shadowing);
            }
        }
    }
}
