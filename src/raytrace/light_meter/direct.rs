//! Direct light at points on surfaces, light by light, with and without the shadows that fall there.

use super::meter::LightMeter;
use super::point::MeterPoint;
use super::receptor::ReceptorFrame;
use super::sampling::{DirectLight, sample_direct};
use crate::math::Ray;
use crate::raytrace::geometry::PassedBodies;
use crate::raytrace::lights::TracedLight;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::ray_filter::RayFilter;
use crate::raytrace::sampler::{self, Dimensions, Sampler};
use crate::scene::{LightId, Receptor};
use glam::Vec3;

/// A point on a surface of the studio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint<'a> {
    /// Index into the scene's objects; none for the room.
    pub object: Option<u32>,
    /// Name of the part of its mesh.
    pub part: &'a str,
    /// World position, metres.
    pub position: Vec3,
    /// Unit shading normal, world space, on the side of the ray.
    pub normal: Vec3,
}

/// A light that is on and has any output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeteredSource {
    /// The light.
    pub light: LightId,
    /// Time by which its illuminance counts in the exposure, seconds: the shutter for continuous light, 1 for flash.
    pub exposure_time_s: f32,
}

impl LightMeter {
    /// Returns the lights that [`LightMeter::direct_light`] can read, in its order.
    pub fn sources(&self) -> impl Iterator<Item = MeteredSource> + '_ {
        self.studio.lights.iter().map(|light| MeteredSource {
            light: light.id,
            exposure_time_s: if light.blank.flash { 1.0 } else { self.studio.shutter_s },
        })
    }

    /// Returns the first surface within `length_m` of a ray in world space. Bodies of lights do not count.
    pub fn first_surface(&self, origin: Vec3, direction: Vec3, length_m: f32) -> Option<SurfacePoint<'_>> {
        let scene = &self.studio.scene;
        let ray = Ray { origin: origin - scene.origin, direction, t_max: length_m };
        let hit = RayCaster::new(scene).intersect_filtered(&ray, RayFilter::seen(PassedBodies::All))?;
        let surface = scene.surface(&ray, &hit);
        let (object, part) = scene.object_and_part(&hit);
        let normal = surface.facing_normal(direction);
        Some(SurfacePoint { object, part, position: surface.position + scene.origin, normal })
    }

    /// Returns the direct light of one of [`LightMeter::sources`] at a point, from `samples` points of its emitter. A
    /// surround counts as no light: it casts no shadow with an edge. `stream` numbers the point: points of different
    /// numbers have independent samples.
    pub fn direct_light(&self, source: usize, point: &MeterPoint, samples: u32, stream: u32) -> DirectLight {
        let mut sum = DirectLight::default();
        let Some(light) = self.studio.scene.lights.get(source).filter(|light| light.is_sampled()) else { return sum };
        let receptor = ReceptorFrame::new(point, &self.studio.scene);
        let mut caster = RayCaster::new(&self.studio.scene);
        // One sample of a delta light is exact.
        let samples = if light.is_delta() { 1 } else { samples.max(1) };
        for index in 0..samples {
            let sampler = Sampler::new(stream, 1 + source as u32, index, 0);
            let direct = sample_direct(&receptor, &mut caster, light, &sampler);
            sum.arriving += direct.arriving / samples as f32;
            sum.unshadowed += direct.unshadowed / samples as f32;
        }
        sum
    }

    /// Returns unit directions in world space from a point to parts of a light's emitter that shine on the point, out of
    /// `samples`; none from a surround. `facing` is the normal of the surface that the point is on.
    pub fn open_directions(&self, source: usize, position: Vec3, facing: Vec3, samples: u32) -> Vec<Vec3> {
        let scene = &self.studio.scene;
        let Some(light) = scene.lights.get(source).filter(|light| light.is_sampled()) else { return Vec::new() };
        let samples = if light.is_delta() { 1 } else { samples.max(1) };
        let mut caster = RayCaster::new(scene);
        let point = MeterPoint { position, facing, receptor: Receptor::Flat };
        let origin = ReceptorFrame::new(&point, scene).origin;
        let direction = |index| {
            let set = Sampler::new(0, 1 + source as u32, index, 0).set(Dimensions::Camera);
            let sample = light.sample(position - scene.origin, sampler::first_pair(&set))?;
            let is_above = sample.direction.dot(facing) > 0.0;
            let connection = is_above.then(|| caster.connect(origin, light, &sample, MediumStack::default()))??;
            (connection.value > 0.0).then_some(sample.direction)
        };
        (0..samples).filter_map(direction).collect()
    }

    /// Returns the unit direction in world space from a point to the middle of a light's emitter, or to a sun; none for
    /// a surround.
    pub fn direction_to(&self, source: usize, position: Vec3) -> Option<Vec3> {
        let scene = &self.studio.scene;
        let towards = |light: &TracedLight| light.sample_centre(position - scene.origin).map(|s| s.direction);
        scene.lights.get(source).and_then(towards)
    }
}
