//! The path tracer: light at a camera ray, sample by sample, light by light.
//!
//! Unidirectional, with light sampling at every vertex and multiple importance sampling (Veach 1997, power heuristic)
//! where both techniques can find a light. `direct` is the same with one scattering event; mirrors and glass are passed
//! through in both. Emitters neither cast shadows nor stop light: only the camera sees them as solid from the front.
//!
//! Light sampling goes straight through thin panes, as light does. Through bodies of glass it goes straight, too, but only
//! for lights without a size, which no refracted ray would ever find: right for flat glass. What else mirrors and glass
//! throw on surfaces is gathered from photons, where there are any; without, light goes straight through curved glass, too.

use super::bsdf::{Bsdf, Polarisation};
use super::bvh::TraversalStack;
use super::caustics::{Gathered, PhotonMap, Rival};
use super::emitters::Vertex;
use super::geometry::SurfaceInteraction;
use super::lights::LightImportances;
use super::medium_stack::MediumStack;
use super::prepare::RenderScene;
use super::sampler::{self, Purpose, Sampler};
use super::sink::RadianceSink;
use crate::color::luminance;
use crate::math::Ray;
use glam::Vec3;

/// Which bounces are followed.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Scattering events at surfaces that are neither mirror nor glass.
    pub wide_bounces: u32,
    /// All events, mirrors and glass too.
    pub all_bounces: u32,
    /// Ways that are followed from the first surface that scatters widely; the way there is shared.
    pub branches: u32,
}

/// Bounces before roulette begins.
const ROULETTE_FROM: u32 = 3;
/// Surfaces of clear glass that the camera sees, one behind the other, at which both ways are followed: what shines in them
/// is bright, and a path that chose would find it once in twenty times.
const SPLITS: u32 = 3;
/// The largest number that a choice can be.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;
/// A way with less of the light than this does not branch any more.
const SMALL_SHARE: f32 = 0.25;

/// A thread's view of the scene with its scratch space and counters.
#[derive(Debug)]
pub struct Tracer<'a> {
    pub(super) scene: &'a RenderScene,
    /// Where photons bring caustics; without, paths find them.
    caustics: Option<&'a PhotonMap>,
    pub(super) stack: TraversalStack,
    /// Rays traced so far.
    pub rays: u64,
}

/// What a path carries from surface to surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    ray: Ray,
    pub(super) throughput: Vec3,
    /// What of the throughput roulette must not see: glass concentrates radiance by its index squared, branches share.
    roulette_scale: f32,
    pub(super) media: MediumStack,
    polarisation: Polarisation,
    vertex: Vertex,
    /// Where the last surface that scatters widely took photons, and all since were such as photons come by.
    gathered: Option<Gathered>,
    /// Ways that are followed from the surface where it is.
    ways: f32,
    /// Surfaces so far.
    pub(super) bounce: u32,
    /// Those of them that are neither mirror nor glass.
    pub(super) wide_bounces: u32,
}

/// Where a path scatters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'a> {
    pub(super) surface: &'a SurfaceInteraction,
    pub(super) bsdf: &'a Bsdf<'a>,
    /// What the lights give there, where they were computed already.
    pub(super) importances: Option<&'a LightImportances<'a>>,
    /// The choice between ways on, where it is made already, 0..1.
    choice: Option<f32>,
    /// From the surface before.
    distance: f32,
    /// On the side of the geometric normal.
    outside: bool,
}

/// What is done about the lights where a path scatters.
#[derive(Clone, Copy, Debug)]
enum Lights {
    /// They are sampled.
    Sample,
    /// That was done, once for so many ways on.
    Sampled { ways: f32 },
    /// None could be of use.
    Not,
}

impl<'a> Tracer<'a> {
    /// A tracer for one thread.
    pub fn new(scene: &'a RenderScene) -> Self {
        Tracer { scene, caustics: None, stack: TraversalStack::default(), rays: 0 }
    }

    /// The same with caustics from photons.
    pub fn with_caustics(scene: &'a RenderScene, caustics: Option<&'a PhotonMap>) -> Self {
        Tracer { caustics, ..Tracer::new(scene) }
    }

    /// Whether photons bring caustics.
    pub(super) fn has_caustics(&self) -> bool {
        self.caustics.is_some()
    }

    /// Follows a camera ray and gives every light's share to `sink`.
    pub fn trace(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl RadianceSink,
    ) {
        self.follow_path(origin, direction, sampler, limits, Vertex::new(origin, direction), sink);
    }

