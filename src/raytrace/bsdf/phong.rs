//! The reflection model of Whitted's method: a diffuse base, a Phong lobe or specular reflection, clear glass.
//!
//! The exponent is 2 / alpha2 - 2, which matches the width of the Beckmann and GGX lobes at their centre; the colour is
//! the reflectance at normal incidence. Base and lobe do not share energy, unlike in [`super::Bsdf`].

use super::ggx;
use super::material_point::MaterialPoint;
use super::transmission_tint::transmission_tint;
use glam::Vec3;
use std::f32::consts::PI;

/// The Phong parameters at a shading point.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    /// Albedo of the diffuse base.
    pub albedo: Vec3,
    /// Reflectance of the Phong lobe; 0 for a smooth surface.
    glossy: Vec3,
    exponent: f32,
    /// Reflectance of specular reflection; 0 for a rough surface.
    pub specular: Vec3,
    /// Weight of clear glass, which reflects and refracts by Fresnel's equations.
    pub transmission: f32,
    /// Base colour, for the colour of transmitted light.
    base_color: Vec3,
}

impl MaterialPoint<'_> {
    /// Returns the Phong parameters at the point.
    pub fn phong(&self) -> Phong {
        let base = self.base_color;
        let opaque = 1.0 - self.transmission;
        let far_side = self.material.layers().map_or(0.0, |layers| layers.translucency);
        let ior = self.material.ior;
        let f0 = ((ior - 1.0) / (ior + 1.0)).powi(2);
        let reflectance = Vec3::splat(f0).lerp(base, self.metallic) * opaque;
        let (glossy, specular) = if self.is_smooth() { (Vec3::ZERO, reflectance) } else { (reflectance, Vec3::ZERO) };
        let alpha = self.alpha.max(ggx::MIN_ALPHA);
        Phong {
            albedo: base * ((1.0 - self.metallic) * opaque * (1.0 - far_side)),
            glossy,
            exponent: (2.0 / (alpha * alpha) - 2.0).max(0.0),
            specular,
            transmission: self.transmission,
            base_color: base,
        }
    }
}

impl Phong {
    /// Returns the factor on light that is transmitted, besides Fresnel's equations.
    pub fn transmission_color(&self, is_thin: bool) -> Vec3 {
        transmission_tint(self.base_color, is_thin) * self.transmission
    }

    /// Returns the BSDF for unit directions above the surface, without specular reflection and glass.
    pub fn eval(&self, light_dir: Vec3, view_dir: Vec3, normal: Vec3) -> Vec3 {
        let mirrored = 2.0 * light_dir.dot(normal) * normal - light_dir;
        let lobe = mirrored.dot(view_dir).max(0.0).powf(self.exponent) * (self.exponent + 2.0) / (2.0 * PI);
        self.albedo / PI + self.glossy * lobe
    }
}
