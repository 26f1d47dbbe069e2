//! The path tracer.
//!
//! Unidirectional path tracing with light sampling at every non-specular vertex, and multiple importance sampling
//! (Veach 1997, power heuristic) where both techniques can find a light. The method `direct` is the same with one
//! non-specular scattering event; specular surfaces are followed in both.
//!
//! Which technique finds the light behind panes, bodies of glass and mirrors: `straight_path`.

use super::aggregate::Hit;
use super::bsdf::{Bsdf, BsdfSample, Polarisation, SurfaceBsdf};
use super::caustics::{CausticMis, GatherDensities, GatherPoint, PhotonMap};
use super::emitters::MisVertex;
use super::events::{PathEnd, PathEvent, PathVertex, ScatteringKind};
use super::geometry::SurfaceInteraction;
use super::irradiance_cache::IrradianceCache;
use super::lights::LightImportances;
use super::limits::PathLimits;
use super::medium_stack::MediumStack;
use super::ray_caster::RayCaster;
use super::ray_filter::RayFilter;
use super::regularisation::BlurredMaterials;
use super::render_scene::RenderScene;
use super::roulette::{survival_probability, survives};
use super::sampler::{self, Dimensions, Sampler};
use super::sink::RadianceSink;
use crate::math::Ray;
use glam::Vec3;

/// Faces of clear glass, one behind the other, at which a camera path follows both reflection and transmission.
const DIELECTRIC_SPLITS: u32 = 3;

/// Traces paths for one thread.
#[derive(Debug)]
pub struct PathTracer<'a> {
    /// Casts the rays.
    pub caster: RayCaster<'a>,
    /// Caustics; without a map, paths find them.
    photon_map: Option<&'a PhotonMap>,
    /// Light on matte surfaces after a bounce; without a cache, paths find all of it.
    pub irradiance_cache: Option<&'a IrradianceCache>,
    /// Materials for paths that regularisation blurs; none without it.
    pub blurred_materials: Option<&'a BlurredMaterials>,
}

/// The state of a path between two vertices.
#[derive(Clone, Copy, Debug)]
pub struct PathState {
    ray: Ray,
    /// Radiance that the path carries per radiance at its end.
    pub throughput: Vec3,
    /// Part of the throughput that Russian roulette ignores: the squared index of refraction by which glass scales
    /// radiance, and the division among split paths.
    pub roulette_scale: f32,
    pub media: MediumStack,
    polarisation: Polarisation,
    /// The last non-specular vertex, and the path since then.
    mis_vertex: MisVertex,
    /// Densities of paths and photons at the last non-specular vertex, if all vertices since were caustic casters.
    gather: Option<GatherDensities>,
    /// Number of paths that leave the present vertex.
    pub split_factor: f32,
    /// The surface that the camera sees, directly or by mirrors and clear glass, has been passed.
    has_seen: bool,
    /// Length of the way from the camera to the first non-specular vertex, metres.
    camera_distance: f32,
    /// Solid angle for which the last sample stands: one over its density, sr; 0 after specular scattering.
    pub sample_solid_angle: f32,
    /// Vertices so far.
    pub depth: u32,
    /// Non-specular vertices so far.
    pub non_specular_depth: u32,
}

/// A path vertex at which light scatters.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint<'a> {
    /// The intersection with the surface at which the path arrived.
    pub hit: &'a Hit,
    /// The surface.
    pub surface: &'a SurfaceInteraction,
    /// The BSDF towards the last vertex.
    pub bsdf: &'a Bsdf<'a>,
    /// Importances of the lights at the point, if they are known already.
    pub importances: Option<&'a LightImportances<'a>>,
    /// A BSDF whose direct light is added besides: a control variate of walks under the surface.
    pub control: Option<&'a Bsdf<'a>>,
    /// Lobe choice in [0, 1), where it is not random.
    pub lobe_choice: Option<f32>,
    /// Distance from the last vertex, metres.
    pub distance: f32,
    /// The ray arrives on the side of the geometric normal.
    pub outside: bool,
}

/// A path vertex at which light scatters under the surface.
#[derive(Clone, Copy, Debug)]
pub struct SoftPoint<'a> {
    /// The vertex.
    pub point: &'a ShadingPoint<'a>,
    /// The BSDF of its surface.
    pub bsdf: &'a SurfaceBsdf<'a>,
}

