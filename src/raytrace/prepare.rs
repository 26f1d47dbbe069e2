//! Preparation: the scene that the user edits becomes the flat tables that the tracer reads.

use super::aggregate::Aggregate;
use super::bsdf::{RoughnessTables, TracedMaterial};
use super::caustics::CausticCasters;
use super::film::{self, Layer};
use super::geometry::{BodyInstance, Instance, MeshGeometry};
use super::geometry_cache::GeometryCache;
use super::lens::{Lens, PixelCamera};
use super::lights::{EmitterBvh, LightLanes, LightSampler, TracedLight};
use super::moments::{self, Moment};
use super::plan::RenderPlan;
use super::render_scene::{ROOM, RenderScene};
use super::strand_detail::StrandView;
use super::texture::TextureMap;
use crate::photo::{PhotometricLight, exposure};
use crate::scene::{
    self, Assets, Light, LightId, Material, Mesh, Scene, Severity, Shape, TexturePlacement, TextureRef, TextureSlot,
};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use thiserror::Error;

/// The reason why a scene cannot be rendered.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// The scene has an error that [`scene::validate`] finds.
    #[error("the scene cannot be rendered: {0}")]
    Invalid(String),
}

/// Prepares a scene: acceleration structures, tables and the plan. Fails only for scenes with errors in
/// [`scene::validate`]; after success nothing in the tracer can fail.
pub fn prepare(scene: &Scene, assets: &Assets) -> Result<RenderScene, PrepareError> {
    prepare_kept(scene, assets, &GeometryCache::default())
}

/// Prepares a scene with the acceleration structures that an earlier call left in `cache`: unchanged meshes cost
/// nothing.
pub fn prepare_kept(scene: &Scene, assets: &Assets, cache: &GeometryCache) -> Result<RenderScene, PrepareError> {
    prepare_for(scene, assets, Purpose::default(), cache)
}

/// What a scene is prepared for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Purpose {
    /// Pixels across and down of the pictures, which show no finer detail of hair; none for all strands.
    pub picture: Option<(u32, u32)>,
    /// Lights of one role share a film layer, which takes less memory than one for each light.
    pub shares_layers: bool,
}

/// As [`prepare_kept`], for a purpose.
pub fn prepare_for(
    scene: &Scene,
    assets: &Assets,
    purpose: Purpose,
    cache: &GeometryCache,
) -> Result<RenderScene, PrepareError> {
    let picture = purpose.picture.filter(|(width, height)| *width > 0 && *height > 0);
    let pixel_m = picture.map(|(width, height)| Lens::new(scene).film_camera(width, height).pixel_m());
    let viewpoint = Viewpoint {
        origin: scene.camera.position,
        // The camera is the origin
        view: pixel_m.map(|pixel_m| StrandView { position: Vec3::ZERO, pixel_m }),
    };
    let assign_layers = if purpose.shares_layers { film::share_layers } else { film::assign_layers };
    let mut prepared = prepare_all(scene, assets, &viewpoint, assign_layers, cache)?;
    let in_moment = |moment: &Moment| prepare_at(scene, assets, &viewpoint, assign_layers, cache, Some(moment));
    prepared.moments = moments::of(scene, assets).par_iter().map(in_moment).collect::<Result<_, _>>()?;
    if !prepared.moments.is_empty() {
        let reason = format!("water moves while it is lit: {} moments of the exposure", prepared.moments.len());
        prepared.plan.reasons.push(reason);
    }
    Ok(prepared)
}

/// Assigns each light its film layer.
pub(super) type AssignLayers = fn(&Scene, &mut [(TracedLight, &Light)]) -> Vec<Layer>;

/// From where a prepared scene is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Viewpoint {
    /// The tracer's origin, a world position near which coordinates are most precise.
    pub origin: Vec3,
    /// The camera for which strands are thinned; all strands without one.
    pub view: Option<StrandView>,
}

