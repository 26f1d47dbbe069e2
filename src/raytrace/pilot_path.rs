//! Pilot paths: camera paths that find surfaces and gather no light, for what is learned about a picture beforehand.

use super::aggregate::Hit;
use super::bsdf::{Bsdf, Polarisation};
use super::geometry::SurfaceInteraction;
use super::irradiance_cache::Footprint;
use super::medium_stack::MediumStack;
use super::ray_caster::RayCaster;
use super::ray_filter::RayFilter;
use super::sampler::{self, Dimensions, Sampler};
use crate::math::Ray;
use glam::Vec3;

/// The pixels of pilot paths: one of so many across and down.
#[derive(Clone, Copy, Debug)]
pub struct PilotRaster {
    size: (u32, u32),
    /// Distance between two of them, pixels; less than 1 where several paths share a pixel.
    pub stride: f64,
    /// Number across, at least one.
    pub across: u32,
    /// Number down, at least one.
    pub down: u32,
}

impl PilotRaster {
    /// Returns about so many pixels of a picture.
    pub fn new((width, height): (u32, u32), paths: u32) -> Self {
        let stride = (f64::from(width) * f64::from(height) / f64::from(paths)).sqrt();
        let along = |pixels: u32| ((f64::from(pixels) / stride) as u32).max(1);
        PilotRaster { size: (width, height), stride, across: along(width), down: along(height) }
    }

    /// Returns the pixel of a place in the raster.
    pub fn pixel(&self, x: u32, y: u32) -> (u32, u32) {
        let at =
            |place: u32, pixels: u32| (((f64::from(place) + 0.5) * self.stride) as u32).min(pixels.saturating_sub(1));
        (at(x, self.size.0), at(y, self.size.1))
    }
}

/// A vertex of a pilot path.
#[derive(Debug)]
pub struct PilotVertex<'a> {
    /// The intersection.
    pub hit: &'a Hit,
    /// The surface.
    pub surface: &'a SurfaceInteraction,
    /// Its BSDF towards the last vertex.
    pub bsdf: &'a Bsdf<'a>,
    /// Unit direction towards the last vertex.
    pub wo: Vec3,
    /// Length of the way from the camera, metres.
    pub travelled: f32,
    /// The part of the surface that the last sample stands for; none after specular scattering.
    pub footprint: Footprint,
    /// Radiance that the path carries per radiance at its end.
    pub throughput: Vec3,
    /// Non-specular vertices before it.
    pub non_specular_depth: u32,
}

/// Follows a path from the camera, specular or not, past at most `max_scatterings` non-specular vertices. Calls `found`
/// with each vertex.
pub fn trace(
    caster: &mut RayCaster<'_>,
    (origin, direction): (Vec3, Vec3),
    sampler: &Sampler,
    max_scatterings: u32,
    mut found: impl FnMut(&PilotVertex<'_>),
) {
    let scene = caster.scene;
    let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
    let (mut media, mut polarisation) = (MediumStack::default(), Polarisation::NONE);
    let (mut travelled, mut throughput, mut non_specular_depth) = (0.0, Vec3::ONE, 0);
    let mut solid_angle = 0.0;
    for depth in 0..scene.plan().max_depth {
        let Some(hit) = caster.intersect_filtered(&ray, RayFilter::of_path(depth, non_specular_depth)) else { return };
        let surface = &scene.surface(&ray, &hit);
        let wo = -ray.direction;
        let bsdf = &scene.bsdf(scene.material_of(surface), surface, wo, &media, polarisation);
        travelled += hit.t;
        let footprint = Footprint::new(solid_angle, hit.t, wo.dot(surface.geometric_normal));
        found(&PilotVertex { hit: &hit, surface, bsdf, wo, travelled, footprint, throughput, non_specular_depth });
        let set = sampler.set(Dimensions::Bsdf { depth });
        let Some(sample) = bsdf.sample(sampler::last_pair(&set)[0], sampler::first_pair(&set)) else { return };
        if !sample.specular {
            non_specular_depth += 1;
            if non_specular_depth > max_scatterings {
                return;
            }
        }
        if sample.is_transmission && !surface.is_thin {
            media.cross(surface.material, wo.dot(surface.geometric_normal) >= 0.0);
        }
        polarisation = sample.polarisation;
        throughput *= sample.weight;
        solid_angle = if sample.specular { 0.0 } else { 1.0 / sample.pdf };
        ray = Ray { origin: surface.spawn_origin(sample.direction), direction: sample.direction, t_max: f32::INFINITY };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_narrower_than_the_stride_has_pilot_paths_too() {
        for size in [(1, 1000), (1000, 1), (3, 4000)] {
            let raster = PilotRaster::new(size, 16);
            assert!(raster.stride > f64::from(size.0.min(size.1)));
            assert!(raster.across * raster.down >= 16, "{raster:?}");
            let (x, y) = raster.pixel(raster.across - 1, raster.down - 1);
            assert!(x < size.0 && y < size.1, "{raster:?}");
        }
        let raster = PilotRaster::new((60, 40), 24);
        assert_eq!((raster.across, raster.down, raster.pixel(0, 0), raster.pixel(5, 3)), (6, 4, (5, 5), (55, 35)));
    }
}
