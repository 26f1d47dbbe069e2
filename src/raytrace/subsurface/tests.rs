//! Walks against closed forms and published profiles.

use super::medium::Medium;
use super::walk::{Walk, WalkEnd, WalkPair};
use crate::math::{Ray, warp};
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::bvh::TraversalStack;
use crate::raytrace::geometry::{Instance, MeshGeometry, SurfaceInteraction};
use crate::raytrace::sampler::{Dimensions, Sampler};
use crate::raytrace::simd::{self, KernelTask, Kernels};
use crate::scene::{Material, Mesh, Shape, Subsurface, tessellate};
use crate::statistics::{SampleMean, TestRng};
use glam::{Affine3A, DVec3, Vec3};
use std::sync::Arc;

/// An object of a material.
struct Body {
    instance: Instance,
    materials: Vec<TracedMaterial>,
    stack: TraversalStack,
}

/// Intersects a body alone.
struct Intersect<'a>(&'a mut Body, Ray);

impl KernelTask for Intersect<'_> {
    type Output = Option<SurfaceInteraction>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Self::Output {
        let hit = self.0.instance.intersect::<K>(&self.1, &mut self.0.stack)?;
        Some(self.0.instance.surface(&hit))
    }
}

impl Body {
    fn new(mesh: Mesh, materials: &[Material]) -> Self {
        let geometry = Arc::new(MeshGeometry::new(Arc::new(mesh)));
        let indices = (0..materials.len() as u32).collect();
        Body {
            instance: Instance::new(geometry, Affine3A::IDENTITY, 0, indices, None).unwrap(),
            materials: materials.iter().map(TracedMaterial::new).collect(),
            stack: TraversalStack::default(),
        }
    }

    fn of_shape(shape: Shape, material: Material) -> Self {
        Body::new(tessellate(&shape).unwrap(), &[material])
    }

    /// Returns the surface that a ray from outside meets.
    fn surface(&mut self, origin: Vec3, direction: Vec3) -> SurfaceInteraction {
        simd::dispatch(Intersect(self, Ray { origin, direction, t_max: f32::INFINITY })).unwrap()
    }

    /// Walks from a surface.
    fn walk(&mut self, entry: &SurfaceInteraction, base_color: Vec3, index: u32) -> WalkPair {
        let extinction = self.materials[0].extinction_per_m().unwrap();
        let sampler = Sampler::new(3, index >> 12, index & 0xfff, 5);
        let (set, numbers) = sampler.set_and_stream(Dimensions::Subsurface { depth: 0 });
        simd::dispatch(Walk {
            instance: &self.instance,
            materials: &self.materials,
            medium: &Medium::new(extinction, base_color),
            entry,
            set,
            numbers,
            stack: &mut self.stack,
        })
    }
}

fn soft(mean_free_path_mm: [f32; 3]) -> Material {
    Material { subsurface: Some(Subsurface { mean_free_path_mm }), ..Material::default() }
}

/// A flat surface so large that walks do not reach its edge, over a half-space.
fn half_space(mean_free_path_mm: [f32; 3]) -> (Body, SurfaceInteraction) {
    let size_m = 0.8 * Vec3::from(mean_free_path_mm).max_element();
    let mut body = Body::of_shape(Shape::Plane { width_m: size_m, depth_m: size_m }, soft(mean_free_path_mm));
    let entry = body.surface(Vec3::new(0.03, 1.0, 0.02) * size_m, Vec3::NEG_Y);
    (body, entry)
}

