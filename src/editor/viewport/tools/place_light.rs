//! Placement of a light by the surface point of its highlight, its light at normal incidence, or the shadow of its aim
//! point.

use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::viewport::tools::surface_pick::SurfaceHit;
use crate::scene::{Aim, Emitter, Light, LightId, Scene};

/// A light that is being placed, and by which feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightPlacement {
    /// The light.
    pub light: LightId,
    /// The feature.
    pub by: PlaceLightBy,
}

/// The reason why a light cannot be placed by a surface point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlaceLightError {
    /// The camera is on the other side of the surface.
    #[error("The camera does not see this side: no highlight can show here.")]
    Unseen,
    /// The surface faces away from the light's position.
    #[error("The light would stand behind this surface.")]
    Behind,
    /// The point is the aim point.
    #[error("This is what the light is aimed at: its shadow falls farther behind.")]
    AtAimPoint,
    /// The light's position is below the floor.
    #[error("The light would have to stand in the floor.")]
    Floor,
}

/// Smallest height of a light, metres.
const MIN_HEIGHT_M: f32 = 0.05;
/// Smallest distance to which the floor may shorten a light's distance, metres.
const MIN_DISTANCE_M: f32 = 0.2;

/// Distance within which a point counts as the aim point, metres.
const SAME_POINT_M: f32 = 0.002;

/// Returns the placed light, at the distance of `start` from its aim point. For highlight and light its new aim is the
/// surface point, relative to the object. The distance is shortened where the light would be below the floor.
///
/// With `n` the normal, `v` the direction to the camera and `l` that to the light, a mirror shows the light where `n`
/// is the half vector: `l = 2 (n.v) n - v`. Straight light comes along the normal: `l = n`. The shadow of the aim `a`
/// falls on the point `p` where the light lies beyond it: `l = a - p`.
pub fn placed_light(scene: &Scene, start: &Light, at: &SurfaceHit, by: PlaceLightBy) -> Result<Light, PlaceLightError> {
    let aimed_at = scene.aim_point(&start.aim, start.position);
    let (centre, direction) = match by {
        PlaceLightBy::Light => (at.point, at.normal),
        PlaceLightBy::Highlight => {
            let view = (scene.camera.position - at.point).try_normalize().ok_or(PlaceLightError::Unseen)?;
            let cosine = at.normal.dot(view);
            if cosine <= 1e-3 {
                return Err(PlaceLightError::Unseen);
            }
            (at.point, 2.0 * cosine * at.normal - view)
        }
        PlaceLightBy::Shadow => {
            let ray = aimed_at - at.point;
            if ray.length() < SAME_POINT_M {
                return Err(PlaceLightError::AtAimPoint);
            }
            let direction = ray.try_normalize().ok_or(PlaceLightError::AtAimPoint)?;
            if direction.dot(at.normal) <= 0.0 {
                return Err(PlaceLightError::Behind);
            }
            (aimed_at, direction)
        }
    };
    let wanted_m = match start.aim {
        Aim::Angles { .. } => (start.position - at.point).length(),
        Aim::Point(_) | Aim::Object { .. } => (start.position - aimed_at).length(),
    };
    let mut distance_m = wanted_m.max(MIN_DISTANCE_M);
    if !start.emitter.is_infinite() && centre.y + direction.y * distance_m < MIN_HEIGHT_M {
        distance_m = (centre.y - MIN_HEIGHT_M) / -direction.y;
        // A point below the floor has a negative or NaN distance.
        if distance_m.is_nan() || distance_m < MIN_DISTANCE_M {
            return Err(PlaceLightError::Floor);
        }
    }
    let aim = match (by, start.aim) {
        (PlaceLightBy::Highlight | PlaceLightBy::Light, _) => aim_on(scene, at),
        (PlaceLightBy::Shadow, Aim::Angles { .. }) => Aim::Point(aimed_at),
        (PlaceLightBy::Shadow, aim) => aim,
    };
    Ok(Light { position: centre + direction * distance_m, aim, ..start.clone() })
}

/// Returns the aim at a surface point, relative to its object.
fn aim_on(scene: &Scene, at: &SurfaceHit) -> Aim {
    let object_from_world = scene.object(at.object).map(|object| object.transform.world_from_object().inverse());
    match object_from_world.map(|m| m.transform_point3(at.point)).filter(|offset| offset.is_finite()) {
        Some(offset) => Aim::Object { object: at.object, offset },
        None => Aim::Point(at.point),
    }
}

