//! Points inside of objects, such as a meter in a person: found by the back faces around them.

use super::ray_caster::RayCaster;
use crate::math::{Ray, warp};
use glam::{Vec2, Vec3};

/// A back face that a ray hits first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BackFace {
    /// The object; [`ROOM`](super::render_scene::ROOM) for the room.
    pub object: u32,
    /// Whether its mesh is closed. A person's is not: clothes are open below.
    pub is_closed: bool,
}

/// Traces so many rays from a point in the tracer's space, evenly over the sphere, and returns the back faces that they
/// hit first.
pub fn back_faces_around(caster: &mut RayCaster<'_>, origin: Vec3, rays: u32) -> Vec<BackFace> {
    let scene = caster.scene;
    let aggregate = &scene.aggregate;
    let back_face = |index: u32| {
        // Directions along a spiral whose turns have the golden ratio
        let u = Vec2::new((index as f32 + 0.5) / rays as f32, (index as f32 * 0.618_034).fract());
        let direction = warp::uniform_sphere(u);
        let hit = caster.intersect(&Ray { origin, direction, t_max: f32::INFINITY })?;
        let instance = &aggregate.instances()[hit.instance as usize];
        let is_back = aggregate.surface(&hit).geometric_normal.dot(direction) > 0.0;
        is_back.then(|| BackFace { object: instance.object, is_closed: instance.geometry.is_closed() })
    };
    (0..rays).filter_map(back_face).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::prepare;
    use crate::scene::{Assets, Object, ObjectId, Scene, Shape, Transform};

    #[test]
    fn back_faces_are_around_a_point_in_a_box_and_a_ray_that_misses_all_is_none() {
        let object = |id, shape, position| Object {
            id: ObjectId(id),
            transform: Transform::at(position),
            ..Object::new(format!("Thing {id}"), shape)
        };
        let scene = Scene {
            objects: vec![
                object(1, Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::ZERO),
                object(2, Shape::Box { size_m: Vec3::ONE }, Vec3::Y * 3.0),
            ],
            ..Scene::default()
        };
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let mut caster = RayCaster::new(&prepared);
        let mut around = |position: Vec3| back_faces_around(&mut caster, position - prepared.origin, 64);
        let of_box = BackFace { object: 1, is_closed: true };
        assert_eq!(around(Vec3::Y * 3.0), [of_box; 64], "inside of the box");
        let below = around(Vec3::Y * -0.1);
        let of_plane = BackFace { object: 0, is_closed: false };
        assert!((20..=32).contains(&below.len()) && below.iter().all(|face| *face == of_plane), "{below:?}");
        assert_eq!(around(Vec3::Y * 9.0), [], "above the box, where most rays miss");
    }
}
