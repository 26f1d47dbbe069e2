//! Revision numbers of the open studio, one for each thing that is redrawn or rebuilt on its own.

use crate::scene::SceneChange;
use std::sync::atomic::{AtomicU64, Ordering};

/// Returns a number that no document has had; the empty document has 0.
fn next() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

/// Revision numbers of a document. Two equal numbers mean that nothing of that kind has changed between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Revisions {
    /// Anything of scene or assets.
    pub document: u64,
    /// Anything that a view of the studio shows; not names, locks and the like.
    pub image: u64,
    /// Geometry, materials and assets.
    pub surfaces: u64,
}

impl Revisions {
    /// New numbers for everything: another studio, or other assets.
    pub fn new() -> Self {
        let number = next();
        Revisions { document: number, image: number, surfaces: number }
    }

    /// Takes new numbers for what a change of the scene makes stale.
    pub fn note(&mut self, change: &SceneChange) {
        let number = next();
        self.document = number;
        if change.needs_redraw() {
            self.image = number;
        }
        if change.needs_surfaces() {
            self.surfaces = number;
        }
    }
}