/// Returns true for lights that have a position or direction.
pub fn can_be_placed(light: &Light) -> bool {
    light.emitter != Emitter::Surround
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::action::Action;
    use crate::editor::document::catalog;
    use crate::scene::ObjectId;
    use glam::Vec3;

    fn studio() -> (Scene, Light) {
        let mut scene = Scene::default();
        let mut ball = catalog::object_named("Chrome ball").unwrap();
        ball.transform.position = Vec3::new(0.2, 1.4, -0.1);
        ball.transform.rotation_deg.y = 33.0;
        Action::AddObject(Box::new(ball)).apply(&mut scene).unwrap();
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        light.aim = Aim::Object { object: ObjectId(0), offset: Vec3::ZERO };
        Action::AddLight(Box::new(light)).apply(&mut scene).unwrap();
        let light = scene.lights[0].clone();
        (scene, light)
    }

    /// Returns the surface point of the ball in a direction from its middle.
    fn on_ball(scene: &Scene, direction: Vec3) -> SurfaceHit {
        let normal = direction.normalize();
        let point = scene.objects[0].transform.position + 0.1 * normal;
        SurfaceHit { object: ObjectId(0), point, normal, t: 1.0 }
    }

    #[test]
    fn the_half_vector_is_the_normal_where_a_highlight_is_put() {
        let (mut scene, start) = studio();
        let distance = (start.position - scene.aim_point(&start.aim, start.position)).length();
        for direction in [Vec3::new(0.1, 0.2, 1.0), Vec3::new(-0.5, 0.6, 0.7), Vec3::new(0.7, -0.1, 0.5)] {
            let at = on_ball(&scene, direction);
            let light = placed_light(&scene, &start, &at, PlaceLightBy::Highlight).unwrap();
            let [to_light, to_camera] = [light.position, scene.camera.position].map(|p| (p - at.point).normalize());
            let half = (to_light + to_camera).normalize();
            assert!((half - at.normal).length() < 1e-5, "{direction}: {half}, not {}", at.normal);
            scene.lights[0] = light.clone();
            let axis = -Vec3::from(scene.light_frame(&light).matrix3.z_axis);
            let to_point = at.point - light.position;
            assert!(axis.cross(to_point).length() < 1e-5 && axis.dot(to_point) > 0.0, "the axis passes the point");
            assert!((to_point.length() - distance).abs() < 1e-5, "at the same distance");
        }
    }

    #[test]
    fn light_at_normal_incidence_lies_along_the_normal() {
        let (scene, start) = studio();
        let at = on_ball(&scene, Vec3::new(-0.9, 0.3, -0.2));
        let light = placed_light(&scene, &start, &at, PlaceLightBy::Light).unwrap();
        let from = (light.position - at.point).normalize();
        assert!((from - at.normal).length() < 1e-6);
        assert!((scene.aim_point(&light.aim, light.position) - at.point).length() < 1e-6);
    }

    #[test]
    fn the_aim_lies_between_the_light_and_its_shadow() {
        let (scene, mut start) = studio();
        start.aim = Aim::Object { object: ObjectId(0), offset: Vec3::new(0.0, 0.0, 0.1) };
        let nose = scene.aim_point(&start.aim, start.position);
        let distance = (start.position - nose).length();
        // On a backdrop, and on a cheek beside the nose.
        for (point, normal) in [(Vec3::new(0.8, 1.1, -2.0), Vec3::Z), (nose + Vec3::new(0.02, -0.02, -0.01), Vec3::Z)] {
            let at = SurfaceHit { object: ObjectId(0), point, normal, t: 1.0 };
            let light = placed_light(&scene, &start, &at, PlaceLightBy::Shadow).unwrap();
            let (to_nose, to_shadow) = (nose - light.position, point - light.position);
            assert!(to_nose.cross(to_shadow).length() < 1e-4 && to_nose.dot(to_shadow) > 0.0, "{}", light.position);
            assert!((to_nose.length() - distance).abs() < 1e-5 && to_shadow.length() > distance);
            assert_eq!(light.aim, start.aim);
        }
        let cap = SurfaceHit { object: ObjectId(0), point: nose, normal: Vec3::Z, t: 1.0 };
        assert_eq!(placed_light(&scene, &start, &cap, PlaceLightBy::Shadow), Err(PlaceLightError::AtAimPoint));
        let back = SurfaceHit { point: Vec3::new(0.2, 1.4, -2.0), normal: Vec3::NEG_Z, ..cap };
        assert_eq!(placed_light(&scene, &start, &back, PlaceLightBy::Shadow), Err(PlaceLightError::Behind));
    }

    #[test]
    fn unseen_points_have_no_highlight_and_lights_stay_above_the_floor() {
        let (mut scene, start) = studio();
        let behind = on_ball(&scene, Vec3::NEG_Z);
        assert_eq!(placed_light(&scene, &start, &behind, PlaceLightBy::Highlight), Err(PlaceLightError::Unseen));
        let below = on_ball(&scene, Vec3::new(0.0, -1.0, 0.1));
        let nearer = placed_light(&scene, &start, &below, PlaceLightBy::Light).unwrap();
        assert!((nearer.position.y - MIN_HEIGHT_M).abs() < 1e-5, "{}", nearer.position);
        assert!(((nearer.position - below.point).normalize() - below.normal).length() < 1e-5, "the direction holds");
        scene.objects[0].transform.position.y = 0.15;
        assert_eq!(
            placed_light(&scene, &start, &on_ball(&scene, Vec3::NEG_Y), PlaceLightBy::Light),
            Err(PlaceLightError::Floor)
        );
    }
}
