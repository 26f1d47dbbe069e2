//! The path tracer: light at a camera ray, sample by sample, light by light.
//!
//! Unidirectional, with light sampling at every vertex and multiple importance sampling (Veach 1997, power heuristic)
//! where both techniques can find a light. `direct` is the same with one scattering event; mirrors and glass are passed
//! through in both. Emitters neither cast shadows nor stop light: only the camera sees them as solid from the front.
//!
//! Light sampling goes straight through thin panes, as light does. Through bodies of glass it goes straight, too, but only
//! for lights without a size, which no refracted ray would ever find: right for flat glass, without caustics for curved.

use super::aggregate::Hit;
use super::bsdf::{Behind, Bsdf, Polarisation, pane_transmittance};
use super::bvh::Stack;
use super::geometry::Surface;
use super::lights::TracedLight;
use super::media::Media;
use super::prepare::RenderScene;
use super::sampler::{self, Purpose, Sampler};
use crate::color::luminance;
use crate::math::Ray;
use glam::Vec3;

/// Which bounces are followed.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Scattering events at surfaces that are neither mirror nor glass.
    pub wide_bounces: u32,
    /// All events, mirrors and glass too.
    pub all_bounces: u32,
}

/// Where contributions go: (layer, value).
pub trait Sink {
    /// Adds white luminance (or finished colour, in shared layers) to a layer.
    fn add(&mut self, layer: usize, value: Vec3);
}

impl Vertex {
    pub(super) fn new(position: Vec3, normal: Vec3) -> Self {
        Vertex { position, normal, left_from: position, travelled: 0.0, pdf: None, total_importance: 0.0 }
    }
}

/// Surfaces that light on its straight way through glass may cross.
const CLEAR_SURFACES: u32 = 64;

/// Lights whose importances are kept while one is chosen.
const FEW_LIGHTS: usize = 8;

/// Bounces before roulette begins.
const ROULETTE_FROM: u32 = 3;

/// A thread's view of the scene with its scratch space and counters.
#[derive(Debug)]
pub struct Tracer<'a> {
    pub(super) scene: &'a RenderScene,
    stack: Stack,
    /// Rays traced so far.
    pub rays: u64,
}

/// The last vertex that sampled lights, as far as weighting a later hit needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    position: Vec3,
    normal: Vec3,
    /// Where the ray left, and how far it has come through thin panes since.
    left_from: Vec3,
    travelled: f32,
    /// Density of the direction that was taken; none after a mirror, glass or at the camera.
    pdf: Option<f32>,
    /// Sum of the lights' importances, where one was chosen; 0 where all were sampled.
    total_importance: f32,
}

/// Veach's power heuristic with exponent 2.
fn power_heuristic(ours: f32, other: f32) -> f32 {
    // Scaled first: squares of densities overflow near emitters.
    if other > ours {
        let r = ours / other;
        r * r / (1.0 + r * r)
    } else {
        let r = other / ours;
        1.0 / (1.0 + r * r)
    }
}

impl<'a> Tracer<'a> {
    /// A tracer for one thread.
    pub fn new(scene: &'a RenderScene) -> Self {
        Tracer { scene, stack: Stack::default(), rays: 0 }
    }

    /// The closest surface.
    pub fn closest(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        self.scene.aggregate.closest(ray, &mut self.stack)
    }

    /// Whether anything but emitters lies between a point and one at `distance` from it.
    pub fn blocked(&mut self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        self.rays += 1;
        let ray = Ray { origin, direction, t_max: short_of(origin, distance) };
        self.scene.aggregate.blocked(&ray, &mut self.stack)
    }