    /// The same for a receptor that has sampled the lights by itself: what of them is met straight on, through thin panes
    /// as well, is left out.
    pub fn trace_past_lights(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl RadianceSink,
    ) {
        // A density of next to nothing: the other technique has all the weight.
        let vertex = Vertex { pdf: Some(f32::MIN_POSITIVE), ..Vertex::new(origin, direction) };
        self.follow_path(origin, direction, sampler, limits, vertex, sink);
    }

    fn follow_path(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        sampler: &Sampler,
        limits: Limits,
        vertex: Vertex,
        sink: &mut impl RadianceSink,
    ) {
        let mut path = Path {
            ray: Ray { origin, direction, t_max: f32::INFINITY },
            throughput: Vec3::ONE,
            roulette_scale: 1.0,
            media: MediumStack::default(),
            polarisation: Polarisation::NONE,
            vertex,
            gathered: None,
            ways: 1.0,
            bounce: 0,
            wide_bounces: 0,
        };
        self.walk(&mut path, sampler, limits, sink);
    }

    /// Follows a path to its end, and all ways on from where it branches.
    fn walk(&mut self, path: &mut Path, sampler: &Sampler, limits: Limits, sink: &mut impl RadianceSink) {
        let scene = self.scene;
        loop {
            let hit = self.closest(&path.ray);
            let distance = hit.map_or(f32::INFINITY, |h| h.triangle.t);
            if path.bounce == 0 {
                if self.camera_sees_emitter(&path.ray, distance, sink) {
                    return;
                }
            } else {
                self.meet_emitters(&path.ray, distance, path.throughput, &path.vertex, &path.media, sink);
            }
            let Some(hit) = hit else { return };
            let surface = scene.aggregate.surface(&hit);
            let material = &scene.materials[surface.material as usize];
            let wo = -path.ray.direction;
            let outside = wo.dot(surface.geometric_normal) >= 0.0;
            if scene.plan().refraction {
                let begins_inside =
                    path.media.innermost().is_none() && material.transmits() && !outside && !surface.is_thin;
                path.throughput *= if begins_inside {
                    material.transmittance(distance)
                } else {
                    path.media.transmittance(&scene.materials, distance)
                };
            }
            if material.is_emissive() {
                let glow = scene.layers.len() - 1;
                sink.add(glow, path.throughput * material.emission * scene.glow_time_s);
            }
            // Straight through a pane a ray goes on after the last bounce, as light sampling there counts on.
            let ends = path.wide_bounces >= limits.wide_bounces;
            if path.bounce >= limits.all_bounces || (ends && !(surface.is_thin && material.transmits())) {
                return;
            }
            let bsdf = scene.bsdf(&surface, wo, &path.media, path.polarisation);
            let lit = material.has_non_specular_lobe() && !ends;
            let place = Place { surface: &surface, bsdf: &bsdf, importances: None, choice: None, distance, outside };
            let branches = if lit && path.wide_bounces == 0 { limits.branches } else { 1 };
            path.ways = branches as f32;
            if let (true, Some(map)) = (lit, self.caustics) {
                let bends = limits.all_bounces - 1 - path.bounce;
                map.of(path.wide_bounces).gather(&surface, &bsdf, path.ways, bends, |layer, value| {
                    sink.add(layer, path.throughput * value);
                });
            }
            if branches > 1 {
                self.branch(path, &place, branches, sampler, limits, sink);
                return;
            }
            if let (true, Some(reflectance)) =
                (path.bounce < SPLITS && path.wide_bounces == 0, bsdf.dielectric_reflectance())
            {
                self.split(path, &place, reflectance, sampler, limits, sink);
                return;
            }
            let lights = if lit { Lights::Sample } else { Lights::Not };
            if !self.scatter(path, &place, lights, sampler, limits, sink) {
                return;
            }
        }
    }

    /// Follows several ways on from a surface. Where all lights are sampled, once serves all ways.
    fn branch(
        &mut self,
        path: &mut Path,
        place: &Place<'_>,
        branches: u32,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl RadianceSink,
    ) {
        let ways = branches as f32;
        let mut importances = None;
        let lights = if self.samples_all(path) {
            let set = sampler.set(Purpose::Light { slot: 0, bounce: path.bounce });
            self.sample_lights(path, place, sampler, &set, ways, sink);
            Lights::Sampled { ways }
        } else {
            importances = self.light_importances(place);
            Lights::Sample
        };
        let place = &Place { importances: importances.as_ref(), ..*place };
        path.throughput /= ways;
        path.roulette_scale /= ways;
        for branch in 0..branches {
            let (mut path, sampler) = (*path, sampler.branch(branch, branches));
            if self.scatter(&mut path, place, lights, &sampler, limits, sink) {
                self.walk(&mut path, &sampler, Limits { branches: 1, ..limits }, sink);
            }
        }
    }

