//! The list of gear to bring.

use super::lengths::Units;
use super::light_facts::{gel_text, head_name, modifier_text};
use crate::photo::flash_time_text;
use crate::scene::{Emitter, Head, Light, Scene, Shape};

/// Height of a head from which an ordinary stand is too low, metres: typical of stands that fold to a metre.
const LOW_STAND_M: f32 = 2.4;

/// Returns the gear of a studio with its number of pieces: heads, modifiers, gels, stands, backdrops, props. `on_booms`
/// are the lights, by their place in the list, whose stand must not be under them.
pub fn gear(scene: &Scene, on_booms: &[usize], units: Units) -> Vec<(usize, String)> {
    let mut list = Vec::new();
    let lights = || scene.lights.iter().enumerate().filter(|(_, light)| !light.emitter.is_infinite());
    lights().for_each(|(_, light)| add(&mut list, head(light, units)));
    lights().filter_map(|(_, light)| modifier(light, units)).for_each(|name| add(&mut list, name));
    lights().filter_map(|(_, light)| gel_text(&light.color.gel)).for_each(|gel| add(&mut list, format!("Gel: {gel}")));
    for (index, light) in lights() {
        let stand = match (on_booms.contains(&index), light.position.y > LOW_STAND_M) {
            (true, _) => "Boom with counterweight",
            (false, true) => "High stand",
            (false, false) => "Light stand",
        };
        add(&mut list, stand.to_owned());
    }
    for object in scene.objects.iter().filter(|object| object.visible) {
        match object.shape {
            Shape::Figure(_) => {}
            Shape::Sweep { width_m, height_m, .. } => {
                let width = units.distance(width_m * object.transform.scale.x);
                add(&mut list, format!("{}, {width} wide, on a crossbar", object.name));
                let up_m = object.transform.position.y + height_m * object.transform.scale.y;
                add(&mut list, format!("Crossbar {} up, with its two stands", units.distance(up_m)));
            }
            _ => add(&mut list, object.name.clone()),
        }
    }
    add(&mut list, format!("Camera, {:.0} mm lens", scene.camera.focal_length_mm));
    add(&mut list, "Light meter".to_owned());
    list
}

/// Returns the head of a light, with what limits its flash.
fn head(light: &Light, units: Units) -> String {
    let name = head_name(light, units);
    match &light.head {
        None => format!("{name} head"),
        Some(Head { t01_s: Some(t01_s), .. }) => format!("{name} (t0.1 {} at full power)", flash_time_text(*t01_s)),
        Some(_) => name,
    }
}

/// Returns the modifier of a head; none for a bare one.
fn modifier(light: &Light, units: Units) -> Option<String> {
    let is_bare = matches!(light.emitter, Emitter::Sphere { .. } | Emitter::Point);
    (!is_bare).then(|| modifier_text(light, units))
}

fn add(list: &mut Vec<(usize, String)>, name: String) {
    match list.iter_mut().find(|(_, listed)| *listed == name) {
        Some((count, _)) => *count += 1,
        None => list.push((1, name)),
    }
}
