//! What a finished picture can follow without tracing, and what makes it out of date.

use crate::raytrace::Film;
use crate::scene::{Camera, LightColor, LightId, Modifier, Power, Scene};

/// Everything that developing a film reads from a scene: when this is the same, the picture is.
#[derive(Clone, Debug, PartialEq)]
pub struct DevelopKey {
    exposure: [f32; 5],
    lights: Vec<(LightId, Power, LightColor, bool, [f32; 2])>,
}

impl DevelopKey {
    /// The key of a scene.
    pub fn of(scene: &Scene) -> Self {
        let Camera { f_number, shutter_s, iso, white_balance_k, meter_constant, .. } = scene.camera;
        let losses = |m: &Modifier| [m.loss_stops, m.scrim_stops];
        let lights = scene.lights.iter().map(|l| (l.id, l.power, l.color, l.on, losses(&l.modifier))).collect();
        DevelopKey { exposure: [f_number, shutter_s, iso, white_balance_k, meter_constant], lights }
    }
}

/// Whether a picture rendered from `rendered` is still what a render of `now` would show, up to what developing the
/// film can change: each light's power, colour and switch, exposure and white balance.
pub fn is_up_to_date(film: &Film, rendered: &Scene, now: &Scene) -> bool {
    let has_layer = |id| film.layers().iter().any(|layer| layer.light == Some(id));
    let mut comparable = now.clone();
    comparable.meter = rendered.meter;
    (comparable.name, comparable.description) = (rendered.name.clone(), rendered.description.clone());
    for light in &mut comparable.lights {
        let Some(old) = rendered.light(light.id) else { continue };
        (light.name, light.role) = (old.name.clone(), old.role);
        if has_layer(light.id) {
            (light.power, light.color, light.on) = (old.power, old.color, old.on);
            let Modifier { loss_stops, scrim_stops, .. } = old.modifier;
            (light.modifier.loss_stops, light.modifier.scrim_stops) = (loss_stops, scrim_stops);
        } else if !light.on && !old.on {
            // Dark then and dark now: where it stands and what it could give does not matter.
            *light = old.clone();
        }
    }
    for object in &mut comparable.objects {
        if let Some(old) = rendered.object(object.id) {
            object.name = old.name.clone();
        }
    }
    let old = &rendered.camera;
    let camera = &mut comparable.camera;
    (camera.iso, camera.meter_constant) = (old.iso, old.meter_constant);
    // The aperture shapes the blur, and layers that several sources share hold shutter and balance already.
    if !camera.depth_of_field {
        camera.f_number = old.f_number;
        camera.focus = old.focus;
    }
    if !has_shared_layers(film, rendered) {
        (camera.shutter_s, camera.white_balance_k) = (old.shutter_s, old.white_balance_k);
    }
    comparable == *rendered
}

/// Whether some layer mixes sources: too many lights for a layer each, or surfaces that glow.
fn has_shared_layers(film: &Film, rendered: &Scene) -> bool {
    let own_layers = film.layers().iter().filter(|layer| layer.light.is_some()).count();
    let lights_on = rendered.lights.iter().filter(|light| light.on).count();
    own_layers < lights_on || rendered.has_emissive_material()
}
