//! Bare emitters: shape, size and luminous intensity distribution, before any modifier.

use crate::math::safe_acos;
use crate::scene::{Cone, Emitter};
use glam::Vec2;
use std::f32::consts::PI;

/// The shape of an emitter, in the light's frame: it shines along -Z.
#[derive(Clone, Debug, PartialEq)]
pub enum EmitterShape {
    /// A point source.
    Point(IntensityDistribution),
    /// A sphere of constant luminance: isotropic.
    Sphere {
        /// Radius, metres.
        radius_m: f32,
    },
    /// A one-sided Lambertian rectangle in the XY plane.
    Rect {
        /// Half width and half height, metres.
        half_size_m: Vec2,
    },
    /// A one-sided Lambertian disc in the XY plane.
    Disc {
        /// Radius, metres.
        radius_m: f32,
    },
    /// Parallel light from infinity, along -Z.
    Sun {
        /// Half of its angular diameter, radians; 0 is a directional light.
        half_angle_rad: f32,
    },
    /// Constant luminance from all directions.
    Surround,
}

/// The luminous intensity of a point source by direction, relative to its axis (-Z).
#[derive(Clone, Debug, PartialEq)]
pub enum IntensityDistribution {
    /// The same in all directions.
    Isotropic,
    /// Constant in the inner cone, linear in angle down to 0 at the outer cone.
    Cone(Cone),
}

impl IntensityDistribution {
    /// Returns the intensity in a direction, relative to the axis, by the cosine against it.
    pub fn relative_intensity(&self, cos_axis: f32) -> f32 {
        match *self {
            IntensityDistribution::Isotropic => 1.0,
            IntensityDistribution::Cone(Cone { inner_deg, outer_deg }) => cone_falloff(cos_axis, inner_deg, outer_deg),
        }
    }

    /// Returns flux over axial intensity, sr.
    fn solid_angle_sr(&self) -> f32 {
        match *self {
            IntensityDistribution::Isotropic => 4.0 * PI,
            IntensityDistribution::Cone(Cone { inner_deg, outer_deg }) => cone_solid_angle_sr(inner_deg, outer_deg),
        }
    }
}

impl EmitterShape {
    /// Converts an emitter of the scene.
    pub fn new(emitter: &Emitter) -> Self {
        match *emitter {
            Emitter::Point => EmitterShape::Point(IntensityDistribution::Isotropic),
            Emitter::Sphere { radius_m } => EmitterShape::Sphere { radius_m },
            Emitter::Spot { inner_deg, outer_deg } => {
                EmitterShape::Point(IntensityDistribution::Cone(Cone { inner_deg, outer_deg }))
            }
            Emitter::RectPanel { width_m, height_m } => {
                EmitterShape::Rect { half_size_m: 0.5 * Vec2::new(width_m, height_m) }
            }
            Emitter::RoundPanel { diameter_m } => EmitterShape::Disc { radius_m: 0.5 * diameter_m },
            Emitter::Sun { angular_diameter_deg } => {
                EmitterShape::Sun { half_angle_rad: (0.5 * angular_diameter_deg).to_radians() }
            }
            Emitter::Surround => EmitterShape::Surround,
        }
    }

    /// Returns true for a sun and a surround, which have no position.
    pub fn is_distant(&self) -> bool {
        matches!(self, EmitterShape::Sun { .. } | EmitterShape::Surround)
    }

    /// Returns the area that a viewer on the axis sees, m2; none for points and distant lights. Axial intensity over
    /// this area is the luminance.
    pub fn projected_area_m2(&self) -> Option<f32> {
        match *self {
            EmitterShape::Sphere { radius_m } | EmitterShape::Disc { radius_m } => Some(PI * radius_m * radius_m),
            EmitterShape::Rect { half_size_m } => Some(4.0 * half_size_m.x * half_size_m.y),
            EmitterShape::Point(_) | EmitterShape::Sun { .. } | EmitterShape::Surround => None,
        }
    }

    /// Returns axial intensity over flux, 1/sr: I = F x this. 1 / 4 pi for isotropic emitters, 1 / pi for panels; none
    /// for distant lights.
    pub fn intensity_per_flux(&self) -> Option<f32> {
        match self {
            EmitterShape::Point(distribution) => Some(1.0 / distribution.solid_angle_sr()),
            EmitterShape::Sphere { .. } => Some(1.0 / (4.0 * PI)),
            EmitterShape::Rect { .. } | EmitterShape::Disc { .. } => Some(1.0 / PI),
            EmitterShape::Sun { .. } | EmitterShape::Surround => None,
        }
    }

