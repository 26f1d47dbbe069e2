//! Surfaces as Whitted's method sees them: a diffuse body, a Phong lobe or a mirror, clear glass.
//!
//! The lobe's exponent comes from the roughness by 2 / alpha^2 - 2 (the width of Beckmann's and GGX's middle), its colour
//! is the reflectance at normal incidence. Body and lobe do not share their energy: that is what the method leaves out.

use super::{TracedMaterial, ggx};
use glam::Vec3;
use std::f32::consts::PI;

/// A surface at a point.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    /// Reflectance of the body.
    pub albedo: Vec3,
    /// Colour of the lobe; zero for a mirror.
    gloss: Vec3,
    exponent: f32,
    /// Share that a mirrored ray brings.
    pub mirror: Vec3,
    /// Share that goes into clear glass, or is reflected there by Fresnel's law.
    pub clear: f32,
}

impl TracedMaterial {
    /// What is left of the material, with a texture value.
    pub fn phong(&self, texture: Vec3) -> Phong {
        let base = self.base_color * texture;
        let opaque = 1.0 - self.transmission;
        let f0 = ((self.ior - 1.0) / (self.ior + 1.0)).powi(2);
        let specular = Vec3::splat(f0).lerp(base, self.metallic) * opaque;
        let (gloss, mirror) = if self.is_smooth() { (Vec3::ZERO, specular) } else { (specular, Vec3::ZERO) };
        let alpha = self.alpha.max(ggx::MIRROR_ALPHA);
        Phong {
            albedo: base * ((1.0 - self.metallic) * opaque),
            gloss,
            exponent: (2.0 / (alpha * alpha) - 2.0).max(0.0),
            mirror,
            clear: self.transmission,
        }
    }
}

impl Phong {
    /// BSDF for light from `light_dir` seen from `view_dir`, both unit and above the surface.
    pub fn eval(&self, light_dir: Vec3, view_dir: Vec3, normal: Vec3) -> Vec3 {
        let mirrored = 2.0 * light_dir.dot(normal) * normal - light_dir;
        let lobe = mirrored.dot(view_dir).max(0.0).powf(self.exponent) * (self.exponent + 2.0) / (2.0 * PI);
        self.albedo / PI + self.gloss * lobe
    }
}
