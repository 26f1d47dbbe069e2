//! Catchlights: the reflections of lights on the corneas of a figure, as the camera sees them.

use crate::figures::{Cornea, corneas};
use crate::raytrace::LightMeter;
use crate::scene::{Figure, LightId, Object, Scene};
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;
use std::fmt;

/// A reflection nearer to the middle of the iris than this part of its radius has no hour.
const MIDDLE: f32 = 0.12;
/// Points of an emitter that are tried for whether it shines on a cornea.
const SAMPLES: u32 = 48;
/// Part of an emitter that must be seen in a cornea at least.
const LEAST_VISIBLE: f32 = 0.1;
/// Distance within which a ray from the camera meets the point that it is aimed at, metres.
const NEAR_M: f32 = 0.0015;

/// A light that is reflected in the eyes.
#[derive(Clone, Debug, PartialEq)]
pub struct Catchlight {
    /// Name of the light.
    pub name: String,
    /// Place on the iris in its radii, to the right and up in the picture: the mean of the eyes that show it.
    pub place: Vec2,
}

impl Catchlight {
    /// Returns the place as on a clock, in half hours from 12; none in the middle of the iris.
    pub fn half_hours(&self) -> Option<u32> {
        if self.place.length() < MIDDLE {
            return None;
        }
        let turn = self.place.x.atan2(self.place.y) / TAU;
        Some((turn * 24.0).round().rem_euclid(24.0) as u32)
    }
}

impl fmt::Display for Catchlight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.name)?;
        match self.half_hours() {
            None => write!(f, "in the middle"),
            Some(half_hours) => {
                let hour = match half_hours / 2 {
                    0 => 12,
                    hour => hour,
                };
                let minutes = if half_hours % 2 == 1 { ":30" } else { "" };
                write!(f, "at {hour}{minutes}")
            }
        }
    }
}

/// Finds the catchlights in a figure's eyes, in the order of the meter's sources. Surrounds and emissive surfaces do not
/// count.
pub fn find_catchlights(scene: &Scene, meter: &LightMeter, object: &Object, figure: &Figure) -> Vec<Catchlight> {
    let world_from_object = object.transform.world_from_object();
    let eyes = corneas(figure).map(|cornea| in_world(&cornea, &world_from_object));
    let frame = scene.camera_frame(scene.camera.aspect());
    let catchlight = |(source, light): (usize, LightId)| {
        let places: Vec<Vec2> =
            eyes.iter().filter_map(|eye| place_on_iris(eye, meter, source, &frame.world_from_camera)).collect();
        let place = places.iter().sum::<Vec2>() / places.len() as f32;
        let name = scene.light(light)?.name.clone();
        (!places.is_empty()).then_some(Catchlight { name, place })
    };
    meter.sources().map(|source| source.light).enumerate().filter_map(catchlight).collect()
}

fn in_world(cornea: &Cornea, world_from_object: &Affine3A) -> Cornea {
    let axis = world_from_object.transform_vector3(cornea.axis);
    Cornea {
        centre: world_from_object.transform_point3(cornea.centre),
        radius: cornea.radius * axis.length(),
        axis: axis.normalize_or(Vec3::Z),
    }
}

/// Returns the middle of a light's reflection on the iris in its radii, to the right and up in the picture: of the part
/// that the camera sees. None where it sees too little.
fn place_on_iris(cornea: &Cornea, meter: &LightMeter, source: usize, world_from_camera: &Affine3A) -> Option<Vec2> {
    let camera = Vec3::from(world_from_camera.translation);
    let to_camera = (camera - cornea.centre).try_normalize()?;
    let vertex = cornea.centre + cornea.axis * cornea.radius;
    // Seen from so small a thing, a part of a light is in one direction. The normal of its reflection is halfway between
    // that and the camera's
    let normals = meter.open_directions(source, vertex, cornea.axis, SAMPLES).into_iter();
    let normals = normals.filter_map(|to_light| (to_light + to_camera).try_normalize());
    let is_on_iris = |normal: &Vec3| {
        normal.dot(cornea.axis) > 0.0
            && normal.cross(cornea.axis).length() < Cornea::EDGE_SINE
            && sees(meter, camera, cornea.centre + normal * cornea.radius)
    };
    let seen: Vec<Vec3> = normals.filter(is_on_iris).collect();
    if (seen.len() as f32) < LEAST_VISIBLE * SAMPLES as f32 && seen.len() != 1 {
        return None;
    }
    let middle = seen.iter().sum::<Vec3>() / seen.len() as f32 - cornea.axis;
    let across = Vec3::from(world_from_camera.matrix3.inverse() * glam::Vec3A::from(middle));
    Some(across.truncate() / Cornea::EDGE_SINE)
}

/// Returns true if nothing is between the camera and a point of a surface.
fn sees(meter: &LightMeter, camera: Vec3, point: Vec3) -> bool {
    let way = point - camera;
    let first = meter.first_surface(camera, way.normalize_or_zero(), way.length() + NEAR_M);
    first.is_none_or(|surface| surface.position.distance(point) < NEAR_M)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(degrees: f32) -> Option<u32> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Catchlight { name: String::new(), place: Vec2::new(sin, cos) * 0.5 }.half_hours()
    }

    #[test]
    fn places_are_hours_of_a_clock() {
        assert_eq!([at(0.0), at(90.0), at(180.0), at(-45.0), at(-2.0)], [0, 6, 12, 21, 0].map(Some));
        let named = |x, y| Catchlight { name: "Key".to_owned(), place: Vec2::new(x, y) }.to_string();
        assert_eq!(named(-0.3, 0.3), "Key at 10:30");
        assert_eq!(named(0.0, -0.5), "Key at 6");
        assert_eq!(named(0.0, 0.5), "Key at 12");
        assert_eq!(named(0.02, 0.0), "Key in the middle");
    }
}
