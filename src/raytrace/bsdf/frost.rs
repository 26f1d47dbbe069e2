//! Frosted glass: reflection and refraction by GGX facets (Walter et al. 2007, "Microfacet Models for Refraction through
//! Rough Surfaces"). Light that is scattered between facets is put back by dividing by the directional albedo of single
//! scattering, as for metals (Turquin 2019): frosted glass that absorbs nothing reflects and transmits all light.
//!
//! A thin frosted pane scatters what passes it by the mirrored lobe of its reflection (glTF, KHR_materials_transmission).

use super::albedo::AlbedoTables;
use super::dielectric::{Boundary, DielectricInterface, DielectricLobe};
use super::direction_table::DirectionTable;
use super::facets::Facets;
use super::transmission_tint::transmission_tint;
use super::{fresnel, ggx};
use glam::{Vec2, Vec3};

/// Least difference of the indices of both sides: without any, there is no refraction.
const MIN_CONTRAST: f32 = 1e-3;

/// The faces of frosted glass.
#[derive(Clone, Debug)]
pub struct Frost {
    facets: Facets,
    /// Relative index of refraction from outside.
    eta: f32,
    /// Albedos of single scattering: from outside, and from inside.
    albedos: [DirectionTable; 2],
    /// As for a pane.
    pane_albedo: DirectionTable,
}

impl Frost {
    /// Tabulates the faces of an index of refraction and a roughness.
    pub fn new(ior: f32, roughness: f32) -> Self {
        let alpha = (roughness * roughness).max(ggx::MIN_ALPHA);
        let (facets, eta) = (Facets::new([alpha; 2]), with_contrast(ior));
        let table = |eta: f32| DirectionTable::by_cosine(|wo| single_scattering(&facets, wo, eta));
        let pane = AlbedoTables::new(ior, alpha).perfect_reflector;
        Frost {
            facets,
            eta,
            albedos: [table(eta), table(1.0 / eta)],
            pane_albedo: DirectionTable::by_cosine(|wo| pane.at(wo.z)),
        }
    }

    /// Returns the factor for scattering between facets; 1 between media for which there is no table.
    fn compensation(&self, boundary: Boundary, wo: Vec3) -> f32 {
        let table = match boundary {
            Boundary::ThinPane => Some(&self.pane_albedo),
            Boundary::Interface(DielectricInterface { eta, .. }) => {
                let is_near = |known: f32| (eta / known - 1.0).abs() < 1e-3;
                let known = [is_near(self.eta), is_near(1.0 / self.eta)].iter().position(|near| *near);
                known.map(|index| &self.albedos[index])
            }
        };
        table.map_or(1.0, |table| 1.0 / table.at(wo).max(0.05))
    }

