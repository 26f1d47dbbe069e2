//! The dielectric lobe: specular reflection and refraction by clear glass and water, and by thin panes.

use super::fresnel;
use super::polarisation::{InterfaceReflection, Polarisation};
use super::sample::BsdfSample;
use super::shading_geometry::ShadingGeometry;
use super::transmission_tint::transmission_tint;
use glam::Vec3;

/// The interface between two dielectric media, as a path crosses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricInterface {
    /// Relative index of refraction: transmitted side over incident side.
    pub eta: f32,
    /// True if the path started inside this body, so that its first medium is unknown: radiance is not scaled by 1 /
    /// eta2.
    pub starts_inside: bool,
}

impl DielectricInterface {
    /// Returns the factor on radiance that passes the interface: 1 / eta2 (Veach 1997, section 5.2), or 1 where the first
    /// medium is unknown.
    pub fn radiance_scale(&self) -> f32 {
        if self.starts_inside { 1.0 } else { 1.0 / (self.eta * self.eta) }
    }
}

/// The boundary at a clear surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// The surface of a body, from outside or inside.
    Interface(DielectricInterface),
    /// Both faces of a thin pane: an open mesh has no inside.
    ThinPane,
}

/// The dielectric lobe for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct DielectricLobe {
    pub ior: f32,
    /// Colour of transmitted light; see [`transmission_tint`].
    pub base_color: Vec3,
    pub boundary: Boundary,
    /// Polarisation that the path accepts.
    pub polarisation: Polarisation,
}

impl DielectricLobe {
    /// Samples reflection (for `u` below [`DielectricLobe::reflectance`]) or transmission.
    pub fn sample(&self, geometry: &ShadingGeometry, u: f32) -> Option<BsdfSample> {
        match self.boundary {
            Boundary::ThinPane => Some(self.sample_pane(geometry, u)),
            Boundary::Interface(interface) => self.sample_interface(geometry, u, interface),
        }
    }

    /// Returns the Fresnel reflectance, which is the probability of sampling reflection.
    pub fn reflectance(&self, geometry: &ShadingGeometry) -> f32 {
        match self.boundary {
            Boundary::ThinPane => self.at_pane(geometry).reflectance,
            Boundary::Interface(interface) => {
                let wo = geometry.to_world(geometry.wo).normalize_or(geometry.normal);
                self.polarisation.at_interface(wo, geometry.normal, interface.eta).reflectance
            }
        }
    }

    fn sample_interface(
        &self,
        geometry: &ShadingGeometry,
        u: f32,
        interface: DielectricInterface,
    ) -> Option<BsdfSample> {
        let eta = interface.eta;
        // Compute the reflectance for the accepted polarisation
        let wo = geometry.to_world(geometry.wo).normalize_or(geometry.normal);
        let fresnel = self.polarisation.at_interface(wo, geometry.normal, eta);
        if u < fresnel.reflectance {
            // Sample specular reflection
            let direction = geometry.specular_reflection()?;
            return Some(BsdfSample { polarisation: fresnel.reflected, ..BsdfSample::specular(direction) });
        }
        // Sample specular transmission about the shading normal; about the geometric normal if the direction would not
        // be below the surface
        let refracted = fresnel::refract(geometry.wo, eta).map(|wi| geometry.to_world(wi).normalize_or_zero());
        let direction = refracted
            .filter(|direction| direction.dot(geometry.geometric_normal) < 0.0)
            .or_else(|| fresnel::refract_about(wo, geometry.geometric_normal, eta))?;
        let scale = interface.radiance_scale();
        Some(BsdfSample {
            weight: transmission_tint(self.base_color, false) * scale,
            eta_scale: scale,
            polarisation: fresnel.transmitted,
            is_transmission: true,
            ..BsdfSample::specular(direction)
        })
    }

    /// Returns the reflection by a thin pane, which has the geometric normal.
    fn at_pane(&self, geometry: &ShadingGeometry) -> InterfaceReflection {
        self.polarisation.at_pane(geometry.wo_world, geometry.geometric_normal, self.ior)
    }

    fn sample_pane(&self, geometry: &ShadingGeometry, u: f32) -> BsdfSample {
        let (wo, normal) = (geometry.wo_world, geometry.geometric_normal);
        let pane = self.at_pane(geometry);
        if u < pane.reflectance {
            let direction = (2.0 * wo.dot(normal) * normal - wo).normalize_or_zero();
            return BsdfSample { polarisation: pane.reflected, ..BsdfSample::specular(direction) };
        }
        let (weight, polarisation) = (transmission_tint(self.base_color, true), pane.transmitted);
        BsdfSample { weight, polarisation, is_transmission: true, is_undeviated: true, ..BsdfSample::specular(-wo) }
    }
}

/// Returns the transmittance of a clear pane in air: the geometric series over all internal reflections, (1 - R) / (1 +
/// R), averaged over both polarisations.
pub fn pane_transmittance(cos_incident: f32, ior: f32) -> f32 {
    let [s, p] = fresnel::pane_reflectances(cos_incident, ior);
    1.0 - 0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transmittance_of_a_pane_matches_the_table() {
        // light_and_camera.md, n = 1.52, to three decimals.
        for (deg, table) in [(0.0_f32, 0.918), (30.0, 0.916), (60.0, 0.844), (80.0, 0.456)] {
            let ours = pane_transmittance(deg.to_radians().cos(), 1.52);
            assert!((ours - table).abs() < 6e-4, "{deg}: {ours}");
        }
        assert_eq!(pane_transmittance(0.5, 1.0), 1.0);
    }
}