impl Viewpoint {
    /// Returns a viewpoint from which rays meet all strands.
    pub fn at(origin: Vec3) -> Self {
        Viewpoint { origin, view: None }
    }
}

/// Prepares a scene at one time, with a cache of acceleration structures.
pub(super) fn prepare_all(
    scene: &Scene,
    assets: &Assets,
    viewpoint: &Viewpoint,
    assign_layers: AssignLayers,
    cache: &GeometryCache,
) -> Result<RenderScene, PrepareError> {
    prepare_at(scene, assets, viewpoint, assign_layers, cache, None)
}

/// As [`prepare_all`], in a moment of the exposure.
fn prepare_at(
    scene: &Scene,
    assets: &Assets,
    &Viewpoint { origin, view }: &Viewpoint,
    assign_layers: AssignLayers,
    cache: &GeometryCache,
    moment: Option<&Moment>,
) -> Result<RenderScene, PrepareError> {
    if let Some(error) = scene::validate(&scene.without_variants()).into_iter().find(|f| f.severity == Severity::Error)
    {
        return Err(PrepareError::Invalid(format!("{}: {}", error.place, error.message)));
    }

    // Collect meshes and materials, and instantiate the meshes' acceleration structures
    let mut tables = Tables::new(cache);
    let placed = place_meshes(scene, assets, moment, &mut tables);
    let geometries = cache.geometries(&unique(placed.iter().map(|p| &p.mesh)));
    let with_geometry = |p: Placed| Some((geometries.get(&Arc::as_ptr(&p.mesh))?.clone(), p));
    let placed: Vec<(Arc<MeshGeometry>, Placed)> = placed.into_iter().filter_map(with_geometry).collect();
    let materials = &tables.materials;
    let instances = placed
        .into_par_iter()
        .filter_map(|(geometry, p)| {
            let clear = p.materials.iter().any(|&m| materials[m as usize].transmits());
            let is_thin = clear && !geometry.is_closed();
            let transform = relative_to(p.world_from_object, origin);
            let mut placed = Instance::new(geometry, transform, p.object, p.materials, view.as_ref())?;
            (placed.is_thin, placed.body) = (is_thin, p.body);
            Some(placed)
        })
        .collect();
    let aggregate = Aggregate::with_merged(instances, &cache.merged());
    cache.store_merged(aggregate.merged().clone());

    // Convert the lights and derive the plan
    let (mut lights, light_ids, layers) = convert_lights(scene, assets, origin, assign_layers);
    let layer_times = layer_times(&lights, &layers);
    if let Some(moment) = moment {
        for (traced, id) in lights.iter_mut().zip(&light_ids) {
            scene.light(*id).into_iter().for_each(|light| moment.dim(traced, light, &scene.camera));
        }
    }
    let continuous = moment.map_or(1.0, |moment| moment.of_continuous_light(&scene.camera));
    let lens = Lens::new(scene);
    let mut plan = RenderPlan::new(&tables.materials, &lights, &lens, aggregate.strand_count());
    plan.reasons.extend(aggregate.thinned_strands());
    let casters = match plan.photons {
        true => CausticCasters::new(&aggregate, &tables.materials),
        false => CausticCasters::default(),
    };
    cache.store_materials(tables.known.into_iter().zip(tables.materials.iter().cloned()));
    Ok(RenderScene {
        origin,
        aggregate,
        materials: tables.materials,
        textures: tables.textures,
        light_sampler: LightSampler::new(&lights),
        light_lanes: LightLanes::new(&lights),
        emitter_bvh: EmitterBvh::new(&lights),
        casters,
        lights,
        light_ids,
        layers,
        layer_times,
        emission_time_s: scene.camera.shutter_s * continuous,
        exposure: exposure::pixel_per_cd_s_m2(scene),
        lens,
        plan,
        moments: Vec::new(),
    })
}

/// Moves a transform's origin, so that coordinates near it are small and precise.
pub(super) fn relative_to(mut transform: Affine3A, origin: Vec3) -> Affine3A {
    transform.translation -= glam::Vec3A::from(origin);
    transform
}

