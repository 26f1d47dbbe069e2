//! Scattering under the surface of soft materials such as skin and wax: a random walk in the body of the object.
//!
//! The coat reflects at the point where the path arrives; the diffuse lobe is replaced by a walk. Light enters with a
//! cosine distribution, scatters isotropically, and leaves with a cosine distribution where the walk meets the surface
//! of the same object: the boundary is matched in index, and [`medium`] finds the single-scattering albedo for which a
//! thick flat body has the base colour as its albedo. The coat's energy is shared as in [`super::bsdf`], with the
//! outgoing direction at the entry and the incident direction at the exit.
//!
//! A walk ends at its entry where it cannot leave by the object's soft surface: at parts of another material, at
//! surfaces that it meets from outside, as where a mesh overlaps itself or has an opening, and where the mean free path
//! is too short for the precision of positions. It has the light of the same walk in a half-space, so that the material
//! looks as without subsurface scattering: lids over eyes, lips over teeth. After [`walk::MAX_STEPS`] scattering
//! events, walks end at their entry with what is left of their light. Other objects inside of the body are ignored, and
//! surfaces seen from inside are diffuse. The method `direct` walks once, at the first non-specular surface; Whitted's
//! sees a diffuse surface.
//!
//! [`walk`] is the walk, `path` its place in a path.

mod medium;
mod path;
#[cfg(test)]
mod tests;
mod walk;
