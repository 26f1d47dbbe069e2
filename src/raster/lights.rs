//! Lights without shadows, in picture units, and their light at the points of a row.

use super::gbuffer_row::{PADDED_WIDTH, RowScalar, RowVec3, WIDTH};
use crate::math::approx::{self, max, min};
use crate::photo::beam::{Beam, doors_transmission};
use crate::photo::emitter::{EmitterShape, IntensityDistribution};
use crate::photo::{MeasuredBeam, PhotometricLight, exposure};
use crate::scene::{Assets, BarnDoors, Cone, Scene};
use glam::{Mat3A, Vec3, Vec3A};
use std::f32::consts::PI;

/// The geometry term of a light.
#[derive(Clone, Copy, Debug)]
enum LightKind {
    /// Points, spots (with a cone), and spheres, whose light outside of them is that of a point.
    Point,
    /// One-sided panels.
    Panel {
        area_m2: f32,
    },
    Sun,
}

/// One light.
#[derive(Clone, Debug)]
pub(super) struct RasterLight {
    kind: LightKind,
    /// Position relative to the eye.
    position: Vec3,
    /// Unit direction in which it shines.
    axis: Vec3,
    /// Axial intensity, or illuminance of a sun, in picture units.
    pub strength: Vec3,
    /// Cones of a spot, a dish, a snoot and a grid; their falloffs multiply.
    cones: Vec<ConeFalloff>,
    /// Barn doors, and the rotation from world space into the light's frame.
    doors: Option<(BarnDoors, Mat3A)>,
    /// Measured distribution, and the same rotation.
    measured: Option<(MeasuredBeam, Mat3A)>,
}

/// The lights that are on.
#[derive(Debug)]
pub(super) struct RasterLights {
    pub lights: Vec<RasterLight>,
    /// Irradiance from the surround, picture units.
    pub ambient_irradiance: Vec3,
    /// Radiance of pixels that show no surface, picture units.
    pub background_radiance: Vec3,
    /// Picture value of 1 cd/m2 of an emissive surface.
    pub emission_scale: f32,
}

/// The light of one source at the points of a row.
#[derive(Debug)]
pub(super) struct IncidentLight {
    /// Unit directions to the light.
    pub direction: RowVec3,
    /// Cosine between the light's axis and the direction to the point.
    cos_axis: RowScalar,
    /// Irradiance on a surface that faces the light, over its strength; 0 where it does not shine.
    pub factor: RowScalar,
}

impl IncidentLight {
    pub const ZERO: Self =
        IncidentLight { direction: RowVec3::ZERO, cos_axis: [0.0; PADDED_WIDTH], factor: [0.0; PADDED_WIDTH] };
}

impl RasterLights {
    pub fn new(scene: &Scene, assets: &Assets, eye: Vec3) -> Self {
        let pixel_per_cd_s_m2 = exposure::pixel_per_cd_s_m2(scene);
        let mut all = RasterLights {
            lights: Vec::new(),
            ambient_irradiance: Vec3::ZERO,
            background_radiance: Vec3::ZERO,
            emission_scale: pixel_per_cd_s_m2 * scene.camera.shutter_s,
        };
        for light in scene.lights.iter().filter(|light| light.on) {
            let light = PhotometricLight::new(scene, assets, light);
            // A closed room blocks distant lights
            if light.shape.is_distant() && scene.room.is_some() {
                continue;
            }
            all.add(&light, light.tint * pixel_per_cd_s_m2 * light.exposure_time_s, eye);
        }
        all
    }

    /// Adds a light, with the picture value of each unit of it.
    fn add(&mut self, light: &PhotometricLight, scale: Vec3, eye: Vec3) {
        let mut cones = Vec::new();
        let strength = scale * light.axial_intensity_or_illuminance();
        let kind = match light.shape {
            EmitterShape::Point(IntensityDistribution::Isotropic) | EmitterShape::Sphere { .. } => LightKind::Point,
            EmitterShape::Point(IntensityDistribution::Cone(cone)) => {
                cones.push(ConeFalloff::new(cone));
                LightKind::Point
            }
            EmitterShape::Rect { half_size_m } => LightKind::Panel { area_m2: 4.0 * half_size_m.x * half_size_m.y },
            EmitterShape::Disc { radius_m } => LightKind::Panel { area_m2: PI * radius_m * radius_m },
            EmitterShape::Sun { .. } => LightKind::Sun,
            EmitterShape::Surround => {
                // An environment map is its mean, without directions
                let mean = light
                    .environment
                    .as_ref()
                    .map_or(Vec3::ONE, |environment| environment.mean_color() * environment.mean_relative_luminance());
                let strength = strength * mean;
                self.ambient_irradiance += strength;
                self.background_radiance += if light.visible_to_camera { strength / PI } else { Vec3::ZERO };
                return;
            }
        };
        if strength.is_finite() && light.world_from_light.is_finite() && strength.max_element() > 0.0 {
            cones.extend(light.beam.iter().flat_map(Beam::cones).map(ConeFalloff::new));
            let light_from_world = light.world_from_light.matrix3.transpose();
            self.lights.push(RasterLight {
                kind,
                position: light.position() - eye,
                axis: light.axis(),
                strength,
                cones,
                doors: light.beam.as_ref().and_then(|beam| beam.doors).map(|doors| (doors, light_from_world)),
                measured: light.measured().map(|measured| (measured.clone(), light_from_world)),
            });
        }
    }
}

