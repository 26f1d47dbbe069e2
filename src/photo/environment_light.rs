//! The light of an environment map: a surround whose luminance and colour depend on the direction.
//!
//! Its stated illuminance is that on the plane that gets most of its light. So an even map is a surround of that
//! illuminance, and a map with one bright pixel is a sun of it. Renderers keep light as a number and its colour apart:
//! [`EnvironmentLight::relative_luminance`] is a factor of the luminance, [`EnvironmentLight::color`] one of the tint.

use crate::color::luminance;
use crate::scene::EnvironmentMap;
use glam::{Quat, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// An environment map, turned about the vertical.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    map: Arc<EnvironmentMap>,
    world_from_map: Quat,
}

/// The sun of an environment map, for renderers that need a light with a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSun {
    /// Unit direction towards it.
    pub direction: Vec3,
    /// Illuminance that it gives on a plane that faces it, over the one that is stated for the map.
    pub illuminance_part: f32,
    /// Colour, of luminance 1.
    pub color: Vec3,
    /// Half the angle that it is seen under, radians.
    pub half_angle_rad: f32,
}

impl PartialEq for EnvironmentLight {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.map, &other.map) && self.world_from_map == other.world_from_map
    }
}

impl EnvironmentLight {
    /// Returns the light of a map, turned to the left by an angle, degrees, as seen from inside.
    pub fn new(map: Arc<EnvironmentMap>, rotation_deg: f32) -> Self {
        EnvironmentLight { map, world_from_map: Quat::from_rotation_y(rotation_deg.to_radians()) }
    }

    fn color_at(&self, direction: Vec3) -> Vec3 {
        self.map.at(self.world_from_map.inverse() * direction)
    }

    /// Returns the luminance in a unit direction over that of an even surround of the same stated illuminance.
    pub fn relative_luminance(&self, direction: Vec3) -> f32 {
        luminance(self.color_at(direction)) * PI / self.map.peak_illuminance()
    }

    /// Returns the colour in a unit direction, of luminance 1; white where there is no light.
    pub fn color(&self, direction: Vec3) -> Vec3 {
        unit_color(self.color_at(direction))
    }

    /// Returns the mean of the relative luminance over all directions.
    pub fn mean_relative_luminance(&self) -> f32 {
        luminance(self.map.mean()) * PI / self.map.peak_illuminance()
    }

    /// Returns the mean colour, of luminance 1.
    pub fn mean_color(&self) -> Vec3 {
        unit_color(self.map.mean())
    }

    /// Returns the colour, its luminance over that of an even surround of the same stated illuminance, without the sun.
    pub fn relative_radiance_without_sun(&self, direction: Vec3) -> Vec3 {
        self.map.without_sun_at(self.world_from_map.inverse() * direction) * PI / self.map.peak_illuminance()
    }

    /// Returns the mean of that over all directions.
    pub fn mean_relative_radiance_without_sun(&self) -> Vec3 {
        self.map.mean_without_sun() * PI / self.map.peak_illuminance()
    }

    /// Returns the sun of the map, if it has one: a small bright spot that gives much of the light.
    pub fn sun(&self) -> Option<EnvironmentSun> {
        let sun = self.map.sun()?;
        let lux = luminance(sun.irradiance);
        Some(EnvironmentSun {
            direction: self.world_from_map * sun.direction,
            illuminance_part: lux / self.map.peak_illuminance(),
            color: unit_color(sun.irradiance),
            half_angle_rad: sun.half_angle_rad,
        })
    }

    /// Returns the unit normal of the plane that gets most light.
    pub fn peak_direction(&self) -> Vec3 {
        self.world_from_map * self.map.peak_direction()
    }

    /// Samples a direction by luminance. Returns it with its density, 1/sr.
    pub fn sample(&self, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let (direction, pdf) = self.map.sample(u)?;
        Some((self.world_from_map * direction, pdf))
    }

    /// Returns the density of [`EnvironmentLight::sample`], 1/sr.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.map.pdf(self.world_from_map.inverse() * direction)
    }
}

fn unit_color(color: Vec3) -> Vec3 {
    let luminance = luminance(color);
    if luminance > 0.0 { color / luminance } else { Vec3::ONE }
}
