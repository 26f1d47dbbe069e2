//! The pixel sampler: from a pixel and a sample index to a camera ray, a traced path, and its contributions.

use super::lens::PixelCamera;
use super::limits::PathLimits;
use super::path_tracer::PathTracer;
use super::sampler::{self, Dimensions, SampleId, Sampler};
use super::settings::Method;
use super::sink::RadianceSink;
use super::whitted;
use glam::{Vec2, Vec3};

/// Traces samples of pixels for one thread.
#[derive(Debug)]
pub struct PixelSampler<'a, C> {
    /// Traces the paths.
    pub tracer: PathTracer<'a>,
    /// Makes the camera rays.
    pub camera: &'a C,
    /// Rendering method.
    pub method: Method,
    /// Limits of the paths.
    pub limits: PathLimits,
}

impl<C: PixelCamera> PixelSampler<'_, C> {
    /// Traces one sample of a pixel and adds its contributions to `sink`.
    pub fn sample(&mut self, sample: SampleId, sink: &mut impl RadianceSink) {
        let sampler = Sampler::of(sample);
        let (origin, direction) = camera_ray(self.camera, &sampler);
        match self.method {
            Method::Whitted => {
                whitted::trace(&mut self.tracer.caster, origin, direction, self.limits.max_depth, sink);
            }
            Method::Direct | Method::Path => self.tracer.trace(origin, direction, &sampler, self.limits, sink),
        }
    }
}

/// Origin and unit direction of the camera ray of a sample.
pub fn camera_ray(camera: &impl PixelCamera, sampler: &Sampler) -> (Vec3, Vec3) {
    let SampleId { x, y, .. } = sampler.id();
    let set = sampler.set(Dimensions::Camera);
    camera.ray(Vec2::new(x as f32, y as f32) + sampler::first_pair(&set), sampler::last_pair(&set).into())
}
