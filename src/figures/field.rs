//! The signed distance field of a figure: groups of primitives, blended smoothly within each group.
//!
//! A group is a list of additions, subtractions and displacements that apply in order. `cull` drops those without
//! effect inside a ball, so that a sample of two hundred primitives evaluates about ten.

use super::primitive::{Primitive, Stroke, smooth_max, smooth_min};
use glam::{Affine3A, Vec3};

/// An operation on the surface of a group.
#[derive(Clone, Debug)]
pub enum SculptStep {
    /// Adds a primitive, by a union smoothed over a width.
    Add(Primitive, f32),
    /// Subtracts a primitive, with an edge smoothed over a width.
    Cut(Primitive, f32),
    /// Displaces the surface along a line.
    Brush(Stroke),
}

/// Primitives that are blended with each other in a local frame.
#[derive(Clone, Debug)]
pub struct PrimitiveGroup {
    /// Rigid transform from world space.
    group_from_world: Affine3A,
    /// Metres per unit of the group's lengths.
    scale: f32,
    /// Mirrors the group at its X = 0 plane: primitives at +X appear at -X, too.
    mirrored: bool,
    steps: Vec<SculptStep>,
    /// Blend with the groups before it.
    join: Join,
}

/// The blend of a group with those before it: wide near a point (a shoulder), narrow away from it (a hand on a hip).
#[derive(Clone, Copy, Debug)]
pub struct Join {
    /// Centre of the wide blend, world space.
    pub center: Vec3,
    /// Radius of the wide blend, metres.
    pub radius: f32,
    /// Blend width inside the radius, metres.
    pub near: f32,
    /// Blend width outside, metres.
    pub far: f32,
}

impl Join {
    /// Returns a blend of constant width, metres.
    pub fn even(width: f32) -> Join {
        Join { center: Vec3::ZERO, radius: 1.0, near: width, far: width }
    }

    fn width(&self, p: Vec3) -> f32 {
        let t = ((p - self.center).length() / self.radius - 1.0).clamp(0.0, 1.0);
        let fade = t * t * (3.0 - 2.0 * t);
        self.near + (self.far - self.near) * fade
    }
}

impl PrimitiveGroup {
    /// Returns an empty group in world space, its lengths in metres.
    pub fn in_world(join: Join) -> PrimitiveGroup {
        PrimitiveGroup::new(Affine3A::IDENTITY, 1.0, join)
    }

    /// Returns an empty group in a local frame, its lengths in units of `scale` metres.
    pub fn new(world_from_group: Affine3A, scale: f32, join: Join) -> PrimitiveGroup {
        let group_from_world = world_from_group.inverse();
        PrimitiveGroup { group_from_world, scale, mirrored: false, steps: Vec::new(), join }
    }

    /// Returns the group mirrored at its X = 0 plane.
    pub fn mirrored(mut self) -> PrimitiveGroup {
        self.mirrored = true;
        self
    }

    /// Adds a primitive.
    pub fn add(&mut self, shape: Primitive, width: f32) {
        self.steps.push(SculptStep::Add(shape, width));
    }

    /// Adds the hull of two balls.
    pub fn cone(&mut self, a: Vec3, ra: f32, b: Vec3, rb: f32, width: f32) {
        self.add(Primitive::Cone { a, b, ra, rb }, width);
    }

    /// Adds an ellipsoid along the group's axes.
    pub fn ball(&mut self, center: Vec3, radii: Vec3, width: f32) {
        self.add(Primitive::ball(center, radii), width);
    }

    /// Subtracts a primitive.
    pub fn cut(&mut self, shape: Primitive, width: f32) {
        self.steps.push(SculptStep::Cut(shape, width));
    }

    /// Displaces the surface along a line, outwards for a positive height.
    pub fn brush(&mut self, path: &[Vec3], radius: f32, height: f32, weights: Vec3) {
        self.steps.push(SculptStep::Brush(Stroke { path: path.to_vec(), radius, height, weights }));
    }

    /// Converts from world space to the group's units, mirrored to +X.
    fn local(&self, world: Vec3) -> Vec3 {
        let mut p = self.group_from_world.transform_point3(world) / self.scale;
        if self.mirrored {
            // A smoothed |x|: the exact one would leave a crease along the middle of the face.
            const FOLD_M: f32 = 0.001_2;
            let fold = FOLD_M / self.scale;
            p.x = (p.x * p.x + fold * fold).sqrt();
        }
        p
    }

