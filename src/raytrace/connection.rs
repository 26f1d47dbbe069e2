//! The connection of a point with a light sample, also through clear bodies.
//!
//! `straight_path` says which light these connections bring. A straight path through a body is displaced sideways: a
//! connection refracts the ray at each face. Towards a sun the direction is given. Towards a point, of an area light,
//! too, it is solved by Newton's method; the wavefront between both gives its derivative, the illuminance and the
//! density of the direction.
//!
//! Inner reflections of a body are counted as if they arrived from the same point; they are displaced by a part of its
//! thickness. Without photons nothing else finds light without extent behind glass. It is then approximated: reflections
//! between parallel bodies arrive from the same point, too, and where the path is caustic, light passes on the straight
//! line.

use super::lights::{LightSample, TracedLight};
use super::medium_stack::MediumStack;
use super::ray_caster::RayCaster;
use super::shadow_ray::{Arrival, BodyMode, ShadowQuery, ShadowRayEnd, Target};
use glam::Vec3;

/// Steps of Newton's method towards a point; each doubles the digits.
const MAX_NEWTON_STEPS: u32 = 8;
/// Distance from the point, relative to that of the light, at which the solution is accepted.
const NEWTON_TOLERANCE: f32 = 1e-5;

/// Relative difference of distances at which a point of an emitter counts as hidden by the emitter's front.
const HIDDEN_TOLERANCE: f32 = 1e-4;

/// Light that arrives at a point from a light sample.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Unit direction towards the light, in which it arrives.
    pub direction: Vec3,
    /// Luminance over pdf, or illuminance normal to the direction, as [`LightSample::value`].
    pub value: f32,
    /// Solid angle density of the direction, 1/sr; none for delta lights.
    pub pdf: Option<f32>,
    /// Transmittance of panes and bodies.
    pub transmittance: Vec3,
}

/// The path to a light is caustic.
struct CausticPath;

impl RayCaster<'_> {
    /// Connects a point inside `media` with a light sample. Returns none where no light arrives.
    pub fn connect(
        &mut self,
        origin: Vec3,
        light: &TracedLight,
        sample: &LightSample,
        media: MediumStack,
    ) -> Option<Connection> {
        let LightSample { direction, distance, .. } = *sample;
        if !self.scene.plan().refraction {
            let passed = light.own_body();
            if self.scene.plan().coverage {
                let part = self.passed_light(origin, direction, distance, passed);
                return (part > 0.0).then(|| Connection::on_line(sample, Vec3::splat(part)));
            }
            let is_visible = !self.occluded(origin, direction, distance, passed);
            return is_visible.then(|| Connection::on_line(sample, Vec3::ONE));
        }
        let target = if distance.is_finite() { Target::Point(origin + direction * distance) } else { Target::Infinity };
        let is_approximate = sample.pdf.is_none() && !self.photon_caustics();
        let passed = light.own_body();
        let mut query =
            ShadowQuery { target, distance, media, mode: BodyMode::Refract, between_bodies: is_approximate, passed };
        match self.solve(&query, origin, light, sample) {
            Ok(connection) => connection,
            Err(CausticPath) if is_approximate => {
                query.mode = BodyMode::Ignore;
                let ShadowRayEnd::Arrived(arrival) = self.trace_shadow_ray(&query, origin, direction) else {
                    return None;
                };
                Some(Connection::on_line(sample, arrival.transmittance))
            }
            Err(CausticPath) => None,
        }
    }

    /// Finds the straight path to a light sample; towards a point by Newton's method.
    fn solve(
        &mut self,
        query: &ShadowQuery,
        origin: Vec3,
        light: &TracedLight,
        sample: &LightSample,
    ) -> Result<Option<Connection>, CausticPath> {
        let mut direction = sample.direction;
        for _ in 0..MAX_NEWTON_STEPS {
            let arrival = match self.trace_shadow_ray(query, origin, direction) {
                ShadowRayEnd::Blocked => return Ok(None),
                ShadowRayEnd::Caustic => return Err(CausticPath),
                ShadowRayEnd::Arrived(arrival) => arrival,
            };
            let on_line = Connection::on_line(sample, arrival.transmittance);
            let Target::Point(point) = query.target else { return Ok(Some(on_line)) };
            if !arrival.crosses_body {
                // Newton's method has left the faces that it started from.
                return Ok((direction == sample.direction).then_some(on_line));
            }
            if arrival.miss.length() < NEWTON_TOLERANCE * sample.distance {
                return Ok(refracted_connection(light, sample, point, direction, &arrival));
            }
            direction = arrival.wavefront.correct(direction, arrival.miss);
        }
        Ok(None)
    }

    /// Returns the density with which [`RayCaster::connect`] samples the direction of a straight path from `origin` that crosses
    /// bodies and hits a light at `point`, 1/sr. `media` are those at both ends.
    pub fn straight_path_pdf(
        &mut self,
        light: &TracedLight,
        origin: Vec3,
        direction: Vec3,
        point: Vec3,
        media: MediumStack,
    ) -> f32 {
        let to_point = point - origin;
        let (distance, target) = (to_point.length(), Target::Point(point));
        let (mode, passed) = (BodyMode::Refract, light.own_body());
        let query = ShadowQuery { target, distance, media, mode, between_bodies: false, passed };
        let ShadowRayEnd::Arrived(arrival) = self.trace_shadow_ray(&query, origin, direction) else { return 0.0 };
        let line = to_point / distance;
        light.pdf(origin, line, distance) * density_ratio(light, point, (line, distance), direction, &arrival)
    }
}

impl Connection {
    /// Returns the light sample itself, on the straight line.
    fn on_line(sample: &LightSample, transmittance: Vec3) -> Self {
        let LightSample { direction, value, pdf, .. } = *sample;
        Connection { direction, value, pdf, transmittance }
    }
}

/// Returns the light of a sample at `point` that arrives in another direction, through bodies.
fn refracted_connection(
    light: &TracedLight,
    sample: &LightSample,
    point: Vec3,
    direction: Vec3,
    arrival: &Arrival,
) -> Option<Connection> {
    let LightSample { distance, .. } = *sample;
    let transmittance = arrival.transmittance;
    let viewpoint = point - direction * distance;
    let Some(pdf) = sample.pdf else {
        // The illuminance at the same distance, changed by the wavefront
        let value = light.sample_centre(viewpoint)?.value * distance * distance / arrival.wavefront.area();
        return Some(Connection { direction, value, pdf: None, transmittance });
    };
    // The point may be hidden in this direction: behind the front of a bulb, or at the back of a panel
    let hit = light.intersect(viewpoint, direction)?;
    if (hit.distance - distance).abs() > HIDDEN_TOLERANCE * distance {
        return None;
    }
    let pdf = pdf * density_ratio(light, point, (sample.direction, distance), direction, arrival);
    Some(Connection { direction, value: hit.luminance / pdf, pdf: Some(pdf), transmittance }).filter(|_| pdf > 0.0)
}

/// Returns the density of a direction through bodies over that of the straight line to the same point of an emitter: the solid
/// angles of its surface are cos / d2 on the line and cos / area by the wavefront.
fn density_ratio(
    light: &TracedLight,
    point: Vec3,
    (line, distance): (Vec3, f32),
    direction: Vec3,
    arrival: &Arrival,
) -> f32 {
    let Some(normal) = light.emitter_normal(point) else { return 0.0 };
    let cosines = line.dot(normal).abs() / direction.dot(normal).abs().max(f32::MIN_POSITIVE);
    cosines * arrival.wavefront.area() / (distance * distance)
}