    /// Share of a light that reaches a point inside `media`, from `distance` away along a direction. Thin panes let it
    /// through; bodies of glass do for a light without a size.
    pub fn visibility(&mut self, origin: Vec3, direction: Vec3, distance: f32, sized: bool, mut media: Media) -> Vec3 {
        let scene = self.scene;
        if !scene.plan().refraction {
            return if self.blocked(origin, direction, distance) { Vec3::ZERO } else { Vec3::ONE };
        }
        let mut ray = Ray { origin, direction, t_max: short_of(origin, distance) };
        let mut passed = Vec3::ONE;
        for _ in 0..CLEAR_SURFACES {
            let Some(hit) = self.closest(&ray) else {
                // A sun beyond the last surface is not inside of anything.
                let rest = if ray.t_max.is_finite() { ray.t_max } else { 0.0 };
                return passed * media.transmittance(&scene.materials, rest);
            };
            let surface = scene.aggregate.surface(&hit);
            let material = &scene.materials[surface.material as usize];
            if !material.transmits() || (sized && !surface.sheet) {
                return Vec3::ZERO;
            }
            let cos = direction.dot(surface.geometric_normal);
            passed *= media.transmittance(&scene.materials, hit.triangle.t) * material.transmission();
            if surface.sheet {
                passed *= pane_transmittance(cos, material.ior());
            } else {
                // Each of two parallel faces takes its half of what the pane takes, in stops.
                let eta = media.interface(&scene.materials, surface.material, cos < 0.0).eta;
                passed *= pane_transmittance(cos, eta.max(1.0 / eta)).sqrt();
                media.cross(surface.material, cos < 0.0);
            }
            let rest = ray.t_max - hit.triangle.t;
            ray = Ray { origin: surface.leave(direction), direction, t_max: rest };
        }
        Vec3::ZERO
    }

    /// Follows a camera ray and gives every light's share to `sink`.
    pub fn trace(&mut self, origin: Vec3, direction: Vec3, sampler: &Sampler, limits: Limits, sink: &mut impl Sink) {
        self.follow_path(origin, direction, sampler, limits, Vertex::new(origin, direction), sink);
    }

    /// The same for a receptor that has sampled the lights by itself: what of them is met straight on, through thin panes
    /// as well, is left out.
    pub fn trace_past_lights(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl Sink,
    ) {
        // A density of next to nothing: the other technique has all the weight.
        let vertex = Vertex { pdf: Some(f32::MIN_POSITIVE), ..Vertex::new(origin, direction) };
        self.follow_path(origin, direction, sampler, limits, vertex, sink);
    }

    fn follow_path(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: Limits,
        mut vertex: Vertex,
        sink: &mut impl Sink,
    ) {
        let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
        let mut throughput = Vec3::ONE;
        let mut eta_scale = 1.0;
        let mut media = Media::default();
        let mut polarisation = Polarisation::NONE;
        let mut wide_bounces = 0;
        for bounce in 0.. {
            let hit = self.closest(&ray);
            let distance = hit.map_or(f32::INFINITY, |h| h.triangle.t);
            if bounce == 0 {
                if self.camera_sees_emitter(&ray, distance, sink) {
                    return;
                }
            } else {
                self.meet_emitters(&ray, distance, throughput, &vertex, &media, sink);
            }
            let Some(hit) = hit else { return };
            let surface = self.scene.aggregate.surface(&hit);
            let material = &self.scene.materials[surface.material as usize];
            let wo = -ray.direction;
            let outside = wo.dot(surface.geometric_normal) >= 0.0;
            throughput *= if media.innermost().is_none() && material.transmits() && !outside && !surface.sheet {
                // The path began inside this body.
                material.transmittance(distance)
            } else {
                media.transmittance(&self.scene.materials, distance)
            };
            if material.glows() {
                let glow = self.scene.layers.len() - 1;
                sink.add(glow, throughput * material.emission * self.scene.glow_time_s);
            }
            // Straight through a pane a ray goes on after the last bounce, as light sampling there counts on.
            let ends = wide_bounces >= limits.wide_bounces;
            if bounce >= limits.all_bounces || (ends && !(surface.sheet && material.transmits())) {
                return;
            }
            let texture = material.texture.map_or(Vec3::ONE, |t| self.scene.textures[t as usize].at(surface.uv));
            let mut bsdf = Bsdf::new(material, texture, surface.normal, surface.geometric_normal, wo);
            if material.transmits() {
                let interface = || media.interface(&self.scene.materials, surface.material, outside);
                let behind = if surface.sheet { Behind::Pane } else { Behind::Body(interface()) };
                bsdf = bsdf.through(behind, polarisation);
            }
            let before = vertex;
            vertex = Vertex::new(surface.position, bsdf.normal());
            let [light_set, set] = sampler.pair(Purpose::Light { slot: 0, bounce }, Purpose::Bsdf { bounce });
            if material.scatters_widely() && !ends {
                let all = bounce == 0 && self.scene.plan().sample_all_lights;
                vertex.total_importance =
                    self.sample_lights(&surface, &bsdf, &media, sampler, &light_set, bounce, all, throughput, sink);
            }
            let Some(sample) = bsdf.sample(set[0], sampler::point(&set)) else { return };
            if ends && !sample.straight {
                return;
            }
            throughput *= sample.weight;
            eta_scale *= sample.eta_scale;
            polarisation = sample.polarisation;
            if sample.through && !surface.sheet {
                media.cross(surface.material, outside);
            }
            if sample.straight {
                vertex = Vertex { travelled: before.travelled + distance, ..before };
            } else if !sample.specular {
                wide_bounces += 1;
                vertex.pdf = Some(sample.pdf);
                let last = wide_bounces >= limits.wide_bounces || bounce + 1 >= limits.all_bounces;
                if last && !self.scene.plan().emitters_have_size {
                    return;
                }
            }
            if !survives(&mut throughput, eta_scale, bounce, set[1]) {
                return;
            }
            ray = Ray { origin: surface.leave(sample.direction), direction: sample.direction, t_max: f32::INFINITY };
            if !sample.straight {
                vertex.left_from = ray.origin;
            }
        }
    }

