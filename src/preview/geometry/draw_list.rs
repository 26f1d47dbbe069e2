//! What there is to draw: one record a surface for the shaders, one item a run of triangles for the passes.

use super::draw_uniforms::GpuDraw;
use super::mesh_cache::{EmitterSurface, MeshCache, MeshKey};
use super::texture_cache::{TextureCache, WHITE};
use crate::photo::exposure;
use crate::preview::input::{Overlay, Pick};
use crate::preview::lights::light_table::{emission, picture_scale};
use crate::preview::pipelines::Sides;
use crate::preview::shadows::layers::View;
use crate::scene::{Assets, Emitter, Material, MeshPart, Scene, Shape};
use bytemuck::{Pod, Zeroable};
use eframe::wgpu;
use glam::{Affine3A, Vec3, Vec4};
use std::f32::consts::PI;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The surface shines and is not lit; twin of the flag in `scene.wgsl`.
const FLAG_EMITTER: u32 = 1;
/// The surface glows besides being lit.
const FLAG_GLOWS: u32 = 2;
/// Outlined as selected.
const FLAG_SELECTED: u32 = 4;
/// Outlined as hovered.
const FLAG_HOVERED: u32 = 8;

/// One surface in a storage buffer; twin of `Surface` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuSurface {
    pub base_color: [f32; 3],
    pub roughness: f32,
    /// Picture units.
    pub emission: [f32; 3],
    pub metallic: f32,
    pub ior: f32,
    pub transmission: f32,
    pub flags: u32,
    pub unused: u32,
}

impl GpuSurface {
    pub fn glows(&self) -> bool {
        self.flags & FLAG_GLOWS != 0
    }

    pub fn is_emitter(&self) -> bool {
        self.flags & FLAG_EMITTER != 0
    }

    /// Marks in the id buffer; twin of `mark_of` in `scene.wgsl`.
    pub fn marks(&self) -> u32 {
        let mark = |flag: u32, bit: u32| if self.flags & flag != 0 { 1 << bit } else { 0 };
        mark(FLAG_SELECTED, 31) | mark(FLAG_HOVERED, 30)
    }
}

/// In which pass a run of triangles is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// Opaque, seen from both sides.
    Opaque,
    /// Opaque, seen from the front only: a camera outside looks into the room.
    OneSided,
    /// Clear glass or water: over the lit picture.
    Glass,
}

/// A run of triangles.
#[derive(Clone, Debug)]
pub(crate) struct DrawItem {
    pub mesh: MeshKey,
    pub indices: std::ops::Range<u32>,
    /// Index of its record, which is also its mark in the id buffer (plus one).
    pub record: u32,
    pub texture: usize,
    pub pass: Pass,
    pub shadow: Shadow,
    /// Which sides of glass are drawn, one after the other: of a solid the far ones first.
    pub glass: &'static [Sides],
    /// Index of its box among the casters, if it casts a shadow.
    pub caster: usize,
}

/// What of a run of triangles casts shadows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shadow {
    /// Nothing.
    Nothing,
    /// All of it: a sheet.
    Sheet,
    /// The sides turned away from the light: a solid, whose far side is nearest to what it touches, so that shadows are
    /// dark and sharp where it stands.
    Solid,
    /// The same for one that is mirrored by its scale.
    MirroredSolid,
}

impl Shadow {
    fn of(shape: &Shape, world_from_object: &Affine3A) -> Self {
        match shape {
            Shape::Plane { .. } | Shape::Sweep { .. } | Shape::MeshFile { .. } => Shadow::Sheet,
            Shape::Mannequin(_) | Shape::Box { .. } | Shape::Sphere { .. } | Shape::Cylinder { .. } => {
                let mirrored = world_from_object.matrix3.determinant() < 0.0;
                if mirrored { Shadow::MirroredSolid } else { Shadow::Solid }
            }
        }
    }
}

impl Shadow {
    /// The sides in the order in which glass of such a shape is drawn.
    fn glass(self) -> &'static [Sides] {
        match self {
            Shadow::Solid => &[Sides::Back, Sides::Front],
            Shadow::MirroredSolid => &[Sides::Front, Sides::Back],
            Shadow::Nothing | Shadow::Sheet => &[Sides::Both],
        }
    }
}

/// Corners of something that casts a shadow: its box in object space and its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Caster {
    pub world_from_object: Affine3A,
    pub low: Vec3,
    pub high: Vec3,
}

impl Caster {
    /// The box around the corners in world space.
    fn world_box(&self) -> (Vec3, Vec3) {
        let corners = self.corners();
        corners.iter().fold((corners[0], corners[0]), |(low, high), corner| (low.min(*corner), high.max(*corner)))
    }

    /// Distance from a point to that box, metres.
    pub fn distance(&self, point: Vec3) -> f32 {
        let (low, high) = self.world_box();
        point.clamp(low, high).distance(point)
    }

