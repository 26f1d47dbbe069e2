//! Closed forms of illuminance, intensity and transmittance, in double precision and independent of the code under
//! test. Used by the README's table and by the tests.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Converts a vector to double precision.
pub fn vec3(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

/// Returns the illuminance, lux, of a polygon of uniform luminance, cd/m2, at `point` on a plane with this normal
/// (Lambert 1760): half the luminance times the sum over the edges of the angle they subtend, times the cosine between
/// the normal and that of the plane through edge and point. Clips the polygon at the receiver's horizon. Independent of
/// the winding.
pub fn polygon(corners: &[DVec3], luminance: f64, point: DVec3, normal: DVec3) -> f64 {
    let above = clip(corners, point, normal);
    let sum: f64 = (0..above.len())
        .map(|i| {
            let (a, b) = ((above[i] - point).normalize(), (above[(i + 1) % above.len()] - point).normalize());
            let edge = a.cross(b);
            let angle = edge.length().atan2(a.dot(b));
            edge.try_normalize().map_or(0.0, |gamma| angle * gamma.dot(normal))
        })
        .sum();
    0.5 * luminance * sum.abs()
}

/// Clips a polygon to the side of a plane that its normal points to (Sutherland and Hodgman 1974).
fn clip(corners: &[DVec3], point: DVec3, normal: DVec3) -> Vec<DVec3> {
    let height = |p: DVec3| (p - point).dot(normal);
    let mut above = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if height(a) >= 0.0 {
            above.push(a);
        }
        if (height(a) > 0.0 && height(b) < 0.0) || (height(a) < 0.0 && height(b) > 0.0) {
            above.push(a + (b - a) * (height(a) / (height(a) - height(b))));
        }
    }
    above
}

/// Returns a disc as a regular polygon of 720 corners with the disc's area.
pub fn disc(centre: DVec3, right: DVec3, up: DVec3, radius: f64) -> Vec<DVec3> {
    const CORNERS: usize = 720;
    let step = 2.0 * PI / CORNERS as f64;
    let radius = radius * (step / step.sin()).sqrt();
    (0..CORNERS).map(|i| centre + (right * (i as f64 * step).cos() + up * (i as f64 * step).sin()) * radius).collect()
}

/// Returns the reflectances (s, p) of a dielectric interface with relative index `n` at an angle of incidence
/// (Fresnel).
pub fn fresnel(angle_rad: f64, n: f64) -> (f64, f64) {
    let cos_i = angle_rad.cos();
    let cos_t = (1.0 - (angle_rad.sin() / n).powi(2)).sqrt();
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    (s * s, p * p)
}

/// Returns the transmittance of a clear pane with all interreflections: the mean of (1 - R) / (1 + R) over both
/// polarisations.
pub fn pane(angle_rad: f64, n: f64) -> f64 {
    let (s, p) = fresnel(angle_rad, n);
    0.5 * ((1.0 - s) / (1.0 + s) + (1.0 - p) / (1.0 + p))
}

/// Returns the illuminance, lux, on the axis of a Lambertian rectangle of this flux, lm, facing it. Lengths in metres.
pub fn rectangle_on_axis(flux: f64, width: f64, height: f64, distance: f64) -> f64 {
    let (a, b) = (0.5 * width, 0.5 * height);
    let (ha, hb) = (distance.hypot(a), distance.hypot(b));
    let luminance = flux / (PI * width * height);
    2.0 * luminance * (a / ha * (b / ha).atan() + b / hb * (a / hb).atan())
}

/// Returns the illuminance, lux, on the axis of a Lambertian disc of this flux, lm, facing it. Lengths in metres.
pub fn disc_on_axis(flux: f64, diameter: f64, distance: f64) -> f64 {
    flux / PI / (0.25 * diameter * diameter + distance * distance)
}

/// Returns the illuminance, lux, on a floor at a distance `beside` from the foot of an isotropic bulb of this flux, lm.
pub fn bulb_over_floor(flux: f64, height: f64, beside: f64) -> f64 {
    flux / (4.0 * PI) * height / (height * height + beside * beside).powf(1.5)
}

/// Returns the axial intensity, cd, of a cone with a hard edge at this full angle.
pub fn hard_cone(flux: f64, full_deg: f64) -> f64 {
    flux / (2.0 * PI * (1.0 - (0.5 * full_deg).to_radians().cos()))
}

/// Returns the axial intensity, cd, of a cone of uniform intensity inside one full angle that falls linearly in angle
/// to zero at another.
pub fn soft_cone(flux: f64, inner_deg: f64, outer_deg: f64) -> f64 {
    let (a, b) = ((0.5 * inner_deg).to_radians(), (0.5 * outer_deg).to_radians());
    flux / (2.0 * PI * (1.0 - (b.sin() - a.sin()) / (b - a)))
}

/// Returns the mean illuminance, lux, in a closed diffuse enclosure of this area, m2, and reflectance.
pub fn closed_box(flux: f64, area: f64, reflectance: f64) -> f64 {
    flux / (area * (1.0 - reflectance))
}
