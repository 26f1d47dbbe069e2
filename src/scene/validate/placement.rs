//! Warnings about unlikely positions: a light inside an object, a camera behind the wall, a panel before most of its
//! measured light.

use super::finding::Finding;
use crate::scene::{Assets, Emitter, Light, Object, Room, Scene, Shape};
use glam::{Affine3A, Vec2, Vec3};

/// Returns warnings about the positions of camera and lights. Objects whose mesh is missing are skipped.
pub fn placement(scene: &Scene, assets: &Assets) -> Vec<Finding> {
    let solids: Vec<ObjectBounds> =
        scene.objects.iter().filter(|o| o.visible).filter_map(|o| ObjectBounds::of(o, assets)).collect();
    let mut findings = Vec::new();
    let mut warn = |place: &str, message: String| findings.push(Finding::warning(place, message));

    let camera = scene.camera.position;
    if scene.room.as_ref().is_some_and(|room| is_outside(room, camera)) {
        warn("camera.position", format!("{camera} is outside the room; a wall is in the way"));
    }
    if let Some(solid) = solids.iter().find(|solid| solid.contains(camera)) {
        warn("camera.position", format!("{camera} is inside {:?}", solid.object.name));
    }
    if !solids.is_empty() && !solids.iter().any(|solid| is_framed(scene, solid)) {
        warn("camera.aim", "the camera looks past everything".to_owned());
    }
    for (index, light) in scene.lights.iter().enumerate().filter(|(_, l)| l.on && !l.emitter.is_infinite()) {
        let place = format!("lights[{index}] {:?} position", light.name);
        if scene.room.as_ref().is_some_and(|room| is_outside(room, light.position)) {
            warn(&place, format!("{} is outside the room; a wall is in the way", light.position));
        }
        if let Some(solid) = solids.iter().find(|solid| solid.contains(light.position)) {
            warn(&place, format!("{} is inside {:?}", light.position, solid.object.name));
        }
        if let Some(part) = part_behind_panel(assets, light).filter(|part| *part > 0.1) {
            let place = format!("lights[{index}] {:?} photometric_file", light.name);
            let percent = 100.0 * part;
            let message =
                format!("{percent:.0} % of its light goes behind the panel and is lost; a point shows all of it");
            warn(&place, message);
        }
    }
    for (index, light) in scene.lights.iter().enumerate().filter(|(_, light)| scene.is_body_in_picture(light)) {
        let place = format!("lights[{index}] {:?} body", light.name);
        warn(&place, "it stands in the picture: move it, or hide it from the camera".to_owned());
    }
    findings
}

/// Returns the part of a measured light's flux that goes behind its panel; none for other lights.
fn part_behind_panel(assets: &Assets, light: &Light) -> Option<f32> {
    let is_panel = matches!(light.emitter, Emitter::RectPanel { .. } | Emitter::RoundPanel { .. });
    let table = assets.intensity_table(light).filter(|_| is_panel)?;
    Some(table.flux_behind_lm() / table.flux_lm())
}

fn is_outside(room: &Room, point: Vec3) -> bool {
    let half = room.size_m * 0.5;
    point.x.abs() > half.x || point.z.abs() > half.z || point.y < 0.0 || point.y > room.size_m.y
}

/// Returns true if some of an object's bounding box is in the picture, by a grid of sample points.
fn is_framed(scene: &Scene, solid: &ObjectBounds) -> bool {
    let frame = scene.camera_frame(scene.camera.aspect());
    let inside = |p: Vec2| p.cmpge(Vec2::ZERO).all() && p.cmple(Vec2::ONE).all();
    // A grid, not the corners alone: a backdrop may fill the frame with all its corners outside.
    let steps = [0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.0];
    let points = steps.iter().flat_map(|&x| steps.iter().flat_map(move |&y| steps.map(|z| Vec3::new(x, y, z))));
    solid.contains(frame.position())
        || points
            .map(|t| solid.world_from_object.transform_point3(solid.low + (solid.high - solid.low) * t))
            .any(|point| frame.project(point).is_some_and(inside))
}

/// An object's bounding box in object space.
struct ObjectBounds<'a> {
    object: &'a Object,
    world_from_object: Affine3A,
    low: Vec3,
    high: Vec3,
}

impl<'a> ObjectBounds<'a> {
    fn of(object: &'a Object, assets: &Assets) -> Option<Self> {
        let (low, high) = match object.shape {
            Shape::MeshFile { .. } | Shape::Figure(_) | Shape::Prop(_) | Shape::Tank(_) => {
                assets.coarse_mesh_of(&object.shape)?.bounds()
            }
            Shape::Plane { width_m, depth_m } => centred(Vec3::new(width_m, 0.0, depth_m)),
            Shape::Box { size_m } => centred(size_m),
            Shape::Sphere { radius_m } => centred(Vec3::splat(2.0 * radius_m)),
            Shape::Cylinder { radius_m, height_m } => centred(Vec3::new(2.0 * radius_m, height_m, 2.0 * radius_m)),
            Shape::Sweep { width_m, height_m, depth_m, .. } => {
                (Vec3::new(-0.5 * width_m, 0.0, 0.0), Vec3::new(0.5 * width_m, height_m, depth_m))
            }
            Shape::VFlat { wing_m, height_m, angle_deg } => {
                let (sin, cos) = (0.5 * angle_deg.to_radians()).sin_cos();
                let corner = Vec3::new(wing_m * sin, 0.5 * height_m, wing_m * cos);
                (Vec3::new(-corner.x, -corner.y, 0.0), corner)
            }
        };
        Some(ObjectBounds { object, world_from_object: object.transform.world_from_object(), low, high })
    }

    /// Returns true if a point is inside of a solid shape. Mesh files may be hollow, and glass may be lit from inside.
    fn contains(&self, point: Vec3) -> bool {
        let p = self.world_from_object.inverse().transform_point3(point);
        let in_box = p.cmpgt(self.low).all() && p.cmplt(self.high).all();
        let across = Vec2::new(p.x, p.z).length();
        self.object.material.transmission == 0.0
            && match self.object.shape {
                Shape::Box { .. } | Shape::Figure(_) => in_box,
                Shape::Sphere { radius_m } => p.length() < radius_m,
                Shape::Cylinder { radius_m, .. } => in_box && across < radius_m,
                Shape::MeshFile { .. }
                | Shape::Plane { .. }
                | Shape::Sweep { .. }
                | Shape::VFlat { .. }
                | Shape::Prop(_)
                | Shape::Tank(_) => false,
            }
    }
}

fn centred(size: Vec3) -> (Vec3, Vec3) {
    (-0.5 * size, 0.5 * size)
}
