//! Checks materials.

use super::check::{Allowed, Check};
use crate::scene::fibre::MIN_ROUGHNESS;
use crate::scene::{Alpha, Anisotropy, Clearcoat, Fibre, FibreColor, Material, Sheen, TexturePlacement, TextureSlot};

/// Reflectances lie in [0, 1): a closed room with reflectance 1 has no finite solution.
const REFLECTANCE: Allowed = Allowed::between(0.0, 0.999, "");
/// The colour of clear glass, which does not reflect by it.
const TRANSMITTANCE: Allowed = Allowed::between(0.0, 1.0, "");
const FRACTION: Allowed = Allowed::between(0.0, 1.0, "");
/// Smoother fibres have lobes of less than a degree.
const FIBRE_ROUGHNESS: Allowed = Allowed::between(MIN_ROUGHNESS, 1.0, "");

pub(super) fn check_material(field: &str, material: &Material, check: &mut Check) {
    let name = |part: &str| format!("{field}.{part}");
    let is_clear = material.transmission == 1.0 && material.metallic == 0.0;
    check.color(&name("base_color"), material.base_color, if is_clear { TRANSMITTANCE } else { REFLECTANCE });
    check_textures(field, material, check);
    check.number(&name("metallic"), material.metallic, FRACTION);
    check.number(&name("roughness"), material.roughness, FRACTION);
    check.number(&name("ior"), material.ior, Allowed::between(1.0, 4.0, ""));
    check.number(&name("transmission"), material.transmission, FRACTION);
    check.color(&name("absorption_per_m"), material.absorption_per_m, Allowed::between(0.0, 1e6, "per m"));
    if let Some(subsurface) = material.subsurface {
        let field = name("subsurface.mean_free_path_mm");
        check.color(&field, subsurface.mean_free_path_mm, Allowed::between(0.01, 1000.0, "mm"));
        if material.transmission > 0.0 {
            check
                .warning(&field, "light passes through something clear: nothing scatters under its surface".to_owned());
        }
    }
    check_layers(field, material, check);
    check.color(&name("emission_cd_m2"), material.emission_cd_m2, Allowed::between(0.0, 1e9, "cd/m2"));
    if let Some(fibre) = &material.fibre {
        check_fibre(&name("fibre"), fibre, check);
        if material.transmission > 0.0 {
            check.warning(&name("transmission"), "a fibre is opaque as a surface; its colour is in fibre".to_owned());
        }
    }
    if material.metallic > 0.0 && material.transmission > 0.0 {
        check.warning(&name("transmission"), "a metal is not transparent; its share of metal stays opaque".to_owned());
    }
}

/// Checks lacquer, sheen, brushing, frosting and translucency.
fn check_layers(field: &str, material: &Material, check: &mut Check) {
    let name = |part: &str| format!("{field}.{part}");
    if let Some(Clearcoat { amount, roughness }) = material.clearcoat {
        check.number(&name("clearcoat.amount"), amount, FRACTION);
        check.number(&name("clearcoat.roughness"), roughness, FRACTION);
    }
    if let Some(Sheen { color, roughness }) = material.sheen {
        check.color(&name("sheen.color"), color, FRACTION);
        check.number(&name("sheen.roughness"), roughness, FRACTION);
    }
    if let Some(Anisotropy { strength, rotation_deg }) = material.anisotropy {
        check.number(&name("anisotropy.strength"), strength, FRACTION);
        check.number(&name("anisotropy.rotation_deg"), rotation_deg, Allowed::between(-360.0, 360.0, "degrees"));
    }
    check.number(&name("frosting"), material.frosting, FRACTION);
    check.number(&name("translucency"), material.translucency, FRACTION);
    if material.frosting > 0.0 && material.transmission == 0.0 {
        check.warning(&name("frosting"), "nothing is clear here: transmission is 0".to_owned());
    }
    if material.translucency > 0.0 && !material.is_translucent() {
        let why = "metal and what is clear let no light through evenly: translucency does nothing here";
        check.warning(&name("translucency"), why.to_owned());
    }
    let has_layers = material.clearcoat.is_some()
        || material.sheen.is_some()
        || material.anisotropy.is_some()
        || material.is_translucent();
    if has_layers && material.subsurface.is_some() {
        let why = "a surface with lacquer, sheen, brushing or translucency has no scattering under it";
        check.warning(&name("subsurface"), why.to_owned());
    }
}

fn check_textures(field: &str, material: &Material, check: &mut Check) {
    let name = |part: &str| format!("{field}.{part}");
    for (slot, texture) in material.textures.iter() {
        if let Some(path) = texture.path() {
            check.asset_path(&name(slot.field()), path);
        }
    }
    check.number(&name("normal_scale"), material.textures.normal_scale, Allowed::between(-16.0, 16.0, ""));
    if material.textures.dome_radius != 0.0 {
        let radii = Allowed::between(1.0, 1000.0, "half widths of the picture, or 0 for none");
        check.number(&name("dome_radius"), material.textures.dome_radius, radii);
    }
    for slot in TextureSlot::ALL {
        let TexturePlacement { offset, rotation_deg, scale, wrap: _, nearest: _, second_uvs: _ } =
            *material.textures.placement(slot);
        let place = name(slot.placement_field());
        let pictures = Allowed::between(-1e4, 1e4, "pictures");
        offset.into_iter().for_each(|value| check.number(&format!("{place}.offset"), value, pictures));
        check.number(&format!("{place}.rotation_deg"), rotation_deg, Allowed::between(-360.0, 360.0, "degrees"));
        scale.into_iter().for_each(|value| check.number(&format!("{place}.scale"), value, pictures));
    }
    match material.alpha {
        Alpha::Opaque => {}
        Alpha::Mask { cutoff } => check.number(&name("alpha.cutoff"), cutoff, FRACTION),
        Alpha::Blend { opacity } => check.number(&name("alpha.opacity"), opacity, FRACTION),
    }
    if material.textures.emission.is_some() && !material.is_emissive() {
        check.warning(&name("emission_texture"), "the surface does not glow: emission_cd_m2 is 0".to_owned());
    }
}

fn check_fibre(field: &str, fibre: &Fibre, check: &mut Check) {
    let name = |part: &str| format!("{field}.{part}");
    match fibre.color {
        FibreColor::Melanin { melanin, redness } => {
            check.number(&name("color.melanin"), melanin, FRACTION);
            check.number(&name("color.redness"), redness, FRACTION);
        }
        FibreColor::Dye(color) => check.color(&name("color"), color, REFLECTANCE),
    }
    check.number(&name("roughness_along"), fibre.roughness_along, FIBRE_ROUGHNESS);
    check.number(&name("roughness_around"), fibre.roughness_around, FIBRE_ROUGHNESS);
}
