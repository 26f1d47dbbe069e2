//! The pixel sampler: from a pixel and a sample index to a camera ray, a traced path, and its contributions.

use super::lens::{PixelCamera, camera_ray};
use super::limits::PathLimits;
use super::path_tracer::PathTracer;
use super::sampler::{SampleId, Sampler};
use super::settings::Method;
use super::sink::RadianceSink;
use super::whitted;

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
