//! A cache of BLASes, material tables and merged BLASes between calls of `prepare`: moving a light or an object
//! builds no BLAS of a mesh again.
//!
//! A mesh is found by its address, or else by its content: shapes such as boxes are tessellated anew each time. Meshes
//! of the last `prepare` are never evicted; of the others, [`MAX_UNUSED_TRIANGLES`] are kept.

use super::aggregate::MergedBlas;
use super::bsdf::{RoughnessTables, TracedMaterial};
use super::geometry::MeshGeometry;
use crate::scene::{Material, Mesh};
use rayon::prelude::*;
use rustc_hash::FxHasher;
use std::collections::HashMap;
use std::hash::Hasher;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of triangles and strand segments that are kept although the last scene did not use them: some 300 MB.
const MAX_UNUSED_TRIANGLES: usize = 2_000_000;

/// Number of merged BLASes that are kept.
const MAX_MERGED: usize = 3;

/// The BLASes, materials and merged BLASes of the last prepared scenes.
#[derive(Debug, Default)]
pub struct GeometryCache(Mutex<CacheState>);

#[derive(Debug, Default)]
struct CacheState {
    by_content: HashMap<u64, CachedGeometry>,
    /// Content hashes of the meshes in `by_content`, by address. An address is valid as long as the entry holds the
    /// mesh.
    by_address: HashMap<usize, u64>,
    /// Merged BLASes, the last used one at the end: live view, renders and meter have theirs about different origins.
    merged: Vec<Arc<MergedBlas>>,
    /// Materials of the last scene.
    materials: Vec<(Material, TracedMaterial)>,
    /// Number of calls of [`GeometryCache::geometries`]: the time of the LRU order.
    now: u64,
    builds: u64,
}

#[derive(Debug)]
struct CachedGeometry {
    geometry: Arc<MeshGeometry>,
    last_used: u64,
}

impl GeometryCache {
    /// Returns the number of BLASes that were built so far.
    pub fn builds(&self) -> u64 {
        self.lock().builds
    }

    fn lock(&self) -> MutexGuard<'_, CacheState> {
        // The state is consistent when a thread panics: at worst a BLAS is missing.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the geometry of each mesh by its address. Missing ones are built in parallel.
    pub(super) fn geometries(&self, meshes: &[Arc<Mesh>]) -> HashMap<*const Mesh, Arc<MeshGeometry>> {
        // Look up the meshes
        let hashes: Vec<u64> = meshes.iter().map(|mesh| self.content_hash(mesh)).collect();
        let found = meshes.iter().zip(&hashes).map(|(mesh, content)| self.find(mesh, *content));
        // Collect the missing ones; meshes of equal content share one geometry
        let mut missing: HashMap<u64, Arc<Mesh>> = HashMap::new();
        let mut geometries = HashMap::new();
        for ((mesh, &content), found) in meshes.iter().zip(&hashes).zip(found) {
            match found {
                Some(geometry) => drop(geometries.insert(Arc::as_ptr(mesh), geometry)),
                None => drop(missing.entry(content).or_insert_with(|| mesh.clone())),
            }
        }
        // Build them in parallel
        let missing: Vec<(u64, Arc<Mesh>)> = missing.into_iter().collect();
        let build = |(content, mesh): (u64, Arc<Mesh>)| (content, Arc::new(MeshGeometry::new(mesh)));
        let built: HashMap<u64, Arc<MeshGeometry>> = missing.into_par_iter().map(build).collect();
        for (mesh, content) in meshes.iter().zip(&hashes) {
            let Some(geometry) = built.get(content) else { continue };
            geometries.entry(Arc::as_ptr(mesh)).or_insert_with(|| geometry.clone());
        }
        self.store(&hashes, built);
        geometries
    }

    /// Returns the content hash of a mesh.
    fn content_hash(&self, mesh: &Arc<Mesh>) -> u64 {
        let known = self.lock().by_address.get(&address(mesh)).copied();
        known.unwrap_or_else(|| hash(mesh))
    }

    fn find(&self, mesh: &Arc<Mesh>, content: u64) -> Option<Arc<MeshGeometry>> {
        let geometry = self.lock().by_content.get(&content)?.geometry.clone();
        (Arc::ptr_eq(geometry.mesh(), mesh) || geometry.mesh() == mesh).then_some(geometry)
    }

    fn store(&self, used: &[u64], built: HashMap<u64, Arc<MeshGeometry>>) {
        let mut state = self.lock();
        state.now += 1;
        state.builds += built.len() as u64;
        let now = state.now;
        for (content, geometry) in built {
            state.by_address.insert(address(geometry.mesh()), content);
            state.by_content.insert(content, CachedGeometry { geometry, last_used: now });
        }
        for content in used {
            if let Some(entry) = state.by_content.get_mut(content) {
                entry.last_used = now;
            }
        }
        state.evict(MAX_UNUSED_TRIANGLES);
    }

