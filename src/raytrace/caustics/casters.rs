//! The surfaces that cast caustics.

use super::patch::Patch;
use super::start_density::StartDensity;
use crate::raytrace::aggregate::{Aggregate, Hit, Primitive};
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::geometry::Instance;
use crate::raytrace::simd::TriangleHit;
use glam::{Vec2, Vec3};
use obvhs::ploc::morton::morton_encode_u64;
use rayon::prelude::*;
use std::ops::Range;

/// Number of patches into which the casters are divided at least: fine enough for a close-up of one of them.
const MIN_PATCHES: f64 = 8192.0;

/// The triangles of mirrors and clear glass, with their distribution by area. Large ones are divided into patches of
/// about the same area. All patches lie on a Morton curve, where neighbours are neighbours in space, and a point of a
/// patch has a position along it: the share of the area before the patch, to the share after it.
#[derive(Debug, Default)]
pub struct CausticCasters {
    /// Patches along the curve.
    patches: Vec<Patch>,
    /// Cumulative areas, square metres.
    areas: Vec<f64>,
    /// Index along the curve of each patch in the order of the meshes.
    curve_indices: Vec<u32>,
    /// For each instance that has casters, the first patch of each triangle and the end, as indices into
    /// `curve_indices`.
    first_patches: Vec<Option<Vec<u32>>>,
}

/// A sampled point on the casters.
#[derive(Clone, Copy, Debug)]
pub struct CasterPoint {
    /// The point.
    pub hit: Hit,
    /// Position of the middle of its patch along the curve, 0 to 1.
    pub curve_position: f64,
    /// Density of sampled points there, relative to points that are uniform in area.
    pub relative_density: f32,
}

impl CausticCasters {
    /// All casters of a studio.
    pub fn new(aggregate: &Aggregate, materials: &[TracedMaterial]) -> Self {
        // Measure the triangles, and divide large ones into patches
        let instances = || (0..).zip(aggregate.instances());
        let areas: Vec<_> = instances().map(|(_, instance)| triangle_areas(instance, materials)).collect();
        let total: f64 = areas.iter().flatten().flatten().sum();
        let mut unsorted = Vec::new();
        let mut first_patches = Vec::new();
        for ((index, instance), areas) in instances().zip(areas) {
            first_patches.push(areas.map(|areas| {
                let mut firsts = vec![unsorted.len() as u32];
                for (triangle, area) in (0..).zip(areas) {
                    if area > 0.0 {
                        let corners = instance.world_corners(triangle as usize);
                        let patches = Patch::divide(index, triangle, area / total * MIN_PATCHES);
                        unsorted.extend(patches.map(|patch| (patch, patch.centre(corners), area * patch.share())));
                    }
                    firsts.push(unsorted.len() as u32);
                }
                firsts
            }));
        }

        // Sort the patches along the curve
        let code = curve(unsorted.iter().map(|(_, centre, _)| *centre));
        let mut order: Vec<(u64, u32)> = (0..).zip(&unsorted).map(|(i, (_, centre, _))| (code(*centre), i)).collect();
        order.par_sort_unstable();
        let mut casters =
            CausticCasters { curve_indices: vec![0; order.len()], first_patches, ..CausticCasters::default() };
        let mut total = 0.0;
        for (curve_index, (_, index)) in (0..).zip(order) {
            let (patch, _, area) = unsorted[index as usize];
            total += area;
            casters.patches.push(patch);
            casters.areas.push(total);
            casters.curve_indices[index as usize] = curve_index;
        }
        casters
    }

    /// Returns the total area, square metres.
    pub fn area(&self) -> f32 {
        self.areas.last().copied().unwrap_or(0.0) as f32
    }

    /// Returns the density of photons that start uniformly on the casters with directions of density `pdf`, at `cos` to
    /// the surface: in perpendicular area and solid angle, 1/(m2 sr).
    pub fn density(&self, pdf: f32, cos: f32) -> f32 {
        pdf / (self.area() * cos)
    }

