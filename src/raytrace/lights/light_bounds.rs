//! Bounds of a light or of a cluster of lights, and the importance that they give it at a shading point.
//!
//! The importance estimates the illuminance of a shading point up to a constant, as in Conty Estevez and Kulla 2018,
//! "Importance Sampling of Many Lights with Adaptive Tree Splitting":
//!
//! importance = I t / d2 * clamp(cos_r, 0.05, 1) * clamp(f, 0.02, 1)
//!
//! with the axial intensity I (cd), the exposure time t (s), the distance d to the centre (at least the radius), the
//! cosine cos_r at the receiver, and the falloff f of the emitter. The bounds differ from the paper's: a bounding
//! sphere instead of a box; and instead of a cone of normals, a slack that is added to the cosine at the emitter. It
//! bounds how far the axes and positions of the members differ from those of the cluster. The lower clamps keep the
//! importance positive wherever part of the light reaches over a horizon. It is 0 only where no part can contribute.

use super::traced_light::{LightSource, TracedLight};
use crate::math::safe_sqrt;
use crate::raytrace::simd::LANES;
use glam::Vec3;
use std::f32::consts::PI;

/// Slack of a light that emits in all directions: a cosine plus this is never under 1.
const ALL_DIRECTIONS: f32 = 2.0;

/// Bounds of a light or of a cluster of lights. Positions are relative to the camera.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// Centre of the bounding sphere; for a sun, the unit direction towards it.
    pub centre: Vec3,
    /// 1; 0 for a sun, whose `centre` is a direction.
    pub is_local: f32,
    /// Radius of the bounding sphere, metres.
    radius: f32,
    /// Axial intensity times exposure time, cd s; illuminance times exposure time of a sun, lx s.
    intensity: f32,
    /// Unit direction of maximum intensity.
    axis: Vec3,
    /// Largest difference of the cosine at the emitter because members' axes differ from `axis`.
    axis_slack: f32,
    /// Largest distance of members before or behind the centre, metres.
    position_slack: f32,
    /// Cosine at which the falloff reaches 0.
    cos_outer: f32,
    /// Reciprocal of the cosine range over which the falloff rises to 1.
    falloff_scale: f32,
}

impl LightBounds {
    /// Returns the bounds of a light; none for lights that next-event estimation does not sample.
    pub fn of(light: &TracedLight) -> Option<Self> {
        let isotropic = |centre: Vec3, radius: f32, intensity: f32| LightBounds {
            centre,
            is_local: 1.0,
            radius,
            intensity: intensity * light.time_s,
            axis: Vec3::Z,
            axis_slack: ALL_DIRECTIONS,
            position_slack: 0.0,
            cos_outer: 0.0,
            falloff_scale: 1.0,
        };
        let panel = |centre, radius, intensity, axis| LightBounds {
            axis,
            axis_slack: 0.0,
            ..isotropic(centre, radius, intensity)
        };
        Some(match light.source {
            LightSource::Point { position, intensity } => isotropic(position, 0.0, intensity),
            LightSource::Spot { position, axis, intensity, inner_deg, outer_deg } => {
                let half_cos = |full_deg: f32| (0.5 * full_deg.to_radians()).cos();
                // Slightly wider than the cone, so that rounding does not make the importance of its rim 0.
                let (cos_inner, cos_outer) = (half_cos(inner_deg.min(outer_deg)), half_cos(outer_deg) - 1e-4);
                let falloff_scale = 1.0 / (cos_inner - cos_outer).max(1e-6);
                LightBounds { axis, axis_slack: 0.0, cos_outer, falloff_scale, ..isotropic(position, 0.0, intensity) }
            }
            LightSource::Rect { rect, luminance } => {
                panel(rect.centre, rect.half_diagonal, luminance * rect.area(), rect.normal())
            }
            LightSource::Disc { disc, luminance } => {
                panel(disc.centre, disc.radius, luminance * disc.area(), disc.normal())
            }
            LightSource::Sphere { sphere, luminance } => {
                isotropic(sphere.centre, sphere.radius, luminance * PI * sphere.radius * sphere.radius)
            }
            LightSource::Sun(sun) => {
                let radius = safe_sqrt(2.0 * sun.one_minus_cos);
                LightBounds { is_local: 0.0, ..isotropic(sun.towards, radius, sun.illuminance) }
            }
            // From everywhere, most of it from one direction: within a sphere of radius 1 about it, the horizon hides none
            LightSource::Surround { luminance } => {
                let towards = light.environment()?.peak_direction();
                LightBounds { is_local: 0.0, ..isotropic(towards, 1.01, luminance * PI) }
            }
        })
    }

