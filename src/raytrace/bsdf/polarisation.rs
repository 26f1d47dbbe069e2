//! Linear polarisation between clear faces: what one face has taken from a polarisation, the next cannot take again.
//! Without it a pane under 60 degrees lets through 1.6 % too little, under 80 degrees 4 %.
//!
//! A path from the camera carries the polarisation that the sensor would accept (a Stokes vector of unit intensity
//! without its circular part; Born and Wolf, "Principles of Optics", 1.5). Anything but clear glass makes it forget.

use super::fresnel;
use glam::Vec3;

/// Accepted polarisation, relative to a direction across the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarisation {
    /// Unit vector across the path.
    across: Vec3,
    /// Share along `across` less the share at right angles to it.
    q: f32,
    /// The same, turned by 45 degrees.
    u: f32,
}

impl Polarisation {
    /// Every polarisation alike.
    pub const NONE: Polarisation = Polarisation { across: Vec3::X, q: 0.0, u: 0.0 };

    /// The same, expressed along another direction across the path, whose own unit direction is `path`.
    fn along(self, across: Vec3, path: Vec3) -> Self {
        let (cos, sin) = (self.across.dot(across), self.across.cross(across).dot(path));
        // Twice the angle between the two.
        let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * sin * cos);
        Polarisation { across, q: self.q * cos2 + self.u * sin2, u: self.u * cos2 - self.q * sin2 }
    }

    /// Reflectance of a face for this polarisation, and the polarisations after reflection and transmission. `wo` points
    /// back along the path, `normal` is on its side, `eta` is the index behind over the one before.
    pub fn at_interface(self, wo: Vec3, normal: Vec3, eta: f32) -> InterfaceReflection {
        // Straight on there is no plane of incidence, and any will do.
        let across = wo.cross(normal).try_normalize().unwrap_or_else(|| wo.any_orthonormal_vector());
        let Polarisation { q, u, .. } = self.along(across, -wo);
        let (s, p) = fresnel::amplitudes(wo.dot(normal), eta);
        let (rs, rp) = (s * s, p * p);
        let mix = |a: f32, b: f32, cross: f32| {
            let share = 0.5 * ((a + b) + q * (a - b));
            let inverse = 1.0 / share.max(1e-12);
            let after = Polarisation { across, q: 0.5 * ((a - b) + q * (a + b)) * inverse, u: u * cross * inverse };
            (share, after)
        };
        let (reflectance, reflected) = mix(rs, rp, s * p);
        let (_, transmitted) = mix(1.0 - rs, 1.0 - rp, ((1.0 - rs) * (1.0 - rp)).max(0.0).sqrt());
        InterfaceReflection { reflectance: reflectance.clamp(0.0, 1.0), reflected, transmitted }
    }
}

/// What happens at a face.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceReflection {
    /// Share that is reflected.
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
    fn unpolarised_light_sees_fresnels_mean() {
        for deg in [0.0, 30.0, 56.0, 80.0] {
            let wo = incoming(deg);
            let ours = Polarisation::NONE.at_interface(wo, Vec3::Z, 1.5).reflectance;
            assert!((ours - fresnel::dielectric(wo.z, 1.5)).abs() < 1e-6, "{deg}: {ours}");
        }
    }

    #[test]
    fn brewsters_angle_polarises_fully_and_crossed_panes_do_not_reflect() {
        let brewster = 1.5_f32.atan().to_degrees();
        let wo = incoming(brewster);
        let after = Polarisation::NONE.at_interface(wo, Vec3::Z, 1.5).reflected;
        assert!((after.q - 1.0).abs() < 1e-4, "{after:?}");
        // A second plate at Brewster's angle, turned by 90 degrees about the ray, gives nothing back (Malus 1808).
        let path = wo;
        let normal = (path * brewster.to_radians().cos() + after.across * brewster.to_radians().sin()).normalize();
        assert!(after.at_interface(path, normal, 1.5).reflectance < 1e-4);
        // Not turned, it gives back all of the s reflectance.
        let same =
            (path * brewster.to_radians().cos() + path.cross(after.across) * brewster.to_radians().sin()).normalize();
        let (s, _) = fresnel::amplitudes(wo.z, 1.5);
        assert!((after.at_interface(path, same, 1.5).reflectance - s * s).abs() < 1e-4);
    }

    #[test]
    fn two_faces_of_a_pane_pass_what_each_polarisation_passes() {
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
