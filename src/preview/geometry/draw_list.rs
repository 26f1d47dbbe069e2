//! The draw list of a frame: one surface record and one or more draw items per part of a mesh.

use super::caches::GeometryCaches;
use super::draw_item::{DrawItem, DrawPass, ShadowCasting, Sides, StrandItem};
use super::mesh_cache::{EmitterSurface, MeshKey};
use super::oriented_box::OrientedBox;
use super::strands::StrandShadows;
use super::surface::{
    FLAG_EMITTER, FLAG_GLOWS, FLAG_HOVERED, FLAG_RELIEF, FLAG_SELECTED, FLAG_SHORT_FIBRE, FLAG_SMOOTH_GLOSS, GpuDraw,
    GpuSurface, diffusion_m, packed_layers,
};
use crate::photo::PhotometricLight;
use crate::photo::emitter::EmitterShape;
use crate::preview::gpu::context::GpuContext;
use crate::preview::input::{Overlay, Pick};
use crate::preview::lights::light_table::{emission, picture_scale};
use crate::scene::{
    Alpha, Assets, BodyPiece, Fibre, FibreColor, Light, Material, MeshPart, Object, PlainBase, Scene, TextureRef,
    body_material,
};
use glam::{Affine3A, Vec3};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Mean length of strands under which they are short, metres: brows, lashes, stubble, crops.
const SHORT_STRAND_M: f32 = 0.02;

/// Everything that a frame draws. `surfaces`, `transforms`, `draws` and `picks` are indexed by surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawList {
    pub surfaces: Vec<GpuSurface>,
    /// World from object.
    pub transforms: Vec<Affine3A>,
    pub draws: Vec<GpuDraw>,
    /// The thing that a click on the surface selects.
    pub picks: Vec<Option<Pick>>,
    pub items: Vec<DrawItem>,
    /// Hair and the like.
    pub strands: Vec<StrandItem>,
    /// Boxes of the objects that cast shadows.
    pub casters: Vec<OrientedBox>,
    /// Hash of the meshes and transforms of all casters.
    pub caster_signature: u64,
    /// Boxes of the selected and hovered objects.
    pub outlined: Vec<OrientedBox>,
}

/// The GPU caches that a draw list fills, and the assets that it uploads.
pub(crate) struct Uploads<'a> {
    pub gpu: &'a GpuContext,
    pub caches: &'a mut GeometryCaches,
    pub assets: &'a Assets,
}

impl DrawList {
    /// Returns the sides of an item that are visible from `eye` (world space).
    pub fn sides(&self, item: &DrawItem, eye: Vec3) -> Sides {
        let outside = || self.casters.get(item.caster).is_some_and(|caster| !caster.may_contain(eye));
        match (item.pass, item.shadow) {
            (DrawPass::OneSided, _) => Sides::Room,
            (_, ShadowCasting::Solid) if outside() => Sides::Front,
            (_, ShadowCasting::MirroredSolid) if outside() => Sides::Back,
            _ => Sides::Both,
        }
    }

    /// Lists what a scene draws, uploading meshes and textures that the caches do not hold yet.
    pub fn new(scene: &Scene, overlay: &Overlay, uploads: &mut Uploads) -> Self {
        let mut list = DrawList::default();
        let mut signature = DefaultHasher::new();
        list.add_room(scene, uploads);
        list.add_objects(scene, overlay, uploads, &mut signature);
        list.add_bodies(scene, overlay, uploads, &mut signature);
        list.add_emitters(scene, uploads);
        list.caster_signature = signature.finish();
        // Sort by pass (opaque before glass), then by texture, to reduce state changes
        list.items.sort_by_key(|item| (item.pass as u32, item.textures));
        list
    }

    fn add_room(&mut self, scene: &Scene, uploads: &mut Uploads) {
        let Some(room) = &scene.room else { return };
        let Some(mesh) = uploads.caches.meshes.room(&uploads.gpu.device, room) else { return };
        let parts = uploads.caches.meshes.get(mesh).map(|m| m.parts.clone()).unwrap_or_default();
        for part in &parts {
            let material = room.material_of(&part.name);
            let surface = self.add_surface(&Affine3A::IDENTITY, material, scene, 0, None);
            self.add_item(mesh, part, surface, material, uploads);
            if let Some(item) = self.items.last_mut() {
                item.pass = DrawPass::OneSided;
            }
        }
    }

