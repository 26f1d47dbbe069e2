//! Fresnel reflection and refraction at smooth interfaces.

use crate::math::safe_sqrt;
use glam::Vec3;

/// Returns the reflected amplitudes (s, p) of a dielectric interface; `eta` is the index of the transmitted side over
/// that of the incident side (Born and Wolf, "Principles of Optics", section 1.5.2). Both are 1 under total internal
/// reflection, whose phase is left out.
#[inline(always)]
pub fn amplitudes(cos_incident: f32, eta: f32) -> (f32, f32) {
    let cos_i = cos_incident.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    let cos_t = safe_sqrt(1.0 - sin2_t);
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t).max(f32::MIN_POSITIVE);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t).max(f32::MIN_POSITIVE);
    // Selected without a branch, so that loops over lanes vectorize
    if sin2_t >= 1.0 { (1.0, 1.0) } else { (s, p) }
}

/// Returns the reflectance of a dielectric interface for unpolarised light: the mean of both polarisations.
#[inline(always)]
pub fn dielectric(cos_incident: f32, eta: f32) -> f32 {
    let (s, p) = amplitudes(cos_incident, eta);
    0.5 * (s * s + p * p)
}

/// Returns the reflectances (s, p) of a clear pane in air: the geometric series over all inner reflections, 2 R / (1 +
/// R) for the reflectance R of a face.
pub fn pane_reflectances(cos_incident: f32, ior: f32) -> [f32; 2] {
    let (s, p) = amplitudes(cos_incident.abs(), ior);
    [s * s, p * p].map(|r| 2.0 * r / (1.0 + r))
}

/// Returns Schlick's approximation (1994) for a metal of normal reflectance `f0`; `cos_half` is the cosine at the half
/// vector.
#[inline(always)]
pub fn schlick(f0: Vec3, cos_half: f32) -> Vec3 {
    let x = (1.0 - cos_half).clamp(0.0, 1.0);
    let x2 = x * x;
    f0 + (Vec3::ONE - f0) * (x2 * x2 * x)
}

/// Refracts a direction in a frame whose +Z is on the side of `wo`; none under total internal reflection. `eta` is the
/// index of the transmitted side over that of the incident side.
pub fn refract(wo: Vec3, eta: f32) -> Option<Vec3> {
    let sin2_t = (1.0 - wo.z * wo.z).max(0.0) / (eta * eta);
    (sin2_t < 1.0).then(|| Vec3::new(-wo.x / eta, -wo.y / eta, -safe_sqrt(1.0 - sin2_t)))
}

/// Refracts a direction about a unit normal on the side of the unit vector `wo`, in any space.
pub fn refract_about(wo: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos = wo.dot(normal).clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos * cos) / (eta * eta);
    let tangential = normal * cos - wo;
    (sin2_t < 1.0).then(|| (tangential / eta - normal * safe_sqrt(1.0 - sin2_t)).normalize_or_zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_gives_f0_from_the_index() {
        let f0 = |n: f32| ((n - 1.0) / (n + 1.0)).powi(2);
        for n in [1.0, 1.33, 1.5, 2.4] {
            assert!((dielectric(1.0, n) - f0(n)).abs() < 1e-6);
        }
    }

    #[test]
    fn refraction_at_normal_incidence_at_thirty_degrees_and_beyond_the_critical_angle() {
        assert_eq!(dielectric(0.3, 1.0 / 1.5), 1.0);
        assert!(refract(Vec3::new(0.95, 0.0, 0.3122), 1.0 / 1.5).is_none());
        assert!((refract(Vec3::Z, 1.5).unwrap() - Vec3::NEG_Z).length() < 1e-6);
        // Snell: 30 degrees into 1.5 leaves at asin(1/3).
        let wo = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
        assert!((refract(wo, 1.5).unwrap().x + 1.0 / 3.0).abs() < 1e-6);
        assert!((refract(wo, 1.5).unwrap() - refract_about(wo, Vec3::Z, 1.5).unwrap()).length() < 1e-6);
    }
}
