//! Fibres: the hair of people and animals, and dyed threads.

use glam::Vec3;
use std::f32::consts::PI;

/// Absorption of eumelanin (black and brown) of concentration 1, per fibre radius, linear RGB (d'Eon et al. 2011, "An
/// Energy-Conserving Hair Reflectance Model", as given in PBRT, 4th ed., section 9.9).
const EUMELANIN: Vec3 = Vec3::new(0.419, 0.697, 1.37);
/// Absorption of pheomelanin (red and yellow) of concentration 1, per fibre radius, linear RGB (same source).
const PHEOMELANIN: Vec3 = Vec3::new(0.187, 0.4, 1.05);
/// Roughness below which lobes are too narrow for single precision.
pub(super) const MIN_ROUGHNESS: f32 = 0.05;
/// Part of a melanin amount of 1 that gives black hair the finite concentration of 8.
const MAX_MELANIN: f32 = 0.99966;

/// The colour of a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FibreColor {
    /// Natural hair.
    Melanin {
        /// Amount of pigment: 0 white, 0.25 blond, 0.7 brown, 1 black.
        melanin: f32,
        /// Part of red pigment (pheomelanin) in it: 0 brown, 1 red.
        redness: f32,
    },
    /// Colour of much such hair in white light; each channel in (0, 1).
    Dye([f32; 3]),
}

/// A fibre as strands of hair have it: a dielectric cylinder with pigment, covered by tilted scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fibre {
    /// Colour.
    pub color: FibreColor,
    /// Roughness along the fibre: the length of the highlights; 0.1 wet, 0.3 healthy, 0.6 dull hair.
    pub roughness_along: f32,
    /// Roughness around the fibre: 0.1 glass-like, 0.3 human hair, 1 wool.
    pub roughness_around: f32,
}

impl Default for Fibre {
    fn default() -> Self {
        Fibre {
            color: FibreColor::Melanin { melanin: 0.75, redness: 0.2 },
            roughness_along: 0.3,
            roughness_around: 0.3,
        }
    }
}

impl Fibre {
    /// Returns natural hair of this pigment.
    pub fn of_melanin(melanin: f32, redness: f32) -> Self {
        Fibre { color: FibreColor::Melanin { melanin, redness }, ..Fibre::default() }
    }

    /// Returns the variance of the longitudinal lobe of reflected light (Chiang et al. 2016, equation 7).
    pub fn longitudinal_variance(&self) -> f32 {
        let m = self.roughness_along.clamp(MIN_ROUGHNESS, 1.0);
        (0.726 * m + 0.812 * m * m + 3.7 * m.powi(20)).powi(2)
    }

    /// Returns the scale of the logistic azimuthal lobes, radians (Chiang et al. 2016, equation 8).
    pub fn azimuthal_scale(&self) -> f32 {
        let n = self.roughness_around.clamp(MIN_ROUGHNESS, 1.0);
        (PI / 8.0).sqrt() * (0.265 * n + 1.194 * n * n + 5.372 * n.powi(22))
    }

    /// Returns the absorption coefficient inside of the fibre, per fibre radius, linear RGB.
    pub fn absorption_per_radius(&self) -> Vec3 {
        match self.color {
            FibreColor::Melanin { melanin, redness } => {
                let concentration = -(-MAX_MELANIN * melanin.clamp(0.0, 1.0)).ln_1p();
                EUMELANIN.lerp(PHEOMELANIN, redness) * concentration
            }
            FibreColor::Dye(color) => {
                // Chiang et al. 2016, "A Practical and Controllable Hair and Fur Model for Production Path Tracing",
                // equation 9
                let b = self.roughness_around;
                let fit = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
                Vec3::from(color).map(|c| (c.clamp(1e-3, 0.999).ln() / fit).powi(2))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_melanin_absorbs_more_and_black_hair_has_the_published_concentration() {
        let absorption = |melanin, redness| Fibre::of_melanin(melanin, redness).absorption_per_radius();
        assert_eq!(absorption(0.0, 0.5), Vec3::ZERO);
        for redness in [0.0, 0.5, 1.0] {
            for step in 0..100 {
                let (less, more) =
                    (absorption(0.01 * step as f32, redness), absorption(0.01 * (step + 1) as f32, redness));
                assert!(less.cmplt(more).all(), "{step} {redness}: {less} {more}");
            }
        }
        // PBRT, 4th ed., section 9.9: a eumelanin concentration of 8 is black hair.
        assert!((absorption(1.0, 0.0) / EUMELANIN - 8.0).abs().max_element() < 0.03);
        // Red pigment passes red light best.
        let (brown, red) = (absorption(0.7, 0.0), absorption(0.7, 1.0));
        assert!(red.x / red.z < brown.x / brown.z);
    }
}