    /// Returns the far-field intensity in a direction, relative to the axis, by the cosine against it; 0 for distant
    /// lights.
    pub fn relative_intensity(&self, cos_axis: f32) -> f32 {
        match self {
            EmitterShape::Point(distribution) => distribution.relative_intensity(cos_axis),
            EmitterShape::Sphere { .. } => 1.0,
            EmitterShape::Rect { .. } | EmitterShape::Disc { .. } => cos_axis.max(0.0),
            EmitterShape::Sun { .. } | EmitterShape::Surround => 0.0,
        }
    }

    /// Returns the largest angle from the axis in which it emits, radians.
    pub(super) fn widest_angle_rad(&self) -> f32 {
        match self {
            EmitterShape::Point(IntensityDistribution::Isotropic) | EmitterShape::Sphere { .. } => PI,
            EmitterShape::Point(IntensityDistribution::Cone(_))
            | EmitterShape::Rect { .. }
            | EmitterShape::Disc { .. }
            | EmitterShape::Sun { .. }
            | EmitterShape::Surround => 0.5 * PI,
        }
    }
}

/// Returns the falloff of a cone by the cosine against its axis; see [`cone_falloff_at`]. Within 0.03 degrees of the
/// angle: the cosine rounds near the axis.
pub fn cone_falloff(cos_axis: f32, inner_deg: f32, outer_deg: f32) -> f32 {
    cone_falloff_at(safe_acos(cos_axis), inner_deg, outer_deg)
}

/// Returns the falloff of a cone at an angle from its axis: 1 inside, 0 outside, linear in angle between. Full angles,
/// degrees.
pub fn cone_falloff_at(angle_rad: f32, inner_deg: f32, outer_deg: f32) -> f32 {
    let angle_deg = angle_rad.to_degrees();
    let (inner, outer) = (0.5 * inner_deg.min(outer_deg), 0.5 * outer_deg);
    if angle_deg <= inner {
        1.0
    } else if angle_deg < outer {
        (outer - angle_deg) / (outer - inner)
    } else {
        0.0
    }
}

/// Returns the effective solid angle of a cone: flux over axial intensity, sr. Full angles, degrees.
/// 2 pi (1 - (sin b - sin a) / (b - a)) with half angles a and b; the limit at a = b is 2 pi (1 - cos a).
pub fn cone_solid_angle_sr(inner_deg: f32, outer_deg: f32) -> f32 {
    let outer = f64::from(outer_deg.min(360.0) * 0.5).to_radians();
    let inner = f64::from(inner_deg.min(outer_deg) * 0.5).to_radians();
    // sin b - sin a = 2 cos((a + b)/2) sin((b - a)/2), so the quotient is cos(mean) sinc(half difference): no 0 / 0.
    let half_difference = 0.5 * (outer - inner);
    let sinc = if half_difference < 1e-9 { 1.0 } else { half_difference.sin() / half_difference };
    let quotient = (0.5 * (inner + outer)).cos() * sinc;
    (2.0 * std::f64::consts::PI * (1.0 - quotient)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hard_cones_have_the_tabulated_intensity() {
        // light_and_camera.md, 1000 lm.
        for (full_deg, candela) in [(15.0, 18603.0), (30.0, 4671.0), (60.0, 1188.0), (90.0, 543.0), (120.0, 318.0)] {
            let ours = 1000.0 / cone_solid_angle_sr(full_deg, full_deg);
            assert!((ours / candela - 1.0).abs() < 1e-3, "{full_deg}: {ours}");
        }
    }

    #[test]
    fn the_solid_angle_of_a_soft_cone_is_the_integral_of_its_falloff() {
        let (inner, outer) = (30.0, 70.0);
        let steps = 200_000_u32;
        let flux: f64 = (0..steps)
            .map(|i| {
                let theta = (f64::from(i) + 0.5) / f64::from(steps) * std::f64::consts::FRAC_PI_2;
                let weight = f64::from(cone_falloff(theta.cos() as f32, inner, outer));
                weight * 2.0 * std::f64::consts::PI * theta.sin() * std::f64::consts::FRAC_PI_2 / f64::from(steps)
            })
            .sum();
        assert!((flux / f64::from(cone_solid_angle_sr(inner, outer)) - 1.0).abs() < 1e-4);
    }
}
