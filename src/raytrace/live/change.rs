//! The scene that the live view traces after an edit.

use crate::raytrace::film::Layer;
use crate::raytrace::retrace::Retrace;
use crate::scene::{Scene, SceneChange, Shape};

/// Returns the scene to trace so that a film of `layers`, traced from `traced`, shows `now`, and what of it must be
/// traced again. The scene's camera plays no part: the live view has its own. A light whose layer stays has the power,
/// colour and switch that were traced; developing applies the current ones.
pub fn between(traced: &Scene, layers: &[Layer], now: &Scene) -> (Scene, Retrace) {
    let retrace = Retrace::after(&SceneChange::between(traced, now), layers, traced, now);
    let mut to_trace = now.clone();
    let retraced = match &retrace {
        Retrace::Nothing => &[][..],
        Retrace::Lights(lights) => lights,
        Retrace::Everything => return (to_trace, retrace),
    };
    to_trace.camera = traced.camera.clone();
    for light in to_trace.lights.iter_mut().filter(|light| !retraced.contains(&light.id)) {
        if let Some(old) = traced.light(light.id) {
            *light = old.clone();
        }
    }
    (to_trace, retrace)
}

/// Returns true if nothing but the water of tanks has moved on since a film of `layers` was traced from `traced`.
pub fn only_flows(traced: &Scene, layers: &[Layer], now: &Scene) -> bool {
    let is_tank = |object: &crate::scene::Object| matches!(object.shape, Shape::Tank(_));
    if !now.objects.iter().any(is_tank) {
        return false;
    }
    let (mut still, mut flows) = (now.clone(), false);
    for (object, old) in still.objects.iter_mut().zip(&traced.objects) {
        if let (Shape::Tank(tank), Shape::Tank(before)) = (&object.shape, &old.shape)
            && tank != before
            && tank.at_start() == before.at_start()
        {
            (object.shape, flows) = (old.shape.clone(), true);
        }
    }
    flows && Retrace::after(&SceneChange::between(traced, &still), layers, traced, &still) == Retrace::Nothing
}
