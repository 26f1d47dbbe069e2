//! What hair must not enter, in the head's frame: head and torso, as height fields, and neck and shoulders, as capsules.

use super::hair_body::HairBody;
use super::head_surface::HeadSurface;
use super::roots::Root;
use super::torso_surface::{ShoulderSide, TorsoSurface};
use glam::Vec3;

/// A rounded cylinder.
#[derive(Clone, Copy, Debug)]
struct Capsule {
    ends: [Vec3; 2],
    radius: f32,
}

impl Capsule {
    /// Returns a point moved along a unit vector until it is outside.
    fn pushed_out(&self, mut p: Vec3, towards: Vec3) -> Vec3 {
        const STEPS: usize = 16;
        const NEAR_M: f32 = 0.0002;
        for _ in 0..STEPS {
            let missing = self.radius - self.distance_from_axis(p);
            if missing < NEAR_M {
                break;
            }
            p += towards * missing;
        }
        p
    }

    fn distance_from_axis(&self, p: Vec3) -> f32 {
        let [a, b] = self.ends;
        let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
        p.distance(a.lerp(b, t))
    }
}

/// Distance of hair from the torso, on which clothes lie, metres.
pub const OVER_CLOTHES_M: f32 = 0.008;

/// Head, neck, shoulders and torso.
#[derive(Clone, Debug)]
pub struct Obstacles {
    skull_centre: Vec3,
    skull_radii: Vec3,
    head: HeadSurface,
    body: Vec<Capsule>,
    torso: TorsoSurface,
    /// Unit vector in which the chest faces.
    forward: Vec3,
}

impl Obstacles {
    /// Returns the obstacles round the roots of a head of hair, with ears if it lies over them.
    pub fn new(body: &HairBody, roots: &[Root], over_ears: bool) -> Obstacles {
        let to_head = body.head.inverse();
        let joint = |name: &str| {
            let bone = body.data.bone(name).map(|b| usize::from(body.data.bones[b].head));
            bone.map_or(Vec3::ZERO, |v| to_head.transform_point3(body.positions[v]))
        };
        let (low, high) =
            roots.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), r| (l.min(r.position), h.max(r.position)));
        let depth = (high.z - low.z) / 2.0;
        let skull_radii = Vec3::new((high.x - low.x) / 2.0, depth * 1.02, depth);
        let skull_centre = Vec3::new(0.0, high.y - skull_radii.y, (high.z + low.z) / 2.0);
        let (neck, left, right) = (joint("neck01"), joint("upperarm01.L"), joint("upperarm01.R"));
        let span = left.distance(right);
        let capsule = |a, b, radius| Capsule { ends: [a, b], radius };
        let body_capsules = vec![capsule(joint("head"), neck, 0.19 * span), capsule(left, right, 0.16 * span)];
        let head = HeadSurface::new(body, skull_centre, over_ears);
        let up = to_head.transform_vector3(Vec3::Y);
        let forward = (left - right).cross(up).normalize_or(Vec3::Z);
        let torso = TorsoSurface::new(body, neck, (left - right).normalize_or(Vec3::X), up);
        Obstacles { skull_centre, skull_radii, head, body: body_capsules, torso, forward }
    }

    /// Returns the middle of the skull.
    pub fn skull_centre(&self) -> Vec3 {
        self.skull_centre
    }

    /// Returns the half axes of the skull.
    pub fn skull_radii(&self) -> Vec3 {
        self.skull_radii
    }

    /// Returns the height of a point over the skin of the head, metres; negative inside.
    pub fn height_over_head(&self, p: Vec3) -> f32 {
        self.head.height(p)
    }

    /// Returns a point moved to at least this height over the head, metres.
    pub fn above_head(&self, p: Vec3, height: f32) -> Vec3 {
        self.head.pushed_out(p, height)
    }

    /// Moves points as [`Obstacles::above_head`] does.
    pub fn move_above_head(&self, points: &mut [Vec3], height: f32) {
        self.head.push_out(points, height);
    }

    /// Returns a point moved to a side of neck and shoulders, and to at least this height over the head, metres.
    pub fn pushed_out(&self, p: Vec3, height: f32, side: ShoulderSide) -> Vec3 {
        let towards = match side {
            ShoulderSide::Front => self.forward,
            ShoulderSide::Back => -self.forward,
        };
        let p = self.body.iter().fold(self.above_head(p, height), |p, capsule| capsule.pushed_out(p, towards));
        self.over_torso(p, OVER_CLOTHES_M.max(height), side)
    }

    /// Returns a point moved to a side of chest and back, to at least this distance from them, metres.
    pub fn over_torso(&self, p: Vec3, distance: f32, side: ShoulderSide) -> Vec3 {
        self.torso.pushed_out(p, distance, side)
    }
}
