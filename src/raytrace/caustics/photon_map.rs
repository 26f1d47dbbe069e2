//! The photon map of one sample pass.

use super::gather_radius::{GatherRadius, INDIRECT_SCALE};
use super::grid::HashGrid;
use super::mis::GatherDensities;
use super::photon::Photon;
use super::photon_pass::{MAX_PHOTONS, PhotonPass};
use super::photon_spacing::{MAX_FILLED_RADIUS_M, PhotonSpacing};
use super::photon_tasks::PhotonTasks;
use super::start_density::StartDensity;
use super::view::CausticView;
use crate::raytrace::aggregate::Hit;
use crate::raytrace::bsdf::Bsdf;
use crate::raytrace::control::RenderControl;
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::render_scene::RenderScene;
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// One more photon is traced for so many, for vertices that are seen by indirect light alone.
const SPARSE_STRIDE: u32 = 16;
/// Ratio of the gather radii for indirect light and for what the camera sees, where the photons for one are among those
/// for the other: the root of [`SPARSE_STRIDE`] for as many photons, times the scale for fewer.
const SPARSE_RADIUS: f32 = 4.0 * INDIRECT_SCALE;
/// Minimum cosine between the normals of a photon and of the vertex that gathers it.
const MIN_NORMAL_COSINE: f32 = 0.5;
/// Photons per task.
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

/// The vertex of a path that gathers photons.
#[derive(Debug)]
pub struct GatherPoint<'a> {
    /// The surface.
    pub surface: &'a SurfaceInteraction,
    /// Its BSDF.
    pub bsdf: &'a Bsdf<'a>,
    /// Number of paths that leave it.
    pub paths: f32,
    /// Length of the way from the camera, metres.
    pub camera_distance: f32,
}

/// Photons with their gather radius.
#[derive(Debug)]
pub struct PhotonLookup {
    pub(super) grid: HashGrid<Photon>,
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
        let set = pass.first_sample;
        let full = PhotonTasks { tasks, photons: TASK, set, seed: pass.seed ^ SEED };
        let sparse = PhotonTasks { tasks, photons: TASK / SPARSE_STRIDE, set, seed: pass.seed ^ SPARSE_SEED };
        let full_photons = full.trace::<Vec<Photon>>(scene, &view.starts, control).concat();
        let sparse_photons = sparse.trace::<Vec<Photon>>(scene, &StartDensity::default(), control).concat();
        let radius = GatherRadius::of_view(&full_photons, full.emitted(), view, pass);
        let sparse_radius = GatherRadius::of_indirect_light(&sparse_photons, sparse.emitted(), pass);
        PhotonMap {
            full: PhotonLookup::new(&full_photons, full.emitted() as f32, radius, Some(view.clone())),
            sparse: PhotonLookup::new(&sparse_photons, sparse.emitted() as f32, sparse_radius, None),
        }
    }

    /// The map of photons that started uniformly and of which so many were emitted for one sample.
    pub fn uniform(photons: Vec<Photon>, emitted: u32) -> Self {
        let radius = PhotonSpacing::new(&photons, emitted).filled_radius(emitted, 1).min(MAX_FILLED_RADIUS_M);
        let brighter = |photon: &Photon| Photon { flux: photon.flux * SPARSE_STRIDE as f32, ..*photon };
        let sparse: Vec<Photon> = photons.iter().step_by(SPARSE_STRIDE as usize).map(brighter).collect();
        let lookup = |photons: &[Photon], emitted: f32, radius| {
            PhotonLookup::new(photons, emitted, GatherRadius::constant(radius), None)
        };
        PhotonMap {
            sparse: lookup(&sparse, emitted as f32 / SPARSE_STRIDE as f32, SPARSE_RADIUS * radius),
            full: lookup(&photons, emitted as f32, radius),
        }
    }

    /// Returns the photons for a vertex after so many non-specular ones.
    pub fn for_depth(&self, non_specular_depth: u32) -> &PhotonLookup {
        if non_specular_depth == 0 { &self.full } else { &self.sparse }
    }

    /// Returns the density, relative to a uniform one, with which those photons start at a hit that a path's last
    /// non-specular vertex gathers, where it is at `non_specular_depth` now. Without a map, or without such a vertex,
    /// as at a meter's receptor, photons start uniformly. None where no photons start.
    pub fn start_density(map: Option<&Self>, scene: &RenderScene, non_specular_depth: u32, hit: &Hit) -> Option<f32> {
        match map.zip(non_specular_depth.checked_sub(1)) {
            Some((map, gathering)) => map.for_depth(gathering).start_density(scene, hit),
            None => scene.casters.relative_density(&StartDensity::default(), hit),
        }
    }
}

impl PhotonLookup {
    fn new(photons: &[Photon], emitted: f32, radius: GatherRadius, view: Option<Arc<CausticView>>) -> Self {
        PhotonLookup { grid: HashGrid::new(photons, radius.greatest()), emitted, radius, view }
    }

    /// Returns the gather radius on a surface at so many metres from the camera, metres.
    pub fn radius(&self, distance: f32) -> f32 {
        self.radius.at(distance)
    }

    /// Returns the gather area times the number of emitted photons, square metres: the expected number of gathered
    /// photons where the density of each is 1/m2.
    pub fn area(&self, distance: f32) -> f32 {
        let radius = self.radius.at(distance);
        PI * radius * radius * self.emitted
    }

    /// Returns the density with which photons start at a hit, relative to a uniform one. None where no photons start.
    fn start_density(&self, scene: &RenderScene, hit: &Hit) -> Option<f32> {
        let uniform = StartDensity::default();
        scene.casters.relative_density(self.view.as_ref().map_or(&uniform, |view| &view.starts), hit)
    }

    /// Estimates the radiance that leaves a vertex due to photons of at most `max_specular_depth`, layer by layer,
    /// weighted against the paths that leave it and may find the same light.
    pub fn gather(&self, point: &GatherPoint<'_>, max_specular_depth: u32, mut add: impl FnMut(usize, Vec3)) {
        let GatherPoint { surface, bsdf, paths, camera_distance } = *point;
        let (radius, area) = (self.radius(camera_distance), self.area(camera_distance));
        let peak = 2.0 / (PI * radius * radius);
        let (mut layer, mut sum) = (0, Vec3::ZERO);
        self.grid.near(surface.position, radius).for_each(|(photon, distance2)| {
            if u32::from(photon.specular_depth) > max_specular_depth
                || bsdf.normal_cosine(photon.normal) < MIN_NORMAL_COSINE
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
