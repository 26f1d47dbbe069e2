//! The scene that the live view traces after an edit.

use crate::raytrace::film::Layer;
use crate::raytrace::retrace::Retrace;
use crate::scene::{Scene, SceneChange};

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