    /// Returns a material of the last scene, with any texture.
    pub(super) fn material(&self, material: &Material) -> Option<TracedMaterial> {
        self.lock().materials.iter().find(|(known, _)| known == material).map(|(_, traced)| traced.clone())
    }

    /// Returns the directional albedos for every roughness that materials of the last scene have.
    pub(super) fn roughness_tables(&self) -> Vec<Arc<RoughnessTables>> {
        self.lock().materials.iter().filter_map(|(_, traced)| traced.roughness_tables().cloned()).collect()
    }

    /// Stores a scene's materials for the next `prepare`.
    pub(super) fn store_materials(&self, materials: impl Iterator<Item = (Material, TracedMaterial)>) {
        self.lock().materials = materials.collect();
    }

    /// Returns the merged BLASes of the last scenes.
    pub(super) fn merged(&self) -> Vec<Arc<MergedBlas>> {
        self.lock().merged.clone()
    }

    /// Stores a merged BLAS for the next calls of `prepare`.
    pub(super) fn store_merged(&self, merged: Arc<MergedBlas>) {
        let mut state = self.lock();
        state.merged.retain(|known| !Arc::ptr_eq(known, &merged));
        state.merged.push(merged);
        let surplus = state.merged.len().saturating_sub(MAX_MERGED);
        state.merged.drain(..surplus);
    }
}

impl CacheState {
    /// Evicts the least recently used meshes, so that at most `max_unused` triangles and segments remain that the last
    /// scene did not use.
    fn evict(&mut self, max_unused: usize) {
        let now = self.now;
        let mut unused: Vec<(u64, u64, usize)> = self
            .by_content
            .iter()
            .filter(|(_, entry)| entry.last_used < now)
            .map(|(content, entry)| (entry.last_used, *content, primitives(entry.geometry.mesh())))
            .collect();
        unused.sort_unstable_by_key(|(last_used, ..)| std::cmp::Reverse(*last_used));
        let mut triangles = 0;
        for (_, content, count) in unused {
            triangles += count;
            if triangles > max_unused {
                self.by_content.remove(&content);
            }
        }
        let by_content = &self.by_content;
        // The address of an evicted mesh may be reused by another.
        self.by_address.retain(|known_address, content| {
            by_content.get(content).is_some_and(|entry| address(entry.geometry.mesh()) == *known_address)
        });
    }
}

fn address(mesh: &Arc<Mesh>) -> usize {
    Arc::as_ptr(mesh) as usize
}

/// Returns the number of triangles and strand segments.
fn primitives(mesh: &Mesh) -> usize {
    mesh.triangles.len() + mesh.strands.points().len() - mesh.strands.len()
}