    /// Samples a point by numbers in [0, 1): a patch by its area and by `starts`, and in it uniformly. None where there
    /// is no caster.
    pub fn sample(&self, starts: &StartDensity, choice: f32, u: Vec2) -> Option<CasterPoint> {
        let total = self.areas.last()?;
        let area = starts.position(f64::from(choice)) * total;
        let index = self.areas.partition_point(|&cumulative| cumulative <= area).min(self.patches.len() - 1);
        let patch = &self.patches[index];
        let span = self.span(index);
        let primitive =
            Primitive::Triangle(TriangleHit { t: 0.0, triangle: patch.triangle, barycentric: patch.barycentric(u) });
        Some(CasterPoint {
            hit: Hit { instance: patch.instance, t: 0.0, primitive },
            curve_position: 0.5 * (span.start + span.end),
            relative_density: starts.relative_density(span),
        })
    }

    /// Returns the centres of so many equal sections of the curve: each is in the patch in the middle of its section.
    pub fn section_centres(&self, aggregate: &Aggregate, sections: usize) -> Vec<Vec3> {
        let Some(total) = self.areas.last() else { return Vec::new() };
        let centre = |section: usize| {
            let middle = (section as f64 + 0.5) / sections as f64 * total;
            let index = self.areas.partition_point(|&cumulative| cumulative <= middle).min(self.patches.len() - 1);
            let patch = &self.patches[index];
            patch.centre(aggregate.instances()[patch.instance as usize].world_corners(patch.triangle as usize))
        };
        (0..sections).map(centre).collect()
    }

    /// Returns the density of points sampled by `starts` at a hit, relative to points that are uniform in area. None
    /// where there is no caster: strands are none.
    pub fn relative_density(&self, starts: &StartDensity, hit: &Hit) -> Option<f32> {
        let Primitive::Triangle(TriangleHit { triangle, barycentric, .. }) = hit.primitive else { return None };
        let firsts = self.first_patches.get(hit.instance as usize)?.as_ref()?;
        let (first, end) = (firsts[triangle as usize], firsts[triangle as usize + 1]);
        if first == end {
            return None;
        }
        let patch = first + Patch::index_at(end - first, barycentric);
        Some(starts.relative_density(self.span(self.curve_indices[patch as usize] as usize)))
    }

    /// Returns the positions of a patch along the curve.
    fn span(&self, index: usize) -> Range<f64> {
        let total = self.areas.last().copied().unwrap_or(1.0);
        let before = index.checked_sub(1).map_or(0.0, |before| self.areas[before]);
        before / total..self.areas[index] / total
    }
}

/// Returns the areas of the triangles of an instance in square metres, 0 for those that cast no caustics. None without
/// casters.
fn triangle_areas(instance: &Instance, materials: &[TracedMaterial]) -> Option<Vec<f64>> {
    let casts: Vec<bool> = instance.materials.iter().map(|&m| materials[m as usize].is_caustic_caster()).collect();
    let area = |triangle: u32| {
        if !casts.get(instance.geometry.part(triangle)).copied().unwrap_or(false) {
            return 0.0;
        }
        let [a, b, c] = instance.world_corners(triangle as usize);
        let area = 0.5 * f64::from((b - a).cross(c - a).length());
        if area.is_finite() { area } else { 0.0 }
    };
    let triangles = 0..instance.geometry.mesh().triangles.len() as u32;
    casts.contains(&true).then(|| triangles.map(area).collect())
}

/// Returns the function from points to their codes on a Morton curve around all of them.
fn curve(points: impl Iterator<Item = Vec3> + Clone) -> impl Fn(Vec3) -> u64 {
    let low = points.clone().fold(Vec3::INFINITY, Vec3::min);
    let size = (points.fold(Vec3::NEG_INFINITY, Vec3::max) - low).max_element().max(f32::MIN_POSITIVE);
    move |point| {
        let cell = ((point - low) / size * (1 << 20) as f32).as_uvec3();
        morton_encode_u64(cell.x, cell.y, cell.z)
    }
}
