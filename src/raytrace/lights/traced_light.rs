//! A light prepared for tracing: light sampling with its density, and intersection of rays with its emitter.

use super::disc::Disc;
use super::rect::Rect;
use super::sphere::Sphere;
use super::sun::SunDisc;
use crate::math::angle_between;
use crate::photo::beam::Beam;
use crate::photo::emitter::{EmitterShape, IntensityDistribution, cone_falloff_at};
use crate::photo::{EnvironmentLight, PhotometricLight};
use crate::raytrace::geometry::PassedBodies;
use crate::scene::{Cone, LightId};
use glam::{Mat3, Vec2, Vec3, Vec3A};
use std::f32::consts::PI;

/// Geometry and output of a light. Positions are relative to the camera, as everywhere in the ray tracer.
#[derive(Clone, Copy, Debug)]
pub(super) enum LightSource {
    /// Intensity, cd.
    Point { position: Vec3, intensity: f32 },
    /// Axial intensity, cd; unit axis; full angles.
    Spot { position: Vec3, axis: Vec3, intensity: f32, inner_deg: f32, outer_deg: f32 },
    /// Luminance, cd/m2.
    Rect { rect: Rect, luminance: f32 },
    /// Luminance, cd/m2.
    Disc { disc: Disc, luminance: f32 },
    /// Luminance, cd/m2.
    Sphere { sphere: Sphere, luminance: f32 },
    /// The sun, a cone of directions.
    Sun(SunDisc),
    /// Luminance, cd/m2, from every direction.
    Surround { luminance: f32 },
}

/// A light prepared for tracing.
#[derive(Clone, Debug)]
pub struct TracedLight {
    pub(super) source: LightSource,
    /// Film layer that the light contributes to.
    pub layer: usize,
    /// Factor on its contributions: white in a layer of one light (its colour is applied later), the light's colour and
    /// exposure time in a layer that several lights share.
    pub tint: Vec3,
    /// Time for which the light contributes to the exposure, seconds (1 for flash). Part of the importance.
    pub time_s: f32,
    /// Axial intensity, cd, or illuminance of a distant light, lx; with seconds for flash.
    pub output: f32,
    /// True if camera rays hit the emitter, which hides what is behind it.
    pub visible_to_camera: bool,
    /// True if camera rays see the emitter before its body: it hides nothing.
    pub glows_before_body: bool,
    /// The light of the scene, if it has a body.
    body_of: Option<LightId>,
    /// Angular transmission of a grid, snoot or barn doors, times a measured distribution.
    beam: Option<OrientedBeam>,
    /// Luminance and colour by direction of a surround with an environment map.
    environment: Option<EnvironmentLight>,
}

/// The angular transmission of a modifier, times a measured distribution, with the rotation into the light's frame.
#[derive(Clone, Debug)]
struct OrientedBeam {
    beam: Beam,
    light_from_world: Mat3,
}

/// A direction towards a light, sampled at a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Distance to the emitter, metres; infinite for the sun.
    pub distance: f32,
    /// Luminance over pdf (lights with extent), or illuminance normal to the direction (delta lights).
    pub value: f32,
    /// Solid angle density, 1/sr; none for delta lights.
    pub pdf: Option<f32>,
}

/// The intersection of a ray with an emitter.
#[derive(Clone, Copy, Debug)]
pub struct EmitterHit {
    /// Distance along the unit direction, metres; infinite for sun and surround.
    pub distance: f32,
    /// Luminance towards the ray's origin, cd/m2.
    pub luminance: f32,
}

impl EmitterHit {
    fn at(distance: f32, luminance: f32) -> Self {
        EmitterHit { distance, luminance }
    }
}

