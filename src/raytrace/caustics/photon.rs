//! The way of one photon: from a lamp to a mirror or glass, and on until it comes to rest.

use crate::math::Ray;
use crate::raytrace::bsdf::Polarisation;
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::path_tracer::{Tracer, survives};
use crate::raytrace::ray_caster::are_parallel;
use crate::raytrace::sampler::{self, Purpose, Sampler};
use glam::Vec3;

/// Light that arrives at a surface.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Relative to the camera.
    pub position: Vec3,
    /// Unit direction towards where it came from.
    pub direction: Vec3,
    /// Of the surface, on the side on which it arrived.
    pub normal: Vec3,
    /// Luminous flux (W of white light, or lm s, as the layer counts) over its cosine to the surface.
    pub flux: Vec3,
    /// Film layer of its light.
    pub layer: u16,
    /// Of its start, in area (square to the direction) and solid angle, 1/(m2 sr), which mirrors and glass do not change;
    /// infinite for a light that no path meets.
    pub density: f32,
    /// Mirrors and glass faces on its way.
    pub bends: u16,
}

/// The same where a body has an inside, which only a light in there meets.
const INSIDE: f32 = 0.1;
/// Least cosine to the surface by which a photon's flux is divided.
const LEAST_COSINE: f32 = 0.01;

/// Chance that a photon begins on the inner side of a surface.
pub fn inside(surface: &SurfaceInteraction) -> f32 {
    if surface.is_thin { 0.5 } else { INSIDE }
}

/// A photon that meets its first mirror or glass.
struct Start {
    /// Where it does.
    surface: SurfaceInteraction,
    /// Unit direction towards the light.
    to_light: Vec3,
    /// Whether some path may meet that light.
    sized: bool,
    /// What it brings, as it would be kept here: of its flux and place, the rest of the way makes the photon.
    photon: Photon,
}

impl Tracer<'_> {
    /// Sends one of `sent` photons, which stand for all light on mirrors and glass, and adds where it is `found`.
    pub fn send_photon(&mut self, sampler: &Sampler, sent: u32, found: &mut Vec<Photon>) {
        if let Some(start) = self.start_photon(sampler, sent) {
            self.follow_photon(start, sampler, found);
        }
    }

    /// A point on a mirror or glass, uniform in area, and a light chosen by what it gives there.
    fn start_photon(&mut self, sampler: &Sampler, sent: u32) -> Option<Start> {
        let scene = self.scene;
        let [place, lamp] = sampler.pair(Purpose::Camera, Purpose::Light { slot: 0, bounce: 0 });
        let [choice, side] = sampler::rest(&place);
        let surface = scene.aggregate.surface(&scene.casters.at(choice, sampler::point(&place))?);
        let inside = inside(&surface);
        let (normal, side) =
            if side < inside { (-surface.geometric_normal, inside) } else { (surface.geometric_normal, 1.0 - inside) };
        let choice = sampler::rest(&lamp)[0];
        let (light, chance) = scene.light_sampler.sample(&scene.lights, surface.position, normal, choice)?;
        let light = &scene.lights[light as usize];
        let sample = light.sample(surface.position, sampler::point(&lamp))?;
        let (to_light, cos) = (sample.direction, sample.direction.dot(normal));
        if cos <= 0.0 {
            return None;
        }
        let origin = surface.spawn_origin(to_light);
        let visible = self.visibility(origin, to_light, sample.distance, true, MediumStack::default());
        let area = scene.casters.area() / (sent as f32 * side * chance);
        let photon = Photon {
            position: surface.position,
            direction: to_light,
            normal,
            flux: light.tint * visible * (sample.value * cos * area),
            layer: light.layer as u16,
            density: sample.pdf.map_or(f32::INFINITY, |pdf| scene.casters.density(side * chance * pdf, cos)),
            bends: 0,
        };
        (photon.flux != Vec3::ZERO).then_some(Start { surface, to_light, sized: sample.pdf.is_some(), photon })
    }

    /// From mirror to glass to mirror, until something scatters it widely.
    fn follow_photon(&mut self, start: Start, sampler: &Sampler, found: &mut Vec<Photon>) {
        let scene = self.scene;
        let Start { mut surface, to_light, sized, photon } = start;
        let mut from = to_light;
        let (mut bends, mut reflected) = (0, false);
        let (mut media, mut polarisation, mut left) = (MediumStack::default(), Polarisation::NONE, Vec3::ONE);
        for bounce in 0..scene.plan().max_bounces {
            let material = &scene.materials[surface.material as usize];
            let set = sampler.set(Purpose::Bsdf { bounce });
            let [lobe, roulette] = sampler::rest(&set);
            let bsdf = scene.bsdf(&surface, from, &media, polarisation);
            let Some(sample) = bsdf.sample(lobe, sampler::point(&set)) else { return };
            // What goes straight through a first pane is found by sampling the lights.
            if !sample.specular || !material.is_caustic_caster() || (sample.is_undeviated && bends == 0) {
                return;
            }
            // Flux is not concentrated in glass as radiance is.
            left *= sample.weight / sample.eta_scale;
            if !sample.is_undeviated {
                bends += 1;
                reflected |= !sample.is_transmission;
                left *= shading_correction(from, sample.direction, surface.normal, surface.geometric_normal);
            }
            if !survives(&mut left, 1.0, bounce, roulette) {
                return;
            }
            if sample.is_transmission && !surface.is_thin {
                media.cross(surface.material, from.dot(surface.geometric_normal) >= 0.0);
            }
            polarisation = sample.polarisation;
            let ray = Ray {
                origin: surface.spawn_origin(sample.direction),
                direction: sample.direction,
                t_max: f32::INFINITY,
            };
            let Some(hit) = self.closest(&ray) else { return };
            left *= media.transmittance(&scene.materials, hit.triangle.t);
            surface = scene.aggregate.surface(&hit);
            from = -sample.direction;
            // Light sampling goes there by itself.
            let is_straight = !sized && !reflected && are_parallel(from, to_light);
            let cos = from.dot(surface.geometric_normal);
            if !is_straight && cos != 0.0 && scene.materials[surface.material as usize].has_non_specular_lobe() {
                let flux = photon.flux * left / cos.abs().max(LEAST_COSINE);
                let normal = surface.geometric_normal * cos.signum();
                found.push(Photon { position: surface.position, direction: from, normal, flux, bends, ..photon });
            }
        }
    }
}

/// What reflection about an interpolated normal does to a beam that the paths from the camera do not see (Veach 1997,
/// section 5.3): `from` and `to` are the directions to the light and onwards.
pub fn shading_correction(from: Vec3, to: Vec3, normal: Vec3, geometric_normal: Vec3) -> f32 {
    let cosines = |normal: Vec3| (from.dot(normal).abs(), to.dot(normal).abs());
    let ((from_s, to_s), (from_g, to_g)) = (cosines(normal), cosines(geometric_normal));
    let denominator = from_g * to_s;
    if denominator > 1e-6 { from_s * to_g / denominator } else { 0.0 }
}
