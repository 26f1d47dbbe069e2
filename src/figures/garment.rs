//! The suit of whole figures, with short sleeves and legs: a solid slightly outside of the body.
//!
//! The cloth is the body's own primitives, cut off at each hem and offset outwards by its thickness. The skin emerges
//! from the hems' flat ends, so that cloth and skin meet in a clean line.

use super::field::{Field, PrimitiveGroup};
use super::limbs;
use super::primitive::Primitive;
use super::proportions::Build;
use super::skeleton::Skeleton;
use super::torso;
use glam::{Mat3, Vec3, vec3};

/// Thickness of the cloth, body units.
const CLOTH: f32 = 0.004;
/// Length of the sleeves, as a fraction of the upper arm.
const SLEEVE: f32 = 0.52;
/// Length of the trouser legs, as a fraction of the thigh.
const LEG: f32 = 0.48;

/// A suit before it is meshed.
pub struct Garment {
    /// The distance field.
    pub field: Field,
    /// Planes of the hems: point and normal.
    hems: Vec<(Vec3, Vec3)>,
    /// The ellipsoid subtracted for the neck.
    neckline: Primitive,
}

impl Garment {
    /// Builds the suit of a posed figure.
    pub fn new(s: &Skeleton, b: &Build) -> Garment {
        let mut hems = Vec::new();
        let mut trunk = torso::torso(s, b);
        let neckline = Primitive::Ellipsoid {
            center: s.chest.transform_point3(vec3(0.0, 1.565, -0.01) * s.unit),
            axes: Mat3::from(s.chest.matrix3),
            radii: vec3(0.082 + 0.3 * b.neck / s.unit, 0.155, 0.125) * s.unit,
        };
        trunk.cut(neckline.clone(), 0.003 * s.unit);
        // Remove the neck above the collar.
        let up = s.chest.transform_vector3(Vec3::Y);
        let collar = s.chest.transform_point3(vec3(0.0, 1.527, 0.0) * s.unit);
        trunk.cut(Primitive::HalfSpace { normal: -up, offset: -up.dot(collar) }, 0.003 * s.unit);
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

    /// Returns the distance to the nearest hem, metres.
    pub fn to_hem(&self, p: Vec3) -> f32 {
        let planes = self
            .hems
            .iter()
            .map(|(point, normal)| ((p - *point).dot(*normal).abs(), (p - *point).length()))
            .filter(|&(_, from_middle)| from_middle < 0.2)
            .map(|(to_plane, _)| to_plane);
        planes.fold(self.to_neckline(p), f32::min)
    }

    /// Returns the distance to the neckline, metres.
    pub fn to_neckline(&self, p: Vec3) -> f32 {
        self.neckline.distance(p).abs()
    }
}

/// Cuts a group off at a plane, and records the plane.
fn hem(group: &mut PrimitiveGroup, hems: &mut Vec<(Vec3, Vec3)>, point: Vec3, beyond: Vec3, unit: f32) {
    group.cut(Primitive::HalfSpace { normal: -beyond, offset: -beyond.dot(point) }, 0.002 * unit);
    hems.push((point + beyond * CLOTH * unit, beyond));
}
