//! Points inside of closed objects, such as a meter in a box: found by the back faces around them.

use super::ray_caster::RayCaster;
use crate::math::{Ray, warp};
use glam::{Vec2, Vec3};

/// Traces so many rays from a point in the tracer's space, evenly over the sphere, and returns the objects of those that
/// first hit the back of a closed mesh. The room is [`ROOM`](super::render_scene::ROOM).
pub fn objects_around(caster: &mut RayCaster<'_>, origin: Vec3, rays: u32) -> Vec<u32> {
    let scene = caster.scene;
    let aggregate = &scene.aggregate;
    let object = |index: u32| {
        // Directions along a spiral whose turns have the golden ratio
        let u = Vec2::new((index as f32 + 0.5) / rays as f32, (index as f32 * 0.618_034).fract());
        let direction = warp::uniform_sphere(u);
        let hit = caster.intersect(&Ray { origin, direction, t_max: f32::INFINITY })?;
        let instance = &aggregate.instances()[hit.instance as usize];
        let is_back = aggregate.surface(&hit).geometric_normal.dot(direction) > 0.0;
        (is_back && instance.geometry.is_closed()).then_some(instance.object)
    };
    (0..rays).filter_map(object).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::prepare;
    use crate::scene::{Assets, Object, ObjectId, Scene, Shape, Transform};

    #[test]
    fn closed_objects_alone_enclose_a_point_and_a_ray_that_misses_all_is_no_back_face() {
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
        let mut around = |position: Vec3| objects_around(&mut caster, position - prepared.origin, 64);
        assert_eq!(around(Vec3::Y * 3.0), [1; 64], "inside of the box");
        assert_eq!(around(Vec3::Y * -0.1), [0; 0], "below the plane, which is open");
        assert_eq!(around(Vec3::Y * 9.0), [0; 0], "above the box, where most rays miss");
    }
}