/// A mesh with its transform and materials.
struct Placed {
    mesh: Arc<Mesh>,
    world_from_object: Affine3A,
    object: u32,
    materials: Vec<u32>,
    body: Option<BodyInstance>,
}

/// Materials and textures without duplicates.
struct Tables<'a> {
    cache: &'a GeometryCache,
    materials: Vec<TracedMaterial>,
    known: Vec<Material>,
    textures: Vec<TextureMap>,
    /// Indices into `textures`, by encoding and placement.
    texture_index: HashMap<TextureRef, Vec<(bool, TexturePlacement, u32)>>,
}

impl<'a> Tables<'a> {
    fn new(cache: &'a GeometryCache) -> Self {
        Tables { cache, materials: vec![], known: vec![], textures: vec![], texture_index: HashMap::new() }
    }

    fn material(&mut self, material: &Material, assets: &Assets) -> u32 {
        if let Some(index) = self.known.iter().position(|m| m == material) {
            return index as u32;
        }
        let textures = material
            .textures
            .look_up(|slot, texture| self.texture(texture, slot.is_srgb(), material.textures.placement(slot), assets));
        self.known.push(material.clone());
        let is_mapped = textures[TextureSlot::MetallicRoughness as usize].is_some();
        let cached = self.cache.material(material).filter(|known| known.roughness_tables().is_some() == is_mapped);
        let mut traced = cached.unwrap_or_else(|| {
            let mut traced = TracedMaterial::new(material);
            if is_mapped {
                traced.map_gloss(material, self.roughness_tables(material.ior));
            }
            traced
        });
        traced.textures = textures;
        self.materials.push(traced);
        self.known.len() as u32 - 1
    }

    /// Returns the directional albedos for every roughness, which materials of one index of refraction share.
    fn roughness_tables(&self, ior: f32) -> Arc<RoughnessTables> {
        let known = self.materials.iter().filter_map(TracedMaterial::roughness_tables);
        let known = known.cloned().chain(self.cache.roughness_tables()).find(|tables| tables.ior() == ior);
        known.unwrap_or_else(|| Arc::new(RoughnessTables::new(ior)))
    }

    fn texture(
        &mut self,
        texture: &TextureRef,
        is_srgb: bool,
        placement: &TexturePlacement,
        assets: &Assets,
    ) -> Option<u32> {
        let maps = self.texture_index.entry(texture.clone()).or_default();
        if let Some((.., index)) = maps.iter().find(|(srgb, known, _)| *srgb == is_srgb && known == placement) {
            return Some(*index);
        }
        self.textures.push(TextureMap::new(&assets.texture(texture)?, is_srgb, placement));
        let index = self.textures.len() as u32 - 1;
        maps.push((is_srgb, *placement, index));
        Some(index)
    }
}

/// The meshes of the room and of all visible objects, with their transforms and materials.
fn place_meshes(scene: &Scene, assets: &Assets, moment: Option<&Moment>, tables: &mut Tables<'_>) -> Vec<Placed> {
    let mut placed = Vec::new();
    if let Some(room) = &scene.room {
        let mesh = Arc::new(scene::room_mesh(room));
        let materials = mesh.parts.iter().map(|p| tables.material(room.material_of(&p.name), assets)).collect();
        placed.push(Placed { mesh, world_from_object: Affine3A::IDENTITY, object: ROOM, materials, body: None });
    }
    let mut round = RoundMeshes::default();
    for (index, object) in scene.objects.iter().enumerate().filter(|(_, o)| o.visible) {
        let Some((mesh, size)) = round.mesh_of(&object.shape, assets) else { continue };
        let mesh = moment.map_or_else(|| mesh.clone(), |moment| moment.moved(mesh.clone()));
        let materials = mesh.part_names().map(|part| tables.material(object.material_of(part), assets)).collect();
        let world_from_object = object.transform.world_from_object() * Affine3A::from_scale(size);
        placed.push(Placed { mesh, world_from_object, object: index as u32, materials, body: None });
    }
    place_bodies(scene, assets, tables, &mut placed);
    placed
}

