//! A rectangular emitter, sampled uniformly in solid angle (Urena, Fajardo and King 2013, "An Area-Preserving
//! Parametrization for Spherical Rectangles").

use super::flat;
use crate::math::simd::LANES;
use crate::math::{Vec3Lanes, atan2, safe_sqrt, sin_cos};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// A flat rectangle. It emits along `right x up`.
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
    pub half_diagonal: f32,
    /// Unit normal of the emitting side.
    normal: Vec3,
}

/// Solid angle (sr) below which the rectangle is sampled by area: the spherical formulas lose precision (1e-4 of the
/// light here), and the variance is the same.
const MIN_SOLID_ANGLE: f32 = 4e-3;

/// Distance from the plane, in half diagonals, beyond which the rectangle is sampled by area: distances and angles of
/// its points differ by less than 20 %, so that the spherical formulas cost more than they save.
const MAX_SPHERICAL_DISTANCE: f32 = 2.5;

/// The spherical rectangle that a rectangle subtends at a point.
#[derive(Clone, Copy, Debug)]
pub struct SphericalRect<'a> {
    rect: &'a Rect,
    /// Opposite corners in the local frame; `z` is minus the distance to the plane.
    low: Vec2,
    high: Vec2,
    z: f32,
    axis_z: Vec3,
    /// Cosines between the normals of the lower and upper edge planes and the rectangle's.
    b0: f32,
    b1: f32,
    k: f32,
    /// Solid angle, sr; 0 where the rectangle is sampled by area.
    pub solid_angle: f32,
}

impl Rect {
    /// Returns the rectangle of a centre, unit axes and half sizes.
    pub fn new(centre: Vec3, right: Vec3, up: Vec3, half: Vec2) -> Self {
        Rect { centre, right, up, half, half_diagonal: half.length(), normal: right.cross(up) }
    }

    /// Returns the unit normal of the emitting side.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Returns true if a point is on the emitting side.
    #[inline(always)]
    pub fn is_in_front(&self, point: Vec3) -> bool {
        (point - self.centre).dot(self.normal) > 0.0
    }

    /// Returns the area, m2.
    #[inline(always)]
    pub fn area(&self) -> f32 {
        4.0 * self.half.x * self.half.y
    }

    /// Returns the distance at which a ray hits the rectangle, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let normal = self.normal();
        let slope = direction.dot(normal);
        let t = (self.centre - origin).dot(normal) / slope;
        let local = origin + direction * t - self.centre;
        let inside = local.dot(self.right).abs() <= self.half.x && local.dot(self.up).abs() <= self.half.y;
        (slope != 0.0 && t > 0.0 && inside).then_some(t)
    }

    /// Returns the spherical rectangle that is subtended at `point`.
    #[inline(always)]
    pub fn seen_from(&self, point: Vec3) -> SphericalRect<'_> {
        let seen = self.seen_by_area_from(point);
        if seen.is_far() { seen } else { seen.with_solid_angle() }
    }

    /// Samples a point uniformly by area, seen from `from`. Returns the vector to it and the density of its direction,
    /// 1/sr.
    #[inline(always)]
    pub fn sample_by_area(&self, from: Vec3, u: Vec2) -> (Vec3, f32) {
        let offset = (2.0 * u - Vec2::ONE) * self.half;
        let to = self.centre + self.right * offset.x + self.up * offset.y - from;
        (to, self.area_pdf(to))
    }

    /// Returns the density of a direction that is sampled by area, for the vector `to` its point, 1/sr.
    #[inline(always)]
    fn area_pdf(&self, to: Vec3) -> f32 {
        flat::area_pdf(to, self.normal, self.area())
    }

    /// Returns the rectangle as seen from `point`, without its solid angle.
    #[inline(always)]
    pub fn seen_by_area_from(&self, point: Vec3) -> SphericalRect<'_> {
        // Transform the rectangle to a frame at `point` with Z away from its plane
        let d = self.centre - point;
        let height = d.dot(self.normal);
        let (axis_z, z) = if height > 0.0 { (-self.normal, -height) } else { (self.normal, height) };
        let middle = Vec2::new(d.dot(self.right), d.dot(self.up));
        let (low, high) = (middle - self.half, middle + self.half);
        SphericalRect { rect: self, low, high, z, axis_z, b0: 0.0, b1: 0.0, k: 0.0, solid_angle: 0.0 }
    }
}