    fn distance(&self, world: Vec3) -> f32 {
        let p = self.local(world);
        let start = f32::MAX;
        let d = self.steps.iter().fold(start, |d, step| match step {
            SculptStep::Add(shape, k) => smooth_min(d, shape.distance(p), *k),
            SculptStep::Cut(shape, k) => smooth_max(d, -shape.distance(p), *k),
            SculptStep::Brush(stroke) => d - stroke.lift(p),
        });
        if d == f32::MAX { FAR_M } else { d * self.scale }
    }

    /// Returns the group without the operations that have no effect inside a ball.
    fn cull(&self, center: Vec3, radius: f32) -> PrimitiveGroup {
        // The distances of ellipsoids and of the smoothed mirror have gradients slightly above 1.
        let (p, reach) = (self.local(center), 1.3 * radius / self.scale);
        let mut d = f32::MAX;
        let mut steps = Vec::new();
        for step in &self.steps {
            let keep = match step {
                SculptStep::Add(shape, k) => {
                    let s = shape.distance(p);
                    let keep = s - reach < d + reach + k;
                    d = smooth_min(d, s, *k);
                    keep
                }
                SculptStep::Cut(shape, k) => {
                    let s = -shape.distance(p);
                    let keep = s + reach > d - reach - k;
                    d = smooth_max(d, s, *k);
                    keep
                }
                SculptStep::Brush(stroke) => {
                    d -= stroke.lift(p);
                    stroke.reaches(p, reach)
                }
            };
            if keep {
                steps.push(step.clone());
            }
        }
        PrimitiveGroup { steps, ..self.clone() }
    }
}

/// Distance of an empty field, metres.
const FAR_M: f32 = 10.0;

/// The distance field of a whole figure.
#[derive(Clone, Debug, Default)]
pub struct Field {
    /// Blended in order.
    pub groups: Vec<PrimitiveGroup>,
    /// Primitives subtracted last, with their blend widths: a bust's flat base.
    pub cuts: Vec<(Primitive, f32)>,
    /// Offset of the surface outwards, metres: the thickness of a garment.
    pub inflate: f32,
}

impl Field {
    /// Returns the signed distance, metres, negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        let joined = self.groups.iter().fold(FAR_M, |d, group| smooth_min(d, group.distance(p), group.join.width(p)));
        self.cuts.iter().fold(joined - self.inflate, |d, (shape, k)| smooth_max(d, -shape.distance(p), *k))
    }

    /// Returns the gradient, by central differences.
    pub fn gradient(&self, p: Vec3) -> Vec3 {
        const STEP_M: f32 = 0.000_2;
        Vec3::from_array([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let (ahead, behind) = (self.distance(p + axis * STEP_M), self.distance(p - axis * STEP_M));
            (ahead - behind) / (2.0 * STEP_M)
        }))
    }

    /// Returns a field that is equal inside a ball and undefined elsewhere.
    pub fn cull(&self, center: Vec3, radius: f32) -> Field {
        let mut joined = FAR_M;
        let mut groups = Vec::new();
        for group in &self.groups {
            let d = group.distance(center);
            let seam = group.join.near.max(group.join.far);
            if d - 1.3 * radius < joined + 1.3 * radius + seam {
                groups.push(group.cull(center, radius));
            }
            joined = smooth_min(joined, d, group.join.width(center));
        }
        Field { groups, cuts: self.cuts.clone(), inflate: self.inflate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snowman() -> Field {
        let mut body = PrimitiveGroup::in_world(Join::even(0.0));
        body.ball(Vec3::ZERO, Vec3::splat(0.3), 0.0);
        body.cut(Primitive::ball(Vec3::Z * 0.3, Vec3::splat(0.05)), 0.01);
        body.brush(&[Vec3::X * 0.3, Vec3::new(0.2, 0.2, 0.0)], 0.05, 0.01, Vec3::ONE);
        let mut head = PrimitiveGroup::in_world(Join::even(0.05));
        head.ball(Vec3::Y * 0.4, Vec3::new(0.15, 0.2, 0.15), 0.0);
        Field { groups: vec![body, head], ..Field::default() }
    }

    #[test]
    fn culling_changes_nothing_inside_the_ball() {
        let field = snowman();
        for center in [Vec3::X * 0.3, Vec3::Z * 0.3, Vec3::Y * 0.25, Vec3::Y * 0.6, Vec3::NEG_Y * 0.3] {
            let culled = field.cull(center, 0.05);
            for offset in [Vec3::ZERO, Vec3::X * 0.05, Vec3::Y * 0.049, Vec3::new(0.02, -0.03, 0.03)] {
                assert_eq!(field.distance(center + offset), culled.distance(center + offset));
            }
        }
    }

    #[test]
    fn gradients_point_outwards() {
        let g = snowman().gradient(Vec3::new(0.0, -0.3, 0.0));
        assert!((g - Vec3::NEG_Y).length() < 1e-2);
    }
}
