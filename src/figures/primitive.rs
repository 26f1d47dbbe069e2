//! Signed distance primitives. Distances are negative inside, and exact or slightly underestimated.

use glam::{Mat3, Vec3};

/// A solid with a signed distance function. Lengths in the units of its group.
#[derive(Clone, Debug)]
pub enum Primitive {
    /// An ellipsoid; `axes` rotates its axes to the group's.
    Ellipsoid {
        /// Centre.
        center: Vec3,
        /// Columns are its axes.
        axes: Mat3,
        /// Half lengths along its axes.
        radii: Vec3,
    },
    /// The hull of two balls: a limb, a finger, the bridge of a nose.
    Cone {
        /// Centre of the first ball.
        a: Vec3,
        /// Centre of the second ball.
        b: Vec3,
        /// Radius of the first ball.
        ra: f32,
        /// Radius of the second ball.
        rb: f32,
    },
    /// A chain of cones, given by centres and radii of the balls between them.
    Tube(Vec<(Vec3, f32)>),
    /// The slit between two eyelids: an almond in the XY plane, extruded along +Z from `back`.
    Almond(Almond),
    /// A half space: inside where `normal . p < offset`.
    HalfSpace {
        /// Unit normal.
        normal: Vec3,
        /// Distance of the plane from the origin along the normal.
        offset: f32,
    },
}

/// The slit between two eyelids; see [`Primitive::Almond`].
#[derive(Clone, Debug)]
pub struct Almond {
    /// Middle of the slit.
    pub center: Vec3,
    /// Half its length.
    pub half_length: f32,
    /// Height of the upper lid's edge over the line between the corners.
    pub rise: f32,
    /// Depth of the lower lid's edge under that line.
    pub fall: f32,
    /// Slope of the line between the corners; positive lifts the end at +X.
    pub tilt: f32,
    /// Position along X, -1 to 1, of the upper lid's highest point.
    pub peak: f32,
    /// Lowest z of the slit.
    pub back: f32,
}

impl Primitive {
    /// Returns an ellipsoid along the group's axes.
    pub fn ball(center: Vec3, radii: Vec3) -> Primitive {
        Primitive::Ellipsoid { center, axes: Mat3::IDENTITY, radii }
    }

    /// Returns the signed distance of `p`.
    pub fn distance(&self, p: Vec3) -> f32 {
        match self {
            Primitive::Ellipsoid { center, axes, radii } => ellipsoid(axes.transpose() * (p - *center), *radii),
            Primitive::Cone { a, b, ra, rb } => cone(p, *a, *b, *ra, *rb),
            Primitive::Tube(points) => {
                points.windows(2).map(|w| cone(p, w[0].0, w[1].0, w[0].1, w[1].1)).fold(f32::INFINITY, f32::min)
            }
            Primitive::Almond(almond) => almond.distance(p),
            Primitive::HalfSpace { normal, offset } => p.dot(*normal) - offset,
        }
    }
}

impl Almond {
    fn distance(&self, p: Vec3) -> f32 {
        let x = p.x - self.center.x;
        let y = p.y - self.center.y - self.tilt * x;
        let along = (x / self.half_length).clamp(-1.0, 1.0);
        // A parabola for each lid; the upper one leans towards its peak.
        let arch = 1.0 - along * along;
        let upper = self.rise * arch * (1.0 + self.peak * along);
        let lower = -self.fall * arch * (1.0 + 0.25 * along);
        // The slope of the lids makes the true distance shorter; 0.8 bounds it.
        let flat = 0.8 * (y - upper).max(lower - y).max(x.abs() - self.half_length);
        flat.max(self.back - p.z)
    }
}

/// Returns the first-order distance to an ellipsoid about the origin: exact on the surface, and everywhere for a ball.
fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let scaled = (p / radii).length();
    let slope = (p / (radii * radii)).length();
    if slope < 1e-9 { -radii.min_element() } else { scaled * (scaled - 1.0) / slope }
}