    fn add_objects(&mut self, scene: &Scene, overlay: &Overlay, uploads: &mut Uploads, signature: &mut impl Hasher) {
        for object in scene.objects.iter().filter(|object| object.visible) {
            let world_from_object = object.transform.world_from_object();
            if !world_from_object.is_finite() {
                continue;
            }
            let Some(mesh) = uploads.caches.meshes.object(&uploads.gpu.device, &object.shape, uploads.assets) else {
                continue;
            };
            let Some((parts, (low, high))) = uploads.caches.meshes.get(mesh).map(|m| (m.parts.clone(), m.bounds))
            else {
                continue;
            };
            let caster = OrientedBox { world_from_object, low, high, body_of: None };
            let pick = Pick::Object(object.id);
            let flags = outline_flags(overlay, pick);
            for part in &parts {
                let material = &*object.untraced_material_of(&part.name);
                let surface = self.add_surface(&world_from_object, material, scene, flags, Some(pick));
                self.add_item(mesh, part, surface, material, uploads);
                let Some(item) = self.items.last_mut() else { continue };
                let shadow = ShadowCasting::of(&object.shape, &world_from_object);
                if item.pass == DrawPass::Opaque {
                    (item.shadow, item.caster) = (shadow, self.casters.len());
                } else {
                    item.glass_sides = shadow.glass_sides();
                }
            }
            self.add_strands(scene, object, mesh, flags, uploads);
            if self.items.iter().rev().take(parts.len()).any(|item| item.shadow != ShadowCasting::None) {
                self.casters.push(caster);
                mesh.hash(signature);
                world_from_object.to_cols_array().map(f32::to_bits).hash(signature);
                for item in self.items.iter().rev().take(parts.len()).filter(|item| item.has_holes) {
                    let maps = self.draws[item.surface as usize].maps();
                    (&item.indices, item.textures, bytemuck::bytes_of(maps)).hash(signature);
                }
            }
            if flags != 0 {
                self.outlined.push(caster);
            }
        }
    }

    /// Adds the strands of an object, whose box is the next among the casters.
    fn add_strands(&mut self, scene: &Scene, object: &Object, mesh: MeshKey, flags: u32, uploads: &Uploads) {
        let strands = uploads.caches.meshes.get(mesh).and_then(|mesh| mesh.strands.as_ref());
        for part in strands.map(|strands| &strands.parts).into_iter().flatten() {
            let (material, world_from_object) = (object.material_of(&part.name), object.transform.world_from_object());
            let surface = self.add_surface(&world_from_object, material, scene, flags, Some(Pick::Object(object.id)));
            // Strands without a fibre material have the hair of a default fibre in their colour
            let color = |material: &Material| FibreColor::Dye(material.base_color);
            let fibre = material.fibre.unwrap_or(Fibre { color: color(material), ..Fibre::default() });
            let record = &mut self.surfaces[surface as usize];
            record.base_color = fibre.absorption_per_radius().into();
            record.diffusion_m = [0.0; 3];
            let is_short = part.mean_length_m < SHORT_STRAND_M;
            record.flags |= if is_short { FLAG_SHORT_FIBRE } else { 0 };
            (record.roughness, record.metallic) = (fibre.longitudinal_variance(), fibre.azimuthal_scale());
            let (instances, caster) = (part.instances.clone(), self.casters.len());
            let shadows = if is_short { StrandShadows::Sparse } else { StrandShadows::Dense };
            let mean_radius_m = part.mean_radius_m;
            self.strands.push(StrandItem { mesh, instances, mean_radius_m, shadows, surface, caster });
        }
    }

    /// Adds the bodies of lights. Those that the camera does not see cast shadows alone.
    fn add_bodies(&mut self, scene: &Scene, overlay: &Overlay, uploads: &mut Uploads, signature: &mut impl Hasher) {
        for (light, body) in scene.light_bodies() {
            let pick = Pick::Light(light.id);
            let flags = outline_flags(overlay, pick);
            for BodyPiece { shape, world_from_piece } in body.pieces() {
                let Some(mesh) = uploads.caches.meshes.body(&uploads.gpu.device, &shape) else { continue };
                let Some((parts, (low, high))) = uploads.caches.meshes.get(mesh).map(|m| (m.parts.clone(), m.bounds))
                else {
                    continue;
                };
                let caster = OrientedBox { world_from_object: world_from_piece, low, high, body_of: Some(light.id) };
                for part in &parts {
                    let material = body_material(&part.name);
                    let surface = self.add_surface(&world_from_piece, &material, scene, flags, Some(pick));
                    self.add_item(mesh, part, surface, &material, uploads);
                    let Some(item) = self.items.last_mut() else { continue };
                    (item.shadow, item.caster) = (ShadowCasting::Solid, self.casters.len());
                    item.pass = if body.is_seen { DrawPass::Opaque } else { DrawPass::Shadow };
                }
                self.casters.push(caster);
                mesh.hash(signature);
                world_from_piece.to_cols_array().map(f32::to_bits).hash(signature);
                if flags != 0 && body.is_seen {
                    self.outlined.push(caster);
                }
            }
        }
    }

