//! The lobes of a BSDF and the probabilities with which they are sampled.

/// A lobe of a [`Bsdf`](super::Bsdf).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    /// Reflection and refraction by clear glass (`dielectric.rs`). Always a delta lobe.
    Dielectric,
    /// Reflection by metal and coat (`microfacet.rs`). A delta lobe where the surface is smooth.
    Microfacet,
    /// The diffuse base (`diffuse.rs`).
    Diffuse,
    /// Scattering under the surface, in place of the diffuse base (`subsurface.rs`). The path continues elsewhere.
    Subsurface,
}

/// The probabilities with which the lobes are sampled.
#[derive(Clone, Copy, Debug)]
pub struct LobeProbabilities {
    /// Of the dielectric lobe.
    pub dielectric: f32,
    /// Of the microfacet lobe, given that the dielectric one was not sampled.
    pub microfacet: f32,
    /// The lobe that is sampled otherwise: diffuse or subsurface.
    pub base: Lobe,
}

impl LobeProbabilities {
    /// Returns the probability of a lobe, given that the dielectric one was not sampled.
    #[inline(always)]
    pub fn opaque(&self, lobe: Lobe) -> f32 {
        match lobe {
            Lobe::Dielectric => 0.0,
            Lobe::Microfacet => self.microfacet,
            Lobe::Diffuse | Lobe::Subsurface if lobe != self.base => 0.0,
            Lobe::Diffuse | Lobe::Subsurface => 1.0 - self.microfacet,
        }
    }

    /// Samples a lobe for `u` in 0..1. Returns it with `u` remapped to 0..1 for the dielectric lobe.
    #[inline(always)]
    pub fn sample(&self, u: f32) -> (Lobe, f32) {
        if u < self.dielectric {
            return (Lobe::Dielectric, u / self.dielectric);
        }
        let u = if self.dielectric > 0.0 { (u - self.dielectric) / (1.0 - self.dielectric) } else { u };
        (if u < self.microfacet { Lobe::Microfacet } else { self.base }, u)
    }
}
