//! Visibility of objects and of the bodies of lights at pixel centres.

use super::geometry::Instance;
use super::ray_caster::RayCaster;
use super::render_scene::{ROOM, RenderScene};
use crate::math::Ray;
use crate::scene::LightId;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Index into the scene's objects of the surface at each pixel's centre; `u32::MAX` for the room and for nothing.
pub fn primary_objects(scene: &RenderScene, width: u32, height: u32) -> Vec<u32> {
    primary_instances(scene, width, height, |instance| instance.map_or(ROOM, |instance| instance.object))
}

/// The light whose body each pixel's centre shows; none where there is another surface or nothing.
pub fn bodies_in_picture(scene: &RenderScene, width: u32, height: u32) -> Vec<Option<LightId>> {
    primary_instances(scene, width, height, |instance| instance?.body.map(|body| body.light))
}

fn primary_instances<T: Send>(
    scene: &RenderScene,
    width: u32,
    height: u32,
    seen: impl Fn(Option<&Instance>) -> T + Sync,
) -> Vec<T> {
    let frame = scene.lens.frame(width as f32 / height as f32);
    let row = |y: u32| {
        let mut caster = RayCaster::new(scene);
        (0..width)
            .map(|x| {
                let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(width as f32, height as f32);
                let direction = frame.direction(point).normalize();
                let ray = Ray { origin: Vec3::ZERO, direction, t_max: f32::INFINITY };
                let hit = caster.intersect_from_camera(&ray);
                seen(hit.map(|hit| &scene.aggregate.instances()[hit.instance as usize]))
            })
            .collect::<Vec<T>>()
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}
