//! The kernels in AVX2, 256 bits wide. The one place with `unsafe` code.
#![expect(unsafe_code, reason = "calls into code made for AVX2, behind the check that the processor has it")]

use super::{Kernels, Query, WIDTH};
use crate::raytrace::bvh::{Node, Slabs, WIDEN};
use crate::raytrace::triangle::{Packet, Sheared, TriangleHit, edges_in_f64};
use std::arch::x86_64::*;

/// Runs a query with these kernels.
///
/// # Panics
/// Never: [`super::dispatch`] has asked the processor; this asks again because it is free beside a query.
#[inline]
pub fn run<Q: Query>(query: Q) -> Q::Answer {
    debug_assert!(std::arch::is_x86_feature_detected!("avx2"));
    // SAFETY: `dispatch`, the only caller, has just found that the processor has AVX2.
    unsafe { compiled_for_avx2(query) }
}

#[target_feature(enable = "avx2")]
fn compiled_for_avx2<Q: Query>(query: Q) -> Q::Answer {
    query.run::<Avx2>()
}

/// Kernels for processors with AVX2. Private, so that only [`compiled_for_avx2`] can name them.
struct Avx2;

impl Kernels for Avx2 {
    #[inline(always)]
    fn boxes(slabs: &Slabs, node: &Node, t_max: f32, enter: &mut [f32; WIDTH]) -> u32 {
        // SAFETY: this type is only named inside `compiled_for_avx2`.
        unsafe { boxes(slabs, node, t_max, enter) }
    }

    #[inline(always)]
    fn triangles(packet: &Packet, ray: &Sheared, t_max: f32) -> Option<TriangleHit> {
        // SAFETY: this type is only named inside `compiled_for_avx2`.
        unsafe { triangles(packet, ray, t_max) }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn load(values: &[f32; WIDTH]) -> __m256 {
    // SAFETY: eight floats are read from an array of eight.
    unsafe { _mm256_loadu_ps(values.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(values: __m256) -> [f32; WIDTH] {
    let mut array = [0.0; WIDTH];
    // SAFETY: eight floats are written to an array of eight.
    unsafe { _mm256_storeu_ps(array.as_mut_ptr(), values) };
    array
}

#[inline]
#[target_feature(enable = "avx2")]
fn boxes(slabs: &Slabs, node: &Node, t_max: f32, enter: &mut [f32; WIDTH]) -> u32 {
    let mut entered = _mm256_setzero_ps();
    let mut left = _mm256_set1_ps(t_max);
    for axis in 0..3 {
        let (near, far) = node.sides(slabs, axis);
        let origin = _mm256_set1_ps(slabs.origin[axis]);
        let minus_inverse = _mm256_set1_ps(slabs.minus_inverse[axis]);
        // These give their second operand when the first is NaN.
        entered = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(origin, load(near)), minus_inverse), entered);
        left = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(origin, load(far)), minus_inverse), left);
    }
    *enter = store(entered);
    let widened = _mm256_mul_ps(left, _mm256_set1_ps(WIDEN));
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entered, widened)) as u32
}

#[inline]
#[target_feature(enable = "avx2")]
fn triangles(packet: &Packet, ray: &Sheared, t_max: f32) -> Option<TriangleHit> {
    let corner =
        |v: usize, axis: usize| _mm256_sub_ps(load(&packet.corners[v][axis]), _mm256_set1_ps(ray.origin[axis]));
    let [kx, ky, kz] = ray.axes;
    let depth = [corner(0, kz), corner(1, kz), corner(2, kz)];
    let shear =
        |v: usize, axis: usize, by: f32| _mm256_sub_ps(corner(v, axis), _mm256_mul_ps(_mm256_set1_ps(by), depth[v]));
    let x = [shear(0, kx, ray.shear[0]), shear(1, kx, ray.shear[0]), shear(2, kx, ray.shear[0])];
    let y = [shear(0, ky, ray.shear[1]), shear(1, ky, ray.shear[1]), shear(2, ky, ray.shear[1])];
    let edge = |a: usize, b: usize| _mm256_sub_ps(_mm256_mul_ps(x[b], y[a]), _mm256_mul_ps(y[b], x[a]));
    let mut e = [edge(1, 2), edge(2, 0), edge(0, 1)];
    let zero = _mm256_setzero_ps();
    let is_zero = |e| _mm256_cmp_ps::<_CMP_EQ_OQ>(e, zero);
    let on_edge = _mm256_or_ps(_mm256_or_ps(is_zero(e[0]), is_zero(e[1])), is_zero(e[2]));
    if _mm256_movemask_ps(on_edge) != 0 {
        let mut exact = e.map(|e| store(e));
        edges_in_f64(&mut exact, &x.map(|x| store(x)), &y.map(|y| store(y)));
        e = [load(&exact[0]), load(&exact[1]), load(&exact[2])];
    }
    // Unused lanes are NaN in all three, and pass neither test.
    let smallest = _mm256_min_ps(_mm256_min_ps(e[0], e[1]), e[2]);
    let largest = _mm256_max_ps(_mm256_max_ps(e[0], e[1]), e[2]);
    let inside = _mm256_or_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(smallest, zero), _mm256_cmp_ps::<_CMP_LE_OQ>(largest, zero));
    if _mm256_movemask_ps(inside) == 0 {
        return None;
    }
    let z = depth.map(|d| _mm256_mul_ps(_mm256_set1_ps(ray.shear[2]), d));
    let determinant = _mm256_add_ps(_mm256_add_ps(e[0], e[1]), e[2]);
    let weighted =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(e[0], z[0]), _mm256_mul_ps(e[1], z[1])), _mm256_mul_ps(e[2], z[2]));
    // A determinant of zero gives infinity or NaN, which the comparisons refuse.
    let t = _mm256_div_ps(weighted, determinant);
    let in_range =
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(t, zero), _mm256_cmp_ps::<_CMP_LT_OQ>(t, _mm256_set1_ps(t_max)));
    let mut hits = _mm256_movemask_ps(_mm256_and_ps(inside, in_range)) as u32;
    if hits == 0 {
        return None;
    }
    let t = store(t);
    let mut nearest = hits.trailing_zeros() as usize % WIDTH;
    hits &= hits - 1;
    while hits != 0 {
        let other = hits.trailing_zeros() as usize % WIDTH;
        hits &= hits - 1;
        if t[other] < t[nearest] {
            nearest = other;
        }
    }
    Some(packet.hit(nearest, t[nearest], e.map(|e| store(e)[nearest])))
}
