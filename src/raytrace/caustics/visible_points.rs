//! The surfaces on which the camera sees caustics: a coarse raster of camera paths to their non-specular vertices.

use super::grid::{HashGrid, Positioned};
use crate::math::quantile;
use crate::raytrace::lens::{PixelCamera, camera_ray};
use crate::raytrace::pilot_path::{self, PilotRaster, PilotVertex};
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::Sampler;
use glam::Vec3;
use std::collections::BTreeMap;

/// Radius around a point that counts as visible, in distances between neighbouring camera rays.
const RADIUS_SPACINGS: f32 = 0.75;
/// Least cosine to the surface by which this radius is divided.
const MIN_COSINE: f32 = 0.2;

/// Points on non-specular surfaces that the camera sees directly or through specular surfaces.
#[derive(Debug, Default)]
pub struct VisiblePoints(Vec<VisiblePoint>);

/// The surroundings of visible points.
#[derive(Debug)]
pub struct Surroundings {
    /// A grid for each power of two of the points' radii.
    grids: Vec<PointGrid>,
}

/// Points of about the same radius.
#[derive(Debug)]
struct PointGrid {
    points: HashGrid<VisiblePoint>,
    /// Their greatest radius, metres.
    radius: f32,
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

impl Positioned for VisiblePoint {
    fn position(&self) -> Vec3 {
        self.position
    }
}

impl VisiblePoints {
    /// Traces about so many camera paths of a picture.
    pub fn trace(scene: &RenderScene, camera: &impl PixelCamera, paths: u32) -> Self {
        let (width, height) = camera.size();
        let raster = PilotRaster::new((width, height), paths.min(width.saturating_mul(height)));
        let spacing = raster.stride as f32 * camera.pixel_m();
        let mut points = Vec::new();
        let mut caster = RayCaster::new(scene);
        for cell in 0..raster.across * raster.down {
            let (x, y) = raster.pixel(cell % raster.across, cell / raster.across);
            let sampler = Sampler::new(x, y, 0, 0);
            pilot_path::trace(&mut caster, camera_ray(camera, &sampler), &sampler, 0, |vertex| {
                let PilotVertex { surface, wo, travelled: distance, .. } = *vertex;
                if surface.strand.is_none() && scene.materials[surface.material as usize].has_non_specular_lobe() {
                    let cos = wo.dot(surface.geometric_normal).abs();
                    let radius = RADIUS_SPACINGS * spacing * distance / cos.max(MIN_COSINE);
                    points.push(VisiblePoint { position: surface.position, distance, radius });
                }
            });
        }
        VisiblePoints(points)
    }

    /// Returns the distance below which there is this share of the points, metres; 0 without points.
    pub fn distance_quantile(&self, share: f32) -> f32 {
        let mut distances: Vec<f32> = self.0.iter().map(|point| point.distance).collect();
        quantile(&mut distances, share)
    }

    /// Returns the points.
    #[cfg(test)]
    pub fn points(&self) -> &[VisiblePoint] {
        &self.0
    }

    /// Returns the surroundings of the points: all within their radii, times a factor.
    pub fn surroundings(&self, factor: f32) -> Surroundings {
        Surroundings::new(self.0.iter().map(|point| VisiblePoint { radius: factor * point.radius, ..*point }))
    }
}

impl Surroundings {
    /// The surroundings of points.
    fn new(points: impl Iterator<Item = VisiblePoint>) -> Self {
        let mut by_power: BTreeMap<i32, Vec<VisiblePoint>> = BTreeMap::new();
        for point in points {
            let power = point.radius.max(f32::MIN_POSITIVE).log2().ceil() as i32;
            by_power.entry(power).or_default().push(point);
        }
        let grid = |(power, points): (i32, Vec<VisiblePoint>)| {
            let radius = (power as f32).exp2();
            PointGrid { points: HashGrid::new(&points, radius), radius }
        };
        Surroundings { grids: by_power.into_iter().map(grid).collect() }
    }

    /// Returns true if a position is near a visible point.
    pub fn contains(&self, position: Vec3) -> bool {
        let near = |grid: &PointGrid| {
            grid.points.near(position, grid.radius).any(|(point, distance2)| distance2 < point.radius * point.radius)
        };
        self.grids.iter().any(near)
    }
}
