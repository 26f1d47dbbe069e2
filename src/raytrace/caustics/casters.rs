//! The surfaces that cast caustics.

use crate::raytrace::aggregate::{Aggregate, Hit, Primitive};
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::simd::TriangleHit;
use glam::Vec2;

/// The triangles of mirrors and clear glass, with their distribution by area.
#[derive(Debug, Default)]
pub struct CausticCasters {
    /// Instance and triangle of each.
    triangles: Vec<(u32, u32)>,
    /// Cumulative areas, square metres.
    areas: Vec<f64>,
}

impl CausticCasters {
    /// All casters of a studio.
    pub fn new(aggregate: &Aggregate, materials: &[TracedMaterial]) -> Self {
        let mut casters = CausticCasters::default();
        let mut total = 0.0;
        for (index, instance) in (0..).zip(aggregate.instances()) {
            let casts: Vec<bool> =
                instance.materials.iter().map(|&m| materials[m as usize].is_caustic_caster()).collect();
            if !casts.contains(&true) {
                continue;
            }
            for triangle in 0..instance.geometry.mesh().triangles.len() as u32 {
                if !casts.get(instance.geometry.part(triangle)).copied().unwrap_or(false) {
                    continue;
                }
                let [a, b, c] = instance.world_corners(triangle as usize);
                let area = 0.5 * f64::from((b - a).cross(c - a).length());
                if area > 0.0 && area.is_finite() {
                    total += area;
                    casters.triangles.push((index, triangle));
                    casters.areas.push(total);
                }
            }
        }
        casters
    }

    /// Total area, square metres.
    pub fn area(&self) -> f32 {
        self.areas.last().copied().unwrap_or(0.0) as f32
    }

    /// Density of photons that start uniformly on the casters with directions of density `pdf`, at `cos` to the
    /// surface: in perpendicular area and solid angle, 1/(m2 sr).
    pub fn density(&self, pdf: f32, cos: f32) -> f32 {
        pdf / (self.area() * cos)
    }

    /// Samples a point, uniform in area, by numbers in [0, 1). None where there is no caster.
    pub fn sample(&self, choice: f32, u: Vec2) -> Option<Hit> {
        let area = f64::from(choice) * self.areas.last()?;
        let index = self.areas.partition_point(|&cumulative| cumulative <= area).min(self.triangles.len() - 1);
        let (instance, triangle) = self.triangles[index];
        // The square folded onto the triangle along its diagonal.
        let barycentric = if u.x + u.y < 1.0 { [u.x, u.y] } else { [1.0 - u.x, 1.0 - u.y] };
        let primitive = Primitive::Triangle(TriangleHit { t: 0.0, triangle, barycentric });
        Some(Hit { instance, t: 0.0, primitive })
    }
}