#[test]
fn the_albedo_of_a_thick_flat_body_is_the_base_colour() {
    // 0.2 % for the fit and the limit on steps, besides the standard error.
    const WALKS: u32 = 40_000;
    let colors = [Vec3::new(0.2, 0.35, 0.5), Vec3::new(0.65, 0.8, 0.95), Vec3::new(0.62, 0.43, 0.34)];
    for color in colors {
        for mean_free_path_mm in [[1.0; 3], [1.3, 0.95, 0.67], [20.0, 5.0, 1.0], [0.2; 3]] {
            let (mut body, entry) = half_space(mean_free_path_mm);
            let walks: Vec<WalkPair> = (0..WALKS).map(|i| body.walk(&entry, color, i)).collect();
            for channel in 0..3 {
                let expected = f64::from(color[channel]);
                let weight = |walk: &WalkPair| walk.end.map_or(0.0, |end| f64::from(end.weight[channel]));
                let mean = SampleMean::of(walks.iter().map(weight));
                assert!(mean.agrees_with(expected, 0.002, 72), "{mean:?} for {expected}");
                // The control variate: the same walk under the tangent plane, which is the surface here.
                let flat = SampleMean::of(walks.iter().map(|walk| f64::from(walk.flat_weight[channel])));
                assert!(flat.agrees_with(expected, 0.0005, 72), "{flat:?} for {expected}");
                let difference = SampleMean::of(walks.iter().map(|w| weight(w) - f64::from(w.flat_weight[channel])));
                assert!(difference.standard_error < 0.1 * mean.standard_error, "{difference:?}");
            }
        }
    }
}

/// Part of the light around a thin beam that leaves within a radius (Christensen and Burley 2015, "Approximate
/// Reflectance Profiles for Efficient Subsurface Scattering", equations 3 and 6: a beam that enters diffusely), for a
/// mean free path of 1.
fn published_profile(albedo: f64, radius: f64) -> f64 {
    let s = 1.9 - albedo + 3.5 * (albedo - 0.8).powi(2);
    1.0 - 0.25 * (-s * radius).exp() - 0.75 * (-s * radius / 3.0).exp()
}

/// Radii at which profiles are compared, mean free paths.
const RADII: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Part of the light around a thin beam that leaves within [`RADII`], by walks in a half-space without any variance
/// reduction: absorbed light ends the walk.
fn brute_force_profile(albedo: f64, rng: &mut TestRng) -> [f64; RADII.len()] {
    let (mut within, mut total) = ([0.0; RADII.len()], 0.0);
    while total < 30_000.0 {
        let entry = warp::cosine_hemisphere(rng.unit_square()).as_dvec3();
        let (mut position, mut direction) = (DVec3::ZERO, DVec3::new(entry.x, -entry.z, entry.y));
        loop {
            let next = position - direction * f64::from(1.0 - rng.uniform()).ln();
            if next.y > 0.0 {
                let radius = (position + direction * (position.y / -direction.y)).length();
                within.iter_mut().zip(RADII).filter(|(_, r)| radius < *r).for_each(|(sum, _)| *sum += 1.0);
                total += 1.0;
                break;
            }
            if f64::from(rng.uniform()) >= albedo {
                break;
            }
            (position, direction) = (next, rng.direction().as_dvec3());
        }
    }
    within.map(|sum| sum / total)
}

#[test]
fn light_around_a_thin_beam_has_the_published_profile() {
    let mut rng = TestRng::new(8);
    for (albedo, mean_free_path_mm) in [(0.2_f32, 2.0), (0.35, 0.5), (0.5, 1.0), (0.65, 20.0), (0.8, 2.0)] {
        let (mut body, entry) = half_space([mean_free_path_mm; 3]);
        let (mut within, mut total) = ([0.0; RADII.len()], 0.0);
        for index in 0..30_000 {
            let Some(end) = body.walk(&entry, Vec3::splat(albedo), index).end else { continue };
            let weight = f64::from(end.weight.y);
            let radius = f64::from(end.surface.position.distance(entry.position) / mean_free_path_mm) * 1e3;
            total += weight;
            within.iter_mut().zip(RADII).filter(|(_, r)| radius < *r).for_each(|(sum, _)| *sum += weight);
        }
        let medium = Medium::new(Vec3::ONE, Vec3::splat(albedo));
        let brute_force = brute_force_profile(f64::from(medium.albedo.x), &mut rng);
        for ((sum, truth), radius) in within.iter().zip(brute_force).zip(RADII) {
            let ours = sum / total;
            // Two proportions of 30 000 walks each, at most 0.5: four standard errors.
            assert!((ours - truth).abs() < 0.016, "{ours} for {truth} within {radius}, albedo {albedo}");
            // The published profile is a fit, within a few per cent.
            let published = published_profile(f64::from(albedo), radius);
            assert!((ours - published).abs() < 0.035, "{ours} for {published} within {radius}, albedo {albedo}");
        }
    }
}

