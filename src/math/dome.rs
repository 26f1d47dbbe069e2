//! A clear dome over a flat picture, as the cornea lies over the iris and a paperweight over its motif.

use super::safe_sqrt;
use glam::{Mat3, Vec2, Vec3};

/// Least downward part of a ray's direction inside the dome: a flatter one meets the base far away.
const LEAST_DESCENT: f32 = 0.05;

/// A cap of a clear sphere whose flat base shows a picture. Lengths are in radii of the base; the picture is the square
/// around the base. Points on the dome and on the base are projected along its axis: (0, 0) is the middle, (1, 0) the end
/// of U, (0, 1) that of V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dome {
    /// Radius of the sphere, at least 1, that of half a ball.
    pub radius: f32,
    /// Index of refraction.
    pub ior: f32,
}

impl Dome {
    /// Returns the texture coordinates that are seen at those of the dome, and world from base, whose axes are U, V and out
    /// of the picture. `frame` is the tangent frame of the surface in the world, `view_dir` the unit direction to the viewer.
    pub fn seen(&self, uv: Vec2, frame: Mat3, view_dir: Vec3) -> (Vec2, Mat3) {
        let point = Dome::point_at(uv);
        (self.seen_uv(point, frame.transpose() * view_dir), frame * self.frame(point).transpose())
    }

    /// Returns the point on the dome at texture coordinates, inside of its edge.
    fn point_at(uv: Vec2) -> Vec2 {
        (uv * 2.0 - Vec2::ONE).clamp_length_max(0.999)
    }

    /// Returns the distance of a point on the dome from the plane through the sphere's centre.
    fn above_centre(&self, point: Vec2) -> f32 {
        safe_sqrt(self.radius * self.radius - point.length_squared())
    }

    /// Returns the tangent frame of the dome at a point: a tangent along U, one across it along V, and the normal, in the
    /// axes U, V and out of the picture.
    pub fn frame(&self, point: Vec2) -> Mat3 {
        let above = self.above_centre(point);
        let normal = point.extend(above) / self.radius;
        let along_u = Vec3::new(above, 0.0, -point.x).normalize_or(Vec3::X);
        Mat3::from_cols(along_u, normal.cross(along_u), normal)
    }

    /// Returns the texture coordinates that are seen at a point on the dome; beyond the base those of its edge. `view_dir` is
    /// the unit direction to the viewer in the tangent frame of that point.
    pub fn seen_uv(&self, point: Vec2, view_dir: Vec3) -> Vec2 {
        let aside = view_dir.truncate() / self.ior;
        let refracted = self.frame(point) * (-aside).extend(-safe_sqrt(1.0 - aside.length_squared()));
        let height = self.above_centre(point) - safe_sqrt(self.radius * self.radius - 1.0);
        let seen = point + refracted.truncate() * (height.max(0.0) / (-refracted.z).max(LEAST_DESCENT));
        seen.clamp_length_max(1.0) * 0.5 + Vec2::splat(0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// That of the eye.
    const DOME: Dome = Dome { radius: 1.322, ior: 1.38 };

    fn height() -> f32 {
        DOME.radius - (DOME.radius * DOME.radius - 1.0).sqrt()
    }

    #[test]
    fn the_view_from_aside_is_refracted_by_snells_law() {
        for degrees in [0.0_f32, 20.0, 45.0, 60.0] {
            let view_dir = Vec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
            let seen = DOME.seen_uv(Vec2::ZERO, view_dir) * 2.0 - Vec2::ONE;
            let refracted = (degrees.to_radians().sin() / DOME.ior).asin();
            assert!(seen.distance(Vec2::new(-height() * refracted.tan(), 0.0)) < 1e-5, "{degrees}: {seen}");
        }
    }

    #[test]
    fn from_the_front_it_magnifies_as_a_thick_lens() {
        // Paraxial: a ray at height y is refracted by y / R (1 - 1 / n), and meets the base below it by `height`
        let expected = 1.0 - height() * (DOME.ior - 1.0) / (DOME.ior * DOME.radius);
        for direction in [Vec2::X, Vec2::Y, Vec2::new(-0.6, 0.8)] {
            let point = direction * 0.02;
            let view_dir = DOME.frame(point).transpose() * Vec3::Z;
            let seen = DOME.seen_uv(point, view_dir) * 2.0 - Vec2::ONE;
            assert!((seen / 0.02).distance(direction * expected) < 1e-3, "{seen} instead of {}", point * expected);
        }
    }

    #[test]
    fn a_dome_without_refraction_shows_what_lies_behind_in_a_straight_line_and_no_more_than_its_base() {
        let dome = Dome { ior: 1.0, ..DOME };
        let view = Vec3::new(0.3, -0.2, 1.0).normalize();
        for point in [Vec2::new(0.3, 0.1), Vec2::new(-0.5, 0.2), Vec2::new(0.0, -0.6)] {
            let frame = dome.frame(point);
            assert!((frame.transpose() * frame).abs_diff_eq(Mat3::IDENTITY, 1e-5) && frame.determinant() > 0.0);
            let seen = dome.seen_uv(point, frame.transpose() * view) * 2.0 - Vec2::ONE;
            let depth = (dome.radius * dome.radius - point.length_squared()).sqrt() - (dome.radius - height());
            assert!(seen.distance(point - view.truncate() * (depth / view.z)) < 1e-5, "{point}: {seen}");
        }
        for point in [Vec2::new(0.9, 0.0), Dome::point_at(Vec2::new(7.0, -3.0))] {
            let seen = DOME.seen_uv(point, Vec3::new(-0.9, 0.0, 0.19_f32.sqrt()));
            assert!((seen * 2.0 - Vec2::ONE).length() <= 1.00001, "{seen}");
        }
    }
}