impl PathState {
    /// A path along its first ray.
    pub fn new(origin: Vec3, direction: Vec3, mis_vertex: MisVertex) -> Self {
        PathState {
            ray: Ray { origin, direction, t_max: f32::INFINITY },
            throughput: Vec3::ONE,
            roulette_scale: 1.0,
            media: MediumStack::default(),
            polarisation: Polarisation::NONE,
            mis_vertex,
            gather: None,
            split_factor: 1.0,
            has_seen: false,
            camera_distance: 0.0,
            sample_solid_angle: 0.0,
            depth: 0,
            non_specular_depth: 0,
        }
    }
}

impl<'a> PathTracer<'a> {
    /// A tracer for a scene, with caustics from a photon map or without.
    pub fn new(scene: &'a RenderScene, photon_map: Option<&'a PhotonMap>) -> Self {
        let caster = RayCaster::with_photon_caustics(scene, photon_map.is_some());
        PathTracer { caster, photon_map, irradiance_cache: None, blurred_materials: None }
    }

    /// Traces a path along a camera ray and adds its contributions to `sink`.
    pub fn trace(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        self.trace_from(origin, direction, sampler, limits, (MisVertex::new(origin, Vec3::ZERO), None), sink);
    }

    /// Traces a path from a receptor that samples the lights by itself: emitters that are hit on a straight path do not
    /// contribute. If it receives photons, too, `gather` holds their density and that of the path.
    pub fn trace_without_direct_light(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: PathLimits,
        gather: Option<GatherDensities>,
        sink: &mut impl RadianceSink,
    ) {
        // With the least density, light sampling has all the MIS weight.
        let vertex = MisVertex { direction, pdf: Some(f32::MIN_POSITIVE), ..MisVertex::new(origin, Vec3::ZERO) };
        self.trace_from(origin, direction, sampler, limits, (vertex, gather), sink);
    }

    fn trace_from(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: PathLimits,
        (mis_vertex, gather): (MisVertex, Option<GatherDensities>),
        sink: &mut impl RadianceSink,
    ) {
        sink.record(|| PathEvent::CameraRay { origin, direction });
        let mut path = PathState { gather, ..PathState::new(origin, direction, mis_vertex) };
        self.extend(&mut path, sampler, limits, sink);
    }

    /// Traces a path that starts on a surface, as scattered by a BSDF, and is one that the camera sees after a bounce.
    pub fn trace_from_surface(
        &mut self,
        (hit, surface): (&Hit, &SurfaceInteraction),
        bsdf: &Bsdf<'_>,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        let normal = surface.geometric_normal;
        let mis_vertex = MisVertex::new(surface.position, normal);
        let mut path = PathState {
            has_seen: true,
            // The camera is the origin
            camera_distance: surface.position.length(),
            depth: 1,
            non_specular_depth: 1,
            ..PathState::new(surface.position, -normal, mis_vertex)
        };
        let point = ShadingPoint {
            hit,
            surface,
            bsdf,
            importances: None,
            control: None,
            lobe_choice: None,
            distance: 0.0,
            outside: true,
        };
        self.gather_photons(&path, surface, bsdf, limits, sink);
        if self.scatter(&mut path, &point, sampler, limits, sink) {
            self.extend(&mut path, sampler, limits, sink);
        }
    }