/// The plane through the reference point and an edge of the rectangle: cosine between its normal and the rectangle's,
/// and the squared sine, which keeps its precision where the rectangle is seen edge-on.
#[derive(Clone, Copy, Debug)]
struct EdgePlane {
    cos: f32,
    sin2: f32,
}

impl EdgePlane {
    /// Returns the plane of the edge at `offset` in the rectangle's plane, at the distance `z`.
    #[inline(always)]
    fn new(offset: f32, z: f32) -> Self {
        let inverse = 1.0 / (z * z + offset * offset).max(f32::MIN_POSITIVE);
        EdgePlane { cos: offset * safe_sqrt(inverse), sin2: z * z * inverse }
    }

    /// Returns cosine and sine of the corner angle with the next edge's plane. The edges are perpendicular.
    #[inline(always)]
    fn corner(self, next: EdgePlane) -> (f32, f32) {
        (-self.cos * next.cos, safe_sqrt(self.sin2 + self.cos * self.cos * next.sin2))
    }
}

/// Returns the sum of two angles, given by cosine and sine, modulo 2 pi. One arc tangent is faster than two arc
/// cosines, and precise near zero.
#[inline(always)]
fn sum_of_angles((cos_a, sin_a): (f32, f32), (cos_b, sin_b): (f32, f32)) -> f32 {
    atan2(sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b)
}

impl SphericalRect<'_> {
    /// Returns true if the point is so far away that the rectangle is sampled by area; an empty one always is.
    #[inline(always)]
    pub fn is_far(&self) -> bool {
        -self.z >= MAX_SPHERICAL_DISTANCE * self.rect.half_diagonal
    }

    /// Computes the solid angle: the sum of the four corner angles less 2 pi. The sums of pairs are known modulo 2 pi,
    /// which does not matter for k. From closer than some micrometres, the half space may come out as solid angle 0, and
    /// is then sampled by area.
    #[inline(always)]
    pub fn with_solid_angle(self) -> Self {
        let SphericalRect { low, high, z, .. } = self;
        let (edge0, edge1) = (EdgePlane::new(-low.y, z), EdgePlane::new(high.x, z));
        let (edge2, edge3) = (EdgePlane::new(high.y, z), EdgePlane::new(-low.x, z));
        let upper = sum_of_angles(edge2.corner(edge3), edge3.corner(edge0));
        let excess = sum_of_angles(edge0.corner(edge1), edge1.corner(edge2)) + upper;
        let turned = if excess < -1e-5 { excess + TAU } else { excess };
        let solid_angle = if turned > TAU - 1e-5 { 0.0 } else { turned.max(0.0) };
        SphericalRect { b0: edge0.cos, b1: edge2.cos, k: -upper, solid_angle, ..self }
    }

    /// Returns true if points are sampled uniformly by area, rather than by solid angle.
    #[inline(always)]
    pub fn is_sampled_by_area(&self) -> bool {
        self.solid_angle < MIN_SOLID_ANGLE
    }

    /// Samples a point of the rectangle, seen from `from`. Returns the vector to it and the density of its direction,
    /// 1/sr; none for a rectangle seen edge-on.
    #[inline(always)]
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        let (to, pdf) =
            if self.is_sampled_by_area() { self.rect.sample_by_area(from, u) } else { self.sample_by_angle(u) };
        (pdf > 0.0 && pdf.is_finite()).then_some((to, pdf))
    }

    /// Samples a point uniformly by solid angle.
    #[inline(always)]
    pub fn sample_by_angle(&self, u: Vec2) -> (Vec3, f32) {
        // Sample x: the cumulative solid angle is inverted for u.x
        let (sin, cos) = sin_cos(u.x * self.solid_angle + self.k);
        let f = (cos * self.b0 - self.b1) / sin;
        let cu = (1.0_f32.copysign(f) / safe_sqrt(f * f + self.b0 * self.b0)).clamp(-1.0, 1.0);
        let x = -(cu * self.z) / safe_sqrt(1.0 - cu * cu).max(1e-7);
        let x = x.max(self.low.x).min(self.high.x);
        // Sample y for u.y
        let distance = safe_sqrt(x * x + self.z * self.z);
        let h0 = self.low.y / safe_sqrt(distance * distance + self.low.y * self.low.y);
        let h1 = self.high.y / safe_sqrt(distance * distance + self.high.y * self.high.y);
        let h = h0 + u.y * (h1 - h0);
        let h2 = h * h;
        let y = if h2 < 1.0 - 1e-6 { h * distance / safe_sqrt(1.0 - h2) } else { self.high.y };
        let y = y.max(self.low.y).min(self.high.y);
        (self.rect.right * x + self.rect.up * y + self.axis_z * self.z, 1.0 / self.solid_angle)
    }

    /// Returns the density of the direction of the vector `to` a point of the rectangle, 1/sr.
    pub fn pdf(&self, to: Vec3) -> f32 {
        if self.is_sampled_by_area() { self.rect.area_pdf(to) } else { 1.0 / self.solid_angle }
    }
}

