//! Shading normals from normal maps.
//!
//! The tangent frame of a point is that of its triangle: the derivatives of the position by the texture coordinates,
//! made orthogonal to the interpolated normal. Every renderer computes it from positions and texture coordinates alone,
//! so that mirrored and turned charts need no tangents in the mesh.

use super::safe_sqrt;
use glam::{Mat3, Vec2, Vec3};

/// How much further than needed a normal is bent.
const BEND_MARGIN: f32 = 1e-3;

/// Returns the derivatives of the position of a triangle by its texture coordinates, for the edges from its first corner
/// and their differences in texture coordinates. Returns none where the texture has no area.
pub fn position_derivatives(edges: [Vec3; 2], uv_edges: [Vec2; 2]) -> Option<[Vec3; 2]> {
    let [duv1, duv2] = uv_edges;
    let determinant = duv1.perp_dot(duv2);
    let du = (edges[0] * duv2.y - edges[1] * duv1.y) / determinant;
    let dv = (edges[1] * duv1.x - edges[0] * duv2.x) / determinant;
    (du.is_finite() && dv.is_finite()).then_some([du, dv])
}

/// Returns the direction that a pixel of a normal map stands for, tangent space: X along +U, Y along +V, Z along the
/// normal. `rgb` lies in 0 to 1; `scale` tilts it.
pub fn decode_normal(rgb: Vec3, scale: f32) -> Vec3 {
    let direction = rgb * 2.0 - Vec3::ONE;
    Vec3::new(direction.x * scale, direction.y * scale, direction.z)
}

/// Returns the tangent frame of a unit normal for the derivatives of the position: unit tangents along U and, across it,
/// along V, and the normal. Returns none where it is degenerate.
pub fn tangent_frame(normal: Vec3, [du, dv]: [Vec3; 2]) -> Option<Mat3> {
    let tangent = (du - normal * normal.dot(du)).try_normalize()?;
    let bitangent = normal.cross(tangent);
    let bitangent = if bitangent.dot(dv) < 0.0 { -bitangent } else { bitangent };
    Some(Mat3::from_cols(tangent, bitangent, normal))
}

/// Returns a unit normal tilted to a direction in tangent space, for the derivatives of the position. Returns the normal
/// itself where the frame is degenerate.
pub fn tilted_normal(normal: Vec3, derivatives: [Vec3; 2], direction: Vec3) -> Vec3 {
    tangent_frame(normal, derivatives).and_then(|frame| (frame * direction).try_normalize()).unwrap_or(normal)
}

/// Bends a shading normal towards the geometric normal as far as is needed for the mirror direction of `view_dir` to lie
/// above the geometric surface. All three are unit vectors; `view_dir` is above the geometric surface.
///
/// With c, a and d the cosines between geometric normal and view, normal and view, and both normals, the bent normal is
/// N + s Ng: its mirror direction is above the surface where `c s^2 + 2 a s + 2 a d - c >= 0`. The result is continuous,
/// so that there are no black patches at grazing angles.
pub fn bend_above(normal: Vec3, geometric_normal: Vec3, view_dir: Vec3) -> Vec3 {
    let c = view_dir.dot(geometric_normal).max(1e-6);
    let (a, d) = (view_dir.dot(normal), normal.dot(geometric_normal));
    if a > 0.0 && 2.0 * a * d >= c {
        return normal;
    }
    // The larger root, by the form without cancellation
    let root = safe_sqrt(a * a + c * (c - 2.0 * a * d));
    let s = if a > 0.0 { (c - 2.0 * a * d) / (a + root).max(1e-12) } else { (root - a) / c };
    // Slightly more: rounding must not put the mirror direction below
    let bent = (normal + geometric_normal * s).try_normalize().unwrap_or(geometric_normal);
    (bent + geometric_normal * BEND_MARGIN).try_normalize().unwrap_or(geometric_normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;

    #[test]
    fn a_flat_map_keeps_the_normal_and_red_leans_along_u() {
        let normal = Vec3::new(0.1, 0.2, 1.0).normalize();
        let derivatives = position_derivatives([Vec3::X * 2.0, Vec3::Y * 3.0], [Vec2::X, Vec2::Y]).unwrap();
        assert_eq!(derivatives, [Vec3::X * 2.0, Vec3::Y * 3.0]);
        let tilt = |rgb| tilted_normal(normal, derivatives, decode_normal(rgb, 1.0));
        assert!(tilt(Vec3::new(0.5, 0.5, 1.0)).distance(normal) < 1e-6);
        let leaning = |rgb| tilted_normal(Vec3::Z, derivatives, decode_normal(rgb, 1.0));
        assert!(leaning(Vec3::new(1.0, 0.5, 0.5)).distance(Vec3::X) < 1e-6);
        assert!(leaning(Vec3::new(0.5, 1.0, 0.5)).distance(Vec3::Y) < 1e-6);
        // A mirrored chart: U runs to the left
        let mirrored = position_derivatives([Vec3::X, Vec3::Y], [-Vec2::X, Vec2::Y]).unwrap();
        let leaning = |rgb| tilted_normal(Vec3::Z, mirrored, decode_normal(rgb, 1.0));
        assert!(leaning(Vec3::new(1.0, 0.5, 0.5)).distance(-Vec3::X) < 1e-6);
        assert!(leaning(Vec3::new(0.5, 1.0, 0.5)).distance(Vec3::Y) < 1e-6);
        assert!(position_derivatives([Vec3::X, Vec3::Y], [Vec2::ONE; 2]).is_none());
    }

    #[test]
    fn a_bent_normal_mirrors_the_view_above_the_surface_and_changes_no_more_than_it_must() {
        let mut bent = 0;
        for i in 0..20_000 {
            let set = sobol_burley::sample_4d(i, 0, 5);
            let view = warp::cosine_hemisphere(Vec2::new(set[0], set[1]));
            // One in four views grazes the surface
            let view = if i % 4 == 0 { (view * Vec3::new(1.0, 1.0, 1e-3)).normalize() } else { view };
            let normal = warp::uniform_sphere(Vec2::new(set[2], set[3]));
            let result = bend_above(normal, Vec3::Z, view);
            let mirrored = 2.0 * view.dot(result) * result - view;
            assert!(
                mirrored.z >= -1e-6 && view.dot(result) > 0.0 && result.is_normalized(),
                "{view} {normal} {result}"
            );
            let was_fine = view.dot(normal) > 0.0 && (2.0 * view.dot(normal) * normal - view).z >= 0.0;
            assert!(!was_fine || result == normal);
            // No further than to where the mirror direction grazes
            bent += u32::from(!was_fine);
            assert!(was_fine || mirrored.z < 0.01, "{view} {normal} {mirrored}");
        }
        assert!(bent > 5000);
    }
}
