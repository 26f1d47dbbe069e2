//! Light sampling at the vertices of a path.

use super::connection::Connection;
use super::emitters::power_heuristic;
use super::events::PathEvent;
use super::lights::LightImportances;
use super::path_tracer::{PathState, PathTracer, ShadingPoint};
use super::sampler::{self, Dimensions, Sampler};
use super::sink::RadianceSink;
use glam::Vec3;

impl<'a> PathTracer<'a> {
    /// Returns true if all lights are sampled at the path's vertex rather than one of them.
    pub fn samples_all_lights(&self, path: &PathState) -> bool {
        let scene = self.caster.scene;
        scene.lights.len() == 1 || (path.non_specular_depth == 0 && scene.plan().sample_all_lights)
    }

    /// Samples all lights, or one by its importance, at a vertex from which so many paths continue.
    pub fn sample_lights(
        &mut self,
        path: &PathState,
        point: &ShadingPoint<'_>,
        sampler: &Sampler,
        first_set: &sampler::Set,
        paths: f32,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.caster.scene;
        if self.samples_all_lights(path) {
            for (slot, _) in (0..).zip(&scene.lights).filter(|(_, light)| light.is_sampled()) {
                let depth = path.depth;
                let set = if slot == 0 { *first_set } else { sampler.set(Dimensions::Light { slot, depth }) };
                self.sample_light(slot, 1.0, path, point, &set, paths, sink);
            }
            return;
        }
        let u = sampler::last_pair(first_set)[0];
        let chosen = match point.importances {
            Some(importances) => importances.sample(&scene.lights, u),
            None => self.light_importances(point).as_ref().and_then(|importances| importances.sample(&scene.lights, u)),
        };
        if let Some((light, pmf)) = chosen {
            self.sample_light(light, pmf, path, point, first_set, paths, sink);
        }
    }

    /// Importances of the lights at a vertex.
    pub fn light_importances(&self, point: &ShadingPoint<'_>) -> Option<LightImportances<'a>> {
        let scene = self.caster.scene;
        scene.light_sampler.importances(&scene.lights, point.surface.position, point.bsdf.normal())
    }

    /// Samples a light that was chosen with probability `pmf`, and adds its contribution.
    #[expect(clippy::too_many_arguments, reason = "called in two places; no two of them belong together")]
    fn sample_light(
        &mut self,
        index: u32,
        pmf: f32,
        path: &PathState,
        point: &ShadingPoint<'_>,
        set: &sampler::Set,
        paths: f32,
        sink: &mut impl RadianceSink,
    ) {
        let light = &self.caster.scene.lights[index as usize];
        let ShadingPoint { surface, bsdf, .. } = *point;

        // Sample a direction towards the light and evaluate the BSDF
        let Some(sample) = &light.sample(surface.position, sampler::first_pair(set)) else { return };
        let (value, bsdf_pdf) = bsdf.eval(sample.direction);
        if value == Vec3::ZERO && point.control.is_none() {
            return;
        }

        // Connect with the light, through flat bodies in another direction
        let event = |pdf, bsdf_pdf, visibility, mis_weight| PathEvent::LightSample {
            light: index,
            pmf,
            pdf,
            bsdf_pdf,
            visibility,
            mis_weight,
        };
        let mut media = path.media;
        if bsdf.enters_body(sample.direction) {
            media.cross(surface.material, point.outside);
        }
        let connection = self.caster.connect(surface.spawn_origin(sample.direction), light, sample, media);
        let Some(Connection { direction, value: light_value, pdf, transmittance }) = connection else {
            sink.record(|| event(sample.pdf, bsdf_pdf, Vec3::ZERO, 0.0));
            return;
        };
        let (value, bsdf_pdf) = if direction == sample.direction { (value, bsdf_pdf) } else { bsdf.eval(direction) };

        // Weight against emitter hits and add the contribution
        let mis_weight = pdf.map_or(1.0, |light_pdf| power_heuristic(light_pdf * pmf, bsdf_pdf * paths));
        sink.record(|| event(pdf, bsdf_pdf, transmittance, mis_weight));
        let value =
            path.throughput * transmittance * value * light.tint_towards(direction) * (light_value * mis_weight / pmf);
        sink.add(light.layer, value);

        // Add the control variate, whose MIS weight is that of one path
        if let Some(control) = point.control {
            let (value, bsdf_pdf) = control.eval(direction);
            let mis_weight = pdf.map_or(1.0, |light_pdf| power_heuristic(light_pdf * pmf, bsdf_pdf));
            let value = path.throughput
                * transmittance
                * value
                * light.tint_towards(direction)
                * (light_value * mis_weight / pmf);
            sink.add(light.layer, value);
        }
    }
}
