//! Emitters: what a point receives from each, by a chosen direction and by a ray that happens to meet it.
//!
//! Values are photometric and white (luminance of luminance 1): a light's colour is applied to its film layer.

mod disc;
mod emitter_bvh;
mod light_sampler;
mod rect;
mod sphere;

use crate::math::{orthonormal_basis, warp};
use crate::photo::PhotometricLight;
use crate::photo::beam::Beam;
use crate::photo::emitter::{EmitterShape, IntensityDistribution, cone_falloff};
use crate::scene::Cone;
use disc::Disc;
pub use emitter_bvh::EmitterBvh;
use glam::{Mat3, Vec2, Vec3, Vec3A};
pub use light_sampler::{LightImportances, LightSampler};
use rect::Rect;
use sphere::Ball;
use std::f32::consts::PI;

/// Geometry and output of a light. Positions are relative to the camera, as everywhere in the tracer.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Intensity, cd.
    Point { position: Vec3, intensity: f32 },
    /// Axial intensity, cd; unit axis; full angles.
    Spot { position: Vec3, axis: Vec3, intensity: f32, inner_deg: f32, outer_deg: f32 },
    /// Luminance, cd/m2.
    Rect { rect: Rect, luminance: f32 },
    /// Luminance, cd/m2.
    Disc { disc: Disc, luminance: f32 },
    /// Luminance, cd/m2.
    Ball { ball: Ball, luminance: f32 },
    /// Unit direction towards it; illuminance normal to it, lx; `1 - cos` of half its angular diameter, 0 for none.
    Sun { towards: Vec3, illuminance: f32, one_minus_cos: f32 },
    /// Luminance, cd/m2.
    Surround { luminance: f32 },
}

/// A light made ready for tracing.
#[derive(Clone, Debug)]
pub struct TracedLight {
    source: Source,
    /// Film layer that it adds to.
    pub layer: usize,
    /// Factor on its contributions: white where the layer holds one light (its colour is applied later), the light's
    /// colour and time where several share a layer.
    pub tint: Vec3,
    /// Seconds for which it counts in the exposure (1 for flash); used to choose between lights.
    pub time_s: f32,
    /// Whether camera rays see the emitter.
    pub visible_to_camera: bool,
    /// What a grid, a snoot or flaps leave of it, by direction.
    beam: Option<PlacedBeam>,
}

/// The angular transmission of a modifier, with the rotation into the light's frame.
#[derive(Clone, Debug)]
struct PlacedBeam {
    beam: Beam,
    light_from_world: Mat3,
}

/// A share that keeps a light with a grid in the choice between lights where its middle seems dark: its edge may not be.
const LEAST_BEAM: f32 = 0.02;

/// Light from a chosen direction.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Distance to the emitter, metres; infinite for the sun.
    pub distance: f32,
    /// Luminance over density (area lights) or illuminance normal to the direction (point, spot, sharp sun).
    pub value: f32,
    /// Density in solid angle; none for lights that only this technique can find.
    pub pdf: Option<f32>,
}

/// What a ray sees of an emitter it crosses.
#[derive(Clone, Copy, Debug)]
pub struct EmitterHit {
    /// Distance, in multiples of the unit direction; infinite for sun and surround.
    pub distance: f32,
    /// Luminance, cd/m2.
    pub luminance: f32,
}

impl TracedLight {
    /// Converts a photometric light, with positions relative to `origin`. Returns none for a light without any output.
    pub fn new(light: &PhotometricLight, origin: Vec3) -> Option<Self> {
        let PhotometricLight { world_from_light, .. } = *light;
        let position = Vec3::from(world_from_light.translation - Vec3A::from(origin));
        let [right, up, back] = [0, 1, 2].map(|i| Vec3::from(world_from_light.matrix3.col(i)));
        let (intensity, illuminance) = (light.axial_intensity(), light.illuminance());
        let source = match light.shape {
            EmitterShape::Point(IntensityDistribution::Isotropic) => Source::Point { position, intensity },
            EmitterShape::Point(IntensityDistribution::Cone(Cone { inner_deg, outer_deg })) => {
                Source::Spot { position, axis: -back, intensity, inner_deg, outer_deg }
            }
            EmitterShape::Sphere { radius_m } if radius_m > 0.0 => {
                let ball = Ball { centre: position, radius: radius_m };
                Source::Ball { ball, luminance: intensity / (PI * radius_m * radius_m) }
            }
            EmitterShape::Sphere { .. } => Source::Point { position, intensity },
            // A panel emits along -Z: right x up is +Z, so its width axis is reversed.
            EmitterShape::Rect { half_size_m } => {
                let rect = Rect::new(position, -right, up, half_size_m);
                Source::Rect { rect, luminance: intensity / rect.area() }
            }
            EmitterShape::Disc { radius_m } => {
                let disc = Disc::new(position, -right, up, radius_m);
                Source::Disc { disc, luminance: intensity / disc.area() }
            }
            EmitterShape::Sun { half_angle_rad } => {
                // 1 - cos a = 2 sin2(a / 2).
                let one_minus_cos = 2.0 * (half_angle_rad * 0.5).sin().powi(2);
                Source::Sun { towards: back, illuminance, one_minus_cos }
            }
            EmitterShape::Surround => Source::Surround { luminance: illuminance / PI },
        };
        let output = intensity.max(illuminance);
        let is_finite = output.is_finite() && world_from_light.matrix3.is_finite() && position.is_finite();
        let light_from_world = Mat3::from(world_from_light.matrix3).transpose();
        (output > 0.0 && is_finite).then(|| TracedLight {
            source,
            layer: 0,
            tint: Vec3::ONE,
            time_s: light.exposure_time_s,
            visible_to_camera: light.visible_to_camera,
            beam: light.beam.clone().map(|beam| PlacedBeam { beam, light_from_world }),
        })
    }