    /// Follows what clear glass reflects and what it lets through.
    fn split(
        &mut self,
        path: &Path,
        place: &Place<'_>,
        reflectance: f32,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl RadianceSink,
    ) {
        for (choice, share) in [(0.0, reflectance), (BELOW_ONE, 1.0 - reflectance)] {
            let branches = if share < SMALL_SHARE { 1 } else { limits.branches };
            let mut path = Path { throughput: path.throughput * share, ..*path };
            path.roulette_scale *= share;
            let place = &Place { choice: Some(choice), ..*place };
            if share > 0.0 && self.scatter(&mut path, place, Lights::Not, sampler, limits, sink) {
                self.walk(&mut path, sampler, Limits { branches, ..limits }, sink);
            }
        }
    }

    /// Samples the lights at a surface and takes the path on from there. False where it ends.
    #[inline(always)]
    fn scatter(
        &mut self,
        path: &mut Path,
        place: &Place<'_>,
        lights: Lights,
        sampler: &Sampler,
        limits: Limits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let Place { surface, bsdf, distance, outside, .. } = *place;
        let bounce = path.bounce;
        let before = path.vertex;
        let [light_set, set] = sampler.pair(Purpose::Light { slot: 0, bounce }, Purpose::Bsdf { bounce });
        let ways = match lights {
            Lights::Sample => {
                self.sample_lights(path, place, sampler, &light_set, 1.0, sink);
                1.0
            }
            Lights::Sampled { ways } => ways,
            Lights::Not => 1.0,
        };
        path.vertex = Vertex { one_light: !self.samples_all(path), ..Vertex::new(surface.position, bsdf.normal()) };
        let [lobe, roulette] = sampler::rest(&set);
        let Some(sample) = bsdf.sample(place.choice.unwrap_or(lobe), sampler::point(&set)) else { return false };
        let ends = path.wide_bounces >= limits.wide_bounces;
        if ends && !sample.is_undeviated {
            return false;
        }
        path.throughput *= sample.weight;
        path.roulette_scale *= sample.eta_scale;
        path.polarisation = sample.polarisation;
        if sample.is_transmission && !surface.is_thin {
            path.media.cross(surface.material, outside);
        }
        if sample.is_undeviated {
            path.vertex = Vertex { travelled: before.travelled + distance, ..before };
        } else if sample.specular {
            let bends = self.scene.materials[surface.material as usize].is_caustic_caster();
            path.gathered = path.gathered.filter(|_| bends);
            path.vertex.rival = path.gathered.map(|gathered| Rival::new(gathered, surface, sample.direction));
        } else {
            path.vertex.pdf = Some(sample.pdf * ways);
            path.gathered = self.caustics.map(|map| {
                let cos = sample.direction.dot(surface.geometric_normal).abs();
                Gathered { paths: sample.pdf * path.ways, photons: map.of(path.wide_bounces).area() * cos }
            });
            path.wide_bounces += 1;
            let last = path.wide_bounces >= limits.wide_bounces || bounce + 1 >= limits.all_bounces;
            if last && !self.scene.plan().emitters_have_size {
                return false;
            }
        }
        if !survives(&mut path.throughput, path.roulette_scale, bounce, roulette) {
            return false;
        }
        path.ray =
            Ray { origin: surface.spawn_origin(sample.direction), direction: sample.direction, t_max: f32::INFINITY };
        if !sample.is_undeviated {
            path.vertex.left_from = path.ray.origin;
        }
        path.bounce += 1;
        true
    }
}

/// Russian roulette by what is left of the light, without a `scale` that says nothing about it.
pub(super) fn survives(throughput: &mut Vec3, scale: f32, bounce: u32, u: f32) -> bool {
    let left = throughput.max_element() / scale;
    // NaN ends the path, as black does.
    if left.is_nan() || left <= 0.0 {
        return false;
    }
    if bounce < ROULETTE_FROM {
        return true;
    }
    let chance = left.min(0.95);
    if u >= chance {
        return false;
    }
    *throughput /= chance;
    luminance(*throughput).is_finite()
}
