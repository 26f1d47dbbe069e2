//! The scene as the tracer reads it: flat tables.

use super::aggregate::{Aggregate, Hit, Primitive};
use super::bsdf::{Boundary, Bsdf, Polarisation, TracedMaterial};
use super::caustics::CausticCasters;
use super::film::Layer;
use super::geometry::SurfaceInteraction;
use super::lens::Lens;
use super::lights::{EmitterBvh, LightLanes, LightSampler, TracedLight};
use super::medium_stack::MediumStack;
use super::plan::RenderPlan;
use super::sampler::{Dimensions, Sampler};
use super::sink::{FirstHit, FirstObject, SeenSurface};
use super::strand_detail::StrandView;
use super::texture::TextureMap;
use crate::math::Ray;
use crate::scene::LightId;
use glam::Vec3;

/// A scene ready for tracing. Positions are relative to `origin`.
#[derive(Debug)]
pub struct RenderScene {
    /// World position of the tracer's origin: the camera of a render.
    pub(super) origin: Vec3,
    pub(super) aggregate: Aggregate,
    pub(super) materials: Vec<TracedMaterial>,
    pub(super) textures: Vec<TextureMap>,
    pub(super) lights: Vec<TracedLight>,
    /// The scene's light of each of `lights`.
    pub(super) light_ids: Vec<LightId>,
    /// Samples one of `lights` by importance.
    pub(super) light_sampler: LightSampler,
    /// Samples all of `lights` at once, if there is a lane for each.
    pub(super) light_lanes: Option<LightLanes>,
    /// Finds those of `lights` that a ray crosses.
    pub(super) emitter_bvh: EmitterBvh,
    /// Surfaces that cast caustics; empty where the plan has no photons.
    pub(super) casters: CausticCasters,
    pub(super) layers: Vec<Layer>,
    /// Exposure time of each layer, seconds; 1 for a flash and where the layer's sums include it.
    pub(super) layer_times: Vec<f32>,
    /// Exposure time of emissive surfaces, seconds.
    pub(super) emission_time_s: f32,
    /// Picture value of one cd s/m2.
    pub(super) exposure: f32,
    pub(super) lens: Lens,
    pub(super) plan: RenderPlan,
    /// The scene in the moments of its exposure; none if one time shows all of it.
    pub(super) moments: Vec<RenderScene>,
}

/// Object index of the room's instance.
pub(super) const ROOM: u32 = u32::MAX;

impl RenderScene {
    /// The plan of the render, with its reasons.
    pub fn plan(&self) -> &RenderPlan {
        &self.plan
    }

    /// Replaces the plan, to measure a shortcut. A plan without what the scene needs makes the picture wrong.
    pub fn set_plan(&mut self, plan: RenderPlan) {
        self.moments.iter_mut().for_each(|moment| moment.plan = plan.clone());
        self.plan = plan;
    }

    /// Chooses the levels of detail of strands for a camera.
    pub(super) fn thin_strands(&mut self, view: &StrandView) {
        self.aggregate.thin_strands(view);
        self.moments.iter_mut().for_each(|moment| moment.thin_strands(view));
    }

    /// The scene in each moment of its exposure, for samples and photons that have [`RenderScene::moment_of`].
    pub(super) fn moments(&self) -> &[RenderScene] {
        if self.moments.is_empty() { std::slice::from_ref(self) } else { &self.moments }
    }

    /// Index of the moment that a sample has.
    pub(super) fn moment_of(&self, sampler: &Sampler) -> usize {
        match self.moments.len() {
            0 => 0,
            count => ((sampler.set(Dimensions::Time)[0] * count as f32) as usize).min(count - 1),
        }
    }

