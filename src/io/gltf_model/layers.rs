//! Lacquer, sheen, brushing and translucency of glTF materials, read from the JSON.

use super::buffers::ModelFile;
use crate::scene::{Anisotropy, Clearcoat, Material, Sheen};
use serde_json::Value;

/// Adds what the extensions of a material say. Returns a sentence for each of their maps, which are left out.
pub fn add_layers(file: &ModelFile, source: &gltf::Material<'_>, material: &mut Material) -> Vec<String> {
    let mut left_out = Vec::new();
    let mut extension = |name: &str| {
        let json = file.material_extension(source.index(), name)?;
        if json.as_object()?.keys().any(|key| key.ends_with("Texture")) {
            left_out.push(format!("maps of {name} are left out"));
        }
        Some(json)
    };
    let clearcoat = extension("KHR_materials_clearcoat").map(|json| Clearcoat {
        amount: unit(json, "clearcoatFactor"),
        roughness: unit(json, "clearcoatRoughnessFactor"),
    });
    material.clearcoat = clearcoat.filter(|coat| coat.amount > 0.0);
    let sheen = extension("KHR_materials_sheen")
        .map(|json| Sheen { color: color(json, "sheenColorFactor"), roughness: unit(json, "sheenRoughnessFactor") });
    material.sheen = sheen.filter(|sheen| sheen.color != [0.0; 3]);
    let anisotropy = extension("KHR_materials_anisotropy").map(|json| Anisotropy {
        strength: unit(json, "anisotropyStrength"),
        rotation_deg: number(json, "anisotropyRotation").to_degrees() % 360.0,
    });
    material.anisotropy = anisotropy.filter(|anisotropy| anisotropy.strength > 0.0);
    if let Some(json) = extension("KHR_materials_diffuse_transmission").filter(|_| material.transmission == 0.0) {
        material.translucency = unit(json, "diffuseTransmissionFactor");
    }
    // Clear surfaces are as rough as their highlights (KHR_materials_transmission)
    if material.transmission > 0.0 {
        material.frosting = material.roughness;
    }
    left_out
}

/// Returns a number; 0 where there is none that can be used.
fn number(json: &Value, name: &str) -> f32 {
    json.get(name).map_or(0.0, float)
}

fn unit(json: &Value, name: &str) -> f32 {
    number(json, name).clamp(0.0, 1.0)
}

fn color(json: &Value, name: &str) -> [f32; 3] {
    let channel = |index: usize| json.get(name).and_then(|values| values.get(index)).map_or(0.0, float);
    [0, 1, 2].map(|index| channel(index).clamp(0.0, 1.0))
}

fn float(value: &Value) -> f32 {
    serde_json::from_value::<f32>(value.clone()).ok().filter(|value| value.is_finite()).unwrap_or(0.0)
}
