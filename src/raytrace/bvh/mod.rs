//! Bounding volume hierarchies: built as binary trees by obvhs, collapsed to eight children a node, traversed by our
//! own code. One traversal serves triangles in a mesh and instances in the studio.

mod build;
mod collapse;
mod traverse;
mod wide;

pub use build::build;
pub use traverse::{Slabs, TraversalStack, WIDEN};
pub use wide::{Node, WideBvh};
