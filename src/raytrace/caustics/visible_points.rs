//! The surfaces on which the camera sees caustics: a coarse grid of camera paths to their first non-specular vertices.

use crate::math::Ray;
use crate::raytrace::bsdf::Polarisation;
use crate::raytrace::lens::PixelCamera;
use crate::raytrace::lens::camera_ray;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::{self, Dimensions, Sampler};
use glam::{IVec3, Vec3};
use std::collections::HashMap;

/// Radius around a point that counts as visible, in distances between neighbouring camera rays.
const RADIUS_SPACINGS: f32 = 0.75;
/// Least cosine to the surface by which this radius is divided.
const MIN_COSINE: f32 = 0.2;

/// The pixels of a picture.
#[derive(Debug)]
pub struct PixelRaster<'a, C> {
    /// Makes the camera rays.
    pub camera: &'a C,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Width of a pixel at 1 m, metres.
    pub pixel_m: f32,
}

/// Points on non-specular surfaces that the camera sees directly or through specular surfaces.
#[derive(Debug, Default)]
pub struct VisiblePoints(Vec<VisiblePoint>);

/// The surroundings of visible points.
#[derive(Debug, Default)]
pub struct Surroundings {
    points: Vec<VisiblePoint>,
    /// Points by the cells that their surroundings overlap. A cell is at least twice as wide as the radius of its points:
    /// there is a grid for each power of two.
    cells: HashMap<(i32, IVec3), Vec<u32>>,
    /// The powers of two that occur: widths of the cells, metres.
    widths: Vec<i32>,
}

/// A visible point.
#[derive(Clone, Copy, Debug)]
pub struct VisiblePoint {
    /// Position, in the tracer's space.
    pub position: Vec3,
    /// Length of the way from the camera, metres.
    pub distance: f32,
    /// Radius around it that is visible, too, metres.
    radius: f32,
}

impl VisiblePoints {
    /// Traces about so many camera paths of a picture.
    pub fn trace(scene: &RenderScene, raster: &PixelRaster<'_, impl PixelCamera>, paths: u32) -> Self {
        let PixelRaster { camera, size: (width, height), pixel_m } = *raster;
        // One pixel of so many across and down
        let stride = (f64::from(width) * f64::from(height) / f64::from(paths)).sqrt().max(1.0);
        let across = (f64::from(width) / stride) as u32;
        let down = (f64::from(height) / stride) as u32;
        let spacing = stride as f32 * pixel_m;
        let mut points = Vec::new();
        let mut caster = RayCaster::new(scene);
        for cell in 0..across * down {
            let at = |index: u32| ((f64::from(index) + 0.5) * stride) as u32;
            let sampler = Sampler::new(at(cell % across), at(cell / across), 0, 0);
            let (origin, direction) = camera_ray(camera, &sampler);
            trace_path(&mut caster, origin, direction, &sampler, |position, distance, cos| {
                let radius = RADIUS_SPACINGS * spacing * distance / cos.max(MIN_COSINE);
                points.push(VisiblePoint { position, distance, radius });
            });
        }
        VisiblePoints(points)
    }

    /// The distance below which there is this share of the points, metres; 0 without points.
    pub fn distance_quantile(&self, share: f32) -> f32 {
        let mut distances: Vec<f32> = self.0.iter().map(|point| point.distance).collect();
        let n = ((distances.len() as f32 * share) as usize).min(distances.len().saturating_sub(1));
        if distances.is_empty() { 0.0 } else { *distances.select_nth_unstable_by(n, f32::total_cmp).1 }
    }

    /// The points.
    #[cfg(test)]
    pub fn points(&self) -> &[VisiblePoint] {
        &self.0
    }

    /// What is within the radii of the points, times a factor.
    pub fn surroundings(&self, factor: f32) -> Surroundings {
        let mut surroundings = Surroundings::default();
        self.0.iter().for_each(|point| surroundings.add(VisiblePoint { radius: factor * point.radius, ..*point }));
        surroundings
    }
}

impl Surroundings {
    /// Returns true if a position is near a visible point.
    pub fn contains(&self, position: Vec3) -> bool {
        let near = |index: &u32| {
            let point = self.points[*index as usize];
            point.position.distance_squared(position) <= point.radius * point.radius
        };
        self.widths.iter().any(|&width| {
            let cell = (position / (width as f32).exp2()).floor().as_ivec3();
            self.cells.get(&(width, cell)).is_some_and(|points| points.iter().any(near))
        })
    }

    fn add(&mut self, point: VisiblePoint) {
        let width = (2.0 * point.radius).max(f32::MIN_POSITIVE).log2().ceil() as i32;
        if !self.widths.contains(&width) {
            self.widths.push(width);
        }
        let cell = |offset: f32| ((point.position + offset) / (width as f32).exp2()).floor().as_ivec3();
        let (low, high) = (cell(-point.radius), cell(point.radius));
        let index = self.points.len() as u32;
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    self.cells.entry((width, IVec3::new(x, y, z))).or_default().push(index);
                }
            }
        }
        self.points.push(point);
    }
}

/// Follows a camera path through specular surfaces. Calls `found` with the position, the length of the way and the
/// cosine to the surface of each non-specular vertex.
fn trace_path(
    caster: &mut RayCaster<'_>,
    origin: Vec3,
    direction: Vec3,
    sampler: &Sampler,
    mut found: impl FnMut(Vec3, f32, f32),
) {
    let scene = caster.scene;
    let mut ray = Ray { origin, direction, t_max: f32::INFINITY };
    let (mut media, mut polarisation, mut travelled) = (MediumStack::default(), Polarisation::NONE, 0.0);
    for depth in 0..scene.plan().max_depth {
        let Some(hit) = caster.intersect(&ray) else { return };
        let surface = scene.aggregate.surface(&hit);
        travelled += hit.t;
        let wo = -ray.direction;
        let cos = wo.dot(surface.geometric_normal);
        if surface.strand.is_none() && scene.materials[surface.material as usize].has_non_specular_lobe() {
            found(surface.position, travelled, cos.abs());
        }
        let set = sampler.set(Dimensions::Bsdf { depth });
        let bsdf = scene.bsdf(&surface, wo, &media, polarisation);
        let sample = bsdf.sample(sampler::last_pair(&set)[0], sampler::first_pair(&set));
        let Some(sample) = sample.filter(|sample| sample.specular) else { return };
        if sample.is_transmission && !surface.is_thin {
            media.cross(surface.material, cos >= 0.0);
        }
        polarisation = sample.polarisation;
        ray = Ray { origin: surface.spawn_origin(sample.direction), direction: sample.direction, t_max: f32::INFINITY };
    }
}
