//! Emitter hits: light of emitters that rays cross, weighted against light sampling and photons.
//!
//! Emitters neither cast shadows nor stop light; the camera alone sees their front as solid. The body of a light, if it
//! has one, stops all light but its own.

use super::aggregate::Hit;
use super::caustics::CausticMis;
use super::events::PathEvent;
use super::geometry::SurfaceInteraction;
use super::lights::EmitterHit;
use super::medium_stack::MediumStack;
use super::ray_caster::{EMITTER_CONTACT, RayCaster, is_before};
use super::render_scene::RenderScene;
use super::sink::{FirstHit, FirstObject, RadianceSink, SeenSurface};
use super::straight_path::StraightPath;
use crate::math::Ray;
use glam::Vec3;

/// The last non-specular vertex, and the path since then, as far as the MIS weight of an emitter hit needs them.
#[derive(Clone, Copy, Debug)]
pub struct MisVertex {
    /// Position of the surface.
    pub position: Vec3,
    /// Shading normal; zero where light from all directions is received.
    pub normal: Vec3,
    /// Origin of the ray that left the vertex.
    pub ray_origin: Vec3,
    /// Unit direction of that ray.
    pub direction: Vec3,
    /// Density of the direction times the number of paths per light sample, 1/sr; none at the camera.
    pub pdf: Option<f32>,
    /// The vertex chooses one of many lights by importance, rather than among samples of all.
    pub samples_by_importance: bool,
    /// The specular surfaces since then.
    pub path: StraightPath,
    /// Distance from the last vertex through thin panes to the origin of the present ray, metres.
    pub travelled: f32,
    /// Photons that carry the same light, for a path that left through caustic casters.
    pub photons: Option<CausticMis>,
}

impl MisVertex {
    /// A vertex whose rays' emitter hits have the weight 1, as no other technique finds them.
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        MisVertex {
            position,
            normal,
            ray_origin: position,
            direction: Vec3::ZERO,
            pdf: None,
            samples_by_importance: false,
            path: StraightPath::default(),
            travelled: 0.0,
            photons: None,
        }
    }

    /// Continues the path by specular scattering, but for transmission by a thin pane. `photons` carry the same light.
    pub fn scatter_specular(
        &mut self,
        surface: &SurfaceInteraction,
        from_outside: bool,
        is_transmission: bool,
        photons: Option<CausticMis>,
    ) {
        self.path.scatter(surface, from_outside, is_transmission);
        self.travelled = 0.0;
        self.photons = photons;
    }
}

/// The power heuristic with exponent 2 (Veach 1997, section 9.2.2).
pub fn power_heuristic(pdf: f32, other_pdf: f32) -> f32 {
    // The ratio first: squares of densities overflow near emitters.
    if other_pdf > pdf {
        let r = pdf / other_pdf;
        r * r / (1.0 + r * r)
    } else {
        let r = other_pdf / pdf;
        1.0 / (1.0 + r * r)
    }
}

