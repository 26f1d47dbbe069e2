//! From the scene that the user edits to flat tables that the tracer reads.

use super::aggregate::Aggregate;
use super::bsdf::{Boundary, Bsdf, Polarisation, TracedMaterial};
use super::caustics::Casters;
use super::film::{self, Layer};
use super::geometry::{Instance, SurfaceInteraction};
use super::geometry_cache::GeometryCache;
use super::lens::Lens;
use super::lights::{EmitterBvh, LightSampler, TracedLight};
use super::medium_stack::MediumStack;
use super::plan::RenderPlan;
use super::texture::TextureMap;
use crate::photo::{PhotometricLight, exposure};
use crate::scene::{self, Assets, Light, Material, Mesh, Scene, Severity, Shape};
use glam::{Affine3A, Vec3};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use thiserror::Error;

/// Why a scene cannot be rendered.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// The scene has an error that [`scene::validate`] finds.
    #[error("the scene cannot be rendered: {0}")]
    Invalid(String),
}

/// A scene ready for tracing. Positions are relative to the camera.
#[derive(Debug)]
pub struct RenderScene {
    pub(super) aggregate: Aggregate,
    pub(super) materials: Vec<TracedMaterial>,
    pub(super) textures: Vec<TextureMap>,
    pub(super) lights: Vec<TracedLight>,
    /// Chooses between them.
    pub(super) light_sampler: LightSampler,
    /// Finds those that a ray meets.
    pub(super) emitter_bvh: EmitterBvh,
    /// What throws caustics; empty where the plan sends no photons.
    pub(super) casters: Casters,
    pub(super) layers: Vec<Layer>,
    /// Time by which a layer's luminance counts in the exposure, seconds; 1 where it is already in.
    pub(super) layer_times: Vec<f32>,
    /// Seconds for which glowing surfaces count.
    pub(super) glow_time_s: f32,
    /// Picture value of one cd s/m2.
    pub(super) exposure: f32,
    pub(super) lens: Lens,
    pub(super) plan: RenderPlan,
}

impl RenderScene {
    /// What this scene needs, with reasons.
    pub fn plan(&self) -> &RenderPlan {
        &self.plan
    }

    /// Takes another plan, to see what a shortcut saves. Leaving out what the scene needs makes the picture wrong.
    pub fn set_plan(&mut self, plan: RenderPlan) {
        self.plan = plan;
    }

    /// Triangles in the studio, each instance counted.
    pub fn triangle_count(&self) -> u64 {
        self.aggregate.instances().iter().map(|i| i.geometry.mesh().triangles.len() as u64).sum()
    }

    /// Lights that are on.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// How a surface scatters towards `wo` (unit), for a viewer inside `media` who accepts this polarisation.
    pub(super) fn bsdf(
        &self,
        surface: &SurfaceInteraction,
        wo: Vec3,
        media: &MediumStack,
        polarisation: Polarisation,
    ) -> Bsdf<'_> {
        let material = &self.materials[surface.material as usize];
        let texture = material.texture.map_or(Vec3::ONE, |t| self.textures[t as usize].at(surface.uv));
        let bsdf = Bsdf::new(material, texture, surface.normal, surface.geometric_normal, wo);
        if !material.transmits() {
            return bsdf;
        }
        let outside = wo.dot(surface.geometric_normal) >= 0.0;
        let interface = || media.interface(&self.materials, surface.material, outside);
        bsdf.with_boundary(
            if surface.is_thin { Boundary::ThinPane } else { Boundary::Interface(interface()) },
            polarisation,
        )
    }

    /// What a fresh film of this scene looks like.
    pub(super) fn layers(&self) -> Vec<Layer> {
        self.layers.clone()
    }
}

/// Prepares a scene: trees, tables and the plan. Fails only for scenes that `validate` calls wrong; after it has
/// succeeded nothing in the tracer can fail.
pub fn prepare(scene: &Scene, assets: &Assets) -> Result<RenderScene, PrepareError> {
    prepare_around(scene, assets, scene.camera.position, film::assign_layers)
}

/// The same, with trees that an earlier call left in `cache`: meshes that did not change cost nothing.
pub fn prepare_kept(scene: &Scene, assets: &Assets, cache: &GeometryCache) -> Result<RenderScene, PrepareError> {
    prepare_all(scene, assets, scene.camera.position, film::assign_layers, cache)
}

/// How lights get the layers that they add to.
pub(super) type AssignLayers = fn(&Scene, &mut [(TracedLight, &Light)]) -> Vec<Layer>;

/// Prepares a scene with the tracer's origin at `eye`: what lies near it keeps the most digits.
pub(super) fn prepare_around(
    scene: &Scene,
    assets: &Assets,
    eye: Vec3,
    assign_layers: AssignLayers,
) -> Result<RenderScene, PrepareError> {
    prepare_all(scene, assets, eye, assign_layers, &GeometryCache::default())
}