    /// Returns the bounds of a cluster. Its members are either all suns or all local.
    pub fn union(members: impl Iterator<Item = LightBounds> + Clone) -> Self {
        // Bounding sphere
        let intensity: f32 = members.clone().map(|m| m.intensity).sum();
        let (low, high) = members
            .clone()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), m| (low.min(m.centre), high.max(m.centre)));
        let centre = (low + high) * 0.5;
        let radius =
            members.clone().map(|m| (m.centre - centre).length() + m.radius).fold(0.0, f32::max) * (1.0 + 1e-5);
        // Mean axis; the cosines against two axes differ by at most the distance between them
        let axis = members.clone().map(|m| m.axis * m.intensity).sum::<Vec3>().normalize_or(Vec3::Z);
        let axis_slack = members.clone().map(|m| m.axis_slack + (m.axis - axis).length()).fold(0.0, f32::max);
        let axis_slack = (axis_slack * (1.0 + 1e-5)).min(ALL_DIRECTIONS);
        let is_local = members.clone().next().map_or(1.0, |m| m.is_local);
        LightBounds {
            centre,
            is_local,
            radius,
            intensity,
            axis,
            axis_slack,
            position_slack: radius,
            cos_outer: 0.0,
            falloff_scale: 1.0,
        }
    }
}

/// Eight [`LightBounds`] as a structure of arrays. Unused lanes have an intensity of 0.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct LightBoundsPacket {
    centre: [[f32; LANES]; 3],
    is_local: [f32; LANES],
    radius: [f32; LANES],
    intensity: [f32; LANES],
    axis: [[f32; LANES]; 3],
    axis_slack: [f32; LANES],
    position_slack: [f32; LANES],
    cos_outer: [f32; LANES],
    falloff_scale: [f32; LANES],
}

impl LightBoundsPacket {
    /// Stores bounds in a lane.
    pub fn set(&mut self, lane: usize, bounds: &LightBounds) {
        for axis in 0..3 {
            self.centre[axis][lane] = bounds.centre[axis];
            self.axis[axis][lane] = bounds.axis[axis];
        }
        self.is_local[lane] = bounds.is_local;
        self.radius[lane] = bounds.radius;
        self.intensity[lane] = bounds.intensity;
        self.axis_slack[lane] = bounds.axis_slack;
        self.position_slack[lane] = bounds.position_slack;
        self.cos_outer[lane] = bounds.cos_outer;
        self.falloff_scale[lane] = bounds.falloff_scale;
    }

    /// Returns the importance of each lane at a shading point with this normal; zero for fibres, which all lights reach.
    #[inline(always)]
    pub fn importances(&self, point: Vec3, normal: Vec3) -> [f32; LANES] {
        let mut importances = [0.0; LANES];
        let slack = if normal.x == 0.0 && normal.y == 0.0 && normal.z == 0.0 { f32::INFINITY } else { 0.0 };
        // A plain loop: closures are not compiled for AVX2.
        for (i, lane) in importances.iter_mut().enumerate() {
            // Vector from the shading point to the centre
            let x = self.centre[0][i] - point.x * self.is_local[i];
            let y = self.centre[1][i] - point.y * self.is_local[i];
            let z = self.centre[2][i] - point.z * self.is_local[i];
            // Its components along the receiver's normal and against the emitter's axis
            let height = normal.x * x + normal.y * y + normal.z * z;
            let before = -(self.axis[0][i] * x + self.axis[1][i] * y + self.axis[2][i] * z);
            // Inverse distance, bounded by the radius
            let radius = self.radius[i];
            let distance2 = max(x * x + y * y + z * z, radius * radius);
            let inverse = 1.0 / max(distance2, f32::MIN_POSITIVE).sqrt();
            // Largest cosine at the emitter; a point inside the bounding sphere is before and behind the light
            let cos = before * inverse + (self.axis_slack[i] + self.position_slack[i] * inverse);
            let falloff = (cos - self.cos_outer[i]) * self.falloff_scale[i];
            let illuminance = self.intensity[i] * inverse * inverse;
            let importance = illuminance * min(max(height * inverse, 0.05), 1.0) * min(max(falloff, 0.02), 1.0);
            *lane = if height + slack > -radius && falloff > 0.0 { importance } else { 0.0 };
        }
        importances
    }
}

/// Returns the larger number in one instruction, unlike `f32::max`. A NaN makes the sum of all importances NaN, which
/// is then discarded.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Returns the smaller number, see [`max`].
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
