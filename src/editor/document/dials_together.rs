//! The dials of several lights, turned together.

use crate::scene::Light;

/// Returns the lights with their dials turned by so many stops, each to a setting that its head has. The step is the same
/// for all, so that the ratios between the lights stay: at least a setting of the coarsest dial. None if a head can't go
/// so far.
pub fn turned_together(lights: &[&Light], stops: f32) -> Option<Vec<Light>> {
    let dials = || lights.iter().filter_map(|light| Some((light.head.as_ref()?.dial, light.power.dial_stops)));
    let step = dials().map(|(dial, now)| dial.step_stops(now)).fold(stops.abs(), f32::max).copysign(stops);
    if dials().any(|(dial, now)| dial.beyond(dial.nearest(now) + step).is_some()) {
        return None;
    }
    let turned = |light: &&Light| {
        let mut light = (*light).clone();
        let now = light.power.dial_stops;
        light.power.dial_stops = light.head.as_ref().map_or(now + step, |head| head.dial.moved(now, step));
        light
    };
    Some(lights.iter().map(turned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{DialScale, Emitter, Head, HeadDial, Output};

    fn light(dial_stops: f32, steps_per_stop: Option<u8>) -> Light {
        let mut light = Light::new(Emitter::Point, Output::Lumens(1000.0));
        light.power.dial_stops = dial_stops;
        light.head = steps_per_stop.map(|steps_per_stop| Head {
            name: "A".to_owned(),
            dial: HeadDial { scale: DialScale::Fractions, lowest_stops: -6.0, steps_per_stop },
            sync_s: None,
            hss_loss_stops: None,
            t01_s: None,
        });
        light
    }

    fn turned(lights: &[Light], stops: f32) -> Option<Vec<f32>> {
        let lights = turned_together(&lights.iter().collect::<Vec<_>>(), stops)?;
        Some(lights.iter().map(|light| light.power.dial_stops).collect())
    }

    #[test]
    fn several_lights_keep_their_ratios_and_go_to_settings_that_their_heads_have() {
        let lights = [light(-2.0, Some(3)), light(-1.0, Some(10)), light(-0.5, None)];
        let up = turned(&lights, 1.0).unwrap();
        assert_eq!(up, [-1.0, 0.0, 0.5]);
        let thirds = turned(&lights, 1.0 / 3.0).unwrap();
        assert!((thirds[0] + 5.0 / 3.0).abs() < 1e-6 && (thirds[1] + 0.7).abs() < 1e-6, "{thirds:?}");
        assert_eq!(turned(&[light(-2.0, Some(3)), light(-0.5, Some(10))], 1.0), None, "no head stays behind");
        assert_eq!(turned(&[light(-2.0, None), light(-5.5, Some(10))], -1.0), None);
        let whole = turned(&[light(-2.0, Some(3)), light(-1.0, Some(1)), light(-3.0, None)], -1.0 / 3.0).unwrap();
        assert_eq!(whole, [-3.0, -2.0, -4.0], "a dial in whole stops turns the others by whole stops");
    }
}
