//! The moments of an exposure: water in motion is traced at several times, with the light that each lamp gives then.
//!
//! A flash lights the water for its own duration, continuous light for as long as the shutter is open. The exposure is
//! divided into intervals of equal probability, in each of which the lights have their share of their energy. Each
//! sample of a pixel and each photon has one of them by chance: the expected light is that of the whole exposure, for
//! each light its own. Without water that moves by a pixel there is one moment, the time of the tank.
//!
//! A flash rises at once and decays exponentially: it is over a tenth of its peak for t0.1, which is ln 10 times its time
//! constant (3.3 times t0.5, over half of the peak). It fires at the tank's time, when the shutter opens. A head without a
//! t0.1 freezes everything; a dial does not change it.

use super::lights::TracedLight;
use crate::scene::{Assets, Camera, Light, Mesh, Scene, Shape};
use std::f64::consts::LN_10;
use std::sync::Arc;

/// Largest number of moments.
const MAX_MOMENTS: usize = 16;
/// Longer side of the picture by whose pixels the blur is judged, pixels.
const LONG_EDGE_PX: f32 = 2000.0;
/// Blur that is left out, pixels.
const UNSEEN_PX: f32 = 0.5;
/// Part of the exposure's light within which the motion of the water is measured.
const BLUR_LIGHT_PART: f64 = 0.9;
/// Time constant of a flash that freezes everything, seconds.
const FROZEN_S: f64 = 1e-7;
/// Time constants after which the rest of a flash, a thousandth, counts as given.
const FLASH_END_TIME_CONSTANTS: f64 = 7.0;

/// The light of a lamp over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pulse {
    /// A flash that decays with a time constant, seconds.
    Flash { decay_s: f64 },
    /// Continuous light through the open shutter, seconds.
    Continuous { open_s: f64 },
}

/// An interval of the exposure.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    /// Time after the tank's at which the water is shown, seconds.
    time_s: f32,
    start_s: f64,
    /// Infinite for the last one.
    end_s: f64,
    /// Its probability.
    probability: f64,
}

impl Pulse {
    /// Returns the pulse of a light.
    pub fn of(light: &Light, camera: &Camera) -> Self {
        if !light.power.output.is_flash() {
            return Pulse::open(camera);
        }
        let t01_s = light.head.as_ref().and_then(|head| head.t01_s).map_or(0.0, f64::from);
        Pulse::Flash { decay_s: (t01_s / LN_10).max(FROZEN_S) }
    }

    /// Returns the pulse of continuous light.
    fn open(camera: &Camera) -> Self {
        Pulse::Continuous { open_s: f64::from(camera.shutter_s) }
    }

    /// Returns the part of the light that is given by a time after its start, 0 to 1.
    fn given(self, time_s: f64) -> f64 {
        match self {
            Pulse::Flash { decay_s } => 1.0 - (-time_s / decay_s).exp(),
            Pulse::Continuous { open_s } => (time_s / open_s).min(1.0),
        }
    }

    fn end_s(self) -> f64 {
        match self {
            Pulse::Flash { decay_s } => FLASH_END_TIME_CONSTANTS * decay_s,
            Pulse::Continuous { open_s } => open_s,
        }
    }
}

impl Moment {
    /// Returns the mesh as it is in this moment.
    pub fn moved(&self, mesh: Arc<Mesh>) -> Arc<Mesh> {
        if mesh.velocities.is_empty() { mesh } else { Arc::new(mesh.moved(self.time_s)) }
    }

    /// Gives a light the output that it has in this moment.
    pub fn dim(&self, traced: &mut TracedLight, light: &Light, camera: &Camera) {
        let factor = self.factor(Pulse::of(light, camera));
        traced.tint *= factor;
        // It is sampled by its importance
        traced.time_s *= factor;
    }

    /// Returns the factor of continuous light in this moment.
    pub fn of_continuous_light(&self, camera: &Camera) -> f32 {
        self.factor(Pulse::open(camera))
    }