impl RasterLight {
    /// Computes the light at points relative to the eye.
    #[inline(always)]
    pub fn illuminate(&self, points: &RowVec3, incident: &mut IncidentLight) {
        // Direction and distance falloff
        match self.kind {
            LightKind::Sun => {
                incident.direction.splat(&(0..WIDTH), -self.axis);
                incident.factor = [1.0; PADDED_WIDTH];
                return;
            }
            LightKind::Point => self.illuminate_by(points, incident, |squared, _| 1.0 / squared),
            // Of a disc, on its axis: L pi R2 / (R2 + h2), exactly; far away: I cos / d2.
            LightKind::Panel { area_m2 } => {
                self.illuminate_by(points, incident, |squared, cos| max(cos, 0.0) / (squared + area_m2 / PI));
            }
        }
        // Cones of the spot and its modifier
        for cone in &self.cones {
            for i in 0..WIDTH {
                incident.factor[i] *= cone.at(incident.cos_axis[i]);
            }
        }
        // Barn doors, only where there is light
        if let Some((doors, light_from_world)) = &self.doors {
            for i in 0..WIDTH {
                if incident.factor[i] > 0.0 {
                    let away_light = *light_from_world * Vec3A::from(-incident.direction.at(i));
                    incident.factor[i] *= doors_transmission(doors, away_light.into());
                }
            }
        }
        // Measured distribution, only where there is light
        if let Some((measured, light_from_world)) = &self.measured {
            for i in 0..WIDTH {
                if incident.factor[i] > 0.0 {
                    let away_light = *light_from_world * Vec3A::from(-incident.direction.at(i));
                    incident.factor[i] *= measured.factor(away_light.into());
                }
            }
        }
    }

    /// Computes direction, axis cosine and factor, which is a function of squared distance and axis cosine.
    #[inline(always)]
    fn illuminate_by(&self, points: &RowVec3, incident: &mut IncidentLight, factor: impl Fn(f32, f32) -> f32) {
        for i in 0..WIDTH {
            let to_light = self.position - points.at(i);
            let squared = max(to_light.length_squared(), 1e-12);
            let direction = to_light * (1.0 / squared.sqrt());
            let cos = -direction.dot(self.axis);
            incident.direction.set(i, direction);
            incident.cos_axis[i] = cos;
            incident.factor[i] = factor(squared, cos);
        }
    }
}

/// A branch-free [`crate::photo::emitter::cone_falloff`].
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

    /// Returns the falloff by the cosine against the axis, 0 to 1.
    #[inline(always)]
    fn at(&self, cos: f32) -> f32 {
        let slope = min(max((self.outer_rad - approx::acos(cos)) * self.per_rad, 0.0), 1.0);
        let outside_inner = if cos > self.cos_outer { slope } else { 0.0 };
        if cos >= self.cos_inner { 1.0 } else { outside_inner }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::emitter::cone_falloff;

    #[test]
    fn the_approximated_cone_falloff_agrees_with_the_exact_one() {
        for (inner_deg, outer_deg) in [(20.0, 40.0), (0.0, 60.0), (30.0, 30.0), (180.0, 180.0), (100.0, 300.0)] {
            let falloff = ConeFalloff::new(Cone { inner_deg, outer_deg });
            for cos in (0..=3000).map(|step| (step as f32 * 1e-3).cos()) {
                let (approximate, exact) = (falloff.at(cos), cone_falloff(cos, inner_deg, outer_deg));
                assert!((approximate - exact).abs() < 1e-5, "{inner_deg} {outer_deg} {cos}: {approximate} and {exact}");
            }
        }
    }
}
