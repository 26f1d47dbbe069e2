//! The figure as a signed distance field: groups of shapes, each group blended softly within itself.
//!
//! A group is a list of steps that run in order, like clay put on and taken off. `cull` drops the steps that cannot
//! matter inside a ball, which makes a field of two hundred shapes cost about ten of them a sample.

use super::shape::{Shape, Stroke, smooth_max, smooth_min};
use glam::{Affine3A, Vec3};

/// One step of modelling.
#[derive(Clone, Debug)]
pub enum Step {
    /// Puts a shape on, with a seam rounded over a width.
    Add(Shape, f32),
    /// Takes a shape off, with an edge rounded over a width.
    Cut(Shape, f32),
    /// Raises or presses in the surface along a line.
    Brush(Stroke),
}

/// Shapes that are blended with each other in a frame of their own.
#[derive(Clone, Debug)]
pub struct Group {
    /// A rigid motion.
    group_from_world: Affine3A,
    /// Metres a unit of the group's lengths.
    scale: f32,
    /// Folds the group at its X = 0 plane: what is modelled at +X is there at -X too.
    mirrored: bool,
    steps: Vec<Step>,
    /// How softly it joins the groups before it.
    join: Join,
}

/// How a group joins the ones before it: softly near a point (a shoulder), crisply away from it (a hand on a hip).
#[derive(Clone, Copy, Debug)]
pub struct Join {
    /// Middle of the soft zone, world space.
    pub center: Vec3,
    /// Radius of the soft zone, metres.
    pub radius: f32,
    /// Width of the seam in the zone, metres.
    pub near: f32,
    /// Width of the seam outside the zone, metres.
    pub far: f32,
}

impl Join {
    /// The same softness everywhere.
    pub fn even(width: f32) -> Join {
        Join { center: Vec3::ZERO, radius: 1.0, near: width, far: width }
    }

    fn width(&self, p: Vec3) -> f32 {
        let t = ((p - self.center).length() / self.radius - 1.0).clamp(0.0, 1.0);
        let fade = t * t * (3.0 - 2.0 * t);
        self.near + (self.far - self.near) * fade
    }
}

impl Group {
    /// An empty group whose lengths are metres in world space.
    pub fn in_world(join: Join) -> Group {
        Group::new(Affine3A::IDENTITY, 1.0, join)
    }

    /// An empty group in a frame of its own, its lengths in units of `scale` metres.
    pub fn new(world_from_group: Affine3A, scale: f32, join: Join) -> Group {
        let group_from_world = world_from_group.inverse();
        Group { group_from_world, scale, mirrored: false, steps: Vec::new(), join }
    }

    /// The same group folded at its X = 0 plane.
    pub fn mirrored(mut self) -> Group {
        self.mirrored = true;
        self
    }

    /// Puts a shape on.
    pub fn add(&mut self, shape: Shape, width: f32) {
        self.steps.push(Step::Add(shape, width));
    }

    /// Puts the hull of two balls on.
    pub fn cone(&mut self, a: Vec3, ra: f32, b: Vec3, rb: f32, width: f32) {
        self.add(Shape::Cone { a, b, ra, rb }, width);
    }

    /// Puts an ellipsoid along the group's axes on.
    pub fn ball(&mut self, center: Vec3, radii: Vec3, width: f32) {
        self.add(Shape::ball(center, radii), width);
    }

    /// Takes a shape off.
    pub fn cut(&mut self, shape: Shape, width: f32) {
        self.steps.push(Step::Cut(shape, width));
    }

    /// Raises or presses in the surface along a line.
    pub fn brush(&mut self, path: &[Vec3], radius: f32, height: f32, weights: Vec3) {
        self.steps.push(Step::Brush(Stroke { path: path.to_vec(), radius, height, weights }));
    }

    /// World space to the group's units, folded if it is mirrored.
    fn local(&self, world: Vec3) -> Vec3 {
        let mut p = self.group_from_world.transform_point3(world) / self.scale;
        if self.mirrored {
            // A rounded fold: a plain |x| would leave a crease down the middle of the face.
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
            Step::Add(shape, k) => smooth_min(d, shape.distance(p), *k),
            Step::Cut(shape, k) => smooth_max(d, -shape.distance(p), *k),
            Step::Brush(stroke) => d - stroke.lift(p),
        });
        if d == f32::MAX { FAR_M } else { d * self.scale }
    }

    /// The group without the steps that leave a ball's near field as it is.
    fn cull(&self, center: Vec3, radius: f32) -> Group {
        // Ellipsoids and the fold may rise a little faster than a true distance.
        let (p, reach) = (self.local(center), 1.3 * radius / self.scale);
        let mut d = f32::MAX;
        let mut steps = Vec::new();
        for step in &self.steps {
            let keep = match step {
                Step::Add(shape, k) => {
                    let s = shape.distance(p);
                    let keep = s - reach < d + reach + k;
                    d = smooth_min(d, s, *k);
                    keep
                }
                Step::Cut(shape, k) => {
                    let s = -shape.distance(p);
                    let keep = s + reach > d - reach - k;
                    d = smooth_max(d, s, *k);
                    keep
                }
                Step::Brush(stroke) => {
                    d -= stroke.lift(p);
                    stroke.reaches(p, reach)
                }
            };
            if keep {
                steps.push(step.clone());
            }
        }
        Group { steps, ..self.clone() }
    }
}

/// A distance that stands for "nowhere near".
const FAR_M: f32 = 10.0;

/// The whole figure.
#[derive(Clone, Debug, Default)]
pub struct Field {
    /// Joined in order.
    pub groups: Vec<Group>,
    /// Taken off at the end, with a rounding width: a bust's flat base.
    pub cuts: Vec<(Shape, f32)>,
    /// How far the surface lies outside what the groups make, metres: the cloth of a garment.
    pub inflate: f32,
}

impl Field {
    /// Signed distance in metres, negative inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        let joined = self.groups.iter().fold(FAR_M, |d, group| smooth_min(d, group.distance(p), group.join.width(p)));
        self.cuts.iter().fold(joined - self.inflate, |d, (shape, k)| smooth_max(d, -shape.distance(p), *k))
    }

    /// Gradient by central differences.
    pub fn gradient(&self, p: Vec3) -> Vec3 {
        const STEP_M: f32 = 0.000_2;
        Vec3::from_array([Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let (ahead, behind) = (self.distance(p + axis * STEP_M), self.distance(p - axis * STEP_M));
            (ahead - behind) / (2.0 * STEP_M)
        }))
    }

    /// The field as it is within a ball; elsewhere the result means nothing.
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
        let mut body = Group::in_world(Join::even(0.0));
        body.ball(Vec3::ZERO, Vec3::splat(0.3), 0.0);
        body.cut(Shape::ball(Vec3::Z * 0.3, Vec3::splat(0.05)), 0.01);
        body.brush(&[Vec3::X * 0.3, Vec3::new(0.2, 0.2, 0.0)], 0.05, 0.01, Vec3::ONE);
        let mut head = Group::in_world(Join::even(0.05));
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
