//! The body of a figure in its pose.

use super::body_data::BodyData;
use super::morph::rest_positions;
use super::skeleton::Skeleton;
use super::skinning::skin;
use crate::scene::{Extent, Figure};
use glam::{Affine3A, Quat, Vec3};

/// Heights of the cut of a bust, as a part of the way from hips to neck.
const BUST_CUT: f32 = 0.42;
/// Distance of the pupils in front of the origin in the rest pose, as a part of the height.
const EYES_FORWARD: f32 = 0.043;

/// A body in its pose: the cage of all vertices.
#[derive(Clone, Debug)]
pub struct PosedBody {
    /// Vertices of the body data, metres; the figure stands on height 0.
    pub positions: Vec<Vec3>,
    /// Vertices in the rest pose, metres: upright on height 0 with spread arms.
    pub rest: Vec<Vec3>,
    /// From the skeleton's space to the object's: the figure stands on the floor, with its eyes above the origin.
    pub shift: Vec3,
    /// World from rest for the bones.
    transforms: Vec<Affine3A>,
    /// Middle of the eyeballs in the rest pose, left and right, and their radius.
    eyes: [(Vec3, f32); 2],
    extent: Extent,
}

impl PosedBody {
    /// Shapes and poses a body.
    pub fn new(data: &BodyData, figure: &Figure) -> PosedBody {
        let rest = rest_positions(data, figure);
        let skeleton = Skeleton::new(data, &rest, figure);
        let mut transforms = skeleton.transforms;
        let mut positions = skin(data, &rest, &transforms);
        // Stand on the floor, or on the cut of a bust
        let soles = || data.quads("body").iter().flatten().map(|&v| positions[usize::from(v)].y);
        let floor = match figure.extent {
            Extent::Whole if figure.pose.seat_m.is_none() => soles().fold(f32::INFINITY, f32::min),
            Extent::Whole => 0.0,
            Extent::Bust => bust_cut(data, &positions),
        };
        let eyes = ["helper-l-eye", "helper-r-eye"].map(|group| ball(data.quads(group), &rest));
        let (eye, radius) = eyes[0];
        let shift = Vec3::new(0.0, -floor, EYES_FORWARD * figure.body.height_m - eye.z - radius);
        let to_origin = Affine3A::from_translation(shift);
        positions.iter_mut().for_each(|p| *p += shift);
        transforms.iter_mut().for_each(|t| *t = to_origin * *t);
        PosedBody { positions, rest, shift, transforms, eyes, extent: figure.extent }
    }

    /// Returns true if a quad, or a part of it, belongs to the part of the body that is there.
    pub fn has(&self, quad: &[u16; 4]) -> bool {
        quad.iter().any(|&v| self.above_cut(v) > 0.0)
    }

    /// Returns the height of a vertex over the cut of a bust, metres; infinite for a whole body.
    pub fn above_cut(&self, vertex: u16) -> f32 {
        match self.extent {
            Extent::Whole => f32::INFINITY,
            Extent::Bust => self.positions[usize::from(vertex)].y,
        }
    }

    /// Returns world from head: origin between the eyes, +Z the direction of the face.
    pub fn head(&self, data: &BodyData) -> Affine3A {
        let head = data.bone("head").map_or(Affine3A::IDENTITY, |bone| self.transforms[bone]);
        head * Affine3A::from_translation((self.eyes[0].0 + self.eyes[1].0) / 2.0)
    }

    /// Returns world from a ball of radius 1 that looks along +Z, for the left and right eye.
    pub fn eyeballs(&self, data: &BodyData, figure: &Figure) -> [Affine3A; 2] {
        let head = data.bone("head").map_or(Affine3A::IDENTITY, |bone| self.transforms[bone]);
        let t = &figure.pose.torso;
        let gaze =
            Quat::from_rotation_y(t.gaze_yaw_deg.to_radians()) * Quat::from_rotation_x(t.gaze_pitch_deg.to_radians());
        self.eyes
            .map(|(middle, radius)| head * Affine3A::from_scale_rotation_translation(Vec3::splat(radius), gaze, middle))
    }
}

/// Returns the middle and the radius of a ball of quads.
fn ball(quads: &[[u16; 4]], positions: &[Vec3]) -> (Vec3, f32) {
    let points = || quads.iter().flatten().map(|&v| positions[usize::from(v)]);
    let (low, high) = points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let middle = (low + high) / 2.0;
    // The helper ball bulges in front where its cornea is: the height tells the radius.
    let radius = (high.y - low.y) / 2.0;
    (middle.with_z(low.z + radius), radius)
}

/// Returns the height of a bust's cut.
fn bust_cut(data: &BodyData, positions: &[Vec3]) -> f32 {
    let joint = |name: &str| data.bone(name).map_or(0.0, |b| positions[usize::from(data.bones[b].head)].y);
    let (hips, neck) = (joint("pelvis.L"), joint("neck01"));
    hips + (neck - hips) * BUST_CUT
}
