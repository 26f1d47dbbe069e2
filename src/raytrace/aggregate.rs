//! All that a ray can hit: small things in one tree of world triangles, large ones as instances in a tree above theirs.
//!
//! An instance costs a ray a transform and a fresh start, dear for the dozen triangles of a wall. So meshes with few
//! triangles are copied into one tree, where they stand; moving one of them costs building that tree anew, which is
//! quick because it is small.

use super::blas::Blas;
use super::bvh::{self, Slabs, TraversalStack, WideBvh};
use super::geometry::{Instance, MeshGeometry, SurfaceInteraction};
use super::simd::{self, KernelTask, Kernels};
use super::triangle::TriangleHit;
use crate::math::Ray;
use glam::Affine3A;
use std::sync::Arc;

/// Meshes with up to this many triangles are copied into the tree of small things.
const SMALL: usize = 4096;
/// Triangles that are copied in all: thousands of balls stay instances of one mesh.
const COPIED: usize = 1 << 18;

/// Instances and the trees over them.
#[derive(Debug, Default)]
pub struct Aggregate {
    instances: Vec<Instance>,
    merged: Arc<MergedBlas>,
    /// Over the boxes of the large instances.
    bvh: WideBvh,
    /// Instance of each box in `bvh`.
    large: Vec<u32>,
}

/// The triangles of small instances in one tree, in world space.
#[derive(Debug, Default)]
pub struct MergedBlas {
    /// Which instances they are, and where they stand.
    sources: Vec<Source>,
    blas: Blas,
    /// Instance and triangle of each triangle in `tree`.
    triangles: Vec<(u32, u32)>,
}

#[derive(Debug)]
struct Source {
    instance: u32,
    geometry: Arc<MeshGeometry>,
    world_from_object: Affine3A,
}

impl Source {
    fn new(index: u32, instance: &Instance) -> Self {
        let (geometry, world_from_object) = (instance.geometry.clone(), *instance.world_from_object());
        Source { instance: index, geometry, world_from_object }
    }

    fn is_same(&self, other: &Source) -> bool {
        self.instance == other.instance
            && Arc::ptr_eq(&self.geometry, &other.geometry)
            && self.world_from_object == other.world_from_object
    }
}

impl MergedBlas {
    fn new(instances: &[Instance], sources: Vec<Source>) -> Self {
        let of = |source: &Source| {
            let index = source.instance;
            (0..source.geometry.mesh().triangles.len() as u32).map(move |triangle| (index, triangle))
        };
        let triangles: Vec<(u32, u32)> = sources.iter().flat_map(of).collect();
        let blas = Blas::new(triangles.len(), |i| {
            let (instance, triangle) = triangles[i];
            instances[instance as usize].world_corners(triangle as usize)
        });
        MergedBlas { sources, blas, triangles }
    }

    fn is_of(&self, sources: &[Source]) -> bool {
        self.sources.len() == sources.len() && self.sources.iter().zip(sources).all(|(a, b)| a.is_same(b))
    }
}

/// A hit of some instance.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index of the instance.
    pub instance: u32,
    /// Where on its mesh.
    pub triangle: TriangleHit,
}

impl Aggregate {
    /// Builds the trees. Instances without triangles are never hit.
    #[cfg(test)]
    pub fn new(instances: Vec<Instance>) -> Self {
        Self::with_merged(instances, None)
    }

    /// The same; the tree of small things is `kept`, where it is what it would become.
    pub fn with_merged(instances: Vec<Instance>, kept: Option<Arc<MergedBlas>>) -> Self {
        let (mut sources, mut large, mut boxes, mut copied) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for (index, instance) in instances.iter().enumerate() {
            let count = instance.geometry.mesh().triangles.len();
            if count <= SMALL && copied + count <= COPIED {
                copied += count;
                sources.push(Source::new(index as u32, instance));
            } else if let Some(bounds) = instance.world_bounds() {
                large.push(index as u32);
                boxes.push(bounds);
            }
        }
        let kept = kept.filter(|small| small.is_of(&sources));
        let merged = kept.unwrap_or_else(|| Arc::new(MergedBlas::new(&instances, sources)));
        let bvh = bvh::build(&boxes, 1);
        Aggregate { instances, merged, bvh, large }
    }