    fn add_emitters(&mut self, scene: &Scene, uploads: &mut Uploads) {
        let is_seen = |light: &&Light| scene.camera_sees_light(light);
        for light in scene.lights.iter().filter(|light| light.on).filter(is_seen) {
            let (id, light) = (light.id, PhotometricLight::new(scene, uploads.assets, light));
            let (emitter, scale) = match light.shape {
                EmitterShape::Sphere { radius_m } => (EmitterSurface::Sphere, Vec3::splat(radius_m)),
                EmitterShape::Rect { half_size_m } => (EmitterSurface::Square, half_size_m.extend(1.0)),
                EmitterShape::Disc { radius_m } => (EmitterSurface::Disc, Vec3::new(radius_m, radius_m, 1.0)),
                EmitterShape::Point(_) | EmitterShape::Sun { .. } | EmitterShape::Surround => continue,
            };
            let Some(area_m2) = light.shape.projected_area_m2() else { continue };
            let world_from_emitter = light.world_from_light * Affine3A::from_scale(scale);
            let on_axis = light.measured().map_or(1.0, |measured| measured.factor(Vec3::NEG_Z));
            let luminance = picture_scale(&light, scene) * light.axial_intensity() * on_axis / area_m2;
            if !world_from_emitter.is_finite() || !luminance.is_finite() {
                continue;
            }
            let Some(mesh) = uploads.caches.meshes.emitter(&uploads.gpu.device, emitter) else { continue };
            let Some(parts) = uploads.caches.meshes.get(mesh).map(|m| m.parts.clone()) else { continue };
            let black = Material { base_color: [0.0; 3], ..Material::default() };
            let pick = Some(Pick::Light(id));
            let surface = self.add_surface(&world_from_emitter, &black, scene, FLAG_EMITTER, pick);
            self.surfaces[surface as usize].emission = luminance.into();
            for part in &parts {
                self.add_item(mesh, part, surface, &black, uploads);
                // The back of an emitter is not drawn
                if let Some(item) = self.items.last_mut() {
                    item.pass = DrawPass::OneSided;
                }
            }
        }
    }

    fn add_surface(
        &mut self,
        world_from_object: &Affine3A,
        material: &Material,
        scene: &Scene,
        flags: u32,
        pick: Option<Pick>,
    ) -> u32 {
        let glow = emission(material, scene);
        let glows = glow.is_finite() && glow.max_element() > 0.0;
        let PlainBase { base_color, roughness } = material.plain_base();
        let relief = match (material.has_relief(), material.has_smooth_gloss()) {
            (true, true) => FLAG_RELIEF | FLAG_SMOOTH_GLOSS,
            (true, false) => FLAG_RELIEF,
            (false, _) => 0,
        };
        let surface = GpuSurface {
            base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
            roughness: roughness.clamp(0.0, 1.0),
            emission: if glows { glow.into() } else { [0.0; 3] },
            metallic: material.metallic.clamp(0.0, 1.0),
            ior: material.ior.clamp(1.0, 4.0),
            transmission: material.transmission.clamp(0.0, 1.0),
            flags: flags | if glows { FLAG_GLOWS } else { 0 } | relief,
            layers: packed_layers(material),
            diffusion_m: diffusion_m(material),
            unused_1: 0,
        };
        self.draws.push(GpuDraw::new(self.surfaces.len() as u32, world_from_object, &surface, material));
        self.surfaces.push(surface);
        self.transforms.push(*world_from_object);
        self.picks.push(pick);
        self.surfaces.len() as u32 - 1
    }

    fn add_item(&mut self, mesh: MeshKey, part: &MeshPart, surface: u32, material: &Material, uploads: &mut Uploads) {
        let Uploads { gpu, caches, assets } = uploads;
        let image = |texture: &TextureRef| assets.texture(texture);
        let textures = caches.textures.ensure(&gpu.device, &gpu.queue, &material.textures, image);
        let glass = material.transmission > 0.0;
        self.items.push(DrawItem {
            mesh,
            indices: part.triangles.start * 3..part.triangles.end * 3,
            surface,
            textures,
            has_dome: material.dome().is_some(),
            has_holes: material.alpha != Alpha::Opaque && !glass,
            pass: if glass { DrawPass::Glass } else { DrawPass::Opaque },
            shadow: ShadowCasting::None,
            glass_sides: &[Sides::Both],
            caster: 0,
        });
    }
}

fn outline_flags(overlay: &Overlay, pick: Pick) -> u32 {
    let selected = if overlay.selects(pick) { FLAG_SELECTED } else { 0 };
    let hovered = if overlay.hovered == Some(pick) { FLAG_HOVERED } else { 0 };
    selected | hovered
}
