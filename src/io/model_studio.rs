//! A studio for a model: on a grey sweep under a softbox, or with the lamps and the camera of its file.

use super::error::AssetError;
use super::model::ImportedModel;
use super::model_set_up::expose_for_lamps;
use super::model_size::fit_model;
use crate::scene::{
    Aim, Camera, Emitter, Light, LightId, Material, MaterialPreset, Mesh, Object, ObjectId, Output, Scene, Shape,
    TextureRef, TextureSlot, Transform, path_complaint,
};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folder beside a studio for models that lie elsewhere.
const MODEL_FOLDER: &str = "models";
/// Extent from which on the sweep and the softbox grow with the model, metres.
const FULL_SIZE_M: f32 = 0.6;
/// Distance of the softbox over the extent of what it lights, at least.
const LIGHT_DISTANCE: f32 = 2.2;
/// Margin around the model in the picture.
const MARGIN: f32 = 1.25;

/// A studio for a model, with the places of its files until they are copied beside it.
#[derive(Debug)]
pub struct ModelStudio {
    /// The studio.
    pub scene: Scene,
    /// Files that lie elsewhere, by the studio's path for them.
    pub imported: BTreeMap<String, PathBuf>,
    /// What was guessed and what was left out, a sentence each.
    pub notes: Vec<String>,
}

/// Builds a studio for a model whose file lies at `file`, for a studio file in `folder`.
///
/// # Errors
/// If the model's file has no name that a studio can hold.
pub fn studio_of(model: ImportedModel, file: &Path, folder: &Path) -> Result<ModelStudio, AssetError> {
    let ImportedModel { mesh, part_materials, set_up, warnings } = model;
    let name = file.file_stem().map_or_else(|| "Model".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut names = AssetNames::new(file, folder)?;
    let part_materials = part_materials.into_iter().map(|(part, material)| (part, names.adopt(material))).collect();
    let mut object = Object {
        id: ObjectId(1),
        part_materials,
        material: MaterialPreset::MatteFabric.material(),
        ..Object::new(name.clone(), Shape::MeshFile { path: names.path.clone() })
    };
    let mut notes: Vec<String> = fit_model(&mut object, &mesh).into_iter().collect();
    let (lights, camera) = set_up.around(&object.transform, &mesh);
    let (low, high) = placed_bounds(&mut object, &mesh, lights.is_empty() && camera.is_none());
    let mut scene = Scene { name, objects: vec![object], ..Scene::default() };
    scene.camera = camera.unwrap_or_else(|| framing_camera(low, high));
    if lights.is_empty() {
        add_sweep_and_softbox(&mut scene, low, high);
    } else {
        notes.push(format!("{} of the file, and no softbox", counted(lights.len(), "lamp")));
        let lens = scene.focused_lens();
        expose_for_lamps(&mut scene.camera, &lens, &lights, 0.5 * (low + high));
        for (light, id) in lights.into_iter().zip(1..) {
            let name = scene.unique_name(&light.name);
            scene.lights.push(Light { id: LightId(id), name, ..light });
        }
    }
    notes.extend(warnings);
    Ok(ModelStudio { scene, imported: names.imported, notes })
}

/// Returns a number with its noun.
fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("the {noun}") } else { format!("the {count} {noun}s") }
}

/// Returns the world box of an object with a fitted mesh; moves the object's middle over the origin if it may move.
fn placed_bounds(object: &mut Object, mesh: &Mesh, may_move: bool) -> (Vec3, Vec3) {
    let (low, high) = mesh.bounds();
    let scale = object.transform.scale.x;
    if may_move {
        let middle = 0.5 * scale * (low + high);
        object.transform.position -= Vec3::new(middle.x, 0.0, middle.z);
    }
    (low * scale + object.transform.position, high * scale + object.transform.position)
}