/// A soft layer, 1 m wide, over another surface at a depth in metres, which faces up.
fn layer_over(depth_m: f32) -> Mesh {
    let mut layer = tessellate(&Shape::Plane { width_m: 1.0, depth_m: 1.0 }).unwrap();
    let mut lower = layer.clone();
    lower.positions.iter_mut().for_each(|position| position.y -= depth_m);
    layer.append(&lower);
    layer
}

#[test]
fn white_walks_that_do_not_find_the_surface_end_at_their_entry_with_all_of_their_light() {
    // A strip much narrower than the mean free path, and a layer over a hard floor of another part.
    let white = Material { base_color: [1.0; 3], ..soft([5.0; 3]) };
    let strip = tessellate(&Shape::Plane { width_m: 1e-3, depth_m: 1.0 }).unwrap();
    let hard = Material { subsurface: None, ..white.clone() };
    for (mesh, materials) in [(strip, vec![white.clone()]), (layer_over(1e-3), vec![white, hard])] {
        let mut body = Body::new(mesh, &materials);
        let entry = body.surface(Vec3::new(1e-4, 1.0, 0.1), Vec3::NEG_Y);
        let ends: Vec<WalkEnd> = (0..500).map(|i| body.walk(&entry, Vec3::ONE, i).end.unwrap()).collect();
        assert!(ends.iter().filter(|end| end.is_entry).count() > 250);
        for end in &ends {
            assert!(end.surface.material == 0 && (!end.is_entry || end.surface.position == entry.position));
        }
        let mean = SampleMean::of(ends.iter().map(|end| f64::from(end.weight.y)));
        assert!(mean.agrees_with(1.0, 0.0, 2), "{mean:?}");
    }
}

#[test]
fn a_soft_layer_over_a_surface_that_stops_walks_has_its_base_colour() {
    // A hard floor, as of teeth behind lips, and the body's own skin, as where a mesh overlaps itself. Walks that ended
    // there at once had up to all of their light: bright spots about mouths and eyes. 0.2 % for the fit, as above.
    const COLOR: Vec3 = Vec3::new(0.62, 0.43, 0.34);
    let skin = soft([1.3, 0.95, 0.67]);
    let hard = Material { subsurface: None, ..skin.clone() };
    for depth_m in [1e-5, 3e-4, 1e-3, 3e-3] {
        for lower in [&hard, &skin] {
            let mut body = Body::new(layer_over(depth_m), &[skin.clone(), lower.clone()]);
            let entry = body.surface(Vec3::new(1e-4, 1.0, 0.1), Vec3::NEG_Y);
            let walks: Vec<WalkPair> = (0..20_000).map(|i| body.walk(&entry, COLOR, i)).collect();
            for channel in 0..3 {
                let weight = |walk: &WalkPair| walk.end.map_or(0.0, |end| f64::from(end.weight[channel]));
                let mean = SampleMean::of(walks.iter().map(weight));
                assert!(mean.agrees_with(f64::from(COLOR[channel]), 0.002, 24), "{mean:?} at {depth_m} m");
                // The control variate leaves next to no noise
                let difference = SampleMean::of(walks.iter().map(|w| weight(w) - f64::from(w.flat_weight[channel])));
                assert!(difference.standard_error < 0.1 * mean.standard_error, "{difference:?} at {depth_m} m");
            }
        }
    }
}
