//! The field cut into cubes, each with only the shapes that matter there.

use super::field::Field;
use glam::{IVec3, Vec3};
use rayon::prelude::*;

/// Edge of a cube, metres.
const CUBE_M: f32 = 0.03;

/// What is in a cube.
enum Content {
    /// The surface is somewhere else; the sign says on which side the cube lies.
    Plain(f32),
    /// The shapes that matter here.
    Near(Field),
}

/// A field that is quick to sample near its surface.
pub struct Cubes {
    low: Vec3,
    count: IVec3,
    cubes: Vec<Content>,
}

impl Cubes {
    /// Cuts up the box from `low` to `high`; outside it the field counts as empty space.
    pub fn new(field: &Field, low: Vec3, high: Vec3) -> Cubes {
        let count = ((high - low) / CUBE_M).ceil().as_ivec3().max(IVec3::ONE);
        // Half the diagonal, and room for the steps of a gradient.
        let radius = CUBE_M * 0.87 + 0.001;
        let cubes = (0..count.element_product())
            .into_par_iter()
            .map(|i| {
                let cell = IVec3::new(i % count.x, i / count.x % count.y, i / (count.x * count.y));
                let center = low + (cell.as_vec3() + 0.5) * CUBE_M;
                let d = field.distance(center);
                // Three times the radius: brushes move the surface, and ellipsoids may overstate their distance.
                if d.abs() > 3.0 * radius { Content::Plain(d) } else { Content::Near(field.cull(center, radius)) }
            })
            .collect();
        Cubes { low, count, cubes }
    }

    fn content(&self, p: Vec3) -> Option<&Content> {
        let cell = ((p - self.low) / CUBE_M).floor().as_ivec3();
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(self.count).all();
        let index = cell.x + self.count.x * (cell.y + self.count.y * cell.z);
        if inside { self.cubes.get(index as usize) } else { None }
    }

    /// Signed distance, exact near the surface; elsewhere only its sign is right.
    pub fn distance(&self, p: Vec3) -> f32 {
        match self.content(p) {
            Some(Content::Near(field)) => field.distance(p),
            Some(Content::Plain(d)) => *d,
            None => CUBE_M,
        }
    }

    /// Distance and gradient; both zero away from the surface.
    pub fn sample(&self, p: Vec3) -> (f32, Vec3) {
        match self.content(p) {
            Some(Content::Near(field)) => (field.distance(p), field.gradient(p)),
            _ => (0.0, Vec3::ZERO),
        }
    }

    /// The point of the surface near `p`, by Newton steps along the gradient.
    pub fn project(&self, p: Vec3, steps: u32) -> Vec3 {
        (0..steps).fold(p, |p, _| {
            let (d, g) = self.sample(p);
            let length_sq = g.length_squared();
            // A weak gradient means a crease: a full step would jump across it.
            if length_sq < 0.05 { p } else { p - g * (d / length_sq).clamp(-0.003, 0.003) }
        })
    }
}
