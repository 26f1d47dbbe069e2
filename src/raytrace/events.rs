//! The steps of a path, for the replay of a single sample.
//!
//! The tracer records positions in its own space, relative to its origin; a replay moves them to world space.
//! Contributions are white luminance, as on the film's layers; a throughput is a factor.

use super::bsdf::BsdfSample;
use glam::Vec3;
use serde::Serialize;

/// A step of the computation of one sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum PathEvent {
    /// The camera ray.
    CameraRay {
        /// Its origin.
        origin: Vec3,
        /// Its unit direction.
        direction: Vec3,
    },
    /// The path meets a surface.
    Vertex(PathVertex),
    /// The ray leaves the studio.
    Miss,
    /// The camera sees an emitter.
    VisibleEmitter {
        /// Index into the prepared lights.
        light: u32,
        /// Distance from the ray's origin, metres.
        distance: f32,
    },
    /// A scattered ray crosses an emitter.
    EmitterHit {
        /// Index into the prepared lights.
        light: u32,
        /// Distance from the vertex, metres; infinite for sun and surround.
        distance: f32,
        /// MIS weight of the path.
        mis_weight: f32,
    },
    /// The surface emits light.
    Emission,
    /// A light is sampled at the vertex.
    LightSample {
        /// Index into the prepared lights.
        light: u32,
        /// Probability with which the light was chosen.
        pmf: f32,
        /// Density of the direction, 1/sr; none for a delta light.
        pdf: Option<f32>,
        /// Density with which the BSDF samples the direction, 1/sr.
        bsdf_pdf: f32,
        /// Transmittance towards the light; 0 in shadow.
        visibility: Vec3,
        /// MIS weight of light sampling.
        mis_weight: f32,
    },
    /// Photons around the vertex are gathered.
    PhotonGather {
        /// Gather radius, metres.
        radius: f32,
    },
    /// Smoother gloss at the vertex is blurred to a roughness.
    BlurredGloss {
        /// The user's roughness, 0 to 1.
        roughness: f32,
    },
    /// The diffuse light of the vertex comes from the irradiance cache.
    CachedLight {
        /// Size of the cell, metres.
        cell_m: f32,
    },
    /// A direction is sampled from the BSDF.
    BsdfSample {
        /// The kind of scattering.
        lobe: ScatteringKind,
        /// Unit direction.
        direction: Vec3,
        /// Density, 1/sr; none for specular scattering.
        pdf: Option<f32>,
        /// BSDF times cosine over density.
        weight: Vec3,
        /// Path throughput after the vertex, before Russian roulette.
        throughput: Vec3,
    },
    /// The path walks under the surface and continues where it comes out.
    Subsurface {
        /// Position at which it comes out.
        position: Vec3,
        /// Number of rays of the walk.
        rays: u32,
        /// True if the walk did not find the surface and ends at its entry.
        at_entry: bool,
        /// Weight of the walk.
        weight: Vec3,
        /// Path throughput after the walk.
        throughput: Vec3,
    },
    /// Several paths continue from the vertex.
    PathSplit {
        /// Number of paths.
        paths: u32,
    },
    /// Reflection and transmission of clear glass are both followed.
    DielectricSplit {
        /// Part that is reflected.
        reflectance: f32,
    },
    /// The next of the paths that continue from the last split.
    Branch {
        /// Its index, from 0.
        index: u32,
    },
    /// Russian roulette.
    Roulette {
        /// Survival probability.
        survival: f32,
        /// The random number; the path ends if it is not less.
        u: f32,
    },
    /// The path ends.
    End(PathEnd),
    /// A contribution to the film.
    Contribution {
        /// Film layer.
        layer: usize,
        /// White luminance times exposure factors, as the layer counts; discarded unless finite.
        value: Vec3,
    },
}

impl PathEvent {
    /// The event with positions relative to `origin` moved to world space.
    pub fn into_world(self, origin: Vec3) -> Self {
        match self {
            PathEvent::CameraRay { origin: start, direction } => {
                PathEvent::CameraRay { origin: start + origin, direction }
            }
            PathEvent::Vertex(vertex) => PathEvent::Vertex(PathVertex { position: vertex.position + origin, ..vertex }),
            PathEvent::Subsurface { position, rays, at_entry, weight, throughput } => {
                PathEvent::Subsurface { position: position + origin, rays, at_entry, weight, throughput }
            }
            other => other,
        }
    }
}

/// A path vertex.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathVertex {
    /// Vertices before it.
    pub depth: u32,
    /// Position.
    pub position: Vec3,
    /// Distance from the last vertex, metres.
    pub distance: f32,
    /// Shading normal.
    pub normal: Vec3,
    /// Index into the scene's objects; none for the room.
    pub object: Option<u32>,
    /// Part of the object's mesh.
    pub part: String,
    /// Index into the prepared materials.
    pub material: u32,
    /// Path throughput at the vertex.
    pub throughput: Vec3,
}

/// A kind of scattering.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScatteringKind {
    /// Diffuse or glossy.
    NonSpecular,
    /// Mirror reflection.
    SpecularReflection,
    /// Refraction.
    SpecularTransmission,
    /// Transmission through a thin pane, without a change of direction.
    Pane,
}

impl ScatteringKind {
    /// Returns the kind of scattering of a sample.
    pub(super) fn of(sample: &BsdfSample) -> Self {
        match sample {
            BsdfSample { is_undeviated: true, .. } => ScatteringKind::Pane,
            BsdfSample { specular: true, is_transmission: true, .. } => ScatteringKind::SpecularTransmission,
            BsdfSample { specular: true, .. } => ScatteringKind::SpecularReflection,
            _ => ScatteringKind::NonSpecular,
        }
    }
}

/// The reason for the end of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PathEnd {
    /// The maximum depth is reached.
    Depth,
    /// No direction carries any light.
    Absorbed,
    /// Russian roulette.
    Roulette,
    /// All light of the vertex came from the irradiance cache.
    Cached,
}
