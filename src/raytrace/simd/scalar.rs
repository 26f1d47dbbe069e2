//! The kernels in portable Rust: what other processors run, and the twin that tests hold the intrinsics to.

use super::{Kernels, WIDTH};
use crate::raytrace::bvh::{Node, Slabs, WIDEN};
use crate::raytrace::triangle::{Packet, ShearedRay, TriangleHit, edges_in_f64};
use std::array::from_fn;

/// Kernels that every processor can run.
#[derive(Clone, Copy, Debug)]
pub struct Scalar;

/// `a` where it is larger than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn max_or(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a` where it is smaller than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn min_or(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Kernels for Scalar {
    #[inline(always)]
    fn boxes(slabs: &Slabs, node: &Node, t_max: f32, enter: &mut [f32; WIDTH]) -> u32 {
        *enter = [0.0; WIDTH];
        let mut leave = [t_max; WIDTH];
        for axis in 0..3 {
            let (near, far) = node.sides(slabs, axis);
            let (origin, minus_inverse) = (slabs.origin[axis], slabs.minus_inverse[axis]);
            for i in 0..WIDTH {
                enter[i] = max_or((origin - near[i]) * minus_inverse, enter[i]);
                leave[i] = min_or((origin - far[i]) * minus_inverse, leave[i]);
            }
        }
        (0..WIDTH).fold(0, |mask, i| mask | u32::from(enter[i] <= leave[i] * WIDEN) << i)
    }

    #[inline(always)]
    fn triangles(packet: &Packet, ray: &ShearedRay, t_max: f32) -> Option<TriangleHit> {
        let [kx, ky, kz] = ray.axes;
        let corner =
            |v: usize, axis: usize| -> [f32; WIDTH] { from_fn(|i| packet.corners[v][axis][i] - ray.origin[axis]) };
        let depth: [[f32; WIDTH]; 3] = from_fn(|v| corner(v, kz));
        let sheared = |axis: usize, shear: f32| -> [[f32; WIDTH]; 3] {
            from_fn(|v| {
                let place = corner(v, axis);
                from_fn(|i| place[i] - shear * depth[v][i])
            })
        };
        let (x, y) = (sheared(kx, ray.shear[0]), sheared(ky, ray.shear[1]));
        let mut edges: [[f32; WIDTH]; 3] = from_fn(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            from_fn(|i| x[b][i] * y[a][i] - y[b][i] * x[a][i])
        });
        if edges.iter().flatten().any(|&e| e == 0.0) {
            edges_in_f64(&mut edges, &x, &y);
        }
        let t: [f32; WIDTH] = from_fn(|i| {
            let z: [f32; 3] = from_fn(|v| ray.shear[2] * depth[v][i]);
            let determinant = edges[0][i] + edges[1][i] + edges[2][i];
            (edges[0][i] * z[0] + edges[1][i] * z[1] + edges[2][i] * z[2]) / determinant
        });
        let inside = |i: usize| edges.iter().all(|e| e[i] >= 0.0) || edges.iter().all(|e| e[i] <= 0.0);
        let hits = (0..WIDTH).filter(|&i| inside(i) && t[i] > 0.0 && t[i] < t_max);
        let nearest = hits.min_by(|&a, &b| t[a].total_cmp(&t[b]))?;
        Some(packet.hit(nearest, t[nearest], edges.map(|e| e[nearest])))
    }

    #[inline(always)]
    fn sobol(index: u32, seeds: [u32; 2]) -> [[f32; 4]; 2] {
        seeds.map(|seed| sobol_burley::sample_4d(index, 0, seed))
    }
}
