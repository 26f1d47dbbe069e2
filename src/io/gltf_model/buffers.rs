//! The document of a glTF file with its buffers, and the images inside.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::image::Source;
use gltf::{Document, Gltf};

/// Extensions whose content is read, or that can be left out of a picture.
const KNOWN_EXTENSIONS: [&str; 9] = [
    "KHR_lights_punctual",
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
}

impl ModelFile {
    /// Parses GLB or JSON, with its buffers.
    ///
    /// # Errors
    /// If the file is damaged, needs an unknown extension, or has buffers in other files.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
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
        // The document's check leaves this out, and reading such an image would panic
        if document.as_json().images.iter().any(|image| match image.buffer_view {
            Some(_) => image.mime_type.is_none(),
            None => image.uri.is_none(),
        }) {
            return Err("an image has no data, or data of no type".to_owned());
        }
        let buffer = |buffer: gltf::Buffer<'_>| {
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => blob.take().ok_or("its binary part is missing")?,
                gltf::buffer::Source::Uri(uri) => data_uri(uri)
                    .ok_or_else(|| format!("its data lie in another file, {uri:?}: export it as one GLB file"))??,
            };
            if bytes.len() < buffer.length() {
                return Err("its data are cut off".to_owned());
            }
            Ok(bytes)
        };
        let buffers = document.buffers().map(buffer).collect::<Result<_, String>>()?;
        Ok(ModelFile { document, buffers })
    }

    /// Returns a sentence for each thing in the file that is no surface, and for each extension that is not read.
    pub fn left_out(&self) -> Vec<String> {
        let has_lights = self.document.lights().is_some_and(|lights| lights.len() > 0);
        let things = [("lamps", has_lights), ("cameras", self.document.cameras().len() > 0)];
        let things = things.into_iter().filter(|(_, is_there)| *is_there).map(|(name, _)| name.to_owned());
        let unknown = self.document.extensions_used().filter(|name| !KNOWN_EXTENSIONS.contains(name));
        let unknown = unknown.map(|name| format!("the properties of {name}"));
        things.chain(unknown).map(|what| format!("{what} are left out")).collect()
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

/// Decodes the bytes of a `data:` URI; none for another URI.
pub fn data_uri(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let (_, data) = uri.strip_prefix("data:")?.split_once(',')?;
    Some(STANDARD.decode(data).map_err(|error| format!("its data are damaged: {error}")))
}
