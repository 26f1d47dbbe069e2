//! Linear polarisation between dielectric interfaces: light that passed one interface is polarised at the next. Without
//! it the transmittance of a pane is 1.6 % too small at 60 degrees, 4 % at 80 degrees.
//!
//! A path from the camera carries the polarisation that the sensor accepts: a Stokes vector of unit intensity without
//! its circular part (Born and Wolf, "Principles of Optics", section 1.4). Every lobe but the dielectric one resets it.

use super::fresnel;
use crate::math::safe_sqrt;
use glam::Vec3;
use std::ops::{Add, Mul, Sub};

/// The accepted linear polarisation, relative to a reference axis perpendicular to the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarisation {
    /// Unit reference axis, perpendicular to the path.
    axis: Vec3,
    /// Stokes Q: intensity along the axis less that perpendicular to it.
    q: f32,
    /// Stokes U: the same for an axis rotated by 45 degrees.
    u: f32,
}

impl Polarisation {
    /// Accepts every polarisation alike.
    pub const NONE: Polarisation = Polarisation { axis: Vec3::X, q: 0.0, u: 0.0 };

    /// Returns the same polarisation relative to another axis. `path` is the unit direction of the path.
    fn relative_to(self, axis: Vec3, path: Vec3) -> Self {
        let (q, u) = rotated((self.q, self.u), self.axis, axis, path);
        Polarisation { axis, q, u }
    }

    /// Returns the reflectance of an interface for this polarisation, and the polarisations after reflection and
    /// transmission (Mueller matrices of an interface; Collett 2005, "Field Guide to Polarization"). `wo` points back
    /// along the path, `normal` is on its side, `eta` is the index of the transmitted side over that of the incident
    /// side.
    pub fn at_interface(self, wo: Vec3, normal: Vec3, eta: f32) -> InterfaceReflection {
        let (s, p) = fresnel::amplitudes(wo.dot(normal), eta);
        let (rs, rp) = (s * s, p * p);
        self.at_face(wo, normal, [rs, rp], [s * p, safe_sqrt((1.0 - rs) * (1.0 - rp))])
    }

    /// Returns the same for a thin pane of this index of refraction, all inner reflections included; their phases are
    /// left out.
    pub fn at_pane(self, wo: Vec3, normal: Vec3, ior: f32) -> InterfaceReflection {
        let (s, p) = fresnel::amplitudes(wo.dot(normal), ior);
        let (rs, rp) = (s * s, p * p);
        let transmitted = (1.0 - rs) * (1.0 - rp) / (1.0 - rs * rp).max(f32::EPSILON);
        self.at_face(
            wo,
            normal,
            fresnel::pane_reflectances(wo.dot(normal), ior),
            [s * p * (1.0 + transmitted), transmitted],
        )
    }

    /// Returns the reflectance and the polarisations for the reflectances of s and p polarisation, and the factors of
    /// Stokes U under reflection and transmission.
    fn at_face(
        self,
        wo: Vec3,
        normal: Vec3,
        [rs, rp]: [f32; 2],
        [cross_reflected, cross_transmitted]: [f32; 2],
    ) -> InterfaceReflection {
        let axis = s_axis(wo, normal);
        let Polarisation { q, u, .. } = self.relative_to(axis, -wo);
        // Apply the Mueller matrix of intensities a (s) and b (p), normalised to unit intensity
        let apply = |a: f32, b: f32, cross: f32| {
            let intensity = 0.5 * ((a + b) + q * (a - b));
            let inverse = 1.0 / intensity.max(1e-12);
            let after = Polarisation { axis, q: 0.5 * ((a - b) + q * (a + b)) * inverse, u: u * cross * inverse };
            (intensity, after)
        };
        let (reflectance, reflected) = apply(rs, rp, cross_reflected);
        let (_, transmitted) = apply(1.0 - rs, 1.0 - rp, cross_transmitted);
        InterfaceReflection { reflectance: reflectance.clamp(0.0, 1.0), reflected, transmitted }
    }
}

/// Returns Stokes Q and U relative to another axis. Both axes are perpendicular to the unit direction of the path.
fn rotated<T>((q, u): (T, T), from: Vec3, to: Vec3, path: Vec3) -> (T, T)
where
    T: Copy + Mul<f32, Output = T> + Add<Output = T> + Sub<Output = T>,
{
    let (cos, sin) = (from.dot(to), from.cross(to).dot(path));
    // Cosine and sine of twice the angle between the axes
    let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * sin * cos);
    (q * cos2 + u * sin2, u * cos2 - q * sin2)
}