    /// The tree of small things.
    pub fn merged(&self) -> &Arc<MergedBlas> {
        &self.merged
    }

    /// The instances, in the order that [`Hit::instance`] counts.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The closest hit.
    pub fn intersect(&self, ray: &Ray, stack: &mut TraversalStack) -> Option<Hit> {
        simd::dispatch(Intersect { aggregate: self, ray, stack })
    }

    /// Whether anything lies on the ray before its end.
    pub fn occluded(&self, ray: &Ray, stack: &mut TraversalStack) -> bool {
        simd::dispatch(Occluded { aggregate: self, ray, stack })
    }

    /// The surface at a hit.
    pub fn surface(&self, hit: &Hit) -> SurfaceInteraction {
        self.instances[hit.instance as usize].surface(&hit.triangle)
    }
}

/// See [`Aggregate::closest`].
struct Intersect<'a> {
    aggregate: &'a Aggregate,
    ray: &'a Ray,
    stack: &'a mut TraversalStack,
}

impl KernelTask for Intersect<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Hit> {
        let Intersect { aggregate, ray, stack } = self;
        let slabs = Slabs::new(ray.origin, ray.direction);
        let mut best = aggregate.merged.blas.intersect::<K>(ray, &slabs, stack).map(|hit| {
            let (instance, triangle) = aggregate.merged.triangles[hit.triangle as usize];
            Hit { instance, triangle: TriangleHit { triangle, ..hit } }
        });
        let t_max = best.map_or(ray.t_max, |hit| hit.triangle.t);
        aggregate.bvh.traverse_front_to_back::<K>(
            &slabs,
            t_max,
            stack,
            #[inline(always)]
            |leaf, mut t_max, stack| {
                for &index in aggregate.bvh.leaf(leaf) {
                    let instance = aggregate.large[index as usize];
                    let placed = &aggregate.instances[instance as usize];
                    let local = placed.to_object(&Ray { t_max, ..*ray });
                    let slabs = Slabs::new(local.origin, local.direction);
                    if let Some(triangle) = placed.geometry.blas.intersect::<K>(&local, &slabs, stack) {
                        t_max = triangle.t;
                        best = Some(Hit { instance, triangle });
                    }
                }
                t_max
            },
        );
        best
    }
}

/// See [`Aggregate::blocked`].
struct Occluded<'a> {
    aggregate: &'a Aggregate,
    ray: &'a Ray,
    stack: &'a mut TraversalStack,
}