    /// Whether a point may lie inside: it does in the box around the corners, and a little beyond.
    fn may_hold(&self, point: Vec3) -> bool {
        let (low, high) = self.world_box();
        let margin = Vec3::splat(0.02);
        point.cmpge(low - margin).all() && point.cmple(high + margin).all()
    }

    /// The eight corners in world space.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            let corner = Vec3::new(
                pick(0, self.low.x, self.high.x),
                pick(1, self.low.y, self.high.y),
                pick(2, self.low.z, self.high.z),
            );
            self.world_from_object.transform_point3(corner)
        })
    }
}

impl DrawList {
    /// Which sides of an item can be seen from `eye`.
    pub fn sides(&self, item: &DrawItem, eye: Vec3) -> Sides {
        let outside = || self.casters.get(item.caster).is_some_and(|caster| !caster.may_hold(eye));
        match (item.pass, item.shadow) {
            (Pass::OneSided, _) => Sides::Room,
            (_, Shadow::Solid) if outside() => Sides::Front,
            (_, Shadow::MirroredSolid) if outside() => Sides::Back,
            _ => Sides::Both,
        }
    }

    /// Changes when what a view sees of all that casts shadows does.
    pub fn seen_by(&self, view: &View) -> u64 {
        let mut hasher = DefaultHasher::new();
        for item in self.items.iter().filter(|item| item.shadow != Shadow::Nothing && self.is_seen(item, view)) {
            (item.mesh, &item.indices, item.shadow as u32).hash(&mut hasher);
            self.casters[item.caster].world_from_object.to_cols_array().map(f32::to_bits).hash(&mut hasher);
        }
        hasher.finish()
    }

    /// Whether a view may see something of an item's box.
    pub fn is_seen(&self, item: &DrawItem, view: &View) -> bool {
        let Some(caster) = self.casters.get(item.caster) else { return false };
        if !view.reaches(caster.distance(view.eye)) {
            return false;
        }
        let corners = caster.corners().map(|corner| view.clip_from_world * corner.extend(1.0));
        let beyond = |outside: fn(Vec4) -> bool| corners.iter().all(|corner| outside(*corner));
        !(beyond(|c| c.x > c.w) || beyond(|c| c.x < -c.w) || beyond(|c| c.y > c.w) || beyond(|c| c.y < -c.w))
    }
}

/// Everything a frame draws.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawList {
    pub records: Vec<GpuSurface>,
    /// Of each record: where it stands, and what its draw reads.
    pub places: Vec<Affine3A>,
    pub draws: Vec<GpuDraw>,
    /// What a click on each record means.
    pub owners: Vec<Option<Pick>>,
    pub items: Vec<DrawItem>,
    pub casters: Vec<Caster>,
    /// Changes when anything that casts a shadow does.
    pub caster_signature: u64,
    /// World boxes of what is outlined.
    pub outlined: Vec<Caster>,
}

/// The device and the caches that a draw list fills.
pub(crate) struct Uploads<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub meshes: &'a mut MeshCache,
    pub textures: &'a mut TextureCache,
    pub assets: &'a Assets,
}

impl DrawList {
    pub fn new(scene: &Scene, overlay: &Overlay, uploads: &mut Uploads) -> Self {
        let mut list = DrawList::default();
        let mut signature = DefaultHasher::new();
        list.add_room(scene, uploads);
        list.add_objects(scene, overlay, uploads, &mut signature);
        list.add_emitters(scene, uploads);
        list.caster_signature = signature.finish();
        // Few state changes: opaque before glass, then by texture and mesh.
        list.items.sort_by_key(|item| (item.pass as u32, item.texture));
        list
    }

    fn add_room(&mut self, scene: &Scene, uploads: &mut Uploads) {
        let Some(room) = &scene.room else { return };
        let Some(mesh) = uploads.meshes.room(uploads.device, room) else { return };
        let parts = uploads.meshes.get(mesh).map(|m| m.parts.clone()).unwrap_or_default();
        for part in &parts {
            let material = room.material_of(&part.name);
            let record = self.add_record(&Affine3A::IDENTITY, material, scene, 0, None);
            self.add_item(mesh, part, record, material, uploads);
            if let Some(item) = self.items.last_mut() {
                item.pass = Pass::OneSided;
            }
        }
    }