/// Rectangles side by side, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct RectLanes {
    centre: Vec3Lanes,
    right: Vec3Lanes,
    up: Vec3Lanes,
    normal: Vec3Lanes,
    half_width: [f32; LANES],
    half_height: [f32; LANES],
    half_diagonal: [f32; LANES],
}

impl RectLanes {
    /// No rectangle in any lane.
    pub const NONE: Self = RectLanes {
        centre: Vec3Lanes::ZERO,
        right: Vec3Lanes::ZERO,
        up: Vec3Lanes::ZERO,
        normal: Vec3Lanes::ZERO,
        half_width: [0.0; LANES],
        half_height: [0.0; LANES],
        half_diagonal: [0.0; LANES],
    };

    /// Sets the rectangle of a lane.
    pub fn set_lane(&mut self, lane: usize, rect: &Rect) {
        self.centre.set_lane(lane, rect.centre);
        self.right.set_lane(lane, rect.right);
        self.up.set_lane(lane, rect.up);
        self.normal.set_lane(lane, rect.normal);
        (self.half_width[lane], self.half_height[lane]) = rect.half.into();
        self.half_diagonal[lane] = rect.half_diagonal;
    }

    /// Returns the rectangle of a lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Rect {
        Rect {
            centre: self.centre.lane(lane),
            right: self.right.lane(lane),
            up: self.up.lane(lane),
            half: Vec2::new(self.half_width[lane], self.half_height[lane]),
            half_diagonal: self.half_diagonal[lane],
            normal: self.normal.lane(lane),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect() -> Rect {
        Rect::new(Vec3::new(0.2, 1.0, -0.3), Vec3::X, Vec3::Y, Vec2::new(0.3, 0.45))
    }

    #[test]
    fn the_face_of_a_cube_subtends_a_sixth_of_the_sphere_at_its_centre() {
        let face = Rect::new(Vec3::Z, Vec3::X, Vec3::Y, Vec2::ONE);
        assert!((face.seen_from(Vec3::ZERO).solid_angle - TAU / 3.0).abs() < 1e-5);
    }

    #[test]
    fn samples_lie_on_the_rectangle_and_agree_with_the_pdf() {
        for from in [Vec3::new(0.0, 0.5, 1.0), Vec3::new(3.0, 0.2, 5.0), Vec3::new(0.2, 1.0, -0.29), Vec3::ZERO] {
            let rect = rect();
            let seen = rect.seen_from(from);
            for i in 0..400 {
                let u = Vec2::new((i % 20) as f32 + 0.5, (i / 20) as f32 + 0.5) / 20.0;
                let (to, pdf) = seen.sample(from, u).unwrap();
                let local = from + to - rect.centre;
                assert!(local.x.abs() <= 0.3001 && local.y.abs() <= 0.4501 && local.z.abs() < 1e-4, "{from} {local}");
                assert!((seen.pdf(to) / pdf - 1.0).abs() < 1e-3);
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
            let (to, pdf) = seen.sample(from, u).unwrap();
            let cos = to.normalize().dot(rect.normal()).abs();
            area += to.length_squared() / cos / pdf / (n * n) as f32;
        }
        assert!((area / rect.area() - 1.0).abs() < 2e-3, "{area}");
    }

    #[test]
    fn samples_from_edge_on_and_on_the_rectangle_are_finite() {
        for from in [Vec3::new(2.0, 1.0, -0.3), Vec3::new(0.2, 1.0, -0.3), Vec3::new(0.5, 1.0, -0.3)] {
            let rect = rect();
            let seen = rect.seen_from(from);
            assert!(seen.solid_angle.is_finite());
            if let Some((to, pdf)) = seen.sample(from, Vec2::new(0.3, 0.7)) {
                assert!(to.is_finite() && pdf.is_finite());
            }
        }
    }
}
