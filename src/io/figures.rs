//! The wardrobe's figures, as OBJ files embedded in the program and read like anybody's model.

use super::error::AssetError;
use super::obj;
use crate::figures;
use crate::scene::{Mannequin, Mesh};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The baked figures, in the order of [`figures::ALL`].
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

/// Figures that were read already: they never change, and reading one takes a noticeable part of a start.
static READ: LazyLock<Mutex<HashMap<Mannequin, Arc<Mesh>>>> = LazyLock::new(Mutex::default);

/// A figure's mesh.
pub(super) fn mesh(figure: Mannequin) -> Result<Arc<Mesh>, AssetError> {
    // A thread that panicked with the lock held has not harmed the map: it only ever grows by whole entries.
    let read = || READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(mesh) = read().get(&figure) {
        return Ok(Arc::clone(mesh));
    }
    // The lock is not held here, so that several figures are read at once.
    let wanted = figures::resolve(figure);
    let file = figures::ALL.iter().position(|baked| *baked == wanted).map(|i| FILES[i]);
    let mesh = file
        .and_then(obj::parse_embedded)
        .map(Arc::new)
        .ok_or(AssetError::NoFigure { figure: figure.figure, pose: figure.pose })?;
    read().insert(figure, Arc::clone(&mesh));
    Ok(mesh)
}