    /// The camera sees emitters as solid from the front. True if one hides what is behind it.
    pub(super) fn camera_sees_emitter(&mut self, ray: &Ray, distance: f32, sink: &mut impl Sink) -> bool {
        let scene = self.scene;
        let nearest = scene
            .lights
            .iter()
            .filter(|light| light.visible_to_camera)
            .filter_map(|light| light.seen_by(ray.origin, ray.direction).map(|seen| (light, seen)))
            .filter(|(_, seen)| reaches(ray, seen.distance, distance))
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
        let Some((light, seen)) = nearest else { return false };
        if seen.distance.is_finite() {
            sink.add(light.layer, light.tint * seen.luminance);
            return true;
        }
        // Sun and surround lie behind everything, and may both be seen.
        for light in scene.lights.iter().filter(|l| l.visible_to_camera) {
            if let Some(seen) = light.seen_by(ray.origin, ray.direction) {
                sink.add(light.layer, light.tint * seen.luminance);
            }
        }
        true
    }

    /// Emitters that a scattered ray crosses before it ends.
    pub(super) fn meet_emitters(
        &self,
        ray: &Ray,
        distance: f32,
        throughput: Vec3,
        vertex: &Vertex,
        media: &Media,
        sink: &mut impl Sink,
    ) {
        for light in &self.scene.lights {
            let Some(seen) = light.seen_by(ray.origin, ray.direction) else { continue };
            if !reaches(ray, seen.distance, distance) {
                continue;
            }
            let weight = match vertex.pdf {
                Some(pdf) if light.is_sampled() => {
                    let choice = self.choice_probability(light, vertex);
                    let other = light.pdf(vertex.left_from, ray.direction, vertex.travelled + seen.distance);
                    power_heuristic(pdf, choice * other)
                }
                _ => 1.0,
            };
            let mut left = throughput;
            if seen.distance.is_finite() {
                left *= media.transmittance(&self.scene.materials, seen.distance);
            }
            sink.add(light.layer, left * light.tint * (seen.luminance * weight));
        }
    }

    /// Chance with which light sampling at `vertex` would have chosen this light.
    fn choice_probability(&self, light: &TracedLight, vertex: &Vertex) -> f32 {
        if vertex.total_importance > 0.0 {
            light.importance(vertex.position, vertex.normal) / vertex.total_importance
        } else {
            1.0
        }
    }