/// Returns a hash of everything that a mesh consists of. Fast, as figures have a million numbers, and not safe against
/// collisions made on purpose.
fn hash(mesh: &Mesh) -> u64 {
    let mut hasher = FxHasher::default();
    mesh.hash_content(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{LightMeter, prepare, prepare_kept};
    use crate::scene::{Assets, Emitter, Light, Object, ObjectId, Output, Room, Scene, Shape, Transform};
    use glam::Vec3;

    /// Returns a room with a sphere, a box, a model of 20 000 triangles and a light.
    fn studio() -> (Scene, Assets) {
        let shapes = [
            Shape::Sphere { radius_m: 0.3 },
            Shape::Box { size_m: Vec3::splat(0.4) },
            Shape::MeshFile { path: "hill.obj".to_owned() },
        ];
        let object = |(i, shape): (usize, Shape)| Object {
            id: ObjectId(i as u32),
            transform: Transform::at(Vec3::X * i as f32),
            ..Object::new(format!("Thing {i}"), shape)
        };
        let objects = shapes.into_iter().enumerate().map(object).collect();
        let lights = vec![Light::new(Emitter::Point, Output::Lumens(1000.0))];
        let mut assets = Assets::default();
        assets.insert_mesh("hill.obj", Arc::new(hill(100, 0.2)));
        (Scene { room: Some(Room::default()), objects, lights, ..Scene::default() }, assets)
    }

    fn hill(side: u32, height: f32) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..(side + 1) * (side + 1) {
            let (x, z) = ((i % (side + 1)) as f32 / side as f32, (i / (side + 1)) as f32 / side as f32);
            mesh.positions.push(Vec3::new(x, height * (7.0 * x).sin() * (9.0 * z).cos(), z));
        }
        for (x, z) in (0..side).flat_map(|x| (0..side).map(move |z| (x, z))) {
            let corner = z * (side + 1) + x;
            mesh.triangles.push([corner, corner + side + 1, corner + 1]);
            mesh.triangles.push([corner + 1, corner + side + 1, corner + side + 2]);
        }
        mesh.with_single_part("hill")
    }

    #[test]
    fn moved_objects_build_no_blas_and_changed_ones_do() {
        let (mut scene, mut assets) = studio();
        let cache = GeometryCache::default();
        let builds = |scene: &Scene, assets: &Assets| {
            let before = cache.builds();
            let merged = cache.merged();
            prepare_kept(scene, assets, &cache).unwrap();
            let after = cache.merged();
            let same_merged = merged.last().zip(after.last()).is_some_and(|(a, b)| Arc::ptr_eq(a, b));
            (cache.builds() - before, same_merged)
        };
        assert_eq!(builds(&scene, &assets), (4, false), "room, sphere, box, hill");
        scene.lights[0].position.x += 1.0;
        assert_eq!(builds(&scene, &assets), (0, true), "a moved light reuses everything");
        scene.objects[2].transform.position.x += 1.0;
        assert_eq!(builds(&scene, &assets), (0, true), "a moved model reuses the merged BLAS");
        scene.objects[1].transform.position.x += 1.0;
        assert_eq!(builds(&scene, &assets), (0, false), "a moved box rebuilds the merged BLAS only");
        scene.objects[1].shape = Shape::Box { size_m: Vec3::new(0.4, 0.5, 0.4) };
        assert_eq!(builds(&scene, &assets).0, 1, "another box is another mesh");
        assets.insert_mesh("hill.obj", Arc::new(hill(100, 0.3)));
        assert_eq!(builds(&scene, &assets).0, 1, "a file that changed on disk");
        assets.insert_mesh("hill.obj", Arc::new(hill(100, 0.3)));
        assert_eq!(builds(&scene, &assets).0, 0, "loaded again with equal content");
        assets.insert_mesh("hill.obj", Arc::new(hill(100, 0.2)));
        assert_eq!(builds(&scene, &assets).0, 0, "an undone change is still cached");
    }

    #[test]
    fn a_scene_renders_the_same_with_and_without_the_cache() {
        use crate::raytrace::{RenderControl, Settings, render};
        use std::ops::ControlFlow;
        let (mut scene, assets) = studio();
        scene.camera.position = Vec3::new(0.5, 1.0, 3.0);
        let cache = GeometryCache::default();
        prepare_kept(&scene, &assets, &cache).unwrap();
        scene.objects[1].transform.position.y += 0.2;
        scene.objects[2].transform.position.y += 0.1;
        let settings = Settings { width: 24, height: 16, spp: 2, ..Settings::default() };
        let picture = |prepared: &crate::raytrace::RenderScene| {
            let film = render(prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            film.develop(&scene)
        };
        let cached = picture(&prepare_kept(&scene, &assets, &cache).unwrap());
        assert_eq!(cached, picture(&prepare(&scene, &assets).unwrap()));
    }

    #[test]
    fn the_number_of_unused_triangles_is_bounded() {
        let cache = GeometryCache::default();
        let hills: Vec<Arc<Mesh>> = (0..8).map(|i| Arc::new(hill(20, 0.1 * i as f32))).collect();
        for hill in &hills {
            cache.geometries(std::slice::from_ref(hill));
        }
        let sizes = |cache: &GeometryCache| {
            let state = cache.lock();
            (state.by_content.len(), state.by_address.len())
        };
        assert_eq!((cache.builds(), sizes(&cache)), (8, (8, 8)));
        // Each has 800 triangles: two fit besides the one of the last call.
        cache.lock().evict(1700);
        assert_eq!(sizes(&cache), (3, 3));
        cache.geometries(&hills[5..8]);
        assert_eq!(cache.builds(), 8, "the most recently used are cached");
        cache.geometries(&hills[..1]);
        assert_eq!(cache.builds(), 9, "the least recently used are evicted");
    }

    #[test]
    fn a_meter_in_another_place_leaves_the_merged_blas_of_the_camera() {
        let (mut scene, assets) = studio();
        let cache = GeometryCache::default();
        let merged = || cache.merged().last().unwrap().clone();
        prepare_kept(&scene, &assets, &cache).unwrap();
        let of_camera = merged();
        LightMeter::kept(&scene, &assets, Vec3::new(0.3, 1.6, 0.2), &cache).unwrap();
        let of_meter = merged();
        assert!(!Arc::ptr_eq(&of_camera, &of_meter));
        // A light moves: both are found again
        scene.lights[0].position.x += 1.0;
        prepare_kept(&scene, &assets, &cache).unwrap();
        assert!(Arc::ptr_eq(&merged(), &of_camera));
        LightMeter::kept(&scene, &assets, Vec3::new(0.3, 1.6, 0.2), &cache).unwrap();
        assert!(Arc::ptr_eq(&merged(), &of_meter));
        // Those of former places go
        for x in 1..10 {
            LightMeter::kept(&scene, &assets, Vec3::X * x as f32, &cache).unwrap();
        }
        assert_eq!(cache.merged().len(), MAX_MERGED);
    }
}
