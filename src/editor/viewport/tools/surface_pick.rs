//! Ray casting against the objects of a scene for the surface point and normal under the pointer.

use crate::scene::{Assets, Object, ObjectId, Scene};
use glam::{Affine3A, Vec3};

/// A surface point of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// The object.
    pub object: ObjectId,
    /// The point, metres.
    pub point: Vec3,
    /// Unit shading normal, on the side that was hit, world space.
    pub normal: Vec3,
    /// Distance along the ray, in units of its direction.
    pub t: f32,
}

/// Returns the nearest hit of a ray with the visible objects, or with one of them. Tests all triangles of an object
/// whose box is hit: one ray per frame needs no BVH.
pub fn hit(
    scene: &Scene,
    assets: &Assets,
    origin: Vec3,
    direction: Vec3,
    only: Option<ObjectId>,
) -> Option<SurfaceHit> {
    let asked = |object: &&Object| object.visible && only.is_none_or(|id| id == object.id);
    let hits = scene.objects.iter().filter(asked).filter_map(|object| hit_object(object, assets, origin, direction));
    hits.min_by(|a, b| a.t.total_cmp(&b.t))
}

/// Returns the nearest hit of a ray with one object.
pub fn hit_object(object: &Object, assets: &Assets, origin: Vec3, direction: Vec3) -> Option<SurfaceHit> {
    let world_from_object = object.transform.world_from_object();
    let object_from_world = Some(world_from_object.inverse()).filter(Affine3A::is_finite)?;
    let (o, d) = (object_from_world.transform_point3(origin), object_from_world.transform_vector3(direction));
    let mesh = assets.coarse_mesh_of(&object.shape)?;
    let (low, high) = mesh.bounds();
    if !crosses_box(o, d, low, high) {
        return None;
    }
    let nearest = (0..mesh.triangles.len()).filter_map(|index| Some((hit_triangle(mesh.corners(index), o, d)?, index)));
    let ((t, weights), index) = nearest.min_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
    let [a, b, c] = mesh.corners(index);
    let flat = (b - a).cross(c - a);
    let smooth = mesh.triangles[index]
        .iter()
        .zip(weights.to_array())
        .map(|(vertex, weight)| mesh.normals.get(*vertex as usize).copied().unwrap_or(flat) * weight)
        .sum::<Vec3>();
    // Normals transform by the inverse transpose.
    let normal = object_from_world.matrix3.transpose() * glam::Vec3A::from(smooth);
    let normal = Vec3::from(normal).try_normalize()?;
    let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
    Some(SurfaceHit { object: object.id, point: origin + direction * t, normal, t })
}

/// Slab test against a box; a ray along a face does not miss.
fn crosses_box(origin: Vec3, direction: Vec3, low: Vec3, high: Vec3) -> bool {
    let inverse = direction.recip();
    let (a, b) = ((low - origin) * inverse, (high - origin) * inverse);
    // NaN from zero times infinity is no bound.
    let bound = |v: f32, otherwise: f32| if v.is_nan() { otherwise } else { v };
    let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
    for axis in 0..3 {
        enter = enter.max(bound(a[axis].min(b[axis]), f32::NEG_INFINITY));
        leave = leave.min(bound(a[axis].max(b[axis]), f32::INFINITY));
    }
    enter <= leave * 1.000_01
}

/// Intersects a triangle from either side: distance and barycentric weights (Möller and Trumbore 1997).
fn hit_triangle([a, b, c]: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
    let (edge_b, edge_c) = (b - a, c - a);
    let p = direction.cross(edge_c);
    let determinant = edge_b.dot(p);
    let inverse = determinant.recip();
    let from_a = origin - a;
    let u = from_a.dot(p) * inverse;
    let q = from_a.cross(edge_b);
    let v = direction.dot(q) * inverse;
    let t = edge_c.dot(q) * inverse;
    // NaN of an edge-on triangle compares as a miss.
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t.is_finite()).then(|| (t, Vec3::new(1.0 - u - v, u, v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::{Shape, Transform};

    fn ball(id: u32, x: f32) -> Object {
        let transform = Transform {
            position: Vec3::new(x, 1.0, 0.0),
            rotation_deg: Vec3::new(10.0, 40.0, 0.0),
            scale: Vec3::new(1.0, 2.0, 1.0),
        };
        Object {
            id: ObjectId(id),
            shape: Shape::Sphere { radius_m: 0.5 },
            transform,
            ..catalog::object_named("Chrome ball").unwrap()
        }
    }

    #[test]
    fn a_scaled_ball_has_the_points_and_normals_of_an_ellipsoid() {
        let scene = Scene { objects: vec![ball(3, 0.0)], ..Scene::default() };
        let (origin, direction) = (Vec3::new(0.2, 1.5, 4.0), Vec3::new(-0.01, -0.05, -1.0));
        let hit = hit(&scene, &Assets::default(), origin, direction, None).unwrap();
        assert_eq!(hit.object, ObjectId(3));
        assert!((origin + direction * hit.t - hit.point).length() < 1e-6);
        let world_from_object = scene.objects[0].transform.world_from_object();
        let local = world_from_object.inverse().transform_point3(hit.point);
        // 128 segments deviate from the ball by 0.03 %, and normals between them by less than a degree.
        assert!((local.length() / 0.5 - 1.0).abs() < 1e-3, "{local}");
        let normal = Vec3::from(world_from_object.matrix3.inverse().transpose() * glam::Vec3A::from(local));
        assert!(hit.normal.dot(normal.normalize()) > 0.999_9, "{} and {normal}", hit.normal);
    }

    #[test]
    fn a_ray_hits_the_nearest_visible_object_or_the_requested_one() {
        let mut scene = Scene { objects: vec![ball(0, 0.0), ball(1, 3.0)], ..Scene::default() };
        let ask = |scene: &Scene, only| {
            hit(scene, &Assets::default(), Vec3::new(9.0, 1.0, 0.0), Vec3::NEG_X, only).map(|hit| hit.object.0)
        };
        assert_eq!((ask(&scene, None), ask(&scene, Some(ObjectId(0)))), (Some(1), Some(0)));
        scene.objects[1].visible = false;
        assert_eq!(ask(&scene, None), Some(0));
        assert_eq!(hit(&scene, &Assets::default(), Vec3::new(9.0, 5.0, 0.0), Vec3::NEG_X, None), None);
    }
}