    /// Returns the part of a light that falls in this moment, over the probability of the moment. Its mean over the
    /// moments is 1.
    fn factor(&self, pulse: Pulse) -> f32 {
        let end = if self.end_s.is_finite() { pulse.given(self.end_s) } else { 1.0 };
        ((end - pulse.given(self.start_s)) / self.probability) as f32
    }
}

/// Returns the moments of a scene's exposure; none if one time shows all of it.
pub(super) fn of(scene: &Scene, assets: &Assets) -> Vec<Moment> {
    let Some(angular_speed) = angular_speed(scene, assets) else { return Vec::new() };
    let lights = scene.lights.iter().filter(|light| light.on);
    let mut pulses: Vec<Pulse> = lights.map(|light| Pulse::of(light, &scene.camera)).collect();
    if scene.has_emissive_material() {
        pulses.push(Pulse::open(&scene.camera));
    }
    if pulses.is_empty() {
        return Vec::new();
    }
    let blur_px = angular_speed * time_of(&pulses, BLUR_LIGHT_PART) as f32 * LONG_EDGE_PX;
    if blur_px < UNSEEN_PX {
        return Vec::new();
    }
    divide(&pulses, (blur_px.ceil() as usize).clamp(2, MAX_MOMENTS))
}

/// Divides an exposure into intervals in which the lights together give equal parts.
fn divide(pulses: &[Pulse], count: usize) -> Vec<Moment> {
    let time_after = |intervals: f64| time_of(pulses, intervals / count as f64);
    let interval = |index: usize| Moment {
        time_s: time_after(index as f64 + 0.5) as f32,
        start_s: if index == 0 { 0.0 } else { time_after(index as f64) },
        end_s: if index + 1 == count { f64::INFINITY } else { time_after(index as f64 + 1.0) },
        probability: 1.0 / count as f64,
    };
    (0..count).map(interval).collect()
}

/// Returns the time by which the lights have given a part of their light, in the mean.
fn time_of(pulses: &[Pulse], part: f64) -> f64 {
    let given = |time_s: f64| pulses.iter().map(|pulse| pulse.given(time_s)).sum::<f64>() / pulses.len() as f64;
    let end_s = pulses.iter().map(|pulse| pulse.end_s()).fold(0.0, f64::max);
    let (mut low, mut high) = (0.0, end_s);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if given(middle) < part { low = middle } else { high = middle }
    }
    high
}

/// Returns the largest speed of what moves, in widths of the picture a second; none if nothing does.
fn angular_speed(scene: &Scene, assets: &Assets) -> Option<f32> {
    let camera = &scene.camera;
    let width_at_1_m = camera.sensor.size_mm().max_element() / camera.focal_length_mm;
    let tanks = scene.objects.iter().filter(|object| object.visible && matches!(object.shape, Shape::Tank(_)));
    let speeds = tanks.filter_map(|object| {
        let mesh = assets.mesh_of(&object.shape)?;
        let fastest = mesh.velocities.iter().map(|velocity| velocity.length()).reduce(f32::max)?;
        let world_from_object = object.transform.world_from_object();
        let (low, high) = mesh.bounds();
        let distance_m = camera.position.distance(world_from_object.transform_point3(0.5 * (low + high)));
        let axes = &world_from_object.matrix3;
        let scale = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.length()).into_iter().fold(0.0, f32::max);
        let speed_m_s = fastest * scale;
        Some(speed_m_s / (width_at_1_m * distance_m).max(f32::MIN_POSITIVE))
    });
    speeds.filter(|speed| *speed > 0.0 && speed.is_finite()).reduce(f32::max)
}

