//! What a surface has besides its base: a clear coat, the sheen of cloth, brushing.

use glam::Vec3;

/// A layer of clear lacquer over a surface, of index 1.5: car paint, varnish, nail polish.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearcoat {
    /// Part of the surface that has the layer, 0 to 1.
    pub amount: f32,
    /// Roughness of the layer, as [`super::Material::roughness`].
    pub roughness: f32,
}

impl Clearcoat {
    /// Index of refraction of the layer, that of glTF's KHR_materials_clearcoat.
    pub const IOR: f32 = 1.5;
    /// Smooth lacquer all over.
    pub const POLISHED: Self = Clearcoat { amount: 1.0, roughness: 0.05 };
}

/// Light that fibres standing up from cloth scatter at grazing angles: velvet, felt, peach skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen {
    /// Colour of that light.
    pub color: [f32; 3],
    /// 0 is a narrow rim, 1 all of the surface.
    pub roughness: f32,
}

/// Roughness that depends on the direction along the surface: brushed and turned metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anisotropy {
    /// 0 is the same in all directions; at 1, the highlight is as wide across the grooves as it can be. GGX alpha across
    /// them is `alpha + (1 - alpha) strength^2`, along them it stays `alpha` (glTF, KHR_materials_anisotropy).
    pub strength: f32,
    /// Direction across the grooves, degrees from the texture's U axis towards V, seen from outside.
    pub rotation_deg: f32,
}

impl Anisotropy {
    /// Returns the GGX alphas across and along the grooves for the alpha of the surface.
    pub fn alphas(self, alpha: f32) -> [f32; 2] {
        [alpha + (1.0 - alpha) * self.strength * self.strength, alpha]
    }
}

/// Returns the reflectance at normal incidence of a metal by its complex index of refraction n + i k, in air (Fresnel's
/// equations; Born and Wolf, *Principles of Optics*, section 14.2).
pub fn metal_reflectance([n, k]: [f32; 2]) -> f32 {
    ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k)
}

/// Returns the colour of a metal by its complex indices at the dominant wavelengths of the Rec.709 primaries: 611, 549
/// and 464 nm.
pub fn metal_color(indices: [[f32; 2]; 3]) -> [f32; 3] {
    Vec3::from(indices.map(metal_reflectance)).min(Vec3::splat(0.99)).into()
}
