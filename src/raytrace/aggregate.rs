//! The acceleration structure over the whole studio, in two levels.
//!
//! Large meshes are instances: the top-level BVH (TLAS) over their boxes refers to a BLAS a mesh. An instance costs a
//! ray a transform and a new traversal, which is expensive for the dozen triangles of a wall. Small instances are
//! therefore merged into one BLAS in world space. When one of them moves, that BLAS is built anew, which is quick. The
//! strands of a mesh have a BLAS and a box in the TLAS of their own.

use super::blas::Blas;
use super::bvh::{self, TraversalStack, WideBvh};
use super::geometry::{Instance, MeshGeometry, SurfaceInteraction};
use super::simd::{self, KernelTask, Kernels, SlabRay, TriangleHit};
use super::strand_geometry::StrandHit;
use super::strand_surface;
use crate::math::Ray;
use glam::Affine3A;
use std::sync::Arc;

/// Largest number of triangles of a mesh whose instances are merged.
const MAX_MERGED_MESH: usize = 4096;
/// Largest number of triangles in the merged BLAS: thousands of spheres stay instances of one mesh.
const MAX_MERGED_TOTAL: usize = 1 << 18;

/// The instances of the studio and the acceleration structures over them.
#[derive(Debug, Default)]
pub struct Aggregate {
    instances: Vec<Instance>,
    merged: Arc<MergedBlas>,
    /// BVH over the bounding boxes of the other instances, and of the strands of all.
    tlas: WideBvh,
    /// The content of each box in `tlas`.
    tlas_entries: Vec<TlasEntry>,
}

/// The BLAS over the triangles of all small instances, in world space.
#[derive(Debug, Default)]
pub struct MergedBlas {
    /// The instances in it, in the order of their triangles.
    sources: Vec<MergedInstance>,
    blas: Blas,
    /// Instance and triangle of each triangle in `blas`.
    triangles: Vec<(u32, u32)>,
}

#[derive(Debug)]
struct MergedInstance {
    index: u32,
    geometry: Arc<MeshGeometry>,
    world_from_object: Affine3A,
}

impl MergedInstance {
    fn new(index: u32, instance: &Instance) -> Self {
        let (geometry, world_from_object) = (instance.geometry.clone(), *instance.world_from_object());
        MergedInstance { index, geometry, world_from_object }
    }

    fn is_same(&self, other: &MergedInstance) -> bool {
        self.index == other.index
            && Arc::ptr_eq(&self.geometry, &other.geometry)
            && self.world_from_object == other.world_from_object
    }
}

impl MergedBlas {
    fn new(instances: &[Instance], sources: Vec<MergedInstance>) -> Self {
        let triangles_of = |source: &MergedInstance| {
            let index = source.index;
            (0..source.geometry.mesh().triangles.len() as u32).map(move |triangle| (index, triangle))
        };
        let triangles: Vec<(u32, u32)> = sources.iter().flat_map(triangles_of).collect();
        let blas = Blas::new(triangles.len(), |i| {
            let (instance, triangle) = triangles[i];
            instances[instance as usize].world_corners(triangle as usize)
        });
        MergedBlas { sources, blas, triangles }
    }

    fn is_over(&self, sources: &[MergedInstance]) -> bool {
        self.sources.len() == sources.len() && self.sources.iter().zip(sources).all(|(a, b)| a.is_same(b))
    }
}

/// The intersection of a ray with an instance.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index of the instance.
    pub instance: u32,
    /// Distance in multiples of the ray's direction vector.
    pub t: f32,
    /// The intersection with its mesh.
    pub primitive: Primitive,
}

/// The intersection of a ray with a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// With a triangle.
    Triangle(TriangleHit),
    /// With a strand.
    Strand(StrandHit),
}

/// What a leaf of the TLAS refers to, by the index of the instance.
#[derive(Clone, Copy, Debug)]
enum TlasEntry {
    /// All triangles of an instance.
    Triangles(u32),
    /// All strands of an instance.
    Strands(u32),
}

impl Aggregate {
    /// Builds the acceleration structures. Instances without triangles are never hit.
    #[cfg(test)]
    pub fn new(instances: Vec<Instance>) -> Self {
        Self::with_merged(instances, &[])
    }

