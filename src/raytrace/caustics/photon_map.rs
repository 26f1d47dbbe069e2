//! The photon map of one sample pass.

use super::gather_radius::GatherRadius;
use super::grid::PhotonGrid;
use super::mis::GatherDensities;
use super::photon::Photon;
use super::photon_pass::{MAX_PHOTONS, PhotonPass};
use super::photon_spacing::{MAX_FILLED_RADIUS_M, filled_radius};
use super::photon_tracer::PhotonTracer;
use super::start_density::StartDensity;
use super::view::CausticView;
use crate::raytrace::aggregate::Hit;
use crate::raytrace::bsdf::Bsdf;
use crate::raytrace::control::RenderControl;
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::Sampler;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;
use std::sync::Arc;

/// One more photon is traced for so many, for vertices that are seen by indirect light alone.
const SPARSE_STRIDE: u32 = 16;
/// Ratio of the gather radii for indirect light and for what the camera sees, where the photons for one are among those
/// for the other.
const SPARSE_RADIUS: f32 = 2.0;
/// Minimum cosine between the normals of a photon and of the vertex that gathers it.
const MIN_NORMAL_COSINE: f32 = 0.5;
/// Photons per task, which share a sequence of random numbers.
const TASK: u32 = 1 << 12;
/// Added to the seed, so that photons and pixels have different random numbers.
const SEED: u32 = 0x70_68_6f_74;
/// The same for the photons for indirect light.
const SPARSE_SEED: u32 = 0x69_6e_64_69;

/// The photons of a pass.
#[derive(Debug)]
pub struct PhotonMap {
    /// For vertices that the camera sees directly or through specular surfaces.
    pub(super) full: PhotonLookup,
    /// For vertices that are seen by indirect light.
    sparse: PhotonLookup,
}

/// Tasks of photons, side by side.
struct PhotonTasks {
    tasks: u32,
    /// Photons per task.
    photons: u32,
    seed: u32,
}

/// Photons with their gather radius.
#[derive(Debug)]
pub struct PhotonLookup {
    pub(super) grid: PhotonGrid,
    /// Number of emitted photons.
    emitted: f32,
    radius: GatherRadius,
    /// The view whose density of starts they have; none for uniform ones.
    view: Option<Arc<CausticView>>,
}

impl PhotonMap {
    /// Traces the photons of a pass on rayon's current pool. Incomplete if `control` is cancelled.
    pub fn trace(scene: &RenderScene, pass: &PhotonPass, view: &Arc<CausticView>, control: &RenderControl) -> Self {
        let tasks = (pass.photons.clamp(1, MAX_PHOTONS) as u32).div_ceil(TASK);
        let full = PhotonTasks { tasks, photons: TASK, seed: pass.seed ^ SEED };
        let sparse = PhotonTasks { tasks, photons: TASK / SPARSE_STRIDE, seed: pass.seed ^ SPARSE_SEED };
        let full_photons = full.trace(scene, pass, &view.starts, control);
        let sparse_photons = sparse.trace(scene, pass, &StartDensity::default(), control);
        let radius = GatherRadius::of_view(&full_photons, full.emitted(), view, pass);
        let sparse_radius = GatherRadius::of_indirect_light(&sparse_photons, pass);
        PhotonMap {
            full: PhotonLookup::new(full_photons, full.emitted() as f32, radius, Some(view.clone())),
            sparse: PhotonLookup::new(sparse_photons, sparse.emitted() as f32, sparse_radius, None),
        }
    }

    /// The map of photons that started uniformly, of which so many were emitted for one sample.
    pub fn uniform(photons: Vec<Photon>, emitted: u32) -> Self {
        let radius = filled_radius(&photons, 1).min(MAX_FILLED_RADIUS_M);
        let brighter = |photon: &Photon| Photon { flux: photon.flux * SPARSE_STRIDE as f32, ..*photon };
        let sparse = photons.iter().step_by(SPARSE_STRIDE as usize).map(brighter).collect();
        let lookup =
            |photons, emitted: f32, radius| PhotonLookup::new(photons, emitted, GatherRadius::constant(radius), None);
        PhotonMap {
            sparse: lookup(sparse, emitted as f32 / SPARSE_STRIDE as f32, SPARSE_RADIUS * radius),
            full: lookup(photons, emitted as f32, radius),
        }
    }

