//! A distance field split into cubes, each with only the primitives near it.

use super::field::Field;
use glam::{IVec3, Vec3};
use rayon::prelude::*;

/// Edge of a cube, metres.
const CUBE_M: f32 = 0.03;

/// The content of a cube.
enum CubeContent {
    /// Far from the surface; the sign of the distance is right in the whole cube.
    Far(f32),
    /// The field's primitives near the cube.
    Near(Field),
}

/// A distance field with fast evaluation near its surface.
pub struct CulledField {
    low: Vec3,
    count: IVec3,
    cubes: Vec<CubeContent>,
}

impl CulledField {
    /// Splits the box from `low` to `high` into cubes; outside of it the field is empty.
    pub fn new(field: &Field, low: Vec3, high: Vec3) -> CulledField {
        let count = ((high - low) / CUBE_M).ceil().as_ivec3().max(IVec3::ONE);
        // Half the diagonal, and the steps of a finite difference.
        let radius = CUBE_M * 0.87 + 0.001;
        let cubes = (0..count.element_product())
            .into_par_iter()
            .map(|i| {
                let cell = IVec3::new(i % count.x, i / count.x % count.y, i / (count.x * count.y));
                let center = low + (cell.as_vec3() + 0.5) * CUBE_M;
                let d = field.distance(center);
                // Three times the radius: brushes move the surface, and ellipsoids may overestimate their distance.
                if d.abs() > 3.0 * radius { CubeContent::Far(d) } else { CubeContent::Near(field.cull(center, radius)) }
            })
            .collect();
        CulledField { low, count, cubes }
    }

    fn content(&self, p: Vec3) -> Option<&CubeContent> {
        let cell = ((p - self.low) / CUBE_M).floor().as_ivec3();
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.count).all();
        let index = cell.x + self.count.x * (cell.y + self.count.y * cell.z);
        if inside { self.cubes.get(index as usize) } else { None }
    }

    /// Returns the signed distance, metres. Far from the surface only its sign is right.
    pub fn distance(&self, p: Vec3) -> f32 {
        match self.content(p) {
            Some(CubeContent::Near(field)) => field.distance(p),
            Some(CubeContent::Far(d)) => *d,
            None => CUBE_M,
        }
    }

    /// Returns distance and gradient; both zero far from the surface.
    pub fn sample(&self, p: Vec3) -> (f32, Vec3) {
        match self.content(p) {
            Some(CubeContent::Near(field)) => (field.distance(p), field.gradient(p)),
            _ => (0.0, Vec3::ZERO),
        }
    }

    /// Returns a point of the surface near `p`, by Newton steps along the gradient.
    pub fn project(&self, p: Vec3, steps: u32) -> Vec3 {
        (0..steps).fold(p, |p, _| {
            let (d, g) = self.sample(p);
            let length_sq = g.length_squared();
            // The gradient is small in a crease, which a full step would jump across.
            if length_sq < 0.05 { p } else { p - g * (d / length_sq).clamp(-0.003, 0.003) }
        })
    }
}