    /// Extends a path, vertex by vertex, to its end, and all paths into which it splits.
    pub fn extend(
        &mut self,
        path: &mut PathState,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.caster.scene;
        loop {
            // Intersect the ray with the studio
            let hit =
                self.caster.intersect_filtered(&path.ray, RayFilter::of_path(path.depth, path.non_specular_depth));
            let distance = hit.as_ref().map_or(f32::INFINITY, |hit| hit.t);

            // Add the light of emitters in front of the surface
            if path.depth == 0 {
                if self.caster.add_visible_emitter(&path.ray, distance, sink) {
                    return;
                }
            } else {
                let PathState { ray, throughput, mis_vertex, media, .. } = &*path;
                self.caster.add_emitter_hits(ray, hit.as_ref(), *throughput, mis_vertex, media, sink);
            }
            let Some(hit) = &hit else {
                sink.record(|| PathEvent::Miss);
                return;
            };
            let surface = scene.surface(&path.ray, hit);
            let material = &scene.materials[surface.material as usize];
            let wo = -path.ray.direction;
            let outside = wo.dot(surface.geometric_normal) >= 0.0;
            if path.depth == 0 {
                sink.first_hit(|| scene.first_hit(&path.ray, hit, &surface));
            }

            if path.non_specular_depth == 0 {
                path.camera_distance += distance;
            }

            // Absorb light along the ray (Beer-Lambert)
            if scene.plan().refraction {
                path.throughput *= path.media.transmittance_to(&scene.materials, &surface, outside, distance);
            }
            sink.record(|| {
                let (object, part) = scene.object_and_part(hit);
                PathEvent::Vertex(PathVertex {
                    depth: path.depth,
                    position: surface.position,
                    distance,
                    normal: surface.normal,
                    object,
                    part: part.to_owned(),
                    material: surface.material,
                    throughput: path.throughput,
                })
            });

            // Add the surface's emission
            if material.is_emissive() {
                sink.record(|| PathEvent::Emission);
                sink.add(scene.emission_layer(), path.throughput * scene.emission(&surface) * scene.emission_time_s);
            }

            // Describe the surface that the camera sees, or sees by mirrors and clear glass
            if !path.has_seen && !material.is_nearly_specular() {
                path.has_seen = true;
                sink.seen_surface(|| scene.seen_surface(&path.ray, path.throughput, &surface));
            }

            // End the path at its maximum depth; the last non-specular vertex is followed by specular ones
            let is_last = path.non_specular_depth >= limits.max_non_specular_depth;
            if path.depth >= limits.max_depth || (is_last && !material.is_caustic_caster()) {
                sink.record(|| PathEvent::End(PathEnd::Depth));
                return;
            }
            // Describe the scattering there; its gloss may be blurred
            let material = self.blurred_material(path, &surface, sink).unwrap_or(material);
            let mut bsdf = scene.bsdf(material, &surface, wo, &path.media, path.polarisation);

            // Take diffuse light from the cache
            if !self.take_cached_light(path, &surface, (wo, distance), &mut bsdf, sink) {
                return;
            }
            let point = ShadingPoint {
                hit,
                surface: &surface,
                bsdf: &bsdf,
                importances: None,
                control: None,
                lobe_choice: None,
                distance,
                outside,
            };
            let samples_lights = bsdf.has_non_specular_lobe() && !is_last;
            // The noise of hair is that of its fibres side by side, which more paths from one of them do not reduce
            let splits = samples_lights && path.non_specular_depth == 0 && surface.strand.is_none();
            let paths = if splits { limits.split_factor } else { 1 };
            path.split_factor = paths as f32;

            // Gather the photons of caustics
            if samples_lights {
                self.gather_photons(path, &surface, &bsdf, limits, sink);
            }

            // Continue under the surface, with several paths, or with both lobes of clear glass
            if let (Some(entry), false) = (bsdf.soft_surface(), is_last) {
                let point = SoftPoint { point: &point, bsdf: entry };
                if !self.scatter_soft(path, point, paths, sampler, limits, sink) {
                    return;
                }
                continue;
            }
            if paths > 1 {
                self.split_path(path, &point, paths, sampler, limits, sink);
                return;
            }
            if path.depth < DIELECTRIC_SPLITS
                && path.non_specular_depth == 0
                && let Some(reflectance) = bsdf.dielectric_reflectance()
            {
                self.split_dielectric(path, &point, reflectance, sampler, limits, sink);
                return;
            }

            // Continue with one path
            let goes_on = if samples_lights {
                self.scatter(path, &point, sampler, limits, sink)
            } else {
                let set = sampler.set(Dimensions::Bsdf { depth: path.depth });
                self.leave(path, &point, 1.0, &set, limits, sink)
            };
            if !goes_on {
                return;
            }
        }
    }

    /// Gathers the photons of caustics at a surface, if there is a photon map.
    pub fn gather_photons(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        // Strands are too thin for that, and their paths find the emitters
        let (Some(map), None) = (self.photon_map, surface.strand) else { return };
        let max_specular_depth = limits.max_depth - 1 - path.depth;
        let photons = map.for_depth(path.non_specular_depth);
        sink.record(|| PathEvent::PhotonGather { radius: photons.radius(path.camera_distance) });
        let point = GatherPoint { surface, bsdf, paths: path.split_factor, camera_distance: path.camera_distance };
        photons.gather(&point, max_specular_depth, |layer, value| {
            sink.add(layer, path.throughput * value);
        });
    }

    /// Samples the lights and the BSDF at a vertex and updates the path to leave it. Returns false if the path ends.
    #[inline(always)]
    pub fn scatter(
        &mut self,
        path: &mut PathState,
        point: &ShadingPoint<'_>,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let depth = path.depth;
        let [light_set, bsdf_set] = sampler.pair(Dimensions::Light { slot: 0, depth }, Dimensions::Bsdf { depth });
        self.sample_lights(path, point, sampler, &light_set, 1.0, sink);
        self.leave(path, point, 1.0, &bsdf_set, limits, sink)
    }

