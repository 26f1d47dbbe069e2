//! The photon tracer: light that mirrors and clear glass throw on non-specular surfaces.

use super::photon::{Photon, inner_side_probability};
use super::start_density::StartDensity;
use crate::math::Ray;
use crate::raytrace::bsdf::{BsdfSample, Polarisation};
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::roulette::{survival_probability, survives};
use crate::raytrace::sampler::{self, Dimensions, Sampler};
use crate::raytrace::straight_path::StraightPath;
use glam::Vec3;

/// Least cosine to the surface by which a photon's flux is divided.
const MIN_COSINE: f32 = 0.01;

/// Squared length of the normal of refraction, the relative index times one direction plus the other, below which light is
/// not deviated.
const UNDEVIATED: f32 = 1e-4;

/// Traces photons for one thread.
#[derive(Debug)]
pub struct PhotonTracer<'a> {
    /// Casts the rays.
    pub caster: RayCaster<'a>,
    /// Where photons start.
    starts: &'a StartDensity,
}

/// Receives the photons that a tracer follows.
pub trait PhotonReceiver {
    /// Receives a photon that arrives at a non-specular surface by a caustic path.
    fn arrive(&mut self, photon: Photon);

    /// Receives a photon that arrives at its first caster, with the position along their curve. The default ignores it.
    fn start(&mut self, _photon: &Photon, _curve_position: f64) {}

    /// Receives a photon on a caustic path on its way to the next surface. The default ignores it.
    fn travel(&mut self, _segment: &PhotonSegment<'_>) {}
}

impl PhotonReceiver for Vec<Photon> {
    fn arrive(&mut self, photon: Photon) {
        self.push(photon);
    }
}

/// A photon between two surfaces.
#[derive(Clone, Copy, Debug)]
pub struct PhotonSegment<'a> {
    /// The ray, whose `t_max` is the distance to the next surface.
    pub ray: Ray,
    /// The photon at the ray's origin: position and direction are the ray's, flux is in lm.
    pub photon: Photon,
    /// The bodies that it is inside of.
    pub media: &'a MediumStack,
}

/// A photon at its first caustic caster.
struct FirstCaster {
    surface: SurfaceInteraction,
    /// Unit direction towards the light.
    to_light: Vec3,
    /// The body around a light that lies inside of one.
    media: MediumStack,
    /// The photon as it arrives.
    photon: Photon,
    /// Position along the curve of the casters.
    curve_position: f64,
}

impl<'a> PhotonTracer<'a> {
    /// A tracer for a scene.
    pub fn new(scene: &'a RenderScene, starts: &'a StartDensity) -> Self {
        PhotonTracer { caster: RayCaster::new(scene), starts }
    }

    /// Traces one of `emitted` photons, which share all light on casters.
    pub fn trace(&mut self, sampler: &Sampler, emitted: u32, receiver: &mut impl PhotonReceiver) {
        if let Some(first) = self.sample_first_caster(sampler, emitted) {
            receiver.start(&first.photon, first.curve_position);
            self.follow(first, sampler, receiver);
        }
    }

    /// Samples a point on the casters, and a light by its importance there.
    fn sample_first_caster(&mut self, sampler: &Sampler, emitted: u32) -> Option<FirstCaster> {
        let scene = self.caster.scene;

        // Sample the point and the side of the surface
        let [point_set, light_set] = sampler.pair(Dimensions::Camera, Dimensions::Light { slot: 0, depth: 0 });
        let [patch_choice, side_choice] = sampler::last_pair(&point_set);
        let start = scene.casters.sample(self.starts, patch_choice, sampler::first_pair(&point_set))?;
        let surface = scene.aggregate.surface(&start.hit);
        let inner = inner_side_probability(&surface);
        let is_inner = side_choice < inner;
        let (normal, side_probability) =
            if is_inner { (-surface.geometric_normal, inner) } else { (surface.geometric_normal, 1.0 - inner) };

        // Sample the light and a direction towards it
        let light_choice = sampler::last_pair(&light_set)[0];
        let (light, pmf) = scene.light_sampler.sample(&scene.lights, surface.position, normal, light_choice)?;
        let light = &scene.lights[light as usize];
        let sample = light.sample(surface.position, sampler::first_pair(&light_set))?;
        let (to_light, cos) = (sample.direction, sample.direction.dot(normal));
        if cos <= 0.0 {
            return None;
        }

        // Trace the shadow ray; bodies of glass block it, as photons through them start at the outer one
        let origin = surface.spawn_origin(to_light);
        let visibility = self.caster.pane_transmittance(origin, to_light, sample.distance, light.own_body());
        if visibility == Vec3::ZERO {
            return None;
        }

        // Only a light inside of a body reaches its inner side, through the body
        let mut media = MediumStack::default();
        let mut transmittance = visibility;
        if is_inner && !surface.is_thin && sample.distance.is_finite() {
            media.cross(surface.material, true);
            transmittance *= media.transmittance(&scene.materials, sample.distance);
        }
        let probability = start.relative_density * side_probability * pmf;
        let area = scene.casters.area() / (emitted as f32 * probability);
        let density = |pdf: f32| scene.casters.density(probability * pdf, cos);
        let photon = Photon {
            position: surface.position,
            direction: to_light,
            normal,
            flux: light.tint_towards(to_light) * transmittance * (sample.value * cos * area),
            layer: light.layer as u16,
            density: sample.pdf.map_or(f32::INFINITY, density),
            specular_depth: 0,
        };
        let curve_position = start.curve_position;
        (photon.flux != Vec3::ZERO).then_some(FirstCaster { surface, to_light, media, photon, curve_position })
    }

