//! Bounding volume hierarchies with eight children a node.
//!
//! `build` builds a binary BVH with obvhs, `collapse` converts it to eight children a node, `wide` stores it,
//! `traverse` intersects rays with it. One traversal serves the triangles of a mesh (BLAS), the instances of the studio
//! (TLAS) and the emitters.

mod build;
mod collapse;
mod traverse;
mod wide;

pub use build::{BuildEffort, build};
pub use traverse::TraversalStack;
pub use wide::WideBvh;
