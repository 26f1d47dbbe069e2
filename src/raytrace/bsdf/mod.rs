//! BSDFs: the scattering of light at surfaces.
//!
//! A surface is a mix of a metal (GGX with Schlick's Fresnel reflectance), a dielectric (a GGX coat over a diffuse
//! base) and clear glass (smooth, Fresnel-weighted). Coat and base share the energy through the coat's directional
//! albedo E: the base is scaled by (1 - E(o))(1 - E(i)) / (1 - mean E) (Kelemen and Szirmay-Kalos 2001, "A Microfacet
//! Based Coupled Specular-Matte BRDF Model"), so that a white base under a coat reflects all light. The metal is scaled
//! by 1 + F0 (1 / E - 1) for light that is reflected between facets (Turquin 2019, "Practical Multiple Scattering
//! Compensation for Microfacet Models").
//!
//! Materials that scatter light under the surface have a walk (`super::subsurface`) in place of the diffuse lobe.
//!
//! Surfaces with lacquer, sheen, brushing, frosting or light to their far side have a BSDF of their own (`layered.rs`),
//! so that all others stay as quick as they are.
//!
//! A strand of hair is a fibre instead (`fibre.rs`), which scatters light over the whole sphere.
//!
//! A new lobe of surfaces needs
//! - a file with a `sample` (local direction, or a whole [`BsdfSample`] for a delta lobe) and an `eval` (BSDF times
//!   cosine, pdf times probability; in the local frame, whose +Z is the shading normal);
//! - a variant of `Lobe` with its probability in `LobeProbabilities` (`lobe.rs`), whose `sample` compares numbers and
//!   does not name every lobe; the probability itself in `material_point.rs`, beside `microfacet_probability`;
//! - an arm of `sample` in `surface.rs`, whose match is exhaustive, and its part in the sums of `eval`;
//! - the same in `surface_lanes.rs`, which selects between the diffuse and the microfacet lobe by itself;
//! - a look at `matte_factor` and `remove_matte_base` in `surface.rs` and `with_diffuse_lobe_alone` in `subsurface.rs`,
//!   for which a surface is a diffuse and a microfacet lobe;
//! - its parameters in [`TracedMaterial`], with `max_albedo`, `has_non_specular_lobe` (also that of [`MaterialPoint`]),
//!   `is_nearly_specular` and `is_caustic_caster` kept true;
//! - a case in `tests.rs` (chi-square of the density, white furnace).

mod albedo;
mod blurred_gloss;
mod dielectric;
mod diffuse;
mod direction_table;
mod facets;
mod fibre;
pub mod fresnel;
mod frost;
mod ggx;
mod layered;
mod layers;
mod lobe;
mod material;
mod material_point;
mod microfacet;
mod phong;
mod polarisation;
mod roughness_tables;
mod sample;
mod shading_geometry;
mod sheen;
mod subsurface;
mod surface;
mod surface_lanes;
mod transmission_tint;

use crate::math::Vec3Lanes;
pub use blurred_gloss::BlurredGloss;
pub use dielectric::{Boundary, DielectricInterface, pane_transmittance};
pub use fibre::{FibreBsdf, TracedFibre};
use glam::{Vec2, Vec3};
pub use layered::LayeredBsdf;
pub use material::TracedMaterial;
pub use material_point::{MaterialPoint, TextureFactors};
pub use polarisation::{Polarisation, TransmittedLight};
pub use roughness_tables::RoughnessTables;
pub use sample::BsdfSample;
pub use surface::SurfaceBsdf;
pub use surface_lanes::{BsdfLanes, BsdfNumbers, BsdfSampleLanes};