    fn add_objects(&mut self, scene: &Scene, overlay: &Overlay, uploads: &mut Uploads, signature: &mut impl Hasher) {
        for object in scene.objects.iter().filter(|object| object.visible) {
            let world_from_object = object.transform.world_from_object();
            if !world_from_object.is_finite() {
                continue;
            }
            let Some(mesh) = uploads.meshes.object(uploads.device, &object.shape, uploads.assets) else { continue };
            let Some((parts, (low, high))) = uploads.meshes.get(mesh).map(|m| (m.parts.clone(), m.bounds)) else {
                continue;
            };
            let caster = Caster { world_from_object, low, high };
            let pick = Pick::Object(object.id);
            let flags = outline_flags(overlay, pick);
            for part in &parts {
                let material = object.material_of(&part.name);
                let record = self.add_record(&world_from_object, material, scene, flags, Some(pick));
                self.add_item(mesh, part, record, material, uploads);
                let Some(item) = self.items.last_mut() else { continue };
                let shadow = Shadow::of(&object.shape, &world_from_object);
                if item.pass == Pass::Opaque {
                    (item.shadow, item.caster) = (shadow, self.casters.len());
                } else {
                    item.glass = shadow.glass();
                }
            }
            if self.items.iter().rev().take(parts.len()).any(|item| item.shadow != Shadow::Nothing) {
                self.casters.push(caster);
                mesh.hash(signature);
                world_from_object.to_cols_array().map(f32::to_bits).hash(signature);
            }
            if flags != 0 {
                self.outlined.push(caster);
            }
        }
    }

    fn add_emitters(&mut self, scene: &Scene, uploads: &mut Uploads) {
        for light in scene.lights.iter().filter(|light| light.on && light.visible_to_camera) {
            let (surface, scale, area_m2) = match light.emitter {
                Emitter::Sphere { radius_m } => {
                    (EmitterSurface::Sphere, Vec3::splat(radius_m), PI * radius_m * radius_m)
                }
                Emitter::RectPanel { width_m, height_m } => {
                    let half = Vec3::new(0.5 * width_m, 0.5 * height_m, 1.0);
                    (EmitterSurface::Square, half, width_m * height_m)
                }
                Emitter::RoundPanel { diameter_m } => {
                    let half = Vec3::new(0.5 * diameter_m, 0.5 * diameter_m, 1.0);
                    (EmitterSurface::Disc, half, 0.25 * PI * diameter_m * diameter_m)
                }
                Emitter::Point | Emitter::Spot { .. } | Emitter::Sun { .. } | Emitter::Surround => continue,
            };
            let world_from_emitter = scene.light_frame(light) * Affine3A::from_scale(scale);
            let luminance = picture_scale(light, &scene.camera) * exposure::axial_intensity(light) / area_m2;
            if !world_from_emitter.is_finite() || !luminance.is_finite() {
                continue;
            }
            let Some(mesh) = uploads.meshes.emitter(uploads.device, surface) else { continue };
            let Some(parts) = uploads.meshes.get(mesh).map(|m| m.parts.clone()) else { continue };
            let black = Material { base_color: [0.0; 3], ..Material::default() };
            let owner = Some(Pick::Light(light.id));
            let record = self.add_record(&world_from_emitter, &black, scene, FLAG_EMITTER, owner);
            self.records[record as usize].emission = luminance.into();
            for part in &parts {
                self.add_item(mesh, part, record, &black, uploads);
                // From behind, the camera looks through an emitter.
                if let Some(item) = self.items.last_mut() {
                    item.pass = Pass::OneSided;
                }
            }
        }
    }

    fn add_record(
        &mut self,
        world_from_object: &Affine3A,
        material: &Material,
        scene: &Scene,
        flags: u32,
        owner: Option<Pick>,
    ) -> u32 {
        let glow = emission(material, &scene.camera);
        let glows = glow.is_finite() && glow.max_element() > 0.0;
        let surface = GpuSurface {
            base_color: material.base_color.map(|c| c.clamp(0.0, 1.0)),
            roughness: material.roughness.clamp(0.0, 1.0),
            emission: if glows { glow.into() } else { [0.0; 3] },
            metallic: material.metallic.clamp(0.0, 1.0),
            ior: material.ior.clamp(1.0, 4.0),
            transmission: material.transmission.clamp(0.0, 1.0),
            flags: flags | if glows { FLAG_GLOWS } else { 0 },
            unused: 0,
        };
        self.draws.push(GpuDraw::new(self.records.len() as u32, world_from_object, &surface));
        self.records.push(surface);
        self.places.push(*world_from_object);
        self.owners.push(owner);
        self.records.len() as u32 - 1
    }

    fn add_item(&mut self, mesh: MeshKey, part: &MeshPart, record: u32, material: &Material, uploads: &mut Uploads) {
        let picture = material.base_color_texture.as_ref().and_then(|path| uploads.assets.textures.get(path));
        let texture = picture.map_or(WHITE, |p| uploads.textures.ensure(uploads.device, uploads.queue, p));
        let glass = material.transmission > 0.0;
        self.items.push(DrawItem {
            mesh,
            indices: part.triangles.start * 3..part.triangles.end * 3,
            record,
            texture,
            pass: if glass { Pass::Glass } else { Pass::Opaque },
            shadow: Shadow::Nothing,
            glass: &[Sides::Both],
            caster: 0,
        });
    }
}

fn outline_flags(overlay: &Overlay, pick: Pick) -> u32 {
    let selected = if overlay.selects(pick) { FLAG_SELECTED } else { 0 };
    let hovered = if overlay.hovered == Some(pick) { FLAG_HOVERED } else { 0 };
    selected | hovered
}
