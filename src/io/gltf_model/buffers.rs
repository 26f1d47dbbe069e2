//! The document of a glTF file with its buffers, and the images inside.

use crate::io::contained_file::find_in;
use crate::io::model::ModelLimits;
use crate::io::read::read_limited;
use crate::scene::path_complaint;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::image::Source;
use gltf::json::validation::Checked;
use gltf::{Document, Gltf};
use percent_encoding::percent_decode_str;
use serde_json::Value;
use std::path::Path;

/// Extensions of materials that the crate does not read.
const LAYER_EXTENSIONS: [&str; 4] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_sheen",
];

/// Extensions whose content is read, or that can be left out of a picture.
const KNOWN_EXTENSIONS: [&str; 13] = [
    "KHR_lights_punctual",
    LAYER_EXTENSIONS[0],
    LAYER_EXTENSIONS[1],
    LAYER_EXTENSIONS[2],
    LAYER_EXTENSIONS[3],
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_texture_transform",
];

/// A glTF file in memory.
pub struct ModelFile {
    /// The checked document.
    pub document: Document,
    buffers: Vec<Vec<u8>>,
    /// The document as JSON, where it has properties that the crate leaves out.
    json: Option<Value>,
}

impl ModelFile {
    /// Parses GLB or JSON, with its buffers.
    ///
    /// # Errors
    /// If the file is damaged, needs an unknown extension, or has buffers that can't be read. Buffers in other files are
    /// read beside `place`, the file's path and limits; without it they are empty.
    pub fn parse(bytes: &[u8], place: Option<(&Path, &ModelLimits)>) -> Result<Self, String> {
        // An extension that is needed gets its own words, before the document is checked
        let unchecked = Gltf::from_slice_without_validation(bytes).map_err(|error| error.to_string())?;
        if let Some(unknown) = unchecked.extensions_required().find(|name| !KNOWN_EXTENSIONS.contains(name)) {
            return Err(format!("it needs {unknown}, which is not read: export it without compression and extras"));
        }
        // The check itself would panic at an array that is not there
        let root = unchecked.document.as_json();
        let mut arrays = root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|one| one.attributes.values());
        if arrays.any(|index| index.value() >= root.accessors.len()) {
            return Err("a mesh has an array that is not there".to_owned());
        }
        let Gltf { document, mut blob } = Gltf::from_slice(bytes).map_err(|error| error.to_string())?;
        // As it would at a lamp that is not there, and at a spot lamp without angles
        check_lamps(document.as_json())?;
        // The document's check leaves this out, and reading such an image would panic
        if document.as_json().images.iter().any(|image| match image.buffer_view {
            Some(_) => image.mime_type.is_none(),
            None => image.uri.is_none(),
        }) {
            return Err("an image has no data, or data of no type".to_owned());
        }
        let mut left = place.map_or(0, |(_, limits)| limits.file_bytes);
        let buffer = |buffer: gltf::Buffer<'_>| {
            let bytes = match (buffer.source(), place) {
                (gltf::buffer::Source::Bin, _) => blob.take().ok_or("its binary part is missing")?,
                (gltf::buffer::Source::Uri(uri), place) => match (data_uri(uri), place) {
                    (Some(bytes), _) => bytes?,
                    (None, Some((path, _))) => external(uri, path, &mut left)?,
                    // An image inside of the file does not need it
                    (None, None) => return Ok(Vec::new()),
                },
            };
            if bytes.len() < buffer.length() {
                return Err("its data are cut off".to_owned());
            }
            Ok(bytes)
        };
        let buffers = document.buffers().map(buffer).collect::<Result<_, String>>()?;
        let needs_json = |name: &str| name == "KHR_texture_transform" || LAYER_EXTENSIONS.contains(&name);
        let json = document.extensions_used().any(needs_json).then(|| json_of(bytes)).flatten();
        Ok(ModelFile { document, buffers, json })
    }

    /// Returns a sentence for each extension that is not read.
    pub fn left_out(&self) -> Vec<String> {
        let unknown = self.document.extensions_used().filter(|name| !KNOWN_EXTENSIONS.contains(name));
        unknown.map(|name| format!("the properties of {name} are left out")).collect()
    }

    /// Returns the transform of the normal texture of a material.
    pub fn normal_texture_transform(&self, material: Option<usize>) -> Option<&Value> {
        let materials = self.json.as_ref()?.get("materials")?;
        materials.get(material?)?.get("normalTexture")?.get("extensions")?.get("KHR_texture_transform")
    }

    /// Returns the extension of a material that the crate does not read, as the file has it.
    pub fn material_extension(&self, material: Option<usize>, name: &str) -> Option<&Value> {
        self.json.as_ref()?.get("materials")?.get(material?)?.get("extensions")?.get(name)
    }

    /// Returns the bytes of a buffer.
    pub fn bytes(&self, buffer: &gltf::Buffer<'_>) -> &[u8] {
        self.buffers.get(buffer.index()).map_or(&[], Vec::as_slice)
    }

    /// Returns the bytes of a part of a buffer; none if it is not inside.
    pub fn view(&self, view: &gltf::buffer::View<'_>) -> Option<&[u8]> {
        let end = view.offset().checked_add(view.length())?;
        self.bytes(&view.buffer()).get(view.offset()..end)
    }

    /// Returns the bytes of the image with an index, a PNG or JPEG file by itself.
    ///
    /// # Errors
    /// If there is no such image, or if it lies in another file.
    pub fn image(&self, index: u32) -> Result<Vec<u8>, String> {
        let missing = || format!("there is no image {index} in it");
        let image = self.document.images().nth(usize::try_from(index).map_err(|_| missing())?).ok_or_else(missing)?;
        match image.source() {
            Source::View { view, .. } => Ok(self.view(&view).ok_or("its data are cut off")?.to_vec()),
            Source::Uri { uri, .. } => data_uri(uri).ok_or_else(missing)?,
        }
    }
}

