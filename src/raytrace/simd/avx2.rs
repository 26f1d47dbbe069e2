//! The kernels in AVX2 intrinsics. All `unsafe` code of the crate is here, in [`crate::math::simd`], which detects AVX2,
//! and in `denoise/simd.rs`.
#![expect(unsafe_code, reason = "intrinsics, and calls of functions compiled for AVX2")]

use super::box_packet::{BoxPacket, SLAB_EXIT_SCALE, SlabRay};
use super::kernels::Kernels;
use super::segment_packet::{NearestSegment, RibbonRay, SegmentHit, SegmentPacket};
use super::sobol;
use super::triangle_packet::{ShearedRay, TriangleHit, TrianglePacket, edges_in_f64};
use crate::math::simd::LANES;
use std::arch::x86_64::*;

/// Kernels for CPUs with AVX2.
pub struct Avx2;

impl Kernels for Avx2 {
    #[inline(always)]
    fn intersect_boxes(ray: &SlabRay, boxes: &BoxPacket, t_max: f32, enter: &mut [f32; LANES]) -> u32 {
        // SAFETY: `dispatch` uses this type only with the proof that the CPU supports AVX2, and no other code can name
        // it.
        unsafe { intersect_boxes(ray, boxes, t_max, enter) }
    }

    #[inline(always)]
    fn intersect_triangles(ray: &ShearedRay, triangles: &TrianglePacket, t_max: f32) -> Option<TriangleHit> {
        // SAFETY: `dispatch` uses this type only with the proof that the CPU supports AVX2, and no other code can name
        // it.
        unsafe { intersect_triangles(ray, triangles, t_max) }
    }

    #[inline(always)]
    fn intersect_segments(ray: &RibbonRay, segments: &SegmentPacket, t_max: f32) -> Option<SegmentHit> {
        // SAFETY: `dispatch` uses this type only with the proof that the CPU supports AVX2, and no other code can name
        // it.
        unsafe { intersect_segments(ray, segments, t_max) }
    }

    #[inline(always)]
    fn sobol_4d(indices: [u32; 2], seeds: [u32; 2]) -> [[f32; 4]; 2] {
        // SAFETY: `dispatch` uses this type only with the proof that the CPU supports AVX2, and no other code can name
        // it.
        unsafe { sobol_4d(indices, seeds) }
    }
}

/// Bit-reversed values of four bits.
const REVERSED_NIBBLE: [i8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];

#[inline]
#[target_feature(enable = "avx2")]
fn load(values: &[f32; LANES]) -> __m256 {
    // SAFETY: eight floats are read from an array of eight.
    unsafe { _mm256_loadu_ps(values.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(values: __m256) -> [f32; LANES] {
    let mut array = [0.0; LANES];
    // SAFETY: eight floats are written to an array of eight.
    unsafe { _mm256_storeu_ps(array.as_mut_ptr(), values) };
    array
}

#[inline]
#[target_feature(enable = "avx2")]
fn intersect_boxes(ray: &SlabRay, boxes: &BoxPacket, t_max: f32, enter: &mut [f32; LANES]) -> u32 {
    let mut entry = _mm256_setzero_ps();
    let mut exit = _mm256_set1_ps(t_max);
    for axis in 0..3 {
        let (near, far) = boxes.slabs(ray, axis);
        let origin = _mm256_set1_ps(ray.origin[axis]);
        let minus_inverse = _mm256_set1_ps(ray.minus_inverse[axis]);
        // Both instructions return their second operand when the first is NaN.
        entry = _mm256_max_ps(_mm256_mul_ps(_mm256_sub_ps(origin, load(near)), minus_inverse), entry);
        exit = _mm256_min_ps(_mm256_mul_ps(_mm256_sub_ps(origin, load(far)), minus_inverse), exit);
    }
    *enter = store(entry);
    let widened = _mm256_mul_ps(exit, _mm256_set1_ps(SLAB_EXIT_SCALE));
    _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(entry, widened)) as u32
}

#[inline]
#[target_feature(enable = "avx2")]
fn intersect_triangles(ray: &ShearedRay, triangles: &TrianglePacket, t_max: f32) -> Option<TriangleHit> {
    // Translate the corners to the ray's origin
    let corner =
        |v: usize, axis: usize| _mm256_sub_ps(load(&triangles.corners[v][axis]), _mm256_set1_ps(ray.origin[axis]));
    let [kx, ky, kz] = ray.axes;
    let depth = [corner(0, kz), corner(1, kz), corner(2, kz)];
    // Shear them, so that the ray points along +Z
    let shear =
        |v: usize, axis: usize, by: f32| _mm256_sub_ps(corner(v, axis), _mm256_mul_ps(_mm256_set1_ps(by), depth[v]));
    let x = [shear(0, kx, ray.shear[0]), shear(1, kx, ray.shear[0]), shear(2, kx, ray.shear[0])];
    let y = [shear(0, ky, ray.shear[1]), shear(1, ky, ray.shear[1]), shear(2, ky, ray.shear[1])];
    // Evaluate the edge functions, in f64 where one is 0
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
    // Test whether all edge functions have one sign; unused lanes are NaN and pass neither comparison
    let smallest = _mm256_min_ps(_mm256_min_ps(e[0], e[1]), e[2]);
    let largest = _mm256_max_ps(_mm256_max_ps(e[0], e[1]), e[2]);
    let inside = _mm256_or_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(smallest, zero), _mm256_cmp_ps::<_CMP_LE_OQ>(largest, zero));
    if _mm256_movemask_ps(inside) == 0 {
        return None;
    }
    // Interpolate the hit distance
    let z = depth.map(|d| _mm256_mul_ps(_mm256_set1_ps(ray.shear[2]), d));
    let determinant = _mm256_add_ps(_mm256_add_ps(e[0], e[1]), e[2]);
    let weighted =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(e[0], z[0]), _mm256_mul_ps(e[1], z[1])), _mm256_mul_ps(e[2], z[2]));
    // A determinant of 0 gives infinity or NaN, which fail the comparisons.
    let t = _mm256_div_ps(weighted, determinant);
    let in_range =
        _mm256_and_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(t, zero), _mm256_cmp_ps::<_CMP_LT_OQ>(t, _mm256_set1_ps(t_max)));
    let hits = _mm256_movemask_ps(_mm256_and_ps(inside, in_range)) as u32;
    if hits == 0 {
        return None;
    }
    let t = store(t);
    let nearest = nearest_lane(&t, hits);
    Some(triangles.hit(nearest, t[nearest], e.map(|e| store(e)[nearest])))
}

