//! Directions to a rectangle, uniform in solid angle (Urena, Fajardo and King 2013, "An Area-Preserving
//! Parametrization for Spherical Rectangles").

use crate::math::safe_sqrt;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A flat rectangle: centre, unit axes, half sizes. It shines along `right x up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Centre.
    pub centre: Vec3,
    /// Unit vector along the width.
    pub right: Vec3,
    /// Unit vector along the height.
    pub up: Vec3,
    /// Half width and half height, metres.
    pub half: Vec2,
    /// Half the diagonal, metres.
    pub reach: f32,
    /// The direction it faces.
    normal: Vec3,
}

/// Below this solid angle (sr) the spherical formulas lose their digits (1e-4 of the light here), and sampling by area is
/// as good.
const SMALL: f32 = 4e-3;

/// From farther than so many half diagonals off its plane, too: its points are about as far, and seen under about the same
/// angle (within 20 % at the corners), so that the spherical formulas buy less than they cost.
const FAR: f32 = 2.5;

/// The rectangle as seen from a point.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRect<'a> {
    rect: &'a Rect,
    /// Corner and opposite corner in the local frame; `z` is minus the distance to the plane.
    low: Vec2,
    high: Vec2,
    z: f32,
    axis_z: Vec3,
    /// Cosines of the lower and upper edge planes.
    b0: f32,
    b1: f32,
    k: f32,
    /// Solid angle, sr; 0 where it is not needed.
    pub solid_angle: f32,
}

impl Rect {
    /// From its centre, unit axes and half sizes.
    pub fn new(centre: Vec3, right: Vec3, up: Vec3, half: Vec2) -> Self {
        Rect { centre, right, up, half, reach: half.length(), normal: right.cross(up) }
    }

    /// The direction it faces.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Area, m2.
    pub fn area(&self) -> f32 {
        4.0 * self.half.x * self.half.y
    }

    /// Distance at which a ray crosses it, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let normal = self.normal();
        let slope = direction.dot(normal);
        let t = (self.centre - origin).dot(normal) / slope;
        let local = origin + direction * t - self.centre;
        let inside = local.dot(self.right).abs() <= self.half.x && local.dot(self.up).abs() <= self.half.y;
        (slope != 0.0 && t > 0.0 && inside).then_some(t)
    }

    /// How the rectangle looks from `point`.
    pub fn seen_from(&self, point: Vec3) -> SphericalRect<'_> {
        let d = self.centre - point;
        let mut axis_z = self.normal();
        let mut z = d.dot(axis_z);
        if z > 0.0 {
            axis_z = -axis_z;
            z = -z;
        }
        let middle = Vec2::new(d.dot(self.right), d.dot(self.up));
        let (low, high) = (middle - self.half, middle + self.half);
        if -z > FAR * self.reach {
            return SphericalRect { rect: self, low, high, z, axis_z, b0: 0.0, b1: 0.0, k: 0.0, solid_angle: 0.0 };
        }
        // The angles add up to 2 pi and the solid angle. Each pair is known but for a full turn, which k can do
        // without. From closer than some micrometres the whole half space may be taken for nothing: it is then sampled
        // by area, as anything small.
        let (edge0, edge1) = (EdgePlane::new(-low.y, z), EdgePlane::new(high.x, z));
        let (edge2, edge3) = (EdgePlane::new(high.y, z), EdgePlane::new(-low.x, z));
        let upper = sum_of_angles(edge2.corner(edge3), edge3.corner(edge0));
        let excess = sum_of_angles(edge0.corner(edge1), edge1.corner(edge2)) + upper;
        let turned = if excess < -1e-5 { excess + TAU } else { excess };
        let solid_angle = if turned > TAU - 1e-5 { 0.0 } else { turned.max(0.0) };
        let (b0, b1, k) = (edge0.cos, edge2.cos, -upper);
        SphericalRect { rect: self, low, high, z, axis_z, b0, b1, k, solid_angle }
    }
}

/// The plane through the viewer and an edge of the rectangle: cosine between its normal and the rectangle's, and the
/// square of the sine, which keeps its digits where the rectangle is seen edge-on.
#[derive(Clone, Copy, Debug)]
struct EdgePlane {
    cos: f32,
    sin2: f32,
}

impl EdgePlane {
    /// Of the edge at `offset` in the rectangle's plane, `z` away.
    fn new(offset: f32, z: f32) -> Self {
        let inverse = 1.0 / (z * z + offset * offset).max(f32::MIN_POSITIVE);
        EdgePlane { cos: offset * safe_sqrt(inverse), sin2: z * z * inverse }
    }

    /// Cosine and sine of the corner that it makes with the plane of the next edge, which stands at right angles.
    fn corner(self, next: EdgePlane) -> (f32, f32) {
        (-self.cos * next.cos, safe_sqrt(self.sin2 + self.cos * self.cos * next.sin2))
    }
}

/// Sum of two angles given by cosine and sine, but for a full turn: by one arc tangent, where arc cosines are slow and
/// lose their digits near zero.
fn sum_of_angles((cos_a, sin_a): (f32, f32), (cos_b, sin_b): (f32, f32)) -> f32 {
    (sin_a * cos_b + cos_a * sin_b).atan2(cos_a * cos_b - sin_a * sin_b)
}

impl SphericalRect<'_> {
    /// A point of the rectangle and the density of its direction, 1/sr. None when the rectangle is seen edge-on.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        if self.solid_angle < SMALL {
            let offset = (2.0 * u - Vec2::ONE) * self.rect.half;
            let target = self.rect.centre + self.rect.right * offset.x + self.rect.up * offset.y;
            let pdf = self.area_pdf(from, target);
            return (pdf > 0.0 && pdf.is_finite()).then_some((target, pdf));
        }
        let angle = u.x * self.solid_angle + self.k;
        let (sin, cos) = angle.sin_cos();
        let f = (cos * self.b0 - self.b1) / sin;
        let cu = (1.0_f32.copysign(f) / safe_sqrt(f * f + self.b0 * self.b0)).clamp(-1.0, 1.0);
        let x = (-(cu * self.z) / safe_sqrt(1.0 - cu * cu).max(1e-7)).clamp(self.low.x, self.high.x);
        let distance = safe_sqrt(x * x + self.z * self.z);
        let h0 = self.low.y / safe_sqrt(distance * distance + self.low.y * self.low.y);
        let h1 = self.high.y / safe_sqrt(distance * distance + self.high.y * self.high.y);
        let h = h0 + u.y * (h1 - h0);
        let h2 = h * h;
        let y = if h2 < 1.0 - 1e-6 { h * distance / safe_sqrt(1.0 - h2) } else { self.high.y };
        let y = y.clamp(self.low.y, self.high.y);
        let target = from + self.rect.right * x + self.rect.up * y + self.axis_z * self.z;
        Some((target, 1.0 / self.solid_angle))
    }

    /// Density of a direction towards `target` on the rectangle, 1/sr.
    pub fn pdf(&self, from: Vec3, target: Vec3) -> f32 {
        if self.solid_angle < SMALL { self.area_pdf(from, target) } else { 1.0 / self.solid_angle }
    }

    fn area_pdf(&self, from: Vec3, target: Vec3) -> f32 {
        let to = target - from;
        let cos = to.normalize_or_zero().dot(self.rect.normal()).abs();
        to.length_squared() / (cos * self.rect.area())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect() -> Rect {
        Rect::new(Vec3::new(0.2, 1.0, -0.3), Vec3::X, Vec3::Y, Vec2::new(0.3, 0.45))
    }

    #[test]
    fn a_square_seen_from_its_cubes_centre_is_a_sixth_of_the_sphere() {
        let face = Rect::new(Vec3::Z, Vec3::X, Vec3::Y, Vec2::ONE);
        assert!((face.seen_from(Vec3::ZERO).solid_angle - TAU / 3.0).abs() < 1e-5);
    }

    #[test]
    fn samples_lie_on_the_rectangle_and_their_density_matches() {
        for from in [Vec3::new(0.0, 0.5, 1.0), Vec3::new(3.0, 0.2, 5.0), Vec3::new(0.2, 1.0, -0.29), Vec3::ZERO] {
            let rect = rect();
            let seen = rect.seen_from(from);
            for i in 0..400 {
                let u = Vec2::new((i % 20) as f32 + 0.5, (i / 20) as f32 + 0.5) / 20.0;
                let (target, pdf) = seen.sample(from, u).unwrap();
                let local = target - rect.centre;
                assert!(local.x.abs() <= 0.3001 && local.y.abs() <= 0.4501 && local.z.abs() < 1e-4, "{from} {local}");
                assert!((seen.pdf(from, target) / pdf - 1.0).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn spherical_sampling_is_uniform_in_solid_angle() {
        // The mean of 1 / (area density) over the samples is area over solid angle, within the grid's error.
        let from = Vec3::new(0.1, 0.6, 0.2);
        let rect = rect();
        let seen = rect.seen_from(from);
        let n = 64;
        let mut area = 0.0;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (target, pdf) = seen.sample(from, u).unwrap();
            let to = target - from;
            let cos = to.normalize().dot(rect.normal()).abs();
            area += to.length_squared() / cos / pdf / (n * n) as f32;
        }
        assert!((area / rect.area() - 1.0).abs() < 2e-3, "{area}");
    }

    #[test]
    fn edge_on_and_touching_are_finite() {
        for from in [Vec3::new(2.0, 1.0, -0.3), Vec3::new(0.2, 1.0, -0.3), Vec3::new(0.5, 1.0, -0.3)] {
            let rect = rect();
            let seen = rect.seen_from(from);
            assert!(seen.solid_angle.is_finite());
            if let Some((target, pdf)) = seen.sample(from, Vec2::new(0.3, 0.7)) {
                assert!(target.is_finite() && pdf.is_finite());
            }
        }
    }
}
