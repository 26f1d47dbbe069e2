//! What light does where mathematics can say it, in double precision and independent of the code under test. The table
//! of the README and the tests both take it from here.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// A single-precision vector as a double one.
pub fn vec3(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

/// Illuminance from an evenly luminous polygon at `point` on a plane with this normal (Lambert 1760): half the luminance
/// times the sum of each edge's angle, projected by the normal of the plane through that edge. What lies below the
/// receiver's horizon is cut off first. The order of the corners does not matter.
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

/// The part of a polygon above a plane (Sutherland and Hodgman 1974).
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

/// A disc as a polygon of many corners, with the disc's area.
pub fn disc(centre: DVec3, right: DVec3, up: DVec3, radius: f64) -> Vec<DVec3> {
    const CORNERS: usize = 720;
    let step = 2.0 * PI / CORNERS as f64;
    let radius = radius * (step / step.sin()).sqrt();
    (0..CORNERS).map(|i| centre + (right * (i as f64 * step).cos() + up * (i as f64 * step).sin()) * radius).collect()
}

/// Reflectance of each polarisation (s, p) of a dielectric interface under an angle of incidence.
pub fn fresnel(angle_rad: f64, n: f64) -> (f64, f64) {
    let cos_i = angle_rad.cos();
    let cos_t = (1.0 - (angle_rad.sin() / n).powi(2)).sqrt();
    let s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    (s * s, p * p)
}

/// Transmittance of a clear pane with all inner reflections: (1 - R) / (1 + R) for each polarisation, and their mean.
pub fn pane(angle_rad: f64, n: f64) -> f64 {
    let (s, p) = fresnel(angle_rad, n);
    0.5 * ((1.0 - s) / (1.0 + s) + (1.0 - p) / (1.0 + p))
}

/// Illuminance on the axis of a rectangle of this flux, facing it: Lambert's formula over its own centre.
pub fn rectangle_on_axis(flux: f64, width: f64, height: f64, distance: f64) -> f64 {
    let (a, b) = (0.5 * width, 0.5 * height);
    let (ha, hb) = (distance.hypot(a), distance.hypot(b));
    let luminance = flux / (PI * width * height);
    2.0 * luminance * (a / ha * (b / ha).atan() + b / hb * (a / hb).atan())
}

/// Illuminance on the axis of a Lambertian disc of this flux, facing it.
pub fn disc_on_axis(flux: f64, diameter: f64, distance: f64) -> f64 {
    flux / PI / (0.25 * diameter * diameter + distance * distance)
}

/// Illuminance under a bulb of this flux at a height over a floor, so far beside it.
pub fn bulb_over_floor(flux: f64, height: f64, beside: f64) -> f64 {
    flux / (4.0 * PI) * height / (height * height + beside * beside).powf(1.5)
}

/// Axial intensity of a hard cone of this full angle.
pub fn hard_cone(flux: f64, full_deg: f64) -> f64 {
    flux / (2.0 * PI * (1.0 - (0.5 * full_deg).to_radians().cos()))
}

/// Axial intensity of a cone that is even inside one full angle and falls linearly in angle to nothing at another.
pub fn soft_cone(flux: f64, inner_deg: f64, outer_deg: f64) -> f64 {
    let (a, b) = ((0.5 * inner_deg).to_radians(), (0.5 * outer_deg).to_radians());
    flux / (2.0 * PI * (1.0 - (b.sin() - a.sin()) / (b - a)))
}

/// Mean illuminance in a closed diffuse box of this area and reflectance.
pub fn closed_box(flux: f64, area: f64, reflectance: f64) -> f64 {
    flux / (area * (1.0 - reflectance))
}