/// Returns the lane with the smallest distance among those whose bit is set in `hits`, which is not 0. The lowest of
/// equal ones.
#[inline(always)]
fn nearest_lane(t: &[f32; LANES], mut hits: u32) -> usize {
    let mut nearest = hits.trailing_zeros() as usize % LANES;
    hits &= hits - 1;
    while hits != 0 {
        let other = hits.trailing_zeros() as usize % LANES;
        hits &= hits - 1;
        if t[other] < t[nearest] {
            nearest = other;
        }
    }
    nearest
}

#[inline]
#[target_feature(enable = "avx2")]
fn intersect_segments(ray: &RibbonRay, segments: &SegmentPacket, t_max: f32) -> Option<SegmentHit> {
    // Transform both ends to the frame of the ray
    let offset = |end: usize, k: usize| _mm256_sub_ps(load(&segments.ends[end][k]), _mm256_set1_ps(ray.origin[k]));
    let offsets = [[offset(0, 0), offset(0, 1), offset(0, 2)], [offset(1, 0), offset(1, 1), offset(1, 2)]];
    let end = |end: usize, axis: usize| {
        let [x, y, z] = ray.axes[axis].map(|a| _mm256_set1_ps(a));
        let o = &offsets[end];
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(o[0], x), _mm256_mul_ps(o[1], y)), _mm256_mul_ps(o[2], z))
    };
    let ([x0, y0], [x1, y1]) = ([end(0, 0), end(0, 1)], [end(1, 0), end(1, 1)]);
    // Find the point of the axis that is nearest to the ray
    let (ex, ey) = (_mm256_sub_ps(x1, x0), _mm256_sub_ps(y1, y0));
    let length2 = _mm256_add_ps(_mm256_mul_ps(ex, ex), _mm256_mul_ps(ey, ey));
    let dot = _mm256_add_ps(_mm256_mul_ps(x0, ex), _mm256_mul_ps(y0, ey));
    let minus_dot = _mm256_xor_ps(dot, _mm256_set1_ps(-0.0));
    // Both instructions return their second operand when the first is NaN.
    let s = _mm256_max_ps(_mm256_div_ps(minus_dot, length2), _mm256_setzero_ps());
    let s = _mm256_min_ps(s, _mm256_set1_ps(1.0));
    let (cx, cy) = (_mm256_add_ps(x0, _mm256_mul_ps(s, ex)), _mm256_add_ps(y0, _mm256_mul_ps(s, ey)));
    // Compare its distance with the radius; unused lanes are NaN and fail
    let r0 = load(&segments.ends[0][3]);
    let radius = _mm256_add_ps(r0, _mm256_mul_ps(s, _mm256_sub_ps(load(&segments.ends[1][3]), r0)));
    let distance2 = _mm256_add_ps(_mm256_mul_ps(cx, cx), _mm256_mul_ps(cy, cy));
    let is_near = _mm256_cmp_ps::<_CMP_LE_OQ>(distance2, _mm256_mul_ps(radius, radius));
    if _mm256_movemask_ps(is_near) == 0 {
        return None;
    }
    // Compute the hit distance
    let (z0, z1) = (end(0, 2), end(1, 2));
    let t = _mm256_add_ps(z0, _mm256_mul_ps(s, _mm256_sub_ps(z1, z0)));
    let in_range = _mm256_and_ps(
        _mm256_cmp_ps::<_CMP_GT_OQ>(t, _mm256_setzero_ps()),
        _mm256_cmp_ps::<_CMP_LT_OQ>(t, _mm256_set1_ps(t_max)),
    );
    let hits = _mm256_movemask_ps(_mm256_and_ps(is_near, in_range)) as u32;
    if hits == 0 {
        return None;
    }
    let t = store(t);
    let lane = nearest_lane(&t, hits);
    let at = |values: __m256| store(values)[lane];
    let nearest = NearestSegment {
        lane,
        t: t[lane],
        s: at(s),
        along: [at(ex), at(ey)],
        to_axis: [at(cx), at(cy)],
        radius: at(radius),
    };
    Some(segments.hit(&nearest))
}

