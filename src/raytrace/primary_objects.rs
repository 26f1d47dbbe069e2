//! Visibility of objects at pixel centres.

use super::ray_caster::RayCaster;
use super::render_scene::{ROOM, RenderScene};
use crate::math::Ray;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Index into the scene's objects of the surface at each pixel's centre; `u32::MAX` for the room and for nothing.
pub fn primary_objects(scene: &RenderScene, width: u32, height: u32) -> Vec<u32> {
    let frame = scene.lens.frame(width as f32 / height as f32);
    let row = |y: u32| {
        let mut caster = RayCaster::new(scene);
        (0..width)
            .map(|x| {
                let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(width as f32, height as f32);
                let direction = frame.direction(point).normalize();
                let hit = caster.intersect(&Ray { origin: Vec3::ZERO, direction, t_max: f32::INFINITY });
                hit.map_or(ROOM, |hit| scene.aggregate.instances()[hit.instance as usize].object)
            })
            .collect::<Vec<u32>>()
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}