    /// Part of the light that its modifier lets pass in a unit direction away from it.
    fn passed(&self, away: Vec3) -> f32 {
        self.beam.as_ref().map_or(1.0, |placed| placed.beam.transmission(placed.light_from_world * away))
    }

    /// Where it is, if it is anywhere.
    fn centre(&self) -> Option<Vec3> {
        match self.source {
            Source::Point { position, .. } | Source::Spot { position, .. } => Some(position),
            Source::Rect { rect, .. } => Some(rect.centre),
            Source::Disc { disc, .. } => Some(disc.centre),
            Source::Ball { ball, .. } => Some(ball.centre),
            Source::Sun { .. } | Source::Surround { .. } => None,
        }
    }

    /// Returns true for a delta light: it has no extent, so no ray hits it.
    pub fn is_delta(&self) -> bool {
        matches!(self.source, Source::Point { .. } | Source::Spot { .. })
            || matches!(self.source, Source::Sun { one_minus_cos, .. } if one_minus_cos <= 0.0)
    }

    /// Whether choosing directions towards it helps. Not for a surround: the surface's own choice is as good.
    pub fn is_sampled(&self) -> bool {
        !matches!(self.source, Source::Surround { .. })
    }

    /// Part of the light that its beam lets pass towards a point; all of it where it has none, or no place.
    fn beam_towards(&self, point: Vec3) -> f32 {
        match (&self.beam, self.centre()) {
            (Some(_), Some(centre)) => self.passed((point - centre).normalize_or_zero()),
            _ => 1.0,
        }
    }

    /// Light that reaches `point` from a chosen place of the emitter, before shadow.
    pub fn sample(&self, point: Vec3, u: Vec2) -> Option<LightSample> {
        let sample = self.sample_source(point, u)?;
        Some(LightSample { value: sample.value * self.passed(-sample.direction), ..sample })
    }

    /// Light that reaches `point` if all of it came from the emitter's centre, before shadow. None from a surround.
    pub fn sample_centre(&self, point: Vec3) -> Option<LightSample> {
        let small = |centre: Vec3, intensity: f32, facing: Option<Vec3>| {
            let sample = from_point(point, centre, intensity)?;
            let cos = facing.map_or(1.0, |facing| -sample.direction.dot(facing));
            (cos > 0.0).then_some(LightSample { value: sample.value * cos, ..sample })
        };
        let sample = match self.source {
            Source::Point { .. } | Source::Spot { .. } => self.sample_source(point, Vec2::splat(0.5)),
            Source::Rect { rect, luminance } => small(rect.centre, luminance * rect.area(), Some(rect.normal())),
            Source::Disc { disc, luminance } => small(disc.centre, luminance * disc.area(), Some(disc.normal())),
            Source::Ball { ball, luminance } => small(ball.centre, luminance * PI * ball.radius * ball.radius, None),
            Source::Sun { towards, illuminance, .. } => {
                Some(LightSample { direction: towards, distance: f32::INFINITY, value: illuminance, pdf: None })
            }
            Source::Surround { .. } => None,
        }?;
        Some(LightSample { value: sample.value * self.passed(-sample.direction), ..sample })
    }

    /// Luminance of a surround, cd/m2.
    pub fn surround_luminance(&self) -> Option<f32> {
        if let Source::Surround { luminance } = self.source { Some(luminance) } else { None }
    }