/// Returns the unit s direction of a plane of incidence; at normal incidence any axis is one.
fn s_axis(wo: Vec3, normal: Vec3) -> Vec3 {
    wo.cross(normal).try_normalize().unwrap_or_else(|| wo.any_orthonormal_vector())
}

/// Light that passed clear faces, in three colours: a Stokes vector without its circular part.
#[derive(Clone, Copy, Debug)]
pub struct TransmittedLight {
    axis: Vec3,
    intensity: Vec3,
    q: Vec3,
    u: Vec3,
}

impl TransmittedLight {
    /// Unpolarised light of intensity 1.
    pub const UNPOLARISED: TransmittedLight =
        TransmittedLight { axis: Vec3::X, intensity: Vec3::ONE, q: Vec3::ZERO, u: Vec3::ZERO };

    /// Returns the intensity.
    pub fn intensity(&self) -> Vec3 {
        self.intensity
    }

    /// Scales the light by a transmittance that does not depend on the polarisation.
    pub fn absorb(&mut self, transmittance: Vec3) {
        self.intensity *= transmittance;
        self.q *= transmittance;
        self.u *= transmittance;
    }

    /// Transmits the light through faces of this normal, with transmittances for s and p polarisation. `direction` is
    /// the unit direction of the light.
    pub fn transmit(&mut self, normal: Vec3, direction: Vec3, [ts, tp]: [Vec3; 2]) {
        let axis = s_axis(direction, normal);
        let (q, u) = rotated((self.q, self.u), self.axis, axis, direction);
        let (sum, difference) = (0.5 * (ts + tp), 0.5 * (ts - tp));
        *self = TransmittedLight {
            axis,
            intensity: sum * self.intensity + difference * q,
            q: difference * self.intensity + sum * q,
            u: u * (ts * tp).max(Vec3::ZERO).powf(0.5),
        };
    }
}

/// Reflectance and polarisations at an interface.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceReflection {
    /// Reflectance for the incoming polarisation.
    pub reflectance: f32,
    /// Polarisation of the reflected path.
    pub reflected: Polarisation,
    /// Polarisation of the transmitted path.
    pub transmitted: Polarisation,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn incoming(deg: f32) -> Vec3 {
        Vec3::new(deg.to_radians().sin(), 0.0, deg.to_radians().cos())
    }

    #[test]
    fn the_reflectance_of_unpolarised_light_is_the_mean() {
        for deg in [0.0, 30.0, 56.0, 80.0] {
            let wo = incoming(deg);
            let ours = Polarisation::NONE.at_interface(wo, Vec3::Z, 1.5).reflectance;
            assert!((ours - fresnel::dielectric(wo.z, 1.5)).abs() < 1e-6, "{deg}: {ours}");
        }
    }

    #[test]
    fn reflection_at_brewsters_angle_polarises_fully_and_a_crossed_pane_does_not_reflect() {
        let brewster = 1.5_f32.atan().to_degrees();
        let wo = incoming(brewster);
        let after = Polarisation::NONE.at_interface(wo, Vec3::Z, 1.5).reflected;
        assert!((after.q - 1.0).abs() < 1e-4, "{after:?}");
        // A second plate at Brewster's angle, rotated by 90 degrees about the ray, reflects nothing (Malus 1808).
        let path = wo;
        let normal = (path * brewster.to_radians().cos() + after.axis * brewster.to_radians().sin()).normalize();
        assert!(after.at_interface(path, normal, 1.5).reflectance < 1e-4);
        // Without rotation its reflectance is that of s polarisation.
        let same =
            (path * brewster.to_radians().cos() + path.cross(after.axis) * brewster.to_radians().sin()).normalize();
        let (s, _) = fresnel::amplitudes(wo.z, 1.5);
        assert!((after.at_interface(path, same, 1.5).reflectance - s * s).abs() < 1e-4);
    }

    #[test]
    fn the_transmittance_of_two_faces_is_the_mean_over_polarisations() {
        let (wo, n) = (incoming(80.0), 1.52_f32);
        let first = Polarisation::NONE.at_interface(wo, Vec3::Z, n);
        let inside = Vec3::new(wo.x / n, 0.0, (1.0 - (wo.x / n).powi(2)).sqrt());
        let second = first.transmitted.at_interface(inside, Vec3::Z, 1.0 / n);
        let once = (1.0 - first.reflectance) * (1.0 - second.reflectance);
        let (s, p) = fresnel::amplitudes(wo.z, n);
        let expected = 0.5 * ((1.0 - s * s).powi(2) + (1.0 - p * p).powi(2));
        assert!((once - expected).abs() < 1e-5, "{once} for {expected}");
    }
}