    /// Number of triangles, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.aggregate.instances().iter().map(|i| i.geometry.mesh().triangles.len() as u64).sum()
    }

    /// Number of lights that are on.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// The layers of the scene's films.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The scene's light of a prepared one.
    pub fn light_id(&self, light: u32) -> Option<LightId> {
        self.light_ids.get(light as usize).copied()
    }

    /// Returns the BSDF at a surface towards `wo` (unit), for a path inside `media` that accepts this polarisation.
    /// `material` is that of the surface, or the same with blurred gloss.
    pub(super) fn bsdf<'a>(
        &'a self,
        material: &'a TracedMaterial,
        surface: &SurfaceInteraction,
        wo: Vec3,
        media: &MediumStack,
        polarisation: Polarisation,
    ) -> Bsdf<'a> {
        if let (Some(strand), Some(fibre)) = (&surface.strand, material.fibre()) {
            return Bsdf::of_fibre(fibre, strand.tangent, strand.h, wo);
        }
        self.surface_bsdf(material, surface, wo, media, polarisation)
    }

    /// As [`RenderScene::bsdf`], of a surface that is no fibre. It is completed in place: copies of it cost time.
    fn surface_bsdf<'a>(
        &'a self,
        material: &'a TracedMaterial,
        surface: &SurfaceInteraction,
        wo: Vec3,
        media: &MediumStack,
        polarisation: Polarisation,
    ) -> Bsdf<'a> {
        let factors = self.texture_factors(surface);
        let mut bsdf = Bsdf::new(material, factors, surface.normal, surface.geometric_normal, wo);
        if self.plan.normal_maps && surface.relief_normal != surface.normal {
            bsdf.set_relief(surface.relief_normal);
        }
        if self.plan.tangents && surface.tangent != Vec3::ZERO {
            bsdf.set_tangent(surface.tangent);
        }
        let outside = wo.dot(surface.geometric_normal) >= 0.0;
        if self.plan.subsurface && outside && surface.strand.is_none() && material.extinction_per_m().is_some() {
            bsdf.set_subsurface();
        } else if material.transmits() {
            let interface = || media.interface(&self.materials, surface.material, outside);
            let boundary = if surface.is_thin { Boundary::ThinPane } else { Boundary::Interface(interface()) };
            bsdf.set_boundary(boundary, polarisation);
        }
        bsdf
    }

    /// The reflectance at a surface, for the albedo AOV and ambient light.
    pub(super) fn albedo(&self, surface: &SurfaceInteraction) -> Vec3 {
        let material = &self.materials[surface.material as usize];
        match material.fibre().filter(|_| surface.strand.is_some()) {
            Some(fibre) => fibre.albedo(),
            None => material.albedo(self.texture_value(surface)),
        }
    }

    /// The film layer of emissive surfaces.
    pub(super) fn emission_layer(&self) -> usize {
        self.layers.len() - 1
    }

    /// Index into the scene's objects of a hit, none for the room, and the name of the part.
    pub(super) fn object_and_part(&self, hit: &Hit) -> (Option<u32>, &str) {
        let instance = &self.aggregate.instances()[hit.instance as usize];
        let (mesh, geometry) = (instance.geometry.mesh(), &instance.geometry);
        let part = match &hit.primitive {
            Primitive::Triangle(hit) => mesh.parts.get(geometry.part(hit.triangle)).map(|part| part.name.as_str()),
            Primitive::Strand(hit) => {
                let part = geometry.strands.part(hit.segment.segment);
                mesh.strands.parts().get(part).map(|part| part.name.as_str())
            }
        };
        (Some(instance.object).filter(|object| *object != ROOM), part.unwrap_or(""))
    }

    /// The film's description of a surface that the camera sees with this throughput.
    pub(super) fn seen_surface(&self, ray: &Ray, throughput: Vec3, surface: &SurfaceInteraction) -> SeenSurface {
        let part = throughput.max_element().clamp(0.0, 1.0);
        SeenSurface { albedo: self.albedo(surface) * throughput, normal: surface.facing_normal(ray.direction) * part }
    }

    /// The film's description of the first hit of a camera ray.
    pub(super) fn first_hit(&self, ray: &Ray, hit: &Hit, surface: &SurfaceInteraction) -> FirstHit {
        let (object, _) = self.object_and_part(hit);
        let is_body = self.aggregate.instances()[hit.instance as usize].body.is_some();
        let no_object = if is_body { FirstObject::Emitter } else { FirstObject::Room };
        FirstHit {
            ray: *ray,
            distance: hit.t,
            normal: surface.facing_normal(ray.direction),
            albedo: self.albedo(surface),
            object: object.map_or(no_object, FirstObject::Object),
        }
    }
}
