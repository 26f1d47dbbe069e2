//! The places of a light's front, its head and its stand in the room.

use crate::scene::{Emitter, Light, ModifierKind, ModifierShape, Scene};
use glam::{Affine3A, Vec3};
use std::f32::consts::TAU;

/// Depth of a softbox or a dish behind its front, as a part of its shorter edge, and at most so many metres.
const DEPTH: (f32, f32) = (0.5, 0.45);
/// Depth of the canopy of an umbrella that reflects, as a part of its diameter.
const CANOPY: f32 = 0.22;
/// Length and radius of a bare head or of one with a reflector, metres.
const HEAD_M: (f32, f32) = (0.28, 0.09);
/// Points of a round front.
const AROUND: u32 = 24;

/// A light as it stands in the room. All points are in world space, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct LightShape {
    /// Points around the luminous front; one for a bare bulb.
    pub front: Vec<Vec3>,
    /// Points of head and modifier behind the front.
    pub back: Vec<Vec3>,
    /// The point at which the stand holds the head.
    pub head: Vec3,
    /// Unit direction in which it shines.
    pub axis: Vec3,
}

impl LightShape {
    /// Returns the shape of a light; none for sun and surround, which stand nowhere in the room.
    pub fn new(scene: &Scene, light: &Light) -> Option<Self> {
        let frame = scene.light_frame(light);
        let circle = |radius_m: f32, back_m: f32| -> Vec<Vec3> {
            let around = (0..AROUND).map(|i| TAU * i as f32 / AROUND as f32);
            around.map(|angle| at(&frame, [radius_m * angle.cos(), radius_m * angle.sin(), back_m])).collect()
        };
        let (front, back, depth_m) = match light.emitter {
            Emitter::RectPanel { width_m, height_m } => {
                let depth_m = (DEPTH.0 * width_m.min(height_m)).min(DEPTH.1);
                let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
                let front = corners.map(|(x, y)| at(&frame, [x * width_m, y * height_m, 0.0])).to_vec();
                (front, circle(HEAD_M.1, depth_m), depth_m)
            }
            Emitter::RoundPanel { diameter_m } if is_umbrella(light) => {
                let depth_m = CANOPY * diameter_m;
                let bowl = [(0.4, 0.4), (0.27, 0.75), (0.1, 1.0)];
                let back = bowl.into_iter().flat_map(|(out, deep)| circle(out * diameter_m, deep * depth_m));
                (circle(0.5 * diameter_m, 0.0), back.collect(), depth_m)
            }
            Emitter::RoundPanel { diameter_m } => {
                let depth_m = (DEPTH.0 * diameter_m).min(DEPTH.1);
                (circle(0.5 * diameter_m, 0.0), circle(HEAD_M.1, depth_m), depth_m)
            }
            Emitter::Spot { .. } => (circle(HEAD_M.1, 0.0), circle(0.7 * HEAD_M.1, HEAD_M.0), HEAD_M.0),
            Emitter::Sphere { radius_m } => {
                (circle(radius_m, 0.0), circle(0.7 * HEAD_M.1, radius_m + HEAD_M.0), radius_m + 0.5 * HEAD_M.0)
            }
            Emitter::Point => (vec![light.position], circle(0.7 * HEAD_M.1, HEAD_M.0), HEAD_M.0),
            Emitter::Sun { .. } | Emitter::Surround => return None,
        };
        // The head of an umbrella is not behind its front
        let depth_m = ModifierShape::of(light).map_or(depth_m, |shape| shape.stand_point_m());
        let axis = -Vec3::from(frame.matrix3.z_axis);
        Some(LightShape { front, back, head: at(&frame, [0.0, 0.0, depth_m]), axis })
    }

    /// Returns all points.
    pub fn points(&self) -> impl Iterator<Item = Vec3> {
        self.front.iter().chain(&self.back).copied()
    }

    /// Returns points all over its front, and those of its back.
    pub fn surface_points(&self) -> impl Iterator<Item = Vec3> {
        let middle = self.front.iter().sum::<Vec3>() / self.front.len().max(1) as f32;
        let next = self.front.iter().cycle().skip(1);
        let edges = self.front.iter().zip(next).flat_map(|(a, b)| [*a, a.lerp(*b, 0.5)]);
        let rings = edges.flat_map(move |point| [1.0, 0.7, 0.4, 0.0].map(|out| middle.lerp(point, out)));
        rings.chain(self.back.iter().copied())
    }

    /// Returns the height of its highest point, metres.
    pub fn top_m(&self) -> f32 {
        self.points().map(|point| point.y).fold(f32::NEG_INFINITY, f32::max)
    }
}

fn is_umbrella(light: &Light) -> bool {
    ModifierShape::of(light).is_some_and(|shape| shape.kind == ModifierKind::Umbrella)
}

fn at(frame: &Affine3A, local: [f32; 3]) -> Vec3 {
    frame.transform_point3(Vec3::from(local))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aim, Output};

    #[test]
    fn a_softbox_has_its_front_at_its_position_and_its_head_behind_it() {
        let emitter = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
        let light = Light {
            position: Vec3::new(0.0, 2.0, 1.0),
            aim: Aim::Point(Vec3::new(0.0, 2.0, 0.0)),
            ..Light::new(emitter, Output::Lumens(1.0))
        };
        let shape = LightShape::new(&Scene::default(), &light).unwrap();
        assert!(shape.front.iter().all(|point| (point.z - 1.0).abs() < 1e-6 && point.x.abs() < 0.31));
        assert!((shape.top_m() - 2.45).abs() < 1e-5 && (shape.head - Vec3::new(0.0, 2.0, 1.3)).length() < 1e-5);
        assert!((shape.axis - Vec3::NEG_Z).length() < 1e-6);
        let sun = Light::new(Emitter::Surround, Output::Lux(1.0));
        assert_eq!(LightShape::new(&Scene::default(), &sun), None);
    }
}
