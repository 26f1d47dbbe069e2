//! Ray against triangles, eight at a time, watertight along shared edges. The arithmetic is in [`super::simd`].
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle IntersectionMethod": the ray is sheared onto an axis; edge functions
//! are then evaluated alike for both neighbours of an edge, so no ray slips between them. Edge functions that come out
//! exactly 0 are computed again in f64.

use super::simd::WIDTH;
use glam::Vec3;

/// Up to eight triangles, corners by vertex, axis and lane. Unused lanes hold NaN, which no comparison lets pass.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Packet {
    pub(super) corners: [[[f32; WIDTH]; 3]; 3],
    /// Triangle numbers in the mesh.
    triangles: [u32; WIDTH],
}

/// A ray made ready for the test: permuted so that its largest direction component is Z, and sheared onto it.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    pub(super) origin: [f32; 3],
    pub(super) axes: [usize; 3],
    pub(super) shear: [f32; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance in multiples of the ray's direction.
    pub t: f32,
    /// Triangle number in the mesh.
    pub triangle: u32,
    /// Barycentric weights of the second and third corner.
    pub barycentric: [f32; 2],
}

impl ShearedRay {
    /// Prepares a ray. The direction must not be zero.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let abs = direction.abs();
        let z = if abs.x > abs.y && abs.x > abs.z {
            0
        } else if abs.y > abs.z {
            1
        } else {
            2
        };
        let direction = direction.to_array();
        // Right-handed about the ray, whichever way it runs along its axis.
        let (x, y) = if direction[z] < 0.0 { (BEFORE[z], AFTER[z]) } else { (AFTER[z], BEFORE[z]) };
        let inverse = 1.0 / direction[z];
        let shear = [direction[x] * inverse, direction[y] * inverse, inverse];
        ShearedRay { origin: origin.to_array(), axes: [x, y, z], shear }
    }
}

/// The axis after each, and the one before.
const AFTER: [usize; 3] = [1, 2, 0];
const BEFORE: [usize; 3] = [2, 0, 1];

impl Packet {
    /// Packs up to eight triangles, given by their number and corners.
    pub fn new(triangles: impl IntoIterator<Item = (u32, [Vec3; 3])>) -> Self {
        let mut packet = Packet { corners: [[[f32::NAN; WIDTH]; 3]; 3], triangles: [u32::MAX; WIDTH] };
        for (lane, (number, corners)) in triangles.into_iter().take(WIDTH).enumerate() {
            packet.triangles[lane] = number;
            for (vertex, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    packet.corners[vertex][axis][lane] = corner[axis];
                }
            }
        }
        packet
    }

    /// What is known of a hit in a lane, from its distance and edge functions.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize, t: f32, edges: [f32; 3]) -> TriangleHit {
        let inverse = 1.0 / (edges[0] + edges[1] + edges[2]);
        TriangleHit { t, triangle: self.triangles[lane], barycentric: [edges[1] * inverse, edges[2] * inverse] }
    }
}

/// Edge functions without rounding of the products (24-bit factors fit a 53-bit product), in the lanes where one came
/// out 0.
#[cold]
pub(super) fn edges_in_f64(e: &mut [[f32; WIDTH]; 3], x: &[[f32; WIDTH]; 3], y: &[[f32; WIDTH]; 3]) {
    for i in 0..WIDTH {
        if e.iter().all(|edge| edge[i] != 0.0) {
            continue;
        }
        for (k, edge) in e.iter_mut().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let exact = f64::from(x[b][i]) * f64::from(y[a][i]) - f64::from(y[b][i]) * f64::from(x[a][i]);
            edge[i] = exact as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::simd::{KernelTask, Kernels, Scalar, dispatch};

    /// The test with the kernels of this processor.
    struct Test<'a>(&'a Packet, &'a ShearedRay, f32);

    impl KernelTask for Test<'_> {
        type Output = Option<TriangleHit>;

        #[inline(always)]
        fn run<K: Kernels>(self) -> Self::Output {
            K::triangles(self.0, self.1, self.2)
        }
    }

    impl Packet {
        pub(in crate::raytrace) fn intersect(&self, ray: &ShearedRay, t_max: f32) -> Option<TriangleHit> {
            let hit = dispatch(Test(self, ray, t_max));
            assert_eq!(hit, Scalar::triangles(self, ray, t_max), "the twins differ");
            hit
        }
    }

    fn unit_triangle() -> Packet {
        Packet::new([(7, [Vec3::ZERO, Vec3::X, Vec3::Y])])
    }

    #[test]
    fn hits_carry_distance_and_barycentrics() {
        let ray = ShearedRay::new(Vec3::new(0.2, 0.3, 2.0), Vec3::new(0.0, 0.0, -2.0));
        let hit = unit_triangle().intersect(&ray, f32::INFINITY).unwrap();
        assert_eq!((hit.t, hit.triangle), (1.0, 7));
        assert!((hit.barycentric[0] - 0.2).abs() < 1e-6 && (hit.barycentric[1] - 0.3).abs() < 1e-6);
        assert!(unit_triangle().intersect(&ray, 1.0).is_none(), "the end of the ray is excluded");
    }

    #[test]
    fn both_sides_are_hit_and_behind_is_not() {
        for z in [1.0, -1.0] {
            let towards = ShearedRay::new(Vec3::new(0.2, 0.2, z), Vec3::new(0.0, 0.0, -z));
            let away = ShearedRay::new(Vec3::new(0.2, 0.2, z), Vec3::new(0.0, 0.0, z));
            assert!(unit_triangle().intersect(&towards, f32::INFINITY).is_some());
            assert!(unit_triangle().intersect(&away, f32::INFINITY).is_none());
        }
    }

    #[test]
    fn triangles_of_no_area_are_never_hit() {
        let ray = ShearedRay::new(Vec3::new(0.5, 0.0, 1.0), Vec3::NEG_Z);
        for corners in [[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], [Vec3::X * 0.5; 3], [Vec3::ZERO, Vec3::ZERO, Vec3::X]] {
            assert!(Packet::new([(0, corners)]).intersect(&ray, f32::INFINITY).is_none());
        }
    }

    #[test]
    fn no_ray_slips_between_neighbours() {
        // A fan around a vertex that is no round number; rays aimed at its edges and at the vertex itself.
        let centre = Vec3::new(0.1, 0.2, 0.3);
        let rim = |i: i32| centre + Vec3::new((i as f32 * 0.9).cos(), (i as f32 * 0.9).sin(), 0.05 * (i % 2) as f32);
        let corners: Vec<[Vec3; 3]> =
            (0..7).map(|i| [centre, rim(i), if i == 6 { rim(0) } else { rim(i + 1) }]).collect();
        let packets: Vec<Packet> =
            corners.chunks(WIDTH).map(|c| Packet::new(c.iter().enumerate().map(|(i, c)| (i as u32, *c)))).collect();
        for k in 0..20_000 {
            let edge = &corners[k % 7];
            let along = (k / 7) as f32 / (20_000.0 / 7.0) * 0.9;
            let target = edge[0] + (edge[1] - edge[0]) * along;
            let origin = Vec3::new((k as f32).sin() * 2.0, (k as f32 * 1.3).cos() * 2.0, 5.0);
            let ray = ShearedRay::new(origin, target - origin);
            assert!(packets.iter().any(|p| p.intersect(&ray, f32::INFINITY).is_some()), "ray {k} slipped through");
        }
    }
}
