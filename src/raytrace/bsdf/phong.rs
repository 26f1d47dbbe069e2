//! The reflection model of Whitted's method: a diffuse base, a Phong lobe or specular reflection, clear glass.
//!
//! The exponent is 0.5 / alpha2 - 0.5, a quarter of that of Blinn-Phong, as the angle to the mirror direction is twice
//! that of the half vector: the lobe has the width of Beckmann's at its centre. The colour is the reflectance at normal
//! incidence. Base and lobe do not share energy, unlike in [`super::Bsdf`].

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
            exponent: (0.5 / (alpha * alpha) - 0.5).max(0.0),
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

#[cfg(test)]
mod tests {
    use super::super::{TextureFactors, TracedMaterial};
    use super::*;
    use crate::scene::Material;

    #[test]
    fn the_highlight_has_the_width_and_the_height_of_beckmanns_at_its_centre_and_no_more_energy() {
        let metal = Material { metallic: 1.0, base_color: [1.0; 3], roughness: 0.4, ..Material::default() };
        let alpha = 0.4_f32 * 0.4;
        let traced = TracedMaterial::new(&metal);
        let phong = MaterialPoint::new(&traced, TextureFactors::ONE).phong();
        let lobe = |angle: f32| phong.eval(Vec3::new(angle.sin(), 0.0, angle.cos()), Vec3::Z, Vec3::Z).x;
        // Beckmann's distribution over four, head-on; its half vector has half of the angle
        let beckmann = |angle: f32| (-((0.5 * angle).tan() / alpha).powi(2)).exp() / (4.0 * PI * alpha * alpha);
        for angle in [0.0, 0.05, 0.1, 0.2] {
            let (ours, right) = (lobe(angle), beckmann(angle));
            assert!((ours / right - 1.0).abs() < 0.1, "{ours} for {right} at {angle}");
        }
        // The directional albedo head-on: the integral over the hemisphere of lobe times cosine
        let steps = 2000;
        let width = 0.5 * PI / steps as f32;
        let ring = |i: i32| {
            let angle = (i as f32 + 0.5) * width;
            lobe(angle) * angle.cos() * angle.sin() * 2.0 * PI * width
        };
        let albedo: f32 = (0..steps).map(ring).sum();
        assert!((albedo - 1.0).abs() < 1e-3, "{albedo}");
    }
}
