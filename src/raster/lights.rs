//! Lights without shadows: what each sends to a point, in picture units.

use crate::color;
use crate::photo::beam;
use crate::photo::exposure::{self, Strength};
use crate::scene::{Emitter, Light, Modifier, Scene};
use glam::{Affine3A, Vec3};
use std::f32::consts::PI;

/// Geometry of a light as it is shaded here.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Bulbs with a size, too: outside of them they are the same.
    Point,
    Spot {
        inner_deg: f32,
        outer_deg: f32,
        cos_inner: f32,
        cos_outer: f32,
    },
    /// One-sided, with its area in m2.
    Panel {
        area_m2: f32,
    },
    Sun,
}

/// One light.
#[derive(Clone, Copy, Debug)]
struct PlacedLight {
    kind: Kind,
    world_from_light: Affine3A,
    position: Vec3,
    /// Unit direction in which it shines.
    axis: Vec3,
    /// Picture units of axial intensity, or of a sun's illuminance.
    strength: Vec3,
    modifier: Option<Modifier>,
}

/// All lights that are on.
#[derive(Debug)]
pub(super) struct Lights {
    lights: Vec<PlacedLight>,
    /// Irradiance from all round.
    pub ambient: Vec3,
    /// Luminance of what the camera sees where there is nothing.
    pub void_radiance: Vec3,
    /// Picture value of one cd/m2 of a surface that glows.
    pub glow: f32,
}

impl Lights {
    pub fn new(scene: &Scene) -> Self {
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
            all.add(scene, light, unit);
        }
        all
    }

    fn add(&mut self, scene: &Scene, light: &Light, unit: Vec3) {
        let illuminance = if let Strength::Illuminance(lux) = exposure::strength(light) { lux } else { 0.0 };
        let infinite = light.emitter.is_infinite();
        if infinite && scene.room.is_some() {
            // A closed room keeps it out.
            return;
        }
        let kind = match light.emitter {
            Emitter::Point | Emitter::Sphere { .. } => Kind::Point,
            Emitter::Spot { inner_deg, outer_deg } => {
                let cos = |full_deg: f32| (0.5 * full_deg).to_radians().cos();
                Kind::Spot { inner_deg, outer_deg, cos_inner: cos(inner_deg.min(outer_deg)), cos_outer: cos(outer_deg) }
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
                position: light.position,
                axis,
                strength,
                modifier,
            });
        }
    }

    /// Unit direction to each light that reaches a point, and its illuminance normal to that direction.
    pub fn at(&self, point: Vec3) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.lights.iter().filter_map(move |light| light.at(point))
    }
}

impl PlacedLight {
    fn at(&self, point: Vec3) -> Option<(Vec3, Vec3)> {
        if let Kind::Sun = self.kind {
            return Some((-self.axis, self.strength));
        }
        let to_light = self.position - point;
        let squared = to_light.length_squared().max(1e-12);
        let direction = to_light / squared.sqrt();
        let cos = -direction.dot(self.axis);
        let factor = match self.kind {
            Kind::Point | Kind::Sun => 1.0 / squared,
            Kind::Spot { cos_inner, .. } if cos >= cos_inner => 1.0 / squared,
            Kind::Spot { cos_outer, .. } if cos <= cos_outer => return None,
            Kind::Spot { inner_deg, outer_deg, .. } => exposure::spot_falloff(cos, inner_deg, outer_deg) / squared,
            Kind::Panel { .. } if cos <= 0.0 => return None,
            // Of a disc, on its axis: L pi R2 / (R2 + h2), exactly; far away: I cos / d2.
            Kind::Panel { area_m2 } => cos / (squared + area_m2 / PI),
        };
        let passed = self.modifier.map_or(1.0, |modifier| {
            let away = self.world_from_light.matrix3.transpose() * glam::Vec3A::from(-direction);
            beam::passed(&modifier, away.into())
        });
        Some((direction, self.strength * (factor * passed)))
    }
}