impl TracedLight {
    /// Converts a photometric light, with positions relative to `origin`. Returns none for a light without any output.
    pub fn new(light: &PhotometricLight, origin: Vec3) -> Option<Self> {
        let PhotometricLight { world_from_light, .. } = *light;
        let position = Vec3::from(world_from_light.translation - Vec3A::from(origin));
        let [right, up, back] = [0, 1, 2].map(|i| Vec3::from(world_from_light.matrix3.col(i)));
        let (intensity, illuminance) = (light.axial_intensity(), light.illuminance());
        let source = match light.shape {
            EmitterShape::Point(IntensityDistribution::Isotropic) => LightSource::Point { position, intensity },
            EmitterShape::Point(IntensityDistribution::Cone(Cone { inner_deg, outer_deg })) => {
                LightSource::Spot { position, axis: -back, intensity, inner_deg, outer_deg }
            }
            EmitterShape::Sphere { radius_m } if radius_m > 0.0 => {
                let sphere = Sphere { centre: position, radius: radius_m };
                LightSource::Sphere { sphere, luminance: intensity / (PI * radius_m * radius_m) }
            }
            EmitterShape::Sphere { .. } => LightSource::Point { position, intensity },
            // A panel emits along -Z: right x up is +Z, so its width axis is reversed.
            EmitterShape::Rect { half_size_m } => {
                let rect = Rect::new(position, -right, up, half_size_m);
                LightSource::Rect { rect, luminance: intensity / rect.area() }
            }
            EmitterShape::Disc { radius_m } => {
                let disc = Disc::new(position, -right, up, radius_m);
                LightSource::Disc { disc, luminance: intensity / disc.area() }
            }
            EmitterShape::Sun { half_angle_rad } => LightSource::Sun(SunDisc::new(back, illuminance, half_angle_rad)),
            EmitterShape::Surround => LightSource::Surround { luminance: illuminance / PI },
        };
        let output = intensity.max(illuminance);
        let is_finite = output.is_finite() && world_from_light.matrix3.is_finite() && position.is_finite();
        let light_from_world = Mat3::from(world_from_light.matrix3).transpose();
        (output > 0.0 && is_finite).then(|| TracedLight {
            source,
            layer: 0,
            tint: Vec3::ONE,
            time_s: light.exposure_time_s,
            output,
            visible_to_camera: light.visible_to_camera,
            glows_before_body: false,
            body_of: None,
            beam: light.beam.clone().map(|beam| OrientedBeam { beam, light_from_world }),
            environment: light.environment.clone(),
        })
    }

    /// Gives the light a body, which camera rays see or pass.
    pub fn with_body(mut self, light: LightId, is_seen: bool) -> Self {
        (self.body_of, self.glows_before_body) = (Some(light), is_seen && !self.visible_to_camera);
        self
    }

    /// Returns the body that its light passes.
    pub fn own_body(&self) -> PassedBodies {
        self.body_of.map_or(PassedBodies::None, PassedBodies::Of)
    }

    /// Returns true for the light with this body.
    pub fn has_body(&self, light: LightId) -> bool {
        self.body_of == Some(light)
    }

    /// Returns true if camera rays see the emitter.
    pub fn is_seen(&self) -> bool {
        self.visible_to_camera || self.glows_before_body
    }

    /// Hides the emitter from rays that start at the camera, or at a receptor.
    pub fn hide_from_camera(&mut self) {
        (self.visible_to_camera, self.glows_before_body) = (false, false);
    }

    /// Returns true if a modifier or a measured distribution limits the light's directions.
    pub(super) fn has_beam(&self) -> bool {
        self.beam.is_some()
    }

    /// Returns the transmission of the modifier in a unit direction away from the light.
    pub(super) fn beam_transmission(&self, away: Vec3) -> f32 {
        self.beam.as_ref().map_or(1.0, |oriented| oriented.beam.transmission(oriented.light_from_world * away))
    }

    /// Returns the transmission of the modifier from the light's centre towards a point; 1 without a modifier, and for
    /// lights at infinity.
    pub(super) fn beam_transmission_towards(&self, point: Vec3) -> f32 {
        match (&self.beam, self.centre()) {
            (Some(_), Some(centre)) => self.beam_transmission((point - centre).normalize_or_zero()),
            _ => 1.0,
        }
    }

    /// Returns the centre of the emitter; none for lights at infinity.
    pub(super) fn centre(&self) -> Option<Vec3> {
        match self.source {
            LightSource::Point { position, .. } | LightSource::Spot { position, .. } => Some(position),
            LightSource::Rect { rect, .. } => Some(rect.centre),
            LightSource::Disc { disc, .. } => Some(disc.centre),
            LightSource::Sphere { sphere, .. } => Some(sphere.centre),
            LightSource::Sun(_) | LightSource::Surround { .. } => None,
        }
    }

    /// Returns the unit normal of the emitter at a point on it; none for delta lights and lights at infinity.
    pub fn emitter_normal(&self, point: Vec3) -> Option<Vec3> {
        match self.source {
            LightSource::Rect { rect, .. } => Some(rect.normal()),
            LightSource::Disc { disc, .. } => Some(disc.normal()),
            LightSource::Sphere { sphere, .. } => Some((point - sphere.centre).normalize_or_zero()),
            LightSource::Point { .. }
            | LightSource::Spot { .. }
            | LightSource::Sun(_)
            | LightSource::Surround { .. } => None,
        }
    }

