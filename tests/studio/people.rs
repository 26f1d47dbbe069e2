//! Shipped studios whose people have no hair, or coarse skin, for tests of renderers that draw either differently.

use catchlight::io::Loaded;
use catchlight::scene::{Asset, AssetKey, AssetRef, FigureMeshes, Mesh, Strands};
use std::sync::Arc;

/// Returns a studio whose people have no hair: strands are compared by tests of their own.
#[allow(dead_code, reason = "not every test crate compares pictures of fine meshes")]
pub fn hairless(loaded: Loaded) -> Loaded {
    with_meshes(loaded, |FigureMeshes { fine, coarse }| FigureMeshes { fine: bald(&fine), coarse: bald(&coarse) })
}

/// Returns a studio whose people have no hair, and are as coarse in renders as in the live view.
#[allow(dead_code, reason = "not every test crate draws the coarse mesh")]
pub fn coarse_and_hairless(loaded: Loaded) -> Loaded {
    with_meshes(loaded, |FigureMeshes { coarse, .. }| FigureMeshes { fine: bald(&coarse), coarse: bald(&coarse) })
}

fn bald(mesh: &Mesh) -> Arc<Mesh> {
    Arc::new(Mesh { strands: Strands::default(), ..mesh.clone() })
}

fn with_meshes(mut loaded: Loaded, change: impl Fn(FigureMeshes) -> FigureMeshes) -> Loaded {
    let keys: Vec<AssetKey> = loaded.assets.iter().map(|(key, _)| key.clone()).collect();
    for key in keys {
        if let AssetRef::Figure(figure) = &key
            && let Some(meshes) = loaded.assets.figure(figure)
        {
            loaded.assets.insert(key, Asset::Figure(change(meshes)));
        }
    }
    loaded
}