/// Returns a camera from the front and slightly above that shows a box with a margin.
fn framing_camera(low: Vec3, high: Vec3) -> Camera {
    let middle = 0.5 * (low + high);
    let mut camera = Camera { focal_length_mm: 85.0, f_number: 8.0, shutter_s: 1.0 / 125.0, ..Camera::default() };
    let half_height = 0.5 * camera.sensor.size_mm().y / camera.focal_length_mm;
    let radius = (0.5 * (high - low).length()).max(0.02);
    let direction = Vec3::new(0.0, 0.25, 1.0).normalize();
    camera.position = middle + direction * (radius * MARGIN / half_height);
    camera.aim = Aim::Point(middle);
    camera
}

/// Adds grey paper behind and below a box, and a softbox from the left, from above and ahead, exposed for the camera.
fn add_sweep_and_softbox(scene: &mut Scene, low: Vec3, high: Vec3) {
    let extent = (high - low).max_element().max(0.02);
    let size = (extent / FULL_SIZE_M).max(1.0);
    let paper = Shape::Sweep { width_m: 2.72 * size, height_m: 2.2 * size, depth_m: 3.0 * size, radius_m: 0.5 * size };
    let material = MaterialPreset::GreyPaper.material();
    let behind = Vec3::new(0.0, low.y - 0.001 * size, low.z - 1.0 * size);
    let transform = Transform::at(behind);
    scene.objects.push(Object { id: ObjectId(2), transform, material, ..Object::new("Grey sweep", paper) });
    let target = 0.5 * (low + high);
    let emitter = Emitter::RectPanel { width_m: 0.6 * size, height_m: 0.9 * size };
    let distance = (LIGHT_DISTANCE * extent).max(1.4 * size);
    let direction = Vec3::new(-0.6, 0.65, 0.6).normalize();
    // A guide number is f-number times distance
    let output = Output::FlashGuideNumber(scene.camera.f_number * distance);
    let softbox = Light {
        id: LightId(1),
        name: "Softbox".to_owned(),
        position: target + direction * distance,
        aim: Aim::Point(target),
        ..Light::new(emitter, output)
    };
    scene.lights.push(softbox);
}

/// The paths by which a studio names the files of a model.
struct AssetNames<'a> {
    file: &'a Path,
    /// The studio's path of the model.
    path: String,
    imported: BTreeMap<String, PathBuf>,
}

impl<'a> AssetNames<'a> {
    fn new(file: &'a Path, folder: &Path) -> Result<Self, AssetError> {
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if let Some(reason) = path_complaint(&name) {
            return Err(AssetError::BadPath { reason, path: name });
        }
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let inside = file.canonicalize().ok().zip(folder.canonicalize().ok()).and_then(|(file, folder)| {
            let path = file.strip_prefix(folder).ok()?;
            Some(path.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/"))
        });
        let mut imported = BTreeMap::new();
        let path = inside.unwrap_or_else(|| {
            let path = format!("{MODEL_FOLDER}/{name}");
            imported.insert(path.clone(), file.to_owned());
            path
        });
        Ok(AssetNames { file, path, imported })
    }

    /// Returns a material with textures as the studio names them: beside the model.
    fn adopt(&mut self, mut material: Material) -> Material {
        let folder = self.path.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
        for slot in TextureSlot::ALL {
            let texture = material.textures.get_mut(slot);
            let Some(reference) = texture.take() else { continue };
            let path = match &reference {
                TextureRef::Embedded { .. } => self.path.clone(),
                TextureRef::File(path) if folder.is_empty() => path.clone(),
                TextureRef::File(path) => format!("{folder}/{path}"),
                TextureRef::Builtin(_) => {
                    *texture = Some(reference);
                    continue;
                }
            };
            if let (TextureRef::File(source), false) = (&reference, self.imported.is_empty()) {
                let beside = self.file.parent().unwrap_or(Path::new("")).join(source);
                self.imported.insert(path.clone(), beside);
            }
            *texture = Some(reference.at_path(path));
        }
        material
    }
}