impl KernelTask for Occluded<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<K: Kernels>(self) -> bool {
        let Occluded { aggregate, ray, stack } = self;
        let slabs = Slabs::new(ray.origin, ray.direction);
        if aggregate.merged.blas.occluded::<K>(ray, &slabs, stack) {
            return true;
        }
        aggregate.bvh.traverse_any::<K>(
            &slabs,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, stack| {
                aggregate.bvh.leaf(leaf).iter().any(|&index| {
                    let placed = &aggregate.instances[aggregate.large[index as usize] as usize];
                    let local = placed.to_object(ray);
                    let slabs = Slabs::new(local.origin, local.direction);
                    placed.geometry.blas.occluded::<K>(&local, &slabs, stack)
                })
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::raytrace::geometry::MeshGeometry;
    use crate::raytrace::simd::Scalar;
    use crate::scene::{Mesh, Shape, tessellate};
    use glam::{Quat, Vec2, Vec3, Vec3Swizzles};

    /// Deterministic numbers in 0..1.
    fn numbers(seed: u32) -> impl FnMut() -> f32 {
        let mut i = 0;
        move || {
            i += 1;
            sobol_burley::sample(i % 65536, i / 65536, seed)
        }
    }

    fn soup(triangles: usize) -> Mesh {
        let mut next = numbers(3);
        let mut mesh = Mesh::default();
        for i in 0..triangles as u32 {
            let centre = Vec3::new(next(), next(), next()) * 4.0 - 2.0;
            for _ in 0..3 {
                mesh.positions.push(centre + (Vec3::new(next(), next(), next()) - 0.5) * 1.5);
            }
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        mesh.with_single_part("soup")
    }

    fn some_rays(count: u32) -> Vec<Ray> {
        let mut next = numbers(11);
        let ray = |_| {
            let origin = Vec3::new(next(), next(), next()) * 6.0 - 3.0;
            let mut direction = warp::uniform_sphere(Vec2::new(next(), next()));
            // Some along the axes, where slabs meet zero and infinity.
            if next() < 0.1 {
                direction = [Vec3::X, Vec3::NEG_Y, Vec3::Z][(next() * 3.0) as usize % 3];
            }
            Ray { origin, direction, t_max: if next() < 0.5 { f32::INFINITY } else { next() * 3.0 } }
        };
        (0..count).map(ray).collect()
    }

    fn instance(mesh: Mesh, transform: Affine3A, object: u32) -> Instance {
        Instance::new(Arc::new(MeshGeometry::new(Arc::new(mesh))), transform, object, vec![0]).unwrap()
    }

    /// Every triangle of every instance, with the same triangle test in the same space.
    fn brute_force(instances: &[Instance], ray: &Ray) -> Option<(u32, TriangleHit)> {
        use crate::raytrace::triangle::{Packet, ShearedRay};
        let mut best: Option<(u32, TriangleHit)> = None;
        for (index, instance) in instances.iter().enumerate() {
            let mesh = instance.geometry.mesh();
            let small = mesh.triangles.len() <= SMALL;
            let local = if small { *ray } else { instance.to_object(ray) };
            let sheared = ShearedRay::new(local.origin, local.direction);
            for t in 0..mesh.triangles.len() {
                let end = best.as_ref().map_or(ray.t_max, |b| b.1.t);
                let corners = if small { instance.world_corners(t) } else { mesh.corners(t) };
                if let Some(hit) = Packet::new([(t as u32, corners)]).intersect(&sheared, end) {
                    best = Some((index as u32, hit));
                }
            }
        }
        best
    }

    #[test]
    fn the_tree_finds_what_testing_every_triangle_finds() {
        let turned = Affine3A::from_scale_rotation_translation(
            Vec3::new(0.5, 2.0, 1.0),
            Quat::from_rotation_y(0.7),
            Vec3::new(1.0, 0.2, -0.5),
        );
        let sphere = tessellate(&Shape::Box { size_m: Vec3::ONE }).unwrap();
        let aggregate = Aggregate::new(vec![
            instance(soup(SMALL + 1), turned * Affine3A::from_scale(Vec3::splat(0.9)), 0),
            instance(soup(300), turned, 1),
            instance(sphere, Affine3A::from_translation(Vec3::Y), 2),
        ]);
        let mut stack = TraversalStack::default();
        let mut hits = 0;
        for (i, ray) in some_rays(6000).iter().enumerate() {
            let ours = aggregate.intersect(ray, &mut stack);
            let truth = brute_force(aggregate.instances(), ray);
            // Two triangles at the very same distance may be named in either order; the distance is the same to the bit.
            assert_eq!(ours.map(|h| h.triangle.t), truth.map(|(_, h)| h.t), "ray {i}: {ray:?}");
            assert_eq!(aggregate.occluded(ray, &mut stack), truth.is_some(), "ray {i}: {ray:?}");
            // The twin without wide vectors gives the same bits.
            let plain = Intersect { aggregate: &aggregate, ray, stack: &mut stack }.run::<Scalar>();
            assert_eq!(plain.map(|h| h.triangle), ours.map(|h| h.triangle), "ray {i}: {ray:?}");
            let plain = Occluded { aggregate: &aggregate, ray, stack: &mut stack }.run::<Scalar>();
            assert_eq!(plain, truth.is_some(), "ray {i}: {ray:?}");
            hits += usize::from(truth.is_some());
        }
        assert!(hits > 1000, "only {hits} rays hit anything: the test says little");
    }

    #[test]
    fn of_ten_thousand_balls_few_are_copied_and_all_are_hit() {
        let ball = Arc::new(MeshGeometry::new(Arc::new(soup(100))));
        let place = |i: u32| Affine3A::from_translation(Vec3::new(10.0 * i as f32, 0.0, 0.0));
        let instances: Vec<Instance> =
            (0..10_000).map(|i| Instance::new(ball.clone(), place(i), i, vec![0]).unwrap()).collect();
        let aggregate = Aggregate::new(instances);
        assert!(aggregate.merged.triangles.len() <= COPIED && aggregate.large.len() > 7_000);
        let mut stack = TraversalStack::default();
        for i in (0..10_000).step_by(333) {
            let (low, high) = aggregate.instances()[i].world_bounds().unwrap();
            let count = (0..64).filter(|&k| {
                let aside = Vec3::new(((k % 8) as f32 + 0.5) / 8.0, ((k / 8) as f32 + 0.5) / 8.0, 0.0);
                let origin = low + (high - low) * aside - Vec3::Z;
                let ray = Ray { origin, direction: Vec3::Z, t_max: f32::INFINITY };
                aggregate.intersect(&ray, &mut stack).is_some_and(|hit| hit.instance as usize == i)
            });
            assert!(count.count() > 10, "ball {i}");
        }
    }

    #[test]
    fn an_empty_studio_is_missed() {
        let aggregate = Aggregate::new(vec![instance(Mesh::default().with_single_part("none"), Affine3A::IDENTITY, 0)]);
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: f32::INFINITY };
        assert!(aggregate.intersect(&ray, &mut TraversalStack::default()).is_none());
    }

    #[test]
    fn rays_that_leave_a_floor_through_the_origin_of_the_tracer_do_not_meet_it_again() {
        // A camera or a meter that lies on a floor: every coordinate across it is 0, and so was its error bound. Rays met
        // the floor they left, and a white room lost a fourteenth of its light.
        let floor = tessellate(&Shape::Plane { width_m: 4.0, depth_m: 4.0 }).unwrap();
        let aggregate = Aggregate::new(vec![instance(floor, Affine3A::IDENTITY, 0)]);
        let mut stack = TraversalStack::default();
        let mut next = numbers(7);
        for _ in 0..100_000 {
            let origin = Vec3::new(next() * 4.0 - 2.0, 2.0 * next(), next() * 4.0 - 2.0);
            let direction = -warp::cosine_hemisphere(Vec2::new(next(), next())).xzy();
            let ray = Ray { origin, direction, t_max: f32::INFINITY };
            let Some(hit) = aggregate.intersect(&ray, &mut stack) else { continue };
            let surface = aggregate.surface(&hit);
            let away = warp::cosine_hemisphere(Vec2::new(next(), next())).xzy();
            let away = Ray { origin: surface.spawn_origin(away), direction: away, t_max: f32::INFINITY };
            assert!(aggregate.intersect(&away, &mut stack).is_none(), "left the floor and met it: {ray:?} {away:?}");
        }
    }

    #[test]
    fn a_million_rays_never_hit_the_triangle_they_leave_nor_leak_from_a_ball() {
        // Also far from the origin, where the camera-relative space has small numbers only near the camera.
        let ball = tessellate(&Shape::Sphere { radius_m: 1.0 }).unwrap();
        for far in [0.0, 1e3, 1e5] {
            let place = Affine3A::from_translation(Vec3::new(far, -far, far));
            let aggregate = Aggregate::new(vec![instance(ball.clone(), place, 0)]);
            let mut stack = TraversalStack::default();
            let mut next = numbers(5);
            for _ in 0..340_000 {
                let origin = Vec3::new(far, -far, far);
                let out = warp::uniform_sphere(Vec2::new(next(), next()));
                let inside = Ray { origin, direction: out, t_max: f32::INFINITY };
                let hit = aggregate.intersect(&inside, &mut stack).expect("a ray from the centre leaked");
                let surface = aggregate.surface(&hit);
                // Outwards again: a convex ball is never met from its own surface.
                let local = warp::cosine_hemisphere(Vec2::new(next(), next()));
                let (t, b) = crate::math::orthonormal_basis(surface.geometric_normal);
                let direction = t * local.x + b * local.y + surface.geometric_normal * local.z.max(1e-3);
                let away = Ray { origin: surface.spawn_origin(direction), direction, t_max: f32::INFINITY };
                if let Some(again) = aggregate.intersect(&away, &mut stack) {
                    // The tessellated ball is convex only up to rounding: grazing rays may touch a neighbour.
                    assert_ne!(again.triangle.triangle, hit.triangle.triangle, "left and hit the same triangle");
                }
                // Inwards: the other side must be found.
                let inwards =
                    Ray { origin: surface.spawn_origin(-direction), direction: -direction, t_max: f32::INFINITY };
                assert!(aggregate.intersect(&inwards, &mut stack).is_some(), "a ray leaked at {far}");
            }
        }
    }
}
