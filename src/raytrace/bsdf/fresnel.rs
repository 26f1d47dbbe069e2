//! Reflection at smooth interfaces.

use crate::math::safe_sqrt;
use glam::Vec3;

/// Unpolarised reflectance of a dielectric interface; `eta` is the index behind over the index before. 1 under total
/// internal reflection.
pub fn dielectric(cos_incident: f32, eta: f32) -> f32 {
    let cos_i = cos_incident.clamp(0.0, 1.0);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = safe_sqrt(1.0 - sin2_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t).max(f32::MIN_POSITIVE);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t).max(f32::MIN_POSITIVE);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Schlick's approximation for a metal whose normal reflectance is `f0`; the angle is the one to the half vector.
pub fn schlick(f0: Vec3, cos_half: f32) -> Vec3 {
    let x = (1.0 - cos_half).clamp(0.0, 1.0);
    let x2 = x * x;
    f0 + (Vec3::ONE - f0) * (x2 * x2 * x)
}

/// Refracted direction in a frame whose +Z is on the side of `wo`; none under total internal reflection. `eta` is the
/// index behind over the index before.
pub fn refract(wo: Vec3, eta: f32) -> Option<Vec3> {
    let sin2_t = (1.0 - wo.z * wo.z).max(0.0) / (eta * eta);
    (sin2_t < 1.0).then(|| Vec3::new(-wo.x / eta, -wo.y / eta, -safe_sqrt(1.0 - sin2_t)))
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
    fn a_pane_transmits_what_the_table_says() {
        // light_and_camera.md, n = 1.52, both faces with all inner reflections: T = (1 - R) / (1 + R), but for each
        // polarisation apart; the mean of both is the table.
        for (deg, table) in [(0.0_f64, 0.918), (30.0, 0.916), (60.0, 0.844), (80.0, 0.456)] {
            let cos_i = deg.to_radians().cos();
            let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (1.52 * 1.52)).sqrt();
            let p = ((1.52 * cos_i - cos_t) / (1.52 * cos_i + cos_t)).powi(2);
            let s = ((cos_i - 1.52 * cos_t) / (cos_i + 1.52 * cos_t)).powi(2);
            let ours = f64::from(dielectric(cos_i as f32, 1.52));
            assert!((ours - 0.5 * (p + s)).abs() < 1e-5);
            // An unpolarised renderer takes the mean reflectance first; that is what it can promise.
            let transmitted = (1.0 - ours) / (1.0 + ours);
            assert!((transmitted - table).abs() < 0.05, "{deg}: {transmitted}");
        }
    }

    #[test]
    fn total_reflection_and_straight_through() {
        assert_eq!(dielectric(0.3, 1.0 / 1.5), 1.0);
        assert!(refract(Vec3::new(0.95, 0.0, 0.3122), 1.0 / 1.5).is_none());
        assert!((refract(Vec3::Z, 1.5).unwrap() - Vec3::NEG_Z).length() < 1e-6);
        // Snell: 30 degrees into 1.5 leaves at asin(1/3).
        let wo = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
        assert!((refract(wo, 1.5).unwrap().x + 1.0 / 3.0).abs() < 1e-6);
    }
}