    /// The photons for a vertex after so many non-specular ones.
    pub fn for_depth(&self, non_specular_depth: u32) -> &PhotonLookup {
        if non_specular_depth == 0 { &self.full } else { &self.sparse }
    }
}

impl PhotonTasks {
    /// Number of emitted photons.
    fn emitted(&self) -> u32 {
        self.tasks * self.photons
    }

    /// Traces the photons of a pass. Incomplete if `control` is cancelled.
    fn trace(
        &self,
        scene: &RenderScene,
        pass: &PhotonPass,
        starts: &StartDensity,
        control: &RenderControl,
    ) -> Vec<Photon> {
        let trace_task = |task: u32| {
            let mut stored = Vec::new();
            if !control.is_cancelled() {
                let mut tracer = PhotonTracer::new(scene, starts);
                for index in 0..self.photons {
                    let sampler = Sampler::new(task, pass.first_sample, index, self.seed);
                    tracer.trace(&sampler, self.emitted(), &mut stored);
                }
                control.count(tracer.caster.rays, 0);
            }
            stored
        };
        let photons: Vec<Vec<Photon>> = (0..self.tasks).into_par_iter().map(trace_task).collect();
        photons.concat()
    }
}

impl PhotonLookup {
    fn new(photons: Vec<Photon>, emitted: f32, radius: GatherRadius, view: Option<Arc<CausticView>>) -> Self {
        PhotonLookup { grid: PhotonGrid::new(photons, radius.greatest()), emitted, radius, view }
    }

    /// Gather radius on a surface at so many metres from the camera, metres.
    pub fn radius(&self, distance: f32) -> f32 {
        self.radius.at(distance)
    }

    /// Gather area times the number of emitted photons, square metres: the expected number of gathered photons where
    /// the density of each is 1/m2.
    pub fn area(&self, distance: f32) -> f32 {
        let radius = self.radius.at(distance);
        PI * radius * radius * self.emitted
    }

    /// Density with which photons start at a hit, relative to a uniform one. None where no photons start.
    pub fn start_density(&self, scene: &RenderScene, hit: &Hit) -> Option<f32> {
        let uniform = StartDensity::default();
        scene.casters.relative_density(self.view.as_ref().map_or(&uniform, |view| &view.starts), hit)
    }

    /// Estimates the radiance that leaves a surface, so many metres from the camera, due to photons of at most
    /// `max_specular_depth`, layer by layer, weighted against the `paths` that leave the surface and may find the same
    /// light.
    pub fn gather(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        (paths, distance): (f32, f32),
        max_specular_depth: u32,
        mut add: impl FnMut(usize, Vec3),
    ) {
        let (radius, area) = (self.radius(distance), self.area(distance));
        let peak = 2.0 / (PI * radius * radius);
        let (mut layer, mut sum) = (0, Vec3::ZERO);
        self.grid.for_each_near(surface.position, radius, |photon, distance2| {
            if u32::from(photon.specular_depth) > max_specular_depth
                || photon.normal.dot(bsdf.normal()) < MIN_NORMAL_COSINE
            {
                return;
            }
            let (value, pdf) = bsdf.eval(photon.direction);
            if value == Vec3::ZERO {
                return;
            }
            let cos = photon.direction.dot(photon.normal);
            let densities = GatherDensities { path_pdf: pdf * paths, photon_area: area * cos };
            // Epanechnikov's kernel: 0 at the radius.
            let kernel = peak * (1.0 - distance2 / (radius * radius));
            let value = value * photon.flux * (kernel * (1.0 - densities.path_weight(photon.density)));
            if photon.layer != layer {
                add(usize::from(layer), std::mem::take(&mut sum));
                layer = photon.layer;
            }
            sum += value;
        });
        add(usize::from(layer), sum);
    }
}