    /// Returns the bounding box of the emitter, slightly enlarged; none for delta lights and lights at infinity.
    pub(super) fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let (centre, extent) = match self.source {
            LightSource::Rect { rect, .. } => {
                (rect.centre, rect.right.abs() * rect.half.x + rect.up.abs() * rect.half.y)
            }
            LightSource::Disc { disc, .. } => (disc.centre, (disc.right.abs() + disc.up.abs()) * disc.radius),
            LightSource::Sphere { sphere, .. } => (sphere.centre, Vec3::splat(sphere.radius)),
            LightSource::Point { .. }
            | LightSource::Spot { .. }
            | LightSource::Sun(_)
            | LightSource::Surround { .. } => return None,
        };
        // The slab test and the emitter's intersection round differently.
        let extent = extent + Vec3::splat(1e-5 * (centre.abs() + extent).max_element());
        Some((centre - extent, centre + extent))
    }

    /// Returns true for a delta light: it has no extent, so no ray hits it.
    pub fn is_delta(&self) -> bool {
        match self.source {
            LightSource::Point { .. } | LightSource::Spot { .. } => true,
            LightSource::Sun(sun) => sun.is_delta(),
            LightSource::Rect { .. }
            | LightSource::Disc { .. }
            | LightSource::Sphere { .. }
            | LightSource::Surround { .. } => false,
        }
    }

    /// Returns true if next-event estimation samples the light. An even surround is left to BSDF sampling, which has as
    /// little variance.
    pub fn is_sampled(&self) -> bool {
        !matches!(self.source, LightSource::Surround { .. }) || self.environment.is_some()
    }

    /// Returns the environment map that a surround shines as.
    pub(super) fn environment(&self) -> Option<&EnvironmentLight> {
        self.environment.as_ref()
    }

    /// Returns the factor on its contributions from a unit direction towards it: its tint, times the colour of an
    /// environment map there. Light is a number with one colour a light; a map is the only light whose colour depends on
    /// the direction.
    pub fn tint_towards(&self, direction: Vec3) -> Vec3 {
        self.environment.as_ref().map_or(self.tint, |environment| self.tint * environment.color(direction))
    }

    /// Samples a direction from `point` towards the light. Visibility is not tested.
    pub fn sample(&self, point: Vec3, u: Vec2) -> Option<LightSample> {
        let mut sample = self.sample_source(point, u);
        if let (Some(sample), true) = (&mut sample, self.has_beam()) {
            sample.value *= self.beam_transmission(-sample.direction);
        }
        sample
    }

    /// Returns the light that reaches `point` if the whole emitter is concentrated in its centre. Visibility is not
    /// tested. Returns none for a surround.
    pub fn sample_centre(&self, point: Vec3) -> Option<LightSample> {
        let concentrated = |centre: Vec3, intensity: f32, normal: Option<Vec3>| {
            let sample = sample_position(point, centre, intensity)?;
            let cos = normal.map_or(1.0, |normal| -sample.direction.dot(normal));
            (cos > 0.0).then_some(LightSample { value: sample.value * cos, ..sample })
        };
        let sample = match self.source {
            LightSource::Point { .. } | LightSource::Spot { .. } => self.sample_source(point, Vec2::splat(0.5)),
            LightSource::Rect { rect, luminance } => {
                concentrated(rect.centre, luminance * rect.area(), Some(rect.normal()))
            }
            LightSource::Disc { disc, luminance } => {
                concentrated(disc.centre, luminance * disc.area(), Some(disc.normal()))
            }
            LightSource::Sphere { sphere, luminance } => {
                concentrated(sphere.centre, luminance * PI * sphere.radius * sphere.radius, None)
            }
            LightSource::Sun(sun) => Some(sample_delta_sun(&sun)),
            LightSource::Surround { .. } => None,
        }?;
        Some(LightSample { value: sample.value * self.beam_transmission(-sample.direction), ..sample })
    }

    /// Returns the luminance of a surround, cd/m2, the mean of an environment map; none for other lights.
    pub fn surround_luminance(&self) -> Option<f32> {
        let LightSource::Surround { luminance } = self.source else { return None };
        Some(luminance * self.environment.as_ref().map_or(1.0, EnvironmentLight::mean_relative_luminance))
    }

    /// Samples a direction towards the light, without its modifier.
    fn sample_source(&self, point: Vec3, u: Vec2) -> Option<LightSample> {
        match &self.source {
            LightSource::Point { position, intensity } => sample_position(point, *position, *intensity),
            LightSource::Spot { position, axis, intensity, inner_deg, outer_deg } => {
                let falloff = cone_falloff_at(angle_between(point - position, *axis), *inner_deg, *outer_deg);
                if falloff > 0.0 { sample_position(point, *position, intensity * falloff) } else { None }
            }
            LightSource::Rect { rect, luminance } => {
                if !rect.is_in_front(point) {
                    return None;
                }
                let (to, pdf) = rect.seen_from(point).sample(point, u)?;
                sample_area_light(to, *luminance, pdf)
            }
            LightSource::Disc { disc, luminance } => {
                if (point - disc.centre).dot(disc.normal()) <= 0.0 {
                    return None;
                }
                let (to, pdf) = disc.sample(point, u)?;
                sample_area_light(to, *luminance, pdf)
            }
            LightSource::Sphere { sphere, luminance } => {
                let (direction, distance, pdf) = sphere.sample(point, u)?;
                Some(LightSample { direction, distance, value: luminance / pdf, pdf: Some(pdf) })
            }
            LightSource::Sun(sun) => {
                if sun.is_delta() {
                    return Some(sample_delta_sun(sun));
                }
                let (direction, pdf) = sun.sample(u);
                let value = sun.luminance() / pdf;
                Some(LightSample { direction, distance: f32::INFINITY, value, pdf: Some(pdf) })
            }
            LightSource::Surround { luminance } => {
                let environment = self.environment.as_ref()?;
                let (direction, pdf) = environment.sample(u.into())?;
                let value = luminance * environment.relative_luminance(direction) / pdf;
                Some(LightSample { direction, distance: f32::INFINITY, value, pdf: Some(pdf) })
            }
        }
    }

    /// Intersects a ray of unit direction with the emitter.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<EmitterHit> {
        let hit = self.intersect_source(origin, direction)?;
        Some(EmitterHit { luminance: hit.luminance * self.beam_transmission(-direction), ..hit })
    }

    /// Intersects a ray with the emitter, without its modifier. Panels emit to the front only.
    fn intersect_source(&self, origin: Vec3, direction: Vec3) -> Option<EmitterHit> {
        match &self.source {
            LightSource::Point { .. } | LightSource::Spot { .. } => None,
            LightSource::Rect { rect, luminance } => {
                let is_front = direction.dot(rect.normal()) < 0.0;
                let distance = is_front.then(|| rect.intersect(origin, direction)).flatten();
                distance.map(|distance| EmitterHit::at(distance, *luminance))
            }
            LightSource::Disc { disc, luminance } => {
                let is_front = direction.dot(disc.normal()) < 0.0;
                let distance = is_front.then(|| disc.intersect(origin, direction)).flatten();
                distance.map(|distance| EmitterHit::at(distance, *luminance))
            }
            LightSource::Sphere { sphere, luminance } => {
                sphere.intersect(origin, direction).map(|distance| EmitterHit::at(distance, *luminance))
            }
            LightSource::Sun(sun) => sun.contains(direction).then(|| EmitterHit::at(f32::INFINITY, sun.luminance())),
            LightSource::Surround { luminance } => {
                let relative = self.environment.as_ref().map_or(1.0, |map| map.relative_luminance(direction));
                Some(EmitterHit::at(f32::INFINITY, luminance * relative))
            }
        }
    }

    /// Returns the density with which [`TracedLight::sample`] samples a direction that hits the emitter at `distance`,
    /// 1/sr.
    pub fn pdf(&self, point: Vec3, direction: Vec3, distance: f32) -> f32 {
        match &self.source {
            LightSource::Rect { rect, .. } => rect.seen_from(point).pdf(direction * distance),
            LightSource::Disc { disc, .. } => disc.pdf(point, direction * distance),
            LightSource::Sphere { sphere, .. } => sphere.pdf(point),
            LightSource::Sun(sun) => sun.pdf(),
            LightSource::Surround { .. } => self.environment.as_ref().map_or(0.0, |map| map.pdf(direction)),
            LightSource::Point { .. } | LightSource::Spot { .. } => 0.0,
        }
    }
}

/// Returns the sample of a point light: I / d2.
fn sample_position(point: Vec3, position: Vec3, intensity: f32) -> Option<LightSample> {
    let to = position - point;
    let distance = to.length();
    let value = intensity / (distance * distance);
    (distance > 0.0 && value.is_finite()).then(|| LightSample { direction: to / distance, distance, value, pdf: None })
}

/// Returns the sample of a point on an area light, for the vector to it.
fn sample_area_light(to: Vec3, luminance: f32, pdf: f32) -> Option<LightSample> {
    let distance = to.length();
    (distance > 0.0).then(|| LightSample {
        direction: to * (1.0 / distance),
        distance,
        value: luminance / pdf,
        pdf: Some(pdf),
    })
}

/// Returns the sample of a sun without extent.
fn sample_delta_sun(sun: &SunDisc) -> LightSample {
    LightSample { direction: sun.towards, distance: f32::INFINITY, value: sun.illuminance, pdf: None }
}