#[inline]
#[target_feature(enable = "avx2")]
fn sobol_4d(indices: [u32; 2], seeds: [u32; 2]) -> [[f32; 4]; 2] {
    let splat = |n: u32| _mm256_set1_epi32(n as i32);
    let times = |n, factor: u32| _mm256_mullo_epi32(n, splat(factor));
    // Shuffle the indices and look up the unscrambled points
    let [low, high] = [0, 1].map(|k: usize| {
        let shuffled = sobol::scramble(indices[k].reverse_bits(), sobol::hash(seeds[k] ^ sobol::SHUFFLE)) >> 16;
        let part = |i: usize| four(&sobol::NIBBLES[i][(shuffled >> (4 * i)) as usize % 16]);
        _mm_xor_si128(_mm_xor_si128(part(0), part(1)), _mm_xor_si128(part(2), part(3)))
    });
    let point = _mm256_set_m128i(high, low);
    // Hash the seeds of the eight dimensions
    let [low, high] = seeds.map(|seed| _mm_set1_epi32(seed.wrapping_mul(sobol::SEED_FACTOR) as i32));
    let dimensions = _mm256_broadcastsi128_si256(four(&sobol::DIMENSION_SEEDS));
    let mut by = _mm256_xor_si256(_mm256_xor_si256(_mm256_set_m128i(high, low), dimensions), splat(sobol::HASH_START));
    by = times(_mm256_xor_si256(by, _mm256_srli_epi32::<16>(by)), sobol::HASH_FACTORS[0]);
    by = times(_mm256_xor_si256(by, _mm256_srli_epi32::<15>(by)), sobol::HASH_FACTORS[1]);
    by = _mm256_xor_si256(by, _mm256_srli_epi32::<16>(by));
    // Owen-scramble the points
    let mut n = _mm256_xor_si256(point, times(point, sobol::SCRAMBLE_FACTORS[0]));
    n = _mm256_mullo_epi32(_mm256_add_epi32(n, by), _mm256_or_si256(_mm256_srli_epi32::<16>(by), splat(1)));
    n = _mm256_xor_si256(n, times(n, sobol::SCRAMBLE_FACTORS[1]));
    n = _mm256_xor_si256(n, times(n, sobol::SCRAMBLE_FACTORS[2]));
    // Use the highest 23 bits as the mantissa of a number in [1, 2)
    let mantissa = _mm256_srli_epi32::<9>(reverse_bits(n));
    let one_to_two = _mm256_castsi256_ps(_mm256_or_si256(mantissa, splat(1.0_f32.to_bits())));
    let [a, b, c, d, e, f, g, h] = store(_mm256_sub_ps(one_to_two, _mm256_set1_ps(1.0)));
    [[a, b, c, d], [e, f, g, h]]
}

#[inline]
#[target_feature(enable = "avx2")]
fn four(values: &[u32; 4]) -> __m128i {
    let [a, b, c, d] = values.map(|value| value as i32);
    _mm_setr_epi32(a, b, c, d)
}

#[inline]
#[target_feature(enable = "avx2")]
fn reverse_bits(n: __m256i) -> __m256i {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n_, o, p] = REVERSED_NIBBLE;
    let reversed = _mm256_broadcastsi128_si256(_mm_setr_epi8(a, b, c, d, e, f, g, h, i, j, k, l, m, n_, o, p));
    let low_half = _mm256_set1_epi8(15);
    let low = _mm256_shuffle_epi8(reversed, _mm256_and_si256(n, low_half));
    let high = _mm256_shuffle_epi8(reversed, _mm256_and_si256(_mm256_srli_epi32::<4>(n), low_half));
    let bytes = _mm256_or_si256(_mm256_slli_epi32::<4>(low), high);
    let order = _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
    _mm256_shuffle_epi8(bytes, _mm256_broadcastsi128_si256(order))
}
