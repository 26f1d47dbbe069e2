//! What textures change at a surface: its normal, the parameters of its material, its emission, and whether it is there.

use super::aggregate::{Hit, Primitive};
use super::bsdf::{MaterialPoint, TextureFactors, TracedMaterial};
use super::geometry::SurfaceInteraction;
use super::render_scene::RenderScene;
use super::texture::TextureMap;
use crate::math::{Ray, bend_above, decode_normal, tangent_frame};
use crate::scene::{Alpha, TextureSlot};
use glam::{Affine2, Vec3};

impl RenderScene {
    /// Returns the surface interaction at a hit of a ray, with the normal of its normal map.
    pub(super) fn surface(&self, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
        let mut surface = self.aggregate.surface(hit);
        if self.plan.normal_maps {
            self.apply_normal_map(&mut surface, ray.direction, hit);
        }
        if self.plan.tangents {
            self.add_tangent(&mut surface, hit);
        }
        surface
    }

    /// Adds the direction across the grooves of a brushed surface: the texture's U axis, turned. Without texture
    /// coordinates, U is horizontal.
    fn add_tangent(&self, surface: &mut SurfaceInteraction, hit: &Hit) {
        let material = self.material_of(surface);
        let Primitive::Triangle(triangle) = &hit.primitive else { return };
        if !material.is_brushed() {
            return;
        }
        let instance = &self.aggregate.instances()[hit.instance as usize];
        let derivatives = instance.position_derivatives(triangle.triangle, false, &Affine2::IDENTITY);
        let along_u = derivatives.map_or_else(|| Vec3::Y.cross(surface.normal), |[along_u, _]| along_u);
        let across_u = surface.normal.cross(along_u);
        let (sin, cos) = material.brushing_angle().sin_cos();
        surface.tangent = along_u * cos + across_u * sin;
    }

    /// Replaces the shading normal by that of the normal map or of the picture under a dome, bent so that the mirror
    /// direction of the ray stays above the surface. The diffuse lobe has no such direction: it keeps the normal of the map,
    /// or relief that leans away from the viewer would be lit as if it faced him. Light that comes out of a soft surface was
    /// spread under it, farther than relief is wide: it has the normal without the map. A smooth gloss keeps the shading
    /// normal.
    fn apply_normal_map(&self, surface: &mut SurfaceInteraction, direction: Vec3, hit: &Hit) {
        let material = self.material_of(surface);
        let map = self.texture(material, TextureSlot::Normal);
        let Primitive::Triangle(triangle) = &hit.primitive else { return };
        if map.is_none() && material.dome.is_none() {
            return;
        }
        let instance = &self.aggregate.instances()[hit.instance as usize];
        let (second_uvs, picture_from_mesh) = match (material.dome, map) {
            (None, Some(map)) => (map.uses_second_uvs(), map.picture_from_mesh()),
            _ => (false, &Affine2::IDENTITY),
        };
        let derivatives = instance.position_derivatives(triangle.triangle, second_uvs, picture_from_mesh);
        let Some(frame) = derivatives.and_then(|derivatives| tangent_frame(surface.normal, derivatives)) else {
            return;
        };
        let view_dir = -direction.normalize_or_zero();
        // Under a dome the textures are those of what is seen on its flat base, which has no colours of vertices
        let world_from_map = material.dome.map_or(frame, |dome| {
            let (uv, world_from_base) = dome.seen(surface.uv, frame, view_dir);
            (surface.uv, surface.color) = (uv, Vec3::ONE);
            world_from_base
        });
        let tilt = map.map_or(Vec3::Z, |map| decode_normal(map.at_surface(surface), material.normal_scale));
        let relief_normal = (world_from_map * tilt).try_normalize().unwrap_or(world_from_map.z_axis);
        // From behind, the same relief is seen from its back
        let side = if direction.dot(surface.geometric_normal) > 0.0 { -1.0 } else { 1.0 };
        let normal = bend_above(relief_normal * side, surface.geometric_normal * side, view_dir) * side;
        let is_soft = self.plan.subsurface && material.extinction_per_m().is_some();
        surface.relief_normal = if is_soft { surface.normal } else { relief_normal };
        if !material.smooth_gloss {
            surface.normal = normal;
        }
    }

    /// Returns the material of a surface.
    pub(super) fn material_of(&self, surface: &SurfaceInteraction) -> &TracedMaterial {
        &self.materials[surface.material as usize]
    }

    /// Returns the texture of a material in a slot.
    fn texture(&self, material: &TracedMaterial, slot: TextureSlot) -> Option<&TextureMap> {
        self.textures.get(material.texture(slot)? as usize)
    }

    /// Returns the factors of the textures and the vertex colours at a surface.
    pub(super) fn texture_factors(&self, surface: &SurfaceInteraction) -> TextureFactors {
        let material = self.material_of(surface);
        let gloss = self.texture(material, TextureSlot::MetallicRoughness);
        let [_, roughness, metallic] = gloss.map_or(Vec3::ONE, |map| map.at_surface(surface)).to_array();
        TextureFactors { color: self.texture_value(surface), roughness, metallic }
    }

    /// Returns the factor of the base colour at a surface, from the texture and the vertex colours.
    pub(super) fn texture_value(&self, surface: &SurfaceInteraction) -> Vec3 {
        let map = self.texture(self.material_of(surface), TextureSlot::BaseColor);
        map.map_or(surface.color, |map| map.at_surface(surface) * surface.color)
    }

    /// Returns the parameters of the material at a surface.
    pub(super) fn material_point(&self, surface: &SurfaceInteraction) -> MaterialPoint<'_> {
        MaterialPoint::new(self.material_of(surface), self.texture_factors(surface))
    }

    /// Returns the luminance that a surface emits, times its colour, cd/m2.
    pub(super) fn emission(&self, surface: &SurfaceInteraction) -> Vec3 {
        let material = self.material_of(surface);
        let map = self.texture(material, TextureSlot::Emission);
        map.map_or(material.emission, |map| material.emission * map.at_surface(surface))
    }

    /// Returns the coverage at a masked or blended surface, 0 to 1; 1 at others.
    pub(super) fn coverage(&self, surface: &SurfaceInteraction) -> f32 {
        let material = self.material_of(surface);
        if material.coverage == Alpha::Opaque || surface.strand.is_some() {
            return 1.0;
        }
        let map = self.texture(material, TextureSlot::BaseColor);
        material.coverage.coverage(map.map_or(1.0, |map| map.alpha_at_surface(surface)))
    }
}