    /// The same without its beam.
    fn sample_source(&self, point: Vec3, u: Vec2) -> Option<LightSample> {
        match self.source {
            Source::Point { position, intensity } => from_point(point, position, intensity),
            Source::Spot { position, axis, intensity, inner_deg, outer_deg } => {
                let cos = (point - position).normalize_or_zero().dot(axis);
                let falloff = cone_falloff(cos, inner_deg, outer_deg);
                if falloff > 0.0 { from_point(point, position, intensity * falloff) } else { None }
            }
            Source::Rect { rect, luminance } => {
                if !shines_on(point, rect.centre, rect.normal()) {
                    return None;
                }
                let (target, pdf) = rect.seen_from(point).sample(point, u)?;
                towards(point, target, luminance, pdf)
            }
            Source::Disc { disc, luminance } => {
                if !shines_on(point, disc.centre, disc.normal()) {
                    return None;
                }
                let (target, pdf) = disc.sample(point, u)?;
                towards(point, target, luminance, pdf)
            }
            Source::Ball { ball, luminance } => {
                let (direction, distance, pdf) = ball.sample(point, u)?;
                Some(LightSample { direction, distance, value: luminance / pdf, pdf: Some(pdf) })
            }
            Source::Sun { towards, illuminance, one_minus_cos } => {
                if one_minus_cos <= 0.0 {
                    return Some(LightSample {
                        direction: towards,
                        distance: f32::INFINITY,
                        value: illuminance,
                        pdf: None,
                    });
                }
                let (tangent, bitangent) = orthonormal_basis(towards);
                let local = warp::uniform_cone(u, one_minus_cos);
                let direction = (tangent * local.x + bitangent * local.y + towards * local.z).normalize();
                let pdf = warp::uniform_cone_pdf(one_minus_cos);
                let value = sun_luminance(illuminance, one_minus_cos) / pdf;
                Some(LightSample { direction, distance: f32::INFINITY, value, pdf: Some(pdf) })
            }
            Source::Surround { .. } => None,
        }
    }

    /// What a ray (unit direction) sees of the emitter if nothing is in between.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<EmitterHit> {
        let seen = self.intersect_source(origin, direction)?;
        Some(EmitterHit { luminance: seen.luminance * self.passed(-direction), ..seen })
    }

    fn intersect_source(&self, origin: Vec3, direction: Vec3) -> Option<EmitterHit> {
        match self.source {
            Source::Point { .. } | Source::Spot { .. } => None,
            Source::Rect { rect, luminance } => {
                let front = direction.dot(rect.normal()) < 0.0;
                front
                    .then(|| rect.intersect(origin, direction))
                    .flatten()
                    .map(|distance| EmitterHit { distance, luminance })
            }
            Source::Disc { disc, luminance } => {
                let front = direction.dot(disc.normal()) < 0.0;
                front
                    .then(|| disc.intersect(origin, direction))
                    .flatten()
                    .map(|distance| EmitterHit { distance, luminance })
            }
            Source::Ball { ball, luminance } => {
                ball.intersect(origin, direction).map(|distance| EmitterHit { distance, luminance })
            }
            Source::Sun { towards, illuminance, one_minus_cos } => {
                // |d - t|2 / 2 is 1 - cos without cancellation.
                let inside = 0.5 * (direction - towards).length_squared() <= one_minus_cos;
                (inside && one_minus_cos > 0.0).then(|| EmitterHit {
                    distance: f32::INFINITY,
                    luminance: sun_luminance(illuminance, one_minus_cos),
                })
            }
            Source::Surround { luminance } => Some(EmitterHit { distance: f32::INFINITY, luminance }),
        }
    }

    /// Density with which [`TracedLight::sample`] chooses a direction that meets the emitter at `distance`, 1/sr.
    pub fn pdf(&self, point: Vec3, direction: Vec3, distance: f32) -> f32 {
        match self.source {
            Source::Rect { rect, .. } => rect.seen_from(point).pdf(point, point + direction * distance),
            Source::Disc { disc, .. } => disc.pdf(point, point + direction * distance),
            Source::Ball { ball, .. } => ball.pdf(point),
            Source::Sun { one_minus_cos, .. } => warp::uniform_cone_pdf(one_minus_cos),
            Source::Point { .. } | Source::Spot { .. } | Source::Surround { .. } => 0.0,
        }
    }
}

/// Luminance of a sun of illuminance E: E / (pi sin2 a).
fn sun_luminance(illuminance: f32, one_minus_cos: f32) -> f32 {
    illuminance / (PI * one_minus_cos * (2.0 - one_minus_cos))
}

fn from_point(point: Vec3, position: Vec3, intensity: f32) -> Option<LightSample> {
    let to = position - point;
    let distance = to.length();
    let value = intensity / (distance * distance);
    (distance > 0.0 && value.is_finite()).then(|| LightSample { direction: to / distance, distance, value, pdf: None })
}

fn towards(point: Vec3, target: Vec3, luminance: f32, pdf: f32) -> Option<LightSample> {
    let to = target - point;
    let distance = to.length();
    (distance > 0.0).then(|| LightSample { direction: to / distance, distance, value: luminance / pdf, pdf: Some(pdf) })
}

/// Whether a point lies before a panel.
fn shines_on(point: Vec3, centre: Vec3, normal: Vec3) -> bool {
    (point - centre).dot(normal) > 0.0
}

#[cfg(test)]
mod tests;
