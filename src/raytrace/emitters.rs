//! What emitters give along a path: by sampling them at a surface, and by rays that meet them. Where both can find a light,
//! they share it by multiple importance sampling.

use super::caustics::Rival;
use super::lights::{LightImportances, TracedLight};
use super::medium_stack::MediumStack;
use super::path_tracer::{Path, Place, Tracer};
use super::ray_caster::{TOUCHING, reaches};
use super::sampler::{self, Purpose, Sampler};
use super::sink::RadianceSink;
use crate::math::Ray;
use glam::Vec3;

/// The last vertex that sampled lights, as far as weighting a later hit needs it.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    pub position: Vec3,
    pub normal: Vec3,
    /// Where the ray left, and how far it has come through thin panes since.
    pub left_from: Vec3,
    pub travelled: f32,
    /// Density of the direction that was taken, times the ways that were taken for each sample of the lights; none after
    /// a mirror, glass or at the camera.
    pub pdf: Option<f32>,
    /// One light was chosen there, if any was sampled; otherwise all were.
    pub one_light: bool,
    /// Photons that bring the same light, where the path went by mirrors and glass.
    pub rival: Option<Rival>,
}

impl Vertex {
    /// Where a ray begins whose hits have all the weight: nothing else could find them.
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        let left_from = position;
        Vertex { position, normal, left_from, travelled: 0.0, pdf: None, one_light: false, rival: None }
    }
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
    /// The camera sees emitters as solid from the front. True if one hides what is behind it.
    pub fn camera_sees_emitter(&mut self, ray: &Ray, distance: f32, sink: &mut impl RadianceSink) -> bool {
        let scene = self.scene;
        let nearest = scene
            .lights
            .iter()
            .filter(|light| light.visible_to_camera)
            .filter_map(|light| light.intersect(ray.origin, ray.direction).map(|seen| (light, seen)))
            .filter(|(_, seen)| reaches(ray, seen.distance, distance))
            .min_by(|a, b| a.1.distance.total_cmp(&b.1.distance));
        let Some((light, seen)) = nearest else { return false };
        if seen.distance.is_finite() {
            sink.add(light.layer, light.tint * seen.luminance);
            return true;
        }
        // Sun and surround lie behind everything, and may both be seen.
        for light in scene.lights.iter().filter(|l| l.visible_to_camera) {
            if let Some(seen) = light.intersect(ray.origin, ray.direction) {
                sink.add(light.layer, light.tint * seen.luminance);
            }
        }
        true
    }

    /// Emitters that a scattered ray crosses before it ends.
    pub fn meet_emitters(
        &mut self,
        ray: &Ray,
        distance: f32,
        throughput: Vec3,
        vertex: &Vertex,
        media: &MediumStack,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.scene;
        // What lies on the surface is met, too.
        let end = distance + 2.0 * TOUCHING * (distance + ray.origin.abs().max_element());
        scene.emitter_bvh.for_each_hit(&scene.lights, &Ray { t_max: end, ..*ray }, &mut self.stack, |index, seen| {
            if !reaches(ray, seen.distance, distance) {
                return;
            }
            let light = &scene.lights[index as usize];
            let weight = match vertex.pdf {
                None if light.is_sampled() => vertex.rival.map_or(1.0, |rival| {
                    let pdf = light.pdf(vertex.left_from, ray.direction, vertex.travelled + seen.distance);
                    let chance = scene.light_sampler.pmf(&scene.lights, index, vertex.position, rival.normal());
                    rival.weight_of_path(&scene.casters, ray.direction, pdf * chance)
                }),
                Some(pdf) if light.is_sampled() => {
                    let choice = if vertex.one_light {
                        scene.light_sampler.pmf(&scene.lights, index, vertex.position, vertex.normal)
                    } else {
                        1.0
                    };
                    let other = light.pdf(vertex.left_from, ray.direction, vertex.travelled + seen.distance);
                    power_heuristic(pdf, choice * other)
                }
                _ => 1.0,
            };
            let mut left = throughput;
            if seen.distance.is_finite() {
                left *= media.transmittance(&scene.materials, seen.distance);
            }
            sink.add(light.layer, left * light.tint * (seen.luminance * weight));
        });
    }

    /// Whether all lights are sampled where a path is now; otherwise one is chosen.
    pub fn samples_all(&self, path: &Path) -> bool {
        self.scene.lights.len() == 1 || (path.wide_bounces == 0 && self.scene.plan().sample_all_lights)
    }

    /// Light sampling at a surface from which so many `ways` are taken: all lights, or one chosen by what it gives.
    pub fn sample_lights(
        &mut self,
        path: &Path,
        place: &Place<'_>,
        sampler: &Sampler,
        first_set: &sampler::Set,
        ways: f32,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.scene;
        if self.samples_all(path) {
            for (slot, light) in scene.lights.iter().enumerate().filter(|(_, l)| l.is_sampled()) {
                let slot = slot as u32;
                let set =
                    if slot == 0 { *first_set } else { sampler.set(Purpose::Light { slot, bounce: path.bounce }) };
                self.sample_light(light, 1.0, path, place, &set, ways, sink);
            }
            return;
        }
        let choice = sampler::rest(first_set)[0];
        let chosen = match place.importances {
            Some(importances) => importances.sample(&scene.lights, choice),
            None => {
                self.light_importances(place).as_ref().and_then(|importances| importances.sample(&scene.lights, choice))
            }
        };
        if let Some((light, chance)) = chosen {
            self.sample_light(&scene.lights[light as usize], chance, path, place, first_set, ways, sink);
        }
    }

    /// What the lights give at a surface.
    pub fn light_importances(&self, place: &Place<'_>) -> Option<LightImportances<'a>> {
        self.scene.light_sampler.importances(&self.scene.lights, place.surface.position, place.bsdf.normal())
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "called in two places; what it needs of the path's state has no name"
    )]
    fn sample_light(
        &mut self,
        light: &TracedLight,
        choice: f32,
        path: &Path,
        place: &Place<'_>,
        set: &sampler::Set,
        ways: f32,
        sink: &mut impl RadianceSink,
    ) {
        let Place { surface, bsdf, .. } = *place;
        let Some(sample) = light.sample(surface.position, sampler::point(set)) else { return };
        let (value, pdf) = bsdf.eval(sample.direction);
        if value == Vec3::ZERO {
            return;
        }
        let weight = sample.pdf.map_or(1.0, |light_pdf| power_heuristic(light_pdf * choice, pdf * ways));
        let origin = surface.spawn_origin(sample.direction);
        let visible = self.visibility(origin, sample.direction, sample.distance, sample.pdf.is_some(), path.media);
        if visible != Vec3::ZERO {
            sink.add(light.layer, path.throughput * visible * value * light.tint * (sample.value * weight / choice));
        }
    }
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