/// Checks that lamps are there and that spot lamps have their angles.
fn check_lamps(root: &gltf::json::Root) -> Result<(), String> {
    let lights = root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref()).map(|all| &all.lights);
    let is_damaged = |light: &gltf::json::extensions::scene::khr_lights_punctual::Light| {
        use gltf::json::extensions::scene::khr_lights_punctual::Type;
        match light.type_ {
            Checked::Valid(Type::Spot) => light.spot.is_none(),
            Checked::Valid(Type::Directional | Type::Point) => false,
            Checked::Invalid => true,
        }
    };
    if lights.is_some_and(|lights| lights.iter().any(is_damaged)) {
        return Err("a lamp has no type, or no angles".to_owned());
    }
    let count = lights.map_or(0, Vec::len);
    let mut references = root.nodes.iter().filter_map(|node| node.extensions.as_ref()?.khr_lights_punctual.as_ref());
    if references.any(|reference| reference.light.value() >= count) {
        return Err("a node has a lamp that is not there".to_owned());
    }
    Ok(())
}

/// Reads a buffer from another file in the folder tree of the model, of at most `left` bytes.
fn external(uri: &str, model: &Path, left: &mut u64) -> Result<Vec<u8>, String> {
    let name = file_name(uri).ok_or_else(|| format!("its data lie in {uri:?}, which is no file beside it"))?;
    let bytes = find_in(&name, model.parent()).and_then(|file| read_limited(&file, *left));
    let bytes = bytes.map_err(|error| format!("its data can't be read: {error}"))?;
    *left = left.saturating_sub(bytes.len() as u64);
    Ok(bytes)
}

/// Returns the path from a model's folder that a URI names; none for data, and for what is not in the folder.
fn file_name(uri: &str) -> Option<String> {
    let name = percent_decode_str(uri).decode_utf8().ok()?.into_owned();
    (!uri.starts_with("data:") && !uri.contains("://") && path_complaint(&name).is_none()).then_some(name)
}

/// Returns the files with the buffers of a document, by their paths from its folder; see [`super::companions`].
pub fn companions(bytes: &[u8]) -> Vec<String> {
    let Ok(document) = Gltf::from_slice_without_validation(bytes) else { return Vec::new() };
    let buffers = document.document.as_json().buffers.iter();
    buffers.filter_map(|buffer| file_name(buffer.uri.as_deref()?)).collect()
}

/// Parses the JSON of a GLB or JSON file.
fn json_of(bytes: &[u8]) -> Option<Value> {
    let is_binary = bytes.starts_with(b"glTF");
    let glb = is_binary.then(|| gltf::Glb::from_slice(bytes).ok()).flatten();
    serde_json::from_slice(glb.as_ref().map_or(bytes, |glb| &glb.json)).ok()
}

/// Decodes the bytes of a `data:` URI; none for another URI.
pub fn data_uri(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let (_, data) = uri.strip_prefix("data:")?.split_once(',')?;
    Some(STANDARD.decode(data).map_err(|error| format!("its data are damaged: {error}")))
}
