//! The meshes of figures, built on first use.

use crate::figures;
use crate::scene::{Figure, FigureMeshes};
use std::sync::{LazyLock, Mutex, PoisonError};

/// Number of figures that are kept: some 30 MB each.
const CAPACITY: usize = 8;

/// The last meshes that were asked for, the latest last.
static CACHE: LazyLock<Mutex<Vec<(Figure, FigureMeshes)>>> = LazyLock::new(Mutex::default);

/// Returns the meshes of a figure.
pub(super) fn meshes(figure: &Figure) -> FigureMeshes {
    // A panic with the lock held leaves the list intact: it changes by whole entries.
    let cache = || CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    let known = cache().iter().find(|(known, _)| known == figure).map(|(_, meshes)| meshes.clone());
    // Build without the lock, so that several figures are built in parallel.
    let built: Vec<(Figure, FigureMeshes)> = if known.is_none() { cache().clone() } else { Vec::new() };
    let turned = || built.iter().find_map(|(other, meshes)| figures::build_from(other, meshes, figure));
    let meshes = known.or_else(turned).unwrap_or_else(|| figures::build(figure));
    let mut cache = cache();
    cache.retain(|(known, _)| known != figure);
    let excess = (cache.len() + 1).saturating_sub(CAPACITY);
    cache.drain(..excess);
    cache.push((*figure, meshes.clone()));
    meshes
}
