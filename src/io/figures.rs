//! The shipped figures' meshes, from OBJ files embedded in the program.

use super::error::AssetError;
use super::obj;
use crate::figures;
use crate::scene::{Mannequin, Mesh};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The shipped files, in the order of [`figures::ALL`].
const FILES: [&[u8]; figures::ALL.len()] = [
    include_bytes!("../../assets/mannequins/woman_standing.obj"),
    include_bytes!("../../assets/mannequins/woman_contrapposto.obj"),
    include_bytes!("../../assets/mannequins/woman_seated.obj"),
    include_bytes!("../../assets/mannequins/woman_head_turned.obj"),
    include_bytes!("../../assets/mannequins/man_standing.obj"),
    include_bytes!("../../assets/mannequins/man_contrapposto.obj"),
    include_bytes!("../../assets/mannequins/man_seated.obj"),
    include_bytes!("../../assets/mannequins/man_head_turned.obj"),
    include_bytes!("../../assets/mannequins/child_standing.obj"),
    include_bytes!("../../assets/mannequins/child_contrapposto.obj"),
    include_bytes!("../../assets/mannequins/child_seated.obj"),
    include_bytes!("../../assets/mannequins/child_head_turned.obj"),
    include_bytes!("../../assets/mannequins/bust_standing.obj"),
    include_bytes!("../../assets/mannequins/bust_head_turned.obj"),
];

/// Meshes that are parsed already. They never change, and parsing one takes a noticeable part of the start-up time.
static CACHE: LazyLock<Mutex<HashMap<Mannequin, Arc<Mesh>>>> = LazyLock::new(Mutex::default);

/// Returns the mesh of a figure in a pose, parsed on first use.
pub(super) fn mesh(figure: Mannequin) -> Result<Arc<Mesh>, AssetError> {
    // A panic with the lock held leaves the map intact: it only grows, by whole entries.
    let cache = || CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(mesh) = cache().get(&figure) {
        return Ok(Arc::clone(mesh));
    }
    // Parse without the lock, so that several figures are parsed in parallel.
    let shipped = figures::resolve(figure);
    let file = figures::ALL.iter().position(|each| *each == shipped).map(|i| FILES[i]);
    let mesh = file
        .and_then(obj::parse_embedded)
        .map(Arc::new)
        .ok_or(AssetError::NoFigure { figure: figure.figure, pose: figure.pose })?;
    cache().insert(figure, Arc::clone(&mesh));
    Ok(mesh)
}
