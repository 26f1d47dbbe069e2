//! Whitted's recursive ray tracer (1980, "An Improved Illumination Model for Shaded Display"): a rung of the ladder, for
//! comparison.
//!
//! Models Phong lobes, hard shadows, mirrored and refracted rays. Every light shines from its centre, so there are no
//! soft shadows, and near a large panel there is too much light: as for any point, it grows with the inverse square. A
//! surround is an even ambient light that nothing shades. No light bounces between surfaces but by mirrors and glass.
//! The units are those of the path tracer.

use super::bsdf::{fresnel, pane_transmittance};
use super::emitters::Vertex;
use super::geometry::SurfaceInteraction;
use super::medium_stack::MediumStack;
use super::path_tracer::Tracer;
use super::sink::RadianceSink;
use crate::math::Ray;
use glam::Vec3;

/// A ray still to be followed, and what of its light arrives.
struct Branch {
    ray: Ray,
    share: Vec3,
    media: MediumStack,
    depth: u32,
}

/// Branches with less than this are cut.
const NEGLIGIBLE: f32 = 1.0 / 512.0;

impl Tracer<'_> {
    /// Follows a camera ray and gives every light's share to `sink`. Mirrors and glass are followed `depth` times.
    pub fn whitted(&mut self, origin: Vec3, direction: Vec3, depth: u32, sink: &mut impl RadianceSink) {
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        let mut open = vec![Branch { ray, share: Vec3::ONE, media: MediumStack::default(), depth: 0 }];
        while let Some(branch) = open.pop() {
            self.follow(branch, depth, &mut open, sink);
        }
    }

    fn follow(&mut self, branch: Branch, depth: u32, open: &mut Vec<Branch>, sink: &mut impl RadianceSink) {
        let scene = self.scene;
        let Branch { ray, mut share, media, .. } = branch;
        let hit = self.closest(&ray);
        let distance = hit.map_or(f32::INFINITY, |hit| hit.triangle.t);
        if branch.depth > 0 {
            self.meet_emitters(&ray, distance, share, &Vertex::new(ray.origin, ray.direction), &media, sink);
        } else if self.camera_sees_emitter(&ray, distance, sink) {
            return;
        }
        let Some(hit) = hit else { return };
        share *= media.transmittance(&scene.materials, distance);
        let surface = scene.aggregate.surface(&hit);
        let material = &scene.materials[surface.material as usize];
        if material.is_emissive() {
            sink.add(scene.layers.len() - 1, share * material.emission * scene.glow_time_s);
        }
        let view_dir = -ray.direction;
        let outside = view_dir.dot(surface.geometric_normal) >= 0.0;
        let side = if outside { 1.0 } else { -1.0 };
        let smooth = surface.normal * side;
        let normal = if smooth.dot(view_dir) > 0.0 { smooth } else { surface.geometric_normal * side };
        let texture = material.texture.map_or(Vec3::ONE, |t| scene.textures[t as usize].at(surface.uv));
        let phong = material.phong(texture);
        self.light(&surface, &media, share, sink, |light_dir| {
            let above = light_dir.dot(normal) > 0.0 && light_dir.dot(surface.geometric_normal) * side > 0.0;
            if above { phong.eval(light_dir, view_dir, normal) * light_dir.dot(normal) } else { Vec3::ZERO }
        });
        self.ambient(share * phong.albedo, sink);
        let mut branch_to = |direction: Vec3, part: Vec3, media: MediumStack| {
            if branch.depth < depth && part.max_element() > NEGLIGIBLE && direction != Vec3::ZERO {
                let ray = Ray { origin: surface.spawn_origin(direction), direction, t_max: f32::INFINITY };
                open.push(Branch { ray, share: part, media, depth: branch.depth + 1 });
            }
        };
        let mirrored = (2.0 * view_dir.dot(normal) * normal - view_dir).normalize_or_zero();
        if phong.clear <= 0.0 {
            branch_to(mirrored, share * phong.mirror, media);
            return;
        }
        if surface.is_thin {
            let passing = pane_transmittance(view_dir.dot(normal), material.ior());
            branch_to(mirrored, share * (phong.mirror + phong.clear * (1.0 - passing)), media);
            branch_to(ray.direction, share * (phong.clear * passing), media);
            return;
        }
        let eta = media.interface(&scene.materials, surface.material, outside).eta;
        let reflectance = fresnel::dielectric(view_dir.dot(normal), eta);
        branch_to(mirrored, share * (phong.mirror + phong.clear * reflectance), media);
        if let Some(refracted) = fresnel::refract_about(view_dir, normal, eta) {
            let mut beyond = media;
            beyond.cross(surface.material, outside);
            branch_to(refracted, share * (phong.clear * (1.0 - reflectance) / (eta * eta)), beyond);
        }
    }

    /// Every light from its centre, with a hard shadow. `scatter` is BSDF times cosine.
    fn light(
        &mut self,
        surface: &SurfaceInteraction,
        media: &MediumStack,
        share: Vec3,
        sink: &mut impl RadianceSink,
        scatter: impl Fn(Vec3) -> Vec3,
    ) {
        for light in &self.scene.lights {
            let Some(sample) = light.sample_centre(surface.position) else { continue };
            let value = scatter(sample.direction);
            if value == Vec3::ZERO {
                continue;
            }
            let origin = surface.spawn_origin(sample.direction);
            let visible = self.visibility(origin, sample.direction, sample.distance, !light.is_delta(), *media);
            sink.add(light.layer, share * visible * value * light.tint * sample.value);
        }
    }

    /// Surrounds, unshaded.
    fn ambient(&self, reflected: Vec3, sink: &mut impl RadianceSink) {
        for light in &self.scene.lights {
            if let Some(luminance) = light.surround_luminance() {
                sink.add(light.layer, reflected * light.tint * luminance);
            }
        }
    }
}
