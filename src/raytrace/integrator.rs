//! The path tracer: light at a camera ray, sample by sample, light by light.
//!
//! Unidirectional, with light sampling at every vertex and multiple importance sampling (Veach 1997, power heuristic)
//! where both techniques can find a light. `direct` is the same with one scattering event; mirrors and glass are passed
//! through in both. Emitters neither cast shadows nor stop light: only the camera sees them as solid from the front.

use super::aggregate::Hit;
use super::bsdf::{Bsdf, BsdfSample};
use super::bvh::Stack;
use super::geometry::Surface;
use super::lights::TracedLight;
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

/// Bounces before roulette begins.
const ROULETTE_FROM: u32 = 3;

/// A thread's view of the scene with its scratch space and counters.
#[derive(Debug)]
pub struct Tracer<'a> {
    scene: &'a RenderScene,
    stack: Stack,
    /// Rays traced so far.
    pub rays: u64,
}

/// The last vertex that sampled lights, as far as weighting a later hit needs it.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
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
        // Stop short of the emitter by the rounding of the distance: it may lie on a surface.
        let ray = Ray { origin, direction, t_max: distance * (1.0 - 4.0 * f32::EPSILON) };
        self.scene.aggregate.blocked(&ray, &mut self.stack)
    }

    /// Follows a camera ray and gives every light's share to `sink`.
    pub fn trace(&mut self, origin: Vec3, direction: Vec3, sampler: &Sampler, limits: Limits, sink: &mut impl Sink) {
        let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
        let mut throughput = Vec3::ONE;
        let mut eta_scale = 1.0;
        let mut vertex = Vertex { position: origin, normal: direction, pdf: None, total_importance: 0.0 };
        let mut wide_bounces = 0;
        for bounce in 0.. {
            let hit = self.closest(&ray);
            let distance = hit.map_or(f32::INFINITY, |h| h.triangle.t);
            if bounce == 0 {
                if self.camera_sees_emitter(&ray, distance, sink) {
                    return;
                }
            } else {
                self.meet_emitters(&ray, distance, throughput, &vertex, sink);
            }
            let Some(hit) = hit else { return };
            let surface = self.scene.aggregate.surface(&hit);
            let material = &self.scene.materials[surface.material as usize];
            if material.glows() {
                let glow = self.scene.layers.len() - 1;
                sink.add(glow, throughput * material.emission * self.scene.glow_time_s);
            }
            let wo = -ray.direction;
            if material.transmits() && wo.dot(surface.geometric_normal) < 0.0 {
                throughput *= (-material.absorption_per_m * distance).exp();
            }
            if wide_bounces >= limits.wide_bounces || bounce >= limits.all_bounces {
                return;
            }
            let texture = material.texture.map_or(Vec3::ONE, |t| self.scene.textures[t as usize].at(surface.uv));
            let bsdf = Bsdf::new(material, texture, surface.normal, surface.geometric_normal, wo);
            vertex = Vertex { position: surface.position, normal: bsdf.normal(), pdf: None, total_importance: 0.0 };
            if material.scatters_widely() {
                let all = bounce == 0 && self.scene.plan().sample_all_lights;
                vertex.total_importance = self.sample_lights(&surface, &bsdf, sampler, bounce, all, throughput, sink);
            }
            let set = sampler.set(Purpose::Bsdf { bounce });
            let Some(sample) = bsdf.sample(set[0], sampler::point(&set)) else { return };
            throughput *= sample.weight;
            eta_scale *= sample.eta_scale;
            if !sample.specular {
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
            ray = leave(&surface, &sample);
        }
    }

    /// The camera sees emitters as solid from the front. True if one hides what is behind it.
    fn camera_sees_emitter(&mut self, ray: &Ray, distance: f32, sink: &mut impl Sink) -> bool {
        let scene = self.scene;
        let nearest = scene
            .lights
            .iter()
            .filter(|light| light.visible_to_camera)
            .filter_map(|light| light.seen_by(ray.origin, ray.direction).map(|seen| (light, seen)))
            .filter(|(_, seen)| seen.distance <= distance)
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
    fn meet_emitters(&self, ray: &Ray, distance: f32, throughput: Vec3, vertex: &Vertex, sink: &mut impl Sink) {
        for light in &self.scene.lights {
            let Some(seen) = light.seen_by(ray.origin, ray.direction) else { continue };
            // A surround is met by every ray that leaves the studio.
            if seen.distance > distance || (seen.distance.is_infinite() && distance.is_finite()) {
                continue;
            }
            let weight = match vertex.pdf {
                Some(pdf) if light.is_sampled() => {
                    let choice = self.choice_probability(light, vertex);
                    let other = choice * light.pdf(ray.origin, ray.direction, seen.distance);
                    power_heuristic(pdf, other)
                }
                _ => 1.0,
            };
            sink.add(light.layer, throughput * light.tint * (seen.luminance * weight));
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
        sampler: &Sampler,
        bounce: u32,
        all: bool,
        throughput: Vec3,
        sink: &mut impl Sink,
    ) -> f32 {
        let scene = self.scene;
        if all || scene.lights.len() == 1 {
            for (slot, light) in scene.lights.iter().enumerate().filter(|(_, l)| l.is_sampled()) {
                let set = sampler.set(Purpose::Light { slot: slot as u32, bounce });
                self.sample_light(light, 1.0, surface, bsdf, &set, throughput, sink);
            }
            return 0.0;
        }
        let importance = |light: &TracedLight| light.importance(surface.position, bsdf.normal());
        let total: f32 = scene.lights.iter().map(importance).sum();
        if !(total > 0.0 && total.is_finite()) {
            return f32::MIN_POSITIVE;
        }
        let set = sampler.set(Purpose::Light { slot: 0, bounce });
        let mut left = set[0] * total;
        for light in &scene.lights {
            let share = importance(light);
            if left < share {
                self.sample_light(light, share / total, surface, bsdf, &set, throughput, sink);
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
        if !self.blocked(origin, sample.direction, sample.distance) {
            sink.add(light.layer, throughput * value * light.tint * (sample.value * weight / choice));
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

fn leave(surface: &Surface, sample: &BsdfSample) -> Ray {
    Ray { origin: surface.leave(sample.direction), direction: sample.direction, t_max: f32::INFINITY }
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
