//! Lights without shadows: what each sends to a point, in picture units.

use super::packet::{LANES, Vec3x8};
use crate::color;
use crate::math::safe_acos;
use crate::photo::beam;
use crate::photo::exposure::{self, Strength};
use crate::scene::{Emitter, Light, Modifier, Scene};
use glam::{Affine3A, Vec3};
use std::f32::consts::PI;
use wide::f32x8;

/// Geometry of a light as it is shaded here.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Bulbs with a size, too: outside of them they are the same.
    Point,
    /// Half angles.
    Spot {
        inner_rad: f32,
        outer_rad: f32,
    },
    /// One-sided, with its area in m2.
    Panel {
        area_m2: f32,
    },
    Sun,
}

/// One light.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedLight {
    kind: Kind,
    world_from_light: Affine3A,
    /// From the eye.
    position: Vec3,
    /// Unit direction in which it shines.
    axis: Vec3,
    /// Picture units of axial intensity, or of a sun's illuminance.
    pub strength: Vec3,
    modifier: Option<Modifier>,
}

/// All lights that are on, as they stand about the eye.
#[derive(Debug)]
pub(super) struct Lights {
    pub lights: Vec<PlacedLight>,
    /// Irradiance from all round.
    pub ambient: Vec3,
    /// Luminance of what the camera sees where there is nothing.
    pub void_radiance: Vec3,
    /// Picture value of one cd/m2 of a surface that glows.
    pub glow: f32,
}

impl Lights {
    pub fn new(scene: &Scene, eye: Vec3) -> Self {
        let camera = &scene.camera;
        let per_unit = exposure::pixel_per_cd_s_m2(camera);
        let mut all = Lights {
            lights: Vec::new(),
            ambient: Vec3::ZERO,
            void_radiance: Vec3::ZERO,
            glow: per_unit * camera.shutter_s,
        };
        for light in scene.lights.iter().filter(|light| light.on) {
            let seconds = exposure::integration_time_s(&light.power.output, camera);
            let unit = color::light_rgb(&light.color, camera.white_balance_k) * per_unit * seconds;
            all.add(scene, light, unit, eye);
        }
        all
    }

    fn add(&mut self, scene: &Scene, light: &Light, unit: Vec3, eye: Vec3) {
        let illuminance = if let Strength::Illuminance(lux) = exposure::strength(light) { lux } else { 0.0 };
        let infinite = light.emitter.is_infinite();
        if infinite && scene.room.is_some() {
            // A closed room keeps it out.
            return;
        }
        let kind = match light.emitter {
            Emitter::Point | Emitter::Sphere { .. } => Kind::Point,
            Emitter::Spot { inner_deg, outer_deg } => {
                let half_rad = |full_deg: f32| (0.5 * full_deg).to_radians();
                Kind::Spot { inner_rad: half_rad(inner_deg.min(outer_deg)), outer_rad: half_rad(outer_deg) }
            }
            Emitter::RectPanel { width_m, height_m } => Kind::Panel { area_m2: width_m * height_m },
            Emitter::RoundPanel { diameter_m } => Kind::Panel { area_m2: 0.25 * PI * diameter_m * diameter_m },
            Emitter::Sun { .. } => Kind::Sun,
            Emitter::Surround => {
                self.ambient += unit * illuminance;
                self.void_radiance += if light.visible_to_camera { unit * illuminance / PI } else { Vec3::ZERO };
                return;
            }
        };
        let world_from_light = scene.light_frame(light);
        let strength = unit * if infinite { illuminance } else { exposure::axial_intensity(light) };
        if strength.is_finite() && world_from_light.is_finite() && strength.max_element() > 0.0 {
            let axis = -Vec3::from(world_from_light.matrix3.z_axis);
            let modifier = light.modifier.narrows().then_some(light.modifier);
            self.lights.push(PlacedLight {
                kind,
                world_from_light,
                position: light.position - eye,
                axis,
                strength,
                modifier,
            });
        }
    }
}

impl PlacedLight {
    /// Unit directions from eight points to the light, and what part of its strength arrives there, for a square metre
    /// that faces it; 0 where it does not shine.
    pub fn at(&self, points: Vec3x8) -> (Vec3x8, f32x8) {
        if let Kind::Sun = self.kind {
            return (Vec3x8::splat(-self.axis), f32x8::ONE);
        }
        let to_light = Vec3x8::splat(self.position) - points;
        let squared = to_light.dot(to_light).fast_max(f32x8::splat(1e-12));
        let direction = to_light.times(f32x8::ONE / squared.sqrt());
        let cos = -direction.dot(Vec3x8::splat(self.axis));
        let factor = match self.kind {
            Kind::Point | Kind::Sun => f32x8::ONE / squared,
            Kind::Spot { inner_rad, outer_rad } => falloff(cos, inner_rad, outer_rad) / squared,
            // Of a disc, on its axis: L pi R2 / (R2 + h2), exactly; far away: I cos / d2.
            Kind::Panel { area_m2 } => cos.fast_max(f32x8::ZERO) / (squared + f32x8::splat(area_m2 / PI)),
        };
        (direction, self.modifier.map_or(factor, |modifier| factor * self.passed(&modifier, direction, factor)))
    }

    /// What a modifier lets through, asked only where there is light.
    fn passed(&self, modifier: &Modifier, direction: Vec3x8, factor: f32x8) -> f32x8 {
        let (directions, factors) = (direction.lanes(), factor.to_array());
        let light_from_world = self.world_from_light.matrix3.transpose();
        let lane = |k: usize| {
            let away = light_from_world * glam::Vec3A::from(-directions[k]);
            if factors[k] > 0.0 { beam::passed(modifier, away.into()) } else { 0.0 }
        };
        let lanes: [f32; LANES] = std::array::from_fn(lane);
        f32x8::from(lanes)
    }
}

/// [`exposure::spot_falloff`] for eight cosines.
fn falloff(cos: f32x8, inner_rad: f32, outer_rad: f32) -> f32x8 {
    let inside = cos.simd_ge(f32x8::splat(inner_rad.cos()));
    let reached = cos.simd_gt(f32x8::splat(outer_rad.cos()));
    if !(inside ^ reached).any() {
        return inside & f32x8::ONE;
    }
    let between = |cos: f32| (outer_rad - safe_acos(cos)) / (outer_rad - inner_rad);
    let slope = f32x8::from(cos.to_array().map(between)).clamp(f32x8::ZERO, f32x8::ONE);
    inside.bitselect(f32x8::ONE, reached & slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_points_see_the_falloff_of_a_spot_that_one_would() {
        for (inner_deg, outer_deg) in [(20.0, 40.0), (0.0, 60.0), (30.0, 30.0), (180.0, 180.0)] {
            let half_rad = |full_deg: f32| (0.5 * full_deg).to_radians();
            let cosines: [f32; LANES] = std::array::from_fn(|k| half_rad(5.0 + 8.3 * k as f32).cos());
            let got = falloff(f32x8::from(cosines), half_rad(inner_deg), half_rad(outer_deg)).to_array();
            for (cos, got) in cosines.into_iter().zip(got) {
                let one = exposure::spot_falloff(cos, inner_deg, outer_deg);
                assert!((got - one).abs() < 1e-5, "{inner_deg} {outer_deg} {cos}: {got} and {one}");
            }
        }
    }
}