/// The whole of it: around `eye`, with what `cache` holds.
pub(super) fn prepare_all(
    scene: &Scene,
    assets: &Assets,
    eye: Vec3,
    assign_layers: AssignLayers,
    cache: &GeometryCache,
) -> Result<RenderScene, PrepareError> {
    if let Some(error) = scene::validate(scene).into_iter().find(|f| f.severity == Severity::Error) {
        return Err(PrepareError::Invalid(format!("{}: {}", error.place, error.message)));
    }
    let mut tables = Tables::new(cache);
    let placed = place_everything(scene, assets, &mut tables);
    let geometries = cache.geometries(&unique(placed.iter().map(|p| &p.mesh)));
    let instances = placed
        .into_iter()
        .filter_map(|p| {
            let geometry = geometries.get(&Arc::as_ptr(&p.mesh))?.clone();
            let clear = p.materials.iter().any(|&m| tables.materials[m as usize].transmits());
            let is_thin = clear && !geometry.is_closed();
            let mut placed = Instance::new(geometry, relative_to(p.world_from_object, eye), p.object, p.materials)?;
            placed.is_thin = is_thin;
            Some(placed)
        })
        .collect();
    let (lights, layers) = trace_lights(scene, eye, assign_layers);
    let layer_times = layer_times(&lights, &layers);
    let lens = Lens::new(scene);
    let plan = RenderPlan::new(&tables.materials, &lights, lens.has_aperture());
    let aggregate = Aggregate::with_merged(instances, cache.merged());
    let casters = if plan.photons { Casters::new(&aggregate, &tables.materials) } else { Casters::default() };
    cache.store_merged(aggregate.merged().clone());
    cache.store_materials(tables.known.into_iter().zip(tables.materials.iter().cloned()));
    Ok(RenderScene {
        aggregate,
        materials: tables.materials,
        textures: tables.textures,
        light_sampler: LightSampler::new(&lights),
        emitter_bvh: EmitterBvh::new(&lights),
        casters,
        lights,
        layers,
        layer_times,
        glow_time_s: scene.camera.shutter_s,
        exposure: exposure::pixel_per_cd_s_m2(&scene.camera),
        lens,
        plan,
    })
}

/// Moves the origin to the camera, so that coordinates near it are small and exact.
pub(super) fn relative_to(mut transform: Affine3A, eye: Vec3) -> Affine3A {
    transform.translation -= glam::Vec3A::from(eye);
    transform
}

/// A mesh with its place and materials.
struct Placed {
    mesh: Arc<Mesh>,
    world_from_object: Affine3A,
    object: u32,
    materials: Vec<u32>,
}

/// Materials and textures, each once.
struct Tables<'a> {
    cache: &'a GeometryCache,
    materials: Vec<TracedMaterial>,
    known: Vec<Material>,
    textures: Vec<TextureMap>,
    texture_index: HashMap<String, u32>,
}

impl<'a> Tables<'a> {
    fn new(cache: &'a GeometryCache) -> Self {
        Tables { cache, materials: vec![], known: vec![], textures: vec![], texture_index: HashMap::new() }
    }

    fn material(&mut self, material: &Material, assets: &Assets) -> u32 {
        if let Some(index) = self.known.iter().position(|m| m == material) {
            return index as u32;
        }
        let texture = material.base_color_texture.as_ref().and_then(|path| self.texture(path, assets));
        self.known.push(material.clone());
        let mut traced = self.cache.material(material).unwrap_or_else(|| TracedMaterial::new(material, texture));
        traced.texture = texture;
        self.materials.push(traced);
        self.known.len() as u32 - 1
    }

    fn texture(&mut self, path: &str, assets: &Assets) -> Option<u32> {
        if let Some(&index) = self.texture_index.get(path) {
            return Some(index);
        }
        let texture = assets.textures.get(path)?;
        self.textures.push(TextureMap::new(texture));
        let index = self.textures.len() as u32 - 1;
        self.texture_index.insert(path.to_owned(), index);
        Some(index)
    }
}

fn place_everything(scene: &Scene, assets: &Assets, tables: &mut Tables<'_>) -> Vec<Placed> {
    let mut placed = Vec::new();
    if let Some(room) = &scene.room {
        let mesh = Arc::new(scene::room_mesh(room));
        let materials = mesh.parts.iter().map(|p| tables.material(room.material_of(&p.name), assets)).collect();
        placed.push(Placed { mesh, world_from_object: Affine3A::IDENTITY, object: u32::MAX, materials });
    }
    let mut round = RoundMeshes::default();
    for (index, object) in scene.objects.iter().enumerate().filter(|(_, o)| o.visible) {
        let Some((mesh, size)) = round.mesh_of(&object.shape, assets) else { continue };
        let materials = mesh.parts.iter().map(|p| tables.material(object.material_of(&p.name), assets)).collect();
        let world_from_object = object.transform.world_from_object() * Affine3A::from_scale(size);
        placed.push(Placed { mesh, world_from_object, object: index as u32, materials });
    }
    placed
}

/// One ball and one cylinder for all balls and cylinders: thousands of them fit in memory.
#[derive(Default)]
struct RoundMeshes {
    ball: Option<Arc<Mesh>>,
    cylinder: Option<Arc<Mesh>>,
}

impl RoundMeshes {
    /// A shape's mesh and the scale by which it becomes the shape.
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

/// Each mesh once.
fn unique<'a>(meshes: impl Iterator<Item = &'a Arc<Mesh>>) -> Vec<Arc<Mesh>> {
    let mut known = HashSet::new();
    meshes.filter(|mesh| known.insert(Arc::as_ptr(mesh))).cloned().collect()
}

fn trace_lights(scene: &Scene, eye: Vec3, assign_layers: AssignLayers) -> (Vec<TracedLight>, Vec<Layer>) {
    let traced = |light| Some((TracedLight::new(&PhotometricLight::new(scene, light), eye)?, light));
    let mut lights: Vec<(TracedLight, &Light)> = scene.lights.iter().filter(|l| l.on).filter_map(traced).collect();
    let layers = assign_layers(scene, &mut lights);
    (lights.into_iter().map(|(light, _)| light).collect(), layers)
}

fn layer_times(lights: &[TracedLight], layers: &[Layer]) -> Vec<f32> {
    let mut times = vec![1.0; layers.len()];
    for light in lights.iter().filter(|l| layers[l.layer].light.is_some()) {
        times[light.layer] = light.time_s;
    }
    times
}