    /// Builds the acceleration structures. Reuses the one of the `cached` merged BLASes that is over the same
    /// instances.
    pub fn with_merged(instances: Vec<Instance>, cached: &[Arc<MergedBlas>]) -> Self {
        // Divide the instances into small ones, which are merged, and large ones
        let (mut sources, mut tlas_entries, mut boxes, mut merged_total) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for (index, instance) in instances.iter().enumerate() {
            let count = instance.geometry.mesh().triangles.len();
            if count <= MAX_MERGED_MESH && merged_total + count <= MAX_MERGED_TOTAL {
                merged_total += count;
                sources.push(MergedInstance::new(index as u32, instance));
            } else if let Some(bounds) = instance.geometry.blas.bounds() {
                tlas_entries.push(TlasEntry::Triangles(index as u32));
                boxes.push(instance.world_bounds(bounds));
            }
            if let Some(bounds) = instance.geometry.strands.blas.bounds() {
                tlas_entries.push(TlasEntry::Strands(index as u32));
                boxes.push(instance.world_bounds(bounds));
            }
        }
        // Build the merged BLAS, unless a cached one is still valid
        let cached = cached.iter().find(|merged| merged.is_over(&sources)).cloned();
        let merged = cached.unwrap_or_else(|| Arc::new(MergedBlas::new(&instances, sources)));
        // Build the TLAS over the large instances and the strands
        let tlas = bvh::build(&boxes, 1);
        Aggregate { instances, merged, tlas, tlas_entries }
    }

    /// Returns the merged BLAS of the small instances.
    pub fn merged(&self) -> &Arc<MergedBlas> {
        &self.merged
    }

    /// Returns the instances, indexed by [`Hit::instance`].
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Returns the number of strands, each instance counted.
    pub fn strand_count(&self) -> usize {
        self.instances.iter().map(|instance| instance.geometry.mesh().strands.len()).sum()
    }

    /// Returns the closest hit of a ray.
    pub fn intersect(&self, ray: &Ray, stack: &mut TraversalStack) -> Option<Hit> {
        simd::dispatch(Intersect { aggregate: self, ray, stack })
    }

    /// Returns true if the ray hits anything before its `t_max`.
    pub fn occluded(&self, ray: &Ray, stack: &mut TraversalStack) -> bool {
        simd::dispatch(Occluded { aggregate: self, ray, stack })
    }

    /// Returns the surface interaction at a hit.
    pub fn surface(&self, hit: &Hit) -> SurfaceInteraction {
        let instance = &self.instances[hit.instance as usize];
        match &hit.primitive {
            Primitive::Triangle(triangle) => instance.surface(triangle),
            Primitive::Strand(strand) => strand_surface::surface(instance, strand),
        }
    }
}

impl Aggregate {
    /// Intersects the triangles of an instance in object space.
    #[inline(always)]
    fn intersect_triangles<K: Kernels>(&self, instance: u32, ray: &Ray, stack: &mut TraversalStack) -> Option<Hit> {
        let placed = &self.instances[instance as usize];
        let local = placed.to_object(ray);
        let slab_ray = SlabRay::new(local.origin, local.direction);
        let hit = placed.geometry.blas.intersect::<K>(&local, &slab_ray, stack)?;
        Some(Hit { instance, t: hit.t, primitive: Primitive::Triangle(hit) })
    }

    /// Intersects the strands of an instance in object space.
    #[inline(always)]
    fn intersect_strands<K: Kernels>(&self, instance: u32, ray: &Ray, stack: &mut TraversalStack) -> Option<Hit> {
        let placed = &self.instances[instance as usize];
        let local = placed.to_object(ray);
        let slab_ray = SlabRay::new(local.origin, local.direction);
        let segment = placed.geometry.strands.blas.intersect::<K>(&local, &slab_ray, stack)?;
        let hit = StrandHit { segment, ray_direction: ray.direction };
        Some(Hit { instance, t: segment.t, primitive: Primitive::Strand(hit) })
    }
}

/// The task of [`Aggregate::intersect`].
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
        // Intersect the merged BLAS in world space
        let slab_ray = SlabRay::new(ray.origin, ray.direction);
        let mut closest = aggregate.merged.blas.intersect::<K>(ray, &slab_ray, stack).map(|hit| {
            let (instance, triangle) = aggregate.merged.triangles[hit.triangle as usize];
            Hit { instance, t: hit.t, primitive: Primitive::Triangle(TriangleHit { triangle, ..hit }) }
        });
        let t_max = closest.map_or(ray.t_max, |hit| hit.t);
        // Traverse the TLAS and intersect the BLAS of each instance in object space
        aggregate.tlas.traverse_front_to_back::<K>(
            &slab_ray,
            t_max,
            stack,
            #[inline(always)]
            |leaf, mut t_max, stack| {
                for &entry in aggregate.tlas.leaf(leaf) {
                    let hit = match aggregate.tlas_entries[entry as usize] {
                        TlasEntry::Triangles(instance) => {
                            aggregate.intersect_triangles::<K>(instance, &Ray { t_max, ..*ray }, stack)
                        }
                        TlasEntry::Strands(instance) => {
                            aggregate.intersect_strands::<K>(instance, &Ray { t_max, ..*ray }, stack)
                        }
                    };
                    if let Some(hit) = hit {
                        t_max = hit.t;
                        closest = Some(hit);
                    }
                }
                t_max
            },
        );
        closest
    }
}