    /// Samples a direction, local frame: reflection for `u_lobe` below the reflectance of a facet.
    pub fn sample(&self, lobe: &DielectricLobe, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<Vec3> {
        let m = self.facets.sample_visible_normal(wo, u);
        let reflected = ggx::reflect(wo, m);
        match lobe.boundary {
            Boundary::ThinPane => {
                let is_reflected = u_lobe < pane_reflectance(lobe.ior, wo.dot(m));
                let wi = if is_reflected { reflected } else { reflected * Vec3::new(1.0, 1.0, -1.0) };
                (reflected.z > 0.0).then_some(wi)
            }
            Boundary::Interface(DielectricInterface { eta, .. }) => {
                let eta = with_contrast(eta);
                if u_lobe < fresnel::dielectric(wo.dot(m), eta) {
                    return Some(reflected).filter(|wi| wi.z > 0.0);
                }
                fresnel::refract_about(wo, m, eta).filter(|wi| wi.z < 0.0)
            }
        }
    }

    /// Returns BSDF times cosine, and the density of [`Frost::sample`], for a direction on either side, local frame.
    pub fn eval(&self, lobe: &DielectricLobe, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let scale = self.compensation(lobe.boundary, wo);
        let (value, pdf) = match lobe.boundary {
            Boundary::ThinPane => self.eval_pane(lobe, wo, wi),
            Boundary::Interface(interface) if wi.z > 0.0 => {
                self.eval_reflection(wo, wi, |cos| fresnel::dielectric(cos, with_contrast(interface.eta)))
            }
            Boundary::Interface(interface) => self.eval_refraction(lobe, interface, wo, wi),
        };
        (value * scale, pdf)
    }

    fn eval_reflection(&self, wo: Vec3, wi: Vec3, reflectance: impl Fn(f32) -> f32) -> (Vec3, f32) {
        let m = (wo + wi).normalize_or(Vec3::Z);
        let (value, pdf) = self.facets.eval_reflection(wo, wi, m, reflectance(wo.dot(m).clamp(0.0, 1.0)));
        (Vec3::splat(value), pdf)
    }

    fn eval_pane(&self, lobe: &DielectricLobe, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let mirrored = Vec3::new(wi.x, wi.y, wi.z.abs());
        if wi.z > 0.0 {
            return self.eval_reflection(wo, mirrored, |cos| pane_reflectance(lobe.ior, cos));
        }
        let (value, pdf) = self.eval_reflection(wo, mirrored, |cos| 1.0 - pane_reflectance(lobe.ior, cos));
        (value * transmission_tint(lobe.base_color, true), pdf)
    }

    /// Walter et al. 2007, equations 16, 17 and 21, with the scale of radiance by 1 / eta2.
    fn eval_refraction(
        &self,
        lobe: &DielectricLobe,
        interface: DielectricInterface,
        wo: Vec3,
        wi: Vec3,
    ) -> (Vec3, f32) {
        let eta = with_contrast(interface.eta);
        // The facet that refracts the one direction into the other
        let sum = wo + wi * eta;
        let m = (sum * sum.z.signum()).normalize_or(Vec3::Z);
        let (cos_o, cos_i) = (wo.dot(m), wi.dot(m));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let denominator = cos_o + eta * cos_i;
        let jacobian = eta * eta * -cos_i / (denominator * denominator).max(f32::MIN_POSITIVE);
        let transmittance = 1.0 - fresnel::dielectric(cos_o, eta);
        let (lambda_o, lambda_i) = (self.facets.lambda(wo), self.facets.lambda(wi));
        let pdf = transmittance * self.facets.distribution(m) * cos_o / wo.z * jacobian / (1.0 + lambda_o);
        let tint = transmission_tint(lobe.base_color, false) * radiance_scale(interface);
        (tint * (pdf / (1.0 + lambda_i)), pdf)
    }
}

/// Returns the factor on radiance that passes a frosted interface.
pub fn radiance_scale(interface: DielectricInterface) -> f32 {
    DielectricInterface { eta: with_contrast(interface.eta), ..interface }.radiance_scale()
}

/// Returns a relative index of refraction that differs from 1.
fn with_contrast(eta: f32) -> f32 {
    if (eta - 1.0).abs() < MIN_CONTRAST { 1.0 + MIN_CONTRAST } else { eta }
}

fn pane_reflectance(ior: f32, cos: f32) -> f32 {
    let [s, p] = fresnel::pane_reflectances(cos, ior);
    0.5 * (s + p)
}

/// Returns the part of the light that single scattering reflects and transmits.
fn single_scattering(facets: &Facets, wo: Vec3, eta: f32) -> f32 {
    let lambda_o = facets.lambda(wo);
    facets.mean_visible(wo, |m| {
        let reflectance = fresnel::dielectric(wo.dot(m), eta);
        let reflected = ggx::reflect(wo, m);
        let mut sum = 0.0;
        if reflected.z > 0.0 {
            sum += reflectance * (1.0 + lambda_o) / (1.0 + lambda_o + facets.lambda(reflected));
        }
        if let Some(refracted) = fresnel::refract_about(wo, m, eta).filter(|wi| wi.z < 0.0) {
            sum += (1.0 - reflectance) / (1.0 + facets.lambda(refracted));
        }
        sum
    })
}