    /// Samples the BSDF at a vertex and updates the path to leave it. Returns false if the path ends.
    #[inline(always)]
    pub fn leave(
        &mut self,
        path: &mut PathState,
        point: &ShadingPoint<'_>,
        paths_per_light_sample: f32,
        bsdf_set: &sampler::Set,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let [lobe, roulette] = sampler::last_pair(bsdf_set);
        let sample = point.bsdf.sample(point.lobe_choice.unwrap_or(lobe), sampler::first_pair(bsdf_set));
        self.leave_along(path, point, paths_per_light_sample, (&sample, roulette), limits, sink)
    }

    /// Updates the path to leave a vertex along a sample of its BSDF. Returns false if the path ends.
    #[inline(always)]
    pub fn leave_along(
        &mut self,
        path: &mut PathState,
        point: &ShadingPoint<'_>,
        paths_per_light_sample: f32,
        (sample, roulette): (&Option<BsdfSample>, f32),
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let ShadingPoint { surface, bsdf, distance, outside, .. } = *point;
        let depth = path.depth;
        let Some(sample) = sample else {
            sink.record(|| PathEvent::End(PathEnd::Absorbed));
            return false;
        };
        let is_last = path.non_specular_depth >= limits.max_non_specular_depth;
        if is_last && !sample.specular {
            sink.record(|| PathEvent::End(PathEnd::Depth));
            return false;
        }

        // Update the throughput, the polarisation and the media
        path.throughput *= sample.weight;
        path.roulette_scale *= sample.eta_scale;
        path.sample_solid_angle = if sample.specular { 0.0 } else { 1.0 / sample.pdf };
        path.polarisation = sample.polarisation;
        if sample.is_transmission && !surface.is_thin {
            path.media.cross(surface.material, outside);
        }
        sink.record(|| PathEvent::BsdfSample {
            lobe: ScatteringKind::of(sample),
            direction: sample.direction,
            pdf: (!sample.specular).then_some(sample.pdf),
            weight: sample.weight,
            throughput: path.throughput,
        });

        // Update the densities for later MIS weights
        let origin = surface.spawn_origin(sample.direction);
        if sample.is_undeviated {
            path.mis_vertex.travelled += distance;
        } else if sample.specular {
            let is_caster = self.caster.scene.materials[surface.material as usize].is_caustic_caster();
            path.gather = path.gather.filter(|_| is_caster);
            let photons = path.gather.and_then(|gather| {
                let scene = self.caster.scene;
                let depth = path.non_specular_depth;
                let start_density = PhotonMap::start_density(self.photon_map, scene, depth, point.hit)?;
                Some(CausticMis::new(gather, surface, sample.direction, start_density))
            });
            path.mis_vertex.scatter_specular(surface, outside, sample.is_transmission, photons);
        } else {
            path.mis_vertex = MisVertex {
                ray_origin: origin,
                direction: sample.direction,
                pdf: Some(sample.pdf * paths_per_light_sample),
                samples_by_importance: self.samples_by_importance(),
                ..MisVertex::new(surface.position, bsdf.normal())
            };
            path.gather = self.photon_map.filter(|_| surface.strand.is_none()).map(|map| {
                let cos = sample.direction.dot(surface.geometric_normal).abs();
                let photons = map.for_depth(path.non_specular_depth);
                let photon_area = photons.area(path.camera_distance) * cos;
                GatherDensities { path_pdf: sample.pdf * path.split_factor, photon_area }
            });
            path.non_specular_depth += 1;
            let is_last = path.non_specular_depth >= limits.max_non_specular_depth || depth + 1 >= limits.max_depth;
            if is_last && !self.caster.scene.plan().has_area_emitters {
                sink.record(|| PathEvent::End(PathEnd::Depth));
                return false;
            }
        }

        // Play Russian roulette
        let survival = survival_probability(path.throughput, path.roulette_scale, depth);
        sink.record(|| PathEvent::Roulette { survival, u: roulette });
        if !survives(&mut path.throughput, survival, roulette) {
            sink.record(|| PathEvent::End(PathEnd::Roulette));
            return false;
        }

        // Spawn the next ray
        path.ray = Ray { origin, direction: sample.direction, t_max: f32::INFINITY };
        path.depth += 1;
        true
    }
}