/// The task of [`Aggregate::occluded`].
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
        let slab_ray = SlabRay::new(ray.origin, ray.direction);
        if aggregate.merged.blas.occluded::<K>(ray, &slab_ray, stack) {
            return true;
        }
        aggregate.tlas.traverse_any::<K>(
            &slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, stack| {
                aggregate.tlas.leaf(leaf).iter().any(|&entry| {
                    let entry = aggregate.tlas_entries[entry as usize];
                    let (TlasEntry::Triangles(index) | TlasEntry::Strands(index)) = entry;
                    let instance = &aggregate.instances[index as usize];
                    let local = instance.to_object(ray);
                    let slab_ray = SlabRay::new(local.origin, local.direction);
                    match entry {
                        TlasEntry::Triangles(_) => instance.geometry.blas.occluded::<K>(&local, &slab_ray, stack),
                        TlasEntry::Strands(_) => instance.geometry.strands.blas.occluded::<K>(&local, &slab_ray, stack),
                    }
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

    impl Hit {
        /// Returns the intersection with a triangle.
        pub(in crate::raytrace) fn triangle(&self) -> TriangleHit {
            let Primitive::Triangle(hit) = self.primitive else { panic!("not a triangle: {self:?}") };
            hit
        }
    }

    /// Returns deterministic numbers in 0..1.
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

    fn random_rays(count: u32) -> Vec<Ray> {
        let mut next = numbers(11);
        let ray = |_| {
            let origin = Vec3::new(next(), next(), next()) * 6.0 - 3.0;
            let mut direction = warp::uniform_sphere(Vec2::new(next(), next()));
            // One in ten along an axis, where the slab test multiplies zero by infinity.
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

    /// Intersects every triangle of every instance, with the same triangle test in the same space.
    fn brute_force(instances: &[Instance], ray: &Ray) -> Option<(u32, TriangleHit)> {
        use crate::raytrace::simd::{ShearedRay, TrianglePacket};
        let mut best: Option<(u32, TriangleHit)> = None;
        for (index, instance) in instances.iter().enumerate() {
            let mesh = instance.geometry.mesh();
            let is_merged = mesh.triangles.len() <= MAX_MERGED_MESH;
            let local = if is_merged { *ray } else { instance.to_object(ray) };
            let sheared = ShearedRay::new(local.origin, local.direction);
            for t in 0..mesh.triangles.len() {
                let end = best.as_ref().map_or(ray.t_max, |b| b.1.t);
                let corners = if is_merged { instance.world_corners(t) } else { mesh.corners(t) };
                if let Some(hit) = TrianglePacket::new([(t as u32, corners)]).intersect(&sheared, end) {
                    best = Some((index as u32, hit));
                }
            }
        }
        best
    }

    #[test]
    fn the_closest_hit_is_that_of_brute_force() {
        let transform = Affine3A::from_scale_rotation_translation(
            Vec3::new(0.5, 2.0, 1.0),
            Quat::from_rotation_y(0.7),
            Vec3::new(1.0, 0.2, -0.5),
        );
        let cube = tessellate(&Shape::Box { size_m: Vec3::ONE }).unwrap();
        let aggregate = Aggregate::new(vec![
            instance(soup(MAX_MERGED_MESH + 1), transform * Affine3A::from_scale(Vec3::splat(0.9)), 0),
            instance(soup(300), transform, 1),
            instance(cube, Affine3A::from_translation(Vec3::Y), 2),
        ]);
        let mut stack = TraversalStack::default();
        let mut hits = 0;
        for (i, ray) in random_rays(6000).iter().enumerate() {
            let ours = aggregate.intersect(ray, &mut stack);
            let truth = brute_force(aggregate.instances(), ray);
            // Of two triangles at one distance either may be returned; the distance has the same bits.
            assert_eq!(ours.map(|h| h.t), truth.map(|(_, h)| h.t), "ray {i}: {ray:?}");
            assert_eq!(aggregate.occluded(ray, &mut stack), truth.is_some(), "ray {i}: {ray:?}");
            // The scalar kernels return the same bits.
            let scalar = Intersect { aggregate: &aggregate, ray, stack: &mut stack }.run::<Scalar>();
            assert_eq!(scalar.map(|h| h.primitive), ours.map(|h| h.primitive), "ray {i}: {ray:?}");
            let scalar = Occluded { aggregate: &aggregate, ray, stack: &mut stack }.run::<Scalar>();
            assert_eq!(scalar, truth.is_some(), "ray {i}: {ray:?}");
            hits += usize::from(truth.is_some());
        }
        assert!(hits > 1000, "only {hits} rays hit anything: too few for the test");
    }

    #[test]
    fn of_ten_thousand_spheres_few_are_merged_and_all_are_hit() {
        let sphere = Arc::new(MeshGeometry::new(Arc::new(soup(100))));
        let transform = |i: u32| Affine3A::from_translation(Vec3::new(10.0 * i as f32, 0.0, 0.0));
        let instances: Vec<Instance> =
            (0..10_000).map(|i| Instance::new(sphere.clone(), transform(i), i, vec![0]).unwrap()).collect();
        let aggregate = Aggregate::new(instances);
        assert!(aggregate.merged.triangles.len() <= MAX_MERGED_TOTAL && aggregate.tlas_entries.len() > 7_000);
        let mut stack = TraversalStack::default();
        for i in (0..10_000).step_by(333) {
            let instance = &aggregate.instances()[i];
            let (low, high) = instance.world_bounds(instance.geometry.blas.bounds().unwrap());
            let count = (0..64).filter(|&k| {
                let offset = Vec3::new(((k % 8) as f32 + 0.5) / 8.0, ((k / 8) as f32 + 0.5) / 8.0, 0.0);
                let origin = low + (high - low) * offset - Vec3::Z;
                let ray = Ray { origin, direction: Vec3::Z, t_max: f32::INFINITY };
                aggregate.intersect(&ray, &mut stack).is_some_and(|hit| hit.instance as usize == i)
            });
            assert!(count.count() > 10, "sphere {i}");
        }
    }

    #[test]
    fn rays_miss_an_empty_studio() {
        let aggregate = Aggregate::new(vec![instance(Mesh::default().with_single_part("none"), Affine3A::IDENTITY, 0)]);
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, t_max: f32::INFINITY };
        assert!(aggregate.intersect(&ray, &mut TraversalStack::default()).is_none());
    }

    #[test]
    fn rays_that_leave_a_floor_through_the_world_origin_do_not_hit_it_again() {
        // A camera or a meter that lies on a floor: the coordinate along its normal is 0, and once its error bound was,
        // too. Rays hit the floor that they had left, and a white room lost a fourteenth of its light.
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
            assert!(aggregate.intersect(&away, &mut stack).is_none(), "left the floor and hit it: {ray:?} {away:?}");
        }
    }

    #[test]
    fn a_million_rays_neither_hit_the_triangle_they_leave_nor_leak_from_a_sphere() {
        // Also far from the camera, where camera-relative coordinates are large.
        let sphere = tessellate(&Shape::Sphere { radius_m: 1.0 }).unwrap();
        for far in [0.0, 1e3, 1e5] {
            let transform = Affine3A::from_translation(Vec3::new(far, -far, far));
            let aggregate = Aggregate::new(vec![instance(sphere.clone(), transform, 0)]);
            let mut stack = TraversalStack::default();
            let mut next = numbers(5);
            for _ in 0..340_000 {
                let origin = Vec3::new(far, -far, far);
                let out = warp::uniform_sphere(Vec2::new(next(), next()));
                let inside = Ray { origin, direction: out, t_max: f32::INFINITY };
                let hit = aggregate.intersect(&inside, &mut stack).expect("a ray from the centre leaked");
                let surface = aggregate.surface(&hit);
                // Outwards: a ray from the surface of a convex body does not hit it.
                let local = warp::cosine_hemisphere(Vec2::new(next(), next()));
                let (t, b) = crate::math::orthonormal_basis(surface.geometric_normal);
                let direction = t * local.x + b * local.y + surface.geometric_normal * local.z.max(1e-3);
                let away = Ray { origin: surface.spawn_origin(direction), direction, t_max: f32::INFINITY };
                if let Some(again) = aggregate.intersect(&away, &mut stack) {
                    // The tessellated sphere is convex up to rounding: a grazing ray may hit an adjacent triangle.
                    assert_ne!(again.triangle().triangle, hit.triangle().triangle, "left and hit the same triangle");
                }
                // Inwards: the ray must hit the other side.
                let inwards =
                    Ray { origin: surface.spawn_origin(-direction), direction: -direction, t_max: f32::INFINITY };
                assert!(aggregate.intersect(&inwards, &mut stack).is_some(), "a ray leaked at {far}");
            }
        }
    }
}
