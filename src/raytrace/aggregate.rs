//! The acceleration structure over the whole studio, in two levels.
//!
//! Large meshes are instances: the top-level BVH (TLAS) over their boxes refers to a BLAS a mesh. An instance costs a
//! ray a transform and a new traversal, which is expensive for the dozen triangles of a wall. Small instances are
//! therefore merged into one BLAS in world space. When one of them moves, that BLAS is built anew, which is quick. The
//! strands of a mesh have a BLAS and a box in the TLAS of their own. Bodies of lights are never merged: some rays pass
//! some of them.

use super::blas::Blas;
use super::bvh::{self, BuildEffort, TraversalStack, WideBvh};
use super::geometry::{Instance, MeshGeometry, SurfaceInteraction};
use super::ray_filter::RayFilter;
use super::simd::{self, KernelTask, Kernels, SlabRay, TriangleHit};
use super::strand_detail::{StrandLevel, StrandLevels, StrandUse, StrandView};
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
            let is_small = count <= MAX_MERGED_MESH && merged_total + count <= MAX_MERGED_TOTAL;
            if is_small && instance.body.is_none() {
                merged_total += count;
                sources.push(MergedInstance::new(index as u32, instance));
            } else if let Some(bounds) = instance.geometry.blas.bounds() {
                tlas_entries.push(TlasEntry::Triangles(index as u32));
                boxes.push(instance.world_bounds(bounds));
            }
            if let Some(bounds) = instance.strand_bounds() {
                tlas_entries.push(TlasEntry::Strands(index as u32));
                boxes.push(bounds);
            }
        }
        // Build the merged BLAS, unless a cached one is still valid
        let cached = cached.iter().find(|merged| merged.is_over(&sources)).cloned();
        let merged = cached.unwrap_or_else(|| Arc::new(MergedBlas::new(&instances, sources)));
        // Build the TLAS over the large instances and the strands
        let tlas = bvh::build(&boxes, 1, BuildEffort::Reinsertion);
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

    /// Returns the coarsest level of detail of strands in words; none if all strands are met.
    pub fn thinned_strands(&self) -> Option<String> {
        let levels = self.instances.iter().filter_map(|instance| Some(instance.strands()?.levels()));
        let coarsest = levels.max_by_key(|levels| levels.lighting.index())?;
        let words = |level: StrandLevel| match level.every() {
            1 => "all strands".to_owned(),
            every => format!("one of {every} strands, {every} times as wide"),
        };
        (coarsest != StrandLevels::default()).then(|| {
            let [seen, lighting] = [coarsest.seen, coarsest.lighting].map(words);
            format!("hair finer than pixels: the camera sees {seen}; shadows and scattered light meet {lighting}")
        })
    }

    /// Chooses the levels of detail of all strands for a view.
    pub fn thin_strands(&mut self, view: &StrandView) {
        self.instances.iter_mut().for_each(|instance| instance.thin_strands(Some(view)));
    }

    /// Makes the bodies of lights visible to all rays: for rays that start at a receptor rather than at the camera.
    pub fn show_bodies(&mut self) {
        self.instances.iter_mut().filter_map(|instance| instance.body.as_mut()).for_each(|body| body.is_hidden = false);
    }

    /// Returns the closest hit of a ray with what it does not pass.
    pub fn intersect(&self, ray: &Ray, filter: RayFilter, stack: &mut TraversalStack) -> Option<Hit> {
        simd::dispatch(Intersect { aggregate: self, ray, filter, stack })
    }

    /// Returns true if the ray hits anything that it does not pass before its `t_max`.
    pub fn occluded(&self, ray: &Ray, filter: RayFilter, stack: &mut TraversalStack) -> bool {
        simd::dispatch(Occluded { aggregate: self, ray, filter, stack })
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
    fn intersect_strands<K: Kernels>(
        &self,
        instance: u32,
        ray: &Ray,
        strand_use: StrandUse,
        stack: &mut TraversalStack,
    ) -> Option<Hit> {
        let placed = &self.instances[instance as usize];
        let (blas, level) = placed.strands()?.of(strand_use);
        let local = placed.to_object(ray);
        let slab_ray = SlabRay::new(local.origin, local.direction);
        let segment = blas.intersect::<K>(&local, &slab_ray, stack)?;
        let hit = StrandHit { segment, ray_direction: ray.direction, level };
        Some(Hit { instance, t: segment.t, primitive: Primitive::Strand(hit) })
    }
}

/// The task of [`Aggregate::intersect`].
struct Intersect<'a> {
    aggregate: &'a Aggregate,
    ray: &'a Ray,
    filter: RayFilter,
    stack: &'a mut TraversalStack,
}

impl KernelTask for Intersect<'_> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Option<Hit> {
        let Intersect { aggregate, ray, filter, stack } = self;
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
                    let entry = aggregate.tlas_entries[entry as usize];
                    let (TlasEntry::Triangles(index) | TlasEntry::Strands(index)) = entry;
                    if aggregate.instances[index as usize].is_passed(filter.passed) {
                        continue;
                    }
                    let hit = match entry {
                        TlasEntry::Triangles(instance) => {
                            aggregate.intersect_triangles::<K>(instance, &Ray { t_max, ..*ray }, stack)
                        }
                        TlasEntry::Strands(instance) => {
                            aggregate.intersect_strands::<K>(instance, &Ray { t_max, ..*ray }, filter.strands, stack)
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
    filter: RayFilter,
    stack: &'a mut TraversalStack,
}

impl KernelTask for Occluded<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<K: Kernels>(self) -> bool {
        let Occluded { aggregate, ray, filter, stack } = self;
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
                    if instance.is_passed(filter.passed) {
                        return false;
                    }
                    let local = instance.to_object(ray);
                    let slab_ray = SlabRay::new(local.origin, local.direction);
                    match entry {
                        TlasEntry::Triangles(_) => instance.geometry.blas.occluded::<K>(&local, &slab_ray, stack),
                        TlasEntry::Strands(_) => instance.strands().is_some_and(|strands| {
                            strands.of(filter.strands).0.occluded::<K>(&local, &slab_ray, stack)
                        }),
                    }
                })
            },
        )
    }
}

#[cfg(test)]
mod tests;
