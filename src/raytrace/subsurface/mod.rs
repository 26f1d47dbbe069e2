//! Scattering under the surface of soft materials such as skin and wax: a random walk in the body of the object.
//!
//! The coat reflects at the point where the path arrives; the diffuse lobe is replaced by a walk. Light enters with a
//! cosine distribution, scatters isotropically, and leaves with a cosine distribution where the walk meets the surface
//! of the same object: the boundary is matched in index, and [`medium`] finds the single-scattering albedo for which a
//! thick flat body has the base colour as its albedo. The coat's energy is shared as in [`super::bsdf`], with the
//! outgoing direction at the entry and the incident direction at the exit.
//!
//! A walk ends at its entry, with what is left of its light, where it cannot leave by the object's soft surface: at
//! parts of another material, behind an opening of the mesh, after [`walk::MAX_STEPS`] scattering events, and where the
//! mean free path is too short for the precision of positions. No light is lost or gained there, and the material looks
//! as without subsurface scattering. Other objects inside of the body are ignored, and surfaces seen from inside are
//! diffuse. The method `direct` walks once, at the first non-specular surface; Whitted's sees a diffuse surface.
//!
//! [`walk`] is the walk, `path` its place in a path.

mod medium;
mod path;
#[cfg(test)]
mod tests;
mod walk;