/// Adds the bodies of the lights. Like the room, they are no objects.
fn place_bodies(scene: &Scene, assets: &Assets, tables: &mut Tables<'_>, placed: &mut Vec<Placed>) {
    for (light, body) in scene.light_bodies() {
        let instance = BodyInstance { light: light.id, is_hidden: !body.is_seen };
        for piece in body.pieces() {
            let mesh = Arc::new(piece.shape.mesh());
            let materials =
                mesh.part_names().map(|part| tables.material(&scene::body_material(part), assets)).collect();
            let world_from_object = piece.world_from_piece;
            placed.push(Placed { mesh, world_from_object, object: ROOM, materials, body: Some(instance) });
        }
    }
}

/// The meshes of a unit sphere and cylinder, shared by all spheres and cylinders: thousands of them fit in memory.
#[derive(Default)]
struct RoundMeshes {
    ball: Option<Arc<Mesh>>,
    cylinder: Option<Arc<Mesh>>,
}

impl RoundMeshes {
    /// Returns the mesh of a shape and the scale that makes it the shape.
    fn mesh_of(&mut self, shape: &Shape, assets: &Assets) -> Option<(Arc<Mesh>, Vec3)> {
        let (unit, slot, size) = match *shape {
            Shape::Sphere { radius_m } => (Shape::Sphere { radius_m: 1.0 }, &mut self.ball, Vec3::splat(radius_m)),
            Shape::Cylinder { radius_m, height_m } => {
                let unit = Shape::Cylinder { radius_m: 1.0, height_m: 1.0 };
                (unit, &mut self.cylinder, Vec3::new(radius_m, height_m, radius_m))
            }
            _ => return assets.mesh_of(shape).map(|mesh| (mesh, Vec3::ONE)),
        };
        if slot.is_none() {
            *slot = assets.mesh_of(&unit);
        }
        slot.clone().map(|mesh| (mesh, size))
    }
}

/// The meshes without duplicates.
fn unique<'a>(meshes: impl Iterator<Item = &'a Arc<Mesh>>) -> Vec<Arc<Mesh>> {
    let mut known = HashSet::new();
    meshes.filter(|mesh| known.insert(Arc::as_ptr(mesh))).cloned().collect()
}

/// Converts the lights that are on, assigns their layers, and returns the ids of the scene's lights with them.
fn convert_lights(
    scene: &Scene,
    assets: &Assets,
    origin: Vec3,
    assign_layers: AssignLayers,
) -> (Vec<TracedLight>, Vec<LightId>, Vec<Layer>) {
    let bodies: HashMap<LightId, bool> = scene.light_bodies().map(|(light, body)| (light.id, body.is_seen)).collect();
    let traced = |light: &'_ Light| {
        let traced = TracedLight::new(&PhotometricLight::new(scene, assets, light), origin)?;
        Some(match bodies.get(&light.id) {
            Some(is_seen) => traced.with_body(light.id, *is_seen),
            None => traced,
        })
    };
    let traced = |light| Some((traced(light)?, light));
    let mut lights: Vec<(TracedLight, &Light)> = scene.lights.iter().filter(|l| l.on).filter_map(traced).collect();
    let layers = assign_layers(scene, &mut lights);
    let (lights, ids) = lights.into_iter().map(|(light, source)| (light, source.id)).unzip();
    (lights, ids, layers)
}

/// Exposure time of each layer, seconds; 1 where its sums include it.
fn layer_times(lights: &[TracedLight], layers: &[Layer]) -> Vec<f32> {
    let mut times = vec![1.0; layers.len()];
    for light in lights.iter().filter(|l| layers[l.layer].light.is_some()) {
        times[light.layer] = light.time_s;
    }
    times
}
