//! The progress of files that are read, which another thread shows and can cancel.

use super::error::AssetError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Steps of the whole.
const STEPS: f32 = 1e6;

/// The progress of files that are read: a model, or a studio with all that it refers to.
#[derive(Debug)]
pub struct LoadProgress {
    whole: Arc<Whole>,
    /// Part of the whole that this one is, 0 to 1.
    weight: f32,
    /// Steps that it has reached.
    reached: AtomicU32,
}

/// What all parts share.
#[derive(Debug, Default)]
struct Whole {
    done: AtomicU32,
    is_cancelled: AtomicBool,
}

impl Default for LoadProgress {
    fn default() -> Self {
        LoadProgress { whole: Arc::default(), weight: 1.0, reached: AtomicU32::new(0) }
    }
}

impl LoadProgress {
    /// Returns the part of the whole that is done, 0 to 1.
    pub fn fraction(&self) -> f32 {
        (self.whole.done.load(Ordering::Relaxed) as f32 / STEPS).min(1.0)
    }

    /// Returns the progress of one of so many parts, which add up to this one. They are cancelled together.
    pub(super) fn part(&self, of: usize) -> Self {
        LoadProgress { whole: self.whole.clone(), weight: self.weight / of.max(1) as f32, ..Self::default() }
    }

    /// Ends the reading as soon as it looks: it fails then.
    pub fn cancel(&self) {
        self.whole.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns true once it is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.whole.is_cancelled.load(Ordering::Relaxed)
    }

    /// Notes that so much of this part is done, 0 to 1; it never goes back.
    ///
    /// # Errors
    /// If it is cancelled.
    pub(super) fn reach(&self, fraction: f32) -> Result<(), AssetError> {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is clamped")]
        let steps = (fraction.clamp(0.0, 1.0) * STEPS) as u32;
        let more = steps.saturating_sub(self.reached.fetch_max(steps, Ordering::Relaxed));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the weight is at most 1")]
        self.whole.done.fetch_add((more as f32 * self.weight) as u32, Ordering::Relaxed);
        if self.is_cancelled() { Err(AssetError::Cancelled) } else { Ok(()) }
    }

    /// As [`LoadProgress::reach`], for a number of so many between two parts.
    pub(super) fn reach_between(&self, [start, end]: [f32; 2], done: usize, of: usize) -> Result<(), AssetError> {
        self.reach(start + (end - start) * done as f32 / of.max(1) as f32)
    }
}

/// The part of an import that reading the file takes.
pub(super) const READING: [f32; 2] = [0.0, 0.3];
/// The part that parsing takes; normals are the rest.
pub(super) const PARSING: [f32; 2] = [0.3, 0.8];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{MODEL_FORMATS, import_model_with};

    #[test]
    fn parts_add_up_and_are_cancelled_together() {
        let whole = LoadProgress::default();
        let parts = [whole.part(2), whole.part(2)];
        parts[1].reach(1.0).unwrap();
        parts[1].reach(0.5).unwrap();
        assert!((whole.fraction() - 0.5).abs() < 1e-5);
        parts[0].part(4).reach(1.0).unwrap();
        assert!((parts[0].fraction() - 0.625).abs() < 1e-5);
        parts[0].cancel();
        assert!(whole.is_cancelled() && parts[1].reach(1.0).is_err());
    }

    #[test]
    fn an_import_of_every_format_ends_at_its_end_or_where_it_is_cancelled() {
        let folder = tempfile::tempdir().unwrap();
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement \
                   face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        let stl = "solid\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendsolid\n";
        let data = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
        let gltf = format!(
            r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}], "buffers": [{{"byteLength": 36, "uri": "{data}"}}]}}"#
        );
        let files = [("a.gltf", &*gltf), ("a.obj", obj), ("a.ply", ply), ("a.stl", stl)];
        assert_eq!(files.len(), MODEL_FORMATS.len());
        for (name, content) in files {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let progress = LoadProgress::default();
            let model = import_model_with(&path, &progress).unwrap();
            assert_eq!((model.mesh.triangles.len(), progress.fraction()), (1, 1.0), "{name}");
            progress.cancel();
            let error = import_model_with(&path, &progress).unwrap_err();
            assert!(matches!(error, AssetError::Cancelled), "{name}: {error}");
        }
    }
}
