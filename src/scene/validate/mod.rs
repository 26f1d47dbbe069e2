//! Validates a scene; messages are in words that a photographer understands.
//!
//! Errors are what no renderer has to cope with: non-finite numbers, sizes of zero, equal names. Warnings are what can
//! be rendered but was hardly meant. Places are named as in the scene file, so that `io` can find their line.

mod aim;
mod camera;
mod check;
mod figure;
mod finding;
mod fluid;
mod light;
mod light_warnings;
mod material;
mod object;
mod placement;
mod tank;
mod variants;

pub use finding::{Finding, Severity};
pub use placement::placement;

use super::Scene;
use check::Check;
use finding::NAME_CLASH;
use std::collections::HashSet;

/// Largest number of objects, and of lights, of a scene.
pub const LIST_LIMIT: usize = 10_000;
/// Largest number of characters of a name.
const NAME_LIMIT: usize = 200;
/// Largest number of characters of a description.
const DESCRIPTION_LIMIT: usize = 10_000;

/// Returns every error and warning of a scene, in file order. A scene without errors can be rendered by every renderer.
/// Warnings about positions, which need the meshes, come from [`placement()`].
pub fn validate(scene: &Scene) -> Vec<Finding> {
    let mut check = Check::default();
    check.text("name", &scene.name, NAME_LIMIT);
    check.text("description", &scene.description, DESCRIPTION_LIMIT);
    for (list, length) in [("objects", scene.objects.len()), ("lights", scene.lights.len())] {
        if length > LIST_LIMIT {
            check.error(list, format!("{length} are too many; at most {LIST_LIMIT} fit in a scene"));
        }
    }
    if check.has_findings() {
        return check.finish();
    }
    camera::check_camera(scene, &mut check);
    if let Some(room) = &scene.room {
        object::check_room(room, &mut check);
    }
    let mut names = HashSet::new();
    for (index, object) in scene.objects.iter().enumerate() {
        check.enter(format!("objects[{index}] {:?} ", object.name));
        check_name(&object.name, &mut names, &mut check);
        object::check_object(object, &mut check);
    }
    for (index, l) in scene.lights.iter().enumerate() {
        check.enter(format!("lights[{index}] {:?} ", l.name));
        check_name(&l.name, &mut names, &mut check);
        light::check_light(scene, l, &mut check);
    }
    if let Some(meter) = &scene.meter {
        camera::check_meter(meter, &mut check);
    }
    check.enter(String::new());
    light_warnings::warn_of_lights(scene, &mut check);
    variants::check_variants(scene, &mut check);
    check.finish()
}

fn check_name<'a>(name: &'a str, names: &mut HashSet<&'a str>, check: &mut Check) {
    check.text("name", name, NAME_LIMIT);
    if name.trim().is_empty() {
        check.error("name", "a name is needed".to_owned());
    }
    if !names.insert(name) {
        check.error("name", NAME_CLASH.to_owned());
    }
}

#[cfg(test)]
mod tests;
