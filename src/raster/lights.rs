//! Lights without shadows: what each sends to a point, in picture units.

use super::row::{Line, ROOM, Vectors, WIDTH};
use super::series;
use crate::photo::beam::{Beam, doors_transmission};
use crate::photo::emitter::{EmitterShape, IntensityDistribution};
use crate::photo::{PhotometricLight, exposure};
use crate::scene::{BarnDoors, Cone, Scene};
use glam::{Mat3A, Vec3, Vec3A};
use std::f32::consts::PI;

/// Geometry of a light as it is shaded here.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Bulbs with a size, too: outside of them they are the same. Spots, too: they have a cone.
    Point,
    /// One-sided, with its area in m2.
    Panel {
        area_m2: f32,
    },
    Sun,
}

/// One light.
#[derive(Clone, Debug)]
pub(super) struct PlacedLight {
    kind: Kind,
    /// From the eye.
    position: Vec3,
    /// Unit direction in which it shines.
    axis: Vec3,
    /// Picture units of axial intensity, or of a sun's illuminance.
    pub strength: Vec3,
    /// Of a spot, a dish, a snoot or a grid.
    cones: Vec<ConeFalloff>,
    /// Barn doors, and the way into the light's frame.
    doors: Option<(BarnDoors, Mat3A)>,
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

/// What a light sends to the pixels of a row.
#[derive(Debug)]
pub(super) struct Incident {
    /// Unit directions to the light.
    pub direction: Vectors,
    /// Cosine of the angle at which it leaves the light, from its axis.
    cos_axis: Line,
    /// Part of its strength that arrives, for a square metre that faces it; 0 where it does not shine.
    pub factor: Line,
}

impl Incident {
    pub const NONE: Self = Incident { direction: Vectors::ZERO, cos_axis: [0.0; ROOM], factor: [0.0; ROOM] };
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
            let light = PhotometricLight::new(scene, light);
            let unit = light.tint * per_unit * light.exposure_time_s;
            all.add(scene, &light, unit, eye);
        }
        all
    }

    fn add(&mut self, scene: &Scene, light: &PhotometricLight, unit: Vec3, eye: Vec3) {
        if light.shape.is_distant() && scene.room.is_some() {
            // A closed room keeps it out.
            return;
        }
        let mut cones = Vec::new();
        let strength = unit * light.axial_intensity_or_illuminance();
        let kind = match light.shape {
            EmitterShape::Point(IntensityDistribution::Isotropic) | EmitterShape::Sphere { .. } => Kind::Point,
            EmitterShape::Point(IntensityDistribution::Cone(cone)) => {
                cones.push(ConeFalloff::new(cone));
                Kind::Point
            }
            EmitterShape::Rect { half_size_m } => Kind::Panel { area_m2: 4.0 * half_size_m.x * half_size_m.y },
            EmitterShape::Disc { radius_m } => Kind::Panel { area_m2: PI * radius_m * radius_m },
            EmitterShape::Sun { .. } => Kind::Sun,
            EmitterShape::Surround => {
                self.ambient += strength;
                self.void_radiance += if light.visible_to_camera { strength / PI } else { Vec3::ZERO };
                return;
            }
        };
        if strength.is_finite() && light.world_from_light.is_finite() && strength.max_element() > 0.0 {
            cones.extend(light.beam.iter().flat_map(Beam::cones).map(ConeFalloff::new));
            let light_from_world = light.world_from_light.matrix3.transpose();
            self.lights.push(PlacedLight {
                kind,
                position: light.position() - eye,
                axis: light.axis(),
                strength,
                cones,
                doors: light.beam.as_ref().and_then(|beam| beam.doors).map(|doors| (doors, light_from_world)),
            });
        }
    }
}

impl PlacedLight {
    /// What arrives at points, which count from the eye.
    #[inline(always)]
    pub fn reach(&self, points: &Vectors, incident: &mut Incident) {
        match self.kind {
            Kind::Sun => {
                incident.direction.spread(&(0..WIDTH), -self.axis);
                incident.factor = [1.0; ROOM];
                return;
            }
            Kind::Point => self.reach_by(points, incident, |squared, _| 1.0 / squared),
            // Of a disc, on its axis: L pi R2 / (R2 + h2), exactly; far away: I cos / d2.
            Kind::Panel { area_m2 } => {
                self.reach_by(points, incident, |squared, cos| series::at_least(cos, 0.0) / (squared + area_m2 / PI));
            }
        }
        for cone in &self.cones {
            for i in 0..WIDTH {
                incident.factor[i] *= cone.at(incident.cos_axis[i]);
            }
        }
        if let Some((doors, light_from_world)) = &self.doors {
            // Asked only where there is light.
            for i in 0..WIDTH {
                if incident.factor[i] > 0.0 {
                    let away = *light_from_world * Vec3A::from(-incident.direction.at(i));
                    incident.factor[i] *= doors_transmission(doors, away.into());
                }
            }
        }
    }

    /// The same for a light whose strength goes by the squared distance and the cosine at its axis.
    #[inline(always)]
    fn reach_by(&self, points: &Vectors, incident: &mut Incident, factor: impl Fn(f32, f32) -> f32) {
        for i in 0..WIDTH {
            let to_light = self.position - points.at(i);
            let squared = series::at_least(to_light.length_squared(), 1e-12);
            let direction = to_light * (1.0 / squared.sqrt());
            let cos = -direction.dot(self.axis);
            incident.direction.set(i, direction);
            incident.cos_axis[i] = cos;
            incident.factor[i] = factor(squared, cos);
        }
    }
}

/// [`crate::photo::emitter::cone_falloff`] for many cosines.
#[derive(Clone, Copy, Debug)]
struct ConeFalloff {
    cos_inner: f32,
    cos_outer: f32,
    outer_rad: f32,
    per_rad: f32,
}

impl ConeFalloff {
    fn new(Cone { inner_deg, outer_deg }: Cone) -> Self {
        let half_rad = |full_deg: f32| (0.5 * full_deg).to_radians();
        let (inner_rad, outer_rad) = (half_rad(inner_deg.min(outer_deg)), half_rad(outer_deg));
        let per_rad = 1.0 / (outer_rad - inner_rad);
        ConeFalloff { cos_inner: inner_rad.cos(), cos_outer: outer_rad.cos(), outer_rad, per_rad }
    }

    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        let slope = series::at_most(series::at_least((self.outer_rad - series::acos(cos)) * self.per_rad, 0.0), 1.0);
        let beyond = if cos > self.cos_outer { slope } else { 0.0 };
        if cos >= self.cos_inner { 1.0 } else { beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::emitter::cone_falloff;

    #[test]
    fn a_cone_falls_off_as_everywhere_else() {
        for (inner_deg, outer_deg) in [(20.0, 40.0), (0.0, 60.0), (30.0, 30.0), (180.0, 180.0), (100.0, 300.0)] {
            let falloff = ConeFalloff::new(Cone { inner_deg, outer_deg });
            for cos in (0..=3000).map(|step| (step as f32 * 1e-3).cos()) {
                let (got, one) = (falloff.at(cos), cone_falloff(cos, inner_deg, outer_deg));
                assert!((got - one).abs() < 1e-5, "{inner_deg} {outer_deg} {cos}: {got} and {one}");
            }
        }
    }
}
