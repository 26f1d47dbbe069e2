//! The kernels against their geometry, and AVX2 against scalar code.

use super::*;
use glam::Vec3;

/// The triangle test with the kernels of this CPU.
struct TriangleTest<'a>(&'a TrianglePacket, &'a ShearedRay, f32);

impl KernelTask for TriangleTest<'_> {
    type Output = Option<TriangleHit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Self::Output {
        K::intersect_triangles(self.1, self.0, self.2)
    }
}

impl TrianglePacket {
    pub(in crate::raytrace) fn intersect(&self, ray: &ShearedRay, t_max: f32) -> Option<TriangleHit> {
        let hit = dispatch(TriangleTest(self, ray, t_max));
        assert_eq!(hit, Scalar::intersect_triangles(ray, self, t_max), "AVX2 and scalar kernels differ");
        hit
    }
}

fn unit_triangle() -> TrianglePacket {
    TrianglePacket::new([(7, [Vec3::ZERO, Vec3::X, Vec3::Y])])
}

#[test]
fn hits_have_distance_and_barycentric_coordinates() {
    let ray = ShearedRay::new(Vec3::new(0.2, 0.3, 2.0), Vec3::new(0.0, 0.0, -2.0));
    let hit = unit_triangle().intersect(&ray, f32::INFINITY).unwrap();
    assert_eq!((hit.t, hit.triangle), (1.0, 7));
    assert!((hit.barycentric[0] - 0.2).abs() < 1e-6 && (hit.barycentric[1] - 0.3).abs() < 1e-6);
    assert!(unit_triangle().intersect(&ray, 1.0).is_none(), "t_max is excluded");
}

#[test]
fn triangles_are_hit_from_both_sides_and_not_behind_the_origin() {
    for z in [1.0, -1.0] {
        let towards = ShearedRay::new(Vec3::new(0.2, 0.2, z), Vec3::new(0.0, 0.0, -z));
        let away = ShearedRay::new(Vec3::new(0.2, 0.2, z), Vec3::new(0.0, 0.0, z));
        assert!(unit_triangle().intersect(&towards, f32::INFINITY).is_some());
        assert!(unit_triangle().intersect(&away, f32::INFINITY).is_none());
    }
}

#[test]
fn degenerate_triangles_are_never_hit() {
    let ray = ShearedRay::new(Vec3::new(0.5, 0.0, 1.0), Vec3::NEG_Z);
    for corners in [[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], [Vec3::X * 0.5; 3], [Vec3::ZERO, Vec3::ZERO, Vec3::X]] {
        assert!(TrianglePacket::new([(0, corners)]).intersect(&ray, f32::INFINITY).is_none());
    }
}

#[test]
fn no_ray_passes_between_adjacent_triangles() {
    // A fan around a vertex with inexact coordinates; rays aimed at its edges and at the vertex itself.
    let centre = Vec3::new(0.1, 0.2, 0.3);
    let rim = |i: i32| centre + Vec3::new((i as f32 * 0.9).cos(), (i as f32 * 0.9).sin(), 0.05 * (i % 2) as f32);
    let corners: Vec<[Vec3; 3]> = (0..7).map(|i| [centre, rim(i), if i == 6 { rim(0) } else { rim(i + 1) }]).collect();
    let packets: Vec<TrianglePacket> =
        corners.chunks(LANES).map(|c| TrianglePacket::new(c.iter().enumerate().map(|(i, c)| (i as u32, *c)))).collect();
    for k in 0..20_000 {
        let edge = &corners[k % 7];
        let along = (k / 7) as f32 / (20_000.0 / 7.0) * 0.9;
        let target = edge[0] + (edge[1] - edge[0]) * along;
        let origin = Vec3::new((k as f32).sin() * 2.0, (k as f32 * 1.3).cos() * 2.0, 5.0);
        let ray = ShearedRay::new(origin, target - origin);
        assert!(packets.iter().any(|p| p.intersect(&ray, f32::INFINITY).is_some()), "ray {k} missed");
    }
}

/// The Sobol kernel of this CPU.
struct SobolPoint([u32; 2], [u32; 2]);

impl KernelTask for SobolPoint {
    type Output = [[f32; 4]; 2];

    #[inline(always)]
    fn run<K: Kernels>(self) -> Self::Output {
        K::sobol_4d(self.0, self.1)
    }
}

#[test]
fn the_sobol_kernel_returns_the_bits_of_the_reference_library() {
    for index in (0..256_u32).chain((256..65_536).step_by(97)) {
        for seed in [0, 1, 0xffff_ffff, index.wrapping_mul(0x9e37_79b9)] {
            let (indices, seeds) = ([index, index ^ 0x2b7], [seed, !seed]);
            assert_eq!(dispatch(SobolPoint(indices, seeds)), Scalar::sobol_4d(indices, seeds), "{index} {seed}");
        }
    }
}

/// The segment test with the kernels of this CPU.
struct SegmentTest<'a>(&'a SegmentPacket, &'a RibbonRay, f32);

impl KernelTask for SegmentTest<'_> {
    type Output = Option<SegmentHit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Self::Output {
        K::intersect_segments(self.1, self.0, self.2)
    }
}

impl SegmentPacket {
    pub(in crate::raytrace) fn intersect(&self, ray: &RibbonRay, t_max: f32) -> Option<SegmentHit> {
        let hit = dispatch(SegmentTest(self, ray, t_max));
        assert_eq!(hit, Scalar::intersect_segments(ray, self, t_max), "AVX2 and scalar kernels differ");
        hit
    }
}

#[test]
fn a_segment_is_hit_within_its_radius_and_at_its_round_ends() {
    let point = |x, radius_m| crate::scene::StrandPoint { position: Vec3::X * x, radius_m };
    let packet = SegmentPacket::new([(9, [point(0.0, 0.1), point(2.0, 0.3)])]);
    let hit = |x: f32, y: f32| {
        let ray = RibbonRay::new(Vec3::new(x, y, 4.0), Vec3::new(0.0, 0.0, -2.0));
        packet.intersect(&ray, 10.0)
    };
    let middle = hit(1.0, 0.1).unwrap();
    assert_eq!((middle.t, middle.segment, middle.s), (2.0, 9, 0.5));
    // N = Z and T = X: N x T = Y.
    assert!((middle.h - 0.5).abs() < 1e-6 && (hit(1.0, -0.1).unwrap().h + 0.5).abs() < 1e-6);
    assert!(hit(1.0, 0.21).is_none() && hit(2.0, 0.29).is_some() && hit(0.0, 0.11).is_none());
    assert!(hit(2.29, 0.0).is_some() && hit(2.31, 0.0).is_none() && hit(-0.09, 0.0).is_some());
    let behind = RibbonRay::new(Vec3::new(1.0, 0.0, -4.0), Vec3::NEG_Z);
    assert!(packet.intersect(&behind, 10.0).is_none());
    let along = RibbonRay::new(Vec3::new(-1.0, 0.05, 0.0), Vec3::X);
    assert_eq!(packet.intersect(&along, 10.0).map(|hit| (hit.s, hit.h)), Some((0.0, 0.0)));
}