    /// Light sampling at a surface: all lights, or one chosen by importance. Returns the sum of importances in the
    /// second case, 0 in the first.
    #[expect(clippy::too_many_arguments, reason = "one call site; the path's state is local to its loop")]
    fn sample_lights(
        &mut self,
        surface: &Surface,
        bsdf: &Bsdf<'_>,
        media: &Media,
        sampler: &Sampler,
        first_set: &sampler::Set,
        bounce: u32,
        all: bool,
        throughput: Vec3,
        sink: &mut impl Sink,
    ) -> f32 {
        let scene = self.scene;
        if all || scene.lights.len() == 1 {
            for (slot, light) in scene.lights.iter().enumerate().filter(|(_, l)| l.is_sampled()) {
                let slot = slot as u32;
                let set = if slot == 0 { *first_set } else { sampler.set(Purpose::Light { slot, bounce }) };
                self.sample_light(light, 1.0, surface, bsdf, media, &set, throughput, sink);
            }
            return 0.0;
        }
        // Few lights are asked once, many once more on the way to the chosen one.
        let mut shares = [0.0; FEW_LIGHTS];
        let importance = |light: &TracedLight| light.importance(surface.position, bsdf.normal());
        let (few, many) = scene.lights.split_at(scene.lights.len().min(FEW_LIGHTS));
        for (share, light) in shares.iter_mut().zip(few) {
            *share = importance(light);
        }
        let total = shares.iter().sum::<f32>() + many.iter().map(importance).sum::<f32>();
        if !(total > 0.0 && total.is_finite()) {
            return f32::MIN_POSITIVE;
        }
        let mut left = first_set[0] * total;
        for (index, light) in scene.lights.iter().enumerate() {
            let share = shares.get(index).copied().unwrap_or_else(|| importance(light));
            if left < share {
                self.sample_light(light, share / total, surface, bsdf, media, first_set, throughput, sink);
                break;
            }
            left -= share;
        }
        total
    }

    #[expect(clippy::too_many_arguments, reason = "one call site; the path's state is local to its loop")]
    fn sample_light(
        &mut self,
        light: &TracedLight,
        choice: f32,
        surface: &Surface,
        bsdf: &Bsdf<'_>,
        media: &Media,
        set: &sampler::Set,
        throughput: Vec3,
        sink: &mut impl Sink,
    ) {
        let Some(sample) = light.sample(surface.position, sampler::point(set)) else { return };
        let (value, pdf) = bsdf.eval(sample.direction);
        if value == Vec3::ZERO {
            return;
        }
        let weight = sample.pdf.map_or(1.0, |light_pdf| power_heuristic(light_pdf * choice, pdf));
        let origin = surface.leave(sample.direction);
        let visible = self.visibility(origin, sample.direction, sample.distance, sample.pdf.is_some(), *media);
        if visible != Vec3::ZERO {
            sink.add(light.layer, throughput * visible * value * light.tint * (sample.value * weight / choice));
        }
    }
}

/// Russian roulette by what is left of the light. Glass concentrates radiance by its index squared; that is no reason
/// to go on.
fn survives(throughput: &mut Vec3, eta_scale: f32, bounce: u32, u: f32) -> bool {
    let left = throughput.max_element() / eta_scale;
    // NaN ends the path, as black does.
    if left.is_nan() || left <= 0.0 {
        return false;
    }
    if bounce < ROULETTE_FROM {
        return true;
    }
    let chance = left.min(0.95);
    if u >= chance {
        return false;
    }
    *throughput /= chance;
    luminance(*throughput).is_finite()
}

/// A share of coordinates and distances that is more than their rounding on the way to an emitter: some 20 micrometres
/// at five metres. Emitters may lie on a surface (a panel on the wall, a lamp on the ceiling) and are seen all the same.
const TOUCHING: f32 = 32.0 * f32::EPSILON;

/// End of a ray towards an emitter that may lie on a surface; none before a sun, whose distance less a share of it would be
/// no number.
fn short_of(origin: Vec3, distance: f32) -> f32 {
    if distance.is_finite() { distance - TOUCHING * (distance + origin.abs().max_element()) } else { distance }
}

/// Whether an emitter at one distance is seen before a surface at another. Sun and surround are seen by rays that leave
/// the studio.
fn reaches(ray: &Ray, emitter: f32, surface: f32) -> bool {
    if emitter.is_finite() { short_of(ray.origin, emitter) <= surface } else { surface.is_infinite() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_techniques_share_one_estimate() {
        for (a, b) in [(1.0, 1.0), (1e-20, 3.0), (1e30, 1e30), (2.0, 0.0)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-6, "{a} {b}: {sum}");
        }
        assert_eq!(power_heuristic(1.0, f32::INFINITY), 0.0);
    }
}
