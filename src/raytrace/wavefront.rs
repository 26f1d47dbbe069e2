//! The wavefront around a ray that is refracted at flat faces (generalised ray tracing: Kneisly 1964, "Local Curvature
//! of Wavefronts in an Optical System").

use crate::math::orthonormal_basis;
use glam::{Mat2, Vec2, Vec3};

/// The derivative of the position at which a ray arrives by its direction, both perpendicular to the direction outside
/// of bodies: the distance where there are none. Symmetric, so that it holds from both ends.
#[derive(Clone, Debug)]
pub struct Wavefront {
    direction: Vec3,
    /// Unit axes perpendicular to the direction.
    axes: [Vec3; 2],
    matrix: Mat2,
    /// Index of refraction relative to the outside of all bodies.
    index: f32,
}

impl Wavefront {
    /// Returns a wavefront at its start, for the unit direction of the ray outside of bodies.
    pub fn new(direction: Vec3) -> Self {
        let axes = orthonormal_basis(direction).into();
        Wavefront { direction, axes, matrix: Mat2::ZERO, index: 1.0 }
    }

    /// Returns the components of a vector along the axes.
    fn local(&self, w: Vec3) -> Vec2 {
        Vec2::new(w.dot(self.axes[0]), w.dot(self.axes[1]))
    }

    /// Propagates along a ray, outside of bodies or between faces of this normal. Between faces, the angle changes by a
    /// factor 1 / n, and in the plane of incidence by cos2 i / (n cos2 r).
    pub fn propagate(&mut self, distance: f32, ray_direction: Vec3, between: Option<Vec3>) {
        let reduced = distance / self.index;
        self.matrix += Mat2::from_diagonal(Vec2::splat(reduced));
        if let Some(normal) = between {
            let (cos_i, cos_r) = (self.direction.dot(normal), ray_direction.dot(normal));
            let tangent = self.local(normal).normalize_or_zero();
            let factor = (cos_i * cos_i) / (cos_r * cos_r).max(f32::MIN_POSITIVE) - 1.0;
            let outer = Mat2::from_cols(tangent * tangent.x, tangent * tangent.y);
            self.matrix += outer * (reduced * factor);
        }
    }

    /// Crosses a face into a medium of this relative index of refraction.
    pub fn refract(&mut self, eta: f32) {
        self.index *= eta;
    }

    /// Returns the area per solid angle, m2/sr: the squared distance where there are no bodies.
    pub fn area(&self) -> f32 {
        self.matrix.determinant()
    }

    /// Returns the direction whose ray arrives further by a vector: a step of Newton's method.
    pub fn correct(&self, direction: Vec3, miss: Vec3) -> Vec3 {
        let change = self.matrix.inverse() * self.local(miss);
        (direction + self.axes[0] * change.x + self.axes[1] * change.y).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slab_at_normal_incidence_brings_an_object_nearer_by_its_optical_thickness() {
        // 1 m of air, 0.3 m of glass, 1 m of air: the object appears at 2 + 0.3 / n.
        let mut wavefront = Wavefront::new(Vec3::Z);
        wavefront.propagate(1.0, Vec3::Z, None);
        wavefront.refract(1.5);
        wavefront.propagate(0.3, Vec3::Z, Some(Vec3::Z));
        wavefront.refract(1.0 / 1.5);
        wavefront.propagate(1.0, Vec3::Z, None);
        assert!((wavefront.area() - 2.2 * 2.2).abs() < 1e-5, "{}", wavefront.area());
        // Moved aside by 1 mm at a distance of 2.2 m.
        let corrected = wavefront.correct(Vec3::Z, Vec3::X * 1e-3);
        assert!((corrected.x - 1e-3 / 2.2).abs() < 1e-7, "{corrected}");
    }

    #[test]
    fn the_wavefront_is_the_derivative_of_the_refracted_ray() {
        // A slab of 0.2 m with normal Z between 1 m of air before and 0.5 m behind, at 60 degrees in the plane of X and Z.
        let n = 1.5_f64;
        let landing = |i: f64| i.tan() * 1.5 + ((i.sin() / n).asin()).tan() * 0.2;
        let i = 60_f64.to_radians();
        let r = (i.sin() / n).asin();
        let tangential = i.cos() * (landing(i + 1e-6) - landing(i - 1e-6)) / 2e-6;
        let sagittal = landing(i) / i.sin();
        let at = |angle: f64| Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32);
        let mut wavefront = Wavefront::new(at(i));
        wavefront.propagate((1.5 / i.cos()) as f32, at(i), None);
        wavefront.refract(n as f32);
        wavefront.propagate((0.2 / r.cos()) as f32, at(r), Some(Vec3::Z));
        let expected = (tangential * sagittal) as f32;
        assert!((wavefront.area() / expected - 1.0).abs() < 1e-5, "{} for {expected}", wavefront.area());
    }
}