    /// Follows a photon through casters until it is absorbed.
    fn follow(&mut self, first: FirstCaster, sampler: &Sampler, receiver: &mut impl PhotonReceiver) {
        let scene = self.caster.scene;
        let FirstCaster { mut surface, to_light, mut media, photon, .. } = first;
        let mut wo = to_light;
        let (mut specular_depth, mut path) = (0, StraightPath::default());
        let (mut polarisation, mut throughput) = (Polarisation::NONE, Vec3::ONE);
        for depth in 0..scene.plan().max_depth {
            // Sample the BSDF; only specular scattering at casters is followed
            let material = &scene.materials[surface.material as usize];
            let set = sampler.set(Dimensions::Bsdf { depth });
            let [lobe, roulette] = sampler::last_pair(&set);
            let bsdf = scene.bsdf(scene.material_of(&surface), &surface, wo, &media, polarisation);
            let Some(sample) = bsdf.sample(lobe, sampler::first_pair(&set)) else { return };
            let is_unscattered = sample.is_undeviated && specular_depth == 0;
            // Light sampling finds what is transmitted by a pane alone.
            if !sample.specular || !material.is_caustic_caster() || is_unscattered {
                return;
            }

            // Update the throughput: unlike radiance, flux does not scale with the squared index of refraction
            let from_outside = wo.dot(surface.geometric_normal) >= 0.0;
            throughput *= sample.weight / sample.eta_scale;
            if !sample.is_undeviated {
                specular_depth += 1;
                let eta = media.interface(&scene.materials, surface.material, from_outside).eta;
                throughput *= shading_correction(wo, &sample, eta, surface.geometric_normal);
            }
            let survival = survival_probability(throughput, 1.0, depth);
            if !survives(&mut throughput, survival, roulette) {
                return;
            }
            if !sample.is_undeviated {
                path.scatter(&surface, from_outside, sample.is_transmission);
            }
            if sample.is_transmission && !surface.is_thin {
                media.cross(surface.material, from_outside);
            }
            polarisation = sample.polarisation;

            // Trace the ray to the next surface
            let (origin, direction) = (surface.spawn_origin(sample.direction), sample.direction);
            let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
            let hit = self.caster.intersect(&ray);

            // Hand the photon on, unless light sampling finds the same light on a straight path
            let is_caustic = !path.is_straight();
            if is_caustic {
                ray.t_max = hit.map_or(f32::INFINITY, |hit| hit.t);
                let flux = photon.flux * throughput;
                let photon = Photon { position: origin, direction: -direction, flux, specular_depth, ..photon };
                receiver.travel(&PhotonSegment { ray, photon, media: &media });
            }
            let Some(hit) = hit else { return };
            throughput *= media.transmittance(&scene.materials, hit.t);
            surface = scene.surface(&ray, &hit);
            wo = -direction;
            let cos = wo.dot(surface.geometric_normal);
            let gathers =
                surface.strand.is_none() && scene.materials[surface.material as usize].has_non_specular_lobe();
            if is_caustic && cos != 0.0 && gathers {
                receiver.arrive(Photon {
                    position: surface.position,
                    direction: wo,
                    normal: surface.geometric_normal * cos.signum(),
                    flux: photon.flux * throughput / cos.abs().max(MIN_COSINE),
                    specular_depth,
                    ..photon
                });
            }
        }
    }
}

/// Returns the factor of a photon's flux at a surface with an interpolated normal, by which photons agree with paths from
/// the camera (Veach 1997, section 5.3). `wo` is the direction towards the light, the sample's the one onwards; `eta` is the
/// index of the transmitted side over that of the side of `wo`. The normal is the one about which light was mirrored or
/// refracted, which follows from these: the geometric one where the interpolated one would have sent it to the wrong
/// side.
pub fn shading_correction(wo: Vec3, sample: &BsdfSample, eta: f32, geometric_normal: Vec3) -> f32 {
    let wi = sample.direction;
    let (wo_geometric, wi_geometric) = (wo.dot(geometric_normal).abs(), wi.dot(geometric_normal).abs());
    let normal = if sample.is_transmission { wo + wi * eta } else { wo + wi };
    // Where both sides have next to the same index, light goes on as it came
    if sample.is_transmission && normal.length_squared() < UNDEVIATED {
        return 1.0;
    }
    let (wo_shading, wi_shading) = (wo.dot(normal).abs(), wi.dot(normal).abs());
    let denominator = wo_geometric * wi_shading;
    if denominator > 1e-6 * normal.length() { wo_shading * wi_geometric / denominator } else { 0.0 }
}