/// Returns true if a finished film of one scene lacks the light of another: water moves in it, and a light that both have
/// shines for another time.
pub(super) fn differ(traced: &Scene, now: &Scene) -> bool {
    let flows = |object: &crate::scene::Object| matches!(&object.shape, Shape::Tank(tank) if object.visible && tank.fluid.is_some());
    let has_other_pulse = |light: &Light| {
        traced.light(light.id).is_some_and(|old| Pulse::of(old, &traced.camera) != Pulse::of(light, &now.camera))
    };
    traced.objects.iter().any(flows) && now.lights.iter().any(has_other_pulse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Head, HeadDial, Object, Output, Tank};

    #[test]
    fn every_light_gives_its_whole_light_over_the_moments() {
        let flash = |t01_s: f64| Pulse::Flash { decay_s: (t01_s / LN_10).max(FROZEN_S) };
        let pulses = [flash(0.0), flash(1.0 / 5000.0), flash(1.0 / 300.0), Pulse::Continuous { open_s: 0.008 }];
        for mix in [&pulses[..], &pulses[1..2], &pulses[2..], &pulses[3..]] {
            let moments = divide(mix, 16);
            for pulse in pulses {
                let mean = moments.iter().map(|moment| moment.factor(pulse)).sum::<f32>() / 16.0;
                assert!((mean - 1.0).abs() < 1e-5, "{pulse:?}: {mean}");
            }
            // The lights together are as bright in each
            for moment in &moments {
                let mean = mix.iter().map(|pulse| moment.factor(*pulse)).sum::<f32>() / mix.len() as f32;
                assert!((mean - 1.0).abs() < 0.03, "{moment:?}: {mean}");
            }
            assert!(moments.windows(2).all(|pair| pair[0].time_s <= pair[1].time_s));
        }
        // One light alone: evenly lit moments
        let alone = divide(&pulses[3..], 4);
        let times: Vec<f32> = alone.iter().map(|moment| 1000.0 * moment.time_s).collect();
        assert!(
            times.iter().zip([1.0, 3.0, 5.0, 7.0]).all(|(time, expected)| (time - expected).abs() < 1e-4),
            "{times:?}"
        );
    }

    #[test]
    fn a_flash_of_another_duration_makes_a_picture_of_moving_water_stale() {
        let head =
            |t01_s| Head { name: String::new(), dial: HeadDial::UNKNOWN, sync_s: None, hss_loss_stops: None, t01_s };
        let studio = |fluid: bool, t01_s: f32, shutter_s: f32| {
            let tank = Tank { fluid: fluid.then(Box::default), ..Tank::default() };
            let flash = Output::FlashGuideNumber(40.0);
            let lights = vec![Light { head: Some(head(Some(t01_s))), ..Light::new(Emitter::Point, flash) }];
            let camera = Camera { shutter_s, ..Camera::default() };
            let objects = vec![Object::new("Tank", Shape::Tank(Box::new(tank)))];
            Scene { objects, lights, camera, ..Scene::default() }
        };
        assert!(differ(&studio(true, 0.001, 0.01), &studio(true, 0.002, 0.01)));
        assert!(!differ(&studio(false, 0.001, 0.01), &studio(false, 0.002, 0.01)));
        // The shutter is of no account for a flash
        assert!(!differ(&studio(true, 0.001, 0.01), &studio(true, 0.001, 0.02)));
        let mut bulb = studio(true, 0.001, 0.01);
        bulb.lights[0].power.output = Output::Lumens(100.0);
        let mut longer = bulb.clone();
        longer.camera.shutter_s = 0.02;
        assert!(differ(&bulb, &longer) && !differ(&bulb, &bulb.clone()));
    }

    #[test]
    fn a_flash_is_at_a_tenth_after_t01_and_at_half_after_less_than_a_third_of_it() {
        let Pulse::Flash { decay_s } = (Pulse::Flash { decay_s: 0.001 / LN_10 }) else { unreachable!() };
        let level = |time_s: f64| (-time_s / decay_s).exp();
        assert!((level(0.001) - 0.1).abs() < 1e-9);
        assert!((level(0.001 / std::f64::consts::LOG2_10) - 0.5).abs() < 1e-4);
    }
}