impl RayCaster<'_> {
    /// Adds the nearest emitter that the camera sees in front of a surface at `distance`. Returns true if there is one,
    /// which hides what is behind it. Emitters that are seen before their bodies add their light and hide nothing.
    pub fn add_visible_emitter(&mut self, ray: &Ray, distance: f32, sink: &mut impl RadianceSink) -> bool {
        let visible = || {
            self.scene
                .lights
                .iter()
                .zip(0..)
                .filter(|(light, _)| light.visible_to_camera)
                .filter_map(|(light, i)| light.intersect(ray.origin, ray.direction).map(|hit| (light, i, hit)))
        };
        let nearest = visible()
            .filter(|(_, _, hit)| is_before(ray, hit.distance, distance))
            .min_by(|a, b| a.2.distance.total_cmp(&b.2.distance));
        self.add_emitters_before_bodies(ray, nearest.map_or(distance, |(.., hit)| hit.distance), sink);
        let Some((_, nearest, nearest_hit)) = nearest else { return false };
        let distance = nearest_hit.distance;
        sink.first_hit(|| FirstHit {
            ray: *ray,
            distance,
            normal: Vec3::ZERO,
            albedo: Vec3::ONE,
            object: FirstObject::Emitter,
        });
        sink.seen_surface(|| SeenSurface { albedo: Vec3::ONE, normal: Vec3::ZERO });
        // Sun and surround lie behind everything, and may both be visible.
        for (light, index, hit) in visible().filter(|(_, i, _)| distance.is_infinite() || *i == nearest) {
            sink.record(|| PathEvent::VisibleEmitter { light: index, distance: hit.distance });
            sink.add(light.layer, light.tint_towards(ray.direction) * hit.luminance);
        }
        true
    }

    /// Adds the emitters that the camera sees before their bodies, up to a distance.
    fn add_emitters_before_bodies(&self, ray: &Ray, distance: f32, sink: &mut impl RadianceSink) {
        for (light, index) in self.scene.lights.iter().zip(0..).filter(|(light, _)| light.glows_before_body) {
            let hit = light.intersect(ray.origin, ray.direction);
            if let Some(hit) = hit.filter(|hit| is_before(ray, hit.distance, distance)) {
                sink.record(|| PathEvent::VisibleEmitter { light: index, distance: hit.distance });
                sink.add(light.layer, light.tint_towards(ray.direction) * hit.luminance);
            }
        }
    }

    /// Adds the emitter of a light that lies behind its own body, at which a scattered ray ends: light sampling lets
    /// light pass the body of its light, too. Panes between both block it here.
    fn add_hit_behind_own_body(
        &mut self,
        ray: &Ray,
        surface: &Hit,
        throughput: Vec3,
        vertex: &MisVertex,
        media: &MediumStack,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.scene;
        let Some(body) = scene.aggregate.instances()[surface.instance as usize].body else { return };
        let Some((light, index)) = scene.lights.iter().zip(0..).find(|(light, _)| light.has_body(body.light)) else {
            return;
        };
        let Some(hit) = light.intersect(ray.origin, ray.direction) else { return };
        let is_counted = is_before(ray, hit.distance, surface.t);
        if is_counted || self.occluded(ray.origin, ray.direction, hit.distance, light.own_body()) {
            return;
        }
        let mis_weight = if light.is_sampled() { scene.mis_weight(vertex, ray, index, &hit, media) } else { 1.0 };
        let throughput = throughput * media.transmittance(&scene.materials, hit.distance);
        sink.record(|| PathEvent::EmitterHit { light: index, distance: hit.distance, mis_weight });
        sink.add(light.layer, throughput * light.tint_towards(ray.direction) * (hit.luminance * mis_weight));
    }

    /// Adds the emitters that a scattered ray crosses before the surface that it hits, weighted against light sampling
    /// and photons at `vertex`.
    pub fn add_emitter_hits(
        &mut self,
        ray: &Ray,
        surface: Option<&Hit>,
        throughput: Vec3,
        vertex: &MisVertex,
        media: &MediumStack,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.scene;
        if let Some(surface) = surface {
            self.add_hit_behind_own_body(ray, surface, throughput, vertex, media, sink);
        }
        let distance = surface.map_or(f32::INFINITY, |hit| hit.t);
        // An emitter may lie on the surface.
        let t_max = distance + 2.0 * EMITTER_CONTACT * (distance + ray.origin.abs().max_element());
        scene.emitter_bvh.for_each_hit(&scene.lights, &Ray { t_max, ..*ray }, &mut self.stack, |index, hit| {
            if !is_before(ray, hit.distance, distance) {
                return;
            }
            let light = &scene.lights[index as usize];
            let mis_weight = if light.is_sampled() { scene.mis_weight(vertex, ray, index, &hit, media) } else { 1.0 };
            let mut throughput = throughput;
            if hit.distance.is_finite() {
                throughput *= media.transmittance(&scene.materials, hit.distance);
            }
            sink.record(|| PathEvent::EmitterHit { light: index, distance: hit.distance, mis_weight });
            sink.add(light.layer, throughput * light.tint_towards(ray.direction) * (hit.luminance * mis_weight));
        });
    }
}

impl RenderScene {
    /// MIS weight of an emitter hit of a sampled light: against light sampling on a straight path, against photons on a
    /// caustic one.
    fn mis_weight(&self, vertex: &MisVertex, ray: &Ray, index: u32, hit: &EmitterHit, media: &MediumStack) -> f32 {
        let light = &self.lights[index as usize];
        let pmf = |position, normal| self.light_sampler.pmf(&self.lights, index, position, normal);
        match (vertex.pdf, vertex.photons) {
            (Some(pdf), _) if vertex.path.is_straight() => {
                let light_pdf = if vertex.path.crosses_body() && hit.distance.is_finite() {
                    let point = ray.origin + ray.direction * hit.distance;
                    let mut caster = RayCaster::new(self);
                    caster.straight_path_pdf(light, vertex.ray_origin, vertex.direction, point, *media)
                } else {
                    light.pdf(vertex.ray_origin, ray.direction, vertex.travelled + hit.distance)
                };
                let pmf = if vertex.samples_by_importance { pmf(vertex.position, vertex.normal) } else { 1.0 };
                power_heuristic(pdf, pmf * light_pdf)
            }
            (Some(_), Some(photons)) => {
                let light_pdf = light.pdf(photons.ray_origin, ray.direction, vertex.travelled + hit.distance);
                photons.path_weight(&self.casters, ray.direction, light_pdf * pmf(photons.position, photons.normal))
            }
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_two_techniques_add_up_to_one() {
        for (a, b) in [(1.0, 1.0), (1e-20, 3.0), (1e30, 1e30), (2.0, 0.0)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-6, "{a} {b}: {sum}");
        }
        assert_eq!(power_heuristic(1.0, f32::INFINITY), 0.0);
    }
}
