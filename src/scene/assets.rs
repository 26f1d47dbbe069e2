//! The meshes and textures that a scene refers to, in memory. `io` loads them; renderers only read.

use super::{
    Emitter, EnvironmentMap, Figure, IntensityTable, Light, Mesh, Object, Scene, Shape, Tank, Texture, TextureRef,
    tessellate,
};
use glam::Vec3;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// A reference from a scene to an asset. Paths are relative to the scene file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AssetRef<'a> {
    /// A mesh file, by its path.
    Mesh(Cow<'a, str>),
    /// A figure.
    Figure(Box<Cow<'a, Figure>>),
    /// A texture, by its file.
    Texture(Cow<'a, TextureRef>),
    /// A photometric file, by its path.
    Photometry(Cow<'a, str>),
    /// A water tank.
    Tank(Box<Cow<'a, Tank>>),
    /// A picture of what surrounds the studio, by its path.
    Environment(Cow<'a, str>),
}

/// An asset reference that owns its path.
pub type AssetKey = AssetRef<'static>;

impl<'a> AssetRef<'a> {
    /// Returns the reference to a figure.
    pub fn figure(figure: Cow<'a, Figure>) -> Self {
        AssetRef::Figure(Box::new(figure))
    }

    /// Returns the reference to a water tank.
    pub fn tank(tank: Cow<'a, Tank>) -> Self {
        AssetRef::Tank(Box::new(tank))
    }

    /// Returns the same reference with a path of its own.
    pub fn into_owned(self) -> AssetKey {
        match self {
            AssetRef::Mesh(path) => AssetRef::Mesh(Cow::Owned(path.into_owned())),
            AssetRef::Figure(figure) => AssetRef::figure(Cow::Owned(figure.into_owned())),
            AssetRef::Texture(texture) => AssetRef::Texture(Cow::Owned(texture.into_owned())),
            AssetRef::Photometry(path) => AssetRef::Photometry(Cow::Owned(path.into_owned())),
            AssetRef::Tank(tank) => AssetRef::tank(Cow::Owned(tank.into_owned())),
            AssetRef::Environment(path) => AssetRef::Environment(Cow::Owned(path.into_owned())),
        }
    }

    /// Returns true for a water tank.
    pub fn is_tank(&self) -> bool {
        matches!(self, AssetRef::Tank(_))
    }

    /// Returns the path of the file that holds the asset; `None` for assets that are part of the program.
    pub fn path(&self) -> Option<&str> {
        match self {
            AssetRef::Mesh(path) | AssetRef::Photometry(path) | AssetRef::Environment(path) => Some(path),
            AssetRef::Figure(_) => None,
            AssetRef::Tank(tank) => tank.height_picture(),
            AssetRef::Texture(texture) => texture.path(),
        }
    }
}

/// A loaded asset, by kind.
#[derive(Clone, Debug)]
pub enum Asset {
    /// The triangles of a mesh file.
    Mesh(Arc<Mesh>),
    /// The meshes of a figure.
    Figure(FigureMeshes),
    /// An image.
    Texture(Arc<Texture>),
    /// A measured luminous intensity distribution.
    Photometry(Arc<IntensityTable>),
    /// The ground and the water of a tank.
    Tank(Arc<Mesh>),
    /// A picture of what surrounds the studio.
    Environment(Arc<EnvironmentMap>),
}

/// The meshes of a figure.
#[derive(Clone, Debug)]
pub struct FigureMeshes {
    /// For renders.
    pub fine: Arc<Mesh>,
    /// For the live view, with a quarter of the triangles.
    pub coarse: Arc<Mesh>,
}

impl FigureMeshes {
    /// Returns the coarse mesh for renders and the live view alike, with those parts of its strands that pass a test of
    /// their name.
    pub fn coarse_with_strands(&self, is_kept: impl Fn(&str) -> bool) -> FigureMeshes {
        let strands = self.coarse.strands.with_parts(is_kept);
        let mesh = Arc::new(Mesh { strands, ..Mesh::clone(&self.coarse) });
        FigureMeshes { fine: mesh.clone(), coarse: mesh }
    }
}

impl Asset {
    fn is_same(&self, other: &Asset) -> bool {
        match (self, other) {
            (Asset::Mesh(a), Asset::Mesh(b)) | (Asset::Tank(a), Asset::Tank(b)) => Arc::ptr_eq(a, b),
            (Asset::Texture(a), Asset::Texture(b)) => Arc::ptr_eq(a, b),
            (Asset::Figure(a), Asset::Figure(b)) => Arc::ptr_eq(&a.fine, &b.fine),
            (Asset::Photometry(a), Asset::Photometry(b)) => Arc::ptr_eq(a, b),
            (Asset::Environment(a), Asset::Environment(b)) => Arc::ptr_eq(a, b),
            (
                Asset::Mesh(_)
                | Asset::Texture(_)
                | Asset::Figure(_)
                | Asset::Photometry(_)
                | Asset::Tank(_)
                | Asset::Environment(_),
                _,
            ) => false,
        }
    }
}

/// The loaded assets of a scene. Cheap to clone: meshes and textures are shared.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    loaded: HashMap<AssetKey, Asset>,
}

impl Assets {
    /// Adds an asset, in the place of an earlier one with the same key. The asset must be of the key's kind: no getter
    /// finds another.
    pub fn insert(&mut self, key: AssetKey, asset: Asset) {
        self.loaded.insert(key, asset);
    }

    /// Takes an asset out.
    pub fn remove(&mut self, key: &AssetKey) {
        self.loaded.remove(key);
    }

    /// Adds the mesh of a mesh file.
    pub fn insert_mesh(&mut self, path: impl Into<String>, mesh: Arc<Mesh>) {
        self.insert(AssetRef::Mesh(Cow::Owned(path.into())), Asset::Mesh(mesh));
    }

    /// Adds a texture.
    pub fn insert_texture(&mut self, texture: TextureRef, image: Arc<Texture>) {
        self.insert(AssetRef::Texture(Cow::Owned(texture)), Asset::Texture(image));
    }

    /// Adds the distribution of a photometric file.
    pub fn insert_photometry(&mut self, path: impl Into<String>, table: Arc<IntensityTable>) {
        self.insert(AssetRef::Photometry(Cow::Owned(path.into())), Asset::Photometry(table));
    }

    /// Adds the picture of what surrounds the studio.
    pub fn insert_environment(&mut self, path: impl Into<String>, map: Arc<EnvironmentMap>) {
        self.insert(AssetRef::Environment(Cow::Owned(path.into())), Asset::Environment(map));
    }

    /// Adds all assets of another collection.
    pub fn extend(&mut self, other: Assets) {
        self.loaded.extend(other.loaded);
    }

    /// Returns the assets that another collection does not hold, or holds another one of.
    pub fn without(&self, other: &Assets) -> Self {
        let is_new = |(key, asset): &(&AssetKey, &Asset)| !other.get(key).is_some_and(|known| known.is_same(asset));
        Assets { loaded: self.iter().filter(is_new).map(|(key, asset)| (key.clone(), asset.clone())).collect() }
    }

    /// Replaces the meshes of every figure, such as by fewer triangles.
    #[must_use]
    pub fn map_figures(mut self, change: impl Fn(&FigureMeshes) -> FigureMeshes) -> Self {
        for asset in self.loaded.values_mut() {
            if let Asset::Figure(meshes) = asset {
                *meshes = change(meshes);
            }
        }
        self
    }

    /// Drops the figures and tanks that a scene does not refer to: each change of a parameter makes another.
    pub fn drop_unused_made(&mut self, scene: &Scene) {
        let is_used = |key: &AssetKey| match key {
            AssetRef::Figure(figure) => {
                scene.objects.iter().any(|o| matches!(&o.shape, Shape::Figure(used) if **used == ***figure))
            }
            AssetRef::Tank(tank) => {
                scene.objects.iter().any(|o| matches!(&o.shape, Shape::Tank(used) if **used == ***tank))
            }
            AssetRef::Mesh(_) | AssetRef::Texture(_) | AssetRef::Photometry(_) | AssetRef::Environment(_) => true,
        };
        self.loaded.retain(|key, _| is_used(key));
    }

    /// Returns true if the asset is loaded.
    pub fn contains(&self, asset: &AssetRef<'_>) -> bool {
        self.get(asset).is_some()
    }

    /// Returns true if some loaded asset comes from the file at this path.
    pub fn contains_file(&self, path: &str) -> bool {
        self.loaded.keys().any(|key| key.path() == Some(path))
    }

    /// Returns the mesh of a mesh file, by its path.
    pub fn mesh(&self, path: &str) -> Option<Arc<Mesh>> {
        self.get_mesh(&AssetRef::Mesh(Cow::Borrowed(path)))
    }

    /// Returns the meshes of a figure.
    pub fn figure(&self, figure: &Figure) -> Option<FigureMeshes> {
        match self.get(&AssetRef::figure(Cow::Borrowed(figure)))? {
            Asset::Figure(meshes) => Some(meshes),
            Asset::Mesh(_) | Asset::Texture(_) | Asset::Photometry(_) | Asset::Tank(_) | Asset::Environment(_) => None,
        }
    }

    /// Returns the mesh of a water tank.
    pub fn tank(&self, tank: &Tank) -> Option<Arc<Mesh>> {
        self.get_mesh(&AssetRef::tank(Cow::Borrowed(tank)))
    }

    /// Returns the distribution of a photometric file, by its path.
    pub fn photometry(&self, path: &str) -> Option<Arc<IntensityTable>> {
        match self.get(&AssetRef::Photometry(Cow::Borrowed(path)))? {
            Asset::Photometry(table) => Some(table),
            Asset::Mesh(_) | Asset::Texture(_) | Asset::Figure(_) | Asset::Tank(_) | Asset::Environment(_) => None,
        }
    }

    /// Returns the environment map of a light; none for one without, for one that is no surround, or whose file is not
    /// loaded.
    pub fn environment(&self, light: &Light) -> Option<Arc<EnvironmentMap>> {
        let path = light.environment_map.as_deref().filter(|_| light.emitter == Emitter::Surround)?;
        match self.get(&AssetRef::Environment(Cow::Borrowed(path)))? {
            Asset::Environment(map) => Some(map),
            Asset::Mesh(_) | Asset::Texture(_) | Asset::Figure(_) | Asset::Photometry(_) | Asset::Tank(_) => None,
        }
    }

    /// Returns the measured distribution of a light; none for one without a photometric file, or whose file is not
    /// loaded.
    pub fn intensity_table(&self, light: &Light) -> Option<Arc<IntensityTable>> {
        self.photometry(light.photometric_file.as_deref()?)
    }

    /// Returns a texture.
    pub fn texture(&self, texture: &TextureRef) -> Option<Arc<Texture>> {
        match self.get(&AssetRef::Texture(Cow::Borrowed(texture)))? {
            Asset::Texture(image) => Some(image),
            Asset::Mesh(_) | Asset::Figure(_) | Asset::Photometry(_) | Asset::Tank(_) | Asset::Environment(_) => None,
        }
    }

    /// Returns every loaded asset with its key, in no particular order.
    pub fn iter(&self) -> impl Iterator<Item = (&AssetKey, &Asset)> {
        self.loaded.iter()
    }

    /// Returns the triangles of a shape; `None` if its mesh is not loaded.
    pub fn mesh_of(&self, shape: &Shape) -> Option<Arc<Mesh>> {
        match shape {
            Shape::MeshFile { path } => self.mesh(path),
            Shape::Figure(figure) => self.figure(figure).map(|meshes| meshes.fine),
            Shape::Tank(tank) => self.tank(tank),
            primitive => tessellate(primitive).map(Arc::new),
        }
    }

    /// Returns the triangles of a shape as the live view draws it; see [`Assets::mesh_of`].
    pub fn coarse_mesh_of(&self, shape: &Shape) -> Option<Arc<Mesh>> {
        match shape {
            Shape::Figure(figure) => self.figure(figure).map(|meshes| meshes.coarse),
            other => self.mesh_of(other),
        }
    }

    /// Returns the axis-aligned box around an object in world space: lowest and highest corner. `None` if its mesh is
    /// not loaded.
    pub fn object_bounds(&self, object: &Object) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.coarse_mesh_of(&object.shape)?.bounds();
        let world_from_object = object.transform.world_from_object();
        let corner = |i: usize| Vec3::new([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2]);
        let corners = (0..8).map(|i| world_from_object.transform_point3(corner(i))).map(|p| (p, p));
        corners.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
    }

    /// Returns true if both collections share the very same meshes and textures under the same keys.
    pub fn is_same(&self, other: &Assets) -> bool {
        let same =
            |(key, asset): (&AssetKey, &Asset)| other.loaded.get(key).is_some_and(|theirs| asset.is_same(theirs));
        self.loaded.len() == other.loaded.len() && self.loaded.iter().all(same)
    }

    /// Returns an asset.
    pub fn get<'k>(&self, key: &AssetRef<'k>) -> Option<Asset> {
        // The map is covariant in its keys, so that a borrowed key needs no copy of its path.
        let loaded: &HashMap<AssetRef<'k>, Asset> = &self.loaded;
        loaded.get(key).cloned()
    }

    fn get_mesh(&self, key: &AssetRef<'_>) -> Option<Arc<Mesh>> {
        match self.get(key)? {
            Asset::Mesh(mesh) | Asset::Tank(mesh) => Some(mesh),
            Asset::Texture(_) | Asset::Figure(_) | Asset::Photometry(_) | Asset::Environment(_) => None,
        }
    }
}

/// Returns the reason why a scene can't name a file by this path; `None` for a usable one. A path is relative, has `/`
/// between folders, and does not lead out of the scene's folder.
pub fn path_complaint(path: &str) -> Option<&'static str> {
    if path.is_empty() {
        Some("a path is needed")
    } else if path.contains('\\') {
        Some("write / between folders")
    } else if path.starts_with('/') || path.chars().nth(1) == Some(':') {
        Some("a path must be relative to the studio's folder")
    } else if path.split('/').any(|part| part == "..") {
        Some("a path must not lead out of the studio's folder")
    } else if path.chars().any(char::is_control) {
        Some("a path has no control characters")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Arc<Texture> {
        Arc::new(Texture::opaque(1, 1, vec![[7; 3]]))
    }

    #[test]
    fn assets_of_different_kinds_with_one_path_are_kept_apart() {
        let path = "chair.glb";
        let embedded = |image| TextureRef::Embedded { model: path.to_owned(), image };
        let mut assets = Assets::default();
        assets.insert_mesh(path, Arc::new(Mesh::default()));
        assert!(assets.mesh(path).is_some());
        assert!(assets.texture(&TextureRef::file(path)).is_none());
        assets.insert_texture(embedded(1), image());
        assert!(assets.texture(&embedded(1)).is_some() && assets.texture(&embedded(0)).is_none());
        assert!(assets.contains_file(path) && !assets.contains_file("chair"));
        let figure = Figure::default();
        assert!(assets.figure(&figure).is_none());
        let (fine, coarse) = (Arc::new(Mesh::default()), Arc::new(Mesh::default()));
        let meshes = FigureMeshes { fine, coarse };
        assets.insert(AssetRef::figure(Cow::Owned(figure)), Asset::Figure(meshes));
        assert!(assets.mesh_of(&Shape::Figure(Box::new(figure))).is_some());
    }

    #[test]
    fn collections_are_the_same_only_if_they_share_what_they_hold() {
        let with = |image: &Arc<Texture>| {
            let mut assets = Assets::default();
            assets.insert_texture(TextureRef::file("a.png"), Arc::clone(image));
            assets
        };
        let (one, equal) = (image(), image());
        assert!(with(&one).is_same(&with(&one)));
        assert!(!with(&one).is_same(&with(&equal)));
        assert!(!with(&one).is_same(&Assets::default()));
        let mut both = with(&one);
        both.extend(with(&equal));
        assert!(both.is_same(&with(&equal)));
    }
}
