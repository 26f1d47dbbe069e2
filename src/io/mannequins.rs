//! The wardrobe's figures, as OBJ files embedded in the program and read like anybody's model.

use super::error::AssetError;
use super::obj;
use crate::scene::{Mannequin, Mesh};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// The baked figures.
const FILES: &[(Mannequin, &[u8])] = &[];

/// Figures that were read already: they never change, and reading one takes a noticeable part of a start.
static READ: LazyLock<Mutex<HashMap<Mannequin, Arc<Mesh>>>> = LazyLock::new(Mutex::default);

/// A figure's mesh.
pub(super) fn mesh(mannequin: Mannequin) -> Result<Arc<Mesh>, AssetError> {
    // A thread that panicked with the lock held has not harmed the map: it only ever grows by whole entries.
    let read = || READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(mesh) = read().get(&mannequin) {
        return Ok(Arc::clone(mesh));
    }
    // The lock is not held here, so that several figures are read at once.
    let file = FILES.iter().find(|(baked, _)| *baked == mannequin).map(|(_, file)| *file);
    let mesh = file.and_then(obj::read_shipped).map(Arc::new).ok_or_else(|| AssetError::BadModel {
        message: "this version has no such figure".to_owned(),
        path: format!("{:?} {:?}", mannequin.figure, mannequin.pose).into(),
    })?;
    read().insert(mannequin, Arc::clone(&mesh));
    Ok(mesh)
}
