//! What the whole figures wear: a plain suit with short sleeves and legs, a solid of its own a little outside the body.
//!
//! The cloth follows the very shapes of the body, cut off at each hem, and stands off by its thickness; the
//! skin comes out of the hems' flat ends, so the seam between cloth and skin is clean from every side.

use super::field::{Field, Group};
use super::limbs;
use super::proportions::Build;
use super::shape::Shape;
use super::skeleton::Skeleton;
use super::torso;
use glam::{Mat3, Vec3, vec3};

/// Thickness of the cloth, body units.
const CLOTH: f32 = 0.004;
/// How far down the upper arm the sleeves reach.
const SLEEVE: f32 = 0.52;
/// How far down the thigh the legs reach.
const LEG: f32 = 0.48;

/// A suit before it is meshed.
pub struct Garment {
    /// Its shape.
    pub field: Field,
    /// Where it ends: points and normals of the hems' planes.
    hems: Vec<(Vec3, Vec3)>,
    /// The hollow that the neck comes out of.
    neckline: Shape,
}

impl Garment {
    /// Cuts a suit for a posed figure.
    pub fn new(s: &Skeleton, b: &Build) -> Garment {
        let mut hems = Vec::new();
        let mut trunk = torso::torso(s, b);
        let neckline = Shape::Ellipsoid {
            center: s.chest.transform_point3(vec3(0.0, 1.565, -0.01) * s.unit),
            axes: Mat3::from(s.chest.matrix3),
            radii: vec3(0.082 + 0.3 * b.neck / s.unit, 0.155, 0.125) * s.unit,
        };
        trunk.cut(neckline.clone(), 0.003 * s.unit);
        // Nothing of the neck is left above it.
        let up = s.chest.transform_vector3(Vec3::Y);
        let collar = s.chest.transform_point3(vec3(0.0, 1.527, 0.0) * s.unit);
        trunk.cut(Shape::HalfSpace { normal: -up, offset: -up.dot(collar) }, 0.003 * s.unit);
        let mut groups = vec![trunk];
        for leg in &s.legs {
            let mut group = limbs::thigh(s, leg, b);
            let along = (leg.knee - leg.hip).normalize_or(Vec3::NEG_Y);
            hem(&mut group, &mut hems, leg.hip.lerp(leg.knee, LEG), along, s.unit);
            groups.push(group);
        }
        for arm in &s.arms {
            let mut group = limbs::upper_arm(s, arm, b);
            let along = (arm.elbow - arm.shoulder).normalize_or(Vec3::NEG_Y);
            hem(&mut group, &mut hems, arm.shoulder.lerp(arm.elbow, SLEEVE), along, s.unit);
            groups.push(group);
        }
        Garment { field: Field { groups, inflate: CLOTH * s.unit, ..Field::default() }, hems, neckline }
    }

    /// Distance to the nearest hem, metres.
    pub fn to_hem(&self, p: Vec3) -> f32 {
        let planes = self
            .hems
            .iter()
            .map(|(point, normal)| ((p - *point).dot(*normal).abs(), (p - *point).length()))
            .filter(|&(_, from_middle)| from_middle < 0.2)
            .map(|(to_plane, _)| to_plane);
        planes.fold(self.to_neckline(p), f32::min)
    }

    /// Distance to the hollow of the neck, metres.
    pub fn to_neckline(&self, p: Vec3) -> f32 {
        self.neckline.distance(p).abs()
    }
}

/// Takes off all of a group that lies beyond a plane.
fn hem(group: &mut Group, hems: &mut Vec<(Vec3, Vec3)>, point: Vec3, beyond: Vec3, unit: f32) {
    group.cut(Shape::HalfSpace { normal: -beyond, offset: -beyond.dot(point) }, 0.002 * unit);
    hems.push((point + beyond * CLOTH * unit, beyond));
}
