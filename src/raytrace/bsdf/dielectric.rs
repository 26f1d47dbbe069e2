//! Clear, smooth glass and water: bodies that refract, and sheets without thickness that stand for thin panes.

use super::{Bsdf, BsdfSample, fresnel};
use glam::Vec3;

/// The interface between two dielectric media, as a path crosses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricInterface {
    /// Relative index of refraction: transmitted side over incident side.
    pub eta: f32,
    /// The path started inside this body, so that its first medium is unknown: radiance is not scaled by eta squared.
    pub starts_inside: bool,
}

/// The boundary at a clear surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// The inside of a body, or the outside, seen from within.
    Interface(DielectricInterface),
    /// The other face of a thin pane: an open mesh has no inside.
    ThinPane,
}

impl Bsdf<'_> {
    /// Reflection or transmission at a clear surface, by chance `choice`.
    pub(super) fn sample_glass(&self, choice: f32) -> Option<BsdfSample> {
        match self.boundary {
            Boundary::ThinPane => self.sample_pane(choice),
            Boundary::Interface(interface) => self.sample_interface(choice, interface),
        }
    }

    /// Share that clear glass reflects towards the viewer, by which [`Bsdf::sample`] chooses: numbers below it reflect. None
    /// for what is more than glass.
    pub fn dielectric_reflectance(&self) -> Option<f32> {
        (self.material.transmission >= 1.0).then(|| match self.boundary {
            Boundary::ThinPane => 1.0 - pane_transmittance(self.wo_world.dot(self.geometric_normal), self.material.ior),
            Boundary::Interface(interface) => {
                let wo = self.to_world(self.wo).normalize_or(self.normal);
                self.polarisation.at_interface(wo, self.normal, interface.eta).reflectance
            }
        })
    }

    fn sample_interface(&self, choice: f32, interface: DielectricInterface) -> Option<BsdfSample> {
        let eta = interface.eta;
        let wo = self.to_world(self.wo).normalize_or(self.normal);
        let interface_reflection = self.polarisation.at_interface(wo, self.normal, eta);
        if choice < interface_reflection.reflectance {
            let mirrored = self.mirrored(Vec3::ONE)?;
            return Some(BsdfSample { polarisation: interface_reflection.reflected, ..mirrored });
        }
        let refracted = fresnel::refract(self.wo, eta).map(|wi| self.to_world(wi).normalize_or_zero());
        // The direction must leave on the side that the triangle agrees with; where an interpolated normal says
        // otherwise, the triangle's own decides.
        let direction = refracted
            .filter(|direction| direction.dot(self.geometric_normal) < 0.0)
            .or_else(|| fresnel::refract_about(wo, self.geometric_normal, eta))?;
        let scale = if interface.starts_inside { 1.0 } else { 1.0 / (eta * eta) };
        Some(BsdfSample {
            weight: Vec3::splat(scale),
            eta_scale: scale,
            polarisation: interface_reflection.transmitted,
            is_transmission: true,
            ..BsdfSample::specular(direction)
        })
    }

    fn sample_pane(&self, choice: f32) -> Option<BsdfSample> {
        let wo = self.wo_world;
        let passing = pane_transmittance(wo.dot(self.geometric_normal), self.material.ior);
        if choice < 1.0 - passing {
            let direction = 2.0 * wo.dot(self.geometric_normal) * self.geometric_normal - wo;
            return Some(BsdfSample::specular(direction.normalize_or_zero()));
        }
        Some(BsdfSample { is_transmission: true, is_undeviated: true, ..BsdfSample::specular(-wo) })
    }
}

/// Transmittance of a clear pane in air with all inner reflections, the mean of both polarisations: (1 - R) / (1 + R)
/// for each.
pub fn pane_transmittance(cos_incident: f32, ior: f32) -> f32 {
    let (s, p) = fresnel::amplitudes(cos_incident.abs(), ior);
    0.5 * ((1.0 - s * s) / (1.0 + s * s) + (1.0 - p * p) / (1.0 + p * p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pane_transmits_what_the_table_says() {
        // light_and_camera.md, n = 1.52, to three decimals.
        for (deg, table) in [(0.0_f32, 0.918), (30.0, 0.916), (60.0, 0.844), (80.0, 0.456)] {
            let ours = pane_transmittance(deg.to_radians().cos(), 1.52);
            assert!((ours - table).abs() < 6e-4, "{deg}: {ours}");
        }
        assert_eq!(pane_transmittance(0.5, 1.0), 1.0);
    }
}
