//! Shipped studios, also those whose people have no hair, or coarse skin, for tests of renderers that draw either
//! differently.

use catchlight::io::{Loaded, find_preset, presets};
use catchlight::raytrace::{GeometryCache, Purpose, RenderScene, prepare_for};
use catchlight::scene::{FigureMeshes, Mesh, Strands};
use std::sync::{Arc, LazyLock, OnceLock};

/// Returns a shipped studio. Each is loaded once by all tests of a crate: its people take the time.
pub fn shipped(name: &str) -> Loaded {
    static LOADED: LazyLock<Vec<OnceLock<Loaded>>> =
        LazyLock::new(|| presets().iter().map(|_| OnceLock::new()).collect());
    let wanted = find_preset(name).unwrap();
    let index = presets().iter().position(|preset| preset == wanted).unwrap();
    LOADED[index].get_or_init(|| wanted.load().unwrap()).clone()
}

/// Pixels on the longer side of the largest picture for which [`prepared`] prepares a studio.
pub const SMALL_PICTURE: u32 = 64;

/// Returns a shipped studio prepared for pictures of at most [`SMALL_PICTURE`] pixels. Each is prepared once by all tests
/// of a crate.
#[allow(dead_code, reason = "not every test crate traces shipped studios")]
pub fn prepared(name: &str) -> &'static RenderScene {
    static PREPARED: LazyLock<Vec<OnceLock<RenderScene>>> =
        LazyLock::new(|| presets().iter().map(|_| OnceLock::new()).collect());
    let wanted = find_preset(name).unwrap();
    let index = presets().iter().position(|preset| preset == wanted).unwrap();
    PREPARED[index].get_or_init(|| {
        let Loaded { scene, assets, .. } = shipped(name);
        let purpose = Purpose { picture: Some(scene.camera.picture_size(SMALL_PICTURE)), ..Purpose::default() };
        prepare_for(&scene, &assets, purpose, &GeometryCache::default()).unwrap()
    })
}

/// Returns a studio whose people have no hair: strands are compared by tests of their own.
#[allow(dead_code, reason = "not every test crate compares pictures of fine meshes")]
pub fn hairless(mut loaded: Loaded) -> Loaded {
    let bald = |mesh: &Mesh| Arc::new(Mesh { strands: Strands::default(), ..mesh.clone() });
    let bald = |meshes: &FigureMeshes| FigureMeshes { fine: bald(&meshes.fine), coarse: bald(&meshes.coarse) };
    loaded.assets = loaded.assets.map_figures(bald);
    loaded
}

/// Returns a studio whose people have no hair, and are as coarse in renders as in the live view.
#[allow(dead_code, reason = "not every test crate draws the coarse mesh")]
pub fn coarse_and_hairless(mut loaded: Loaded) -> Loaded {
    loaded.assets = loaded.assets.map_figures(|meshes| meshes.coarse_with_strands(|_| false));
    loaded
}
