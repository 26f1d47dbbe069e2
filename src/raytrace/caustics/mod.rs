//! Caustics by photon mapping: light that reaches a non-specular surface through mirrors and clear glass alone.
//!
//! A path from the camera finds such light by luck: the narrow cone in which a glass shows the lamp is one direction of
//! thousands, and a delta light is never hit. Photons start where light meets caustic casters and are stored on
//! non-specular surfaces (Jensen 1996), where every path gathers those within a small radius.
//!
//! Photons start mostly where they reach what the camera sees. The gather radius follows the width of a pixel there,
//! and is wider where there are few photons. Each sample pass has its own photons and a smaller radius, proportional to
//! (samples so far)^(-1/6): the blur vanishes, slower than the noise (Knaus and Zwicker 2011, "Progressive Photon
//! Mapping: A Probabilistic Approach").
//!
//! Photons and paths are weighted by their densities (Georgiev et al. 2012, "Light Transport Simulation with Vertex
//! Connection and Merging"), so that paths keep most of the light that they find well: by a narrow gloss, or of a large
//! softbox in a mirror.

mod casters;
mod gather_radius;
mod grid;
mod mis;
mod patch;
mod photon;
mod photon_map;
mod photon_pass;
mod photon_spacing;
mod photon_tasks;
mod photon_tracer;
mod start_density;
mod start_learner;
#[cfg(test)]
mod tests;
mod view;
mod visible_points;

pub use casters::CausticCasters;
pub use mis::{CausticMis, GatherDensities};
pub use photon::Photon;
pub use photon_map::{GatherPoint, PhotonMap};
pub use photon_pass::{MIN_PHOTONS, PhotonPass};
pub use photon_tracer::{PhotonReceiver, PhotonSegment, PhotonTracer};
pub use start_density::StartDensity;
pub use view::CausticView;
