//! Materials: diffuse, metal, dielectric, glass and emissive surfaces in one model.

use super::{Anisotropy, Clearcoat, Fibre, MaterialTextures, Sheen};
use crate::math::Dome;

/// Surface properties. Colours are scene-linear RGB with Rec.709 primaries.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Diffuse albedo, or the mirror colour of a metal; each channel in [0, 1). Of a transmitting surface, the colour of
    /// what passes a thin pane, or both faces of a body; 1 for clear glass.
    pub base_color: [f32; 3],
    /// Textures, by the property that they vary.
    pub textures: MaterialTextures,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// 0 mirror, 1 matte; GGX alpha is its square.
    pub roughness: f32,
    /// Index of refraction of the dielectric.
    pub ior: f32,
    /// 0 opaque, 1 clear glass or water.
    pub transmission: f32,
    /// Absorption inside a transmitting object, per metre (Beer-Lambert).
    pub absorption_per_m: [f32; 3],
    /// Scattering under the surface of an opaque body; none for a hard surface.
    pub subsurface: Option<Subsurface>,
    /// Luminance that the surface gives off as it glows, cd/m2, times its RGB.
    pub emission_cd_m2: [f32; 3],
    /// Strands of this material are such fibres; they ignore the properties of surfaces above, emission excepted.
    pub fibre: Option<Fibre>,
    /// Parts of the surface that are not there.
    pub alpha: Alpha,
    /// A layer of lacquer over what is opaque of the surface.
    pub clearcoat: Option<Clearcoat>,
    /// Light of standing fibres, under the lacquer.
    pub sheen: Option<Sheen>,
    /// Brushing of metal and coat.
    pub anisotropy: Option<Anisotropy>,
    /// Roughness of the faces of a transmitting surface: 0 is clear, 0.3 frosted glass.
    pub frosting: f32,
    /// Part of the diffuse light that leaves an opaque sheet on its far side: 0 for a wall, about a half for tracing
    /// paper and scrims. The base colour is the albedo of both sides together.
    pub translucency: f32,
}

/// The parts of a surface that are not there, by the alpha of its base colour's texture. Light passes them straight and
/// unchanged: leaves and lace, not glass.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Alpha {
    /// All of the surface is there.
    #[default]
    Opaque,
    /// The surface is there where the texture's alpha is at least `cutoff`.
    Mask {
        /// Least alpha that is there.
        cutoff: f32,
    },
    /// The surface covers a part of each point: the texture's alpha times `opacity`.
    Blend {
        /// Factor of the texture's alpha.
        opacity: f32,
    },
}

impl Alpha {
    /// Returns the part of a point that is there, 0 to 1, for the texture's alpha.
    pub fn coverage(self, texture_alpha: f32) -> f32 {
        match self {
            Alpha::Opaque => 1.0,
            Alpha::Mask { cutoff } => f32::from(u8::from(texture_alpha >= cutoff)),
            Alpha::Blend { opacity } => (texture_alpha * opacity).clamp(0.0, 1.0),
        }
    }
}

/// Scattering of light under the surface of skin, wax or marble. The base colour stays the albedo of a thick body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsurface {
    /// Mean distance between two scattering events, millimetres: red, green, blue. Scattering is isotropic.
    pub mean_free_path_mm: [f32; 3],
}

impl Subsurface {
    /// Light skin. The reduced scattering coefficients of skin are 0.74, 0.88 and 1.01 per mm (Jensen et al. 2001, "A
    /// Practical Model for Subsurface Light Transport", figure 5, "skin1"); the mean free path is the single-scattering
    /// albedo that gives the preset's colour over them.
    pub const SKIN: Self = Subsurface { mean_free_path_mm: [1.29, 0.99, 0.79] };
    /// Medium skin, from the same coefficients: more is absorbed, so that light goes less far.
    pub const MEDIUM_SKIN: Self = Subsurface { mean_free_path_mm: [1.17, 0.78, 0.55] };
    /// Dark skin, from the same coefficients. Its pigment is taken to be spread evenly; in truth it lies near the
    /// surface, and red light goes further below it.
    pub const DARK_SKIN: Self = Subsurface { mean_free_path_mm: [0.69, 0.36, 0.21] };
}

impl Default for Material {
    fn default() -> Self {
        Material {
            base_color: [0.5; 3],
            textures: MaterialTextures::default(),
            metallic: 0.0,
            roughness: 0.6,
            ior: 1.5,
            transmission: 0.0,
            absorption_per_m: [0.0; 3],
            subsurface: None,
            emission_cd_m2: [0.0; 3],
            fibre: None,
            alpha: Alpha::Opaque,
            clearcoat: None,
            sheen: None,
            anisotropy: None,
            frosting: 0.0,
            translucency: 0.0,
        }
    }
}

impl Material {
    /// Returns true if light passes the surface and scatters evenly on its far side: paper, scrims. Clear and soft
    /// surfaces have no such light.
    pub fn is_translucent(&self) -> bool {
        self.translucency > 0.0 && self.transmission == 0.0 && self.metallic < 1.0
    }

    /// Returns the clear dome over the textures; none without any.
    pub fn dome(&self) -> Option<Dome> {
        let radius = self.textures.dome_radius;
        let is_over_a_picture = radius > 0.0 && self.textures.iter().next().is_some();
        is_over_a_picture.then(|| Dome { radius: radius.max(1.0), ior: self.ior })
    }

    /// Returns true if the gloss lies over the relief, with the normal of the mesh.
    pub fn has_smooth_gloss(&self) -> bool {
        self.textures.smooth_gloss || self.dome().is_some()
    }

    /// Returns true if what is below the gloss has normals of its own.
    pub fn has_relief(&self) -> bool {
        self.textures.normal.is_some() || self.dome().is_some()
    }

    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission_cd_m2 != [0.0; 3]
    }
}