/// The BSDF at a shading point for one outgoing direction.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "lives on the stack for one vertex; scenes without fibres are traced as fast as with a small variant"
)]
pub enum Bsdf<'a> {
    /// Of a surface.
    Surface(SurfaceBsdf<'a>),
    /// Of a surface with lacquer, sheen, brushing, frosting or light to its far side.
    Layered(LayeredBsdf<'a>),
    /// Of a fibre.
    Fibre(FibreBsdf<'a>),
}

impl<'a> Bsdf<'a> {
    /// Returns the BSDF of a surface for the outgoing direction `wo` (unit, world space), outward normals and texture
    /// values. A clear material is a body in air; see [`Bsdf::set_boundary`] for others.
    pub fn new(
        material: &'a TracedMaterial,
        textures: impl Into<TextureFactors>,
        normal: Vec3,
        geometric_normal: Vec3,
        wo: Vec3,
    ) -> Self {
        match material.layers() {
            None => Bsdf::Surface(SurfaceBsdf::new(material, textures, normal, geometric_normal, wo)),
            Some(layers) => {
                Bsdf::Layered(LayeredBsdf::new((material, layers), textures.into(), normal, geometric_normal, wo))
            }
        }
    }

    /// Lays the brushing across `tangent`, world space.
    pub fn set_tangent(&mut self, tangent: Vec3) {
        if let Bsdf::Layered(layered) = self {
            layered.set_tangent(tangent);
        }
    }

    /// Gives the diffuse lobe an outward normal of its own, world space: that of the BSDF was bent towards the viewer.
    /// Layers are bent with their base.
    pub fn set_relief(&mut self, normal: Vec3) {
        if let Bsdf::Surface(surface) = self {
            surface.set_relief(normal);
        }
    }

    /// Sets the boundary, for a path that accepts this polarisation.
    pub fn set_boundary(&mut self, boundary: Boundary, polarisation: Polarisation) {
        let dielectric = match self {
            Bsdf::Surface(surface) => &mut surface.dielectric,
            Bsdf::Layered(layered) => layered.dielectric_mut(),
            Bsdf::Fibre(_) => return,
        };
        (dielectric.boundary, dielectric.polarisation) = (boundary, polarisation);
    }

    /// Returns the shading normal on the side of the outgoing direction; zero for fibres, frosted glass and translucent
    /// sheets, which scatter light from all directions, and for a surface whose diffuse lobe has a normal of its own.
    pub fn normal(&self) -> Vec3 {
        match self {
            Bsdf::Surface(surface) if surface.has_relief() => Vec3::ZERO,
            Bsdf::Surface(surface) => surface.normal(),
            Bsdf::Layered(layered) if layered.is_two_sided() => Vec3::ZERO,
            Bsdf::Layered(layered) => layered.normal(),
            Bsdf::Fibre(_) => Vec3::ZERO,
        }
    }

    /// Returns the cosine between the shading normal and another normal; of both sides for a surface that scatters light
    /// from both.
    pub fn normal_cosine(&self, normal: Vec3) -> f32 {
        match self {
            Bsdf::Surface(surface) => surface.normal().dot(normal),
            Bsdf::Layered(layered) if layered.is_two_sided() => layered.normal().dot(normal).abs(),
            Bsdf::Layered(layered) => layered.normal().dot(normal),
            Bsdf::Fibre(_) => 0.0,
        }
    }

    /// Returns true if light from a direction reaches the path through the face of a body of frosted glass, so that it
    /// comes from the body's other side.
    pub fn enters_body(&self, direction: Vec3) -> bool {
        matches!(self, Bsdf::Layered(layered) if layered.enters_body(direction))
    }

    /// Returns the Fresnel reflectance of clear glass, which is the probability that [`Bsdf::sample`] samples
    /// reflection: for lobe numbers below it. Returns none for materials with other lobes.
    pub fn dielectric_reflectance(&self) -> Option<f32> {
        match self {
            Bsdf::Surface(surface) => surface.dielectric_reflectance(),
            Bsdf::Layered(_) | Bsdf::Fibre(_) => None,
        }
    }

    /// Returns true if it has a lobe that is not a delta function, so that light sampling can contribute.
    pub fn has_non_specular_lobe(&self) -> bool {
        match self {
            Bsdf::Surface(surface) => surface.has_non_specular_lobe(),
            Bsdf::Layered(layered) => layered.has_non_specular_lobe(),
            Bsdf::Fibre(_) => true,
        }
    }

    /// Returns the BSDF of a fibre for a unit outgoing direction at an offset `h`, -1 to 1, along `tangent` from root to
    /// tip.
    pub fn of_fibre(fibre: &'a TracedFibre, tangent: Vec3, h: f32, wo: Vec3) -> Self {
        Bsdf::Fibre(FibreBsdf::new(fibre, tangent, h, wo))
    }

    /// Puts scattering under the surface in the place of the diffuse lobe.
    pub fn set_subsurface(&mut self) {
        if let Bsdf::Surface(surface) = self {
            surface.set_subsurface();
        }
    }

    /// Returns the diffuse reflectance of a plain matte base under its coat, towards the outgoing direction: the factor on
    /// the light of [`Bsdf::at_exit`]. None for textured gloss, relief, walks, layers, clear materials and fibres.
    pub fn matte_factor(&self) -> Option<Vec3> {
        match self {
            Bsdf::Surface(surface) => surface.matte_factor(),
            Bsdf::Layered(_) | Bsdf::Fibre(_) => None,
        }
    }

    /// Removes the diffuse lobe of a BSDF with a [`Bsdf::matte_factor`]. Returns true if there is a coat or metal left.
    pub fn remove_matte_base(&mut self) -> bool {
        match self {
            Bsdf::Surface(surface) => surface.remove_matte_base(),
            Bsdf::Layered(_) | Bsdf::Fibre(_) => true,
        }
    }

    /// Returns the BSDF where a walk under the surface comes out: a diffuse lobe under the coat, for any outgoing
    /// direction.
    pub fn at_exit(material: &'a TracedMaterial, normal: Vec3, geometric_normal: Vec3) -> Self {
        Bsdf::Surface(SurfaceBsdf::at_exit(material, normal, geometric_normal))
    }

    /// Returns the BSDF of the surface if it samples scattering under the surface.
    pub fn soft_surface(&self) -> Option<&SurfaceBsdf<'a>> {
        match self {
            Bsdf::Surface(surface) => Some(surface).filter(|surface| surface.samples_walks()),
            Bsdf::Layered(_) | Bsdf::Fibre(_) => None,
        }
    }

    /// Returns BSDF times cosine, and the density of [`Bsdf::sample`] (1/sr), for a unit world direction. Delta lobes
    /// are left out of both.
    #[inline(always)]
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        match self {
            Bsdf::Surface(surface) => surface.eval(direction),
            Bsdf::Layered(layered) => layered.eval(direction),
            Bsdf::Fibre(fibre) => fibre.eval(direction),
        }
    }

    /// Returns what [`Bsdf::eval`] returns for the directions of the first lanes.
    #[inline(always)]
    pub fn eval_lanes(&self, directions: &Vec3Lanes, lanes: usize) -> BsdfLanes {
        if let Bsdf::Surface(surface) = self {
            return surface.eval_lanes(directions);
        }
        let mut values = BsdfLanes::ZERO;
        for lane in 0..lanes {
            values.set_lane(lane, self.eval(directions.lane(lane)));
        }
        values
    }

    /// Returns what [`Bsdf::sample`] returns for the numbers of each lane, where all can be sampled at once.
    pub fn sample_lanes(&self, numbers: &BsdfNumbers) -> Option<BsdfSampleLanes> {
        match self {
            Bsdf::Surface(surface) => surface.sample_lanes(numbers),
            Bsdf::Layered(_) | Bsdf::Fibre(_) => None,
        }
    }

    /// Samples a direction for a lobe number in 0..1 and a point of the unit square. Returns none for samples without
    /// contribution.
    #[inline(always)]
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Bsdf::Surface(surface) => surface.sample(u_lobe, u),
            Bsdf::Layered(layered) => layered.sample(u_lobe, u),
            Bsdf::Fibre(fibre) => fibre.sample(u_lobe, u),
        }
    }
}

#[cfg(test)]
mod layered_tests;
#[cfg(test)]
mod tests;