/// Returns the distance to the hull of two balls: the nearest of the balls between `a` and `b` with a linear radius.
fn cone(p: Vec3, a: Vec3, b: Vec3, ra: f32, rb: f32) -> f32 {
    let (axis, from_a) = (b - a, p - a);
    let length = axis.length();
    let slope = (ra - rb) / length;
    // One ball contains the other.
    if length < 1e-9 || slope.abs() >= 1.0 {
        return (from_a.length() - ra).min((p - b).length() - rb);
    }
    let along = from_a.dot(axis) / length;
    let across = (from_a - axis * (along / length)).length();
    let t = (along - across * slope / (1.0 - slope * slope).sqrt()).clamp(0.0, length);
    (across * across + (along - t) * (along - t)).sqrt() - (ra - slope * t)
}

/// A displacement of the surface near a polyline: outwards, or inwards with a negative height.
#[derive(Clone, Debug)]
pub struct Stroke {
    /// Points of the polyline.
    pub path: Vec<Vec3>,
    /// Distance at which the displacement is zero.
    pub radius: f32,
    /// Displacement on the line.
    pub height: f32,
    /// Weight of each axis in the distance from the line; a small Z makes a stroke on the face nearly independent of
    /// depth.
    pub weights: Vec3,
}

impl Stroke {
    /// Returns the displacement outwards at `p`.
    pub fn lift(&self, p: Vec3) -> f32 {
        let q = p * self.weights;
        let distance_sq = self
            .path
            .windows(2)
            .map(|w| segment_distance_sq(q, w[0] * self.weights, w[1] * self.weights))
            .fold(f32::INFINITY, f32::min);
        let fade = (1.0 - distance_sq / (self.radius * self.radius)).max(0.0);
        self.height * fade * fade * fade
    }

    /// Returns true if the displacement may be nonzero in a ball.
    pub fn reaches(&self, center: Vec3, radius: f32) -> bool {
        let q = center * self.weights;
        let reach = self.radius + radius * self.weights.max_element();
        self.path.windows(2).any(|w| segment_distance_sq(q, w[0] * self.weights, w[1] * self.weights) <= reach * reach)
    }
}

fn segment_distance_sq(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let axis = b - a;
    let length_sq = axis.length_squared();
    let t = if length_sq > 0.0 { ((p - a).dot(axis) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
    (p - a - axis * t).length_squared()
}

/// Smooth union over a width `k`; the cubic polynomial keeps highlights continuous across the seam.
pub fn smooth_min(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0);
    if h == 0.0 {
        return a.min(b);
    }
    let h = h / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Smooth intersection over a width `k`.
pub fn smooth_max(a: f32, b: f32, k: f32) -> f32 {
    -smooth_min(-a, -b, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_is_the_hull_of_its_balls() {
        let (a, b, ra, rb) = (Vec3::new(0.1, 0.0, 0.2), Vec3::new(0.3, 0.5, -0.1), 0.12, 0.05);
        for p in [Vec3::ZERO, Vec3::new(0.4, 0.2, 0.1), Vec3::new(0.3, 0.9, -0.3), Vec3::new(0.2, 0.25, 0.05)] {
            let nearest = (0..=20_000)
                .map(|i| i as f32 / 20_000.0)
                .map(|t| (p - a.lerp(b, t)).length() - (ra + (rb - ra) * t))
                .fold(f32::INFINITY, f32::min);
            assert!((cone(p, a, b, ra, rb) - nearest).abs() < 1e-5);
        }
    }

    #[test]
    fn smooth_unions_are_exact_away_from_the_seam() {
        assert_eq!(smooth_min(0.3, 0.1, 0.05), 0.1);
        assert!(smooth_min(0.1, 0.1, 0.05) < 0.1);
        assert_eq!(smooth_max(0.3, 0.1, 0.05), 0.3);
    }

    #[test]
    fn a_stroke_is_zero_at_its_radius() {
        let stroke = Stroke { path: vec![Vec3::ZERO, Vec3::X], radius: 0.5, height: 0.1, weights: Vec3::ONE };
        assert_eq!(stroke.lift(Vec3::new(0.5, 0.0, 0.0)), 0.1);
        assert_eq!(stroke.lift(Vec3::new(0.5, 0.5, 0.0)), 0.0);
        assert!(stroke.reaches(Vec3::new(0.5, 0.6, 0.0), 0.11) && !stroke.reaches(Vec3::new(0.5, 0.7, 0.0), 0.1));
    }
}
