//! The kernels in portable Rust, for CPUs without AVX2 and as the reference that tests compare the intrinsics with.

use super::box_packet::{BoxPacket, SLAB_EXIT_SCALE, SlabRay};
use super::kernels::Kernels;
use super::segment_packet::{NearestSegment, RibbonRay, SegmentHit, SegmentPacket};
use super::triangle_packet::{ShearedRay, TriangleHit, TrianglePacket, edges_in_f64};
use crate::math::simd::LANES;
use std::array::from_fn;

/// Kernels for every CPU.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

/// Returns `a` where it is larger than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn max_or(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Returns `a` where it is smaller than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn min_or(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Kernels for Scalar {
    #[inline(always)]
    fn intersect_boxes(ray: &SlabRay, boxes: &BoxPacket, t_max: f32, enter: &mut [f32; LANES]) -> u32 {
        *enter = [0.0; LANES];
        let mut exit = [t_max; LANES];
        for axis in 0..3 {
            let (near, far) = boxes.slabs(ray, axis);
            let (origin, minus_inverse) = (ray.origin[axis], ray.minus_inverse[axis]);
            for i in 0..LANES {
                enter[i] = max_or((origin - near[i]) * minus_inverse, enter[i]);
                exit[i] = min_or((origin - far[i]) * minus_inverse, exit[i]);
            }
        }
        (0..LANES).fold(0, |mask, i| mask | u32::from(enter[i] <= exit[i] * SLAB_EXIT_SCALE) << i)
    }

    #[inline(always)]
    fn intersect_triangles(ray: &ShearedRay, triangles: &TrianglePacket, t_max: f32) -> Option<TriangleHit> {
        // Translate the corners to the ray's origin
        let [kx, ky, kz] = ray.axes;
        let corner =
            |v: usize, axis: usize| -> [f32; LANES] { from_fn(|i| triangles.corners[v][axis][i] - ray.origin[axis]) };
        let depth: [[f32; LANES]; 3] = from_fn(|v| corner(v, kz));
        // Shear them, so that the ray points along +Z
        let sheared = |axis: usize, shear: f32| -> [[f32; LANES]; 3] {
            from_fn(|v| {
                let translated = corner(v, axis);
                from_fn(|i| translated[i] - shear * depth[v][i])
            })
        };
        let (x, y) = (sheared(kx, ray.shear[0]), sheared(ky, ray.shear[1]));
        // Evaluate the edge functions, in f64 where one is 0
        let mut edges: [[f32; LANES]; 3] = from_fn(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            from_fn(|i| x[b][i] * y[a][i] - y[b][i] * x[a][i])
        });
        if edges.iter().flatten().any(|&e| e == 0.0) {
            edges_in_f64(&mut edges, &x, &y);
        }
        // Interpolate the hit distance
        let t: [f32; LANES] = from_fn(|i| {
            let z: [f32; 3] = from_fn(|v| ray.shear[2] * depth[v][i]);
            let determinant = edges[0][i] + edges[1][i] + edges[2][i];
            (edges[0][i] * z[0] + edges[1][i] * z[1] + edges[2][i] * z[2]) / determinant
        });
        // Select the nearest hit in range: edge functions of one sign are inside
        let inside = |i: usize| edges.iter().all(|e| e[i] >= 0.0) || edges.iter().all(|e| e[i] <= 0.0);
        let hits = (0..LANES).filter(|&i| inside(i) && t[i] > 0.0 && t[i] < t_max);
        let nearest = hits.min_by(|&a, &b| t[a].total_cmp(&t[b]))?;
        Some(triangles.hit(nearest, t[nearest], edges.map(|e| e[nearest])))
    }

    #[inline(always)]
    fn intersect_segments(ray: &RibbonRay, segments: &SegmentPacket, t_max: f32) -> Option<SegmentHit> {
        let mut nearest: Option<NearestSegment> = None;
        for lane in 0..LANES {
            // Transform both ends to the frame of the ray
            let end = |end: usize, axis: usize| {
                let offset = |k: usize| segments.ends[end][k][lane] - ray.origin[k];
                let axis = &ray.axes[axis];
                offset(0) * axis[0] + offset(1) * axis[1] + offset(2) * axis[2]
            };
            let ([x0, y0, z0], [x1, y1, z1]) = ([end(0, 0), end(0, 1), end(0, 2)], [end(1, 0), end(1, 1), end(1, 2)]);
            // Find the point of the axis that is nearest to the ray
            let along = [x1 - x0, y1 - y0];
            let length2 = along[0] * along[0] + along[1] * along[1];
            let s = min_or(max_or((-(x0 * along[0] + y0 * along[1])) / length2, 0.0), 1.0);
            let to_axis = [x0 + s * along[0], y0 + s * along[1]];
            // Compare its distance with the radius
            let [r0, r1] = [segments.ends[0][3][lane], segments.ends[1][3][lane]];
            let radius = r0 + s * (r1 - r0);
            let t = z0 + s * (z1 - z0);
            let distance2 = to_axis[0] * to_axis[0] + to_axis[1] * to_axis[1];
            let is_hit = distance2 <= radius * radius && t > 0.0 && t < t_max;
            if is_hit && nearest.as_ref().is_none_or(|nearest| t < nearest.t) {
                nearest = Some(NearestSegment { lane, t, s, along, to_axis, radius });
            }
        }
        nearest.map(|nearest| segments.hit(&nearest))
    }

    #[inline(always)]
    fn sobol_4d(indices: [u32; 2], seeds: [u32; 2]) -> [[f32; 4]; 2] {
        [0, 1].map(|i| sobol_burley::sample_4d(indices[i], 0, seeds[i]))
    }
}
